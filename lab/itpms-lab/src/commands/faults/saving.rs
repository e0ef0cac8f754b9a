//! Saving, disturbed: the program is killed in the middle, the disk is full, a file is not what was written.

use std::fs;
use std::io::{Read as _, Write as _, stderr};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::{self, sleep};
use std::time::Duration;

use itpms_console::Failure;
use itpms_data::reference::StoredReference;
use itpms_live::state::{self, SavedDrive};

use super::subject::{options, program};
use super::{Campaign, Outcome};

/// Longest time from the first save of the program that is killed to its end.
const LATEST_NS: u64 = 12_000_000;
/// Steps from no room at all to enough.
const ROOMS: u64 = 64;

/// The program that is killed, or that finds no room: saves two files in turn under one name.
pub(super) fn save_forever(kind: &Path, files: [&PathBuf; 2], target: &Path) -> Result<(), Failure> {
    let fail = |error: std::io::Error| Failure::Usage(error.to_string());
    let save = |file| -> Result<Box<dyn Fn() -> Result<(), Failure>>, Failure> {
        if kind == Path::new("state") {
            let bytes = fs::read(file).map_err(fail)?;
            let failed = |error: itpms_live::error::LiveError| Failure::Usage(error.to_string());
            return Ok(Box::new(move || state::write(target, &bytes).map_err(failed)));
        }
        let stored = StoredReference::read(file)?;
        Ok(Box::new(move || Ok(stored.save(target)?)))
    };
    let saves = [save(files[0])?, save(files[1])?];
    let mut reported = false;
    loop {
        for save in &saves {
            save()?;
            if !reported {
                // Whoever kills waits for this.
                stderr().write_all(b"!").map_err(fail)?;
                reported = true;
            }
        }
    }
}

pub(super) fn killed(campaign: &mut Campaign<'_>, kind: &str) -> Result<Outcome, Failure> {
    let files = campaign.subject.files(kind);
    let target = campaign.subject.at(&format!("killed.{kind}"));
    let fail = |error| Failure::Directory(target.clone(), error);
    let [old, new] = [fs::read(&files[0]).map_err(fail)?, fs::read(&files[1]).map_err(fail)?];
    fs::write(&target, &old).map_err(fail)?;
    let tried = campaign.of(200);
    let (mut lost, mut found_old, mut left) = (0, 0, 0);
    for _ in 0..tried {
        campaign.interrupt.check()?;
        let mut command = program()?;
        command.args(["faults", "--victim", kind]).args(files).arg(&target).stderr(Stdio::piped());
        let mut child = command.spawn().map_err(fail)?;
        if let Some(said) = &mut child.stderr {
            let _ = said.read_exact(&mut [0]);
        }
        sleep(Duration::from_nanos(campaign.moments.below(LATEST_NS)));
        // Nothing in the program gets to know of it.
        child.kill().map_err(fail)?;
        child.wait().map_err(fail)?;
        let found = fs::read(&target).unwrap_or_default();
        lost += u64::from(found != old && found != new);
        found_old += u64::from(found == old);
        left += beside(&target);
    }
    let found = format!("{found_old} times the old one, {left} times killed in the middle of writing");
    Ok(Outcome { tried, lost, found })
}

fn beside(target: &Path) -> u64 {
    let prefix = format!(".{}.", target.file_name().unwrap_or_default().to_string_lossy());
    let Some(Ok(entries)) = target.parent().map(fs::read_dir) else { return 0 };
    entries.flatten().filter(|entry| entry.file_name().to_string_lossy().starts_with(&prefix)).count() as u64
}

/// The system lets a file grow to a limit and no further; the limit grows from nothing until the file fits.
pub(super) fn full_disk(campaign: &mut Campaign<'_>, kind: &str) -> Result<Outcome, Failure> {
    let files = campaign.subject.files(kind);
    let target = campaign.subject.at(&format!("full.{kind}"));
    let fail = |error| Failure::Directory(target.clone(), error);
    let [old, new] = [fs::read(&files[0]).map_err(fail)?, fs::read(&files[1]).map_err(fail)?];
    // The shell counts in blocks of 512 bytes.
    let blocks = (old.len().min(new.len()) as u64 / 512).max(1);
    let steps = campaign.of(ROOMS).min(blocks);
    let (mut lost, mut said) = (0, 0);
    for step in 0..steps {
        campaign.interrupt.check()?;
        fs::write(&target, &old).map_err(fail)?;
        let own = program()?;
        let limited = format!("trap '' XFSZ; ulimit -f {}; exec \"$0\" \"$@\"", step * blocks / steps);
        let mut command = Command::new("sh");
        command.arg("-c").arg(limited).arg(own.get_program()).args(["faults", "--victim", kind]);
        command.arg(&files[1]).arg(&files[1]).arg(&target).stdin(Stdio::null());
        let output = command.output().map_err(fail)?;
        let refused = output.status.code() == Some(2) && !output.stderr.is_empty();
        said += u64::from(refused);
        lost += u64::from(!refused || fs::read(&target).map_err(fail)? != old);
    }
    Ok(Outcome {
        tried: steps,
        lost,
        found: format!("{said} times an error, the old one stays, {} files left", beside(&target)),
    })
}

pub(super) fn changed_state(campaign: &mut Campaign<'_>) -> Result<Outcome, Failure> {
    let (vehicle, options) = (&campaign.subject.vehicle, options());
    let bytes = read(&campaign.subject.states[1])?;
    let header = bytes.iter().position(|byte| *byte == b'\n').unwrap_or(0);
    let every = (1.0 / campaign.effort).ceil().max(1.0) as usize;
    let believed = |changed: &[u8], at: usize| {
        // A file changed in the first line alone and accepted all the same is the same drive.
        SavedDrive::parse(changed, vehicle, &options).is_ok() && at > header
    };
    changed(&bytes, every, believed)
}

pub(super) fn changed_calibration(campaign: &mut Campaign<'_>) -> Result<Outcome, Failure> {
    let path = &campaign.subject.calibrations[1];
    let (bytes, whole) = (read(path)?, StoredReference::read(path)?);
    changed(&bytes, 1, |changed, _| StoredReference::parse(changed).is_ok_and(|read| read != whole))
}

pub(super) fn cut_state(campaign: &mut Campaign<'_>) -> Result<Outcome, Failure> {
    let (vehicle, options) = (&campaign.subject.vehicle, options());
    let bytes = read(&campaign.subject.states[1])?;
    let tried = campaign.of(500);
    let mut lost = 0;
    for _ in 0..tried {
        let length = campaign.moments.below(bytes.len() as u64) as usize;
        lost += u64::from(SavedDrive::parse(&bytes[..length], vehicle, &options).is_ok());
    }
    Ok(Outcome { tried, lost, found: format!("of {} bytes", bytes.len()) })
}

fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    fs::read(path).map_err(|error| Failure::Directory(path.to_owned(), error))
}

/// A bit of every `every`th byte changed, one at a time, on all processors.
fn changed(
    bytes: &[u8],
    every: usize,
    believed: impl Fn(&[u8], usize) -> bool + Sync,
) -> Result<Outcome, Failure> {
    let places: Vec<usize> = (0..bytes.len()).step_by(every).collect();
    let part = places.len().div_ceil(rayon::current_num_threads()).max(1);
    let lost: u64 = thread::scope(|scope| {
        let threads: Vec<_> = places
            .chunks(part)
            .map(|places| {
                let believed = &believed;
                // An estimator is made on it where a change is believed.
                let builder = thread::Builder::new().stack_size(16 << 20);
                builder.spawn_scoped(scope, move || {
                    let mut changed = bytes.to_vec();
                    let mut lost = 0;
                    for at in places {
                        changed[*at] ^= 1 << (at % 8);
                        lost += u64::from(believed(&changed, *at));
                        changed[*at] = bytes[*at];
                    }
                    lost
                })
            })
            .collect();
        // A thread that broke off, or was never there, has shown nothing: all of its part counts as lost.
        threads
            .into_iter()
            .map(|thread| thread.map_or(part as u64, |t| t.join().unwrap_or(part as u64)))
            .sum()
    });
    let tried = places.len() as u64;
    Ok(Outcome {
        tried,
        lost,
        found: format!("{} refused or the same, of {} bytes", tried - lost.min(tried), bytes.len()),
    })
}
