//! The result as text, and the traces as CSV.

use std::fmt::Write as _;

use itpms_core::sample::Corner;

use super::{Certificate, Outcome, Procedure, Verdict};

/// Minutes and seconds, `3:07`; what is not there is a dash.
pub(super) fn clock(seconds: Option<f64>) -> String {
    seconds.map_or("-".to_owned(), |s| {
        let whole = s.max(0.0).round() as u64;
        format!("{}:{:02}", whole / 60, whole % 60)
    })
}

/// The wheels named, with those that are wrong in it.
pub(super) fn named(outcome: &Outcome) -> String {
    match (outcome.named.as_str(), outcome.named_wrongly.as_str()) {
        ("", _) => "-".to_owned(),
        (named, "") => named.to_owned(),
        (named, wrong) => format!("{named} (wrong: {wrong})"),
    }
}

/// What the tires were let down from and to.
pub(super) fn pressures(outcome: &Outcome) -> String {
    outcome.test_kpa.map_or("-".to_owned(), |test| format!("{:.0} > {test:.0}", outcome.warm_kpa))
}

/// Whether it was lit again, in a word.
pub(super) fn relit(outcome: &Outcome) -> &'static str {
    match outcome.relit {
        Some(true) => "yes",
        Some(false) => "no",
        None => "-",
    }
}

impl Certificate {
    /// A table of all tests and a line that sums up.
    #[must_use]
    pub fn table(&self) -> String {
        let head = [
            "",
            "clause",
            "test",
            "kPa",
            "warned",
            "limit",
            "wheels named",
            "lit again",
            "out after",
            "verdict",
        ];
        let rows = self.outcomes.iter().map(|outcome| {
            [
                outcome.rule.label().to_owned(),
                outcome.clause.to_owned(),
                outcome.what.clone(),
                pressures(outcome),
                clock(outcome.warned_after_s),
                clock(Some(outcome.limit_s)),
                named(outcome),
                relit(outcome).to_owned(),
                clock(outcome.out_after_s),
                outcome.verdict.label().to_owned(),
            ]
        });
        let rows: Vec<[String; 10]> = std::iter::once(head.map(str::to_owned)).chain(rows).collect();
        aligned(&rows) + &self.summary()
    }

    /// How many passed, in a line.
    #[must_use]
    pub fn summary(&self) -> String {
        let passed = self.outcomes.iter().filter(|outcome| outcome.verdict == Verdict::Pass).count();
        let wrong = self.outcomes.iter().filter(|outcome| !outcome.named_wrongly.is_empty()).count();
        format!(
            "{passed} of {} tests passed, {wrong} with a wrong wheel named; {:.1} simulated hours, seed {}. A simulation is no type approval.\n",
            self.outcomes.len(),
            self.driven_s / 3600.0,
            self.seed
        )
    }
}

/// The tests that would be driven, a line each.
#[must_use]
pub fn list(procedures: &[Procedure]) -> String {
    let rows: Vec<[String; 5]> = procedures
        .iter()
        .map(|p| {
            let [slow, fast] = p.rule.band_km_h(p.test);
            [
                p.name(),
                p.rule.clause(p.test).to_owned(),
                p.words(),
                format!("{slow:.0}-{fast:.0} km/h"),
                format!("within {}", clock(Some(p.rule.limit_s(p.test)))),
            ]
        })
        .collect();
    aligned(&rows)
}

fn aligned<const N: usize>(rows: &[[String; N]]) -> String {
    let width = |i: usize| rows.iter().map(|row| row[i].chars().count()).max().unwrap_or(0);
    let widths: [usize; N] = std::array::from_fn(width);
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().zip(widths).map(|(cell, width)| format!("{cell:width$}")).collect::<Vec<_>>();
        let _ = writeln!(text, "{}", cells.join("  ").trim_end());
    }
    text
}

impl Outcome {
    /// The test's pressures over time.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut text = "time_s,speed_km_h".to_owned();
        for corner in Corner::ALL.map(Corner::label) {
            let _ = write!(text, ",{corner}_true_kpa,{corner}_pressure_kpa,{corner}_sd_kpa");
        }
        text.push('\n');
        for point in &self.trace {
            let _ = write!(text, "{:.1},{:.1}", point.time_s, point.speed_km_h);
            for i in 0..4 {
                for value in [point.truth_kpa[i], point.estimate_kpa[i], point.sd_kpa[i]] {
                    let _ = if value.is_finite() { write!(text, ",{value:.2}") } else { write!(text, ",") };
                }
            }
            text.push('\n');
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::clock;

    #[test]
    fn times_read_like_a_clock() {
        assert_eq!(clock(None), "-");
        assert_eq!(clock(Some(0.2)), "0:00");
        assert_eq!(clock(Some(59.7)), "1:00");
        assert_eq!(clock(Some(3600.0)), "60:00");
    }
}
