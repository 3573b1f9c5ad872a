// The tables of a surface. Host side: src/gpu/tables.

// A texel a patch: first texel in `points`; kind (bits 0 to 7), refinement levels along u and v (4 bits each), levels that
// are expanded (5 bits, from bit 16), groups of picked points (from bit 21); first texel in `scales` (bits 0 to 15), and from bit 16 the
// transform that moves it, counted from 1, or 0; first texel of the matrix of its class in `points`.
@group(0) @binding(0) var patches: texture_2d<u32>;
// In blocks of BLOCK_ROWS rows. First the transforms, 3 texels each: the columns. Then rows of 4 points, 3 texels each: the four x, the four y, the four z. A regular patch has
// 4 rows, each but the first as its difference from the one before: strips along creases are so thin that dv would
// lose its digits in the difference of points. A Gregory patch has its Bezier net with f- inside likewise, then a row of
// f+ - f-, a corner each. An expanded level of an irregular patch has 9: those of the windows at u >= 1 (5), then those of the window at
// u < 1 (4). After the expanded levels come the picked points, a group of 4 like a row, and one texel with the limit
// normal at (0,0). The matrix of a class gives the levels after the expanded ones: for every level and every picked
// point 9 texels, its weights in the 4 points of each of the 9 rows.
@group(0) @binding(1) var points: texture_2d_array<f32>;
// lambda^(n-1) and 2^n lambda^(n-1), a texel a level n, of each class.
@group(0) @binding(2) var scales: texture_2d<f32>;

fn point_texel(index: u32) -> vec4f {
    let row = index / TABLE_WIDTH;
    return textureLoad(points, vec2u(index % TABLE_WIDTH, row % BLOCK_ROWS), row / BLOCK_ROWS, 0);
}

fn is_irregular(record: vec4u) -> bool {
    return (record.y & 255u) == KIND_IRREGULAR;
}

fn is_gregory(record: vec4u) -> bool {
    return (record.y & 255u) == KIND_GREGORY;
}

// Weights of the rows as they are stored, from those of the points; `sum` is that of the weights.
fn row_weights(w: vec4f, sum: f32, record: vec4u) -> vec4f {
    return select(vec4f(sum, w.y + w.z + w.w, w.z + w.w, w.w), w, is_irregular(record));
}

fn refinement_of(record: vec4u) -> vec2u {
    return vec2u(record.y >> 8u, record.y >> 12u) & vec2u(15u);
}

fn expanded_levels(record: vec4u) -> u32 {
    return (record.y >> 16u) & 31u;
}

fn groups_of(record: vec4u) -> u32 {
    return record.y >> 21u;
}

fn first_scale(record: vec4u) -> u32 {
    return select(record.z, record.z & 0xffffu, HAS_INSTANCES);
}

// Whether it is another patch in another place.
fn is_instance(record: vec4u) -> bool {
    return HAS_INSTANCES && (record.z >> 16u) > 0u;
}

// What moves an instance, without the translation, which is in its origin.
fn transform_of(record: vec4u) -> mat3x3f {
    let first = 3u * ((record.z >> 16u) - 1u);
    return mat3x3f(point_texel(first).xyz, point_texel(first + 1u).xyz, point_texel(first + 2u).xyz);
}

// Where the limit normal at (0,0) of an irregular patch is.
fn normal_texel(record: vec4u) -> u32 {
    return record.x + expanded_levels(record) * LEVEL_TEXELS + 3u * groups_of(record);
}
