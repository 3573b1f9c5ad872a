//! How patches meet, and what that does to lines: closed forms, every mesh, and the command.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/rng.rs"]
mod rng;

mod askew;
mod command;
mod lines;
mod mutated;
mod revolution;
mod seams;
mod surfaces;
mod vertices;
