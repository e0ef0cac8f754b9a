//! All tests of the crate in one program.
#![allow(clippy::unwrap_used, clippy::panic)]

mod air;
mod from_c;
mod wheels;
