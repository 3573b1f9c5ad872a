// Sums up the certificates of a tile's own samples, SUMMED of a column an invocation. Host side: passes/summary.rs.

struct Own {
    // First sample and number of them, each way.
    origin: vec2u,
    size: vec2u,
}

@group(0) @binding(0) var certificates: texture_2d<u32>;
@group(0) @binding(1) var<uniform> own: Own;
// Samples that see the surface, that were solved on the host, that did not converge; steps; the largest residual, as bits.
@group(0) @binding(2) var<storage, read_write> sums: array<atomic<u32>, 5>;

const INFINITE = 0x7f800000u;

@compute @workgroup_size(WORKGROUP)
fn summarise(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= own.size.x {
        return;
    }
    var covered = 0u;
    var solved = 0u;
    var doubtful = 0u;
    var steps = 0u;
    var residual = 0u;
    let end = min(own.size.y, (id.y + 1u) * SUMMED);
    for (var y = id.y * SUMMED; y < end; y++) {
        let bits = textureLoad(certificates, own.origin + vec2u(id.x, y), 0).x;
        let state = (bits >> 24u) & (STATE_DOUBTFUL - 1u);
        covered += select(0u, 1u, state != STATE_NONE);
        solved += select(0u, 1u, state == STATE_SOLVED);
        let own_residual = bits << 16u;
        let converged = ((bits >> 24u) & STATE_DOUBTFUL) == 0u && own_residual < INFINITE;
        doubtful += select(1u, 0u, converged);
        steps += (bits >> 16u) & 255u;
        residual = max(residual, own_residual);
    }
    atomicAdd(&sums[0], covered);
    atomicAdd(&sums[1], solved);
    atomicAdd(&sums[2], doubtful);
    atomicAdd(&sums[3], steps);
    // Residuals are floats from 0 on, whose bits are ordered like them.
    atomicMax(&sums[4], min(residual, INFINITE));
}
