//! Surfaces of revolution whose profile is two cubics: with a corner, C1 and C2 (Ulmet 2003, figures 6.1 and 6.2).

use catoptric::field::{Camera, Field, Light, Method};
use catoptric::quality::{Continuity, LineBreak};
use catoptric::stam::{Jet, Jet2};
use glam::{DVec3, dvec3};

/// r(s) = r0 + a s + b s^2 + c s^3, z = s.
#[derive(Debug, Clone, Copy)]
pub struct Profile(pub [f64; 4]);

impl Profile {
    /// Position and unit normal, which points inwards, at (s, turn).
    pub fn point(&self, s: f64, turn: f64) -> (DVec3, DVec3) {
        let [r, a, b, c] = self.0;
        let (out, round) = (dvec3(turn.cos(), turn.sin(), 0.0), dvec3(-turn.sin(), turn.cos(), 0.0));
        let (radius, slope) = (r + s * (a + s * (b + s * c)), a + s * (2.0 * b + s * 3.0 * c));
        (out * radius + DVec3::Z * s, (out * slope + DVec3::Z).cross(round).normalize())
    }

    /// By s and the angle, at the joint s = 0; `speed`: how fast its parameter runs along s, so that the two sides have little in
    /// common but the surface.
    pub fn jet(&self, turn: f64, speed: f64) -> Jet2 {
        let [r, a, b, _] = self.0;
        let (out, round) = (dvec3(turn.cos(), turn.sin(), 0.0), dvec3(-turn.sin(), turn.cos(), 0.0));
        let first = Jet::new(out * r, speed * (out * a + DVec3::Z), round * r);
        Jet2 { first, duu: speed * speed * 2.0 * b * out, duv: speed * a * round, dvv: -r * out }
    }

    /// Curvature along the profile at the joint; the normal du x dv points inwards.
    pub fn curvature(&self) -> f64 {
        let [_, a, b, _] = self.0;
        -2.0 * b / (1.0 + a * a).powf(1.5)
    }
}

pub const BELOW: Profile = Profile([1.3, 0.4, -0.5, 0.2]);
/// The same curvature and another third derivative.
pub const C2: Profile = Profile([1.3, 0.4, -0.5, -0.9]);
pub const C1: Profile = Profile([1.3, 0.4, 0.15, -0.9]);
pub const CORNER: Profile = Profile([1.3, 0.55, -0.5, 0.2]);

pub fn camera() -> Camera {
    let points = [dvec3(-1.5, -1.5, -1.0), dvec3(1.5, 1.5, 1.0)];
    Camera::fit(&points, [400, 300], DVec3::Z, dvec3(0.6, -0.7, 0.3), 26.0)
}

/// Angles of points of the joint.
pub fn turns() -> impl Iterator<Item = f64> {
    (0..40).map(|i| -1.6 + 0.05 * f64::from(i))
}

pub fn sides(above: &Profile, turn: f64) -> [Jet2; 2] {
    [BELOW.jet(turn, 1.0), above.jet(turn, 2.5)]
}

/// The joint runs along v. Both sides are evaluated in a handful of operations.
pub const ROUNDING: [f64; 2] = [1e-14; 2];

#[test]
fn continuity_is_what_the_profiles_say() {
    for turn in turns() {
        let joint = |above: &Profile| {
            let [own, other] = sides(above, turn);
            Continuity::new([&own, &other], own.first.dv, ROUNDING)
        };
        let smooth = joint(&C2);
        assert_eq!((smooth.gap, smooth.difference, smooth.concave), (0.0, Some(0.0), false));
        // A few roundings in each normal.
        assert!(smooth.angle_deg.expect("normals") < 1e-13, "{smooth:?}");

        let tangent = joint(&C1);
        let (below, above) = (BELOW.curvature(), C1.curvature());
        let [k1, k2] = tangent.curvature.expect("tangent planes");
        assert!((k1 - below).abs() + (k2 - above).abs() < 1e-14, "{tangent:?}");
        assert!(tangent.angle_deg.expect("normals") < 1e-13 && tangent.concave, "{tangent:?}");
        // Of opposite signs: 2 (|k1| + |k2|) over |k1| + |k2|.
        assert!((tangent.difference.expect("tangent planes") - 2.0).abs() < 1e-14);
        let flatter = joint(&Profile([1.3, 0.4, -0.4, 0.0]));
        let expected = 2.0 * (0.5 - 0.4) / (0.5 + 0.4);
        assert!((flatter.difference.expect("tangent planes") - expected).abs() < 1e-13 && !flatter.concave);

        let corner = joint(&CORNER);
        let expected = (0.55f64.atan() - 0.4f64.atan()).to_degrees();
        assert!((corner.angle_deg.expect("normals") - expected).abs() < 1e-12, "{corner:?}");
    }
}

/// Contours of curvature would need third derivatives: the jump is known, the kink is not.
#[test]
fn curvature_jumps_where_it_breaks() {
    let field = Field {
        light: Light::new(DVec3::ZERO, DVec3::Z, DVec3::X, 1.0),
        method: "curvature:mean".parse().expect("a method"),
    };
    let camera = camera();
    let [own, other] = sides(&C1, 0.3);
    let line = LineBreak::new(&field, &camera, [&own, &other], own.first.dv, ROUNDING).expect("curvatures");
    assert!((line.jump - 0.5 * (BELOW.curvature() - C1.curvature()).abs()).abs() < 1e-14);
    assert_eq!((line.turn_deg, line.along), (None, None));
    assert!(matches!(field.method, Method::Curvature(_)));
}
