//! Opens stages, and refuses what openusd 0.8 does not survive: where a prim is composed of itself, however many arcs away, or
//! text is nested very deep, it goes on until the stack or the memory ends; prims below prims take time with the cube of their number.

use openusd::ar::{self, Resolver};
use openusd::sdf::{AbstractData, Layer};
use openusd::usd::Stage;
use std::borrow::Cow;
use std::cell::RefCell;
use std::io;
use std::rc::Rc;
use std::time::SystemTime;

use super::circles::Arcs;
use super::value::one_line;
use super::{nesting, text};
use crate::mesh::MeshError;
use crate::mesh::error::{Place, Spot, quote};

/// Most prims one below the other, and most braces, brackets and parentheses that are open at a time.
pub(super) const DEEPEST: usize = 200;

/// Opens the stage of a file; `file` is its name in messages.
pub(super) fn open(path: &str, file: &str) -> Result<Stage, MeshError> {
    let at = || Place::with(file, Spot::Whole);
    let watch = Rc::new(RefCell::new(None));
    let resolver = Watching { inner: ar::DefaultResolver::new(), arcs: Rc::clone(&watch) };
    let stage = Stage::builder().resolver(resolver).open(path);
    let stage = stage.map_err(|error| MeshError::UsdUnreadable { at: at(), reason: one_line(&error) })?;
    let mut arcs = Arcs::default();
    let layers = stage.layer_identifiers();
    let layers = || layers.iter().filter_map(|layer| stage.layer(layer));
    let location = |layer: &Layer| layer.resolved_path().unwrap_or(layer.identifier()).to_owned();
    layers().for_each(|layer| arcs.root(&location(&layer)));
    for layer in layers() {
        check_depth(layer.data()).map_err(|reason| MeshError::UsdUnreadable { at: at(), reason })?;
        arcs.add(&location(&layer), layer.data());
    }
    if let Some(prim) = arcs.circle() {
        return Err(MeshError::ArcsInCircle { at: at(), prim: quote(prim.as_str().as_bytes()) });
    }
    // From here on layers are opened as arcs lead to them.
    *watch.borrow_mut() = Some(arcs);
    Ok(stage)
}

fn check_depth(layer: &dyn AbstractData) -> Result<(), String> {
    let depth = layer.spec_paths().iter().map(openusd::sdf::Path::element_count).max().unwrap_or(0);
    if depth > DEEPEST { Err(format!("prims {depth} deep, but at most {DEEPEST} are read")) } else { Ok(()) }
}

/// Finds files as OpenUSD does, and looks at those that arcs lead to.
struct Watching {
    inner: ar::DefaultResolver,
    /// `None` until the root layers are open.
    arcs: Rc<RefCell<Option<Arcs>>>,
}

impl Resolver for Watching {
    fn open_asset(&self, path: &ar::ResolvedPath) -> io::Result<Box<dyn ar::Asset>> {
        // A device or a pipe may have no end.
        if std::fs::metadata(&**path).is_ok_and(|found| !found.is_file()) {
            return Err(io::Error::other("not a file"));
        }
        let bytes = self.inner.open_asset(path)?.into_buffer()?.into_shared();
        let is_text = !bytes.starts_with(b"PXR-USDC") && !bytes.starts_with(b"PK");
        let bytes = if is_text { ar::SharedBuffer::new(text::plain(&bytes)) } else { bytes };
        if is_text && nesting::depth(&bytes) > DEEPEST {
            return Err(io::Error::other(format!("nested more than {DEEPEST} deep")));
        }
        if let Some(arcs) = &mut *self.arcs.borrow_mut() {
            // What is no layer is told by whoever opens it.
            if let Ok(layer) = Layer::from_bytes("", ar::AssetBuffer::Shared(bytes.clone())) {
                check_depth(layer.data()).map_err(io::Error::other)?;
                arcs.add(&path.to_string_lossy(), layer.data());
                if let Some(prim) = arcs.circle() {
                    return Err(io::Error::other(format!("the arcs of {prim} lead back to it")));
                }
            }
        }
        Ok(Box::new(io::Cursor::new(ar::AssetBuffer::Shared(bytes))))
    }

    fn create_identifier(&self, path: &str, anchor: Option<&ar::ResolvedPath>) -> String {
        self.inner.create_identifier(path, anchor)
    }

    fn resolve(&self, path: &str) -> Option<ar::ResolvedPath> {
        self.inner.resolve(path)
    }

    fn resolve_for_new_asset(&self, path: &str) -> Option<ar::ResolvedPath> {
        self.inner.resolve_for_new_asset(path)
    }

    fn get_extension<'a>(&self, path: &'a str) -> &'a str {
        self.inner.get_extension(path)
    }

    fn is_context_dependent_path(&self, path: &str) -> bool {
        self.inner.is_context_dependent_path(path)
    }

    fn in_memory_identifier<'a>(&self, path: &'a str) -> Cow<'a, str> {
        self.inner.in_memory_identifier(path)
    }

    fn get_asset_info(&self, path: &str, resolved: &ar::ResolvedPath) -> ar::AssetInfo {
        self.inner.get_asset_info(path, resolved)
    }

    fn get_modification_timestamp(&self, path: &str, resolved: &ar::ResolvedPath) -> Option<SystemTime> {
        self.inner.get_modification_timestamp(path, resolved)
    }

    fn identity(&self) -> String {
        self.inner.identity()
    }

    fn cache_id(&self) -> Option<u64> {
        self.inner.cache_id()
    }
}
