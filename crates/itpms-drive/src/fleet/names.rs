//! Names of drives on the fleet's page, and their links.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use itpms_analysis::plot::escape;

use super::record::DriveRecord;

/// The drives' names: those of their files, with their folders where several files have one name.
pub(super) struct Names<'a>(BTreeSet<&'a str>);

impl<'a> Names<'a> {
    pub(super) fn of(drives: &'a [DriveRecord]) -> Self {
        let mut seen = BTreeSet::new();
        Self(drives.iter().map(|drive| tail(&drive.file, 1)).filter(|name| !seen.insert(*name)).collect())
    }

    /// The drive's name, leading to its report where there is one.
    pub(super) fn link(&self, drive: &DriveRecord) -> String {
        let several = self.0.contains(tail(&drive.file, 1));
        let name = escape(tail(&drive.file, if several { 3 } else { 1 }));
        match &drive.report {
            Some(report) => format!("<a href=\"{}\">{name}</a>", address(report)),
            None => format!("<span title=\"{}\">{name}</span>", escape(&drive.file)),
        }
    }
}

fn tail(path: &str, parts: usize) -> &str {
    let cut = path.rmatch_indices(['/', '\\']).nth(parts - 1).map_or(0, |(at, _)| at + 1);
    &path[cut..]
}

fn address(path: &str) -> String {
    let mut out = String::with_capacity(path.len());
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"-_.~/".contains(&byte) {
            out.push(char::from(byte));
        } else {
            let _ = write!(out, "%{byte:02X}");
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_lead_to_any_file_name() {
        assert_eq!(address("reports/a b/100%#1.csv.html"), "reports/a%20b/100%25%231.csv.html");
        assert_eq!(address("reports/ü.html"), "reports/%C3%BC.html");
    }

    #[test]
    fn files_of_one_name_are_told_apart_by_their_folders() {
        assert_eq!(
            [1, 2, 3, 9].map(|n| tail("logs/A/mon/drive.csv", n)),
            ["drive.csv", "mon/drive.csv", "A/mon/drive.csv", "logs/A/mon/drive.csv"]
        );
        assert_eq!(tail("C:\\logs\\drive.csv", 2), "logs\\drive.csv");
    }
}
