// Evaluates the limit at samples, for `eval --backend gpu`, `verify` and the tests. Host side: passes/evaluate.rs.

struct SampleRecord {
    uv: vec2f,
    patch_id: u32,
    padding: u32,
}

struct JetRecord {
    position: vec3f,
    du: vec3f,
    dv: vec3f,
    normal: vec3f,
}

@group(1) @binding(0) var<storage, read> samples: array<SampleRecord>;
@group(1) @binding(1) var<storage, read_write> jets: array<JetRecord>;

@compute @workgroup_size(WORKGROUP)
fn evaluate(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&samples) {
        return;
    }
    let s = samples[id.x];
    let p = limit_point(textureLoad(patches, at(s.patch_id), 0), clamp(s.uv, vec2f(0.0), vec2f(1.0)));
    jets[id.x] = JetRecord(p.position, p.du, p.dv, p.normal);
}
