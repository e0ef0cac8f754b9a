//! The vehicle file of a typical car as text: every value with its standard deviation and a comment on where it is from.
//! Called by [`TypicalCar::vehicle_file`](super::TypicalCar::vehicle_file) alone.

use std::fmt::Write as _;

use itpms_core::model::Corner;

use super::entry::line;
use super::{
    Axle, DAMPING_SD, FRICTION_N, SPRING_SD, SPRUNG_MASS_SD, STIFFNESS_SD, TIRE_DAMPING_N_S_PER_M, TireSize,
    TypicalCar, UNSPRUNG_MASS_SD, WHEELBASE_SD_M,
};
use crate::toml_table::escaped;

pub(super) fn vehicle_file(car: &TypicalCar) -> String {
    let figures = car.class.figures();
    let class = car.class.label();
    let mut out = String::from(
        "# Typical values of other cars, by itpms vehicle init; docs/vehicle.md says how good each of them is.\n\
         # Replace what you have measured, and its standard deviation with it (relative: 0.05 is 5 %).\n\n[vehicle]\n",
    );
    let made_up = format!("{class}, {} kg, {}", car.mass_kg, car.tire);
    let name = escaped(car.name.as_deref().unwrap_or(&made_up));
    let _ = writeln!(out, "name = \"{name}\"");
    match car.wheelbase_m {
        Some(wheelbase_m) => line(&mut out, "wheelbase_m", wheelbase_m, 3, "as given"),
        None => {
            let typical = format!("typical {class}; measure it to 1 cm, or let itpms vehicle learn find it");
            line(&mut out, "wheelbase_m", figures.wheelbase_m, 2, &typical);
            line(&mut out, "wheelbase_sd_m", WHEELBASE_SD_M, 2, "assumed");
        }
    }
    out.push_str("confidence = \"typical\"\n");
    if let Some(axles) = &car.wheels {
        super::wheels::axle_keys(&mut out, axles);
    }
    let size = |axle: usize| car.tire.axles()[axle];
    let wheels = car.wheels.is_some();
    tire(&mut out, "tire", &size(0), wheels);
    for (corner, axle) in Corner::ALL.into_iter().zip([0, 0, 1, 1]) {
        corner_table(&mut out, car, corner, axle);
        if size(axle) != size(0) {
            tire(&mut out, &format!("corner.{}.tire", corner.label()), &size(axle), wheels);
        }
    }
    out
}

fn tire(out: &mut String, table: &str, size: &TireSize, wheels: bool) {
    let _ = writeln!(out, "\n[{table}]");
    line(
        out,
        "stiffness_per_kpa",
        size.stiffness_per_kpa(),
        1,
        &format!("N/m per kPa: by the size {size}, as Rhyne 2005 and three tires measured over pressure"),
    );
    line(
        out,
        "stiffness_at_zero",
        size.stiffness_at_zero(),
        0,
        "N/m: what 87 kPa are worth, as in those tires",
    );
    line(
        out,
        "stiffness_relative_sd",
        STIFFNESS_SD,
        2,
        "scatter of published tires about that; itpms lab calibrate, for a tire on a bench",
    );
    line(out, "rolling_radius_m", size.rolling_radius_m(), 3, "3.05 diameters to a turn (ETRTO)");
    if wheels {
        super::wheels::radius_keys(out);
    }
}

fn corner_table(out: &mut String, car: &TypicalCar, corner: Corner, axle: usize) {
    let figures = car.class.figures();
    let class = car.class.label();
    let Axle { sprung_kg, unsprung_kg, spring_n_per_m, damping_n_s_per_m } = car.axles()[axle];
    let share = 100.0 * [car.front_share, 1.0 - car.front_share][axle];
    let _ = writeln!(out, "\n[corner.{}]", corner.label());
    line(
        out,
        "sprung_mass_kg",
        sprung_kg,
        1,
        &format!(
            "half of {share:.0} % of {} kg, less the wheel; the load is identified on the way",
            car.mass_kg
        ),
    );
    line(out, "sprung_mass_relative_sd", SPRUNG_MASS_SD, 2, "driver, passengers, fuel");
    line(
        out,
        "unsprung_mass_kg",
        unsprung_kg,
        1,
        &format!(
            "all four are {:.1} % of the car ({class}; NHTSA cars 10.7-11.7 %, golden car 13 %)",
            100.0 * figures.unsprung_share
        ),
    );
    line(
        out,
        "unsprung_mass_relative_sd",
        UNSPRUNG_MASS_SD,
        2,
        "scatter of published cars; a per cent here is 3 kPa without a calibration",
    );
    line(
        out,
        "spring_n_per_m",
        spring_n_per_m,
        0,
        &format!("body at {:.2} Hz ({class}; published cars 1.25-1.8 Hz)", figures.body_hz[axle]),
    );
    line(out, "spring_relative_sd", SPRING_SD, 2, "scatter of those; itpms lab identify spring or bump");
    line(
        out,
        "damping_n_s_per_m",
        damping_n_s_per_m,
        0,
        &format!("damping ratio {:.2} (published cars 0.17-0.40)", figures.damping_ratio[axle]),
    );
    line(out, "damping_relative_sd", DAMPING_SD, 2, "scatter of those; itpms lab identify damper or bump");
    line(
        out,
        "friction_n",
        FRICTION_N[0],
        1,
        "struts have some 10 to 100 N (assumed; itpms lab identify bump)",
    );
    line(out, "friction_sd_n", FRICTION_N[1], 1, "");
    line(
        out,
        "tire_damping_n_s_per_m",
        TIRE_DAMPING_N_S_PER_M[0],
        1,
        "a rolling tire hardly damps (assumed; 50 is usual in MF-Tyre files)",
    );
    line(out, "tire_damping_sd_n_s_per_m", TIRE_DAMPING_N_S_PER_M[1], 1, "");
    line(
        out,
        "placard_kpa",
        car.placard_kpa.axles()[axle],
        1,
        "from the placard in the door frame: cold, gauge",
    );
}
