//! catoptric
fn main() {}
