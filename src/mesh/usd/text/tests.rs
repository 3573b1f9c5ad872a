use super::plain;

fn rewritten(text: &str) -> String {
    let plain = String::from_utf8(plain(format!("#usda 1.0\n{text}").as_bytes())).expect("UTF-8");
    assert_eq!(plain.matches('\n').count(), text.matches('\n').count() + 2, "{text}\n{plain}");
    let words: Vec<&str> = plain.split_whitespace().skip(2).collect();
    words.join(" ")
}

#[test]
fn numbers_have_one_form() {
    let points = "point3f[] points = [(.5, 5., +5), (1e3, -.5e-2, -inf), (nan, -nan, 1.e3)]";
    assert_eq!(
        rewritten(points),
        "point3f [ ] points = [ ( 0.5 , 5.0 , 5 ) , ( 1e3 , -0.5e-2 , -inf ) , ( nan , nan , 1.0e3 ) ]"
    );
    assert_eq!(rewritten("int[] ids = [1e3, 5., 1.5, -0.5, 7]"), "int [ ] ids = [ 1000 , 5 , 1 , 0 , 7 ]");
    // The keys of samples are times, whatever the values are.
    assert_eq!(
        rewritten("int[] ids.timeSamples = { .5: [1.], 1.: None, }"),
        "int [ ] ids . timeSamples = { 0.5 : [ 1 ] , 1.0 : None , }"
    );
    assert_eq!(rewritten("(\n metersPerUnit = .01\n)"), "( metersPerUnit = 0.01 )");
}

#[test]
fn comments_go_and_lines_stay() {
    assert_eq!(
        rewritten("# it's\ndef Mesh 'm' // \"\n{ /* { \n\n */ int[] holeIndices = [1, # ]\n2 // ]\n] }"),
        "def Mesh \"m\" { int [ ] holeIndices = [ 1 , 2 ] }"
    );
}

#[test]
fn strings_have_one_form() {
    let mesh = |name: &str| rewritten(&format!("def {name} {{}}"));
    assert_eq!(mesh("'a\"b'"), "def \"a\\\"b\" { }");
    assert_eq!(mesh("\"\"\"a\"b\"\"\""), "def \"a\\\"b\" { }");
    assert_eq!(mesh("'''it\\'s'''"), "def \"it\\'s\" { }");
}

#[test]
fn what_is_not_needed_goes() {
    for gone in [
        "asset inputs:file = \"sky.png\"",
        "float[] weights = edit { [0] = 5. }",
        "asset points = \"points.png\"",
        "custom int x = \"y\" ( doc = \"\"\"a ) b\"\"\" )",
        "float3[] x.timeSamples = { 1: [(1, 2)], 2: <nothing> }",
        "token outputs:surface.connect = </a.b>",
        "rel material:binding = </a> (bindMaterialAs = \"weak\")",
        "reorder properties = [\"a\"]",
        "prepend token größe:a = [[{]}]",
    ] {
        assert_eq!(rewritten(gone), "", "{gone}");
    }
    assert_eq!(
        rewritten("def \"a\" (symmetryFunction =\n foo = bar; active = 1) {}"),
        "def \"a\" ( active = true ) { }"
    );
    let kept = "def \"a\" (\n \"comment\"\n doc = 'b'; active = no; customData = { int a = (1) }\n \
                prepend references = @a@</b> (offset = .5)\n delete inactiveIds = [2])\n{\n}";
    assert_eq!(
        rewritten(kept),
        "def \"a\" ( active = false prepend references = @a@ </b> ( offset = 0.5 ) \
         delete catoptric_inactiveIds = [ 2 ] ) { }"
    );
}

/// What is not understood is left to openusd, and so is what is no USDA.
#[test]
fn what_is_broken_stays() {
    assert_eq!(rewritten("int[] ids = [4, oops"), "int [ ] ids = [ 4 , oops");
    assert_eq!(rewritten("def \"a\" { \"unended"), "def \"a\" { \"unended");
    assert_eq!(rewritten("} % def"), "} % def");
    assert_eq!(plain(b"v 0 0 0"), b"v 0 0 0");
    assert_eq!(plain(b"#usda 2.0\n//"), b"#usda 2.0\n//");
}
