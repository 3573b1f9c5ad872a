//! Physical reflection: the points that mirror a light into an eye, by closed forms, by brute force and by their count.

#[path = "../common/bodies.rs"]
mod bodies;
#[path = "../common/mod.rs"]
mod common;

mod brute;
mod command;
mod contour;
mod count;
mod degenerate;
mod graphs;
