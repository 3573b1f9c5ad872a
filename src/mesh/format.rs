//! Formats of mesh files.

use std::path::Path;

use super::packed;

/// A format that meshes are read from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MeshFormat {
    /// Wavefront OBJ, with the `t` tags of OpenSubdiv.
    Obj,
    /// USD as text or in binary form.
    Usd,
    /// USD as text.
    Usda,
    /// USD in binary form.
    Usdc,
    /// A package of USD files.
    Usdz,
}

impl MeshFormat {
    /// All formats.
    pub const ALL: [Self; 5] = [Self::Obj, Self::Usd, Self::Usda, Self::Usdc, Self::Usdz];

    /// The extension of its files, in lower case.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Usd => "usd",
            Self::Usda => "usda",
            Self::Usdc => "usdc",
            Self::Usdz => "usdz",
        }
    }

    /// The format of an extension, in lower or upper case.
    pub fn of_extension(extension: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| format.extension().eq_ignore_ascii_case(extension))
    }

    /// The format of a file of this name: its extension says it, also if `.gz` is behind it.
    pub fn of_path(path: &Path) -> Option<Self> {
        Self::of_extension(packed::unpacked_path(path).extension()?.to_str()?)
    }

    /// The format of a content: USD says what it is in its first bytes, and everything else is taken for an OBJ.
    pub fn of_content(content: &[u8]) -> Self {
        match content {
            [b'P', b'K', ..] => Self::Usdz,
            _ if content.starts_with(b"PXR-USDC") => Self::Usdc,
            _ if content.starts_with(b"#usda") => Self::Usda,
            _ => Self::Obj,
        }
    }
}
