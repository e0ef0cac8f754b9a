//! Lines of candump on standard input, or from any other reader. Waits for room: a pipe can wait.

use std::io::{self, BufRead, BufReader, Read};
use std::sync::Arc;
use std::thread;
use std::time::Instant;

use super::lines::Lines;
use crate::input::{Input, NoteSink, SourceName};
use crate::queue::Queue;

/// Longest line in bytes; the rest of a longer one is passed over.
const LONGEST: u64 = 4096;

/// How standard input is called.
pub fn name() -> SourceName {
    SourceName { name: "-".to_owned(), kind: "stdin" }
}

pub fn start(inputs: Arc<Queue<Input>>, notes: NoteSink) {
    thread::spawn(move || {
        read(BufReader::with_capacity(1 << 16, io::stdin()), &inputs, notes);
    });
}

fn read(mut reader: BufReader<impl Read>, inputs: &Queue<Input>, notes: NoteSink) {
    let mut lines = Lines::new("-", notes);
    let mut line = Vec::new();
    let mut batch = Vec::new();
    let last = loop {
        line.clear();
        match Read::take(&mut reader, LONGEST).read_until(b'\n', &mut line) {
            Ok(0) => break Input::Ended,
            Ok(_) => {}
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => break Input::Failed(format!("-: cannot be read: {error}")),
        }
        batch.extend(lines.take(&line, Instant::now()));
        // Nothing waits here for a line that may never come.
        let more = reader.buffer().contains(&b'\n');
        if (!more || batch.len() >= 256) && !inputs.push_all(batch.drain(..)) {
            return;
        }
    };
    inputs.push_all(batch);
    inputs.push(last);
    inputs.close();
}
