//! The HTML report: well formed, complete in itself, and what a browser makes of it.

use super::{folder, run, text};
use base64::Engine;
use scraper::{ElementRef, Html, Selector};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Parses the report of a run that ends with this exit code; it must be well formed.
fn report(folder: &Path, words: &[&str], code: i32) -> (String, Html) {
    let output = run(folder, &[words, &["--html", "report.html"]].concat());
    assert_eq!(output.status.code(), Some(code), "{}{}", text(&output.stdout), text(&output.stderr));
    let page = fs::read_to_string(folder.join("report.html")).expect("it is written");
    let html = Html::parse_document(&page);
    assert!(html.errors.is_empty(), "{:?}", html.errors);
    (page, html)
}

fn all<'a>(html: &'a Html, selector: &str) -> Vec<ElementRef<'a>> {
    html.select(&Selector::parse(selector).expect("a selector")).collect()
}

fn words(element: ElementRef<'_>) -> String {
    element.text().collect::<String>().split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn a_page_has_everything_and_needs_nothing() {
    let folder = folder(&["m/dart", "m/pole_5", "m/valence_2_interior"]);
    fs::write(folder.path().join("m/bad.obj"), "f").expect("it is written");
    let (page, html) = report(folder.path(), &["m", "--allow-refused", "--json", "v.json"], 0);
    let json = super::json(&folder.path().join("v.json"));
    assert_eq!(words(all(&html, "#verdict strong")[0]), "Pass");
    assert_eq!((all(&html, "#meshes tr.mesh").len(), all(&html, "#meshes tr.refused").len()), (3, 1));
    // Every row of the JSON, with its reason where the reference is wrong.
    for (body, mesh) in all(&html, "details .body").iter().zip(json["meshes"].as_array().expect("a list")) {
        let rows = |key: &str| mesh[key].as_array().expect("a list").len();
        let within = |selector: &str| body.select(&Selector::parse(selector).expect("a selector")).count();
        assert_eq!(within("table.rows tbody tr:not(.reason)"), rows("tiers") + rows("reference_known_wrong"));
        assert_eq!(within("table.rows tr.reason"), rows("reference_known_wrong"));
        assert_eq!(within("table.rows .badge.known"), rows("reference_known_wrong"));
        assert_eq!((within("svg.histogram"), within("img"), within("svg.legend")), (2, 6, 4));
    }
    // Links lead somewhere.
    let ids: BTreeSet<_> = all(&html, "[id]").iter().filter_map(|e| e.attr("id")).collect();
    let links: Vec<_> = all(&html, "a").iter().map(|a| a.attr("href").expect("a link leads")).collect();
    assert_eq!(links.len(), 3);
    assert!(links.iter().all(|link| link.strip_prefix('#').is_some_and(|id| ids.contains(id))), "{links:?}");
    // Nothing is fetched, nothing runs.
    assert!(
        all(&html, "script, iframe, object, embed").is_empty() && !page.contains("url(h") && !page.contains("@import")
    );
    for element in all(&html, "[src], link, use, image") {
        let source = ["src", "href", "xlink:href"].iter().find_map(|name| element.attr(name)).expect("a source");
        assert!(source.starts_with("data:"), "{source:.80}");
    }
    let policy = all(&html, "meta[http-equiv=Content-Security-Policy]")[0].attr("content");
    assert!(policy.is_some_and(|policy| policy.starts_with("default-src 'none'")));
    // Pictures are pictures, and said in words.
    for image in all(&html, "img") {
        let data = image.attr("src").and_then(|src| src.strip_prefix("data:image/png;base64,")).expect("a PNG");
        let png = base64::engine::general_purpose::STANDARD.decode(data).expect("base64");
        let picture = image::load_from_memory(&png).expect("a picture");
        assert_eq!(Some(picture.width().to_string().as_str()), image.attr("width"));
        let colours: BTreeSet<_> = picture.to_rgb8().pixels().map(|pixel| pixel.0).collect();
        assert!(colours.len() > 5, "something is seen on it");
        assert!(image.attr("alt").is_some_and(|alt| alt.len() > 20));
    }
    assert!(all(&html, "th").iter().all(|th| th.attr("scope").is_some()));
    // The same report makes the same page.
    let (again, _) = report(folder.path(), &["m", "--allow-refused"], 0);
    assert!(page == again);
}

#[test]
fn failures_are_told_at_the_top_and_where() {
    let folder = folder(&["dart", "cube"]);
    let (page, html) = report(folder.path(), &["dart.obj", "cube.obj", "--plant", "point:1"], 1);
    assert_eq!(words(all(&html, "#verdict strong")[0]), "FAIL");
    assert!(!all(&html, ".rows .badge.fail").is_empty());
    assert_eq!(all(&html, "details[open]").len(), 2);
    assert!(page.contains("--only") && page.contains("times what is allowed"));
}

#[test]
fn names_are_text_whatever_they_are() {
    let folder = folder(&["cube"]);
    let name = r#"<script>alert(1)</script>&amp; "q" 'a'"#;
    // Not a path: a mesh of that name in a folder of that name would need a slash.
    let name = name.replace('/', "");
    fs::rename(folder.path().join("cube.obj"), folder.path().join(&name).with_extension("obj")).expect("it is renamed");
    let file = format!("{name}.obj");
    let (_, html) = report(folder.path(), &[&file], 0);
    assert_eq!(all(&html, "summary h2")[0].text().collect::<String>(), name);
    assert!(all(&html, "script").is_empty());
    assert!(all(&html, "img").iter().all(|img| img.attr("alt").is_some_and(|alt| alt.contains(&name))));
}

/// Other programs' answers come as a page too.
#[test]
fn answers_have_a_page() {
    let folder = folder(&["cube"]);
    run(folder.path(), &["cube.obj", "--samples-out", "s.csv"]);
    let eval = ["eval", "cube.obj", "--samples", "s.csv", "-o", "r.csv"];
    let output =
        Command::new(env!("CARGO_BIN_EXE_catoptric")).args(eval).current_dir(&folder).output().expect("it starts");
    assert!(output.status.success());
    let swapped = fs::read_to_string(folder.path().join("r.csv")).expect("it is there").replacen("u,v", "v,u", 1);
    fs::write(folder.path().join("swapped.csv"), swapped).expect("it is written");
    let (_, html) = report(folder.path(), &["cube.obj", "--results", "swapped.csv"], 1);
    assert!(words(all(&html, "pre.results")[0]).contains("u and v are swapped"));
    assert!(all(&html, "img").is_empty() && !all(&html, ".rows .badge.fail").is_empty());
}

/// A page in headless Chromium: what it makes of the document, what it complains about, and what is seen.
struct Shown {
    dom: String,
    console: String,
    picture: image::RgbImage,
}

fn show(folder: &Path, size: [u32; 2], more: &[&str]) -> Shown {
    let chromium = |args: &[String]| {
        let profile = format!("--user-data-dir={}", folder.join("profile").display());
        let flags = ["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--enable-logging=stderr"];
        let url = format!("file://{}", folder.join("report.html").display());
        let output = Command::new("chromium").args(flags).arg(profile).args(more).args(args).arg(url).output();
        output.expect("chromium is installed: script/test installs it")
    };
    let file = folder.join("page.png");
    let window = format!("--window-size={},{}", size[0], size[1]);
    let taken = chromium(&[window.clone(), format!("--screenshot={}", file.display())]);
    let dumped = chromium(&[window, "--dump-dom".to_owned()]);
    let log = text(&[taken.stderr, dumped.stderr].concat());
    let console: Vec<_> = log.lines().filter(|line| line.contains("CONSOLE")).collect();
    let picture = image::open(&file).unwrap_or_else(|error| panic!("no screenshot ({error}): {log}")).to_rgb8();
    Shown { dom: text(&dumped.stdout), console: console.join("\n"), picture }
}

#[test]
#[ignore = "needs chromium: script/test installs it and runs this"]
fn a_browser_shows_it() {
    let folder = folder(&["dart"]);
    report(folder.path(), &["dart.obj"], 0);
    let count = |picture: &image::RgbImage, near: [u8; 3]| {
        let close = |pixel: &image::Rgb<u8>| (0..3).all(|c| pixel.0[c].abs_diff(near[c]) <= 8);
        picture.pixels().filter(|pixel| close(pixel)).count()
    };
    // Paper and ink of either theme.
    let [paper, night] = [[252, 252, 251], [21, 23, 26]];
    let light = show(folder.path(), [1300, 2600], &["--blink-settings=preferredColorScheme=1"]);
    let dark = show(folder.path(), [1300, 2600], &["--blink-settings=preferredColorScheme=0"]);
    let narrow = show(folder.path(), [500, 4000], &["--blink-settings=preferredColorScheme=1"]);
    for shown in [&light, &dark, &narrow] {
        // The policy of the page forbids every request: the browser would complain about one here.
        assert_eq!(shown.console, "");
        let html = Html::parse_document(&shown.dom);
        assert_eq!((all(&html, "img").len(), all(&html, "svg").len()), (6, 6));
        assert!(all(&html, "table.rows tbody tr").len() > 15);
        let [width, height] = [shown.picture.width(), shown.picture.height()].map(|n| n as usize);
        // Heat maps are there: their darkest colour, which nothing else has, fills a surface of each.
        assert!(count(&shown.picture, [68, 1, 84]) > 5_000, "{width}x{height}");
        // So are the bars.
        let bars = [[74, 111, 165], [126, 164, 220]].map(|colour| count(&shown.picture, colour));
        assert!(bars.iter().sum::<usize>() > 1_000, "{bars:?}");
    }
    assert!(count(&light.picture, paper) > 100_000 && count(&light.picture, night) < 1_000);
    assert!(count(&dark.picture, night) > 100_000);
    // Nothing sticks out to the side of a narrow window: its right edge is paper all the way down.
    let edge = narrow.picture.width() - 4;
    assert!((0..narrow.picture.height()).all(|y| narrow.picture.get_pixel(edge, y).0 == paper));
    let pdf = folder.path().join("page.pdf");
    show(folder.path(), [800, 600], &[&format!("--print-to-pdf={}", pdf.display())]);
    let bytes = fs::read(&pdf).expect("it prints");
    let pages = bytes.windows(11).filter(|bytes| bytes == b"/Type /Page").count();
    assert!(bytes.starts_with(b"%PDF") && (2..12).contains(&pages), "{pages} pages");
}
