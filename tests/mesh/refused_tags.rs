//! Tags that are refused, each case with its message and line.

use crate::{QUAD, refusal};

/// Refusal of one tag behind a single quad; the tag is on line 6.
fn refused(tag: &str) -> String {
    let message = refusal(format!("{QUAD}f 1 2 3 4\n{tag}\n"));
    let (place, rest) = message.split_at("mesh.obj:6: ".len());
    assert_eq!(place, "mesh.obj:6: ");
    rest.to_owned()
}

#[test]
fn a_crease_at_a_vertex_that_is_not_there() {
    assert_eq!(refused("t crease 2/1/0 0 99 3"), "a crease with vertex 99, but the mesh has only 0 to 3; count from 0");
    assert_eq!(refused("t crease 2/1/0 4 3 3"), "a crease with vertex 4, but the mesh has only 0 to 3; count from 0");
}

#[test]
fn a_crease_on_one_vertex() {
    assert_eq!(refused("t crease 3/1/0 0 1 1 3"), "a crease from vertex 1 to itself; name the two ends of an edge");
}

#[test]
fn a_crease_that_is_no_edge() {
    assert_eq!(
        refused("t crease 3/1/0 1 0 2 3"),
        "a crease from vertex 0 to 2, but no face has that edge; count from 0"
    );
}

#[test]
fn sharpness_that_is_not_finite() {
    for (token, value) in [("nan", "NaN"), ("inf", "inf"), ("-inf", "-inf"), ("1e39", "inf")] {
        let expected = format!("sharpness {value} is not finite; use 0 (smooth) to 10 (infinitely sharp)");
        assert_eq!(refused(&format!("t crease 2/1/0 0 1 {token}")), expected);
        assert_eq!(refused(&format!("t corner 1/1/0 2 {token}")), expected);
    }
}

#[test]
fn sharpness_that_is_negative() {
    let expected = "sharpness -0.5 is negative; use 0 (smooth) to 10 (infinitely sharp)";
    assert_eq!(refused("t crease 2/1/0 0 1 -0.5"), expected);
    assert_eq!(refused("t corner 2/2/0 2 3 1 -0.5"), expected);
}

#[test]
fn sharpness_that_is_no_number() {
    assert_eq!(refused("t crease 2/1/0 0 1 sharp"), "'sharp' is not a sharpness; correct it");
}

#[test]
fn a_corner_that_is_not_there() {
    assert_eq!(refused("t corner 1/1/0 4 2"), "a corner at vertex 4, but the mesh has only 0 to 3; count from 0");
}

#[test]
fn a_hole_that_is_not_there() {
    assert_eq!(refused("t hole 2/0/0 0 7"), "a hole at face 7, but the mesh has only 0 to 0; count from 0");
}

#[test]
fn an_index_that_no_mesh_can_have() {
    assert_eq!(refused("t crease 2/1/0 0 -1 3"), "the crease tag has index -1; use 0 to 2147483647");
    assert_eq!(refused("t corner 1/1/0 2147483648 3"), "the corner tag has index 2147483648; use 0 to 2147483647");
    assert_eq!(refused("t hole 1/0/0 -2"), "the hole tag has index -2; use 0 to 2147483647");
    assert_eq!(refused("t hole 1/0/0 0.5"), "'0.5' is not an index; correct it");
}

#[test]
fn a_truncated_tag() {
    assert_eq!(refused("t crease 2/1/0 0"), "the crease tag announces 3 values and has 1; correct its counts");
    assert_eq!(refused("t hole 3/0/0 0"), "the hole tag announces 3 values and has 1; correct its counts");
    assert_eq!(refused("t crease 2/1/0 0 1 3 4"), "the crease tag announces 3 values and has 4; correct its counts");
    let huge = usize::MAX;
    assert_eq!(
        refused(&format!("t hole {huge}/{huge}/1 0")),
        format!("the hole tag announces {huge} values and has 1; correct its counts")
    );
}

#[test]
fn a_tag_without_a_header() {
    for tag in ["t", "t crease", "t crease 2/1", "t crease 2/1/0/0 0 1 3", "t crease a/b/c", "t hole -1/0/0"] {
        assert_eq!(
            refused(tag),
            "a tag without a name and counts; \
             write t NAME INTS/FLOATS/STRINGS and then as many values"
        );
    }
}

#[test]
fn counts_that_a_tag_does_not_take() {
    assert_eq!(
        refused("t crease 1/1/0 0 3"),
        "the crease tag has 1/1/0 ints/floats/strings; \
         it takes a chain of 2 ints or more, and one float or one an edge"
    );
    assert_eq!(
        refused("t crease 2/2/0 0 1 3 3"),
        "the crease tag has 2/2/0 ints/floats/strings; \
         it takes a chain of 2 ints or more, and one float or one an edge"
    );
    assert_eq!(
        refused("t corner 2/0/0 0 1"),
        "the corner tag has 2/0/0 ints/floats/strings; \
         it takes one int or more, and one float or one an int"
    );
    assert_eq!(refused("t hole 0/1/0 0"), "the hole tag has 0/1/0 ints/floats/strings; it takes ints alone");
    assert_eq!(
        refused("t interpolateboundary 2/0/0 0 1"),
        "the interpolateboundary tag has 2/0/0 ints/floats/strings; it takes one int"
    );
    assert_eq!(
        refused("t creasemethod 0/0/0"),
        "the creasemethod tag has 0/0/0 ints/floats/strings; it takes one string"
    );
}

#[test]
fn an_unknown_tag() {
    assert_eq!(
        refused("t craese 2/1/0 0 1 3"),
        "tag 'craese' is unknown; \
         use crease, corner, hole, interpolateboundary, creasemethod or scheme"
    );
}

#[test]
fn a_rule_that_is_unknown() {
    for value in ["3", "-1", "nan", "x"] {
        assert_eq!(
            refused(&format!("t interpolateboundary 1/0/0 {value}")),
            format!(
                "interpolateboundary '{value}' is not supported; \
                 use 0 (none), 1 (edge and corner) or 2 (edge only)"
            )
        );
    }
    assert_eq!(refused("t creasemethod 0/0/1 sharp"), "creasemethod 'sharp' is not supported; use normal or chaikin");
}

#[test]
fn rules_for_triangles_that_there_are_not() {
    assert_eq!(
        refused("t smoothtriangles 0/0/1 round"),
        "smoothtriangles 'round' is not supported; use catmark or smooth"
    );
}
