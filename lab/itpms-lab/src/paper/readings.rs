//! The published filter in every reading of its equations, in the case of Fig. 7: does one of them follow?
//!
//! Called by [`super::reproduce`]; its table stands below Fig. 7.

use itpms_paper::{AekfUi, CorrectionInput, FactorTiming, FilterConfig, Forgetting, GradientDescent};
use itpms_sim::simulation::Simulation;
use rayon::prelude::*;

use super::case::{Case, JUDGED_FROM_S};
use super::data::Data;
use super::section::Table;
use super::standing::spread;
use super::{CORNER, Request};
use crate::runner::Result;
use crate::score::stats::{ErrorSum, Spread};

fn readings() -> [(&'static str, FilterConfig<f64>); 7] {
    let usual = FilterConfig::paper_simulation();
    let printed = usual.with_correction_input(CorrectionInput::Previous);
    let iterative = Forgetting::Iterative(GradientDescent::default());
    [
        ("new input in eq. (17), one-step factor (aekf-ui here)", usual),
        ("new input, factor of the same step in eq. (18)", usual.with_factor_timing(FactorTiming::Same)),
        ("new input, iterative factor of eq. (25) to (27)", usual.with_forgetting(iterative)),
        ("old input in eq. (17) as printed, one-step factor", printed),
        ("old input, factor of the same step in eq. (18)", printed.with_factor_timing(FactorTiming::Same)),
        ("old input, iterative factor of eq. (25) to (27)", printed.with_forgetting(iterative)),
        ("old input in eq. (17) as printed, no forgetting", printed.with_forgetting(Forgetting::None)),
    ]
}

/// RMSE over t > 3 s of every reading in one drive, kPa; infinite once diverged.
fn drive(case: &Case, seed: u64) -> Result<Vec<f64>> {
    let corner = case.scenario.corner_config(CORNER)?;
    let mut filters = vec![];
    for (_, config) in readings() {
        filters.push((AekfUi::new(corner.quarter_car, config)?, ErrorSum::default(), false));
    }
    let step_s = 1.0 / case.scenario.rate_hz;
    for row in Simulation::new(&case.scenario, seed)? {
        let Some(truth) = row.corners[CORNER.index()] else { continue };
        for (filter, sum, diverged) in filters.iter_mut().filter(|(_, _, diverged)| !diverged) {
            let record = filter.step(step_s, &truth.sample());
            *diverged = record.is_diverged();
            if row.time_s > JUDGED_FROM_S {
                sum.push(corner.tire.pressure_kpa(record.stiffness_n_per_m()) - truth.pressure_kpa, 0.0);
            }
        }
    }
    let rmse = |(_, sum, diverged): &(_, ErrorSum, bool)| if *diverged { f64::INFINITY } else { sum.rmse() };
    Ok(filters.iter().map(rmse).collect())
}

pub(super) fn table(request: &Request) -> Result<Table> {
    let case = Case::simulation("paper-drop", request)?;
    let seed = |turn: usize| request.first_seed.wrapping_add(turn as u64);
    let drives = (0..request.seeds).into_par_iter().map(|turn| drive(&case, seed(turn)));
    let drives = drives.collect::<Result<Vec<_>, _>>()?;
    let of = |i: usize| drives.iter().filter_map(move |errors| errors.get(i).copied());
    let found: Vec<(&str, Spread, usize)> = readings()
        .iter()
        .enumerate()
        .map(|(i, (name, _))| (*name, Spread::of(of(i)), of(i).filter(|error| error.is_infinite()).count()))
        .collect();
    let column = |pick: fn(&(&str, Spread, usize)) -> f64| found.iter().map(pick).collect::<Vec<_>>();
    let data = Data::new("figure-07-readings", "Readings of the published filter in the case of Figure 7")
        .text("reading", found.iter().map(|one| one.0.to_owned()))
        .numbers("rmse_median_kpa", column(|one| one.1.median))
        .numbers("rmse_p10_kpa", column(|one| one.1.p10))
        .numbers("rmse_p90_kpa", column(|one| one.1.p90))
        .numbers("diverged_drives", column(|one| one.2 as f64))
        .numbers("drives", found.iter().map(|_| request.seeds as f64));
    let head = ["Reading", "RMSE, t > 3 s (kPa)", "Diverged"];
    let mut table = Table::new("The published filter, read in other ways", &head, data);
    for (name, rmse, diverged) in found {
        table = table.row([name.to_owned(), spread(&rmse, 2), format!("{diverged} of {}", request.seeds)]);
    }
    Ok(table)
}
