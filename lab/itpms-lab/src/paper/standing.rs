//! The table of errors that stands under every estimator figure, and the words that compare our errors to the paper's.
//!
//! Called by the sections.

use super::data::Data;
use super::outcome::{Outcome, Record};
use super::section::{Table, number};
use crate::score::stats::Spread;

/// `13.7 (10.0–16.2)`; what has diverged says so.
pub(super) fn spread(spread: &Spread, decimals: usize) -> String {
    if spread.median.is_infinite() && spread.p10.is_infinite() {
        return "diverged".to_owned();
    }
    format!(
        "{} ({} – {})",
        number(spread.median, decimals),
        number(spread.p10, decimals),
        number(spread.p90, decimals)
    )
}

/// Who took part, as a row says it.
fn name(record: &Record) -> String {
    match record.who.reset_s {
        seconds if seconds > 0.0 => format!("{}, reset of {seconds} s", record.who.label()),
        _ => record.who.label().to_owned(),
    }
}

/// Errors of all who drove these cases. `what` heads the first column where there is more than one case; `file` names the data.
pub(super) fn standing(file: &str, title: &str, what: &str, cases: &[(String, &Outcome)]) -> Table {
    let records: Vec<(&String, &Record)> = cases
        .iter()
        .flat_map(|(case, outcome)| outcome.records.iter().map(move |record| (case, record)))
        .collect();
    let column =
        |pick: fn(&Record) -> f64| records.iter().map(|(_, record)| pick(record)).collect::<Vec<_>>();
    let data = Data::new(file, title)
        .text("case", records.iter().map(|(case, _)| (*case).clone()))
        .text("estimator", records.iter().map(|(_, record)| record.who.label().to_owned()))
        .numbers("reset_s", column(|r| r.who.reset_s))
        .numbers("rmse_median_kpa", column(|r| r.rmse.median))
        .numbers("rmse_p10_kpa", column(|r| r.rmse.p10))
        .numbers("rmse_p90_kpa", column(|r| r.rmse.p90))
        .numbers("rmse_after_reset_median_kpa", column(|r| r.after.median))
        .numbers("rmse_after_reset_p10_kpa", column(|r| r.after.p10))
        .numbers("rmse_after_reset_p90_kpa", column(|r| r.after.p90))
        .numbers("coverage_95", column(|r| r.coverage))
        .numbers("diverged_drives", column(|r| r.diverged as f64))
        .numbers("drives", column(|r| r.drives as f64))
        .numbers("drawn_drive_rmse_kpa", column(|r| r.drawn_rmse_kpa));
    let with_reset = records.iter().any(|(_, record)| record.who.reset_s > 0.0);
    let mut head = vec![what, "Estimator", "RMSE, t > 3 s (kPa)"];
    if with_reset {
        head.push("RMSE after the reset (kPa)");
    }
    head.extend(["Truth inside 95 %", "Diverged"]);
    let one_case = cases.len() == 1;
    let mut table = Table::new(title, if one_case { &head[1..] } else { &head }, data);
    for (case, record) in records {
        let mut cells = vec![case.clone(), name(record), spread(&record.rmse, 2)];
        if with_reset {
            cells.push(spread(&record.after, 2));
        }
        cells.push(match record.coverage {
            share if share.is_nan() => "–".to_owned(),
            share => format!("{} %", number(100.0 * share, 1)),
        });
        cells.push(format!("{} of {}", record.diverged, record.drives));
        table = table.row(cells.into_iter().skip(usize::from(one_case)));
    }
    table
}

/// Farther than this from ours, as a factor, the paper's number does not agree with it, however wide our spread is.
const NEAR: f64 = 1.25;

/// Our spread against a number that the paper prints, in a word or two. To agree takes both: the number lies within our
/// spread, and close to its middle.
pub(super) fn verdict(paper_kpa: f64, ours: &Spread) -> String {
    let percent = 100.0 * (ours.median / paper_kpa - 1.0);
    let off = match percent {
        _ if !percent.is_finite() => return "Nothing of ours to compare.".to_owned(),
        p if p.abs() < 0.5 => "as large".to_owned(),
        p if p >= 100.0 => format!("{:.1} times as large", ours.median / paper_kpa),
        p if p > 0.0 => format!("{p:.0} % larger"),
        p => format!("{:.0} % smaller", -p),
    };
    let ratio = ours.median / paper_kpa;
    let near = ratio.max(ratio.recip()) <= NEAR;
    match (ours.p10..=ours.p90).contains(&paper_kpa) {
        true if near => format!("Agrees: within our 10–90 %, our median is {off}."),
        true => {
            format!("Differs: our median is {off}; our 10–90 % is so wide that it holds the paper's number.")
        }
        false => format!("Differs: our median is {off}."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_follow_the_numbers() {
        let ours = Spread { p10: 10.0, median: 13.0, p90: 16.0 };
        assert_eq!(verdict(12.0, &ours), "Agrees: within our 10–90 %, our median is 8 % larger.");
        assert_eq!(verdict(26.0, &ours), "Differs: our median is 50 % smaller.");
        assert_eq!(verdict(6.5, &ours), "Differs: our median is 2.0 times as large.");
        // A spread that holds anything agrees with nothing.
        let wide = Spread { p10: 3.4, median: 14.8, p90: 40.7 };
        let width = "our 10–90 % is so wide that it holds the paper's number.";
        assert_eq!(verdict(4.22, &wide), format!("Differs: our median is 3.5 times as large; {width}"));
        assert_eq!(verdict(30.0, &wide), format!("Differs: our median is 51 % smaller; {width}"));
        // A quarter more, or the paper a quarter more, is the end of it.
        assert!(verdict(10.5, &ours).starts_with("Agrees") && verdict(10.3, &ours).starts_with("Differs"));
        assert!(verdict(16.0, &ours).starts_with("Agrees"));
        assert_eq!(spread(&ours, 1), "13.0 (10.0 – 16.0)");
        let lost = Spread { p10: f64::INFINITY, median: f64::INFINITY, p90: f64::INFINITY };
        assert_eq!(
            (spread(&lost, 1).as_str(), verdict(1.0, &lost).as_str()),
            ("diverged", "Nothing of ours to compare.")
        );
    }
}
