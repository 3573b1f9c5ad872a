//! The three layouts of the tables, and what they take.

use super::basis::Basis;
use super::{PatchSource, Storage, TABLE_LEVELS};
use crate::gpu::shader::{LEVEL_TEXELS, SCALE_LEVELS, TRIANGLE_TEXELS};
use glam::DAffine3;
use rayon::prelude::*;
use std::collections::HashSet;
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

/// Memory that tables may take before [`TableLayout::Auto`] prefers the smallest layout to the fastest: half of the
/// smallest adapter that professional programs still ask for (2 GiB), which leaves as much for pictures; a software
/// adapter takes it from the machine, where a million creased faces should fit in 6 GiB.
pub const BUDGET: u64 = 1 << 30;

/// What is not worth saving: below it the fastest layout is taken. (Measured on lavapipe, built-in sample at 2048^2 samples:
/// the limit pass takes 0.15 s expanded and 0.18 s hybrid, whose shader has one more loop.)
const AMPLE: u64 = 8 << 20;

/// Levels that the hybrid layout stores point by point: 1 - 4^-4 of the parameter area.
const HYBRID_LEVELS: usize = 4;
/// Texels of a regular patch: 4 rows of 4 points, x, y and z each.
const REGULAR_TEXELS: usize = 12;
/// Texels of a Gregory patch: a row more.
const GREGORY_TEXELS: usize = REGULAR_TEXELS + 3;

/// How the levels of irregular patches are stored. The surface is the same to the rounding of f32.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TableLayout {
    /// Expanded where that is little (8 MiB) or no more than hybrid; else hybrid; compact where that exceeds [`BUDGET`] or
    /// the adapter.
    #[default]
    Auto,
    /// Every level of every patch: fastest, 10.4 kB an irregular patch.
    Expanded,
    /// A few points a patch, matrices a class: smallest, but every pixel of an irregular patch combines its points.
    Compact,
    /// Levels 1 to 4 expanded, the rest compact: as fast as expanded but for 1/256 of a patch, under 2 kB.
    Hybrid,
}

impl TableLayout {
    /// The three layouts that `Auto` chooses from.
    pub const ALL: [Self; 3] = [Self::Expanded, Self::Compact, Self::Hybrid];

    /// Levels stored point by point.
    fn expanded_levels(self) -> usize {
        match self {
            Self::Expanded => TABLE_LEVELS,
            Self::Compact => 0,
            Self::Hybrid | Self::Auto => HYBRID_LEVELS,
        }
    }
}

impl fmt::Display for TableLayout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Auto => "auto",
            Self::Expanded => "expanded",
            Self::Compact => "compact",
            Self::Hybrid => "hybrid",
        })
    }
}

impl FromStr for TableLayout {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let all = [Self::Auto, Self::Expanded, Self::Compact, Self::Hybrid];
        let found = all.into_iter().find(|layout| layout.to_string() == name);
        found.ok_or_else(|| format!("no table layout {name}: give auto, expanded, compact or hybrid"))
    }
}

/// Bytes that the tables of patches take on an adapter, without building them. `Auto`: those of its choice, if the
/// adapter has room for it.
pub fn bytes(source: &impl PatchSource, layout: TableLayout) -> u64 {
    Plan::new(source, layout, u64::MAX).bytes
}

/// A layout applied to a surface: where everything goes.
#[derive(Debug)]
pub(super) struct Plan {
    pub layout: TableLayout,
    /// Levels stored point by point of the patches that have a class.
    pub expanded: usize,
    /// The rest, class by class; none where all levels are expanded.
    pub bases: Arc<Vec<Option<Arc<Basis>>>>,
    /// Some patches are [`Storage::Gregory`].
    pub has_gregory: bool,
    /// Patches are triangles.
    pub has_triangles: bool,
    /// What moves instances; none where there are more than records can count, so that every patch has its own points.
    pub transforms: Vec<DAffine3>,
    /// Texels in the table of points: transforms and matrices first, then patches.
    pub texels: u64,
    /// Bytes of all tables.
    pub bytes: u64,
    /// Bytes of what classes share.
    pub matrices: u64,
    /// Most bytes of a patch.
    pub largest_patch: u64,
}

impl Plan {
    /// Plans `layout`; `Auto` keeps to [`BUDGET`] and to `limit` texels of points.
    pub fn new<S: PatchSource + ?Sized>(source: &S, layout: TableLayout, limit: u64) -> Plan {
        let transforms = shared(source);
        let census = Census::new(source, &transforms);
        let of = |layout: TableLayout| {
            Plan::of(&census, layout, bases(source, layout), census.gregory > 0, transforms.clone())
        };
        if layout != TableLayout::Auto {
            return of(layout);
        }
        let [expanded, hybrid] = [TableLayout::Expanded, TableLayout::Hybrid].map(of);
        let plan = if expanded.bytes > AMPLE.max(hybrid.bytes) { hybrid } else { expanded };
        match plan.bytes <= BUDGET && plan.texels <= limit {
            true => plan,
            false => {
                let compact = of(TableLayout::Compact);
                if compact.bytes < plan.bytes { compact } else { plan }
            }
        }
    }

    /// The plan of some patches of the source that this one is for: in the same layout, with the same matrices, each patch with
    /// points of its own.
    pub fn for_part<S: PatchSource + ?Sized>(&self, part: &S) -> Plan {
        Plan::of(&Census::new(part, &[]), self.layout, self.bases.clone(), self.has_gregory, Vec::new())
    }

    fn of(
        census: &Census,
        layout: TableLayout,
        bases: Arc<Vec<Option<Arc<Basis>>>>,
        has_gregory: bool,
        transforms: Vec<DAffine3>,
    ) -> Plan {
        let expanded = layout.expanded_levels();
        let has_triangles = census.triangles + census.irregular_triangles > 0;
        let mut plan = Plan {
            layout,
            expanded,
            bases,
            has_gregory,
            transforms,
            has_triangles,
            texels: 0,
            bytes: 0,
            matrices: 0,
            largest_patch: 0,
        };
        let matrices: usize = (0..plan.bases.len()).map(|class| plan.matrix_texels(class)).sum();
        let irregular: usize =
            census.classes.iter().enumerate().map(|(class, &count)| count * plan.irregular_texels(Some(class))).sum();
        let rest = census.regular * REGULAR_TEXELS
            + census.gregory * GREGORY_TEXELS
            + census.classless * plan.irregular_texels(None)
            + census.triangles * plan.patch_texels(Storage::Triangle, None)
            + census.irregular_triangles * plan.patch_texels(Storage::IrregularTriangle, None);
        plan.texels = (plan.transforms.len() * TRANSFORM_TEXELS + matrices + irregular + rest) as u64;
        plan.matrices = 16 * matrices as u64;
        let classes = census.classes.iter().enumerate().filter(|&(_, &count)| count > 0).map(|(class, _)| Some(class));
        let irregular = classes.chain((census.classless > 0).then_some(None)).map(|class| plan.irregular_texels(class));
        let triangle = plan.patch_texels(Storage::IrregularTriangle, None);
        let triangle = if census.irregular_triangles > 0 { triangle } else { 0 };
        plan.largest_patch = 16 * (1 + irregular.max().unwrap_or(0).max(triangle).max(GREGORY_TEXELS) as u64);
        plan.bytes =
            16 * (census.patches as u64 + plan.texels) + 8 * u64::from(SCALE_LEVELS) * census.eigenvalues as u64;
        plan
    }

    /// What gives the levels of a class that are not expanded.
    pub fn basis(&self, class: usize) -> Option<&Basis> {
        self.bases.get(class)?.as_deref()
    }

    /// Texels of a patch.
    pub fn patch_texels(&self, storage: Storage, class: Option<usize>) -> usize {
        match storage {
            Storage::Regular => REGULAR_TEXELS,
            Storage::Gregory => GREGORY_TEXELS,
            Storage::Irregular => self.irregular_texels(class),
            Storage::Triangle => TRIANGLE_TEXELS as usize,
            Storage::IrregularTriangle => TABLE_LEVELS * TRIANGLE_TEXELS as usize + 1,
        }
    }

    /// Texels of an irregular patch: its expanded levels, its picked points in groups of 4 (x, y and z each), its normal.
    fn irregular_texels(&self, class: Option<usize>) -> usize {
        let levels = |count: usize| count * LEVEL_TEXELS as usize + 1;
        match class.and_then(|class| self.basis(class)) {
            Some(basis) => levels(self.expanded) + 3 * basis.groups(),
            None => levels(TABLE_LEVELS),
        }
    }

    /// Texels of the matrix of a class: 9 rows of 4 points for each picked point of each level.
    pub fn matrix_texels(&self, class: usize) -> usize {
        let groups = self.basis(class).map_or(0, Basis::groups);
        (TABLE_LEVELS - self.expanded) * 4 * groups * (LEVEL_TEXELS / 3) as usize
    }
}

/// What gives the levels of each class that a layout does not expand.
fn bases<S: PatchSource + ?Sized>(source: &S, layout: TableLayout) -> Arc<Vec<Option<Arc<Basis>>>> {
    let levels = layout.expanded_levels() + 1..=TABLE_LEVELS;
    let classes = if levels.is_empty() { &[] } else { source.classes() };
    Arc::new(classes.par_iter().map(|table| Basis::shared(table, *levels.start())).collect())
}

/// Texels of a transform: the columns of its matrix.
pub(super) const TRANSFORM_TEXELS: usize = 3;

/// Transforms that records can count, and scales that they can point to: 16 bits each.
const MOST_TRANSFORMS: usize = u16::MAX as usize;

/// What moves the instances that share points with their originals.
fn shared<S: PatchSource + ?Sized>(source: &S) -> Vec<DAffine3> {
    let transforms = source.transforms();
    let scales = SCALE_LEVELS as usize * source.classes().len();
    if transforms.len() <= MOST_TRANSFORMS && scales <= MOST_TRANSFORMS { transforms } else { Vec::new() }
}

/// How many patches there are, and how many with points of their own of each class.
struct Census {
    patches: usize,
    regular: usize,
    gregory: usize,
    classes: Vec<usize>,
    /// Irregular patches without a class.
    classless: usize,
    triangles: usize,
    irregular_triangles: usize,
    /// Different values of lambda.
    eigenvalues: usize,
}

impl Census {
    fn new<S: PatchSource + ?Sized>(source: &S, transforms: &[DAffine3]) -> Census {
        let mut census = Census {
            patches: source.count(),
            regular: 0,
            gregory: 0,
            classes: vec![0; source.classes().len()],
            classless: 0,
            triangles: 0,
            irregular_triangles: 0,
            eigenvalues: 0,
        };
        let mut eigenvalues = HashSet::new();
        let is_own = |patch: &usize| transforms.is_empty() || source.instance(*patch).is_none();
        for patch in (0..source.count()).filter(is_own) {
            match (source.storage(patch), source.class(patch)) {
                (Storage::Regular, _) => census.regular += 1,
                (Storage::Gregory, _) => census.gregory += 1,
                (Storage::Irregular, Some(class)) => {
                    census.classes[class] += 1;
                    eigenvalues.insert(source.classes()[class].lambda.to_bits());
                }
                (Storage::Irregular, None) => census.classless += 1,
                (Storage::Triangle, _) => census.triangles += 1,
                (Storage::IrregularTriangle, _) => census.irregular_triangles += 1,
            }
        }
        census.eigenvalues = eigenvalues.len() + usize::from(census.classless + census.irregular_triangles > 0);
        census
    }
}
