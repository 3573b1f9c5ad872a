// Patterns filtered to the pixel. f64 twin with hard edges: src/field/pattern.rs.

// Part of a pixel of width w (in periods) at s that lies in stripes `width` wide round the integers: the mean of the
// pulse train over [s - w/2, s + w/2]. Reduced to the nearest period first, for the sake of f32.
fn stripe(s: f32, width: f32, w: f32) -> f32 {
    let x = s - round(s);
    let h = 0.5 * clamp(w, 1e-6, 2.0);
    let mean = clamp((pulse_integral(x + h, width) - pulse_integral(x - h, width)) / (2.0 * h), 0.0, 1.0);
    // A box lets some of every frequency through: beyond its first zero (one period) that would only be moire.
    return mix(mean, width, smoothstep(0.6, 1.0, w));
}

// Integral from -1/2 to x of the pulse train.
fn pulse_integral(x: f32, width: f32) -> f32 {
    let period = floor(x + 0.5);
    return period * width + clamp(x - period + 0.5 * width, 0.0, width);
}

// Regularly arranged discs; j: derivatives of p by the pixel's x and y.
fn disc(p: vec2f, radius: f32, jx: vec2f, jy: vec2f) -> f32 {
    let c = p - round(p);
    let r = max(length(c), 1e-6);
    let w = max(length(vec2f(dot(c, jx), dot(c, jy))) / r, 1e-6);
    let sharp = clamp((radius - r) / w + 0.5, 0.0, 1.0);
    // Where the pixel is wider than half a period it sees the mean.
    return mix(sharp, 3.14159265 * radius * radius, smoothstep(0.3, 1.0, max(length(jx), length(jy))));
}

// Part of the pixel inside |x| <= half.
fn slab(x: f32, half: f32, w: f32) -> f32 {
    return clamp((half - abs(x)) / max(w, 1e-20) + 0.5, 0.0, 1.0);
}
