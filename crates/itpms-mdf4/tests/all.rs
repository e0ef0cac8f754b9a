//! MDF4 files through the crate's public face.

mod damage;
mod foreign;
mod round_trip;
