//! Where results go: columns that the caller owns.

use std::array;

/// x, y and z of some vector, a number a sample in each.
pub type Column<'a, T> = [&'a mut [T]; 3];

/// Room for results, all slices as long as there are samples.
#[derive(Debug)]
pub struct Columns<'a, T> {
    /// Limit positions, in world units.
    pub position: Column<'a, T>,
    /// Derivatives by u and v of the ptex face.
    pub first: Option<[Column<'a, T>; 2]>,
    /// Second derivatives by uu, uv and vv of the ptex face.
    pub second: Option<[Column<'a, T>; 3]>,
    /// Unit normals: the limit of the normals inside the patch; zero where there is none.
    pub normal: Option<Column<'a, T>>,
}

/// Column `k` of three, cut at `at`.
fn cut<'a, T>(column: Column<'a, T>, at: usize) -> [Column<'a, T>; 2] {
    let [mut before, mut after] = [const { [const { None }; 3] }; 2];
    for (k, slice) in column.into_iter().enumerate() {
        let (a, b) = slice.split_at_mut(at);
        (before[k], after[k]) = (Some(a), Some(b));
    }
    [before, after].map(|half| half.map(|slice| slice.expect("all three are cut")))
}

fn cut_all<'a, T, const N: usize>(columns: [Column<'a, T>; N], at: usize) -> [[Column<'a, T>; N]; 2] {
    let mut halves = columns.map(|column| cut(column, at).map(Some));
    [0, 1].map(|half| array::from_fn(|k| halves[k][half].take().expect("each half is taken once")))
}

impl<'a, T> Columns<'a, T> {
    /// Those of the samples before `at`, and of the others.
    pub(super) fn split_at(self, at: usize) -> [Self; 2] {
        let two = |[a, b]: [Column<'a, T>; 2]| [Some(a), Some(b)];
        let [position, positions] = cut(self.position, at);
        let [first, firsts] = self.first.map_or([None, None], |first| cut_all(first, at).map(Some));
        let [second, seconds] = self.second.map_or([None, None], |second| cut_all(second, at).map(Some));
        let [normal, normals] = self.normal.map_or([None, None], |normal| two(cut(normal, at)));
        [
            Self { position, first, second, normal },
            Self { position: positions, first: firsts, second: seconds, normal: normals },
        ]
    }

    /// All slices.
    pub(super) fn slices(&mut self) -> impl Iterator<Item = &mut &'a mut [T]> {
        let first = self.first.iter_mut().flatten();
        let second = self.second.iter_mut().flatten();
        [&mut self.position].into_iter().chain(first).chain(second).chain(&mut self.normal).flatten()
    }
}

/// What is asked for besides positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Wanted {
    /// First derivatives.
    pub first: bool,
    /// Second derivatives.
    pub second: bool,
    /// Unit normals.
    pub normal: bool,
}

/// Results of an [`Evaluator`](super::Evaluator), column by column: memory behind [`Columns`].
#[derive(Debug, Clone)]
pub struct Results<T> {
    wanted: Wanted,
    columns: Vec<[Vec<T>; 3]>,
}

impl<T: Copy + Default> Results<T> {
    /// Room for the results of `count` samples, zero.
    pub fn new(wanted: Wanted, count: usize) -> Self {
        let Wanted { first, second, normal } = wanted;
        let columns = 1 + 2 * usize::from(first) + 3 * usize::from(second) + usize::from(normal);
        let column = || array::from_fn(|_| vec![T::default(); count]);
        Self { wanted, columns: (0..columns).map(|_| column()).collect() }
    }

    /// Where an evaluator is to write.
    pub fn columns(&mut self) -> Columns<'_, T> {
        let Wanted { first, second, normal } = self.wanted;
        let mut all = self.columns.iter_mut();
        let mut next = || all.next().expect("as many as are wanted").each_mut().map(|column| &mut column[..]);
        Columns {
            position: next(),
            first: first.then(|| array::from_fn(|_| next())),
            second: second.then(|| array::from_fn(|_| next())),
            normal: normal.then(next),
        }
    }

    /// Sets all numbers.
    pub fn fill(&mut self, x: T) {
        self.columns.as_flattened_mut().iter_mut().for_each(|column| column.fill(x));
    }

    fn vector(&self, column: usize, sample: usize) -> [T; 3] {
        self.columns[column].each_ref().map(|numbers| numbers[sample])
    }

    /// Limit position of a sample.
    ///
    /// # Panics
    /// There is no such sample; so for the others.
    pub fn position(&self, sample: usize) -> [T; 3] {
        self.vector(0, sample)
    }

    /// Derivatives by u and v, if they were asked for.
    pub fn first(&self, sample: usize) -> Option<[[T; 3]; 2]> {
        self.wanted.first.then(|| array::from_fn(|k| self.vector(1 + k, sample)))
    }

    /// Derivatives by uu, uv and vv, if they were asked for.
    pub fn second(&self, sample: usize) -> Option<[[T; 3]; 3]> {
        let at = 1 + 2 * usize::from(self.wanted.first);
        self.wanted.second.then(|| array::from_fn(|k| self.vector(at + k, sample)))
    }

    /// Unit normal, if it was asked for.
    pub fn normal(&self, sample: usize) -> Option<[T; 3]> {
        self.wanted.normal.then(|| self.vector(self.columns.len() - 1, sample))
    }
}
