//! Clocks that jump: a row's time is far ahead, far behind, none at all, or the clock was set.

use itpms_console::Failure;
use itpms_data::LogRow;
use itpms_live::engine::Published;

use super::subject::{RATE_HZ, silent};
use super::{Campaign, Outcome};

/// Seconds of rows before a jump, and after it.
const BEFORE_S: f64 = 25.0;
const AFTER_S: f64 = 20.0;
const TOLD_HZ: f64 = 10.0;
/// Seconds after a jump within which estimates have to come as before.
const SOON_S: f64 = 5.0;

/// How a clock goes wrong: what becomes of the time of the row so many rows after the jump.
type Jump = fn(f64, usize) -> f64;

const JUMPS: [(&str, Jump); 10] = [
    ("set ahead by an hour", |t, _| t + 3600.0),
    ("set back by an hour", |t, _| t - 3600.0),
    ("set ahead by a second", |t, _| t + 1.0),
    ("set back by a second", |t, _| t - 1.0),
    ("set to 1970", |t, _| t - 1.8e9),
    ("set ahead by 57 years", |t, _| t + 1.8e9),
    ("one stamp of another day", |t, row| if row == 0 { t + 86_400.0 } else { t }),
    ("one stamp of the day before", |t, row| if row == 0 { t - 86_400.0 } else { t }),
    ("no stamp for half a second", |t, row| if row < 100 { f64::NAN } else { t }),
    ("stands still for half a second", |t, row| if row < 100 { t - row as f64 / RATE_HZ } else { t }),
];

pub(super) fn jumps(campaign: &mut Campaign<'_>) -> Result<Outcome, Failure> {
    let each = campaign.of(4);
    let (mut tried, mut lost, mut warned) = (0, 0, 0);
    let mut worst: (f64, &str) = (0.0, "");
    for (name, jump) in JUMPS {
        for _ in 0..each {
            campaign.interrupt.check()?;
            let at = (BEFORE_S * RATE_HZ) as usize + campaign.moments.below((RATE_HZ * 30.0) as u64) as usize;
            let rows = &campaign.subject.rows;
            let first = at - (BEFORE_S * RATE_HZ) as usize;
            let last = (at + (AFTER_S * RATE_HZ) as usize).min(rows.len());
            let mut engine = campaign.subject.engine(None, silent());
            let (mut soon, mut false_warnings, mut resumed_s) = (0, 0, AFTER_S);
            for (place, row) in rows[first..last].iter().enumerate().map(|(place, row)| (first + place, row))
            {
                let after = place.checked_sub(at);
                let time_s = after.map_or(row.time_s, |rows_after| jump(row.time_s, rows_after));
                let jumped = LogRow { time_s, ..*row };
                let mut take = |published| match (published, after) {
                    (Published::Estimate(reported), Some(rows_after)) => {
                        let since_s = rows_after as f64 / RATE_HZ;
                        let valid = reported.wheels.iter().all(|wheel| wheel.valid);
                        resumed_s = if valid { resumed_s.min(since_s) } else { resumed_s };
                        soon += u32::from(since_s < SOON_S);
                    }
                    (Published::Warning(_), Some(_)) => false_warnings += 1,
                    _ => {}
                };
                engine.take(&jumped, None, &mut take).map_err(|error| Failure::Usage(error.to_string()))?;
            }
            tried += 1;
            warned += false_warnings;
            // Half the number of estimates in that time without a jump.
            let goes_on = f64::from(soon) >= 0.5 * SOON_S * TOLD_HZ && resumed_s < SOON_S;
            lost += u64::from(!goes_on || false_warnings > 0);
            if resumed_s > worst.0 {
                worst = (resumed_s, name);
            }
        }
    }
    let found = format!(
        "{warned} false warnings; valid pressures of all wheels after {:.2} s at most ({})",
        worst.0, worst.1
    );
    Ok(Outcome { tried, lost, found })
}
