//! Copies the frames of a CAN log into another, whose format its extension says; without a second name, counts them.
//!
//!     cargo run --release -p itpms-can-log --example can_copy -- drive.blf drive.log

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use itpms_can_log::{CanError, FrameReader, FrameWriter};

fn main() -> ExitCode {
    let names: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let (from, to) = match names.as_slice() {
        [from] => (from, None),
        [from, to] => (from, Some(to.as_path())),
        _ => {
            eprintln!("can_copy LOG [LOG]");
            return ExitCode::from(2);
        }
    };
    match copy(from, to) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

fn copy(from: &Path, to: Option<&Path>) -> Result<(), CanError> {
    let mut reader = FrameReader::open(from)?;
    let mut writer = to.map(FrameWriter::create).transpose()?;
    while let Some(frame) = reader.next_frame()? {
        if let Some(writer) = &mut writer {
            writer.write(&frame)?;
        }
    }
    if let Some(writer) = writer {
        writer.finish()?.commit()?;
    }
    println!("{} frames", reader.repairs().frames);
    reader.repairs().warnings().iter().for_each(|warning| println!("{warning}"));
    Ok(())
}
