//! How patches meet, and what that does to lines: closed forms, every mesh, and the command.

#[path = "../common/mod.rs"]
mod common;

mod askew;
mod command;
mod lines;
mod revolution;
mod surfaces;
mod vertices;
