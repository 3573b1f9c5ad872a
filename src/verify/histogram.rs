//! How errors are spread over the orders of magnitude.

use serde::Serialize;

/// Counts of errors by size, four bins a decade: bin i of [`counts`](Self::counts) holds those in
/// [10^((first+i)/4), 10^((first+i+1)/4)), borders to within rounding. Bins before the first and after the last are empty.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Histogram {
    /// Errors of exactly 0, which have no logarithm.
    pub zero: u64,
    /// Errors that are no finite number.
    pub not_finite: u64,
    /// Quarter decade at which the first bin starts.
    pub first: i32,
    /// Errors in each bin. What is below 1e-18 counts in its bin, what is 1e3 and above in the one that ends there.
    pub counts: Vec<u64>,
}

impl Histogram {
    /// Bins a decade.
    pub const PER_DECADE: i32 = 4;

    /// Quarter decades of the smallest and the largest bin: 1e-18, below every rounding error of a double near 1, and
    /// 1e3, which ends the bin of 180 degrees.
    const RANGE: [i32; 2] = [-18 * Self::PER_DECADE, 3 * Self::PER_DECADE - 1];

    /// Counts an error, which is not negative.
    pub fn add(&mut self, error: f64) {
        match error {
            0.0 => self.zero += 1,
            error if !error.is_finite() => self.not_finite += 1,
            error => {
                let bin = (error.log10() * f64::from(Self::PER_DECADE)).floor() as i32;
                *self.bin(bin.clamp(Self::RANGE[0], Self::RANGE[1])) += 1;
            }
        }
    }

    /// Counts all that another one counted.
    pub fn merge(&mut self, other: &Self) {
        self.zero += other.zero;
        self.not_finite += other.not_finite;
        for (bin, &count) in (other.first..).zip(&other.counts) {
            *self.bin(bin) += count;
        }
    }

    /// The count of the bin that starts at a quarter decade, made if it is not there.
    fn bin(&mut self, bin: i32) -> &mut u64 {
        if self.counts.is_empty() {
            self.first = bin;
        }
        if bin < self.first {
            let missing = (self.first - bin) as usize;
            self.counts.splice(0..0, std::iter::repeat_n(0, missing));
            self.first = bin;
        }
        let index = (bin - self.first) as usize;
        if index >= self.counts.len() {
            self.counts.resize(index + 1, 0);
        }
        &mut self.counts[index]
    }

    /// Errors counted.
    pub fn total(&self) -> u64 {
        self.zero + self.not_finite + self.counts.iter().sum::<u64>()
    }

    /// Borders and count of each bin.
    pub fn bins(&self) -> impl Iterator<Item = ([f64; 2], u64)> {
        let border = |bin: i32| 10f64.powf(f64::from(bin) / f64::from(Self::PER_DECADE));
        (self.first..).zip(&self.counts).map(move |(bin, &count)| ([border(bin), border(bin + 1)], count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_error_has_its_bin() {
        let errors = [3e-7, 0.0, 2e-16, 1.5e-7, f64::NAN, 179.9, 2e-16, f64::INFINITY, 1e-300, 1e30];
        let mut histogram = Histogram::default();
        errors.iter().for_each(|&error| histogram.add(error));
        assert_eq!((histogram.zero, histogram.not_finite, histogram.total()), (1, 2, 10));
        let holding = |error: f64| histogram.bins().find(|([low, high], _)| (*low..*high).contains(&error));
        assert_eq!(holding(2e-16).map(|(_, count)| count), Some(2));
        for error in [3e-7, 1.5e-7, 179.9] {
            assert_eq!(holding(error).map(|(_, count)| count), Some(1), "{error}");
        }
        // The outermost bins take what lies beyond them.
        let counts: Vec<_> = histogram.bins().collect();
        assert!(counts[0].1 == 1 && (counts[0].0[0] / 1e-18 - 1.0).abs() < 1e-9, "{counts:?}");
        assert!(counts[counts.len() - 1].1 == 1 && (counts[counts.len() - 1].0[1] / 1e3 - 1.0).abs() < 1e-9);
    }

    #[test]
    fn merging_is_counting_all() {
        let of = |errors: &[f64]| {
            let mut histogram = Histogram::default();
            errors.iter().for_each(|&error| histogram.add(error));
            histogram
        };
        let [a, b] = [[1e-3, 0.0, 5e-9], [1e-15, 2.0, f64::NAN]];
        let mut merged = of(&a);
        merged.merge(&of(&b));
        assert_eq!(merged, of(&[a, b].concat()));
        merged.merge(&Histogram::default());
        assert_eq!(merged, of(&[a, b].concat()));
    }
}
