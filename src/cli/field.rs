//! What is read off the surface: flags.

use super::Failure;
use crate::field::{Camera, Field, Light, Method, Pattern, Picture, Scout};
use clap::Args;
use std::path::Path;

#[derive(Debug, Args)]
pub(super) struct FieldArgs {
    /// What is read off the surface: reflection, curve:circle, curve:ellipse=ASPECT, curve:EXPRESSION of x and y, distance,
    /// highlight[:array|signed|nearest|pseudo|alternative=RADIUS], sphere[:reflection|normal], normal, isophote,
    /// curvature[:mean|gaussian|largest|smallest], section
    #[arg(long = "field", value_name = "FIELD", default_value = "reflection")]
    pub method: Method,
}

#[derive(Debug, Default, Args)]
pub(super) struct PatternArgs {
    /// Shape of the lights: stripes, lattice, circles, band, a picture, or heat for false colours [default: stripes; heat for
    /// curvature]
    #[arg(
        long = "pattern",
        value_name = "stripes|lattice|circles|band|heat[:LOW,HIGH]|FILE.png",
        allow_hyphen_values = true
    )]
    pattern: Option<String>,
    /// Part of the spacing that shines, 0 to 1 (of circles: their diameter)
    #[arg(long, value_name = "PART", value_parser = part)]
    light_width: Option<f64>,
}

fn part(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x| (0.0..=1.0).contains(x)).ok_or("give a number from 0 to 1".to_owned())
}

impl FieldArgs {
    /// The field as it suits a camera, read by `light` where that is given.
    pub fn field(&self, scout: &Scout, camera: &Camera, light: Option<Light>) -> Field {
        match light {
            Some(light) => Field { light, method: self.method.clone() },
            None => scout.field(&self.method, camera),
        }
    }
}

impl PatternArgs {
    /// Reads the pattern, and its picture if it is one; the ends of false colours may be left to [`fitted`](Self::fitted).
    pub fn read(&self, method: &Method) -> Result<Pattern, Failure> {
        let width = |default: f64| self.light_width.unwrap_or(default);
        let default = if method.reads_curvature() { "heat" } else { "stripes" };
        match self.pattern.as_deref().unwrap_or(default) {
            "stripes" => Ok(Pattern::Stripes { width: width(0.42) }),
            "lattice" => Ok(Pattern::Lattice { width: width(0.2) }),
            "circles" => Ok(Pattern::Circles { radius: width(0.6) / 2.0 }),
            "band" => Ok(Pattern::Band { radius: width(0.42) / 2.0 }),
            "heat" => Ok(Pattern::Heat { range: [f64::NAN; 2] }),
            text => match text.strip_prefix("heat:") {
                Some(range) => heat(range).map_err(Failure::Bad),
                None => picture(Path::new(text)),
            },
        }
    }

    /// The pattern with what fits where flags do not say.
    pub fn fitted(pattern: Pattern, scout: &Scout, field: &Field, camera: &Camera) -> Pattern {
        match pattern {
            Pattern::Heat { range } if range[0].is_nan() => Pattern::Heat { range: scout.range(field, camera) },
            pattern => pattern,
        }
    }

    /// As it is written, without the folder of a picture.
    pub fn name(&self, pattern: &Pattern) -> String {
        match pattern {
            Pattern::Stripes { .. } => "stripes".to_owned(),
            Pattern::Lattice { .. } => "lattice".to_owned(),
            Pattern::Circles { .. } => "circles".to_owned(),
            Pattern::Band { .. } => "band".to_owned(),
            Pattern::Heat { range } => format!("heat:{},{}", range[0], range[1]),
            Pattern::Picture(_) => {
                let path = Path::new(self.pattern.as_deref().unwrap_or_default());
                path.file_name().unwrap_or_default().to_string_lossy().into_owned()
            }
        }
    }
}

fn heat(text: &str) -> Result<Pattern, String> {
    let ends: Option<Vec<f64>> =
        text.split(',').map(|end| end.trim().parse().ok().filter(|x: &f64| x.is_finite())).collect();
    match ends.as_deref() {
        Some(&[low, high]) if low < high => Ok(Pattern::Heat { range: [low, high] }),
        _ => Err("--pattern heat:LOW,HIGH takes two numbers, the smaller first".to_owned()),
    }
}

fn picture(path: &Path) -> Result<Pattern, Failure> {
    let bad = |what: String| {
        let names = "stripes, lattice, circles, band, heat or a PNG file";
        Failure::Bad(format!("{}: {what}; give {names}", path.display()))
    };
    let reader = image::ImageReader::open(path).map_err(|e| bad(format!("cannot read the pattern ({e})")))?;
    let reader = reader.with_guessed_format().map_err(|e| bad(format!("cannot read the pattern ({e})")))?;
    let picture = reader.decode().map_err(|e| bad(format!("not a picture we read ({e})")))?.to_rgba8();
    Ok(Pattern::Picture(Picture { size: [picture.width(), picture.height()], rgba8: picture.into_raw() }))
}
