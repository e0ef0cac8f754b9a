//! CAN logs and DBC files through the crate's public face.

mod damage;
mod dbc;
mod dbc_any;
mod logs;
