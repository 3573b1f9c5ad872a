// Tables are textures TABLE_WIDTH texels wide, read by index. Software adapters gather texels of 8 invocations at once,
// but walk through storage buffers one invocation at a time (measured on lavapipe: 4 times slower).

fn at(index: u32) -> vec2u {
    return vec2u(index % TABLE_WIDTH, index / TABLE_WIDTH);
}
