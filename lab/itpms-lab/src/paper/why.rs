//! Why the published filter cannot find the stiffness, and what can: the study of observability for the paper's car.
//!
//! Called by [`super::reproduce`].

use std::ops::ControlFlow;

use super::data::Data;
use super::section::{Section, Table, number};
use crate::observability::{Car, Observability, Situation, Sources, Subject, Varied, study};
use crate::runner::Result;

/// When the bounds are printed, in s.
const REPORTED_S: [f64; 3] = [2.0, 8.0, 40.0];

/// The section; needs no drive. Errors: none for the paper's car.
pub(super) fn section() -> Result<Section> {
    let found = study(&Subject::paper(), &|_| ControlFlow::Continue(()))?;
    let mut figures = found.figures().into_iter();
    let mut section = Section::new("why", "Why: what two accelerations can tell, and what they cannot")
        .text(found.proof_text())
        .table(twins(&found), "Each drive is integrated by itself, from its own road and its own stiffness.");
    if let Some(figure) = figures.next() {
        section = section.figure(
            figure,
            "Four tires on four roads: the wheel's acceleration is one line drawn four times. No estimator that assumes nothing of the road \
             can tell them apart.",
            vec![twin_data(&found)],
        );
    }
    section = section
        .text(found.rank_text())
        .table(ranks(&found), "Exact derivatives at 20 instants of a steady motion; the same rank at each.")
        .text(found.conditions_text())
        .table(bounds(&found), "Least sd in kPa after 2 / 8 / 40 s; a dash is nothing at all.")
        .text(found.lesson_text());
    if let Some(figure) = figures.next() {
        section = section.figure(
            figure,
            "Each source alone, and together. With a known car, comparing (b, c) is far sharper than the road's spectrum (a); with a car known \
             as well as its file, its unsprung mass is the floor.",
            vec![time_data(&found)],
        );
    }
    section = section.text(found.circumstances_text());
    if let Some(figure) = figures.next() {
        let caption = "Eight seconds after a loss of 20 %: over speed, damping, sensor noise, and the share of the road that each wheel or pass has for \
             itself.";
        section = section.figure(figure, caption, vec![sweep_data(&found)]);
    }
    Ok(section)
}

fn twins(found: &Observability) -> Table {
    let others = || found.twins.drives.iter().skip(1);
    let data = Data::new("why-twins", "Tires that are not distinguishable")
        .text("tire", others().map(|twin| twin.label.clone()))
        .numbers("road_difference_rms_m", others().map(|twin| twin.road_difference_rms_m))
        .numbers("body_relative_difference", others().map(|twin| twin.relative_difference[0]))
        .numbers("wheel_relative_difference", others().map(|twin| twin.relative_difference[1]));
    let head = [
        "Tire",
        "Its road differs by, mm rms",
        "Body acceleration differs by",
        "Wheel acceleration differs by",
    ];
    others().fold(Table::new("Tires that are not distinguishable", &head, data), |table, twin| {
        table.row([
            twin.label.clone(),
            number(1e3 * twin.road_difference_rms_m, 3),
            format!("{:.0e}", twin.relative_difference[0]),
            format!("{:.0e}", twin.relative_difference[1]),
        ])
    })
}

fn ranks(found: &Observability) -> Table {
    let all = || found.ranks.iter();
    let data = Data::new("why-rank", "Rank with the road as unknown input")
        .text("case", all().map(|case| case.label.clone()))
        .numbers("unknowns", all().map(|case| case.unknowns as f64))
        .numbers("rank", all().map(|case| case.rank as f64))
        .numbers("missing", all().map(|case| case.missing as f64))
        .numbers("drifts", all().map(|case| case.drifts as f64))
        .text("stiffness", all().map(|case| case.stiffness.label().to_owned()));
    let head = ["Case", "Rank", "Missing", "Of these drift", "Stiffness"];
    all().fold(Table::new("Rank with the road as unknown input", &head, data), |table, case| {
        table.row([
            case.label.clone(),
            format!("{} of {}", case.rank, case.unknowns),
            case.missing.to_string(),
            case.drifts.to_string(),
            case.stiffness.label().to_owned(),
        ])
    })
}

/// A car and a situation, in the order of the columns.
fn columns() -> impl Iterator<Item = (Car, Situation)> + Clone {
    Car::ALL.into_iter().flat_map(|car| Situation::ALL.map(|situation| (car, situation)))
}

fn bounds(found: &Observability) -> Table {
    let at = |sources: &str, (car, situation): (Car, Situation), t: f64| {
        found.curve(sources, situation, car).map_or(f64::NAN, |curve| curve.at(t))
    };
    let labels: Vec<String> = Sources::ALL.into_iter().map(|sources| sources.to_string()).collect();
    let mut data = Data::new("why-bounds", "Least sd for each source of information")
        .text("sources", labels.iter().cloned());
    for (column, t) in columns().flat_map(|column| REPORTED_S.map(|t| (column, t))) {
        let name = format!("{}_{}_{t}_s_kpa", column.0.label(), column.1.label()).replace('-', "_");
        data = data.numbers(name, labels.iter().map(|label| at(label, column, t)));
    }
    let head = [
        "Sources",
        "In words",
        "Car known, constant pressure",
        "Car known, after a loss",
        "Car uncertain, constant pressure",
        "Car uncertain, after a loss",
    ];
    Sources::ALL.into_iter().zip(&labels).fold(
        Table::new("Least sd for each source of information", &head, data),
        |table, (sources, label)| {
            let cells = columns().map(|column| configured(REPORTED_S.map(|t| at(label, column, t))));
            table.row([label.clone(), sources.text().to_owned()].into_iter().chain(cells))
        },
    )
}

/// `25.5 / 12.7 / 5.7`, or a dash where nothing can be known.
fn configured(sds: [f64; 3]) -> String {
    if sds.iter().all(|sd| !sd.is_finite()) {
        return "–".to_owned();
    }
    sds.map(|sd| number(sd, if sd < 1.0 { 2 } else { 1 })).join(" / ")
}

fn twin_data(found: &Observability) -> Data {
    let data = Data::new("observability-twins", "Four tires, four roads, one measurement")
        .numbers("time_s", found.twins.time_s.iter().copied());
    found.twins.drives.iter().enumerate().fold(data, |data, (i, twin)| {
        data.numbers(format!("pressure_{i}_kpa"), twin.pressure_kpa.iter().copied())
            .numbers(format!("road_{i}_m"), twin.road_m.iter().copied())
            .numbers(format!("wheel_accel_{i}_m_s2"), twin.wheel_accel_m_s2.iter().copied())
    })
}

fn time_data(found: &Observability) -> Data {
    let rows = || found.curves.iter().flat_map(|curve| curve.points.iter().map(move |point| (curve, *point)));
    Data::new("observability-time", "Least sd over time")
        .text("sources", rows().map(|(curve, _)| curve.sources.clone()))
        .text("situation", rows().map(|(curve, _)| curve.situation.label().to_owned()))
        .text("car", rows().map(|(curve, _)| curve.car.label().to_owned()))
        .numbers("time_s", rows().map(|(_, point)| point.0))
        .numbers("sd_kpa", rows().map(|(_, point)| point.1))
}

fn sweep_data(found: &Observability) -> Data {
    let rows = || {
        let of = |varied: Varied| found.sweeps.iter().filter(move |sweep| sweep.varied == varied);
        let all = Varied::ALL.into_iter().flat_map(of);
        all.flat_map(|sweep| sweep.points.iter().map(move |point| (sweep, *point)))
    };
    Data::new(
        "observability-sweeps",
        "Least sd over speed, damping, noise and the share of the road that is not common",
    )
    .text("varied", rows().map(|(sweep, _)| sweep.varied.label().to_owned()))
    .text("sources", rows().map(|(sweep, _)| sweep.sources.clone()))
    .text("car", rows().map(|(sweep, _)| sweep.car.label().to_owned()))
    .numbers("value", rows().map(|(_, point)| point.0))
    .numbers("sd_kpa", rows().map(|(_, point)| point.1))
}
