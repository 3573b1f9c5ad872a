// The lower half of a certificate: a distance of 0 or more as the upper half of an f32, rounded up.
fn residual_bits(residual: f32) -> u32 {
    return (bitcast<u32>(residual) + 0xffffu) >> 16u;
}
