mod caster;
mod gpu_support;
use caster::{Caster, Ray};
use catoptric::field::Scout;
use catoptric::gpu::*;
use catoptric::mesh;
use catoptric::stam::LimitSurface;
use rayon::prelude::*;
#[test]
fn tmp() {
    for path in std::env::var("MESHES").unwrap_or_default().split(' ') {
        let m = if path.is_empty() { mesh::sample() } else { mesh::read(std::path::Path::new(path)).unwrap() };
        let surface = LimitSurface::new(&m).unwrap();
        let gpu = gpu_support::gpu();
        let tables = gpu.upload(&surface).unwrap();
        let Some(scout) = Scout::new(&surface) else { continue };
        let mut camera = scout.camera([256, 256], glam::DVec3::Z);
        if std::env::var("ORTHO").is_ok() {
            camera = scout.orthographic_from([256, 256], glam::DVec3::Z, camera.eye - camera.target);
        }
        let view = View { samples: 1, ..View::new(camera, scout.light(&camera)) };
        let image = gpu.inspect(&tables, &view).unwrap();
        let c = Caster::new(&surface);
        let start = std::time::Instant::now();
        let hits: Vec<_> = (0..256 * 256usize)
            .into_par_iter()
            .map(|i| {
                let r = camera.pixel_ray((i % 256) as f64 + 0.5, (i / 256) as f64 + 0.5);
                c.first_hit(&Ray::new(r.origin, r.direction))
            })
            .collect();
        let t = start.elapsed();
        let (mut cov, mut worst, mut big, mut nmax, mut covered) = (0, 0f64, 0, 0f64, 0);
        let mut angles = vec![];
        for i in 0..hits.len() {
            match (&hits[i], image.patch[i]) {
                (None, NO_PATCH) => (),
                (Some(h), p) if p != NO_PATCH => {
                    covered += 1;
                    let [a, b] = [camera.project(h.position).unwrap(), camera.project(image.position[i]).unwrap()];
                    let d = (a[0] - b[0]).hypot(a[1] - b[1]);
                    let far = h.position.distance(image.position[i]) / surface.diagonal();
                    if far > 1e-3 {
                        big += 1;
                        if big < 5 {
                            println!("layer {i} {far} {:?} {h:?} {} {:?}", image.certificate[i], p, image.uv[i]);
                        }
                        continue;
                    }
                    worst = worst.max(d);
                    let n = glam::DVec3::from_array(image.normal[i].map(f64::from));
                    let angle = n.cross(h.normal).length().atan2(n.dot(h.normal)).to_degrees();
                    nmax = nmax.max(angle);
                    angles.push(angle);
                }
                (h, p) => {
                    cov += 1;
                    if cov < 5 {
                        println!("cover {i} {h:?} {p} {:?}", image.certificate[i]);
                    }
                }
            }
        }
        angles.sort_by(f64::total_cmp);
        let s = image.summary();
        println!(
            "{path}: covered {covered} coverage differs {cov} layers {big} worst px {worst:.2e} normal p99.9 {:.1e} max {nmax:.1e}; {:?} caster {t:?}",
            angles[angles.len() * 999 / 1000],
            s
        );
    }
}
