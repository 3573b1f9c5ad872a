//! Geometry that is refused, each case with its message and line.

use std::fs;
use std::path::Path;

use catoptric::mesh;

use crate::{QUAD, accepted, refusal};

#[test]
fn a_file_that_is_not_there() {
    let error = mesh::read(Path::new("no/such/file.obj")).unwrap_err();
    assert_eq!(error.to_string(), "no/such/file.obj: no such file: the folder no does not exist; check the path");
}

#[test]
fn a_folder_in_place_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("folder.obj");
    fs::create_dir(&path).unwrap();
    let message = mesh::read(&path).unwrap_err().to_string();
    assert!(message.ends_with("folder.obj: it is a folder, and one mesh is wanted; name a file in it"), "{message}");
}

#[test]
fn another_format() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["car.fbx", "car.usdx", "car", "obj"] {
        let path = folder.path().join(name);
        // What is not there has no format.
        let missing = mesh::read(&path).unwrap_err().to_string();
        assert!(missing.contains(": no such file") && missing.ends_with("; check the path"), "{missing}");
        fs::write(&path, "v 0 0 0\n").unwrap();
        let message = mesh::read(&path).unwrap_err().to_string();
        let name = path.display();
        assert_eq!(
            message,
            format!(
                "{name}: only .obj, .usd, .usda, .usdc and .usdz are read, also with .gz behind; export the mesh as one of these"
            )
        );
    }
}

#[test]
fn a_line_break_in_the_path_stays_one_line() {
    let message = mesh::read(Path::new("a\nb.obj")).unwrap_err().to_string();
    assert_eq!(message, "a\\nb.obj: no such file; check the path");
}

#[test]
fn an_empty_file() {
    assert_eq!(refusal(""), "mesh.obj: the file is empty; export the mesh again");
}

#[test]
fn a_binary_file() {
    let expected = "mesh.obj:1: a NUL byte, so this is not text; give an OBJ in ASCII or UTF-8";
    assert_eq!(refusal(b"\x00\x01\x02".repeat(500)), expected);
    // UTF-16 is half NUL bytes.
    let utf16: Vec<u8> = QUAD.encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert_eq!(refusal(utf16), expected);
    let late = refusal(format!("{QUAD}f 1 2 3 4\n\0"));
    assert!(late.starts_with("mesh.obj:6: a NUL byte"), "{late}");
}

#[test]
fn text_that_is_no_obj() {
    assert_eq!(
        refusal("Dear all,\nplease find attached\n"),
        "mesh.obj: the mesh has no vertices, but unknown keywords (1 Dear, 1 please, the first in line 1), \
         which is not read; give a mesh with polygons"
    );
}

#[test]
fn no_faces() {
    assert_eq!(
        refusal(format!("{QUAD}p 1\nl 1 2 3\n")),
        "mesh.obj: the mesh has no faces, but lines (1 l), points (1 p), which is not read; give a mesh with polygons"
    );
    assert_eq!(refusal(QUAD), "mesh.obj: the mesh has no faces; give a mesh with polygons, not points or curves alone");
}

#[test]
fn a_face_of_no_one_or_two_vertices() {
    for (face, size) in [("f", 0), ("f 1", 1), ("f 1 2", 2)] {
        assert_eq!(
            refusal(format!("{QUAD}f 1 2 3 4\n{face}\n")),
            format!("mesh.obj:6: a face of size {size}; a face needs at least 3 vertices")
        );
    }
}

#[test]
fn a_face_with_too_many_vertices() {
    let mut text: String = (0..65_536).map(|i| format!("v {i} {} 0\n", i * i % 97)).collect();
    text += "f";
    for i in 1..=65_536 {
        text += &format!(" {i}");
    }
    assert_eq!(
        refusal(text),
        "mesh.obj:65537: a face with 65536 vertices, but OpenSubdiv takes at most 65535; split it"
    );
}

#[test]
fn a_vertex_where_too_many_edges_meet() {
    // A fan of 65,536 triangles around vertex 1, closed.
    let mut text = String::from("# fan\nv 0 0 0\n");
    for i in 0..65_536 {
        text += &format!("v {i} 1 0\n");
    }
    for i in 0..65_536 {
        text += &format!("f 1 {} {}\n", i + 2, (i + 1) % 65_536 + 2);
    }
    assert_eq!(
        refusal(text),
        "mesh.obj:2: 65536 edges meet at this vertex, but OpenSubdiv takes at most 65535; \
         split the vertex"
    );
}

#[test]
fn an_edge_where_too_many_faces_meet() {
    // A book of triangles on the edge from vertex 1 to 2, a page more than its spine holds.
    let book = |pages: usize| {
        let mut text = String::from("v 0 0 0\nv 0 0 1\n");
        for i in 0..pages {
            text += &format!("v {i} 1 0\nf 1 2 {}\n", i + 3);
        }
        text
    };
    accepted(&book(65_533));
    assert_eq!(
        refusal(book(65_534)),
        "mesh.obj:1: an edge of this vertex has 65534 faces, but OpenSubdiv takes at most 65533; \
         split the edge"
    );
}

#[test]
fn a_vertex_index_of_zero() {
    assert_eq!(refusal(format!("{QUAD}f 0 1 2\n")), "mesh.obj:5: a face with vertex 0; OBJ counts vertices from 1");
}

#[test]
fn a_vertex_index_too_large() {
    assert_eq!(
        refusal(format!("{QUAD}f 1 2 3 9\n")),
        "mesh.obj:5: a face with vertex 9, but the mesh has only 1 to 4; correct it"
    );
    assert_eq!(
        refusal(format!("{QUAD}f 1 2 3 5\n")),
        "mesh.obj:5: a face with vertex 5, but the mesh has only 1 to 4; correct it"
    );
}

#[test]
fn a_vertex_index_beyond_every_mesh() {
    for index in ["2147483648", "99999999999999999999", "-99999999999"] {
        assert_eq!(
            refusal(format!("{QUAD}f 1 2 3 {index}/7\n")),
            format!("mesh.obj:5: '{index}/7' is not a vertex index of at most 2147483647; correct it")
        );
    }
}

#[test]
fn a_negative_index_before_the_first_vertex() {
    assert_eq!(
        refusal(format!("{QUAD}f -5 -3 -2 -1\n")),
        "mesh.obj:5: a face with vertex -5 (vertices so far: 4); \
         -1 is the latest, use -4 to -1"
    );
    assert_eq!(
        refusal(format!("f -1 2 3\n{QUAD}")),
        "mesh.obj:1: a face with vertex -1 (vertices so far: 0); \
         move the face behind its vertices"
    );
}

#[test]
fn an_index_that_is_no_number() {
    for token in ["x", "1.5", "/2", "1-2", "\u{e9}"] {
        assert_eq!(
            refusal(format!("{QUAD}f 1 2 3 {token}\n")),
            format!("mesh.obj:5: '{token}' is not a vertex index of at most 2147483647; correct it")
        );
    }
}

#[test]
fn a_coordinate_that_is_no_number() {
    assert_eq!(refusal("v 0 0 0\nv 1,5 0 0\nf 1 2 3\n"), "mesh.obj:2: '1,5' is not a coordinate; correct it");
    assert_eq!(refusal(b"v 0 \xff\x07 0\n"), "mesh.obj:1: '\u{fffd}\\u{7}' is not a coordinate; correct it");
}

#[test]
fn a_quotation_is_cut_to_a_readable_length() {
    let message = refusal(format!("v 0 {} 0\n", "z".repeat(100_000)));
    assert_eq!(message, format!("mesh.obj:1: '{}...' is not a coordinate; correct it", "z".repeat(40)));
}

#[test]
fn a_vertex_without_three_coordinates() {
    assert_eq!(refusal("v 0 0 0\n\nv 1 2 # 3\n"), "mesh.obj:3: a vertex with 2 of 3 coordinates; write v x y z");
}

#[test]
fn a_coordinate_that_is_not_finite() {
    // The vertex is refused even though no face uses it.
    assert_eq!(
        refusal(format!("v -1e999 0 0\n{QUAD}f 2 3 4 5\n")),
        "mesh.obj:1: coordinate -inf is not finite; correct the vertex"
    );
}

#[test]
fn a_coordinate_that_a_program_could_not_compute() {
    let computed = |token: &str, cause: &str| {
        format!(
            "mesh.obj:1: coordinate '{token}' is not a number, the program that wrote it {cause}; \
             correct the vertex, or export the mesh again"
        )
    };
    for token in ["nan", "NaN", "-nan", "-nan(ind)", "-1.#IND", "1.#QNAN", "-1.#IND00", "1.#SNAN"] {
        for vertex in [format!("{token} 0 0"), format!("0 {token} 0"), format!("0 0 {token} # last")] {
            assert_eq!(refusal(format!("v {vertex}\n{QUAD}f 2 3 4 5\n")), computed(token, "computed 0/0"));
        }
    }
    for token in ["inf", "-inf", "Infinity", "1.#INF", "-1.#INF00", "1.#J"] {
        assert_eq!(refusal(format!("v 0 0 {token}\n{QUAD}f 2 3 4 5\n")), computed(token, "divided by 0 or overflowed"));
    }
    // Texture coordinates and normals are not read.
    accepted(&format!("{QUAD}vt -1.#IND 0\nvn 1.#QNAN 0 0\nf 1 2 3 4\n"));
    let sharpness = refusal(format!("{QUAD}f 1 2 3 4\nt crease 2/1/0 0 1 1.#QNAN\n"));
    assert_eq!(sharpness, "mesh.obj:6: '1.#QNAN' is not a sharpness; correct it");
}

#[test]
fn a_coordinate_that_overflows() {
    assert_eq!(
        refusal(format!("{QUAD}v 0 0 -2e18\nf 1 2 3 4\n")),
        "mesh.obj:5: coordinate -2e18 is larger than 1e18, where squares overflow; \
         scale the mesh down"
    );
}

#[test]
fn a_repeated_vertex() {
    for face in ["1 2 2 3", "1 2 3 1", "1 2 3 2"] {
        let vertex = if face == "1 2 3 1" { 1 } else { 2 };
        assert_eq!(
            refusal(format!("{QUAD}\nf {face}\n")),
            format!("mesh.obj:6: a face with vertex {vertex} twice; name each vertex of a face once")
        );
    }
}

#[test]
fn a_duplicate_face() {
    for copy in ["1 2 3 4", "3 4 1 2"] {
        assert_eq!(
            refusal(format!("{QUAD}f 1 2 3 4\nf 4 3 2 1\nf {copy}\n")),
            "mesh.obj:7: the same face as line 5; delete one of the two"
        );
    }
}

#[test]
fn the_first_of_several_duplicates_is_reported() {
    let text = format!("{QUAD}v 2 2 2\nf 1 2 3\nf 3 4 5\nf 4 5 3\nf 2 3 1\nf 5 3 4\n");
    assert_eq!(refusal(text), "mesh.obj:8: the same face as line 7; delete one of the two");
}
