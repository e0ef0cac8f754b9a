//! Whether two files hold the same: a drive that was copied under another name would count twice.

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::Path;

/// Whether two files have the same bytes, at least one. One that cannot be read is like no other: what is wrong with it is reported where
/// it is read.
#[must_use]
pub fn have_same_bytes(one: &Path, other: &Path) -> bool {
    let compare = || -> io::Result<bool> {
        let [one, other] = [File::open(one)?, File::open(other)?];
        if one.metadata()?.len() != other.metadata()?.len() || one.metadata()?.len() == 0 {
            return Ok(false);
        }
        let [mut one, mut other] = [one, other].map(BufReader::new);
        loop {
            let (a, b) = (one.fill_buf()?, other.fill_buf()?);
            let length = a.len().min(b.len());
            if length == 0 {
                return Ok(a.is_empty() && b.is_empty());
            }
            if a[..length] != b[..length] {
                return Ok(false);
            }
            one.consume(length);
            other.consume(length);
        }
    };
    compare().unwrap_or(false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_bytes_under_two_names() {
        let dir = tempfile::tempdir().unwrap();
        let write = |name: &str, bytes: &[u8]| {
            let path = dir.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            path
        };
        let long: Vec<u8> = (0..100_000u32).flat_map(u32::to_le_bytes).collect();
        let mut other = long.clone();
        *other.last_mut().unwrap() ^= 1;
        let [a, b, c, d, e] =
            [write("a", &long), write("b", &long), write("c", &other), write("d", b""), write("e", b"")];
        assert!(have_same_bytes(&a, &b));
        for (one, other) in [(&a, &c), (&a, &d), (&d, &e), (&a, &dir.path().join("none"))] {
            assert!(!have_same_bytes(one, other));
        }
    }
}
