//! Every field against its closed form on surfaces where it is known: planes and quadratic graphs, which bicubics reproduce.

#[path = "../common/bodies.rs"]
mod bodies;
mod highlight;
mod reflection;
mod scene;
mod shape;
