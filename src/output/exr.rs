//! OpenEXR pictures: colour, and what every pixel's centre sees, in full precision.

use super::whole::write_sealed;
use super::{MADE_BY, OutputError, WriteSeek, seal};
use crate::field::{Camera, Projection};
use crate::gpu::{LinearFrame, NO_PATCH, PatchSource, SurfaceImage};
use ::exr::error::Error;
use ::exr::math::Vec2;
use ::exr::prelude::{
    AttributeValue, Encoding, Image, ImageAttributes, Layer, LayerAttributes, SpecificChannels, Text, WritableImage,
};
use glam::{DMat4, DVec2, DVec3, DVec4};
use std::io::{BufRead, Cursor, Seek};
use std::path::Path;

/// `ptex.face` of a pixel that sees no surface.
pub const NO_FACE: u32 = u32::MAX;

/// The attribute with the digest of the file, and how it stands in the header: name, type, and the length of the digits (OpenEXR File
/// Layout, "attribute layout").
const DIGEST: &str = "catoptric_digest";
const DIGEST_MARK: &[u8] = b"catoptric_digest\0string\0\x10\0\0\0";

/// What an EXR file is made of.
#[derive(Debug, Clone, Copy)]
pub struct Layers<'a> {
    /// From where the picture was taken.
    pub camera: &'a Camera,
    /// Linear colour, premultiplied, coverage in alpha: channels R, G, B and A.
    pub colour: &'a LinearFrame,
    /// What pixel centres see, of the same size: P, N, ptex, field and residual.
    pub seen: &'a SurfaceImage,
    /// Where the patches came from, which knows the ptex face of each.
    pub source: &'a dyn PatchSource,
    /// How the picture was made: the attribute [`MADE_BY`].
    pub made_by: &'a str,
}

/// One pixel of the layers under the surface; NaN where there is nothing to say.
struct Pixel {
    position: [f32; 3],
    normal: [f32; 3],
    face: u32,
    uv: [f32; 2],
    field: f32,
    residual: f32,
}

impl Layers<'_> {
    /// What pixel `i` sees. The residual is the distance in pixels between its centre and where its point appears.
    fn pixel(&self, i: usize) -> Pixel {
        let nothing = [f32::NAN; 3];
        if self.seen.patch[i] == NO_PATCH {
            let [x, y, _] = nothing;
            return Pixel { position: nothing, normal: nothing, face: NO_FACE, uv: [x, y], field: x, residual: x };
        }
        let (face, uv) = self.source.to_ptex(self.seen.patch[i] as usize, self.seen.uv[i].map(f64::from));
        let position = self.seen.position[i];
        let width = self.seen.size[0] as usize;
        let centre = DVec2::new((i % width) as f64, (i / width) as f64) + 0.5;
        let off = |pixel: [f64; 2]| DVec2::from_array(pixel).distance(centre);
        Pixel {
            position: position.as_vec3().to_array(),
            normal: self.seen.normal[i],
            face,
            uv: uv.map(|x| x as f32),
            field: self.seen.field[i].map_or(f32::NAN, |value| value.x as f32),
            residual: self.camera.project(position).map_or(f32::NAN, |pixel| off(pixel) as f32),
        }
    }
}

/// From world space to camera space as OpenEXR defines it (ImfStandardAttributes.h): left-handed, x to the right, y up, z
/// along the line of sight, the eye at the origin. For column vectors; OpenEXR stores the transpose.
pub fn world_to_camera(camera: &Camera) -> DMat4 {
    let axes = camera.axes();
    let row = |axis: DVec3| axis.extend(-axis.dot(camera.eye));
    DMat4::from_cols(row(axes.right), row(axes.up), row(axes.forward), DVec4::W).transpose()
}

/// From world space to the picture as OpenEXR defines it: after the division by w, (0,0) is its upper left corner and
/// (1,1) its lower right one. The third coordinate, which the definition leaves open, grows with distance and is 0 at
/// the target.
pub fn world_to_ndc(camera: &Camera) -> DMat4 {
    let [sx, sy] = camera.axes().scale;
    let distance = camera.eye.distance(camera.target);
    let w = match camera.projection {
        Projection::Perspective { .. } => DVec4::Z,
        Projection::Orthographic { .. } => DVec4::W,
    };
    let rows = [0.5 * (w + sx * DVec4::X), 0.5 * (w - sy * DVec4::Y), DVec4::Z - distance * DVec4::W, w];
    DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose() * world_to_camera(camera)
}

/// Writes the layers as 32-bit float channels, `ptex.face` as 32-bit integers: `R G B A`, `P.X P.Y P.Z` and `N.X N.Y N.Z` in
/// world space, `ptex.face ptex.u ptex.v`, `field` (the coordinate across the light lines, world units) and `residual`
/// (pixels). Where nothing is seen they are NaN, and the face is [`NO_FACE`]. Scan lines from top to bottom, zip-compressed
/// without loss. Pixels are put together while they are written, so that this takes no memory beside the layers.
///
/// # Errors
/// As [`write_whole`](super::write_whole); layers that differ in size are an error too.
pub fn write_exr(path: &Path, layers: &Layers<'_>) -> Result<(), OutputError> {
    write_sealed(path, |out| encode(out, layers), |file| seal::write(file, DIGEST_MARK))
}

/// The bytes of the file that [`write_exr`] makes.
///
/// # Errors
/// Layers that differ in size.
pub fn exr_bytes(layers: &Layers<'_>) -> std::io::Result<Vec<u8>> {
    let mut file = Cursor::new(Vec::new());
    encode(&mut file, layers)?;
    seal::write(&mut file, DIGEST_MARK)?;
    Ok(file.into_inner())
}

/// All but the digest.
fn encode(out: &mut dyn WriteSeek, layers: &Layers<'_>) -> std::io::Result<()> {
    let size @ [width, height] = layers.seen.size;
    if layers.colour.size != size || layers.camera.size != size {
        return Err(std::io::Error::other("layers differ in size"));
    }
    let matrix = |matrix: DMat4| Some(matrix.to_cols_array().map(|x| x as f32));
    let mut attributes = LayerAttributes {
        world_to_camera: matrix(world_to_camera(layers.camera)),
        world_to_normalized_device: matrix(world_to_ndc(layers.camera)),
        software_name: Some(Text::from(concat!("catoptric ", env!("CARGO_PKG_VERSION")))),
        ..LayerAttributes::default()
    };
    // As UTF-8, whatever the mesh is called.
    let made_by = Text::from_bytes_unchecked(layers.made_by.as_bytes().into());
    attributes.other.insert(Text::from(MADE_BY), AttributeValue::Text(made_by));
    let pixel = |at: Vec2<usize>| {
        let i = at.y() * width as usize + at.x();
        let ([r, g, b, a], p) = (layers.colour.rgba[i], layers.pixel(i));
        let ([x, y, z], [nx, ny, nz], [u, v]) = (p.position, p.normal, p.uv);
        (r, g, b, a, x, y, z, nx, ny, nz, p.face, u, v, p.field, p.residual)
    };
    let channels = SpecificChannels::build()
        .with_channel::<f32>("R")
        .with_channel::<f32>("G")
        .with_channel::<f32>("B")
        .with_channel::<f32>("A")
        .with_channel::<f32>("P.X")
        .with_channel::<f32>("P.Y")
        .with_channel::<f32>("P.Z")
        .with_channel::<f32>("N.X")
        .with_channel::<f32>("N.Y")
        .with_channel::<f32>("N.Z")
        .with_channel::<u32>("ptex.face")
        .with_channel::<f32>("ptex.u")
        .with_channel::<f32>("ptex.v")
        .with_channel::<f32>("field")
        .with_channel::<f32>("residual")
        .with_pixel_fn(pixel);
    let layer = Layer::new((width as usize, height as usize), attributes, Encoding::SMALL_LOSSLESS, channels);
    // Not beside the other: of several, a header has the first one that a hash finds, and the file would be another each time.
    let mut shared = ImageAttributes::with_size((width as usize, height as usize));
    shared.other.insert(Text::from(DIGEST), AttributeValue::Text(Text::from(seal::BLANK)));
    let image = Image::new(shared, layer);
    image.write().to_buffered(out).map_err(plain)
}

/// What the system said, where it is the system's fault.
fn plain(error: Error) -> std::io::Error {
    match error {
        Error::Io(error) => error,
        other => std::io::Error::other(other),
    }
}

/// The attribute of an EXR file that says how it was made; `None` where it has none.
///
/// # Errors
/// The file cannot be read, is no EXR, or does not prove that it is whole by the digest that [`write_exr`] puts into it.
pub fn read_exr_made_by(mut file: impl BufRead + Seek) -> std::io::Result<Option<String>> {
    let is_proved = seal::prove(&mut file, DIGEST_MARK)?;
    file.rewind()?;
    let reader = ::exr::block::read(&mut file, false).map_err(plain)?;
    let found = reader.headers().iter().find_map(|header| header.own_attributes.other.get(MADE_BY.as_bytes()));
    let made_by = match found {
        Some(AttributeValue::Text(text)) => String::from_utf8(text.as_slice().to_vec()).ok(),
        _ => None,
    };
    // Others have no digest, and nothing of theirs is proved.
    match made_by {
        Some(_) if !is_proved => Err(std::io::Error::other("it has no digest that proves it whole")),
        made_by => Ok(made_by),
    }
}
