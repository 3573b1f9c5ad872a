//! What joints do to lines, held to values of the fields themselves on surfaces of revolution that are known in closed form: contours
//! are found by bisection and differences of values, with no second derivative.

use crate::revolution::{BELOW, C1, C2, CORNER, Profile, ROUNDING, camera, sides, turns};
use catoptric::field::{Camera, Field, Light, Point};
use catoptric::quality::LineBreak;
use glam::{DVec2, DVec3, dvec2, dvec3};

/// One surface of revolution, read by a field.
struct Side<'a> {
    profile: Profile,
    field: &'a Field,
    camera: &'a Camera,
}

impl Side<'_> {
    fn value(&self, s: f64, turn: f64) -> Option<f64> {
        let (position, normal) = self.profile.point(s, turn);
        let sight = self.camera.sight(position);
        self.field.value(&Point { position, normal, sight, curvature: None }).map(|value| value.x)
    }

    /// Difference of two values, round the sphere where it is one.
    fn minus(&self, a: f64, b: f64) -> f64 {
        match self.field.method.name() {
            "sphere" => (a - b) - 360.0 * ((a - b) / 360.0).round(),
            _ => a - b,
        }
    }

    /// Derivatives of the value by s and the angle at the joint: differences of fourth order.
    fn slope(&self, turn: f64) -> Option<[f64; 2]> {
        const STEP: f64 = 1e-3;
        let along = |direction: DVec2| {
            let apart = |step: f64| {
                let [a, b] = [step, -step].map(|step| self.value(step * direction.x, turn + step * direction.y));
                Some(self.minus(a?, b?) / (2.0 * step))
            };
            let [near, far] = [apart(STEP)?, apart(2.0 * STEP)?];
            // Near a horizon values grow without bound, and we know as little as the library.
            ((near - far).abs() < 1e-4 * near.abs().max(1e-2)).then_some((4.0 * near - far) / 3.0)
        };
        Some([along(DVec2::X)?, along(DVec2::Y)?])
    }

    /// A vector at the joint, in the plane laid flat: along the joint, and across it towards growing s.
    fn flat(&self, turn: f64, vector: DVec3) -> DVec2 {
        let (_, normal) = self.profile.point(0.0, turn);
        let along = dvec3(-turn.sin(), turn.cos(), 0.0);
        // s grows to the right of the angle, seen from the normal's side: du x dv is the normal.
        dvec2(vector.dot(along), -vector.dot(normal.cross(along)))
    }

    /// Direction in which the contour through a point of the joint crosses it, laid flat.
    fn tangent(&self, turn: f64) -> Option<DVec2> {
        let [by_s, by_turn] = self.slope(turn)?;
        let [r, a, ..] = self.profile.0;
        let (out, round) = (dvec3(turn.cos(), turn.sin(), 0.0), dvec3(-turn.sin(), turn.cos(), 0.0));
        let direction = self.flat(turn, -by_turn * (out * a + DVec3::Z) + by_s * r * round);
        Some(direction * direction.y.signum())
    }

    /// The angle at which the value is that of (0, turn) again, at a height s; by bisection.
    fn contour(&self, turn: f64, s: f64) -> Option<f64> {
        let [by_s, by_turn] = self.slope(turn)?;
        let value = self.value(0.0, turn)?;
        let middle = turn - by_s / by_turn * s;
        let reach = 0.5 * (middle - turn).abs() + 1e-2 * s.abs();
        let error = |at: f64| Some(self.minus(self.value(s, at)?, value));
        zero(error, [middle - reach, middle + reach])
    }

    /// The angle of the contour's direction across the joint, from points of it at three heights on this side (`sign`: above or below),
    /// extrapolated; and how far that may be off: what the farthest point contributes.
    fn traced(&self, turn: f64, sign: f64) -> Option<[f64; 2]> {
        let (start, _) = self.profile.point(0.0, turn);
        let angle = |height: f64| {
            let s = sign * height;
            let (end, _) = self.profile.point(s, self.contour(turn, s)?);
            let chord = self.flat(turn, (end - start) * sign);
            Some(chord.to_angle())
        };
        // a(h) = a + b h + c h^2 + ...
        let [far, middle, near] = [angle(4e-3)?, angle(2e-3)?, angle(1e-3)?];
        let [quadratic, linear] = [(8.0 * near - 6.0 * middle + far) / 3.0, 2.0 * near - middle];
        Some([quadratic, (quadratic - linear).abs()])
    }

    /// How far apart along the joint, half on each side of a point, this side and another one have the same value; model units.
    fn shift(&self, above: &Side<'_>, turn: f64, guess: f64) -> Option<f64> {
        let radius = self.profile.0[0];
        let error = |by: f64| {
            let half = 0.5 * by / radius;
            Some(self.minus(self.value(0.0, turn - half)?, above.value(0.0, turn + half)?))
        };
        // To the right or to the left.
        zero(error, [0.5 * guess, 1.5 * guess]).or_else(|| zero(error, [-0.5 * guess, -1.5 * guess])).map(f64::abs)
    }
}

/// A zero between two ends of different signs, to the last digit.
fn zero(of: impl Fn(f64) -> Option<f64>, [mut low, mut high]: [f64; 2]) -> Option<f64> {
    let start = of(low)?;
    if start * of(high)? > 0.0 {
        return None;
    }
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if of(middle)? * start > 0.0 { low = middle } else { high = middle }
    }
    Some(0.5 * (low + high))
}

fn fields() -> Vec<Field> {
    let light = Light::new(dvec3(2.5, -3.5, -5.0), dvec3(-0.4, 0.5, 1.0), dvec3(0.5, 1.0, 0.2), 0.5);
    let names = ["reflection", "highlight", "highlight:signed", "highlight:pseudo", "isophote", "sphere", "normal"];
    names.map(|name| Field { light, method: name.parse().expect("a method") }).to_vec()
}

fn side<'a>(profile: Profile, field: &'a Field, camera: &'a Camera) -> Side<'a> {
    Side { profile, field, camera }
}

fn line_break(above: &Profile, turn: f64, field: &Field, camera: &Camera) -> Option<LineBreak> {
    let [own, other] = sides(above, turn);
    LineBreak::new(field, camera, [&own, &other], own.first.dv, ROUNDING)
}

/// Angle between two directions, degrees.
fn apart(a: DVec2, b: DVec2) -> f64 {
    a.perp_dot(b).abs().atan2(a.dot(b)).to_degrees()
}

/// Turns of lines across joints, against the two sides' own values: by their derivatives, and by points of the contour itself. Where it
/// runs along the joint to a tenth of a radian, it is no line that crosses it.
#[test]
fn lines_turn_as_their_values_say() {
    let camera = camera();
    for (name, above) in [("C2", C2), ("C1", C1), ("corner", CORNER)] {
        for field in fields() {
            let [below, above_side] = [BELOW, above].map(|profile| side(profile, &field, &camera));
            let (mut compared, mut traced, mut worst, mut most) = (0, 0, 0.0f64, 0.0f64);
            let (mut kinks, mut jumps) = (0, 0);
            for turn in turns() {
                let Some((a, b)) = below.tangent(turn).zip(above_side.tangent(turn)) else { continue };
                if [a, b].iter().any(|d| d.y < 0.1 * d.length()) {
                    continue;
                }
                let line = line_break(&above, turn, &field, &camera).expect("both sides have values");
                let found = line.turn_deg.expect("slopes");
                compared += 1;
                worst = worst.max((found - apart(a, b)).abs());
                most = most.max(found);
                let expected = below
                    .minus(below.value(0.0, turn).expect("a value"), above_side.value(0.0, turn).expect("a value"));
                assert!((line.jump - expected.abs()).abs() <= 1e-12 * (1.0 + expected.abs()), "{line:?} {expected}");
                kinks += usize::from(found > 0.5);
                jumps += usize::from(line.jump > 1e-6);
                let Some(([a, doubt], [b, more])) = below.traced(turn, -1.0).zip(above_side.traced(turn, 1.0)) else {
                    continue;
                };
                let doubt = (doubt + more).to_degrees();
                if doubt < 0.1 {
                    traced += 1;
                    let off = (found - (a - b).abs().to_degrees()).abs();
                    assert!(
                        off < doubt + 1e-6,
                        "{name} {} at {turn}: {found} is {off:e} off, not {doubt:e}",
                        field.method
                    );
                }
            }
            println!(
                "{name} {}: {compared} points, {worst:e} degrees off, {traced} traced; turns up to {most}",
                field.method
            );
            assert!(compared > 20 && traced > 15, "{name} {}: {compared} {traced}", field.method);
            // Fourth-order differences over thousandths on both sides: 1e-12 of a derivative, and four digits for where the first
            // derivatives are small beside the fifth.
            assert!(worst < 1e-6, "{name} {}: {worst:e}", field.method);
            match name {
                // The third derivatives differ, and no line knows.
                "C2" => assert!(most < 1e-6 && jumps == 0, "{}: {most:e}", field.method),
                // All lines but those that happen to run across: the change of the slope is along them.
                "C1" => assert!(10 * kinks > 9 * compared && jumps == 0, "{}: {kinks} of {compared}", field.method),
                _ => assert!(jumps == compared, "{}: {jumps} of {compared}", field.method),
            }
        }
    }
}

/// A line that arrives at a corner goes on elsewhere: how far off, to first order in the corner's angle, so that the error falls with its
/// square or faster.
#[test]
fn lines_jump_along_a_corner_as_far_as_values_say() {
    let camera = camera();
    let [r, a, b, c] = BELOW.0;
    for field in fields() {
        let below = side(BELOW, &field, &camera);
        let mut compared = 0;
        for turn in turns() {
            let off = |angle: f64| {
                let above = Profile([r, a + angle, b, c]);
                let found = line_break(&above, turn, &field, &camera)?.along?;
                Some([below.shift(&side(above, &field, &camera), turn, found)?, found])
            };
            let Some(sizes) = [0.02, 0.01, 0.005].map(off).into_iter().collect::<Option<Vec<_>>>() else { continue };
            // Far along the joint the value is another function.
            if sizes[0][1] > 0.05 {
                continue;
            }
            compared += 1;
            for [exact, found] in &sizes {
                assert!((found - exact).abs() < 0.05 * exact, "{} at {turn}: {sizes:?}", field.method);
            }
            let [first, .., last] = &sizes[..] else { unreachable!() };
            let part = |[exact, found]: &[f64; 2]| (found - exact).abs() / exact;
            assert!(part(last) < 0.3 * part(first) + 1e-6, "{} at {turn}: {sizes:?}", field.method);
        }
        println!("{}: {compared} points", field.method);
        assert!(compared > 5, "{}: {compared}", field.method);
    }
}

/// Beier & Chen 1994, Property 2: "A discontinuity on a surface is magnified by an order of one in the highlight line", and so forth: a corner
/// breaks its position, a break of curvature its tangent, one of the third derivative its curvature, and nothing breaks nothing.
#[test]
fn property_2_of_beier_and_chen() {
    let camera = camera();
    let field = &fields()[1];
    assert_eq!(field.method.to_string(), "highlight:array");
    let below = side(BELOW, field, &camera);
    let mut judged = 0;
    for turn in turns() {
        // Curvature of the contour from points at heights h and 2h on one side, by its angle: what differs across the joint is the
        // angle's derivative by the height.
        let bend = |side: &Side<'_>, sign: f64| {
            let (start, _) = side.profile.point(0.0, turn);
            let angle = |height: f64| {
                let (end, _) = side.profile.point(sign * height, side.contour(turn, sign * height)?);
                Some(side.flat(turn, (end - start) * sign).to_angle())
            };
            let [a, b, c] = [angle(1e-3)?, angle(2e-3)?, angle(4e-3)?];
            // a(h) = a + b h + c h^2: b, from three heights.
            Some(sign * (-2.0 * a + 2.5 * b - 0.5 * c) / 1e-3)
        };
        let Some(own) = below.tangent(turn).filter(|d| d.y > 0.3 * d.length()).and_then(|_| bend(&below, -1.0)) else {
            continue;
        };
        let of = |above: Profile| {
            let line = line_break(&above, turn, field, &camera).expect("both sides have values");
            (line.jump > 1e-9, line.turn_deg.expect("slopes") > 1e-6, bend(&side(above, field, &camera), 1.0))
        };
        let corner = of(CORNER);
        assert!(corner.0, "position breaks at {turn}");
        let tangent = of(C1);
        assert!(!tangent.0 && tangent.1, "position does not, the tangent breaks at {turn}");
        let (jumps, turns, other) = of(C2);
        let third = (other.expect("a contour") - own).abs();
        assert!(!jumps && !turns && third > 0.05, "neither does, but the bend: {third} at {turn}");
        let (jumps, turns, other) = of(BELOW);
        let none = (other.expect("a contour") - own).abs();
        assert!(!jumps && !turns && none < 0.02 * third, "nothing breaks: {none} at {turn}");
        judged += 1;
    }
    println!("{judged} points");
    assert!(judged > 5, "{judged}");
}
