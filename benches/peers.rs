//! The contests of `catoptric bench` on the sample, by criterion: to see whether a change makes something faster or slower.
//!
//! `cargo bench --features peers [-- NAME]`; without the feature (and libembree-dev) there is no Embree. Ratios are those of
//! `catoptric bench`, where contestants take turns; here each has its time by itself.

use catoptric::bench::{Effort, Work, contests};
use catoptric::gpu::Gpu;
use catoptric::mesh::sample;
use criterion::{Criterion, criterion_group, criterion_main};

fn peers(criterion: &mut Criterion) {
    let (mesh, gpu) = (sample(), Gpu::new().expect("an adapter"));
    let effort = Effort { samples: 1 << 14, ..Effort::FULL };
    for work in Work::ALL {
        for mut contest in contests(work, &mesh, effort, Some(&gpu)).expect("all take the sample") {
            let mut group = criterion.benchmark_group(contest.name());
            group.sample_size(20);
            for (name, work) in contest.contestants() {
                group.bench_function(name, |bencher| bencher.iter(&mut *work));
            }
            group.finish();
        }
    }
}

criterion_group!(benches, peers);
criterion_main!(benches);
