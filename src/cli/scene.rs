//! Which mesh a command reads: the file, what of it, and when.

use super::Failure;
use super::numbered::Numbered;
use super::settings::CommandLine;
use crate::field::Scout;
use crate::line::printable;
use crate::memory;
use crate::mesh::{self, Choice, MeshFile, MeshFormat, Scheme, SubdivMesh};
use clap::Args;
use std::io::Read;
use std::path::{Path, PathBuf};

/// What the mesh is called that comes by standard input.
const STANDARD_INPUT: &str = "-";

/// Most times of an animation: more than an hour at 25 a second.
const MOST_TIMES: f64 = 100_000.0;

#[derive(Debug, Clone, Default, Args)]
pub(super) struct ReadArgs {
    /// Of a USD stage, read the meshes of this prim and of those below it alone; give as many as there are to be
    #[arg(long = "prim", value_name = "PATH")]
    prims: Vec<String>,
    /// Refuse a mesh with a face that names a vertex twice, has less than three or doubles another one, instead of leaving that
    /// face out
    #[arg(long)]
    strict: bool,
    /// Format of standard input, where MESH is - [default: what the first bytes look like]
    #[arg(long, value_name = "FORMAT", value_parser = format)]
    format: Option<MeshFormat>,
}

fn format(text: &str) -> Result<MeshFormat, String> {
    MeshFormat::of_extension(text).ok_or_else(|| "give obj, usd, usda, usdc or usdz".to_owned())
}

#[derive(Debug, Clone, Default, Args)]
pub(super) struct SceneArgs {
    #[command(flatten)]
    read: ReadArgs,
    /// Time code at which a USD stage is read, or number of the frame where MESH has #### or %04d [default: the stage's
    /// default time]
    #[arg(long, value_name = "T", value_parser = time, allow_negative_numbers = true)]
    time: Option<f64>,
}

impl SceneArgs {
    /// Reads the mesh, or makes the built-in sample; says on standard error what the reader has to say.
    pub(super) fn load(&self, path: Option<&Path>) -> Result<SubdivMesh, Failure> {
        self.read(path).map_err(Failure::Bad)
    }

    /// As [`load`](Self::load), for a command that does not know triangles under Loop's rules.
    pub(super) fn load_quads(&self, path: Option<&Path>, command: &str) -> Result<SubdivMesh, Failure> {
        let mesh = self.load(path)?;
        check_quads(&mesh, command).map_err(Failure::Bad)?;
        Ok(mesh)
    }

    /// As [`load`](Self::load); the error is one line.
    pub(super) fn read(&self, path: Option<&Path>) -> Result<SubdivMesh, String> {
        let mesh = Source::open(path, &self.read)?.at(self.time)?;
        say_notes(path, &mesh);
        Ok(mesh)
    }

    /// Adds these flags to a command that is recorded.
    pub(super) fn record(&self, line: &mut CommandLine) {
        self.read.record(self.time, line);
    }

    /// These flags as a shell takes them, each after a space.
    pub(super) fn flags(&self) -> String {
        let mut line = CommandLine::default();
        self.record(&mut line);
        line.into_words()
    }
}

#[derive(Debug, Clone, Default, Args)]
pub(super) struct AnimationArgs {
    #[command(flatten)]
    read: ReadArgs,
    /// Time code at which a USD stage is read, or number of the frame where MESH has #### or %04d; with several, a series of
    /// pictures into numbered files, STEP (1) apart. Points move, the topology must stay [default: the stage's default time]
    #[arg(long, value_name = "T|FIRST:LAST[:STEP]", value_parser = times, allow_negative_numbers = true)]
    time: Option<Times>,
}

impl AnimationArgs {
    /// Times of the pictures, at least one.
    pub(super) fn times(&self) -> Vec<Option<f64>> {
        self.time.as_ref().map_or(vec![None], |times| times.all().map(Some).collect())
    }

    /// Numbers of the files, if the pictures are a series: the times themselves where they can be numbers.
    pub(super) fn numbers(&self) -> Option<Vec<u32>> {
        let times: Vec<f64> = self.time.as_ref().filter(|times| times.step.is_some())?.all().collect();
        let is_number = |time: &f64| time.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(time);
        Some(match times.iter().all(is_number) {
            true => times.iter().map(|&time| time as u32).collect(),
            false => (1..=times.len() as u32).collect(),
        })
    }

    pub(super) fn source<'a>(&'a self, path: Option<&'a Path>) -> Result<Source<'a>, Failure> {
        Source::open(path, &self.read).map_err(Failure::Bad)
    }

    /// Adds the flags of the picture at a time to a command that is recorded.
    pub(super) fn record(&self, time: Option<f64>, line: &mut CommandLine) {
        self.read.record(time, line);
    }
}

impl ReadArgs {
    fn record(&self, time: Option<f64>, line: &mut CommandLine) {
        self.prims.iter().for_each(|prim| line.flag("prim", prim));
        time.iter().for_each(|time| line.flag("time", time));
    }
}

/// A time, or times at equal distances.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Times {
    first: f64,
    count: u32,
    /// `None`: a time by itself.
    step: Option<f64>,
}

impl Times {
    fn all(&self) -> impl Iterator<Item = f64> {
        let (first, step) = (self.first, self.step.unwrap_or(0.0));
        (0..self.count).map(move |k| first + f64::from(k) * step)
    }
}

fn time(text: &str) -> Result<f64, String> {
    let time = text.trim().parse().ok().filter(|time: &f64| time.abs() <= 1e12);
    time.ok_or_else(|| "give a time code, a number".to_owned())
}

fn times(text: &str) -> Result<Times, String> {
    let form =
        || "give a time code, or FIRST:LAST or FIRST:LAST:STEP with the earlier first and STEP above 0".to_owned();
    let numbers: Vec<f64> = text.split(':').map(time).collect::<Result<_, _>>().map_err(|_| form())?;
    match numbers[..] {
        [first] => Ok(Times { first, count: 1, step: None }),
        [first, last, ref step @ ..] if step.len() <= 1 && first <= last => {
            let step = step.first().copied().unwrap_or(1.0);
            // Steps of 0.1 may end a rounding short.
            let steps = ((last - first) / step + 1e-9).floor();
            match step > 0.0 && steps < MOST_TIMES {
                true => Ok(Times { first, count: steps as u32 + 1, step: Some(step) }),
                false if step > 0.0 => Err(format!("at most {MOST_TIMES} times; give a larger STEP")),
                false => Err(form()),
            }
        }
        _ => Err(form()),
    }
}

/// Refuses triangles under Loop's rules for a command that does not know them; the error is one line.
pub(super) fn check_quads(mesh: &SubdivMesh, command: &str) -> Result<(), String> {
    let known = "render, eval, info and verify do, or use catmullClark";
    match mesh.scheme {
        Scheme::Loop => Err(format!("{}: the scheme loop is not supported by {command}; {known}", mesh.name)),
        _ => Ok(()),
    }
}

/// What the reader passed over, on standard error.
pub(super) fn say_notes(path: Option<&Path>, mesh: &SubdivMesh) {
    let name = path.map_or_else(|| "sample".to_owned(), |path| path.display().to_string());
    let name = if name == STANDARD_INPUT { "standard input" } else { &name };
    for note in &mesh.notes {
        tell!("catoptric: {}", printable(&format!("{name}: {note}")));
    }
}

/// Faces that run against their neighbours, on standard error.
pub(super) fn say_orientation(path: Option<&Path>, mesh: &SubdivMesh) {
    for sentence in mesh.orientation().sentences(mesh) {
        tell!("catoptric: {}: {sentence}", path.unwrap_or(Path::new("sample")).display());
    }
}

/// Says on standard error that a surface has no area, if it has none; what cannot be done therefore.
pub(super) fn say_without_area(mesh: &SubdivMesh, scout: &Scout, so: &str) -> bool {
    let why = scout.without_area();
    if let Some(why) = &why {
        tell!("catoptric: {}: the surface has no area; {so}: {why}", mesh.name);
    }
    why.is_some()
}

/// Where the mesh of each time comes from.
pub(super) struct Source<'a> {
    place: Place<'a>,
    read: &'a ReadArgs,
}

enum Place<'a> {
    Sample,
    /// A file that has all times.
    File(MeshFile),
    /// A file a frame: the name has a place for its number.
    Sequence(&'a Path, Numbered),
}

impl<'a> Source<'a> {
    fn open(path: Option<&'a Path>, read: &'a ReadArgs) -> Result<Self, String> {
        let numbered = |path: &Path| Numbered::placed(path.file_name()?.to_str()?);
        let is_standard_input = path.is_some_and(|path| path == STANDARD_INPUT);
        if read.format.is_some() && !is_standard_input {
            return Err("--format is for standard input; leave it out, or give - for the mesh".to_owned());
        }
        let place = match path {
            None => Place::Sample,
            Some(_) if is_standard_input => Place::File(standard_input(read.format)?),
            Some(path) => match numbered(path).filter(|_| !path.exists()) {
                Some(name) => Place::Sequence(path, name),
                None => Place::File(MeshFile::open(path).map_err(|error| error.to_string())?),
            },
        };
        Ok(Self { place, read })
    }

    /// The mesh at a time; the error is one line.
    pub(super) fn at(&self, time: Option<f64>) -> Result<SubdivMesh, String> {
        let ReadArgs { prims, strict, .. } = self.read;
        let choice = Choice { prims: prims.clone(), time, strict: *strict };
        match &self.place {
            Place::Sample if !prims.is_empty() => Err("--prim is for USD files; give one before it".to_owned()),
            Place::Sample if time.is_some() => {
                Err("--time is for USD files and sequences; give one before it".to_owned())
            }
            Place::Sample => Ok(mesh::sample()),
            Place::File(file) => file.read(&choice).map_err(|error| error.to_string()),
            Place::Sequence(path, name) => {
                let path = frame(path, name, time)?;
                let is_obj = MeshFormat::of_path(&path) == Some(MeshFormat::Obj);
                let choice = Choice { time: choice.time.filter(|_| !is_obj), ..choice };
                mesh::read_choice(&path, &choice).map_err(|error| error.to_string())
            }
        }
    }
}

/// Reads all of standard input as a mesh file.
fn standard_input(format: Option<MeshFormat>) -> Result<MeshFile, String> {
    const NAME: &str = "standard input";
    // The text and what it says take about as much.
    let most = memory::limit().bytes / 2;
    let mut content = Vec::new();
    let read = std::io::stdin().lock().take(most.saturating_add(1)).read_to_end(&mut content);
    read.map_err(|error| format!("{NAME}: cannot be read ({error}); give a file"))?;
    if content.len() as u64 > most {
        let needs = memory::TooMuch { needs: 2 * content.len() as u64, limit: memory::limit() };
        return Err(format!("{NAME}: to be read {needs}"));
    }
    let format = format.unwrap_or_else(|| MeshFormat::of_content(&content));
    MeshFile::of_bytes(content, format, NAME, "stdin").map_err(|error| error.to_string())
}

/// The file of a frame.
fn frame(path: &Path, name: &Numbered, time: Option<f64>) -> Result<PathBuf, String> {
    let place = "the name has a place for the number of a frame";
    let time = time.ok_or_else(|| format!("{}: no such file, and {place}; give --time", path.display()))?;
    let number = Some(time).filter(|time| time.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(time));
    let number =
        number.ok_or_else(|| format!("{}: {place}, and --time {time} is none; give 0, 1, 2 ...", path.display()))?;
    Ok(path.with_file_name(name.of(number as u32)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_a_number_or_a_range() {
        let all = |text: &str| times(text).map(|times| times.all().collect::<Vec<_>>()).ok();
        assert_eq!(all("12"), Some(vec![12.0]));
        assert_eq!(all("-1.5"), Some(vec![-1.5]));
        assert_eq!(all("1:4"), Some(vec![1.0, 2.0, 3.0, 4.0]));
        assert_eq!(all("1:2:0.5"), Some(vec![1.0, 1.5, 2.0]));
        assert_eq!(all("0:1:0.1").map(|times| times.len()), Some(11));
        assert_eq!(all("3:3"), Some(vec![3.0]));
        assert_eq!(all("1:4:2"), Some(vec![1.0, 3.0]));
        for bad in ["", "a", "1:", "4:1", "1:2:0", "1:2:-1", "1:2:3:4", "nan", "inf", "0:1e9", "1e300"] {
            assert!(times(bad).is_err(), "{bad}");
        }
    }
}
