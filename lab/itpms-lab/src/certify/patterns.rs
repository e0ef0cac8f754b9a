//! Tests of one kind together: how many were warned of in time, how fast, how slowly, and how many named a wrong wheel.
//!
//! Called where a test is driven several times, as on wheel speeds, whose times scatter.

use itpms_core::wheel_speed::Pattern;
use serde::Serialize;

use super::{Outcome, Procedure, Rule, Test};

/// Tests of a regulation with tires let down in one pattern.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PatternTests {
    pub rule: Rule,
    /// Which tires: `one wheel`, `both of an axle` and the like.
    pub tires: &'static str,
    /// Runs, of them warned of within the limit, warned of later or never, and with a wheel named to which nothing was done.
    pub runs: usize,
    pub in_time: usize,
    pub wrong: usize,
    /// With anything reported while all was well.
    pub false_alarms: usize,
    /// Cumulative driving time in s at the warning: median of all runs, `None` where that one was not warned of.
    pub median_s: Option<f64>,
    /// The slowest of all; `None` where one was never warned of.
    pub worst_s: Option<f64>,
    pub limit_s: f64,
}

const KINDS: [&str; 7] =
    ["front wheel", "rear wheel", "both of an axle", "both of a side", "across", "three", "all four"];

fn kind(procedure: &Procedure) -> Option<&'static str> {
    if matches!(procedure.test, Test::Malfunction(_)) {
        return None;
    }
    let number = match Pattern::from(procedure.low_wheels()) {
        Pattern::None => return None,
        Pattern::Wheel(corner) => corner.index() / 2,
        Pattern::Axle => 2,
        Pattern::Side => 3,
        Pattern::Diagonal => 4,
        Pattern::Three => 5,
        Pattern::All => 6,
    };
    KINDS.get(number).copied()
}

/// By regulation and pattern, in their order.
pub(super) fn by_pattern(outcomes: &[(Procedure, &Outcome)]) -> Vec<PatternTests> {
    let mut tests = vec![];
    for rule in Rule::ALL {
        for tires in KINDS {
            let these = |(procedure, outcome): &(Procedure, &Outcome)| {
                (procedure.rule == rule && kind(procedure) == Some(tires)).then(|| (*outcome).clone())
            };
            let mut runs: Vec<Outcome> = outcomes.iter().filter_map(these).collect();
            let after = |outcome: &Outcome| outcome.warned_after_s.unwrap_or(f64::INFINITY);
            runs.sort_by(|a, b| after(a).total_cmp(&after(b)));
            let (Some(middle), Some(last)) = (runs.get(runs.len() / 2), runs.last()) else { continue };
            tests.push(PatternTests {
                rule,
                tires,
                runs: runs.len(),
                in_time: runs.iter().filter(|run| after(run) <= run.limit_s).count(),
                wrong: runs.iter().filter(|run| !run.named_wrongly.is_empty()).count(),
                false_alarms: runs.iter().filter(|run| run.false_alarm_s.is_some()).count(),
                median_s: middle.warned_after_s,
                worst_s: last.warned_after_s,
                limit_s: last.limit_s,
            });
        }
    }
    tests
}
