//! What a person or a script gets to read: results on standard output, remarks on standard error.

use std::fmt::Display;
use std::io::{self, Write as _};

use crate::progress::Progress;

/// Where a command speaks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Screen {
    quiet: bool,
}

impl Screen {
    /// With `--quiet`, remarks and progress bars are left out; errors never are.
    pub(crate) fn new(quiet: bool) -> Self {
        Self { quiet }
    }

    /// A line of the result. A reader that has gone away (`| head`) is no reason to complain.
    pub(crate) fn print(&self, line: impl Display) {
        let _ = writeln!(io::stdout(), "{line}");
    }

    /// What happened besides the result.
    pub(crate) fn remark(&self, line: impl Display) {
        if !self.quiet {
            let _ = writeln!(io::stderr(), "{line}");
        }
    }

    /// What was repaired or looks odd, but did not stop us.
    pub(crate) fn warn(&self, line: impl Display) {
        let _ = writeln!(io::stderr(), "warning: {line}");
    }

    /// The one message a failed command ends with.
    pub(crate) fn error(&self, line: impl Display) {
        let _ = writeln!(io::stderr(), "error: {line}");
    }

    /// A progress bar, unless it is to be quiet.
    pub(crate) fn progress(&self, label: &str) -> Progress {
        if self.quiet { Progress::hidden() } else { Progress::shown(label) }
    }
}
