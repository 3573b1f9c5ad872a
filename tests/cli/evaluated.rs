//! `eval`: answers in order, the same from all evaluators.

use super::{Folder, mesh};
use std::path::Path;

/// Rows of a CSV file that `eval` wrote: numbers, and the kind.
fn rows(path: &Path) -> Vec<(Vec<f64>, String)> {
    let mut reader = csv::Reader::from_path(path).expect("a CSV file");
    let header = reader.headers().expect("a header").iter().collect::<Vec<_>>().join(",");
    assert_eq!(header, "face,u,v,x,y,z,xu,yu,zu,xv,yv,zv,nx,ny,nz,kind");
    let row = |row: Result<csv::StringRecord, csv::Error>| {
        let row = row.expect("a row");
        let numbers = row.iter().take(15).filter(|x| !x.is_empty()).map(|x| x.parse().expect("a number")).collect();
        (numbers, row[15].to_owned())
    };
    reader.into_records().map(row).collect()
}

#[test]
fn evaluators_answer_in_order_and_agree() {
    let folder = Folder::new();
    let samples = folder.file("samples.csv", "face,u,v\n0,0.5,0.25\n3,0.125,0.5\n5,1,0.125\n2,0.3,0.9\n");
    let mut tables = Vec::new();
    for backend in ["cpu", "gpu", "osd"] {
        let out = folder.path("out.csv");
        let args = ["eval", "--samples", samples.to_str().expect("UTF-8"), "-o", "out.csv", "--backend", backend];
        let output = folder.run(args.iter().copied().chain([mesh("cube").to_str().expect("UTF-8")]));
        assert!(output.status.success(), "{backend}: {}", String::from_utf8_lossy(&output.stderr));
        tables.push(rows(&out));
    }
    for table in &tables {
        assert_eq!(table.iter().map(|(numbers, _)| numbers[0]).collect::<Vec<_>>(), [0.0, 3.0, 5.0, 2.0]);
        for ((numbers, kind), (reference, _)) in table.iter().zip(&tables[0]) {
            assert_eq!(kind, "smooth");
            for (a, b) in numbers.iter().zip(reference) {
                // f32 on the GPU: 2e-6 of the cube's diagonal, a few times that in derivatives.
                assert!((a - b).abs() < 2e-5, "{numbers:?} {reference:?}");
            }
        }
    }
}

#[test]
fn the_smallest_parameters_come_back_and_have_answers() {
    let folder = Folder::new();
    folder.file("samples.csv", "face,u,v\n0,5e-324,5e-324\n0,1e-305,1e-305\n0,1e-300,0.1\n0,0.30000000000000004,1\n");
    for backend in ["cpu", "gpu", "osd"] {
        let mesh = mesh("cube");
        let flags = ["eval", "--samples", "samples.csv", "-o", "out.csv", "--backend", backend];
        let output = folder.run(flags.iter().copied().chain([mesh.to_str().expect("UTF-8")]));
        assert!(output.status.success(), "{backend}: {}", String::from_utf8_lossy(&output.stderr));
        let text = std::fs::read_to_string(folder.path("out.csv")).expect("it is written");
        let places: Vec<_> =
            text.lines().skip(1).map(|line| line.split(',').take(3).collect::<Vec<_>>().join(",")).collect();
        assert_eq!(places, ["0,5e-324,5e-324", "0,1e-305,1e-305", "0,1e-300,0.1", "0,0.30000000000000004,1"]);
        let rows = rows(&folder.path("out.csv"));
        assert!(rows.iter().all(|(numbers, _)| numbers.iter().all(|x| x.is_finite())), "{backend}: {text}");
    }
}

#[test]
fn holes_have_a_kind_and_no_numbers() {
    let folder = Folder::new();
    let samples = folder.file("samples.csv", "face,u,v\n5,0.5,0.5\n0,0.5,0.5\n");
    for backend in ["cpu", "gpu", "osd"] {
        let (mesh, samples) = (mesh("hole"), samples.as_path());
        let args = ["eval", mesh.to_str().expect("UTF-8"), "--samples", samples.to_str().expect("UTF-8")];
        let output = folder.run(args.iter().chain(&["-o", "out.csv", "--backend", backend]));
        assert!(output.status.success());
        let rows = rows(&folder.path("out.csv"));
        assert_eq!((rows[0].0.len(), rows[0].1.as_str()), (3, "hole"));
        assert_eq!((rows[1].0.len(), rows[1].1.as_str()), (15, "regular"));
    }
}
