//! Series of pictures: turntables, light sweeps and animations, numbered files that a later run can go on with.

use super::Failure;
use super::numbered::Numbered;
use super::outgoing::is_stdout;
use super::render::Format;
use super::rig::orbited;
use super::settings::method_name;
use crate::field::{Field, HighlightKind, Method, Pattern};
use crate::rig::FittedRig;
use clap::Args;
use glam::DQuat;
use std::path::{Path, PathBuf};

/// Most frames of a series: more than an hour at 25 a second.
const MOST_FRAMES: i64 = 100_000;
/// Most degrees or periods of a series: its frames would be whole turns apart otherwise, and digits run out.
const MOST_WAY: f64 = 1e6;

#[derive(Debug, Args)]
pub(super) struct FramesArgs {
    /// Draw a series of N pictures into numbered files: view_0001.png and so on, or where FILE has #### or %04d
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MOST_FRAMES))]
    frames: Option<u32>,
    /// Turn the eye by DEG in total about the up axis through the target, counter-clockwise seen from above; whole turns
    /// loop. A camera that is fitted is fitted to the first picture
    #[arg(long, value_name = "DEG", value_parser = way, allow_negative_numbers = true)]
    orbit: Option<f64>,
    /// Move the light plane across its lines by DIST periods of its pattern in total, or turn the sphere; whole periods of
    /// infinite lights loop
    #[arg(long, value_name = "DIST", value_parser = way, allow_negative_numbers = true, num_args = 0..=1, default_missing_value = "1")]
    sweep_light: Option<f64>,
    /// Leave frames that are there already, whole and with the same settings, and draw the others
    #[arg(long)]
    resume: bool,
}

fn way(text: &str) -> Result<f64, String> {
    let way = text.parse().ok().filter(|x: &f64| x.abs() <= MOST_WAY && *x != 0.0);
    way.ok_or_else(|| {
        format!("give a number other than 0, at most {MOST_WAY:e} either way; a mesh comes before this flag")
    })
}

impl FramesArgs {
    /// Refuses flags that contradict each other or miss one another. `animated`: the mesh has a series of times, and with them
    /// the number of pictures.
    pub(super) fn check(&self, animated: bool) -> Result<(), Failure> {
        let bad = |what: &str| Err(Failure::Bad(what.to_owned()));
        match (self.frames, self.orbit, self.sweep_light) {
            (Some(_), ..) if animated => bad("--time FIRST:LAST says how many pictures there are; leave --frames out"),
            (None, Some(_), None) | (None, None, Some(_) | None) if animated => Ok(()),
            (_, Some(_), Some(_)) => bad("--orbit and --sweep-light are two series; give one of them"),
            (Some(_), None, None) => bad("--frames needs something that changes; add --orbit DEG or --sweep-light"),
            (None, Some(_), None) => bad("--orbit needs the number of pictures; add --frames N"),
            (None, None, Some(_)) => bad("--sweep-light needs the number of pictures; add --frames N"),
            (None, ..) if self.resume => {
                bad("--resume goes on with a series; add --frames N or --time FIRST:LAST, or leave it out")
            }
            _ => Ok(()),
        }
    }

    /// Refuses to move a light that a method reads no place of, or whose spacing is no distance that it could move by.
    pub(super) fn check_method(&self, method: &Method) -> Result<(), Failure> {
        let what = match method {
            Method::Isophote | Method::Curvature(_) => {
                format!("changes nothing of {method}, which does not read where the light is")
            }
            Method::Curve(_)
            | Method::Highlight(HighlightKind::Signed | HighlightKind::Pseudo | HighlightKind::Alternative(_)) => {
                let method = method_name(method);
                format!("has no period for {method}, whose values do not repeat as the light moves")
            }
            Method::Reflection | Method::RayDistance | Method::Highlight(_) | Method::Sphere(_) | Method::Section => {
                return Ok(());
            }
        };
        match self.sweep_light {
            Some(_) => Err(Failure::Bad(format!("--sweep-light {what}; give --orbit, or another --field"))),
            None => Ok(()),
        }
    }

    /// Files of the series in order; `output` itself without one. An animation brings the numbers of its frames.
    pub(super) fn paths(&self, output: &Path, animation: Option<Vec<u32>>) -> Result<Vec<PathBuf>, Failure> {
        let Some(numbers) = animation.or_else(|| self.frames.map(|count| (1..=count).collect())) else {
            return Ok(vec![output.to_owned()]);
        };
        if is_stdout(output) {
            let what = "standard output (-) takes one picture, and this is a series; name files with -o";
            return Err(Failure::Bad(what.to_owned()));
        }
        let last = numbers.last().copied().unwrap_or_default();
        let name = output.file_name().and_then(|name| name.to_str()).and_then(|name| Numbered::new(name, last));
        let name = name.ok_or_else(|| {
            let what = "cannot number this name; have one #### or %04d in it, or neither";
            Failure::Bad(format!("{}: {what}", output.display()))
        })?;
        Ok(numbers.into_iter().map(|frame| output.with_file_name(name.of(frame))).collect())
    }

    /// What the file names of a series have in common, `#` in place of the number; `None` where there is no series. `animated`: as in
    /// [`FramesArgs::check`].
    pub(super) fn pattern(&self, output: &Path, animated: bool) -> Option<String> {
        let name = output.file_name()?.to_str()?;
        (animated || self.frames.is_some()).then(|| Numbered::new(name, 0).map(|name| name.pattern())).flatten()
    }

    /// The rig of frame `index` of the `count` of a series, counted from 0; the first one is `rig` itself.
    pub(super) fn rig(&self, rig: &FittedRig, pattern: &Pattern, index: u32, count: u32) -> FittedRig {
        let mut rig = rig.clone();
        if let Some(degrees) = self.orbit {
            let angle = degrees.to_radians() * progress(index, count, degrees / 360.0);
            if angle != 0.0 {
                rig.camera = orbited(rig.camera, angle);
            }
        }
        if let Some(periods) = self.sweep_light {
            let light = rig.light.own();
            let period = pattern.period(&Field { light, method: rig.method.clone() });
            let way = period * periods * progress(index, count, periods);
            match rig.method {
                // Towards the lights of greater longitude.
                Method::Sphere(_) if way != 0.0 => {
                    rig.light.lines = DQuat::from_axis_angle(light.normal(), way.to_radians()) * light.axes[1];
                }
                Method::Sphere(_) => {}
                _ => rig.light.center += light.axes[0] * way,
            }
        }
        rig
    }

    /// Whether frames that are there stay.
    pub(super) fn resumes(&self) -> bool {
        self.resume
    }

    /// What stands where a frame of these settings goes, of which `--resume` keeps what is whole.
    ///
    /// # Errors
    /// It is a frame of other settings, or no frame of ours.
    pub(super) fn found(&self, path: &Path, format: Format, made_by: &str) -> Result<Found, Failure> {
        if !(self.resume && path.exists()) {
            return Ok(Found::Nothing);
        }
        match format.made_by(path) {
            Ok(Some(found)) if found == made_by => Ok(Found::Whole),
            Ok(Some(_)) => Err(other(path, "was made with other settings")),
            Ok(None) => Err(other(path, "does not say how it was made")),
            Err(error) if says(path, made_by) => Ok(Found::Broken(error)),
            Err(error) => Err(other(path, &format!("cannot be read ({error})"))),
        }
    }
}

/// What stands where a frame goes.
#[derive(Debug)]
pub(super) enum Found {
    Nothing,
    /// The frame, whole.
    Whole,
    /// The frame once: bytes of it have changed, or are missing.
    Broken(std::io::Error),
}

/// Whether a file that cannot be read is the frame that is wanted, or was: it has one half of the text that says how it was made, of which a
/// byte may have changed, or it is empty.
fn says(path: &Path, made_by: &str) -> bool {
    let Ok(bytes) = std::fs::read(path) else { return false };
    let halves = made_by.as_bytes().split_at(made_by.len() / 2);
    let has = |half: &[u8]| bytes.windows(half.len()).any(|window| window == half);
    bytes.is_empty() || has(halves.0) || has(halves.1)
}

/// A file that stands where a frame would.
fn other(path: &Path, what: &str) -> Failure {
    let remedy = "remove it, choose another -o, or leave --resume out to overwrite it";
    Failure::Bad(format!("{}: this frame is there, but {what}; {remedy}", path.display()))
}

/// Part of the way at frame `index` of `count`: if the way is a whole number of `rounds`, the frame after the last one is
/// the first again; else the last one is at its end.
fn progress(index: u32, count: u32, rounds: f64) -> f64 {
    let steps = if rounds.fract() == 0.0 { count } else { (count - 1).max(1) };
    f64::from(index) / f64::from(steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_rounds_loop_and_others_arrive() {
        assert_eq!([0, 1, 2, 3].map(|k| progress(k, 4, 1.0)), [0.0, 0.25, 0.5, 0.75]);
        assert_eq!([0, 1, 2, 3].map(|k| progress(k, 4, -2.0)), [0.0, 0.25, 0.5, 0.75]);
        assert_eq!([0, 1, 2].map(|k| progress(k, 3, 0.25)), [0.0, 0.5, 1.0]);
        assert_eq!(progress(0, 1, 0.25), 0.0);
    }
}
