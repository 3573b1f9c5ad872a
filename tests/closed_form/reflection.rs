//! Reflection lines and curves, ray distance, environment: Ulmet 2003, Yasui & Kanai 2004.

use crate::scene::{ANGLE, Sample, close, everywhere};
use catoptric::field::{Field, Light, Method, Mirrored, PlaneCurve, reflection_direction};
use glam::{DVec2, DVec3};

/// Theorem RL and RC, eq. 5.11 and 5.12, in the light's own frame i, j, k: coordinates of the point where the ray meets the plane z = z0,
/// relative to the light's centre; with the ray's length t by eq. 5.6 and its slope s.k. Any origin O will do.
fn by_ulmet(light: &Light, sample: &Sample) -> (DVec2, f64, f64) {
    let origin = DVec3::new(0.4, -1.1, 0.7);
    let ([i, j], k) = (light.axes, light.axes[0].cross(light.axes[1]));
    let (r, s) = (sample.r - origin, sample.s());
    let c = light.center - origin;
    let z0 = c.dot(k);
    let mixed = |a: DVec3, b: DVec3, c: DVec3| a.cross(b).dot(c);
    let x = (mixed(s, r, j) + z0 * s.dot(i)) / s.dot(k);
    let y = (mixed(r, s, i) + z0 * s.dot(j)) / s.dot(k);
    let t = (z0 - r.dot(k)) / s.dot(k);
    (DVec2::new(x - c.dot(i), y - c.dot(j)), t, s.dot(k))
}

/// The ray turns by twice the error of the normal, twice; where it meets the plane, at the distance t, that moves by t / |s.k| of it. The
/// mixed products add terms of the size of the ray's offset over s.k.
fn tolerance(t: f64, slope: f64) -> f64 {
    4.0 * ANGLE * (t.abs() + 10.0) / slope.abs()
}

#[test]
fn reflection_is_theorem_rl() {
    let values = everywhere(&Method::Reflection, |_, light, sample, found| {
        let (expected, t, slope) = by_ulmet(light, sample);
        // The plane is met by the ray, not by its extension to behind.
        match t > 0.0 {
            true => close(found, expected, tolerance(t, slope)),
            false => assert_eq!(found, None),
        }
    });
    assert!(values > 2000, "{values}");
}

/// The same by Yasui & Kanai, eq. 1: with the mirrored ray S' = (S - E) - 2 ((S - E).n) n through S, of any length, sec. 3.1.
#[test]
fn reflection_is_the_law_of_reflection() {
    let values = everywhere(&Method::Reflection, |_, light, sample, found| {
        let Some(found) = found else { return };
        // Eye, surface point and the point of the light that is seen: the normal halves the angle.
        let seen = light.center + light.axes[0] * found.x + light.axes[1] * found.y;
        let to_seen = (seen - sample.r).normalize();
        let half = (to_seen + sample.to_eye).normalize_or_zero();
        let off = half.cross(sample.n).length();
        // Angles of 90 degrees between ray and normal leave a short sum.
        let cos = sample.to_eye.dot(sample.n).abs();
        assert!(off <= 4.0 * ANGLE * (1.0 + found.length()) / cos, "{off:e}");
    });
    assert!(values > 2000, "{values}");
}

/// g(x,y) of Theorem RC: circles (example 5.2, eq. 5.13), ellipses, an expression.
#[test]
fn reflection_curves_are_theorem_rc() {
    type Case<'a> = (&'a str, fn(DVec2) -> f64, fn(DVec2) -> f64);
    // g, and a bound of its gradient.
    let cases: [Case; 3] = [
        ("curve:circle", |p| (p.x * p.x + p.y * p.y).sqrt(), |_| 1.0),
        ("curve:ellipse=0.5", |p| (p.x * p.x + p.y * p.y / 0.25).sqrt(), |_| 2.0),
        ("curve:x^2 - 3*x*y + 2", |p| p.x * (p.x - 3.0 * p.y) + 2.0, |p| 5.0 * p.length()),
    ];
    for (name, g, gradient) in cases {
        let method: Method = name.parse().expect("a method");
        assert!(matches!(
            method,
            Method::Curve(PlaneCurve::Circle | PlaneCurve::Ellipse { .. } | PlaneCurve::Expression(_))
        ));
        let values = everywhere(&method, |_, light, sample, found| {
            let (at, t, slope) = by_ulmet(light, sample);
            if t <= 0.0 {
                assert_eq!(found, None);
                return;
            }
            let rounding = 1e-15 * (1.0 + g(at).abs() + at.length_squared());
            close(found, DVec2::new(g(at), 0.0), gradient(at) * tolerance(t, slope) + rounding);
        });
        assert!(values > 2000, "{name} {values}");
    }
}

/// eq. 4.2, d = |(s x c).b| / |s x c|, least of many light lines.
#[test]
fn ray_distance_is_equation_4_2() {
    let values = everywhere(&Method::RayDistance, |_, light, sample, found| {
        let found = found.expect("no ray is parallel to the lines");
        let (s, c) = (sample.s(), light.axes[1]);
        let across = s.cross(c);
        let distance = |k: f64| {
            let b = light.center + light.axes[0] * (k * light.spacing) - sample.r;
            across.dot(b) / across.length()
        };
        let offset = (light.center - sample.r).length() + found.y.abs() * light.spacing;
        // The common perpendicular turns by the error of the ray over the sine of the angle between ray and lines.
        let tolerance = 4.0 * ANGLE * offset / across.length();
        assert!((found.x - distance(found.y)).abs() <= tolerance, "{found} {}", distance(found.y));
        for k in -60..=60 {
            assert!(found.x.abs() <= distance(found.y + f64::from(k)).abs() + tolerance, "{found} {k}");
        }
    });
    assert_eq!(values, 4000);
}

/// Bands d <= eps shrink to the reflection line: at a point whose mirrored ray passes a line at distance d, the reflection field is off
/// k spacing by d over the sine between ray and plane, across the lines, and never by less than d.
#[test]
fn bands_shrink_to_reflection_lines() {
    let mut compared = 0;
    everywhere(&Method::RayDistance, |_, light, sample, found| {
        let (at, t, _) = by_ulmet(light, sample);
        let Some(found) = found.filter(|_| t > 0.0) else { return };
        let s = sample.s();
        let k = light.axes[0].cross(light.axes[1]);
        // In the plane across the lines.
        let sine = s.dot(k).abs() / s.cross(light.axes[1]).length();
        let off = (at.x - found.y * light.spacing).abs();
        assert!((off * sine - found.x.abs()).abs() <= 40.0 * ANGLE * (10.0 + t / sine), "{off} {sine} {found}");
        compared += 1;
    });
    assert!(compared > 2000, "{compared}");
}

/// Directions on the sphere, sec. 6: longitude from the first axis, latitude from the equator; the light's normal points to the south pole.
#[test]
fn environment_is_longitude_and_latitude() {
    for mirrored in [Mirrored::Reflection, Mirrored::Normal] {
        let values = everywhere(&Method::Sphere(mirrored), |_, light, sample, found| {
            let d = if mirrored == Mirrored::Normal { sample.n } else { sample.s() };
            let north = light.axes[1].cross(light.axes[0]);
            let sine = d.dot(north);
            let cos = (d - sine * north).length();
            let angle = (d.dot(light.axes[0]) / cos).clamp(-1.0, 1.0).acos().to_degrees();
            let longitude = if d.dot(light.axes[1]) < 0.0 { -angle } else { angle };
            let found = found.expect("no pole");
            // The arc cosine loses half the digits at 0 and 180 degrees; both lose at the poles.
            assert!((found.x - longitude).abs() <= 1e-6 / cos, "{found} {longitude}");
            let on_circle = DVec2::from_angle(found.x.to_radians()) * cos;
            let expected = DVec2::new(d.dot(light.axes[0]), d.dot(light.axes[1]));
            assert!(on_circle.distance(expected) <= 8.0 * ANGLE, "{found} {expected}");
            assert!((found.y.to_radians().sin() - sine).abs() <= 8.0 * ANGLE, "{found} {sine}");
        });
        assert_eq!(values, 4000);
    }
}

/// The second line of Ulmet's eq. 2.5, p and a at the same angle to n, for the directions themselves.
#[test]
fn mirrored_directions_keep_the_angle() {
    everywhere(&Method::Reflection, |_, _, sample, _| {
        let mirrored = reflection_direction(sample.n, -3.0 * sample.to_eye);
        assert!((mirrored / 3.0).distance(sample.s()) < 1e-15);
        assert!((mirrored.dot(sample.n) / 3.0 - sample.to_eye.dot(sample.n)).abs() < 1e-15);
    });
}

/// On a plane the reflection field is the mirror image: coordinate by coordinate, without any ray.
#[test]
fn planes_show_the_mirror_image() {
    let plane = crate::scene::GRAPHS[0];
    let surface = plane.surface();
    let light = Light::new(DVec3::new(0.5, 0.2, 3.0), DVec3::NEG_Z, DVec3::new(0.3, 1.0, 0.0), 0.5);
    let eye = DVec3::new(0.3, -2.0, 1.5);
    let camera = catoptric::field::Camera {
        eye,
        target: DVec3::ZERO,
        up: DVec3::Z,
        projection: catoptric::field::Projection::Perspective { fov: 40.0 },
        size: [64; 2],
    };
    let field = Field::reflection(light);
    let mut seen = 0;
    for face in 0..surface.ptex_count() as u32 {
        let Some((patch, uv)) = surface.locate(face, [0.3, 0.8]) else { continue };
        let at = surface.evaluate(patch, uv).position;
        // From the mirror image of the eye, at -z, through the point, up to the height of the light.
        let image = eye * DVec3::new(1.0, 1.0, -1.0);
        let hit = image + (at - image) * ((light.center.z - image.z) / -image.z);
        close(field.at(&surface, &camera, patch, uv), light.coordinates(hit), 1e-13);
        seen += 1;
    }
    assert_eq!(seen, 36);
}
