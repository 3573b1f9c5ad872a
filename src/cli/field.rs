//! What is read off the surface, and its colours: flags.

use super::Failure;
use crate::field::{Grid, Method};
use crate::rig::{Colour, Colours, PatternName, PatternRig, Rig, checked_part};
use clap::Args;

#[derive(Debug, Args)]
pub(super) struct FieldArgs {
    /// What is read off the surface: reflection, curve:circle, curve:ellipse=ASPECT, curve:EXPRESSION of x and y,
    /// curve:FILE.png[=WIDTH] (a gray picture), distance, highlight[:array|signed|nearest|pseudo|alternative=RADIUS], sphere[:reflection|normal], normal, isophote,
    /// curvature[:mean|gaussian|largest|smallest], section [default: reflection]
    #[arg(long = "field", value_name = "FIELD", value_parser = method)]
    pub method: Option<Method>,
}

#[derive(Debug, Args)]
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

#[derive(Debug, Args)]
pub(super) struct ColourArgs {
    /// Colour of the object where it mirrors no light: '#rrggbb' in sRGB, or three linear numbers from 0 to 1
    #[arg(long, value_name = "COLOUR")]
    paint: Option<Colour>,
    /// Colour of the lights
    #[arg(long, value_name = "COLOUR")]
    light_colour: Option<Colour>,
    /// Colour of the background at the top of the picture
    #[arg(long, value_name = "COLOUR")]
    background_top: Option<Colour>,
    /// Colour of the background at the bottom
    #[arg(long, value_name = "COLOUR")]
    background_bottom: Option<Colour>,
}

fn method(text: &str) -> Result<Method, String> {
    let mut method: Method = text.parse()?;
    method.grid_mut().map_or(Ok(()), Grid::read)?;
    Ok(method)
}

fn part(text: &str) -> Result<f64, String> {
    checked_part(text.parse().unwrap_or(f64::NAN))
}

impl PatternArgs {
    /// What these flags say.
    pub fn rig(&self) -> Result<PatternRig, Failure> {
        let width = self.light_width;
        Ok(match self.pattern.as_deref() {
            Some("") => {
                let names = "stripes, lattice, circles, band, heat or a PNG file";
                return Err(Failure::Bad(format!("--pattern names nothing; give {names}")));
            }
            None => PatternRig { width, ..PatternRig::default() },
            Some(text) => match text.strip_prefix("heat:") {
                Some(ends) => PatternRig { name: Some(PatternName::Heat), width, range: Some(range(ends)?) },
                None => PatternRig { name: text.parse().ok(), width, range: None },
            },
        })
    }
}

impl PatternArgs {
    /// Refuses a width that changes nothing of the pattern that the rig turns out to have.
    pub fn check(&self, rig: &Rig) -> Result<(), Failure> {
        let name = rig.pattern.name_for(&rig.method());
        let what = match name {
            PatternName::Heat => "false colours, which have no lights",
            PatternName::File(_) => "a picture, whose lights are as wide as it shows them",
            _ => return Ok(()),
        };
        match self.light_width {
            Some(_) => Err(Failure::Bad(format!("--light-width changes nothing of {what}; leave it out"))),
            None => Ok(()),
        }
    }
}

impl ColourArgs {
    /// What these flags say.
    pub fn rig(&self) -> Colours {
        Colours {
            paint: self.paint,
            light: self.light_colour,
            top: self.background_top,
            bottom: self.background_bottom,
        }
    }
}

fn range(text: &str) -> Result<[f64; 2], Failure> {
    let ends: Option<Vec<f64>> =
        text.split(',').map(|end| end.trim().parse().ok().filter(|x: &f64| x.is_finite())).collect();
    match ends.as_deref() {
        Some(&[low, high]) if low < high => Ok([low, high]),
        _ => Err(Failure::Bad("--pattern heat:LOW,HIGH takes two numbers, the smaller first".to_owned())),
    }
}
