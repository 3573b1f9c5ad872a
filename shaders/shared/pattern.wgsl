// Patterns filtered to the pixel. f64 twin with hard edges: src/field/pattern.rs.

// Part of a sample of width w (in periods) at s that lies in stripes `width` wide round the integers: the mean of the
// pulse train over [s - w/2, s + w/2]. Reduced to the nearest period first, for the sake of f32. `pixel`: samples in a
// pixel's width.
fn stripe(s: f32, width: f32, w: f32, pixel: f32) -> f32 {
    let x = s - round(s);
    let h = 0.5 * clamp(w, 1e-6, 2.0);
    let mean = clamp((pulse_integral(x + h, width) - pulse_integral(x - h, width)) / (2.0 * h), 0.0, 1.0);
    return mix(mean, width, unresolved(w * pixel));
}

// Integral from -1/2 to x of the pulse train.
fn pulse_integral(x: f32, width: f32) -> f32 {
    let period = floor(x + 0.5);
    return period * width + clamp(x - period + 0.5 * width, 0.0, width);
}

// How much of a pattern with periods 1/w pixels gives way to its mean: a box filter lets some of every frequency through,
// and beyond half a period a pixel that is nothing but moire.
fn unresolved(w: f32) -> f32 {
    return smoothstep(0.4, 0.8, w);
}

// Regularly arranged discs; j: derivatives of p by the sample's x and y.
fn disc(p: vec2f, radius: f32, jx: vec2f, jy: vec2f, pixel: f32) -> f32 {
    let c = p - round(p);
    let r = max(length(c), 1e-6);
    let w = max(length(vec2f(dot(c, jx), dot(c, jy))) / r, 1e-6);
    let sharp = clamp((radius - r) / w + 0.5, 0.0, 1.0);
    return mix(sharp, 3.14159265 * radius * radius, unresolved(max(length(jx), length(jy)) * pixel));
}

// Part of the sample inside |x| <= half.
fn slab(x: f32, half: f32, w: f32) -> f32 {
    return clamp((half - abs(x)) / max(w, 1e-20) + 0.5, 0.0, 1.0);
}
