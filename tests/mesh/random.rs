//! Noise is refused with one line, or accepted as a mesh that validates; it never panics.

use proptest::prelude::*;

use crate::read_text;

fn check(text: &[u8]) -> Result<(), TestCaseError> {
    match read_text(text) {
        Ok(mesh) => {
            prop_assert!(mesh.validate().is_ok());
            prop_assert!(mesh.diagonal().is_finite());
        }
        Err(error) => prop_assert_eq!(error.to_string().lines().count(), 1),
    }
    Ok(())
}

fn token() -> impl Strategy<Value = String> {
    let word = prop::sample::select(vec![
        "v",
        "f",
        "t",
        "fo",
        "g",
        "vt",
        "#",
        "\\",
        "\n",
        "\n",
        "\n",
        "\r\n",
        "crease",
        "corner",
        "hole",
        "interpolateboundary",
        "creasemethod",
        "chaikin",
        "smoothtriangles",
        "2/1/0",
        "1/1/0",
        "1/0/0",
        "0/0/1",
        "3/2/0",
        "nan",
        "-inf",
        "1e400",
        "1//2",
        "0",
        "-1",
        "99999999999999999999",
        "\u{e9}",
    ]);
    prop_oneof![
        4 => word.prop_map(str::to_owned),
        2 => (-3..9_i32).prop_map(|n| n.to_string()),
        1 => any::<f64>().prop_map(|x| x.to_string()),
    ]
}

/// A line that is nearly right, so that noise also comes past the parser.
fn near_line() -> impl Strategy<Value = String> {
    let index = || -1..12_u32 as i32;
    prop_oneof![
        6 => prop::array::uniform3(-9.0..9.0_f64).prop_map(|[x, y, z]| format!("v {x} {y} {z}\n")),
        4 => prop::collection::vec(index(), 2..6).prop_map(|face| {
            let face: Vec<_> = face.iter().map(i32::to_string).collect();
            format!("f {}\n", face.join(" "))
        }),
        1 => (index(), index(), -1.0..12.0_f32).prop_map(|(a, b, s)| format!("t crease 2/1/0 {a} {b} {s}\n")),
        1 => (index(), -1.0..12.0_f32).prop_map(|(a, s)| format!("t corner 1/1/0 {a} {s}\n")),
        1 => index().prop_map(|face| format!("t hole 1/0/0 {face}\n")),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn bytes(text in prop::collection::vec(any::<u8>(), 0..400)) {
        check(&text)?;
    }

    #[test]
    fn tokens(tokens in prop::collection::vec(token(), 0..120)) {
        check(tokens.join(" ").as_bytes())?;
    }

    #[test]
    fn near_meshes(lines in prop::collection::vec(near_line(), 0..24)) {
        check(lines.concat().as_bytes())?;
    }
}
