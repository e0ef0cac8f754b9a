//! The result as text, and the traces as CSV.

use std::fmt::Write as _;

use itpms_core::model::Corner;

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

/// The tires' pressures before and after they were let down.
pub(super) fn pressures(outcome: &Outcome) -> String {
    outcome.test_kpa.map_or("-".to_owned(), |test| format!("{:.0} > {test:.0}", outcome.warm_kpa))
}

/// False reports, each with when it was first.
pub(super) fn false_alerts(outcome: &Outcome) -> String {
    let reported = |reported: &super::FalseAlert| {
        format!("{} {} {}", reported.cause, reported.wheels, clock(Some(reported.time_s)))
    };
    let all = outcome.false_alerts.iter().map(reported).collect::<Vec<_>>().join(", ");
    if all.is_empty() { "-".to_owned() } else { all }
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
    pub fn table(&self) -> String {
        let head = "|clause|test|kPa|warned|limit|wheels named|lit again|out after|also reported, at|verdict";
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
                false_alerts(outcome),
                outcome.verdict.label().to_owned(),
            ]
        });
        aligned(head, rows) + &self.by_pattern() + &self.summary()
    }

    /// Tests of one kind together; nothing where they are not put together.
    pub fn by_pattern(&self) -> String {
        if self.patterns.is_empty() {
            return String::new();
        }
        let head = "|tires let down|runs|in time|median|worst|limit|wrong wheel|false alarm";
        let rows = self.patterns.iter().map(|tests| {
            [
                tests.rule.label().to_owned(),
                tests.tires.to_owned(),
                tests.runs.to_string(),
                tests.in_time.to_string(),
                clock(tests.median_s),
                clock(tests.worst_s),
                clock(Some(tests.limit_s)),
                tests.wrong.to_string(),
                tests.false_alarms.to_string(),
            ]
        });
        aligned(head, rows)
            + "Wheel speeds alone: what all four tires lose alike is not seen, but by tooth pulses; a dash is never.\n"
    }

    pub fn failed(&self) -> usize {
        self.outcomes.iter().filter(|outcome| outcome.verdict != Verdict::Pass).count()
    }

    pub fn summary(&self) -> String {
        let passed = self.outcomes.len() - self.failed();
        let wrong = self.outcomes.iter().filter(|outcome| !outcome.named_wrongly.is_empty()).count();
        let false_alerts = self.outcomes.iter().filter(|outcome| !outcome.false_alerts.is_empty()).count();
        format!(
            "{passed} of {} tests passed, {wrong} with a wrong wheel named, {false_alerts} with something reported that was not so; {:.1} simulated hours, seed {}. A simulation is no type approval.\n",
            self.outcomes.len(),
            self.driven_s / 3600.0,
            self.seed
        )
    }
}

/// The tests that would be driven, a line each.
pub fn list(procedures: &[Procedure]) -> String {
    let rows = procedures.iter().map(|p| {
        let [slow, fast] = p.rule.band_km_h(p.test);
        [
            p.name(),
            p.rule.clause(p.test).to_owned(),
            p.text(),
            format!("{slow:.0}-{fast:.0} km/h"),
            format!("within {}", clock(Some(p.rule.limit_s(p.test)))),
        ]
    });
    aligned("", rows)
}

/// Columns side by side; their heads, parted by `|`, are a line above if there are any.
fn aligned<const N: usize>(heads: &str, rows: impl Iterator<Item = [String; N]>) -> String {
    let mut heads = heads.split('|').map(str::to_owned);
    let head: [String; N] = std::array::from_fn(|_| heads.next().unwrap_or_default());
    let rows: Vec<[String; N]> =
        std::iter::once(head).chain(rows).skip_while(|row| row.iter().all(String::is_empty)).collect();
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
    use super::super::outcome::{Findings, Phase};
    use super::super::rules::Rule;
    use super::super::telltale::Wrong;
    use super::*;

    #[test]
    fn what_else_was_said_is_in_the_table_and_on_the_page() {
        let outcome = |false_alerts, verdict| Outcome {
            name: "a".to_owned(),
            rule: Rule::UnR141,
            clause: "5.2",
            what: "puncture: fl".to_owned(),
            verdict,
            warned_after_s: Some(3.0),
            limit_s: 600.0,
            named: "fl".to_owned(),
            named_wrongly: String::new(),
            false_alerts,
            false_alarm_s: None,
            relit: Some(true),
            out_after_s: Some(60.0),
            warm_kpa: 263.0,
            test_kpa: Some(210.0),
            wrong_at_s: 1340.0,
            warned_at_s: Some(1400.0),
            low_wheels: "fl".to_owned(),
            driven_s: 2000.0,
            trace: vec![],
        };
        let alert = crate::low(Corner::RearRight);
        let mut findings = Findings::default();
        findings.keep_false_alert(1507.0, Phase::Detection, Wrong::Wheel, &alert);
        let certificate = Certificate {
            version: "0",
            seed: 1,
            passed: false,
            driven_s: 4000.0,
            patterns: vec![],
            outcomes: vec![
                outcome(vec![], Verdict::Pass),
                outcome(findings.false_alerts, Verdict::WrongWheel),
            ],
        };
        let table = certificate.table();
        let lines: Vec<&str> = table.lines().collect();
        let reported = "under-inflated rr 25:07";
        assert!(lines[1].ends_with("pass") && !lines[1].contains("rr"), "{table}");
        assert!(lines[2].contains(reported) && lines[2].ends_with("FAIL: wrong wheel named"), "{table}");
        assert!(lines[3].contains("1 with something reported that was not so"), "{table}");
        assert!(certificate.page().contains(reported));
        let json = serde_json::to_value(&certificate).unwrap();
        let kept = &json["outcomes"][1]["false_alerts"][0];
        assert_eq!((&kept["cause"], &kept["phase"]), (&"under-inflated".into(), &"detection".into()));
    }

    #[test]
    fn times_read_like_a_clock() {
        assert_eq!(clock(None), "-");
        assert_eq!(clock(Some(0.2)), "0:00");
        assert_eq!(clock(Some(59.7)), "1:00");
        assert_eq!(clock(Some(3600.0)), "60:00");
    }
}
