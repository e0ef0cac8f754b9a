//! The list for a script. Called by the command alone.

use std::path::Path;

use itpms_data::signals::{ListedGroup, Listing, Resolved};
use serde_json::{Value, json};

use super::Columns;

pub(super) fn value(log: &Path, listing: &Listing, resolved: &Resolved, columns: &Columns<'_>) -> Value {
    let groups = listing.groups.iter().enumerate().map(|(place, group)| group_value(place, group, columns));
    let chosen = resolved.iter().map(|chosen| {
        json!({
            "column": chosen.slot.name(),
            "signal": chosen.signal,
            "unit": chosen.unit,
            "factor": chosen.conversion.factor,
            "offset": chosen.conversion.offset,
            "source": chosen.source.to_string(),
        })
    });
    json!({
        "log": log.display().to_string(),
        "kind": listing.kind,
        "samples": listing.samples,
        "clock": listing.clock,
        "first_s": listing.span_s.map(|(first, _)| first),
        "last_s": listing.span_s.map(|(_, last)| last),
        "groups": groups.collect::<Vec<_>>(),
        "columns": chosen.collect::<Vec<_>>(),
        "not_in_log": columns.not_in_log(),
        "remarks": resolved.remarks().iter().map(ToString::to_string).collect::<Vec<_>>(),
        "unusable": resolved.unusable(),
        "absent": listing.absent.iter().map(|signal| signal.full_name()).collect::<Vec<_>>(),
        "unread": listing.unread.iter().map(|unread| json!({
            "signal": unread.candidate.full_name(),
            "why": unread.why,
        })).collect::<Vec<_>>(),
        "warnings": listing.notes,
    })
}

fn group_value(place: usize, group: &ListedGroup, columns: &Columns<'_>) -> Value {
    let signals = group.signals.iter().enumerate().map(|(number, signal)| {
        json!({
            "name": signal.name,
            "unit": signal.unit,
            "samples": signal.samples,
            "missing": signal.missing,
            // JSON has no NaN: null where there is no value.
            "min": signal.min.is_finite().then_some(signal.min),
            "max": signal.max.is_finite().then_some(signal.max),
            "column": columns.of(place, number).map(|chosen| chosen.slot.name()),
        })
    });
    json!({
        "name": group.name,
        "id": group.id,
        "bus": group.bus,
        "known": group.is_known,
        "samples": group.samples,
        "rate_hz": group.rate_hz,
        "jitter_s": group.jitter_s,
        "stated_hz": group.stated_hz,
        "bytes": group.bytes.map(|(least, most)| [least, most]),
        "signals": signals.collect::<Vec<_>>(),
    })
}
