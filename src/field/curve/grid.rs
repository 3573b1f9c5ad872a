//! A gray picture in the light plane, as a smooth function.

use crate::absent::problem;
use glam::DVec2;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Least number of texels each way: a bicubic patch has so many control values.
const LEAST: u32 = 4;
/// Largest number of texels each way, the texture limit of the software adapter.
const MOST: u32 = 8192;
/// Least width in world units; one over it is the most: shaders have 32 bits.
const LEAST_WIDTH: f64 = 1e-30;

/// g(x, y) as a uniform bicubic B-spline whose control values are the texels of a gray picture, 0 (black) to 1 (white): twice
/// continuously differentiable, so that its contours are smooth. 16-bit pictures keep their digits; colours count by their luminance.
///
/// The picture's middle is at the origin of the plane, its columns run along x, its rows from top to bottom against y. A
/// texel's control value belongs to its centre; g is defined where there are 4 x 4 of them, so a margin of 1.5 texels is not.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    path: PathBuf,
    /// World units that the picture is wide; its texels are squares. `None`: to be fitted.
    width: Option<f64>,
    /// `None` until it is read.
    net: Option<Arc<Net>>,
}

/// Control values, rows from top to bottom.
#[derive(PartialEq)]
struct Net {
    size: [u32; 2],
    values: Vec<f64>,
}

impl Grid {
    /// By what is written for it, `FILE.png` or `FILE.png=WIDTH`, without reading the file; `None` for anything else, an
    /// error for a width that is none.
    pub(in crate::field) fn named(text: &str) -> Option<Result<Grid, String>> {
        let is_picture = |path: &str| Path::new(path).extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
        let named = |path: &str, width| Grid { path: PathBuf::from(path), width, net: None };
        if is_picture(text) {
            return Some(Ok(named(text, None)));
        }
        let (path, width) = text.rsplit_once('=').filter(|(path, _)| is_picture(path))?;
        let width = width.trim().parse().ok().filter(|width| (LEAST_WIDTH..=1.0 / LEAST_WIDTH).contains(width));
        let what = "FILE.png=WIDTH takes a number above 0, which 32 bits hold";
        Some(width.map(|width| named(path, Some(width))).ok_or(what.to_owned()))
    }

    /// A grid of control values, rows from top to bottom, `size[0]` a row, `width` world units wide; `None` where the numbers do
    /// not match or are too few (less than 4 each way).
    pub fn new(size: [u32; 2], values: Vec<f64>, width: f64) -> Option<Grid> {
        let is_fine = size.iter().all(|n| (LEAST..=MOST).contains(n))
            && values.len() == size[0] as usize * size[1] as usize
            && values.iter().all(|value| value.is_finite())
            && (LEAST_WIDTH..=1.0 / LEAST_WIDTH).contains(&width);
        is_fine.then(|| Grid { path: PathBuf::new(), width: Some(width), net: Some(Arc::new(Net { size, values })) })
    }

    /// Reads the picture.
    ///
    /// # Errors
    /// It cannot be read, or is too small or too large: one line.
    pub fn read(&mut self) -> Result<(), String> {
        let path = self.path.clone();
        let bad = |what: String| format!("{}: {what}; give a gray PNG file", path.display());
        let reader = image::ImageReader::open(&path)
            .map_err(|e| bad(format!("cannot read the grid: {}", problem(&path, &e))))?;
        let reader =
            reader.with_guessed_format().map_err(|e| bad(format!("cannot read the grid: {}", problem(&path, &e))))?;
        let picture = reader.decode().map_err(|e| bad(format!("not a picture we read ({e})")))?.to_luma16();
        let size = [picture.width(), picture.height()];
        if size.iter().any(|n| !(LEAST..=MOST).contains(n)) {
            let [w, h] = size;
            return Err(bad(format!("{w}x{h} texels: a grid has {LEAST} to {MOST} each way")));
        }
        let values = picture.into_raw().into_iter().map(|value| f64::from(value) / f64::from(u16::MAX)).collect();
        self.net = Some(Arc::new(Net { size, values }));
        Ok(())
    }

    /// Where the picture is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The same by another path, which is not read.
    pub fn set_path(&mut self, path: PathBuf) {
        self.path = path;
    }

    /// World units that the picture is wide, where that is known.
    pub fn width(&self) -> Option<f64> {
        self.width
    }

    /// The same, so many world units wide.
    pub fn wide(self, width: f64) -> Grid {
        Grid { width: Some(width), ..self }
    }

    /// Texels each way and control values, once they are read.
    pub fn net(&self) -> Option<([u32; 2], &[f64])> {
        self.net.as_ref().map(|net| (net.size, &net.values[..]))
    }

    /// g; NaN where it is not defined, and everywhere until picture and width are there.
    pub fn value(&self, at: DVec2) -> f64 {
        let is_inside = self.half_extents().is_some_and(|half| at.abs().cmple(half).all());
        if is_inside { self.extended(at) } else { f64::NAN }
    }

    /// Half the size of the rectangle, round the origin, where g is defined, world units.
    pub(in crate::field) fn half_extents(&self) -> Option<DVec2> {
        let [columns, rows] = self.net.as_ref()?.size.map(f64::from);
        Some(DVec2::new(columns - 3.0, rows - 3.0) * (0.5 * self.width? / columns))
    }

    /// g, and beyond the rectangle where it is defined the polynomials of its border cells.
    pub(in crate::field) fn extended(&self, at: DVec2) -> f64 {
        let (Some(net), Some(width)) = (&self.net, self.width) else { return f64::NAN };
        let texels = DVec2::new(at.x, -at.y) * (f64::from(net.size[0]) / width);
        let [(column, across), (row, down)] = [0, 1].map(|k| {
            // The cell with the texels first - 1 to first + 2.
            let parameter = texels[k] + 0.5 * f64::from(net.size[k]) - 0.5;
            let first = parameter.floor().clamp(1.0, f64::from(net.size[k] - 3));
            (first as usize - 1, weights(parameter - first))
        });
        (0..4)
            .map(|j| {
                let start = (row + j) * net.size[0] as usize + column;
                let sum: f64 = net.values[start..start + 4].iter().zip(across).map(|(value, w)| value * w).sum();
                sum * down[j]
            })
            .sum()
    }

    /// g as a WGSL expression of `x` and `y`, world units, with shaders/field/grid.wgsl.
    pub(super) fn wgsl(&self) -> String {
        let columns = self.net.as_ref().map_or(1.0, |net| f64::from(net.size[0]));
        format!("grid_value(vec2f(x, -y) * {:?})", (columns / self.width.unwrap_or(1.0)) as f32)
    }
}

/// Weights of the four control values round a place of a uniform cubic B-spline.
fn weights(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [s * s * s / 6.0, (t * t * (3.0 * t - 6.0) + 4.0) / 6.0, (s * s * (3.0 * s - 6.0) + 4.0) / 6.0, t * t * t / 6.0]
}

impl fmt::Debug for Net {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{} values", self.size[0], self.size[1])
    }
}

impl fmt::Display for Grid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        self.width.map_or(Ok(()), |width| write!(f, "={width}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    /// Texels h = 1/2 apart: cubic B-splines reproduce lines, and squares up to h^2/3 of the second derivative's half.
    #[test]
    fn lines_and_squares_are_reproduced() {
        const SIZE: [u32; 2] = [12, 9];
        let h = 0.5;
        let place = |k: u32| {
            let (i, j) = (f64::from(k % SIZE[0]), f64::from(k / SIZE[0]));
            dvec2(i - 0.5 * f64::from(SIZE[0]) + 0.5, 0.5 * f64::from(SIZE[1]) - 0.5 - j) * h
        };
        let grid = |g: &dyn Fn(DVec2) -> f64| {
            let values = (0..SIZE[0] * SIZE[1]).map(|k| g(place(k))).collect();
            Grid::new(SIZE, values, h * f64::from(SIZE[0])).expect("a grid")
        };
        let line = grid(&|p| 3.0 * p.x - 2.0 * p.y + 0.25);
        let square = grid(&|p| p.x * p.x + p.y * p.y + 0.7 * p.x * p.y);
        let mut defined = 0;
        for k in 0..1000 {
            let at = dvec2((0.37 * f64::from(k)).sin() * 2.6, (0.71 * f64::from(k)).cos() * 1.7);
            let is_inside = at.x.abs() <= 4.5 * h && at.y.abs() <= 3.0 * h;
            assert_eq!(line.value(at).is_finite(), is_inside, "{at}");
            if is_inside {
                defined += 1;
                assert!((line.value(at) - (3.0 * at.x - 2.0 * at.y + 0.25)).abs() < 1e-14, "{at}");
                let expected = at.length_squared() + 0.7 * at.x * at.y + 2.0 * h * h / 3.0;
                assert!((square.value(at) - expected).abs() < 1e-13, "{at}");
            }
        }
        assert!(defined > 300, "{defined}");
        // The ends belong to it.
        assert!(line.value(dvec2(4.5 * h, -3.0 * h)).is_finite());
    }

    #[test]
    fn names_are_written_as_they_are_read() {
        for text in ["grid.png", "a/b=c.PNG=2.5", "a.png=0.001"] {
            let grid = Grid::named(text).expect("a picture").expect("with a width, if any");
            assert_eq!(grid.to_string(), text);
            assert!(grid.value(DVec2::ZERO).is_nan());
        }
        assert!(Grid::named("x^2 - y").is_none() && Grid::named("ellipse=2").is_none());
        for text in ["a.png=", "a.png=0", "a.png=-1", "a.png=inf", "a.png=wide"] {
            assert!(Grid::named(text).expect("a picture").is_err(), "{text}");
        }
        assert!(Grid::new([3, 9], vec![0.0; 27], 1.0).is_none() && Grid::new([4, 4], vec![0.0; 15], 1.0).is_none());
    }
}
