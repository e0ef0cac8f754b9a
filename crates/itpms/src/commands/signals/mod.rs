//! `itpms signals`: a log in; out come its signals with rates and ranges, and which column each would be.
//!
//! | module | idea |
//! |---|---|
//! | `table` | all of this as a table for a person |
//! | `json` | the same for a script |

mod json;
mod table;

use std::path::Path;

use itpms_console::{Failure, Interrupt, Screen, former, names};
use itpms_data::LogReader;
use itpms_data::log::{LogOptions, Slot};
use itpms_data::out::AtomicFile;
use itpms_data::signals::{Chosen, Lister, Listing, Resolved, SignalMap, resolve_among};

use crate::args::SignalsArgs;

pub(crate) fn run(args: &SignalsArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    let map = args.signals.as_deref().map(SignalMap::read).transpose()?;
    let written = args.write_map.as_deref().map(|path| output(path, args)).transpose()?;
    let mut lister = Lister::open(&args.log, args.dbc.as_deref(), &args.rows)?;
    let progress = screen.progress("reading");
    while lister.step()? {
        interrupt.check()?;
        progress.set(lister.progress());
    }
    drop(progress);
    let listing = lister.finish();
    let has_samples = listing.has_samples();
    let resolved = resolve_among(&listing.candidates(), &has_samples, &listing.unread, map.as_ref())?;
    if let Some(mut file) = written {
        let text = resolved.to_toml_in(listing.clock.as_deref(), listing.clock_unit());
        former::keep(file.target(), &text, screen)?;
        file.append(text.as_bytes())?;
        file.settle()?;
        file.commit()?;
    }
    let columns = Columns::new(&listing, &resolved, &has_samples);
    if args.json {
        screen.print_lines(format!("{:#}", json::value(&args.log, &listing, &resolved, &columns)));
    } else {
        table::print(args, &listing, &resolved, &columns, screen);
    }
    // What this command understands of a table's header is more than the others take by themselves.
    let reading = LogOptions { rows: args.rows.clone(), ..LogOptions::default() };
    let understood = listing.kind == "table" && map.is_none() && resolved.unusable().is_none();
    if let Some(error) = understood.then(|| LogReader::open_with(&args.log, &reading).err()).flatten() {
        screen.warn(format!("without a map the log is refused: {error}; write one with --write-map map.toml, and read the log with --signals map.toml"));
    }
    for note in &listing.notes {
        screen.warn(format!("{}: {note}", args.log.display()));
    }
    for remark in resolved.remarks() {
        screen.warn(remark);
    }
    Ok(())
}

/// Starts the map's file, so that one that cannot be written is known before the work begins.
fn output(path: &Path, args: &SignalsArgs) -> Result<AtomicFile, Failure> {
    let inputs = [
        (Some(args.log.as_path()), "the log"),
        (args.dbc.as_deref(), "the DBC file"),
        (args.signals.as_deref(), "the signal map"),
    ];
    names::check(&inputs, &[Some(path)])?;
    Ok(AtomicFile::create(path)?)
}

/// Which column each listed signal would be.
struct Columns<'a> {
    /// For each group the number of its first signal among the candidates.
    firsts: Vec<usize>,
    resolved: &'a Resolved,
    /// Of each candidate whether the log has it, not only its description.
    has_samples: &'a [bool],
}

impl<'a> Columns<'a> {
    fn new(listing: &Listing, resolved: &'a Resolved, has_samples: &'a [bool]) -> Self {
        Self { firsts: listing.first_candidates(), resolved, has_samples }
    }

    /// The column that the signal at this place of this group was taken for.
    fn of(&self, group: usize, signal: usize) -> Option<&'a Chosen> {
        let candidate = self.firsts.get(group)? + signal;
        self.resolved.iter().find(|chosen| chosen.candidate == candidate)
    }

    /// Columns whose signals the log, or its description, names and of which it has no sample.
    fn not_in_log(&self) -> Vec<String> {
        let by_map = |slot| self.resolved.get(slot).is_some_and(|chosen| !self.is_in_log(chosen));
        let is_missed = |slot: &Slot| self.resolved.without_samples().contains(slot) || by_map(*slot);
        Slot::all().filter(is_missed).map(Slot::name).collect()
    }

    fn is_in_log(&self, chosen: &Chosen) -> bool {
        self.has_samples.get(chosen.candidate) == Some(&true)
    }
}
