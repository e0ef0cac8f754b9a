//! Ctrl-C, SIGTERM and SIGHUP end a run between two rows, so that unfinished files are removed on the way out; and within a
//! second where it waits for something that does not come, such as a pipe without a writer.

use std::io::Write as _;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use std::{io, process, thread};

use itpms_data::out::abandon_all;

use crate::exit::Failure;

/// Time for a run to notice that it is to end. Whoever computes looks several times a second; who does not look waits.
const NOTICE: Duration = Duration::from_millis(700);
/// Time for the end of a run that has noticed: the monitor waits three seconds for the last acknowledgements of its broker.
const ENDING: Duration = Duration::from_secs(4);
/// Time for the last word: standard error may be a pipe that is full.
const LAST_MESSAGE: Duration = Duration::from_millis(50);

/// Whether an end is wanted.
#[derive(Debug, Clone)]
pub struct Interrupt(Arc<Flags>);

#[derive(Debug, Default)]
struct Flags {
    wanted: AtomicBool,
    noticed: AtomicBool,
    /// What is finished is kept, and the same command goes on from there.
    resumes: AtomicBool,
}

impl Flags {
    /// Ends the program from outside of the thread that waits.
    fn end(&self) -> ! {
        abandon_all();
        let word = if self.resumes.load(Ordering::Relaxed) {
            Failure::Paused.to_string()
        } else {
            "interrupted".to_owned()
        };
        thread::spawn(move || {
            let _ = writeln!(io::stderr(), "error: {word}");
        });
        thread::sleep(LAST_MESSAGE);
        process::exit(130)
    }
}

impl Interrupt {
    /// Starts listening. Once per process.
    pub fn install() -> Result<Self, Failure> {
        let flags = Arc::new(Flags::default());
        let seen = Arc::clone(&flags);
        ctrlc::set_handler(move || {
            if seen.wanted.swap(true, Ordering::Relaxed) {
                // Asked twice: it is to end now, whatever it does.
                seen.end();
            }
            let seen = Arc::clone(&seen);
            thread::spawn(move || {
                thread::sleep(NOTICE);
                if seen.noticed.load(Ordering::Relaxed) {
                    thread::sleep(ENDING);
                }
                seen.end();
            });
        })
        .map_err(|error| Failure::Usage(format!("cannot listen for Ctrl-C: {error}")))?;
        Ok(Self(flags))
    }

    /// Tells that this run keeps what is finished and can go on from there, however it ends.
    pub fn resumes(&self) {
        self.0.resumes.store(true, Ordering::Relaxed);
    }

    /// To be asked every few thousand rows.
    pub fn check(&self) -> Result<(), Failure> {
        if self.is_wanted() { Err(Failure::Interrupted) } else { Ok(()) }
    }

    /// The same, for a computation that asks whether to go on.
    pub fn flow(&self) -> ControlFlow<()> {
        if self.is_wanted() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn is_wanted(&self) -> bool {
        let wanted = self.0.wanted.load(Ordering::Relaxed);
        if wanted {
            self.0.noticed.store(true, Ordering::Relaxed);
        }
        wanted
    }
}
