//! Roads through the crate's public face.

mod roads;
