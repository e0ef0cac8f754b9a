//! `itpms monitor`: a source, an estimating thread and outputs put together; what they have to say goes to the screen.
//!
//! | module | idea |
//! |---|---|
//! | `access` | how brokers are reached |
//! | `sources` | the source that was asked for |
//! | `outputs` | the outputs that were asked for |

mod access;
mod outputs;
mod sources;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use std::{fs, thread};

use itpms_console::{Failure, Interrupt, Screen, names};
use itpms_data::Vehicle;
use itpms_data::out::{AtomicFile, NameLock};
use itpms_drive::Settings;
use itpms_live::LiveError;
use itpms_live::drive::DriveOptions;
use itpms_live::engine::Engine;
use itpms_live::feed::Feed;
use itpms_live::hub::Hub;
use itpms_live::input::{Note, NoteSink};
use itpms_live::monitor::{End, Monitor};
use itpms_live::output::can;
use itpms_live::queue::Queue;
use itpms_live::state::SavedDrive;

use super::reference;
use crate::args::MonitorArgs;

/// Rows and frames between a source and the estimate: some seconds of a busy bus.
const WAITING: usize = 32_768;
/// So many refused states are kept; the last one of them is written over.
const SET_ASIDE: u32 = 9;

pub(crate) fn run(args: &MonitorArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    if args.print_dbc {
        screen.print_lines(can::DBC.trim_end());
        return Ok(());
    }
    let Some(vehicle) = &args.vehicle else {
        return Err(Failure::Usage("expected --vehicle V.toml".to_owned()));
    };
    if args.pulses.is_some() && args.replay.is_none() {
        let why =
            "--pulses: tooth pulses are read beside a log, expected --replay LOG; a live source carries none";
        return Err(Failure::Usage(why.to_owned()));
    }
    check_names(args)?;
    let mut vehicle = Vehicle::read(vehicle)?;
    let options = options(args, &mut vehicle)?;
    let notes = notes(*screen);
    let hub = Hub::new();
    let stop = Arc::new(AtomicBool::new(false));
    let inputs = Arc::new(Queue::new(WAITING));
    let mut source = sources::open(args, screen)?;
    let feed = source.feed.take();
    let mut _lock = None;
    if let Some(state) = &args.state {
        // That it cannot be written is better known now than at the end.
        drop(AtomicFile::create(state)?);
        // Two monitors would take turns in writing over what the other one has learned.
        _lock = NameLock::take(state)?;
    }
    let saved = saved(args, &vehicle, &options, screen)?;
    let outputs = outputs::open(args, source.can_wait(), &notes, screen)?;
    let server = outputs::serve(args, &hub, screen)?;

    let engine = Engine::new(vehicle, options, source.name(), saved, Arc::clone(&notes))
        .knowing(feed.as_ref().map_or_else(|| source.mapping().to_vec(), Feed::doubts));
    source.start(&inputs, &stop, &notes);
    let mut monitor = Monitor::new(engine, hub, outputs, args.state.clone(), notes);
    if let Some(feed) = feed {
        monitor = monitor.with_feed(feed);
    }
    let stopped = || interrupt.check().is_err();
    let end = monitor.run(&inputs, stopped);
    stop.store(true, Ordering::Relaxed);
    if end.map_err(failure)? == End::SourceEnded && server.is_some() {
        screen.remark("the source has ended; the page stays until Ctrl-C");
        while !stopped() {
            thread::sleep(Duration::from_millis(100));
        }
    }
    Ok(())
}

fn failure(error: LiveError) -> Failure {
    match error {
        LiveError::Data(error) => Failure::Data(error),
        other => Failure::Usage(other.to_string()),
    }
}

fn notes(screen: Screen) -> NoteSink {
    Arc::new(move |note| match note {
        Note::Remark(text) => screen.remark(text),
        Note::Warning(text) => screen.warn(text),
    })
}

/// The vehicle becomes the one from which a reference counts.
fn options(args: &MonitorArgs, vehicle: &mut Vehicle) -> Result<DriveOptions, Failure> {
    let mut options = DriveOptions { units: args.reading.options().units, ..DriveOptions::default() };
    if let Some(path) = &args.reference {
        let file = args.vehicle.as_deref().unwrap_or(Path::new("--vehicle"));
        let (known, stored) = reference::of(path, vehicle, file)?;
        *vehicle = known;
        options.reference = Some(stored);
    }
    options.settings = Settings {
        regulation: args.regulation,
        calibrate_s: args.calibrate_s,
        reference: args.reference.clone(),
        pulses: args.pulses.clone(),
        rate_hz: args.rate,
        ..options.settings
    };
    Ok(options)
}

/// Refuses an output that is one of the inputs, or two outputs of one name.
fn check_names(args: &MonitorArgs) -> Result<(), Failure> {
    let [dbc, signals] = args.reading.inputs();
    let inputs = [
        (args.replay.as_deref(), "the log"),
        (args.pulses.as_deref(), "the tooth pulses"),
        (args.vehicle.as_deref(), "the vehicle file"),
        (args.reference.as_deref(), "the learned reference"),
        (args.mqtt_password_file.as_deref(), "the password"),
        (args.mqtt_ca.as_deref(), "the certificates"),
        dbc,
        signals,
    ];
    // An interface is no file; a file that is one of the others would grow by our frames.
    let can_out = args.can_out.as_deref().map(Path::new);
    let outputs = [
        args.json.as_deref(),
        args.state.as_deref(),
        can_out,
        #[cfg(feature = "mcap")]
        args.mcap.as_deref(),
    ];
    names::check(&inputs, &outputs)
}

/// The saved state, or a word about why it is not used. What is no saved state at all is another's file, and not written over.
fn saved(
    args: &MonitorArgs,
    vehicle: &Vehicle,
    options: &DriveOptions,
    screen: &Screen,
) -> Result<Option<SavedDrive>, Failure> {
    let Some(path) = &args.state else { return Ok(None) };
    if !SavedDrive::is_one(path) {
        let text = format!("{}: is no saved state, expected one, or the name of a new file", path.display());
        return Err(Failure::Usage(text));
    }
    Ok(match SavedDrive::read(path, vehicle, options) {
        Ok(Some(saved)) => {
            if args.calibrate_s.is_some() {
                screen.remark("--calibrate-s: the saved state goes on, without another reset");
            }
            if args.reference.is_some() {
                screen.remark("--reference: the saved state goes on with what it has learned itself");
            }
            Some(saved)
        }
        Ok(None) => {
            screen.remark(format!("{}: no saved state yet, begins afresh", path.display()));
            None
        }
        Err(why) => {
            let aside = set_aside(path)?;
            let kept = aside.map(|aside| format!(", kept as {}", aside.display())).unwrap_or_default();
            screen.warn(format!("{}: {why}: refused{kept}, BEGINS AFRESH", path.display()));
            None
        }
    })
}

/// Gives a state that is refused another name: it may be another car's, or this one's under another regulation. What is empty is not kept.
fn set_aside(path: &Path) -> Result<Option<PathBuf>, Failure> {
    let failure = |error: std::io::Error| Failure::Usage(format!("{}: {error}", path.display()));
    if fs::metadata(path).map_err(failure)?.len() == 0 {
        return Ok(None);
    }
    let named = |k: u32| {
        let mut name = path.as_os_str().to_owned();
        name.push(if k == 1 { ".refused".to_owned() } else { format!(".refused-{k}") });
        PathBuf::from(name)
    };
    let aside = (1..SET_ASIDE).map(named).find(|name| !name.exists()).unwrap_or_else(|| named(SET_ASIDE));
    fs::rename(path, &aside).map_err(failure)?;
    Ok(Some(aside))
}
