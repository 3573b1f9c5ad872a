//! Which values of the field have lines.

use crate::cli::Failure;
use crate::cli::settings::CommandLine;
use crate::field::{Camera, Field, HighlightKind, Method, Scout};
use clap::Args;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// Most lights that are drawn where nothing is said about them.
const MOST: i64 = 40;
/// Most lights that can be asked for.
const MOST_ASKED: i64 = 10_000;

#[derive(Debug, Args)]
pub(super) struct FamilyArgs {
    /// Trace these values of the field, in its units [default: every whole multiple of the light's spacing that the
    /// surface shows, at most 40]
    #[arg(long, value_name = "C,...", allow_hyphen_values = true, conflicts_with_all = ["lights", "count"])]
    values: Option<Numbers>,
    /// Trace the lights with these numbers: the first and last k of the values k spacing
    #[arg(long, value_name = "K,K", value_parser = lights, allow_hyphen_values = true, conflicts_with = "count")]
    lights: Option<[i32; 2]>,
    /// Trace N lights, with a spacing that spreads them over what the camera sees
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MOST_ASKED), conflicts_with = "light_spacing")]
    count: Option<u32>,
    /// Trace the borders of bands round each light instead: the values on both sides at these distances
    #[arg(long, value_name = "R,...", allow_hyphen_values = true)]
    radius: Option<Numbers>,
}

/// Finite numbers, one at least.
#[derive(Debug, Clone)]
struct Numbers(Vec<f64>);

impl FromStr for Numbers {
    type Err = String;

    fn from_str(text: &str) -> Result<Numbers, String> {
        let parse = |x: &str| x.trim().parse().ok().filter(|x: &f64| x.is_finite());
        let numbers: Option<Vec<f64>> = text.split(',').map(parse).collect();
        numbers
            .filter(|numbers| numbers.len() as i64 <= MOST_ASKED)
            .map(Numbers)
            .ok_or_else(|| format!("give finite numbers with commas between them, at most {MOST_ASKED}"))
    }
}

impl Numbers {
    fn text(&self) -> String {
        self.0.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
    }
}

fn lights(text: &str) -> Result<[i32; 2], String> {
    let parse = |k: &str| k.trim().parse().ok();
    let ends = text.split_once(',').and_then(|(first, last)| Some([parse(first)?, parse(last)?]));
    ends.filter(|[first, last]: &[i32; 2]| (0..MOST_ASKED).contains(&(i64::from(*last) - i64::from(*first))))
        .ok_or_else(|| format!("give the first and the last of at most {MOST_ASKED} whole numbers"))
}

/// Where the lights of a method are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    /// At the values k spacing.
    Values,
    /// At 0, k being the nearest light.
    Nearest,
    /// At 0, and there is only one.
    Single,
}

/// The values that are traced.
#[derive(Debug)]
pub(super) struct Family {
    /// Light and value of each.
    pub values: Vec<(i32, f64)>,
    /// How they are asked for again.
    flags: Vec<(&'static str, String)>,
    /// Lights that the surface shows, where not all of them are drawn.
    left_out: Option<(i64, [i32; 2])>,
}

impl FamilyArgs {
    fn place(&self, method: &Method) -> Place {
        match method {
            Method::RayDistance | Method::Highlight(HighlightKind::Nearest) => Place::Nearest,
            Method::Highlight(HighlightKind::Pseudo | HighlightKind::Alternative(_)) => Place::Single,
            // Without bands it is a family of radii (Beier & Chen 1994, colour plate 3).
            Method::Highlight(HighlightKind::Signed) if self.radius.is_some() => Place::Single,
            _ => Place::Values,
        }
    }

    /// Refuses flags that say nothing to a method.
    pub fn check(&self, method: &Method) -> Result<(), Failure> {
        let bad = |what: String| Err(Failure::Bad(what));
        let has_lights = self.lights.is_some() || self.count.is_some();
        match self.place(method) {
            Place::Nearest if self.values.is_some() => {
                bad(format!("--values is not for {method}, the distance from the nearest light; give --radius"))
            }
            Place::Single if has_lights => bad(format!("{method} has one light here; leave --lights and --count out")),
            _ => match self.radius.iter().flat_map(|radii| &radii.0).find(|radius| **radius <= 0.0) {
                Some(radius) => bad(format!("--radius {radius}: a radius is above 0; correct it")),
                None => Ok(()),
            },
        }
    }

    /// The family of a field; where a number of lights is asked for, the field gets the spacing that makes so many.
    pub fn family(&self, scout: &Scout, camera: &Camera, field: &mut Field) -> Family {
        let place = self.place(&field.method);
        let mut flags = Vec::new();
        let mut left_out = None;
        let middles: Vec<(i32, f64)> = match (&self.values, place) {
            (Some(values), _) => {
                flags.push(("values", values.text()));
                (0..).zip(values.0.iter().copied()).collect()
            }
            (None, Place::Single) => vec![(0, 0.0)],
            (None, Place::Values | Place::Nearest) => {
                let (numbers, all) = self.numbers(scout, camera, field);
                flags.push(("lights", format!("{},{}", numbers.start(), numbers.end())));
                left_out = all.map(|all| (all, [*numbers.start(), *numbers.end()]));
                let value = |k: i32| if place == Place::Nearest { 0.0 } else { f64::from(k) * field.light.spacing };
                numbers.filter(|&k| exists(field, place, k)).map(|k| (k, value(k))).collect()
            }
        };
        let mut values = Vec::new();
        match &self.radius {
            None => values = middles,
            Some(Numbers(radii)) => {
                for (light, middle) in middles {
                    values.extend(radii.iter().flat_map(|radius| [(light, middle - radius), (light, middle + radius)]));
                }
            }
        }
        flags.extend(self.radius.iter().map(|radii| ("radius", radii.text())));
        Family { values, flags, left_out }
    }

    /// Half the width that has lights; infinite where nothing bounds them.
    fn half(&self, field: &Field) -> f64 {
        let bounds = field.method.is_bounded() || self.place(&field.method) == Place::Nearest;
        if bounds { field.light.half[0] } else { f64::INFINITY }
    }

    /// Numbers of the lights, and how many the surface shows where these are not all.
    fn numbers(&self, scout: &Scout, camera: &Camera, field: &mut Field) -> (RangeInclusive<i32>, Option<i64>) {
        if let Some([first, last]) = self.lights {
            return (first..=last, None);
        }
        let spread = spread(field);
        let [low, middle, high] = scout.quantiles(&spread, camera, [0.02, 0.5, 0.98]);
        let half = self.half(field);
        let [low, high] = [low, high].map(|end| end.clamp(-half, half));
        if let Some(count) = self.count {
            let spacing = (high - low) / f64::from(count);
            if spacing > 0.0 && spacing.is_finite() {
                field.light.spacing = spacing;
            }
            let first = number((low / field.light.spacing).ceil());
            return (first..=first.saturating_add(count as i32 - 1), None);
        }
        let Some([least, greatest]) = scout.extremes(&spread, camera) else { return (0..=0, None) };
        let spacing = field.light.spacing;
        // Outwards: the points looked at are not all there are.
        let (first, last) = (number((least / spacing).floor()), number((greatest / spacing).ceil()));
        let outermost = outermost(half, spacing);
        let [first, last] = [first, last].map(|k| k.clamp(-outermost, outermost));
        let all = i64::from(last) - i64::from(first) + 1;
        if all <= MOST {
            return (first..=last, None);
        }
        let start = (number((middle / spacing).round()).saturating_sub(MOST as i32 / 2)).max(first);
        let start = start.min(last - (MOST as i32 - 1));
        (start..=start + (MOST as i32 - 1), Some(all))
    }
}

/// The field whose values say where lights are: the place on the light plane, for distances from the nearest one.
fn spread(field: &Field) -> Field {
    let method = match &field.method {
        Method::RayDistance => Method::Reflection,
        Method::Highlight(HighlightKind::Nearest) => Method::Highlight(HighlightKind::Array),
        method => method.clone(),
    };
    Field { method, ..field.clone() }
}

/// Greatest number of a light at most `half` from the middle.
fn outermost(half: f64, spacing: f64) -> i32 {
    let nearest = number((half / spacing).round());
    // As `exists` has it, to the last digit.
    if f64::from(nearest) * spacing <= half { nearest } else { nearest - 1 }
}

fn number(k: f64) -> i32 {
    // Far from both ends, so that nothing overflows: lights at the horizon have any number.
    const FARTHEST: f64 = 1e9;
    k.clamp(-FARTHEST, FARTHEST) as i32
}

/// Whether a light of the family is one: within the extents, and no other one's twin.
fn exists(field: &Field, place: Place, light: i32) -> bool {
    let value = f64::from(light) * field.light.spacing;
    match field.method {
        Method::Sphere(_) => value > -180.0 && value <= 180.0 && value.abs() <= field.light.half[0],
        // At 0 and 180 there are points, not lines.
        Method::Isophote => value > 0.0 && value < 180.0,
        _ if field.method.is_bounded() || place == Place::Nearest => value.abs() <= field.light.half[0],
        _ => true,
    }
}

impl Family {
    /// The flags that give these values again.
    pub fn record(&self, command: &mut CommandLine) {
        self.flags.iter().for_each(|(flag, value)| command.flag(flag, value));
    }

    /// Says on standard error where not all lights are drawn.
    pub fn say(&self) {
        if let Some((all, [first, last])) = self.left_out {
            tell!(
                "lines: the surface shows some {all} lights; these are numbers {first} to {last}, in the middle of what is seen: \
                 --lights chooses others, --light-spacing and --count put them farther apart"
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outermost_lights_are_within_the_extents() {
        for (half, spacing, expected) in [(1.5, 0.2, 7), (0.3, 0.1, 2), (0.05, 0.2, 0), (2.0, 0.5, 4)] {
            assert_eq!(outermost(half, spacing), expected, "{half} {spacing}");
        }
        assert_eq!(outermost(f64::INFINITY, 0.1), number(f64::INFINITY));
    }

    #[test]
    fn lists_are_finite_numbers() {
        assert_eq!("1, -2.5,3e-7".parse::<Numbers>().map(|numbers| numbers.text()), Ok("1,-2.5,0.0000003".to_owned()));
        for text in ["", "1,,2", "nan", "inf", "1;2", "1,"] {
            assert!(text.parse::<Numbers>().is_err(), "{text}");
        }
        assert_eq!(lights("-3,4"), Ok([-3, 4]));
        for text in ["", "1", "4,3", "1,2,3", "0,10000", "a,b", "-2147483648,2147483647"] {
            assert!(lights(text).is_err(), "{text}");
        }
    }
}
