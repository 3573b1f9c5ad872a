//! Arguments that are wrong: one line that says which, what was meant, and whose help to look at.

use super::Folder;

#[test]
fn options_and_values_that_are_misspelt_have_suggestions() {
    let folder = Folder::new();
    for (args, line) in [
        ("render --sizes 10x10", "render has no option --sizes; did you mean --size? See catoptric render --help"),
        ("render -size 9x9", "render has no option -size; did you mean --size? See catoptric render --help"),
        (
            "render --pattren stripes",
            "render has no option --pattren; did you mean --pattern? See catoptric render --help",
        ),
        (
            "lines --levels 3",
            "lines has no option --levels, which is one of info; leave it out; see catoptric lines --help",
        ),
        ("--samples-out x", "--samples-out is an option of verify; write it after the command; see catoptric --help"),
        ("rendr cube.obj", "no command 'rendr'; did you mean render? See catoptric --help"),
        ("help rendr", "no command 'rendr'; did you mean render? See catoptric --help"),
        (
            "render --pipeline exat",
            "--pipeline has no value 'exat' (did you mean exact?); give exact, limit, polygon or points; see catoptric render --help",
        ),
        ("render --size", "--size needs a value; write --size <WxH>; see catoptric render --help"),
        ("render --size 10", "--size 10: give WIDTHxHEIGHT, each 1 to 8192; see catoptric render --help"),
        ("render --samples 9", "--samples 9: give a whole number from 1 to 4; see catoptric render --help"),
        ("render --frames many", "--frames many: give a whole number; see catoptric render --help"),
        (
            "render --frames -1",
            "-1 begins as an option does; if it is meant for --frames, write --frames=-1; see catoptric render --help",
        ),
        ("render --frames=-1", "--frames -1: give a whole number from 1 to 100000; see catoptric render --help"),
        ("render --size 9x9 --size 8x8", "--size is given twice; give it once; see catoptric render --help"),
        ("eval", "eval needs --samples <FILE>; add it; see catoptric eval --help"),
        ("verify --partial", "what is given needs --results <FILE>; add it; see catoptric verify --help"),
        (
            "verify --only 0,0,0 --junit x",
            "--only does not go with --junit; leave one of them out; see catoptric verify --help",
        ),
        (
            "info --memory-limit lots",
            "--memory-limit lots: give a size such as 6GiB or 500MB; see catoptric info --help",
        ),
        ("completions tcl", "SHELL has no value 'tcl'"),
    ] {
        let words: Vec<&str> = args.split_whitespace().collect();
        let message = folder.refused(&words);
        let line = format!("catoptric: {line}");
        assert!(
            message.trim_end() == line || line.ends_with("'tcl'") && message.starts_with(&line),
            "{args}: {message}"
        );
    }
    for (args, part) in [
        ("", "no command; give render, lines, eval,"),
        ("frobnicate", "no command 'frobnicate'; give render, lines, eval,"),
        ("render a.obj b.obj", "render has no use for 'b.obj'"),
        ("render -x", "render has no option -x"),
        ("render --field relfection", "--field relfection: did you mean reflection?"),
        ("render --pattern strips", "strips: no pattern has this name (did you mean stripes?), and no file"),
        ("render --rig tunel", "--rig tunel: no light rig has this name (did you mean tunnel?)"),
        ("bench --only frames", "--only frames: no row has this name (did you mean frame?)"),
        ("quality --ignore crease", "--ignore has no value 'crease' (did you mean creases?)"),
    ] {
        let words: Vec<&str> = args.split_whitespace().collect();
        let message = folder.refused(&words);
        assert!(message.contains(part), "{args}: {message}");
    }
}
