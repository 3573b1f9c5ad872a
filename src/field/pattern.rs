//! What is drawn on the light plane: f64, with hard edges; `shaders/shade.wgsl` filters the same shapes to the pixel.

use super::colours::{linear_to_srgb, srgb_to_linear};
use super::{Field, Method};
use glam::{DVec2, DVec3, dvec2};

/// A picture in linear RGB, rows from top to bottom.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Width and height in texels, both at least 1.
    pub size: [u32; 2],
    /// sRGB-encoded RGBA texels, 4 bytes each; alpha is ignored.
    pub rgba8: Vec<u8>,
}

/// The shape of the lights on the plane. Lengths are fractions of the light's `spacing`.
#[derive(Debug, Clone, PartialEq)]
pub enum Pattern {
    /// Parallel tubes at x = k spacing, `width` wide.
    Stripes {
        /// Part of the period that shines, 0 to 1.
        width: f64,
    },
    /// Two crossing families of tubes, x = k spacing and y = k spacing (Yasui & Kanai 2004, fig. 6a).
    Lattice {
        /// Part of the period that shines, 0 to 1.
        width: f64,
    },
    /// Regularly arranged discs (Yasui & Kanai 2004, fig. 6b).
    Circles {
        /// Radius, 0 to 0.5.
        radius: f64,
    },
    /// A single tube round x = 0, this many periods to each side.
    Band {
        /// Half its width in periods, 0 or more.
        radius: f64,
    },
    /// False colours over the first coordinate, from dark blue over green to yellow; where the ends have different signs, from blue
    /// over white, at 0, to red. The surface is magenta where the field is undefined.
    Heat {
        /// Values at the ends of the scale, in units of the field.
        range: [f64; 2],
    },
    /// A picture, stretched over the light's extents, or repeated every [`Pattern::PICTURE_PERIODS`] periods of an
    /// infinite light. On the sphere it goes once round: an equirectangular environment, longitude 0 and latitude 0 in its middle,
    /// the north pole at its top.
    Picture(Picture),
}

impl Pattern {
    /// Width of a repeated picture, in periods of the light; its height follows from its shape.
    pub const PICTURE_PERIODS: f64 = 8.0;

    /// Light sent out where a field has the value `point`, linear RGB from 0 to 1; black outside the light's extents where they
    /// are those of the field ([`Method::is_bounded`]).
    pub fn radiance(&self, field: &Field, point: DVec2) -> DVec3 {
        let light = &field.light;
        if field.method.is_bounded() && !light.contains(point) {
            return DVec3::ZERO;
        }
        // Signed distance to the middle of the nearest period, -0.5 to 0.5.
        let cell = |x: f64| x - x.round();
        let p = point / light.spacing;
        let on = match self {
            Pattern::Stripes { width } => cell(p.x).abs() <= width * 0.5,
            Pattern::Lattice { width } => cell(p.x).abs().min(cell(p.y).abs()) <= width * 0.5,
            Pattern::Circles { radius } => dvec2(cell(p.x), cell(p.y)).length() <= *radius,
            Pattern::Band { radius } => p.x.abs() <= *radius,
            // Colours are no light.
            Pattern::Heat { .. } => false,
            Pattern::Picture(picture) => return picture.texel(point * self.picture_scale(field) + 0.5),
        };
        if on { DVec3::ONE } else { DVec3::ZERO }
    }

    /// Distance along the light's first axis after which the pattern comes back, world units: of a picture that is not
    /// repeated, its width.
    pub fn period(&self, field: &Field) -> f64 {
        match self {
            Pattern::Picture(_) => 1.0 / self.picture_scale(field).x,
            _ => field.light.spacing,
        }
    }

    /// Factor from plane coordinates in world units to texture coordinates (0 to 1 across the picture, y downwards; add
    /// 0.5). Ones for the other patterns.
    pub fn picture_scale(&self, field: &Field) -> DVec2 {
        let Pattern::Picture(picture) = self else { return DVec2::ONE };
        let Field { light, method } = field;
        let (width, height) = match method {
            Method::Sphere(_) => (360.0, 180.0),
            _ => {
                let width = light.spacing * Self::PICTURE_PERIODS;
                (width, width * f64::from(picture.size[1]) / f64::from(picture.size[0]))
            }
        };
        let side = |half: f64, repeat: f64| if half.is_finite() { 2.0 * half } else { repeat };
        dvec2(1.0 / side(light.half[0], width), -1.0 / side(light.half[1], height))
    }
}

impl Picture {
    /// The picture at half the size (rounded down, at least 1), averaged in linear light.
    pub fn halved(&self) -> Picture {
        let size = self.size.map(|n| (n / 2).max(1));
        let mut rgba8 = Vec::with_capacity(4 * (size[0] * size[1]) as usize);
        for k in 0..size[0] * size[1] {
            let (x, y) = (k % size[0], k / size[0]);
            let corners = [(0, 0), (1, 0), (0, 1), (1, 1)]
                .map(|(i, j)| self.linear((2 * x + i).min(self.size[0] - 1), (2 * y + j).min(self.size[1] - 1)));
            let mean = corners.into_iter().sum::<DVec3>() * 0.25;
            rgba8.extend(mean.to_array().map(|c| (linear_to_srgb(c) * 255.0).round() as u8));
            rgba8.push(255);
        }
        Picture { size, rgba8 }
    }

    /// A texel in linear RGB.
    fn linear(&self, x: u32, y: u32) -> DVec3 {
        let at = 4 * (y as usize * self.size[0] as usize + x as usize);
        DVec3::from_array(std::array::from_fn(|c| srgb_to_linear(f64::from(self.rgba8[at + c]) / 255.0)))
    }

    /// Nearest texel at texture coordinates (repeating), linear RGB.
    fn texel(&self, uv: DVec2) -> DVec3 {
        let index = |x: f64, n: u32| ((x - x.floor()) * f64::from(n)).min(f64::from(n - 1)) as u32;
        self.linear(index(uv.x, self.size[0]), index(uv.y, self.size[1]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{Light, Mirrored};

    fn field() -> Field {
        Field::reflection(Light::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 2.0))
    }

    #[test]
    fn shapes() {
        let on = |pattern: &Pattern, x: f64, y: f64| pattern.radiance(&field(), dvec2(x, y)) == DVec3::ONE;
        let stripes = Pattern::Stripes { width: 0.25 };
        assert!(on(&stripes, 0.24, 9.0) && on(&stripes, -3.8, 0.0) && !on(&stripes, 0.26, 0.0));
        let lattice = Pattern::Lattice { width: 0.25 };
        assert!(on(&lattice, 1.0, 0.2) && !on(&lattice, 1.0, 1.0));
        let circles = Pattern::Circles { radius: 0.25 };
        assert!(on(&circles, 2.3, -2.3) && !on(&circles, 0.4, 0.4));
    }

    #[test]
    fn extents_and_pictures() {
        let mut field = field();
        field.light.half = [4.0, 2.0];
        let picture = Picture { size: [2, 1], rgba8: vec![255, 0, 0, 255, 0, 255, 0, 255] };
        let pattern = Pattern::Picture(picture);
        assert_eq!(pattern.radiance(&field, dvec2(-1.0, 0.0)), DVec3::X);
        assert_eq!(pattern.radiance(&field, dvec2(3.9, 1.9)), DVec3::Y);
        assert_eq!(pattern.radiance(&field, dvec2(4.1, 0.0)), DVec3::ZERO);
        assert_eq!(pattern.period(&field), 8.0);
        field.light.half = [f64::INFINITY; 2];
        assert_eq!(pattern.period(&field), 16.0);
        assert_eq!(Pattern::Stripes { width: 0.25 }.period(&field), 2.0);
        // Once round the sphere, whatever the spacing.
        field.method = Method::Sphere(Mirrored::Normal);
        assert_eq!(pattern.period(&field), 360.0);
        assert_eq!(pattern.radiance(&field, dvec2(-179.0, 30.0)), DVec3::X);
        assert_eq!(pattern.radiance(&field, dvec2(179.0, -80.0)), DVec3::Y);
    }
}
