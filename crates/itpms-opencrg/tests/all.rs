//! Roads through the crate's public face.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

mod roads;
