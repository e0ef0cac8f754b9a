//! The `itpms` command.
fn main() {}
