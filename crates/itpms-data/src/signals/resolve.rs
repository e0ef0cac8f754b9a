//! Which signal is which column: first as the map says, then where names match.
//!
//! Called by whoever opens a bus log or a measurement file, with everything that is in it. Without a map a column's
//! signal is, in this order: the one with the column's own name; with that name in other letters (`FL_BodyAccel_mS2`);
//! the one whose words say it (`FL_BodyAccZ`, see [`names`](super::names)). A step counts only if one signal alone
//! takes it: of two it is unknown which is meant, so both are named and neither is taken. Knows nothing of formats.

use itpms_core::model::Corner;

use super::names::{self, Fit};
use super::remark::{Remark, Source};
use super::units::Unit;
use super::{Candidate, Conversion, Entry, Scale, SignalMap, Unread, not_there, sentences};
use crate::error::DataError;
use crate::log::{Field, Quantity, SLOTS, Slot};

#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    pub slot: Slot,
    pub candidate: usize,
    pub conversion: Conversion,
    pub signal: String,
    /// The unit as stated by the log.
    pub unit: String,
    pub source: Source,
}

/// Which signal each column gets, and what is to be reported about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Resolved {
    pub(super) chosen: [Option<Chosen>; SLOTS],
    pub(super) remarks: Vec<Remark>,
    pub(super) candidates: usize,
    /// Columns of which there are only signals without samples.
    pub(super) without_samples: Vec<Slot>,
    /// Other contents that cannot be read.
    pub(super) unread: Vec<Unread>,
}

impl Resolved {
    pub fn get(&self, slot: Slot) -> Option<&Chosen> {
        self.chosen[slot.index()].as_ref()
    }

    /// Every column that gets something, in the order of [`Slot::all`].
    pub fn iter(&self) -> impl Iterator<Item = &Chosen> {
        self.chosen.iter().flatten()
    }

    /// The columns that would get something if it had samples.
    pub fn without_samples(&self) -> &[Slot] {
        &self.without_samples
    }

    /// The columns that get something, in the order of [`Slot::all`].
    pub fn slots(&self) -> Vec<Slot> {
        self.iter().map(|chosen| chosen.slot).collect()
    }
}

/// Finds each column's signal. `time_s` is never among them: a log has its own clock.
/// Errors: the map asks for a signal that is not there or not the only one of its name, or for one whose unit is of no use and not given in
/// the map. That names match nowhere is no error; see [`Resolved::unusable`].
pub fn resolve(candidates: &[Candidate], map: Option<&SignalMap>) -> Result<Resolved, DataError> {
    resolve_knowing(candidates, &[], map)
}

/// The same, knowing what else there is that cannot be read, so that the reason can be reported.
pub fn resolve_knowing(
    candidates: &[Candidate],
    unread: &[Unread],
    map: Option<&SignalMap>,
) -> Result<Resolved, DataError> {
    resolve_among(candidates, &[], unread, map)
}

/// The same where it is known which candidates have samples in this log; beyond the end of `has_samples` all have. One without is no column
/// unless the map names it and no other.
pub fn resolve_among(
    candidates: &[Candidate],
    has_samples: &[bool],
    unread: &[Unread],
    map: Option<&SignalMap>,
) -> Result<Resolved, DataError> {
    let is_empty = |place: &usize| has_samples.get(*place) == Some(&false);
    let mut resolved = Resolved {
        chosen: [const { None }; SLOTS],
        remarks: Vec::new(),
        candidates: candidates.len(),
        without_samples: Vec::new(),
        unread: unread.to_vec(),
    };
    let mut settled = [false; SLOTS];
    settled[Slot::Time.index()] = true;
    for (map, entry) in map.into_iter().flat_map(|map| map.entries.iter().map(move |entry| (map, entry))) {
        settled[entry.slot.index()] = true;
        let Some(signal) = &entry.signal else { continue };
        let chosen = by_map(candidates, &is_empty, unread, entry, signal)
            .map_err(|sentence| DataError::new(&map.path, sentence))?;
        let before = resolved.iter().find(|other| other.candidate == chosen.candidate);
        if let Some(other) = before {
            let remark =
                Remark::UsedTwice { signal: chosen.signal.clone(), slots: [other.slot, chosen.slot] };
            resolved.remarks.push(remark);
        }
        resolved.chosen[entry.slot.index()] = Some(chosen);
    }
    let fits = Fits::of(candidates);
    for slot in Slot::all().filter(|slot| !settled[slot.index()]) {
        let taken = |candidate: usize| resolved.iter().any(|chosen| chosen.candidate == candidate);
        // How a car moves is asked for where wheel speeds are.
        if matches!(slot, Slot::Motion(_)) && !resolved.has_wheel_speeds() {
            continue;
        }
        match fits.best(candidates, &is_empty, slot, taken) {
            Best::Nothing => resolved.remarks.extend(unread.iter().find_map(|unread| unread.as_column(slot))),
            Best::One(chosen) => resolved.chosen[slot.index()] = Some(chosen),
            Best::Doubt(remark) => {
                let is_empty = matches!(remark, Remark::NoSamples { .. });
                resolved.without_samples.extend(is_empty.then_some(slot));
                // What few cars send is not missed.
                if !is_empty || slot.is_acceleration() || slot == Slot::Speed {
                    resolved.remarks.push(remark);
                }
            }
        }
    }
    Ok(resolved)
}

impl Unread {
    /// The remark on it if its name says that it is this column.
    fn as_column(&self, slot: Slot) -> Option<Remark> {
        let Candidate { group, name, unit } = &self.candidate;
        let meant = || names::meaning_in(group, name, unit).is_some_and(|(meant, _)| meant == slot);
        let (signal, why) = (self.candidate.full_name(), self.why.clone());
        (fits_own_name(&self.candidate, slot) || meant()).then_some(Remark::Unread { slot, signal, why })
    }
}

/// The candidates of which only one can be taken, in the order of their places: several fit one column, or are what the map calls one.
#[cfg(any(feature = "can", feature = "mdf4"))]
pub(crate) fn contested(candidates: &[Candidate], map: Option<&SignalMap>) -> Vec<usize> {
    let mut contested = Vec::new();
    let mut several = |places: Vec<usize>| {
        if places.len() > 1 {
            contested.extend(places);
        }
    };
    let entries = || map.into_iter().flat_map(|map| &map.entries);
    let by_name = |slot: &Slot| entries().all(|entry| entry.slot != *slot);
    let fits = Fits::of(candidates);
    Slot::all().filter(by_name).for_each(|slot| several(fits.places[slot.index()].concat()));
    for signal in entries().filter_map(|entry| entry.signal.as_deref()) {
        let called =
            |(_, candidate): &(usize, &Candidate)| candidate.name == signal || candidate.is_called(signal);
        several(candidates.iter().enumerate().filter(called).map(|(place, _)| place).collect());
    }
    contested.sort_unstable();
    contested.dedup();
    contested
}

fn by_map(
    candidates: &[Candidate],
    is_empty: &impl Fn(&usize) -> bool,
    unread: &[Unread],
    entry: &Entry,
    signal: &str,
) -> Result<Chosen, String> {
    let (line, column, slot) = (entry.line, entry.slot.name(), entry.slot);
    let called = |name: &dyn Fn(&Candidate) -> bool| {
        candidates.iter().enumerate().filter(|(_, c)| name(c)).map(|(i, _)| i).collect::<Vec<_>>()
    };
    // The full name first, so that a signal that shares its short name with others can be named at all.
    let mut found = called(&|candidate| candidate.is_called(signal));
    if found.is_empty() {
        found = called(&|candidate| candidate.name == signal);
    }
    if !found.iter().all(is_empty) {
        found.retain(|place| !is_empty(place));
    }
    let place = match found[..] {
        [place] => place,
        [] => {
            let called =
                |unread: &&Unread| unread.candidate.is_called(signal) || unread.candidate.name == signal;
            if let Some(Unread { candidate, why }) = unread.iter().find(called) {
                let signal = candidate.full_name();
                return Err(format!(
                    "line {line}: {column} is to be {signal:?}, which cannot be read: it is {why}"
                ));
            }
            let full: Vec<String> = candidates.iter().map(Candidate::full_name).collect();
            let short = candidates.iter().map(|candidate| candidate.name.as_str());
            let names = full.iter().map(String::as_str).chain(short);
            return Err(not_there(line, &column, signal, candidates.len(), names));
        }
        _ => {
            let to_be = format!("line {line}: {column} is to be {signal:?}");
            let (groups, names) = (found.len(), some_names(candidates, &found));
            return Err(if candidates[found[0]].full_name() == *signal {
                format!(
                    "{to_be}, of which there are {groups} at the same times: nothing tells them apart, expected one (leave the other groups out \
                     of the log, or give them names)"
                )
            } else {
                format!("{to_be}, which could be {names}: expected one of these")
            });
        }
    };
    let candidate = &candidates[place];
    let stated = || {
        let own = fits_own_name(candidate, slot);
        match Unit::of(&candidate.unit) {
            Unit::Silent if own => Some(Conversion::IDENTITY),
            unit => unit.conversion_to(slot),
        }
    };
    let conversion = match &entry.scale {
        Scale::AsStated => stated().ok_or_else(|| {
            let (signal, unit) = (candidate.full_name(), &candidate.unit);
            let (found, expected) = (sentences::stated(unit), Quantity::of(slot).words());
            let suggested = sentences::suggested(slot, &signal, unit);
            format!(
                "line {line}: {column} is to be {signal:?}, whose unit {found}, expected {expected}: give it in the map, {suggested}"
            )
        })?,
        Scale::Unit(_, conversion) | Scale::Numbers(conversion) => *conversion,
    };
    Ok(chosen(slot, place, candidate, conversion, Source::Map))
}

fn chosen(slot: Slot, place: usize, candidate: &Candidate, conversion: Conversion, source: Source) -> Chosen {
    let (signal, unit) = (candidate.full_name(), candidate.unit.clone());
    Chosen { slot, candidate: place, conversion, signal, unit, source }
}

/// The column's own name says its unit, too.
fn fits_own_name(candidate: &Candidate, slot: Slot) -> bool {
    letters(&candidate.name) == letters(&slot.name())
}

/// A name in small letters and digits alone.
fn letters(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

fn some_names(candidates: &[Candidate], places: &[usize]) -> String {
    const MOST: usize = 4;
    let mut names: Vec<String> =
        places.iter().take(MOST).map(|place| candidates[*place].full_name()).collect();
    if places.len() > MOST {
        names.push(format!("{} more", places.len() - MOST));
    }
    names.join(", ")
}

/// Which candidates could be a column, by how sure that is.
struct Fits {
    /// By [`Slot::index`], then by the step of [`STEPS`].
    places: Vec<[Vec<usize>; STEPS.len()]>,
}

/// The place of a wheel's speed of rotation, of that of its speed.
fn rotation_of(place: usize) -> Option<usize> {
    let slot = |field| Corner::ALL.map(|corner| Slot::Corner(corner, field).index());
    let speeds = slot(Field::WheelSpeed).into_iter().zip(slot(Field::WheelRotation));
    speeds.filter(|(speed, _)| *speed == place).map(|(_, rotation)| rotation).next()
}

const STEPS: [Source; 4] = [Source::Name, Source::Letters, Source::Words, Source::SomeWords];

enum Best {
    Nothing,
    One(Chosen),
    Doubt(Remark),
}

impl Fits {
    fn of(candidates: &[Candidate]) -> Self {
        let mut fits = Self { places: (0..SLOTS).map(|_| Default::default()).collect() };
        let columns: Vec<(usize, String, String)> =
            Slot::all().map(|slot| (slot.index(), slot.name(), letters(&slot.name()))).collect();
        for (place, candidate) in candidates.iter().enumerate() {
            let plain = letters(&candidate.name);
            let own = columns.iter().find(|(_, _, column)| *column == plain);
            let (slot, step) = match own {
                Some((slot, name, _)) => (*slot, usize::from(*name != candidate.name)),
                None => match names::meaning_in(&candidate.group, &candidate.name, &candidate.unit) {
                    Some((slot, Fit::AllWords)) => (slot.index(), 2),
                    Some((slot, Fit::SomeWords)) => (slot.index(), 3),
                    None => continue,
                },
            };
            fits.places[slot][step].push(place);
            // Words do not tell a wheel's speed from its rotation; the unit does.
            if step >= 2
                && let Some(rotation) = rotation_of(slot)
            {
                fits.places[rotation][step].push(place);
            }
        }
        fits
    }

    /// The surest candidate of a usable unit that no other column has been given.
    fn best(
        &self,
        candidates: &[Candidate],
        is_empty: &impl Fn(&usize) -> bool,
        slot: Slot,
        taken: impl Fn(usize) -> bool,
    ) -> Best {
        let mut doubt = None;
        let mut empty = None;
        for (source, places) in STEPS.into_iter().zip(&self.places[slot.index()]) {
            let free = places.iter().copied().filter(|place| !taken(*place));
            let mut usable = Vec::new();
            for place in free {
                let candidate = &candidates[place];
                if is_empty(&place) {
                    let missed = || Remark::NoSamples { slot, signal: candidate.full_name() };
                    empty = empty.or_else(|| Some(missed()));
                    continue;
                }
                match (Unit::of(&candidate.unit), source) {
                    (Unit::Silent, Source::Name | Source::Letters) => {
                        usable.push((place, Conversion::IDENTITY));
                    }
                    (unit @ Unit::Known(..), _) => {
                        usable.extend(unit.conversion_to(slot).map(|conversion| (place, conversion)));
                    }
                    (Unit::Silent | Unit::Unknown, _) => {
                        let (signal, unit) = (candidate.full_name(), candidate.unit.clone());
                        doubt = doubt.or(Some(Remark::Unit { slot, signal, unit }));
                    }
                }
            }
            match usable[..] {
                [] => {}
                [(place, conversion)] => {
                    return Best::One(chosen(slot, place, &candidates[place], conversion, source));
                }
                _ => {
                    let places: Vec<usize> = usable.iter().map(|(place, _)| *place).collect();
                    let signals = some_names(candidates, &places);
                    let first = candidates[places[0]].full_name();
                    return Best::Doubt(Remark::Ambiguous { slot, signals, first });
                }
            }
        }
        doubt.or(empty).map_or(Best::Nothing, Best::Doubt)
    }
}
