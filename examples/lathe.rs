//! Writes `tests/meshes/lathe_c1.obj` and `lathe_c2.obj`: surfaces of revolution as in Ulmet 2003, figures 6.1 and 6.2.
//!
//! `cargo run --release --example lathe -- c1 > lathe_c1.obj`
//!
//! The profile is a uniform cubic B-spline, so the surface is C2, unless a ring of edges is infinitely sharp. The surface is straight across
//! such a ring on both sides (phantom points 2 a - b): where the first edges beyond it are collinear the curvature is 0 on both, and
//! nothing breaks. So the edges on one side run askew, as the rulings of a hyperboloid: the tangent planes still agree, but the
//! profile's curvature is 0 below the ring, and above it -tan^2 of the angle to the meridian times that of the ring.

/// Points a ring. The ring's curve is a circle to 7 parts in a million.
const AROUND: usize = 24;
/// Radius and height of the rings below the sharp one, and of it.
const BELOW: [[f64; 2]; 6] = [[0.62, -2.2], [0.95, -1.75], [1.18, -1.2], [1.2, -0.65], [1.1, -0.2], [1.0, 0.2]];
/// Rings above it.
const ABOVE: usize = 4;
/// How far their edges run along the ring, in radii.
const ASKEW: f64 = 0.5;

fn main() {
    let sharp = match std::env::args().nth(1).as_deref() {
        Some("c1") => true,
        Some("c2") => false,
        _ => {
            eprintln!("lathe: give c1 or c2");
            std::process::exit(2);
        }
    };
    let what = if sharp { "tangent planes agree along a ring, curvature does not" } else { "C2" };
    println!("# surface of revolution: {what} (examples/lathe.rs)");
    let [before, ring] = [BELOW[BELOW.len() - 2], BELOW[BELOW.len() - 1]];
    let above = (1..=ABOVE).map(|i| {
        let step = i as f64;
        let radius = ring[0] + step * (ring[0] - before[0]);
        let aside = step * ASKEW * ring[0];
        (radius.hypot(aside), ring[1] + step * (ring[1] - before[1]), aside.atan2(radius))
    });
    for (radius, height, turn) in BELOW.iter().map(|&[radius, height]| (radius, height, 0.0)).chain(above) {
        for k in 0..AROUND {
            let angle = turn + std::f64::consts::TAU * k as f64 / AROUND as f64;
            println!("v {:.9} {:.9} {height:.9}", radius * angle.cos(), radius * angle.sin());
        }
    }
    let at = |ring: usize, k: usize| ring * AROUND + k % AROUND;
    for ring in 0..BELOW.len() + ABOVE - 1 {
        for k in 0..AROUND {
            let corners = [at(ring, k), at(ring, k + 1), at(ring + 1, k + 1), at(ring + 1, k)].map(|corner| corner + 1);
            println!("f {} {} {} {}", corners[0], corners[1], corners[2], corners[3]);
        }
    }
    println!("t interpolateboundary 1/0/0 1");
    if sharp {
        for k in 0..AROUND {
            println!("t crease 2/1/0 {} {} 10", at(BELOW.len() - 1, k), at(BELOW.len() - 1, k + 1));
        }
    }
}
