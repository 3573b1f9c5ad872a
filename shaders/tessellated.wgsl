// Triangles with interpolated normals, as programs without the limit surface draw reflection lines: the peer that frames are
// measured against. One pass, the least that does it. Host side: gpu/tessellated.rs.

struct Scene {
    projection: mat4x4f,
    eye: vec4f,
    // A point of the light plane, and the period of the stripes.
    plane: vec4f,
    plane_normal: vec4f,
    across: vec4f,
}

@group(0) @binding(0) var<uniform> scene: Scene;

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
}

@vertex
fn corner(@location(0) position: vec3f, @location(1) normal: vec3f) -> Corner {
    return Corner(scene.projection * vec4f(position, 1.0), position, normal);
}

@fragment
fn stripes(at: Corner) -> @location(0) vec4f {
    let mirrored = reflect(at.position - scene.eye.xyz, normalize(at.normal));
    let ahead = dot(mirrored, scene.plane_normal.xyz);
    let hit = at.position + mirrored * (dot(scene.plane.xyz - at.position, scene.plane_normal.xyz) / ahead);
    let field = dot(hit - scene.plane.xyz, scene.across.xyz) / scene.plane.w;
    // The stripe's edge is as soft as a pixel is wide.
    let softness = max(fwidth(field), 1e-6);
    let shade = clamp(0.5 + (abs(fract(field) - 0.5) - 0.25) / softness, 0.0, 1.0);
    return vec4f(vec3f(shade), 1.0);
}
