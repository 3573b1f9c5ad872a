//! One point of the surface, as text.

use super::only::{Evaluation, Only};
use std::fmt;

impl fmt::Display for Only {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let super::Sample { face, u, v } = self.sample;
        writeln!(f, "{}: ptex face {face} at u {u}, v {v} (control face {})", self.mesh, self.control_face)?;
        match &self.patch {
            Some(patch) => {
                let ([s, t], [a, b]) = (patch.local, patch.depth);
                writeln!(
                    f,
                    "  patch {} ({}) at local u {s}, v {t}; depth {a} in u, {b} in v",
                    patch.index, patch.kind
                )?;
            }
            None => writeln!(f, "  no patch of ours: a hole")?,
        }
        self.evaluations.iter().try_for_each(|evaluation| write!(f, "{evaluation}"))?;
        self.write_control_points(f)
    }
}

impl Only {
    fn write_control_points(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "  control points: x y z; weights in position, d/du, d/dv of the limit stencil | ours - stencil")?;
        let largest = |of: fn(&[f64; 3]) -> f64| {
            let off = self.control_points.iter().filter_map(|p| {
                let ours = p.ours?;
                Some(of(&std::array::from_fn(|k| (ours[k] - p.stencil[k]).abs())))
            });
            off.fold(0.0, f64::max)
        };
        for point in &self.control_points {
            write!(f, "    {:>7} ", point.vertex)?;
            point.point.iter().try_for_each(|x| write!(f, " {x:>23.16e}"))?;
            point.stencil.iter().try_for_each(|w| write!(f, " {w:>24.16e}"))?;
            match point.ours {
                Some(ours) => {
                    write!(f, " |")?;
                    ours.iter()
                        .zip(point.stencil)
                        .try_for_each(|(ours, stencil)| write!(f, " {:>8.1e}", ours - stencil))?;
                }
                None => write!(f, " | no surface")?,
            }
            writeln!(f)?;
        }
        writeln!(
            f,
            "  largest difference of weights: position {:.1e}, derivatives {:.1e}",
            largest(|w| w[0]),
            largest(|w| w[1].max(w[2]))
        )?;
        match self.weights_miss {
            Some(miss) => {
                writeln!(f, "  the control points by our weights miss our position by {miss:.1e} of the diagonal")
            }
            None => Ok(()),
        }
    }
}

impl fmt::Display for Evaluation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "  {} ({})", self.evaluator, self.answer)?;
        let off = |x: Option<f64>, unit: &str| x.map(|x| format!("   off {x:.1e}{unit}")).unwrap_or_default();
        let lines = [
            ("position", self.position, off(self.position_off, " of the diagonal")),
            ("d/du", self.du, String::new()),
            ("d/dv", self.dv, off(self.derivative_off, " of the diagonal")),
            ("normal", self.normal, off(self.normal_off_deg, " degrees")),
        ];
        for (name, vector, off) in lines {
            let Some([x, y, z]) = vector else { continue };
            writeln!(f, "    {name:<8} {x:>23.16e} {y:>23.16e} {z:>23.16e}{off}")?;
        }
        Ok(())
    }
}
