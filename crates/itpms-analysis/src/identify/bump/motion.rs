//! The measured motion of a corner made ready for a fit: heights, velocities, accelerations and the state of friction, by
//! band, and where the motion is free. Called by `bump`.

use super::super::{IdentifyError, Result, guard};
use super::smooth::{BANDS, bands, derivative, integral, low_pass};
use super::{BumpCorner, BumpSignals, BumpWindow};

/// Lowest rate in Hz; the rows per second of a drive log.
const LOWEST_RATE_HZ: f64 = 99.0;
/// Velocity in m/s at which friction has turned round: three quarters of it at this velocity.
const FRICTION_VELOCITY_M_S: f64 = 0.002;
/// Low-pass in Hz of the velocity that friction follows, and of the search for the free motion.
const SLIP_HZ: f64 = 32.0;
const LOOK_HZ: f64 = 16.0;
/// The same for the search for its end, where noise is loudest beside the motion.
const ENDING_HZ: f64 = 6.0;
/// Lowest frequency that heights from accelerations keep.
const SLOWEST_HZ: f64 = 0.4;
/// Zeros before and behind a record of accelerations, so that the low-pass has settled where the record begins.
const PADDING_S: f64 = 1.5;
/// Share of the largest motion at which it has begun and at which it has ended.
const BEGUN_ACCELERATION: f64 = 0.1;
const BEGUN_VELOCITY: f64 = 0.05;
const ENDED: f64 = 0.05;
/// Time in s after the beginning in which a holder lets go and a wheel comes down.
const LETTING_GO_S: f64 = 0.1;
/// Time in s at either end of the record that the slowest low-pass smears with what was not measured.
const SMEARED_S: f64 = 0.15;
/// Shortest motion in s that is worth a fit.
const SHORTEST_S: f64 = 0.5;

/// Everything in one band, in the rows of the record.
#[derive(Debug, Clone)]
pub(super) struct Band {
    /// Wheel above body, in m, and its velocity in m/s.
    pub(super) travel: Vec<f64>,
    pub(super) travel_velocity: Vec<f64>,
    /// Friction as a share of its full value, signed as the velocity.
    pub(super) slip: Vec<f64>,
    pub(super) wheel: Vec<f64>,
    pub(super) wheel_velocity: Vec<f64>,
    pub(super) wheel_acceleration: Vec<f64>,
    pub(super) body_acceleration: Vec<f64>,
    /// What a constant is in this band, and for records of accelerations what a step at the beginning is: the force of the
    /// hand that held the body.
    pub(super) constants: Vec<Vec<f64>>,
}

#[derive(Debug, Clone)]
pub(super) struct Motion {
    pub(super) step_s: f64,
    pub(super) first_s: f64,
    pub(super) bands: Vec<Band>,
    pub(super) wheel_acceleration: Vec<f64>,
    pub(super) rows: std::ops::Range<usize>,
}

/// The motion before it is cut into bands.
struct Whole {
    body: [Vec<f64>; 3],
    wheel: [Vec<f64>; 3],
    begins: usize,
    /// Rows that padding put before the record.
    padding: usize,
    /// Whether what is slow has to be taken out.
    drifts: bool,
}

impl Motion {
    pub(super) fn of(time_s: &[f64], corner: &BumpCorner<'_>, window: BumpWindow) -> Result<Self> {
        let step_s = step(time_s)?;
        let whole = match corner.signals {
            BumpSignals::Heights { body_m, wheel_m } => {
                check(time_s, ("the body's height", body_m), ("the wheel's height", wheel_m))?;
                from_heights(body_m, wheel_m, step_s)
            }
            BumpSignals::Accelerations { body_m_s2, wheel_m_s2 } => {
                check(
                    time_s,
                    ("the body's acceleration", body_m_s2),
                    ("the wheel's acceleration", wheel_m_s2),
                )?;
                from_accelerations(body_m_s2, wheel_m_s2, step_s)
            }
        };
        let first_s = time_s[0] - whole.padding as f64 * step_s;
        let row = |time: f64| ((time - first_s) / step_s).round().max(0.0) as usize;
        let last = whole.padding + time_s.len();
        let begins = window.from_s.map_or(whole.begins, row);
        let smeared = (SMEARED_S / step_s) as usize;
        let settled = window.from_s.map_or(whole.begins + (LETTING_GO_S / step_s) as usize, row);
        let settled = settled.max(whole.padding + smeared);
        let travel: [Vec<f64>; 2] = [0, 1].map(|i| difference(&whole.wheel[i], &whole.body[i]));
        let slow = |x: &[f64]| if whole.drifts { without_slow(x, step_s) } else { x.to_vec() };
        let closing = low_pass(&slow(&travel[1]), SLIP_HZ, step_s);
        let ends =
            window.until_s.map_or_else(|| ending(&low_pass(&closing, ENDING_HZ, step_s), settled, last), row);
        let ends = ends.min(last.saturating_sub(smeared));
        let shortest = (SHORTEST_S / step_s) as usize;
        if ends <= settled + shortest {
            let found = ends.saturating_sub(settled);
            return Err(IdentifyError::too_few("rows of free motion", found, shortest));
        }
        let slip: Vec<f64> = closing.iter().map(|v| (v / FRICTION_VELOCITY_M_S).tanh()).collect();
        let mut constants = vec![vec![1.0; travel[0].len()]];
        if whole.drifts {
            let held: Vec<f64> = (0..travel[0].len()).map(|i| if i < begins { 1.0 } else { 0.0 }).collect();
            constants.push(slow(&held));
        }
        let cut = |x: &[f64]| bands(&slow(x), step_s);
        let mut parts = [
            &travel[0],
            &travel[1],
            &slip,
            &whole.wheel[0],
            &whole.wheel[1],
            &whole.wheel[2],
            &whole.body[2],
        ]
        .map(|x| cut(x).into_iter());
        let mut constants: Vec<_> = constants.iter().map(|x| bands(x, step_s).into_iter()).collect();
        let mut next = |i: usize| parts[i].next().unwrap_or_default();
        let by_band = (0..BANDS)
            .map(|_| Band {
                travel: next(0),
                travel_velocity: next(1),
                slip: next(2),
                wheel: next(3),
                wheel_velocity: next(4),
                wheel_acceleration: next(5),
                body_acceleration: next(6),
                constants: constants.iter_mut().map(|c| c.next().unwrap_or_default()).collect(),
            })
            .collect();
        let [_, _, wheel_acceleration] = whole.wheel;
        Ok(Self { step_s, first_s, bands: by_band, wheel_acceleration, rows: settled..ends })
    }

    /// The mean of this motion and another one of the same record.
    pub(super) fn mean_with(&self, other: &Self) -> Self {
        let bands = self
            .bands
            .iter()
            .zip(&other.bands)
            .map(|(a, b)| Band {
                travel: mean(&a.travel, &b.travel),
                travel_velocity: mean(&a.travel_velocity, &b.travel_velocity),
                slip: mean(&a.slip, &b.slip),
                wheel: mean(&a.wheel, &b.wheel),
                wheel_velocity: mean(&a.wheel_velocity, &b.wheel_velocity),
                wheel_acceleration: mean(&a.wheel_acceleration, &b.wheel_acceleration),
                body_acceleration: mean(&a.body_acceleration, &b.body_acceleration),
                constants: a.constants.iter().zip(&b.constants).map(|(a, b)| mean(a, b)).collect(),
            })
            .collect();
        Self {
            bands,
            wheel_acceleration: mean(&self.wheel_acceleration, &other.wheel_acceleration),
            rows: self.rows.start.max(other.rows.start)..self.rows.end.min(other.rows.end),
            ..*self
        }
    }

    /// A quantity of all bands together, in the rows of the free motion.
    pub(super) fn whole(&self, quantity: impl Fn(&Band) -> &Vec<f64>) -> Vec<f64> {
        self.rows.clone().map(|row| self.bands.iter().map(|band| quantity(band)[row]).sum()).collect()
    }

    pub(super) fn time_s(&self, row: usize) -> f64 {
        self.first_s + row as f64 * self.step_s
    }
}

/// The step of a record, uniform to a tenth of itself.
fn step(time_s: &[f64]) -> Result<f64> {
    guard::at_least("rows", time_s.len(), 3)?;
    guard::finite("time_s", time_s)?;
    let step = (time_s[time_s.len() - 1] - time_s[0]) / (time_s.len() - 1) as f64;
    for (i, pair) in time_s.windows(2).enumerate() {
        if !(pair[1] > pair[0]) {
            return Err(IdentifyError::time_order(i + 2, pair[0], pair[1]));
        }
        if !((pair[1] - pair[0] - step).abs() < 0.1 * step) {
            return Err(IdentifyError::Refused(format!(
                "time_s steps by {:.6} s at row {}, expected {step:.6} s as on average: one rate throughout",
                pair[1] - pair[0],
                i + 2
            )));
        }
    }
    if !(1.0 / step >= LOWEST_RATE_HZ) {
        let found = format!("found {:.1} rows per second, expected at least 100", 1.0 / step);
        return Err(IdentifyError::Refused(found));
    }
    Ok(step)
}

fn check(time_s: &[f64], body: (&'static str, &[f64]), wheel: (&'static str, &[f64])) -> Result<()> {
    guard::pair(("time_s", time_s), body)?;
    guard::pair(body, wheel)?;
    guard::varies(body.0, body.1)?;
    guard::varies(wheel.0, wheel.1).map(|_| ())
}

fn from_heights(body_m: &[f64], wheel_m: &[f64], step_s: f64) -> Whole {
    let motion = |x: &[f64]| {
        let velocity = derivative(x, step_s);
        let acceleration = derivative(&velocity, step_s);
        [x.to_vec(), velocity, acceleration]
    };
    let (body, wheel) = (motion(body_m), motion(wheel_m));
    let begins = beginning(&low_pass(&body[1], LOOK_HZ, step_s), BEGUN_VELOCITY);
    Whole { body, wheel, begins, padding: 0, drifts: false }
}

fn from_accelerations(body_m_s2: &[f64], wheel_m_s2: &[f64], step_s: f64) -> Whole {
    let padding = (PADDING_S / step_s) as usize;
    let motion = |x: &[f64]| {
        let mean = x.iter().sum::<f64>() / x.len() as f64;
        let rest = vec![0.0; padding];
        let acceleration: Vec<f64> =
            rest.iter().copied().chain(x.iter().map(|a| a - mean)).chain(rest.iter().copied()).collect();
        let velocity = integral(&acceleration, step_s);
        [integral(&velocity, step_s), velocity, acceleration]
    };
    let (body, wheel) = (motion(body_m_s2), motion(wheel_m_s2));
    let begins = beginning(&low_pass(&body[2], LOOK_HZ, step_s), BEGUN_ACCELERATION);
    Whole { body, wheel, begins, padding, drifts: true }
}

/// The first row at which there is a share of the largest motion.
fn beginning(motion: &[f64], share: f64) -> usize {
    let largest = motion.iter().fold(0.0f64, |most, v| most.max(v.abs()));
    motion.iter().position(|v| v.abs() > share * largest).unwrap_or(0)
}

/// One beyond the last row at which there is a share of the largest motion.
fn ending(motion: &[f64], from: usize, last: usize) -> usize {
    let Some(free) = motion.get(from..last) else { return from };
    let largest = free.iter().fold(0.0f64, |most, v| most.max(v.abs()));
    from + free.iter().rposition(|v| v.abs() > ENDED * largest).map_or(0, |i| i + 1)
}

fn without_slow(x: &[f64], step_s: f64) -> Vec<f64> {
    difference(x, &low_pass(x, SLOWEST_HZ, step_s))
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn mean(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect()
}
