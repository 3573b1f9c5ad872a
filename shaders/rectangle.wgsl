// The smallest rectangle that encloses the proxy's projection (Yasui & Kanai 2004, sec. 4.4), over the vertices of one
// draw. Follows visibility.wgsl. Host side: passes/rectangle.rs.

struct Span {
    // First vertex of the draw's group, and vertices in a group.
    first: u32,
    count: u32,
    groups: u32,
    // Groups a layer of the dispatch.
    rows: u32,
}

// Three words a vertex: u, v, member.
@group(1) @binding(1) var<storage, read> vertices: array<u32>;
@group(1) @binding(2) var<uniform> span: Span;
// Least x and y, greatest x and y, in samples of the target: floats, whose bits are ordered like them from 0 on.
@group(1) @binding(3) var<storage, read_write> rectangle: array<atomic<u32>, 4>;

@compute @workgroup_size(WORKGROUP)
fn enclose(@builtin(global_invocation_id) id: vec3u) {
    let group = id.y + id.z * span.rows;
    if id.x >= span.count || group >= span.groups {
        return;
    }
    let word = 3u * (span.first + id.x);
    let patch_id = order[draw.first + group * draw.group_size + vertices[word + 2u]];
    if patch_id == NO_PATCH {
        return;
    }
    let uv = vec2f(bitcast<f32>(vertices[word]), bitcast<f32>(vertices[word + 1u]));
    let clip = projected(patch_id, limit_point(textureLoad(patches, at(patch_id), 0), uv).position);
    // What reaches behind the near plane may cover anything.
    var low = vec2f(0.0);
    var high = frame.size;
    if clip.w > clip.z {
        low = clamp((clip.xy / clip.w * vec2f(0.5, -0.5) + 0.5) * frame.size, vec2f(0.0), frame.size);
        high = low;
    }
    let least = bitcast<vec2u>(low);
    let greatest = bitcast<vec2u>(high);
    for (var k = 0u; k < 2u; k++) {
        // Most vertices change nothing: a look is cheaper than an exchange.
        if least[k] < atomicLoad(&rectangle[k]) {
            atomicMin(&rectangle[k], least[k]);
        }
        if greatest[k] > atomicLoad(&rectangle[2u + k]) {
            atomicMax(&rectangle[2u + k], greatest[k]);
        }
    }
}
