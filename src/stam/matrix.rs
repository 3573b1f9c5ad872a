//! Small dense matrices, as class tables need them.

/// A dense matrix, row-major.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    columns: usize,
    values: Vec<f64>,
}

impl Matrix {
    /// A matrix of zeros.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self { columns, values: vec![0.0; rows * columns] }
    }

    /// A matrix from rows of equal length.
    pub fn from_rows(rows: &[Vec<f64>]) -> Self {
        Self { columns: rows[0].len(), values: rows.concat() }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.values.len() / self.columns
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// A row.
    pub fn row(&self, row: usize) -> &[f64] {
        &self.values[row * self.columns..(row + 1) * self.columns]
    }

    /// All entries, row after row.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Applies `f` to every entry (row, column, value).
    pub fn map(&self, f: impl Fn(usize, usize, f64) -> f64) -> Self {
        let values = self.values.iter().enumerate().map(|(k, &x)| f(k / self.columns, k % self.columns, x));
        Self { columns: self.columns, values: values.collect() }
    }

    /// The product with `other`.
    pub fn times(&self, other: &Self) -> Self {
        let mut out = Self::zeros(self.rows(), other.columns);
        for (row, target) in out.values.chunks_exact_mut(other.columns).enumerate() {
            for (k, &factor) in self.row(row).iter().enumerate().filter(|(_, x)| **x != 0.0) {
                for (t, &x) in target.iter_mut().zip(other.row(k)) {
                    *t += factor * x;
                }
            }
        }
        out
    }

    /// Largest absolute entry.
    pub fn largest(&self) -> f64 {
        self.values.iter().fold(0.0, |m, x| m.max(x.abs()))
    }
}
