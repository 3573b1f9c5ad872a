//! Where errors are looked for, and what they are summed up in.

use glam::DVec3;

/// Mean, 99th percentile (nearest rank) and maximum.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct Spread {
    /// How many values there are.
    pub count: usize,
    /// Mean.
    pub mean: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Largest value.
    pub max: f64,
}

impl Spread {
    /// Of all values but NaN.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Spread {
        let mut values: Vec<f64> = values.into_iter().filter(|x| !x.is_nan()).collect();
        values.sort_by(f64::total_cmp);
        let Some(&max) = values.last() else { return Spread::default() };
        let count = values.len();
        let mean = values.iter().sum::<f64>() / count as f64;
        Spread { count, mean, p99: values[(count * 99).div_ceil(100) - 1], max }
    }
}

/// A number of two or three digits, as people read them: 1.2e-5, 0.034, 5.67, 89; whole numbers below a million in full.
pub fn short(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        size if size < 1e-3 => format!("{x:.1e}"),
        size if size < 0.0995 => format!("{x:.3}"),
        size if size < 9.95 => format!("{x:.2}"),
        size if size < 999_999.5 => format!("{x:.0}"),
        _ => format!("{x:.1e}"),
    }
}

/// A number in as many digits as it takes to read it back, very small and large ones with an exponent: 0.001, 2, 1e-12.
pub fn exact(x: f64) -> String {
    match x.abs() {
        size if size != 0.0 && !(1e-5..1e9).contains(&size) => format!("{x:e}"),
        _ => x.to_string(),
    }
}

/// Point `i` of a sequence that fills the unit square evenly (Roberts' R2: multiples of the plastic number's powers).
pub fn scatter(i: u32) -> [f64; 2] {
    [0.754_877_666_246_692_8, 0.569_840_290_998_053_3].map(|step| (0.5 + f64::from(i) * step).fract())
}

/// Angle between two normals in degrees, exact for small ones; NaN where one is none.
pub fn angle_deg(a: DVec3, b: DVec3) -> f64 {
    match a != DVec3::ZERO && b != DVec3::ZERO {
        true => a.cross(b).length().atan2(a.dot(b)).to_degrees(),
        false => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let texts = [0.0, 1.23e-5, 0.0336, 0.456, 9.0, 144.4, 999_999.4, 999_999.5, -3.2e307, f64::INFINITY].map(short);
        assert_eq!(texts, ["0", "1.2e-5", "0.034", "0.46", "9.00", "144", "999999", "1.0e6", "-3.2e307", "inf"]);
        let texts = [0.0, 1e-12, 0.001, 2.0, 123_456.75, 1.25e300].map(exact);
        assert_eq!(texts, ["0", "1e-12", "0.001", "2", "123456.75", "1.25e300"]);
    }

    #[test]
    fn percentiles_are_of_nearest_rank() {
        let spread = Spread::of((1..=200).map(f64::from).chain([f64::NAN]));
        assert_eq!(spread, Spread { count: 200, mean: 100.5, p99: 198.0, max: 200.0 });
        assert_eq!(Spread::of([3.0]), Spread { count: 1, mean: 3.0, p99: 3.0, max: 3.0 });
        assert_eq!(Spread::of([f64::NAN]).count, 0);
        assert_eq!(Spread::of([1.0, f64::INFINITY]).max, f64::INFINITY);
    }
}
