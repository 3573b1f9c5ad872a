//! Methods as they are written on the command line and in files.

use super::{CurvatureKind, Grid, HighlightKind, Method, Mirrored, PlaneCurve};
use crate::nearest::nearest;
use std::fmt;
use std::str::FromStr;

/// What may be written, for people.
const FORMS: &str = "reflection, curve:circle, curve:ellipse=ASPECT, curve:EXPRESSION of x and y, \
                     curve:FILE.png[=WIDTH], distance, \
                     highlight[:array|signed|nearest|pseudo|alternative=RADIUS], sphere[:reflection|normal], normal, isophote, \
                     curvature[:mean|gaussian|largest|smallest], section or position";

/// Names without their kinds.
const NAMES: [&str; 10] = [
    "reflection",
    "curve",
    "distance",
    "highlight",
    "sphere",
    "normal",
    "isophote",
    "curvature",
    "section",
    "position",
];

/// A picture that a method names is not read: [`Grid::read`] does that.
impl FromStr for Method {
    type Err = String;

    fn from_str(text: &str) -> Result<Method, String> {
        let (name, kind) = text.split_once(':').map_or((text, None), |(name, kind)| (name, Some(kind.trim())));
        let method = match (name, kind) {
            ("reflection", None) => Method::Reflection,
            ("curve", Some(kind)) => Method::Curve(curve(kind)?),
            ("distance", None) => Method::RayDistance,
            ("highlight", kind) => Method::Highlight(highlight(kind.unwrap_or("array"))?),
            ("sphere", None | Some("reflection")) => Method::Sphere(Mirrored::Reflection),
            ("sphere", Some("normal")) | ("normal", None) => Method::Sphere(Mirrored::Normal),
            ("isophote", None) => Method::Isophote,
            ("curvature", None | Some("mean")) => Method::Curvature(CurvatureKind::Mean),
            ("curvature", Some("gaussian")) => Method::Curvature(CurvatureKind::Gaussian),
            ("curvature", Some("largest")) => Method::Curvature(CurvatureKind::Largest),
            ("curvature", Some("smallest")) => Method::Curvature(CurvatureKind::Smallest),
            ("section" | "position", None) => Method::Section,
            _ => {
                let near =
                    nearest(name, NAMES).map(|name| format!("did you mean {name}? Otherwise ")).unwrap_or_default();
                return Err(format!("{near}give {FORMS}"));
            }
        };
        Ok(method)
    }
}

fn curve(text: &str) -> Result<PlaneCurve, String> {
    if text == "circle" {
        return Ok(PlaneCurve::Circle);
    }
    if let Some(aspect) = text.strip_prefix("ellipse=") {
        let aspect = aspect.parse().ok().filter(|aspect: &f64| *aspect > 0.0 && aspect.is_finite());
        return aspect
            .map(|aspect| PlaneCurve::Ellipse { aspect })
            .ok_or("ellipse=ASPECT takes a number above 0".into());
    }
    if let Some(grid) = Grid::named(text) {
        return grid.map(PlaneCurve::Grid);
    }
    text.parse().map(PlaneCurve::Expression).map_err(|error| error.to_string())
}

fn highlight(text: &str) -> Result<HighlightKind, String> {
    match text {
        "array" => Ok(HighlightKind::Array),
        "signed" => Ok(HighlightKind::Signed),
        "nearest" => Ok(HighlightKind::Nearest),
        "pseudo" => Ok(HighlightKind::Pseudo),
        _ => {
            let radius = text.strip_prefix("alternative=").and_then(|radius| radius.parse().ok());
            let radius = radius.filter(|radius: &f64| radius.is_finite()).map(HighlightKind::Alternative);
            radius.ok_or_else(|| "highlight takes array, signed, nearest, pseudo or alternative=RADIUS".to_owned())
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Method::Reflection | Method::RayDistance | Method::Isophote | Method::Section => f.write_str(self.name()),
            Method::Curve(PlaneCurve::Circle) => f.write_str("curve:circle"),
            Method::Curve(PlaneCurve::Ellipse { aspect }) => write!(f, "curve:ellipse={aspect}"),
            Method::Curve(PlaneCurve::Expression(expression)) => write!(f, "curve:{expression}"),
            Method::Curve(PlaneCurve::Grid(grid)) => write!(f, "curve:{grid}"),
            Method::Highlight(kind) => match kind {
                HighlightKind::Array => f.write_str("highlight:array"),
                HighlightKind::Signed => f.write_str("highlight:signed"),
                HighlightKind::Nearest => f.write_str("highlight:nearest"),
                HighlightKind::Pseudo => f.write_str("highlight:pseudo"),
                HighlightKind::Alternative(radius) => write!(f, "highlight:alternative={radius}"),
            },
            Method::Sphere(Mirrored::Reflection) => f.write_str("sphere:reflection"),
            Method::Sphere(Mirrored::Normal) => f.write_str("sphere:normal"),
            Method::Curvature(kind) => f.write_str(match kind {
                CurvatureKind::Mean => "curvature:mean",
                CurvatureKind::Gaussian => "curvature:gaussian",
                CurvatureKind::Largest => "curvature:largest",
                CurvatureKind::Smallest => "curvature:smallest",
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_are_written_as_they_are_read() {
        for text in [
            "reflection",
            "curve:circle",
            "curve:ellipse=0.5",
            "curve:x^2 - y",
            "curve:contours.png=2.5",
            "distance",
            "highlight:array",
            "highlight:signed",
            "highlight:nearest",
            "highlight:pseudo",
            "highlight:alternative=-0.25",
            "sphere:reflection",
            "sphere:normal",
            "isophote",
            "curvature:mean",
            "curvature:gaussian",
            "curvature:largest",
            "curvature:smallest",
            "section",
        ] {
            assert_eq!(text.parse::<Method>().map(|method| method.to_string()), Ok(text.to_owned()));
        }
        let short = [("highlight", "highlight:array"), ("normal", "sphere:normal"), ("position", "section")];
        for (text, long) in short {
            assert_eq!(text.parse::<Method>().map(|method| method.to_string()), Ok(long.to_owned()));
        }
        for text in
            ["", "zebra", "curve", "curve:", "curve:ellipse=0", "highlight:alternative=", "isophote:3", "sphere:x"]
        {
            assert!(text.parse::<Method>().is_err(), "{text}");
        }
    }
}
