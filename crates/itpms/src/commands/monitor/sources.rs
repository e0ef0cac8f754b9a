//! The source that was asked for, opened before anything else starts: what cannot be read is reported at once.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use itpms_console::{Failure, Screen};
use itpms_data::can::FrameReader;
use itpms_data::dbc::Decoder;
use itpms_data::signals::SignalMap;
use itpms_data::{DataError, LogReader};
use itpms_live::broker::BrokerAddress;
use itpms_live::feed::Feed;
use itpms_live::input::{Input, NoteSink, SourceName};
use itpms_live::output::can;
use itpms_live::queue::Queue;
use itpms_live::source::replay::Pulses;
use itpms_live::source::{Speed, broker, replay, stdin};

use super::{access, failure};
use crate::args::MonitorArgs;

pub(super) struct Source {
    kind: Kind,
    /// Tooth pulses beside a log.
    pulses: Option<Pulses>,
    pub(super) feed: Option<Feed>,
}

enum Kind {
    Rows(Box<LogReader>, Speed),
    Frames(Box<FrameReader>, Speed),
    Lines,
    Broker(BrokerAddress),
    #[cfg(target_os = "linux")]
    Bus(itpms_live::source::socketcan::Interface, String),
}

pub(super) fn open(args: &MonitorArgs, screen: &Screen) -> Result<Source, Failure> {
    if let Some(path) = &args.replay {
        let pulses = args.pulses.as_deref().map(Pulses::open).transpose()?;
        if !itpms_data::holds_frames(path, args.reading.dbc.as_deref())? {
            let log = LogReader::open_with(path, &args.reading.options())?;
            return Ok(Source { kind: Kind::Rows(Box::new(log), args.speed), pulses, feed: None });
        }
        let feed = feed(args, screen)?;
        let frames = FrameReader::open(path).map_err(DataError::from)?;
        return Ok(Source { kind: Kind::Frames(Box::new(frames), args.speed), pulses, feed: Some(feed) });
    }
    if let Some(file) = args.interface.as_deref().filter(|name| Path::new(name).is_file()) {
        return Err(Failure::Usage(format!(
            "{file}: is a file, expected an interface; a log: --replay {file}"
        )));
    }
    let feed = Some(feed(args, screen)?);
    let kind = match (&args.mqtt_in, args.interface.as_deref()) {
        (Some(address), _) => Kind::Broker(access::broker(args, address, screen)?),
        (None, Some("-")) => Kind::Lines,
        (None, Some(interface)) => bus(interface)?,
        (None, None) => {
            return Err(Failure::Usage("expected an interface, -, --replay LOG or --mqtt-in URL".to_owned()));
        }
    };
    Ok(Source { kind, pulses: None, feed })
}

#[cfg(target_os = "linux")]
fn bus(interface: &str) -> Result<Kind, Failure> {
    let opened = itpms_live::source::socketcan::Interface::open(interface).map_err(failure)?;
    Ok(Kind::Bus(opened, interface.to_owned()))
}

#[cfg(not(target_os = "linux"))]
fn bus(interface: &str) -> Result<Kind, Failure> {
    Err(Failure::Usage(format!(
        "{interface}: SocketCAN is Linux's alone, expected -, --replay LOG or --mqtt-in URL"
    )))
}

fn feed(args: &MonitorArgs, screen: &Screen) -> Result<Feed, Failure> {
    let needed = || Failure::Usage("frames need --dbc CAR.dbc, which says what they mean".to_owned());
    let (path, dbc) = match (&args.reading.dbc, &args.replay) {
        (Some(path), _) => (path, itpms_data::dbc::described(path)?),
        // It may be attached to the log.
        (None, Some(log)) => (log, itpms_data::frame_description(log, None)?),
        (None, None) => return Err(needed()),
    };
    let map = args.reading.signals.as_deref().map(SignalMap::read).transpose()?;
    let decoder = match &args.replay {
        Some(log) => itpms_data::frame_decoder(log, dbc, map.as_ref())?,
        None => Decoder::new(dbc, map.as_ref())?,
    };
    if let Some(first) = decoder.problems().first() {
        let count = decoder.problems().len();
        screen.warn(format!("{}: {count} problems, the first: {first}", path.display()));
    }
    let sends_there = args.can_out.is_some() && args.can_out == args.interface;
    let own = if sends_there { can::identifiers().map_err(failure)? } else { Vec::new() };
    let feed = Feed::new(decoder, own);
    if !feed.is_enough() {
        let path = path.display();
        return Err(Failure::Usage(format!(
            "{path}: no corner has both its accelerations among the signals, nor have all four wheels a speed; `itpms signals` lists them, \
             --signals MAP.toml says which is which"
        )));
    }
    Ok(feed)
}

impl Source {
    pub(super) fn name(&self) -> SourceName {
        match &self.kind {
            Kind::Rows(log, _) => replay::name(log.path()),
            Kind::Frames(log, _) => replay::name(log.path()),
            Kind::Lines => stdin::name(),
            Kind::Broker(address) => broker::name(address),
            #[cfg(target_os = "linux")]
            Kind::Bus(_, interface) => itpms_live::source::socketcan::name(interface),
        }
    }

    /// What its signals were taken for, where it has rows.
    pub(super) fn mapping(&self) -> &[String] {
        match &self.kind {
            Kind::Rows(log, _) => log.mapping(),
            _ => &[],
        }
    }

    /// Whether it waits while the estimate is busy, instead of losing something.
    pub(super) fn can_wait(&self) -> bool {
        match &self.kind {
            #[cfg(target_os = "linux")]
            Kind::Bus(..) => false,
            _ => true,
        }
    }

    pub(super) fn start(self, inputs: &Arc<Queue<Input>>, stop: &Arc<AtomicBool>, notes: &NoteSink) {
        let (inputs, stop, notes) = (Arc::clone(inputs), Arc::clone(stop), Arc::clone(notes));
        match self.kind {
            Kind::Rows(log, speed) => drop(replay::start(*log, self.pulses, speed, inputs, stop, notes)),
            Kind::Frames(log, speed) => {
                drop(replay::start_frames(*log, self.pulses, speed, inputs, stop, notes))
            }
            Kind::Lines => stdin::start(inputs, notes),
            Kind::Broker(address) => broker::start(address, inputs, stop, notes),
            #[cfg(target_os = "linux")]
            Kind::Bus(interface, _) => interface.start(inputs, stop),
        }
    }
}
