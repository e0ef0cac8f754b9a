//! The numbers printed in docs/math/identifiability.md are those of the study.

use std::fs;
use std::ops::ControlFlow;

use itpms_lab::observability::{Car, Observability, Situation, Subject, Varied, study};

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/math/identifiability.md");

fn rows() -> Vec<Vec<String>> {
    let page = fs::read_to_string(PAGE).unwrap();
    let cells = |line: &str| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect();
    page.lines().filter(|line| line.starts_with('|')).map(cells).collect()
}

fn found() -> Observability {
    study(&Subject::paper(), &|_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn ranks_are_those_of_the_page() {
    let rows = rows();
    for case in found().ranks {
        let row = rows.iter().find(|row| row[0] == case.label).unwrap();
        let expected = [
            format!("{} of {}", case.rank, case.unknowns),
            case.missing.to_string(),
            case.drifts.to_string(),
            case.stiffness.label().to_owned(),
        ];
        assert_eq!(row[1..], expected);
    }
}

#[test]
fn bounds_are_those_of_the_page() {
    let found = found();
    let mut compared = 0;
    let columns = Car::ALL.into_iter().flat_map(|car| Situation::ALL.map(|situation| (car, situation)));
    for row in rows().iter().filter(|row| !is_pairs(row)) {
        let sources = if row[0] == "all four" { "a+b+c+d".to_owned() } else { row[0].replace(' ', "") };
        let sources = if sources == "roadknown" { "road known" } else { &sources };
        for (cell, (car, situation)) in row[1..].iter().zip(columns.clone()) {
            let Some(curve) = found.curve(sources, situation, car) else { continue };
            let printed: Vec<&str> = cell.split(" / ").collect();
            if printed == ["-"] {
                assert!(curve.at(40.0).is_infinite(), "{sources} {situation:?} {car:?}");
                continue;
            }
            assert_eq!(printed.len(), 3, "{cell}");
            for (text, seconds) in printed.into_iter().zip([2.0, 8.0, 40.0]) {
                let decimals = text.split_once('.').map_or(0, |(_, fraction)| fraction.len());
                assert_eq!(
                    text,
                    format!("{:.decimals$}", curve.at(seconds)),
                    "{sources} {situation:?} {car:?}"
                );
                compared += 1;
            }
        }
    }
    assert!(compared > 90, "{compared}");
}

/// Cells like `0.14 / 2.7`: car known and uncertain.
fn is_pairs(row: &[String]) -> bool {
    row.get(1).is_some_and(|cell| cell.split(" / ").count() == 2)
}

#[test]
fn tracks_are_those_of_the_page() {
    let found = found();
    let rows: Vec<_> = rows().into_iter().filter(|row| is_pairs(row)).collect();
    assert_eq!(rows.len(), 3);
    for row in rows {
        let sources = if row[0] == "all four" { "a+b+c+d" } else { &row[0] };
        for (cell, share) in row[1..].iter().zip([0.0, 1e-3, 1e-2, 1e-1]) {
            for (text, car) in cell.split(" / ").zip(Car::ALL) {
                let sweep = found.sweep(sources, Varied::IncoherentShare, car).unwrap();
                let swept = sweep.points.iter().find(|(value, _)| *value == share).map(|(_, sd)| *sd);
                let common = || found.curve(sources, Situation::AfterLoss, car).unwrap().at(8.0);
                let sd = swept.unwrap_or_else(common);
                let decimals = text.split_once('.').map_or(0, |(_, fraction)| fraction.len());
                assert_eq!(text, format!("{sd:.decimals$}"), "{sources} {share} {car:?}");
            }
        }
    }
}
