//! The source that was asked for, opened before anything else starts: what cannot be read is said at once.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use itpms_data::LogReader;
use itpms_live::engine::Engine;
use itpms_live::input::{Input, Say, SourceName};
use itpms_live::queue::Queue;
use itpms_live::source::{Speed, replay};

use crate::args::MonitorArgs;
use crate::exit::Failure;

/// An opened source.
pub(super) enum Source {
    /// A drive log.
    Replay(Box<LogReader>, Speed),
}

/// Opens what was asked for.
pub(super) fn open(args: &MonitorArgs) -> Result<Source, Failure> {
    if let Some(path) = &args.replay {
        let log = LogReader::open_with(path, &args.reading.options())?;
        return Ok(Source::Replay(Box::new(log), args.speed));
    }
    Err(Failure::Usage("expected an interface, -, --replay LOG or --mqtt-in URL".to_owned()))
}

impl Source {
    pub(super) fn name(&self) -> SourceName {
        match self {
            Source::Replay(log, _) => replay::name(log.path()),
        }
    }

    /// Whether it waits while the estimate is busy, instead of losing something.
    pub(super) fn can_wait(&self) -> bool {
        true
    }

    /// Starts its thread.
    pub(super) fn start(
        self,
        engine: Engine,
        inputs: &Arc<Queue<Input>>,
        stop: &Arc<AtomicBool>,
        say: &Say,
    ) -> Engine {
        let (inputs, stop, say) = (Arc::clone(inputs), Arc::clone(stop), Arc::clone(say));
        match self {
            Source::Replay(log, speed) => drop(replay::start(*log, speed, inputs, stop, say)),
        }
        engine
    }
}
