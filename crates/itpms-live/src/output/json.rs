//! A line of JSON per estimate (`"type": "estimate"` and the snapshot) and per transition (`"type": "warning"`).

use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use serde::Serialize;

use super::{Output, WhenSlow};
use crate::engine::Published;
use crate::error::LiveError;
use crate::snapshot::{Snapshot, Transition};

#[derive(Serialize)]
#[serde(tag = "type", rename_all = "lowercase")]
enum Line<'a> {
    Estimate(&'a Snapshot),
    Warning(&'a Transition),
}

/// Lines of JSON to a file or to standard output.
pub struct JsonLines {
    name: String,
    target: BufWriter<Box<dyn Write + Send>>,
}

impl JsonLines {
    /// Lines appended to a file, which grows as they come; `-` is standard output.
    pub fn open(path: &Path) -> Result<Self, LiveError> {
        let name = path.display().to_string();
        let target: Box<dyn Write + Send> = if name == "-" {
            Box::new(io::stdout())
        } else {
            let file = File::options().create(true).append(true).open(path);
            Box::new(file.map_err(|error| LiveError::Output { target: name.clone(), error })?)
        };
        Ok(Self { name, target: BufWriter::new(target) })
    }

    pub fn to(name: &str, target: Box<dyn Write + Send>) -> Self {
        Self { name: name.to_owned(), target: BufWriter::new(target) }
    }

    pub fn start(self, when_slow: WhenSlow) -> Output {
        Output::start(when_slow, self, Self::write, |mut lines| lines.flushed(Ok(())))
    }

    fn write(&mut self, waiting: &mut VecDeque<Published>) -> Result<(), LiveError> {
        let written = waiting.drain(..).try_for_each(|published| {
            let line = match &published {
                Published::Estimate(snapshot) => Line::Estimate(snapshot),
                Published::Warning(transition) => Line::Warning(transition),
            };
            serde_json::to_writer(&mut self.target, &line)?;
            self.target.write_all(b"\n")
        });
        self.flushed(written)
    }

    fn flushed(&mut self, written: io::Result<()>) -> Result<(), LiveError> {
        let flushed = written.and_then(|()| self.target.flush());
        flushed.map_err(|error| match error.kind() {
            io::ErrorKind::BrokenPipe => LiveError::ReaderGone,
            _ => LiveError::Output { target: self.name.clone(), error },
        })
    }
}
