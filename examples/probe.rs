//! scratch
use catoptric::{
    mesh,
    osd::{Answer, Bfr, Far, Reference},
};
fn main() {
    for path in std::env::args().skip(1) {
        let Ok(m) = mesh::read(path.as_ref()) else { continue };
        eprintln!("=== {path}");
        let n: u32 = m.face_sizes.iter().map(|&n| if n == 4 { 1 } else { n }).sum();
        let samples: Vec<_> = (0..n).flat_map(|f| [(f, 0.0, 0.0), (f, 1.0, 1.0), (f, 0.3, 0.7)]).collect();
        for levels in [(2, 6)] {
            let r = Bfr::new(&m, levels).unwrap().evaluate(&samples).unwrap();
            eprintln!("not asked {}", r.iter().filter(|r| r.answer == Answer::NotAsked).count());
        }
        let _ = Far::new(&m, 4).unwrap().evaluate(&samples).unwrap();
    }
}
