//! Scalar fields on the surface.
