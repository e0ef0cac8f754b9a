//! Pressures that came with the log, in another unit than kPa: errors against them would be nonsense.
//!
//! Tires of cars hold 150 to 350 kPa, of lorries up to 900, and a flat one some tens. So a median from 0.5 to 12 is in bar, one
//! beyond 1500 in millibar or in Pa. A value in psi looks like a flat tire and is not detected.

use itpms_core::model::Corner;

use super::{column, wrong_units};
use crate::error::Problem;
use crate::log::row::LogRow;

const BAR: std::ops::Range<f64> = 0.5..12.0;
const MOST_KPA: f64 = 1500.0;
/// Values from which a unit is known.
const ENOUGH: usize = 5;

/// Refuses true pressures that cannot be in kPa.
pub(super) fn check<'a>(rows: impl Iterator<Item = &'a LogRow> + Clone) -> Result<(), Problem> {
    for corner in Corner::ALL {
        let truth = column(rows.clone(), corner, |corner| corner.pressure_kpa);
        let mut truth: Vec<f64> = truth.filter(|value| value.is_finite()).collect();
        truth.sort_unstable_by(f64::total_cmp);
        let Some(&median) = truth.get(truth.len() / 2).filter(|_| truth.len() >= ENOUGH) else { continue };
        let suspicion = match median {
            bar if BAR.contains(&bar) => "true pressure in bar",
            much if much > MOST_KPA => "true pressure in mbar or Pa",
            _ => continue,
        };
        let evidence = format!("{}_pressure_kpa has a median of {median:.4}", corner.label());
        return Err(wrong_units(suspicion, "kPa", &evidence));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::LogCorner;

    #[test]
    fn true_pressures_in_bar_and_pa_are_refused_and_flat_tires_are_not() {
        let verdict = |pressure: fn(usize) -> f64| {
            let row = |i: usize| {
                let accel = f64::NAN;
                let corner = LogCorner {
                    body_accel_m_s2: accel,
                    wheel_accel_m_s2: accel,
                    pressure_kpa: pressure(i),
                    road_m: f64::NAN,
                };
                LogRow::without_motion(0.01 * i as f64, 20.0, [None, Some(corner), None, None])
            };
            let rows: Vec<LogRow> = (0..100).map(row).collect();
            check(rows.iter()).err().map(|problem| problem.to_string())
        };
        let text = verdict(|_| 2.413).unwrap_or_default();
        assert!(text.contains("true pressure in bar") && text.contains("fr_pressure_kpa has"), "{text}");
        assert!(text.contains("expected kPa"), "{text}");
        for much in [|_| 2413.0, |_| 241_300.0] as [fn(usize) -> f64; 2] {
            assert!(verdict(much).unwrap_or_default().contains("mbar or Pa"));
        }
        for fine in [
            |_| 241.3,
            |_| 41.4,
            |_| 900.0,
            |_| 0.0,
            |_| f64::NAN,
            // Sent seldom, and garbage at times.
            |i| if i % 10 == 0 { 241.3 } else { f64::NAN },
            |i| if i % 10 == 0 { 2.4 } else { 241.3 },
            |i| if i == 50 { 2.4 } else { f64::NAN },
        ] as [fn(usize) -> f64; 8]
        {
            assert_eq!(verdict(fine), None);
        }
    }
}
