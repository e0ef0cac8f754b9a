//! `itpms vehicle show`: a vehicle file as a table, or as JSON.

use itpms_console::{Failure, Screen, plain};
use itpms_core::model::Corner;
use itpms_data::Vehicle;
use itpms_data::vehicle::{CornerFigures, Driven, ParameterUncertainty};
use serde_json::{Value, json};

use crate::args::ShowArgs;

/// Width of the first column, of a value, and of a value with its deviation.
const NAME: usize = 34;
const CELL: usize = 20;

pub(super) fn run(args: &ShowArgs, screen: &Screen) -> Result<(), Failure> {
    let vehicle = Vehicle::read(&args.file)?;
    if args.json {
        let text = serde_json::to_string_pretty(&document(&vehicle))
            .map_err(|error| Failure::Usage(format!("the result is no JSON: {error}")))?;
        screen.print_lines(text);
    } else {
        screen.print_lines(table(&vehicle));
    }
    Ok(())
}

/// One parameter of a corner: its value, its standard deviation in the same unit, and whether the file says the latter.
struct Parameter {
    name: &'static str,
    unit: &'static str,
    value: f64,
    sd: f64,
    stated: bool,
}

/// The parameters of a corner, in the order of the file.
fn parameters(vehicle: &Vehicle, corner: Corner) -> Vec<Parameter> {
    let Some(config) = vehicle.corner(corner) else { return Vec::new() };
    let (car, stated) = (&config.quarter_car, &vehicle.details.corners[corner.index()]);
    let sd = vehicle.uncertainty(corner);
    let tire = config.tire.stiffness_n_per_m(config.placard_kpa);
    let relative = |name, unit, value: f64, sd: f64, stated: Option<f64>| Parameter {
        name,
        unit,
        value,
        sd: sd * value,
        stated: stated.is_some(),
    };
    vec![
        relative(
            "sprung mass",
            "kg",
            car.sprung_mass_kg(),
            sd.sprung_mass_relative_sd,
            stated.sprung_mass_relative_sd,
        ),
        relative(
            "unsprung mass",
            "kg",
            car.unsprung_mass_kg(),
            sd.unsprung_mass_relative_sd,
            stated.unsprung_mass_relative_sd,
        ),
        relative("spring", "N/m", car.spring_n_per_m(), sd.spring_relative_sd, stated.spring_relative_sd),
        relative(
            "damping",
            "N s/m",
            car.damping_n_s_per_m(),
            sd.damping_relative_sd,
            stated.damping_relative_sd,
        ),
        Parameter {
            name: "friction",
            unit: "N",
            value: sd.friction_n,
            sd: sd.friction_sd_n,
            stated: stated.friction_sd_n.is_some(),
        },
        relative(
            "tire stiffness at placard",
            "N/m",
            tire,
            sd.stiffness_relative_sd,
            stated.tire.stiffness_relative_sd,
        ),
        Parameter {
            name: "tire damping",
            unit: "N s/m",
            value: sd.tire_damping_n_s_per_m,
            sd: sd.tire_damping_sd_n_s_per_m,
            stated: stated.tire_damping_sd_n_s_per_m.is_some(),
        },
    ]
}

fn figures(vehicle: &Vehicle, corner: Corner) -> Option<(CornerFigures, ParameterUncertainty<f64>)> {
    let sd = vehicle.uncertainty(corner);
    vehicle.corner(corner).map(|config| (CornerFigures::of(config, sd.tire_damping_n_s_per_m), sd))
}

fn table(vehicle: &Vehicle) -> String {
    let corners: Vec<Corner> = Corner::ALL.into_iter().filter(|c| vehicle.corner(*c).is_some()).collect();
    let mut out = head(vehicle);
    if corners.is_empty() {
        return out.join("\n");
    }
    out.push(String::new());
    out.push(row("", corners.iter().map(|corner| corner.label().to_owned())));
    let columns: Vec<Vec<Parameter>> = corners.iter().map(|corner| parameters(vehicle, *corner)).collect();
    for i in 0..columns.first().map_or(0, Vec::len) {
        let first = &columns[0][i];
        out.push(row(&named(first.name, first.unit), columns.iter().map(|column| shown(&column[i]))));
    }
    let kpa = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.1}"));
    let configs = || corners.iter().filter_map(|corner| vehicle.corner(*corner));
    out.push(row("placard (kPa)", configs().map(|config| kpa(Some(config.placard_kpa)))));
    out.push(String::new());
    let derived: Vec<_> = corners.iter().filter_map(|corner| figures(vehicle, *corner)).collect();
    let line =
        |name: &str, cell: &dyn Fn(&CornerFigures) -> String| row(name, derived.iter().map(|(f, _)| cell(f)));
    out.push(line("body, tire included (Hz)", &|f| format!("{:.2}", f.body_hz)));
    out.push(line("body, tire included, damping ratio", &|f| format!("{:.2}", f.body_damping_ratio)));
    out.push(line("wheel hop (Hz)", &|f| format!("{:.1}", f.hop_hz)));
    out.push(line("wheel hop, damping ratio", &|f| format!("{:.2}", f.hop_damping_ratio)));
    out.push(line("kPa per 1 % of unsprung mass", &|f| format!("{:.2}", f.kpa_per_percent_of_mass)));
    out.push(row(
        "pressure, uncalibrated (sd, kPa)",
        derived
            .iter()
            .map(|(f, sd)| format!("{:.0}", 100.0 * sd.tire_relative_sd() * f.kpa_per_percent_of_mass)),
    ));
    out.push(String::new());
    // A body on spring and tire swings slower, and less damped, than on its spring alone, which is what such a file's comments state.
    out.push(
        "tire included: on spring and tire in series; comments by `vehicle init` are of the spring alone"
            .to_owned(),
    );
    if columns.iter().flatten().any(|parameter| !parameter.stated) {
        out.push(
            "* no standard deviation in the file: what is usual for its confidence (docs/vehicle.md)"
                .to_owned(),
        );
    }
    out.join("\n")
}

fn head(vehicle: &Vehicle) -> Vec<String> {
    let details = &vehicle.details;
    let metres = |value: Option<f64>| value.map_or("not given".to_owned(), |value| format!("{value} m"));
    let mut out = vec![
        format!("{:<NAME$}{}", "vehicle", plain(&vehicle.name)),
        format!("{:<NAME$}{}", "confidence", details.confidence.label()),
        format!("{:<NAME$}{}", "wheelbase", metres(vehicle.wheelbase_m)),
    ];
    if let Some(id) = &vehicle.id {
        out.insert(1, format!("{:<NAME$}{}", "id", plain(id)));
    }
    if details.track_front_m.is_some() || details.track_rear_m.is_some() {
        let tracks = format!("{}, {}", metres(details.track_front_m), metres(details.track_rear_m));
        out.push(format!("{:<NAME$}{tracks}", "track, front and rear"));
    }
    if let Some(driven) = details.driven {
        let coupled = if details.limited_slip { ", limited slip" } else { "" };
        out.push(format!("{:<NAME$}{}{coupled}", "driven", driven.label()));
    }
    if let Ok(config) = vehicle.wheel_speed_config() {
        let (beta, sd) = (config.radius_per_ln_pressure, config.radius_per_ln_pressure_sd);
        let shown = format!(
            "{beta:.4} ± {:.4}; a fifth less is {:.2} % of the radius",
            beta * sd,
            -100.0 * beta * 0.8f64.ln()
        );
        out.push(format!("{:<NAME$}{shown}", "rolling radius per ln p"));
    }
    out
}

fn named(name: &str, unit: &str) -> String {
    format!("{name} ({unit})")
}

fn row(name: &str, cells: impl Iterator<Item = String>) -> String {
    let cells: String = cells.map(|cell| format!("{cell:>CELL$}")).collect();
    format!("{name:<NAME$}{cells}").trim_end().to_owned()
}

fn shown(parameter: &Parameter) -> String {
    let decimals = usize::from(parameter.value < 1_000.0);
    let mark = if parameter.stated { ' ' } else { '*' };
    format!("{:.decimals$} ± {:.decimals$}{mark}", parameter.value, parameter.sd)
}

fn document(vehicle: &Vehicle) -> Value {
    let corner = |corner: Corner| {
        let (f, sd) = figures(vehicle, corner)?;
        let config = vehicle.corner(corner)?;
        let parameters: serde_json::Map<String, Value> = parameters(vehicle, corner)
            .into_iter()
            .map(|p| {
                let source = if p.stated { "file" } else { "confidence" };
                (
                    p.name.replace(' ', "_"),
                    json!({ "value": p.value, "sd": p.sd, "unit": p.unit, "sd_from": source }),
                )
            })
            .collect();
        let derived = json!({
            "tire_n_per_m": f.tire_n_per_m,
            "body_hz": f.body_hz,
            "body_damping_ratio": f.body_damping_ratio,
            "hop_hz": f.hop_hz,
            "hop_damping_ratio": f.hop_damping_ratio,
            "kpa_per_percent_of_mass": f.kpa_per_percent_of_mass,
            "uncalibrated_pressure_sd_kpa": 100.0 * sd.tire_relative_sd() * f.kpa_per_percent_of_mass,
        });
        let value =
            json!({ "placard_kpa": config.placard_kpa, "parameters": parameters, "derived": derived });
        Some((corner.label().to_owned(), value))
    };
    let corners: serde_json::Map<String, Value> = Corner::ALL.into_iter().filter_map(corner).collect();
    json!({
        "name": vehicle.name,
        "id": vehicle.id,
        "confidence": vehicle.details.confidence.label(),
        "wheelbase_m": vehicle.wheelbase_m,
        "wheel_speeds": vehicle.wheel_speed_config().ok().map(|config| json!({
            "track_front_m": config.track_front_m,
            "track_rear_m": config.track_rear_m,
            "driven": vehicle.details.driven.map(Driven::label),
            "limited_slip": config.limited_slip,
            "radius_per_ln_pressure": config.radius_per_ln_pressure,
            "radius_per_ln_pressure_sd": config.radius_per_ln_pressure * config.radius_per_ln_pressure_sd,
        })),
        "corners": corners,
    })
}
