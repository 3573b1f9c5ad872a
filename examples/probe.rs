//! scratch
use catoptric::{
    mesh,
    osd::{Answer, Far, Reference},
    stam::LimitSurface,
};
use std::collections::BTreeMap;
fn main() {
    for path in std::env::args().skip(1) {
        let m = match mesh::read(path.as_ref()) {
            Ok(m) => m,
            Err(e) => {
                println!("{path}: {e}");
                continue;
            }
        };
        let t = std::time::Instant::now();
        let s = match LimitSurface::new(&m) {
            Ok(s) => s,
            Err(e) => {
                println!("{path}: {e}");
                continue;
            }
        };
        let t1 = t.elapsed();
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for p in s.patches() {
            *counts.entry(p.kind.name()).or_default() += 1;
        }
        println!("{} {:?} {:?} diag {} classes {}", m.name, t1, counts, s.diagonal(), s.classes().len());
        let t = std::time::Instant::now();
        let mut far = Far::new(&m, 10).unwrap();
        let t2 = t.elapsed();
        let mut samples = vec![];
        for f in 0..s.ptex_count() as u32 {
            for k in [1u32, 2, 4, 64, 1024] {
                let step = if k > 4 { k / 2 - 1 } else { 1 };
                let mut i = 0;
                while i <= k {
                    let mut j = 0;
                    while j <= k {
                        samples.push((f, i as f64 / k as f64, j as f64 / k as f64));
                        j += step;
                    }
                    i += step;
                }
            }
        }
        let r = far.evaluate(&samples).unwrap();
        let mut worst: BTreeMap<(&str, &str), (usize, f64, f64, f64, u32, f64, f64)> = BTreeMap::new();
        for (x, r) in samples.iter().zip(&r) {
            let e = s.evaluate_ptex(x.0, [x.1, x.2]);
            let Some((p, j)) = e else {
                if r.answer != Answer::None {
                    println!("hole mismatch {x:?}");
                }
                continue;
            };
            if r.answer == Answer::None {
                println!("hole mismatch2 {x:?}");
                continue;
            }
            let d = (j.position - r.position).length() / s.diagonal();
            let dd = ((j.du - r.du).length().max((j.dv - r.dv).length())) / s.diagonal();
            let n = r.du.cross(r.dv).normalize_or_zero();
            let a = n.cross(j.normal).length().atan2(n.dot(j.normal)).to_degrees();
            let w = worst.entry((s.kind(p).name(), if r.answer == Answer::Regular { "R" } else { "E" })).or_default();
            w.0 += 1;
            w.2 = w.2.max(dd);
            w.3 = w.3.max(a);
            if d > w.1 {
                w.1 = d;
                w.4 = x.0;
                w.5 = x.1;
                w.6 = x.2;
            }
        }
        for (k, w) in worst {
            println!(
                "    {:8} {} n={:6} pos {:.2e} der {:.2e} ang {:.2e}  worst face {} u {} v {}",
                k.0, k.1, w.0, w.1, w.2, w.3, w.4, w.5, w.6
            );
        }
        println!("    far {t2:?} ");
    }
}
