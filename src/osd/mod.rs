//! OpenSubdiv: topology refinement and the regression reference.

/// What OpenSubdiv refused.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Error(pub String);
