//! Series of pictures as a user meets them: numbers, loops, going on after an interruption.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn command(&self, args: &str) -> Command {
        let mesh = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/corner.obj");
        let mut command = Command::new(env!("CARGO_BIN_EXE_catoptric"));
        command.arg("render").arg(mesh).args(args.split_whitespace()).current_dir(self.0.path());
        command
    }

    fn output(&self, args: &str) -> Output {
        self.command(args).output().expect("the program starts")
    }

    fn done(&self, args: &str) {
        let output = self.output(args);
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{args}: {message}");
        // Standard error is no terminal here, so there is no progress: only what the certificates say, if anything was drawn, and
        // which files were written.
        let known = |line: &str| ["exact: ", "wrote "].iter().any(|start| line.starts_with(start));
        assert!(message.lines().count() <= 2 && message.lines().all(known), "{args}: {message}");
    }

    /// Refused with exit code 2, one line, and all files as before.
    fn refused(&self, args: &str) -> String {
        let before = self.names();
        let output = self.output(args);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{args}: {message}");
        assert_eq!(message.lines().count(), 1, "{args}: {message}");
        assert_eq!(self.names(), before, "{args} left a file");
        message
    }

    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).expect("a readable folder");
        let mut names: Vec<String> =
            entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("UTF-8")).collect();
        names.sort();
        names
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).expect(name)
    }

    fn pixels(&self, name: &str) -> Vec<u8> {
        image::load_from_memory(&self.bytes(name)).expect("a PNG").to_rgba8().into_raw()
    }

    /// When a file was last written, and which one it is.
    fn stamp(&self, name: &str) -> (std::time::SystemTime, u64) {
        use std::os::unix::fs::MetadataExt;
        let data = std::fs::metadata(self.path(name)).expect(name);
        (data.modified().expect("a time"), data.ino())
    }
}

/// Bytes that differ by more than a step of rounding.
fn different(a: &[u8], b: &[u8]) -> usize {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).filter(|(a, b)| a.abs_diff(**b) > 2).count()
}

#[test]
fn frames_are_numbered_and_the_first_is_the_plain_picture() {
    let folder = Folder::new();
    folder.done("--size 64x48 -o plain.png");
    folder.done("--size 64x48 --frames 3 --orbit 360");
    assert_eq!(folder.names(), ["plain.png", "view_0001.png", "view_0002.png", "view_0003.png"]);
    assert!(folder.bytes("plain.png") == folder.bytes("view_0001.png"), "the first frame is another picture");
    folder.done("--size 64x48 --frames 2 --sweep-light -o light-##.png");
    folder.done("--size 64x48 --frames 1 --sweep-light 0.5 -o %02d.png");
    assert!(["light-01.png", "light-02.png", "01.png"].iter().all(|name| folder.path(name).exists()));
    assert!(folder.bytes("plain.png") == folder.bytes("light-01.png"));
    assert!(folder.bytes("plain.png") == folder.bytes("01.png"));
}

/// A turn of 360 degrees in 4 frames is 4 quarters: the same pictures as a turn of 270 degrees in 4, which ends there.
/// Back again is the same in reverse; and the second frame of a full turn in 2 is the third in 4.
#[test]
fn turns_loop_and_partial_turns_arrive() {
    let folder = Folder::new();
    folder.done("--size 64x48 --frames 4 --orbit 360 -o full#.png");
    folder.done("--size 64x48 --frames 4 --orbit 270 -o part#.png");
    folder.done("--size 64x48 --frames 4 --orbit -360 -o back#.png");
    folder.done("--size 64x48 --frames 2 --orbit 360 -o half#.png");
    let pixels = |name: &str| folder.pixels(name);
    for frame in 1..=4 {
        let full = pixels(&format!("full{frame}.png"));
        assert!(different(&full, &pixels(&format!("part{frame}.png"))) < full.len() / 200, "frame {frame}");
        let back = pixels(&format!("back{}.png", (5 - frame) % 4 + 1));
        assert!(different(&full, &back) < full.len() / 200, "frame {frame} backwards");
        let other = pixels(&format!("full{}.png", frame % 4 + 1));
        assert!(different(&full, &other) > full.len() / 20, "frame {frame} is its neighbour");
    }
    assert!(different(&pixels("full3.png"), &pixels("half2.png")) < 64 * 48 * 4 / 200);
}

/// The light comes back after one period: half way there is half way back.
#[test]
fn sweeps_loop() {
    let folder = Folder::new();
    folder.done("--size 64x48 --frames 4 --sweep-light -o on#.png");
    folder.done("--size 64x48 --frames 4 --sweep-light -1 -o back#.png");
    folder.done("--size 64x48 --frames 3 --sweep-light 2.5 -o far#.png");
    let pixels = |name: &str| folder.pixels(name);
    let limit = 64 * 48 * 4 / 200;
    assert!(different(&pixels("on2.png"), &pixels("back4.png")) < limit);
    assert!(different(&pixels("on3.png"), &pixels("back3.png")) < limit);
    assert!(different(&pixels("on1.png"), &pixels("on3.png")) > 4 * limit);
    // 2.5 periods end half a period on.
    assert!(different(&pixels("on3.png"), &pixels("far3.png")) < limit);
}

#[test]
fn resuming_draws_what_is_missing_and_nothing_else() {
    for extension in ["png", "exr"] {
        let folder = Folder::new();
        let flags = format!("--size 48x32 --frames 3 --orbit 90 -o v.{extension}");
        let name = |frame: u32| format!("v_000{frame}.{extension}");
        folder.done(&flags);
        let whole = [1, 2, 3].map(|frame| folder.bytes(&name(frame)));
        std::fs::remove_file(folder.path(&name(2))).expect("it is there");
        let stamps = [1, 3].map(|frame| folder.stamp(&name(frame)));
        folder.done(&format!("{flags} --resume"));
        assert_eq!([1, 3].map(|frame| folder.stamp(&name(frame))), stamps);
        assert!([1, 2, 3].map(|frame| folder.bytes(&name(frame))) == whole, "a frame has changed");
        // Nothing to do.
        let stamp = folder.stamp(&name(2));
        folder.done(&format!("{flags} --resume"));
        assert_eq!(folder.stamp(&name(2)), stamp);

        // Other settings are not mixed with these, unless asked for.
        std::fs::remove_file(folder.path(&name(1))).expect("it is there");
        let message = folder.refused(&format!("{flags} --resume --light-width 0.1"));
        assert!(message.contains(&name(2)) && message.contains("other settings"), "{message}");
        folder.done(&format!("{flags} --light-width 0.1"));
        assert!(folder.bytes(&name(2)) != whole[1], "it is not overwritten");
        std::fs::write(folder.path(&name(3)), "not a picture").expect("a writable folder");
        let message = folder.refused(&format!("{flags} --light-width 0.1 --resume"));
        assert!(message.contains(&name(3)) && message.contains("cannot be read"), "{message}");
    }
    let folder = Folder::new();
    image::RgbaImage::new(4, 4).save(folder.path("v_0001.png")).expect("a writable folder");
    let message = folder.refused("--size 48x32 --frames 2 --orbit 90 -o v.png --resume");
    assert!(message.contains("v_0001.png") && message.contains("does not say"), "{message}");
}

/// The line that tells of frames that are not whole.
fn not_whole(output: &Output) -> String {
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{message}");
    message.lines().find(|line| line.contains("not whole")).unwrap_or_default().to_owned()
}

/// A frame of which a byte has changed, wherever it is, or that ends too early, is drawn again; the others stay.
#[test]
fn frames_that_are_not_whole_are_drawn_again() {
    for extension in ["png", "exr"] {
        let folder = Folder::new();
        let flags = format!("--size 24x16 --frames 2 --orbit 90 -o v.{extension}");
        let [first, second] = [1, 2].map(|frame| format!("v_000{frame}.{extension}"));
        folder.done(&flags);
        let whole = folder.bytes(&second);
        let stamp = folder.stamp(&first);
        // The first bytes, the header, the text that says how it was made, pixels, the end.
        let places = [0, 1, 9, whole.len() / 5, whole.len() / 3, whole.len() / 2, whole.len() - 20, whole.len() - 1];
        for place in places {
            let mut changed = whole.clone();
            changed[place] ^= 0x10;
            std::fs::write(folder.path(&second), changed).expect("a writable folder");
            let line = not_whole(&folder.output(&format!("{flags} --resume")));
            assert!(line.contains("1 frame is") && line.contains(&second), "byte {place} of {extension}: {line}");
            assert!(folder.bytes(&second) == whole, "byte {place} of {extension} is not mended");
        }
        for length in [0, whole.len() / 2, whole.len() - 1] {
            std::fs::write(folder.path(&second), &whole[..length]).expect("a writable folder");
            assert!(
                not_whole(&folder.output(&format!("{flags} --resume"))).contains(&second),
                "{length} of {extension}"
            );
            assert!(folder.bytes(&second) == whole, "{length} bytes of {extension} are not mended");
        }
        let longer = [&whole[..], b"more"].concat();
        std::fs::write(folder.path(&second), longer).expect("a writable folder");
        assert!(not_whole(&folder.output(&format!("{flags} --resume"))).contains(&second));
        assert_eq!(folder.stamp(&first), stamp, "the whole frame is drawn again");
        assert_eq!(not_whole(&folder.output(&format!("{flags} --resume"))), "");
    }
}

/// Of two runs that draw one series together one is refused, whatever their settings; what is there in the end is of one of them.
#[test]
fn one_run_at_a_time_draws_a_series() {
    let folder = Folder::new();
    let flags = "--size 128x128 --frames 12 --orbit 360 -o v.exr --resume";
    let widths = ["--light-width 0.1", "--light-width 0.2", "--light-width 0.1"];
    let start = |more: &&str| {
        let mut command = folder.command(&format!("{flags} {more}"));
        command.stderr(Stdio::piped()).stdout(Stdio::null()).spawn().expect("the program starts")
    };
    let children: Vec<_> = widths.iter().map(start).collect();
    let outputs: Vec<Output> = children.into_iter().map(|child| child.wait_with_output().expect("a child")).collect();
    let done: Vec<usize> = (0..widths.len()).filter(|&k| outputs[k].status.success()).collect();
    assert!(!done.is_empty(), "none is done");
    for output in outputs.iter().filter(|output| !output.status.success()) {
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        let is_refusal =
            message.contains("another run is drawing this series (process ") || message.contains("other settings");
        assert!(message.lines().count() == 1 && is_refusal, "{message}");
    }
    // All frames are those of one run.
    assert_eq!(folder.names().len(), 12);
    let again = folder.output(&format!("{flags} {}", widths[done[0]]));
    assert!(again.status.success(), "{}", String::from_utf8_lossy(&again.stderr));
}

/// A run that was killed holds nobody up, and what it was writing goes with the next one.
#[test]
fn what_killed_runs_leave_is_taken_over() {
    let folder = Folder::new();
    let flags = "--size 256x256 --frames 40 --orbit 360 -o v.exr";
    let mut child = folder.command(flags).stderr(Stdio::null()).spawn().expect("the program starts");
    while !folder.path("v_0002.exr").exists() {
        assert!(child.try_wait().expect("a child").is_none(), "it was faster");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    // While it lives, others are refused, also those that would write over its frames.
    let message = folder.output("--size 32x32 --frames 2 --orbit 90 -o v_##.exr");
    assert_eq!(message.status.code(), Some(2), "{}", String::from_utf8_lossy(&message.stderr));
    child.kill().expect("a child");
    child.wait().expect("a child");
    let lock = folder.names().into_iter().find(|name| name.ends_with(".lock")).expect("a lock");
    assert!(lock.starts_with(".catoptric-v_#.exr"), "{lock}");
    // A file that is being written, and one that was an hour ago.
    let old = std::time::SystemTime::now() - std::time::Duration::from_secs(3600);
    for name in [".catoptric-old000.part", ".catoptric-held00.part"] {
        let file = std::fs::File::create(folder.path(name)).expect("a writable folder");
        file.set_modified(old).expect("its owner");
    }
    std::fs::write(folder.path(".catoptric-new000.part"), "").expect("a writable folder");
    let held = std::fs::File::open(folder.path(".catoptric-held00.part")).expect("it is there");
    held.lock().expect("a lock");
    let stamp = folder.stamp("v_0001.exr");
    folder.done(&format!("{flags} --resume"));
    assert_eq!(folder.stamp("v_0001.exr"), stamp);
    let hidden: Vec<String> = folder.names().into_iter().filter(|name| name.starts_with('.')).collect();
    let others = [".catoptric-held00.part", ".catoptric-new000.part"];
    // What the killed run was writing is not a minute old.
    assert!(others.iter().all(|name| hidden.iter().any(|hidden| hidden == name)), "{hidden:?}");
    assert!(!hidden.iter().any(|name| name.ends_with(".lock") || name == ".catoptric-old000.part"), "{hidden:?}");
}

/// The mesh is part of the settings, whatever its file is called.
#[test]
fn another_mesh_of_the_same_name_is_noticed() {
    let folder = Folder::new();
    let quad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 Z\nf 1 2 3 4\n";
    let run = |z: &str, more: &[&str]| {
        std::fs::write(folder.path("m.obj"), quad.replace('Z', z)).expect("a writable folder");
        let mut command = Command::new(env!("CARGO_BIN_EXE_catoptric"));
        command.current_dir(folder.path("."));
        command.args(["render", "m.obj", "--size", "32x32", "--frames", "2", "--sweep-light"]).args(more);
        command.args(["--eye=3,3,3", "--light-spacing=1", "--light-center=0,0,9", "--target=0,0,0"]);
        command.args(["--light-normal=0,0,1", "--light-lines=0,1,0"]).output().expect("the program starts")
    };
    assert!(run("0", &[]).status.success());
    assert!(run("0", &["--resume"]).status.success());
    assert_eq!(run("0.25", &["--resume"]).status.code(), Some(2));
}

/// On the sphere lights go round: by a stripe that is the first picture again, by half a stripe another one.
#[test]
fn spheres_turn() {
    let folder = Folder::new();
    folder.done("--size 160x120 --frames 2 --sweep-light 2 --rig zebra --light-spacing 24 -o two.png");
    folder.done("--size 160x120 --frames 2 --sweep-light --rig zebra --light-spacing 24 -o half.png");
    let [a, b, c] = ["two_0001.png", "two_0002.png", "half_0002.png"].map(|name| folder.pixels(name));
    assert!(different(&a, &b) < a.len() / 200, "{}", different(&a, &b));
    assert!(different(&a, &c) > a.len() / 20, "{}", different(&a, &c));
}

/// What the files say makes them again.
#[test]
fn files_carry_the_command_that_makes_them() {
    let folder = Folder::new();
    folder.done("--size 64x48 --frames 3 --orbit 100 --projection orthographic --pattern circles --samples 1");
    let decoder = png::Decoder::new(std::io::Cursor::new(folder.bytes("view_0002.png")));
    let reader = decoder.read_info().expect("a PNG");
    let text = reader.info().utf8_text.iter().find(|text| text.keyword == "catoptric").expect("a text");
    let text = text.get_text().expect("it is plain");
    let (command, digests) = text.split_once(", mesh ").expect("digests");
    let (command, version) = command.split_once(" # ").expect("a comment");
    assert!(version == concat!("catoptric ", env!("CARGO_PKG_VERSION")) && !digests.contains("pattern"), "{text}");
    let flags = command.split_once("corner.obj ").expect("the mesh").1;
    folder.done(&format!("{flags} -o again.png"));
    let [a, b] = ["view_0002.png", "again.png"].map(|name| folder.pixels(name));
    assert!(a == b, "{flags} draws another picture");
}

#[test]
fn bad_series_are_refused() {
    let folder = Folder::new();
    for (args, expected) in [
        ("--frames 0 --orbit 360", "0"),
        ("--frames 10", "--orbit"),
        ("--orbit 360", "--frames N"),
        ("--sweep-light", "--frames N"),
        ("--resume", "--frames N"),
        ("--frames 3 --orbit 360 --sweep-light", "two series"),
        ("--frames 3 --sweep-light --field isophote", "changes nothing of isophote"),
        ("--frames 3 --sweep-light --field curvature", "changes nothing of curvature"),
        ("--frames 3 --sweep-light --field curve:circle", "has no period for curve:circle"),
        ("--frames 3 --sweep-light --field highlight:signed", "has no period for highlight:signed"),
        ("--frames 3 --sweep-light --field highlight:pseudo", "has no period for highlight:pseudo"),
        ("--frames 3 --sweep-light --field highlight:alternative=0.1", "has no period for highlight:alternative=0.1"),
        ("--frames 3 --orbit 0", "other than 0"),
        ("--frames 3 --orbit nan", "other than 0"),
        ("--frames 3 --sweep-light inf", "other than 0"),
        ("--frames 3 --orbit 360 -o #_#.png", "#_#.png: cannot number"),
        ("--frames 3 --orbit 360 -o no-such-folder/v.png", "no-such-folder"),
        ("--frames 3 --orbit 360 -o v.gif", ".png or .exr"),
    ] {
        let message = folder.refused(args);
        assert!(message.contains(expected), "{args}: {message}");
    }
}

/// Interrupted in the middle of a series: every file that is there is whole, none is left half written, and the rest
/// is drawn later.
#[test]
fn interrupted_series_leave_whole_files() {
    let folder = Folder::new();
    let flags = "--size 256x256 --frames 40 --orbit 360 -o v.exr";
    // Whoever runs the tests may ignore it (`&` in a script), and what is ignored when a program starts stays ignored.
    let plain = folder.command(flags);
    let mut child = Command::new("env");
    child.arg("--default-signal=INT").arg(plain.get_program()).args(plain.get_args()).current_dir(folder.path("."));
    let mut child = child.stderr(Stdio::null()).spawn().expect("the program starts");
    for _ in 0..6000 {
        if folder.path("v_0002.exr").exists() || child.try_wait().expect("a child").is_some() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let stopped = Command::new("sh").args(["-c", &format!("kill -INT {}", child.id())]).status();
    assert!(stopped.expect("a shell").success());
    assert!(!child.wait().expect("a child").success());
    let names = folder.names();
    println!("{} frames before the interruption", names.len());
    assert!((2..40).contains(&names.len()), "{names:?}");
    assert!(names.iter().all(|name| name.starts_with("v_00") && name.ends_with(".exr")), "{names:?}");
    for name in &names {
        let file = exr::prelude::read_all_flat_layers_from_file(folder.path(name));
        assert!(file.is_ok(), "{name} is not whole");
    }
    let stamp = folder.stamp("v_0001.exr");
    folder.done(&format!("{flags} --resume"));
    assert_eq!((folder.names().len(), folder.stamp("v_0001.exr")), (40, stamp));
}
