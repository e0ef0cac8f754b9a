//! Which program this is, for results that are kept over many runs.

use std::fs;
use std::path::PathBuf;

use crate::exit::Failure;

/// FNV-1a (64 bit) of the running program's file: tells builds apart, which a version number does not.
pub fn fingerprint() -> Result<String, Failure> {
    let unreadable =
        |error: std::io::Error| Failure::Usage(format!("the running program cannot be read: {error}"));
    let path: PathBuf = std::env::current_exe().map_err(unreadable)?;
    let bytes = fs::read(path).map_err(unreadable)?;
    let mut hash = 0xcbf2_9ce4_8422_2325u64;
    for byte in bytes {
        hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }
    Ok(format!("{hash:016x}"))
}
