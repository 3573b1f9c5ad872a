//! Surfaces of revolution whose profile is two cubics: with a corner, C1 and C2 (Ulmet 2003, figures 6.1 and 6.2). What breaks them breaks
//! the lines of every field, one order lower (Beier & Chen 1994, Property 2).

use catoptric::field::{Camera, Field, Light, Method, Point};
use catoptric::quality::{Continuity, LineBreak};
use catoptric::stam::{Jet, Jet2};
use glam::{DVec3, dvec3};

/// r(s) = r0 + a s + b s^2 + c s^3, z = s.
#[derive(Debug, Clone, Copy)]
struct Profile([f64; 4]);

impl Profile {
    fn position(&self, s: f64, turn: f64) -> DVec3 {
        let [r, a, b, c] = self.0;
        let radius = r + s * (a + s * (b + s * c));
        dvec3(radius * turn.cos(), radius * turn.sin(), s)
    }

    /// By s and the angle, at the joint s = 0; `speed`: how fast its parameter runs along s, so that the two sides have little in
    /// common but the surface.
    fn jet(&self, turn: f64, speed: f64) -> Jet2 {
        let [r, a, b, _] = self.0;
        let (out, round) = (dvec3(turn.cos(), turn.sin(), 0.0), dvec3(-turn.sin(), turn.cos(), 0.0));
        let first = Jet::new(out * r, speed * (out * a + DVec3::Z), round * r);
        Jet2 { first, duu: speed * speed * 2.0 * b * out, duv: speed * a * round, dvv: -r * out }
    }

    /// Curvature along the profile at the joint; the normal du x dv points inwards.
    fn curvature(&self) -> f64 {
        let [_, a, b, _] = self.0;
        -2.0 * b / (1.0 + a * a).powf(1.5)
    }
}

const BELOW: Profile = Profile([1.3, 0.4, -0.5, 0.2]);
/// The same curvature and another third derivative.
const C2: Profile = Profile([1.3, 0.4, -0.5, -0.9]);
const C1: Profile = Profile([1.3, 0.4, 0.15, -0.9]);
const CORNER: Profile = Profile([1.3, 0.55, -0.5, 0.2]);

fn camera() -> Camera {
    let points = [dvec3(-1.5, -1.5, -1.0), dvec3(1.5, 1.5, 1.0)];
    Camera::fit(&points, [400, 300], DVec3::Z, dvec3(0.6, -0.7, 0.3), 26.0)
}

fn fields() -> Vec<Field> {
    let light = Light::new(dvec3(2.0, -3.0, -9.0), dvec3(-0.1, 0.2, 1.0), dvec3(0.3, 0.8, 0.2), 0.5);
    let methods = [
        "reflection",
        "curve:circle",
        "distance",
        "highlight",
        "highlight:signed",
        "highlight:pseudo",
        "sphere:reflection",
        "isophote",
    ];
    methods.map(|method| Field { light, method: method.parse().expect("a method") }).into()
}

/// Angles of the joint's points that the camera sees, and that mirror the light.
fn turns() -> impl Iterator<Item = f64> {
    (0..40).map(|i| -1.6 + 0.05 * f64::from(i))
}

fn sides(above: &Profile, turn: f64) -> [Jet2; 2] {
    [BELOW.jet(turn, 1.0), above.jet(turn, 2.5)]
}

/// The joint runs along v. Both sides are evaluated in a handful of operations.
const ROUNDING: [f64; 2] = [1e-14; 2];

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

/// Breaks of one field along the joint.
fn breaks(field: &Field, above: &Profile) -> Vec<LineBreak> {
    let camera = camera();
    let at = |turn| {
        let [own, other] = sides(above, turn);
        LineBreak::new(field, &camera, [&own, &other], own.first.dv, ROUNDING)
    };
    turns().filter_map(at).collect()
}

fn largest(breaks: &[LineBreak], of: impl Fn(&LineBreak) -> Option<f64>) -> f64 {
    breaks.iter().filter_map(of).fold(0.0, f64::max)
}

/// Property 2, field by field: an angle makes the lines jump, a difference in curvature gives them a kink, and C2 does neither.
#[test]
fn breaks_of_the_surface_are_breaks_of_lines_one_order_lower() {
    for field in fields() {
        let name = field.method.to_string();
        let [smooth, tangent, corner] = [C2, C1, CORNER].map(|above| breaks(&field, &above));
        assert!(smooth.len() >= 20 && tangent.len() == smooth.len(), "{name}: {} points", smooth.len());
        let known = smooth.iter().filter(|line| line.turn_deg.is_some()).count();
        assert!(known * 10 >= smooth.len() * 9, "{name}: {known} slopes of {}", smooth.len());
        // Values are some 1e3 at most here, made of 50 roundings or so; normals differ by a few.
        let rounding = 1e3 * 50.0 * f64::EPSILON;
        for (lines, kinked) in [(&smooth, false), (&tangent, true)] {
            let jump = largest(lines, |line| Some(line.jump));
            assert!(jump < rounding, "{name}: {jump:e}");
            let turn = largest(lines, |line| line.turn_deg);
            // The slopes of both sides are the same but for what differences of fourth order and rounding leave:
            // steps of 1e-3 leave 1e-12, or ten times that where the field is steep, and rounding 1e-13 of values a hundred times
            // the slope.
            assert!(if kinked { turn > 5.0 } else { turn < 1e-8 }, "{name}: {turn} degrees");
        }
        let jump = largest(&corner, |line| Some(line.lines));
        assert!(jump > 0.05, "{name}: {jump} lines");
    }
}

/// The kink is that of the contour itself: its direction on each cubic, by differences of the field on the surface.
#[test]
fn kinks_are_those_of_contours_on_the_surface() {
    let camera = camera();
    for field in fields() {
        // On the cubic and beyond its end: it goes on.
        let value = |profile: &Profile, s: f64, turn: f64| {
            let h = 1e-4;
            // The normal, by differences too: nothing of the jets.
            let difference = |a: DVec3, b: DVec3| (8.0 * a - b) / (12.0 * h);
            let along = |k: f64| profile.position(s + k * h, turn) - profile.position(s - k * h, turn);
            let round = |k: f64| profile.position(s, turn + k * h) - profile.position(s, turn - k * h);
            let normal = difference(along(1.0), along(2.0)).cross(difference(round(1.0), round(2.0))).normalize();
            let position = profile.position(s, turn);
            let point = Point { position, normal, sight: camera.sight(position), curvature: None };
            field.value(&point).map(|value| value.x)
        };
        let direction = |profile: &Profile, turn: f64| {
            let h = 1e-3;
            let s = (value(profile, h, turn)? - value(profile, -h, turn)?) / (2.0 * h);
            let t = (value(profile, 0.0, turn + h)? - value(profile, 0.0, turn - h)?) / (2.0 * h);
            let jet = profile.jet(turn, 1.0).first;
            Some(jet.dv * s - jet.du * t)
        };
        let mut compared = 0;
        for turn in turns() {
            let [own, other] = sides(&C1, turn);
            let found = LineBreak::new(&field, &camera, [&own, &other], own.first.dv, ROUNDING);
            let expected = direction(&BELOW, turn).zip(direction(&C1, turn));
            let (Some(found), Some((a, b))) = (found.and_then(|line| line.turn_deg), expected) else { continue };
            let expected = a.cross(b).length().atan2(a.dot(b)).to_degrees();
            // Second-order differences over 1e-3 in a field whose third derivatives are some 1e3 times its first where it is steepest.
            assert!((found - expected).abs() < 0.1, "{} at {turn}: {found} {expected}", field.method);
            compared += 1;
        }
        assert!(compared >= 20, "{}: {compared}", field.method);
    }
}

/// Where a line goes on beside where it arrived: found by solving for its value on both sides.
#[test]
fn shifts_along_the_joint_are_those_of_the_lines() {
    let camera = camera();
    // So small an angle that first order is enough.
    let above = Profile([1.3, 0.4 + 1e-5, -0.5, 0.2]);
    let field = &fields()[0];
    let value = |profile: &Profile, turn: f64| {
        let jet = profile.jet(turn, 1.0).first;
        let (position, normal) = (jet.position, jet.normal);
        field.value(&Point { position, normal, sight: camera.sight(position), curvature: None }).map(|value| value.x)
    };
    let mut compared = 0;
    for turn in turns() {
        let [own, other] = sides(&above, turn);
        let found = LineBreak::new(field, &camera, [&own, &other], own.first.dv, ROUNDING).and_then(|line| line.along);
        let (Some(found), Some(wanted)) = (found, value(&BELOW, turn)) else { continue };
        // The secant rule from two points beside.
        let (mut a, mut b) = (turn - 1e-4, turn + 1e-4);
        for _ in 0..20 {
            let (Some(x), Some(y)) = (value(&above, a), value(&above, b)) else { break };
            if x == y {
                break;
            }
            (a, b) = (b, b - (y - wanted) * (b - a) / (y - x));
        }
        let expected = 1.3 * (b - turn).abs();
        // First order in an angle of 1e-5, over fields that change within a hundredth of a radian at the steepest.
        assert!((found - expected).abs() < 1e-2 * expected, "at {turn}: {found:e} {expected:e}");
        compared += 1;
    }
    assert!(compared >= 20, "{compared}");
}

/// Contours of curvature would need third derivatives: the jump is known, the kink is not.
#[test]
fn curvature_jumps_where_it_breaks() {
    let field = Field { light: fields()[0].light, method: "curvature:mean".parse().expect("a method") };
    let camera = camera();
    let [own, other] = sides(&C1, 0.3);
    let line = LineBreak::new(&field, &camera, [&own, &other], own.first.dv, ROUNDING).expect("curvatures");
    assert!((line.jump - 0.5 * (BELOW.curvature() - C1.curvature()).abs()).abs() < 1e-14);
    assert_eq!((line.turn_deg, line.along), (None, None));
    assert!(matches!(field.method, Method::Curvature(_)));
}
