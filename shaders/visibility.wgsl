// Rasterises the proxy tessellation: which patch, at which (u,v), each pixel sees (Yasui & Kanai 2004, sec. 4.4, "face id
// and parameters"). Host side: passes/visibility.rs.

// Two texels a patch: clip-space x, y and w or z of its origin; the viewpoint relative to its origin. Composed in f64.
@group(0) @binding(3) var views: texture_2d<f32>;
@group(0) @binding(4) var<uniform> frame: Frame;
// Patches in drawing order, NO_PATCH where a group is not full.
@group(0) @binding(5) var<storage, read> order: array<u32>;

// One draw: an instance is a group of patches.
struct Draw {
    first: u32,
    group_size: u32,
    padding: vec2u,
}

@group(1) @binding(0) var<uniform> draw: Draw;

struct Vertex {
    @builtin(position) clip: vec4f,
    @location(0) uv: vec2f,
    @location(1) @interpolate(flat, either) patch_id: u32,
    @location(2) position: vec3f,
    @location(3) normal: vec3f,
}

struct Visible {
    // Patch id + 1: 0 is the background.
    @location(0) patch_id: u32,
    @location(1) uv: vec2f,
}

struct Polygon {
    @location(0) patch_id: u32,
    @location(1) uv: vec2f,
    @location(2) position: vec4f,
    @location(3) normal: vec4f,
}

fn clip_direction(d: vec3f) -> vec3f {
    return vec3f(dot(frame.clip_x, d), dot(frame.clip_y, d), dot(frame.clip_depth, d));
}

// z and w from the third coordinate: in perspective it is w, and z the near distance (z/w = near/distance); in an
// orthographic view it is z, and w is 1. Either way the greater depth is the nearer.
fn depth_of(third: f32) -> vec2f {
    return select(vec2f(frame.near, third), vec2f(third, 1.0), frame.orthographic != 0u);
}

// How far to move along the unit tangent `d` so that the vertex at clip-space c moves by PUSH pixels. Where the tangent
// is seen end on, not more than 10 times what it takes face on.
fn push_distance(c: vec3f, d: vec3f) -> f32 {
    let perspective = frame.orthographic == 0u;
    let w = select(1.0, max(c.z, frame.near), perspective);
    let e = clip_direction(d);
    let turn = select(0.0, e.z / w, perspective);
    let speed = length((e.xy - c.xy * turn) * frame.size * frame.scale) * 0.5 / w;
    let head_on = frame.focal / w;
    return PUSH / max(speed, 0.1 * head_on);
}

// Where a point of a patch, relative to its origin, is in the picture.
fn projected(patch_id: u32, position: vec3f) -> vec4f {
    let clip = textureLoad(views, at(2u * patch_id), 0).xyz + clip_direction(position);
    let depth = depth_of(clip.z);
    return vec4f(clip.xy * frame.scale + frame.shift * depth.y, depth);
}

// For `--pipeline points`: the polygon as it is, no border moved.
@vertex
fn vertex_plain(@location(0) uv: vec2f, @location(1) member: u32, @builtin(instance_index) group: u32) -> Vertex {
    let patch_id = order[draw.first + group * draw.group_size + member];
    if patch_id == NO_PATCH {
        return Vertex(vec4f(2.0, 2.0, 0.0, 1.0), vec2f(0.0), 0u, vec3f(0.0), vec3f(0.0));
    }
    let p = limit_point(textureLoad(patches, at(patch_id), 0), uv);
    return Vertex(projected(patch_id, p.position), uv, patch_id, p.position, p.normal);
}

@vertex
fn vertex(@location(0) uv: vec2f, @location(1) member: u32, @builtin(instance_index) group: u32) -> Vertex {
    let patch_id = order[draw.first + group * draw.group_size + member];
    if patch_id == NO_PATCH {
        return Vertex(vec4f(2.0, 2.0, 0.0, 1.0), vec2f(0.0), 0u, vec3f(0.0), vec3f(0.0));
    }
    let record = textureLoad(patches, at(patch_id), 0);
    let p = limit_point(record, uv);
    var clip = textureLoad(views, at(2u * patch_id), 0).xyz + clip_direction(p.position);
    // Neighbours compute the vertices that they share from different points, so these differ by rounding, and pixels
    // could fall in between. Border vertices therefore move outwards by a fraction of a pixel; (u,v) moves along (the
    // limit pass clamps it), so that inside the patch nothing shifts.
    let side = vec2f(select(0.0, 1.0, uv.x == 1.0) - select(0.0, 1.0, uv.x == 0.0),
        select(0.0, 1.0, uv.y == 1.0) - select(0.0, 1.0, uv.y == 0.0));
    let tu = unit_or_zero(p.du);
    let tv = unit_or_zero(p.dv);
    let push = side * vec2f(push_distance(clip, tu), push_distance(clip, tv));
    clip += clip_direction(tu * push.x + tv * push.y);
    // A quarter of a proxy cell at most; none at an extraordinary vertex, where derivatives vanish or blow up.
    let own = refinement_of(record);
    let cell = 0.25 * exp2(-vec2f(max(vec2u(frame.proxy_level), own) - own));
    let speed = max(vec2f(length(p.du), length(p.dv)), vec2f(1e-30));
    var shift = clamp(push / speed, -cell, cell);
    if is_irregular(record) && all(uv == vec2f(0.0)) {
        shift = vec2f(0.0);
    }
    let depth = depth_of(clip.z);
    let xy = clip.xy * frame.scale + frame.shift * depth.y;
    return Vertex(vec4f(xy, depth), uv + shift, patch_id, p.position, p.normal);
}

@fragment
fn visible(v: Vertex) -> Visible {
    return Visible(v.patch_id + 1u, clamp(v.uv, vec2f(0.0), vec2f(1.0)));
}

// For `--pipeline polygon`: position and normal interpolated from the proxy's vertices (Yasui & Kanai 2004, fig. 7b).
@fragment
fn polygon(v: Vertex) -> Polygon {
    let uv = clamp(v.uv, vec2f(0.0), vec2f(1.0));
    return Polygon(v.patch_id + 1u, uv, vec4f(v.position, 1.0), vec4f(unit_or_zero(v.normal), 0.0));
}
