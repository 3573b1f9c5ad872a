//! What an OBJ has that is not read: told by name, one line a file. And creases as other programs write them.

use catoptric::mesh::{Corner, Crease};

use crate::{QUAD, accepted, refusal};

const FREE_FORM: &str =
    "cstype bspline\ndeg 3 3\nsurf 0 1 0 1 1 2 3 4 1 2 3 4 1 2 3 4 1 2 3 4\nparm u 0 0 1 1\nparm v 0 0 1 1\nend\n";

fn note(text: &str) -> String {
    let mesh = accepted(&format!("{QUAD}f 1 2 3 4\n{text}"));
    let [note] = &mesh.notes[..] else { panic!("{:?}", mesh.notes) };
    note.clone()
}

#[test]
fn keywords_that_everybody_writes_are_not_told() {
    let text = "# by hand\nmtllib x.mtl\no one\nvt 0 0\nvn 0 0 1\ng a b\nusemtl red\ns off\n#call x.obj\n";
    assert!(accepted(&format!("{text}{QUAD}f 1 2 3 4\n")).notes.is_empty());
}

#[test]
fn everything_else_is_told_with_its_count() {
    let free_form = "passed over: free-form geometry (1 cstype, 1 deg, 1 surf, 2 parm, 1 end)";
    assert_eq!(note(FREE_FORM), free_form);
    assert_eq!(note(&format!("vp 0 0\n{FREE_FORM}")), free_form.replace("(1 cs", "(1 vp, 1 cs"));
    assert_eq!(note("l 1 2\nl 2 3\np 1\n"), "passed over: lines (2 l), points (1 p)");
    assert_eq!(note("call part.obj\ncsh ls\n"), "passed over: other files (1 call), commands (1 csh)");
    assert_eq!(
        note("bsp 1\nbzp 1\ncdc 1\ncdp 1\nres 1 1\n"),
        "passed over: free-form geometry (1 bsp, 1 bzp, 1 cdc, 1 cdp, 1 res)"
    );
    assert_eq!(note("lod 3\nbevel on\n"), "passed over: display attributes (1 lod, 1 bevel)");
    assert_eq!(note("fa 1 2 3\nF 1 2 3\nfa 1 2 3\n"), "passed over: unknown keywords (2 fa, 1 F, the first in line 6)");
    let comments = "# crease 1 2 3.5\n# crease 2 3 1\n# creases are below\n";
    assert_eq!(note(comments), "passed over: comments that say creases (2 # crease, the first in line 6)");
    // Continued lines are one statement; what is told is printable.
    assert_eq!(note("l 1 2 \\\n 3 \\\n 4\n"), "passed over: lines (1 l)");
    assert_eq!(note("\u{1b}[31m\u{7} 1\n"), "passed over: unknown keywords (1 \\u{1b}[31m\\u{7}, the first in line 6)");
    assert_eq!(note("crease 1 2 3\ncr 1 2 3\n"), "passed over: unknown keywords (1 crease, 1 cr, the first in line 6)");
}

#[test]
fn a_text_of_many_words_is_told_in_one_line() {
    let words: String = (0..5000).map(|i| format!("word{i} and more\n")).collect();
    let note = note(&words);
    assert!(note.starts_with("passed over: unknown keywords (1 word0, 1 word1, "), "{note}");
    assert!(note.ends_with("1 word11 and 4988 of others, the first in line 6)"), "{note}");
    assert!(note.len() < 300, "{note}");
}

#[test]
fn a_file_of_free_form_surfaces_alone_says_so() {
    let found = "free-form geometry (1 cstype, 1 deg, 1 surf, 2 parm, 1 end)";
    assert_eq!(
        refusal(format!("{QUAD}{FREE_FORM}")),
        format!("mesh.obj: the mesh has no faces, but {found}, which is not read; give a mesh with polygons")
    );
}

/// Embree's OBJ loader: `ec WEIGHT VERTEX VERTEX`, vertices as in faces.
#[test]
fn edge_creases_as_embree_reads_them() {
    let mesh = accepted(&format!("{QUAD}f 1 2 3 4\nec 2.5 1 2\nec inf -1 -2\nec 0 2/1 3\n"));
    let creases = [([0, 1], 2.5), ([3, 2], 10.0), ([1, 2], 0.0)];
    assert_eq!(mesh.creases, creases.map(|(vertices, sharpness)| Crease { vertices, sharpness }));
    assert_eq!(mesh.notes, ["creases are read from 3 lines of Embree's form, ec WEIGHT VERTEX VERTEX"]);
    for other in ["ec 1 2", "ec 1 2 3 4", "ec a 1 2", "ec nan 1 2", "ec 1 x 2", "ec 1 0 2"] {
        assert_eq!(note(&format!("{other}\n")), "passed over: unknown keywords (1 ec, the first in line 6)", "{other}");
    }
    let refused = |line: &str| refusal(format!("{QUAD}f 1 2 3 4\n{line}\n"));
    assert_eq!(refused("ec -1 1 2"), "mesh.obj:6: sharpness -1 is negative; use 0 (smooth) to 10 (infinitely sharp)");
    assert!(refused("ec 1 1 3").starts_with("mesh.obj:6: a crease from vertex 0 to 2, but no face has that edge"));
    assert!(refused("ec 1 1 9").starts_with("mesh.obj:6: a crease with vertex 8, but"));
}

/// A crease tag may list its edges one after the other, as OpenSubdiv's reader takes it.
#[test]
fn crease_tags_of_pairs() {
    let with = |tag: &str| accepted(&format!("{QUAD}v 2 0 0\nv 2 1 0\nf 1 2 3 4\nf 2 5 6 3\n{tag}\n"));
    let creases = |expected: &[([u32; 2], f32)]| -> Vec<Crease> {
        expected.iter().map(|&(vertices, sharpness)| Crease { vertices, sharpness }).collect()
    };
    let pairs = "1 crease tag read as pairs of vertices, as OpenSubdiv does, not as a chain";
    // Vertices 1 and 5 share no edge.
    let mesh = with("t crease 4/1/0 0 1 5 2 3");
    assert_eq!((mesh.creases, &mesh.notes[..]), (creases(&[([0, 1], 3.0), ([5, 2], 3.0)]), &[pairs.to_owned()][..]));
    // Where both make sense it is a chain.
    let mesh = with("t crease 4/1/0 0 1 2 3 3");
    assert_eq!(mesh.creases, creases(&[([0, 1], 3.0), ([1, 2], 3.0), ([2, 3], 3.0)]));
    assert!(mesh.notes.is_empty() && mesh.corners == [] as [Corner; 0]);
    // And where neither does it is refused.
    let refused = refusal(format!("{QUAD}v 2 0 0\nv 2 1 0\nf 1 2 3 4\nf 2 5 6 3\nt crease 4/1/0 0 1 3 5 3\n"));
    assert!(refused.starts_with("mesh.obj:9: a crease from vertex 1 to 3, but no face has that edge"), "{refused}");
}
