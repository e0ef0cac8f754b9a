//! Numbers in another unit than m/s² and m/s: suspected where physics leaves no other reading.
//!
//! Called once by the reader with the rows it has looked ahead. Signs, any of them enough:
//!
//! 1. **Gravity of size one.** Both sensors of a corner have a mean of 0.85 to 1.15 in size while the body hardly moves
//!    (rms below 0.5 about it). In g that is a sensor standing upright; in m/s² it would be a constant acceleration of
//!    1 m/s², the same for body and wheel, which no upright sensor sees and no usual offset explains. A mean of 9.81 is
//!    gravity in m/s² and welcome; estimators remove the mean.
//! 2. **Too quiet for a moving car.** The smoothest roads in use have an IRI of about 0.5 m/km, Gd(n0) = 1.6e-6 m³. The
//!    paper's car (Table 2) at speed V, slope w from 1.8 to 2.6, shows there at least 0.051 m/s² rms at the body and
//!    0.37 at the wheel for V = 20 km/h, both growing like sqrt(V), before any sensor noise is added; damping of 2500
//!    N s/m gives 0.08 and 0.37. So less than `0.05 sqrt(V / 20 km/h)` at every body *and* less than
//!    `1.0 sqrt(V / 20 km/h)` at every wheel is not a drive in m/s². Class A at 20 km/h, w = 2.14, is 0.24 and 2.3 m/s²
//!    (noise included), hence 0.025 and 0.24 in g: caught; at 80 km/h 0.053 and 0.53 against limits of 0.1 and 2: caught.
//!    Below 5 m/s nothing is reported: a parked car shows its sensors' noise in any unit. Where the speed is unknown a wheel
//!    that moves four times as much as its body shows that the car rolls; then the body's limit is 0.035.
//!
//! 3. **Faster than cars are**: more than 90 m/s (324 km/h) in more than a hundredth of the rows is a speed in km/h. One that
//!    stays below is not seen.
//! 4. **Wheels calmer than their bodies.** A wheel follows the road at frequencies at which its body rests on springs: its rms
//!    is four to fifteen times the body's, noise of both taken in, and hardly ever less than noise of both alone makes it,
//!    once. In g it is 0.4 to 1.5 times the body's, in columns that carry each other's names a tenth. So a moving car whose
//!    wheels all show less than 0.8 of their bodies' rms is not what its columns say. What changes within 0.04 s, half a
//!    swing of wheel hop, tells more: of that a body has 0.02 to 0.15 of its wheel's, the wheel 7 to 50 times its body's,
//!    and in g 0.7 to 1.7 times. Less than 1.7 at all wheels, with bodies that change by more than 0.6 m/s², which
//!    sensors' noise of 0.3 does not make, is no drive either, whether or not the speed is known. (A wheel in g on a road
//!    that moves bodies by less, and by more than 0.8 of their rms, is not seen: class A at 20 km/h.)
//! 5. **Wilder than roads are.** On class D at 80 km/h body and wheel show 4 and 42 m/s² rms, on class F, which no one drives at
//!    that speed, 17 and 170. More than 25 or 200 are thousandths of g, cm/s², mm/s² or counts. The loudest hundredth is left
//!    out: single values may be garbage, and are repaired later, row by row.
//! 6. **Gravity in two units.** The body of a corner has a mean of some 9.81 in size, its wheel one of some 1.
//!
//! Simulated drives of the paper's car (classes A-C, 15 to 120 km/h, w 1.8 to 2.6, noise 0 to 0.3 m/s², four seeds): of
//! 1620 logs in m/s², a third of them without a speed and a third with gravity, none is refused; of 540 in g with gravity
//! all are; of those without gravity all 144 on class A from 20 km/h on, some on class B, none on class C.
//!
//! Of 72 drives of the whole car (classes A-D, 20 to 100 km/h, w 1.8 to 2.6, noise 0.05 and 0.3 m/s², each with and without a
//! speed) none is refused; with bodies and wheels exchanged all are; with wheels in g, of 36 each with and without a speed, 32
//! and 26 on classes A and B, all on C and D.
//!
//! Pressures that came with the log: `truth`.
//!
//! What this cannot see: a drive in g without gravity (AC-coupled sensors) on class B and worse, which looks like a very
//! smooth road in m/s². The estimated pressure does not depend on the unit there, the road's height does.

mod truth;

use itpms_core::model::Corner;

use super::row::{LogCorner, LogRow};
use super::stand_in::stand_in;
use crate::error::Problem;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum UnitCheck {
    /// Refuse a log whose accelerations are not in m/s² by all appearance.
    #[default]
    Suspicious,
    /// The user knows better.
    Trusting,
}

/// Slowest speed in m/s at which a quiet sensor is suspicious.
const MOVING_M_S: f64 = 5.0;
/// 20 km/h, where the limits below hold.
const REFERENCE_M_S: f64 = 20.0 / 3.6;
const QUIET_BODY_M_S2: f64 = 0.05;
const QUIET_WHEEL_M_S2: f64 = 1.0;
const QUIET_BODY_UNKNOWN_SPEED_M_S2: f64 = 0.035;
/// Mean size of a sensor that shows gravity in g, 15 % for tilt, offset and scale.
const ONE_G: std::ops::RangeInclusive<f64> = 0.85..=1.15;
/// A body that shakes more than this is not the quiet background against which a mean of one would stand out.
const STEADY_BODY: f64 = 0.5;
/// Rms of bodies and wheels that is no drive's.
const VIOLENT_BODY_M_S2: f64 = 25.0;
const VIOLENT_WHEEL_M_S2: f64 = 200.0;
/// Faster than any car on a road, in m/s.
const FASTEST_M_S: f64 = 90.0;
/// How many times as large a body's acceleration is as its wheel's where they carry each other's names, at least: 3 to 10.
const EXCHANGED: f64 = 3.0;
/// Least rms of a wheel over its body's while the car moves.
const CALM_WHEEL: f64 = 0.8;
/// Least hop of a wheel over its body's, and how much of a body's is no sensor's noise, in m/s².
const CALM_HOP: f64 = 1.7;
const HOPPING_M_S2: f64 = 0.6;
/// Half a swing of wheel hop in s.
const HALF_HOP_S: f64 = 0.04;
/// Share of the values that may be garbage.
const GARBAGE: f64 = 0.01;
/// Gravity in m/s², within what tilt, offset and scale make of it.
const GRAVITY_M_S2: std::ops::RangeInclusive<f64> = 8.3..=11.3;
const ENOUGH: usize = 200;

#[derive(Debug, Clone, Copy)]
struct Spread {
    mean: f64,
    rms: f64,
}

impl Spread {
    fn of(values: &[f64]) -> Option<Self> {
        let values = values.iter().copied().filter(|value| value.is_finite());
        let count = values.clone().count();
        if count < ENOUGH {
            return None;
        }
        let mean = values.clone().sum::<f64>() / count as f64;
        let variance = values.map(|value| (value - mean).powi(2)).sum::<f64>() / count as f64;
        Some(Self { mean, rms: variance.sqrt() })
    }
}

/// Rms about the median without the loudest hundredth; `None` of too few.
fn core_rms(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    if values.len() < ENOUGH {
        return None;
    }
    values.sort_unstable_by(f64::total_cmp);
    let median = values[values.len() / 2];
    values.iter_mut().for_each(|value| *value = (*value - median).powi(2));
    values.sort_unstable_by(f64::total_cmp);
    values.truncate(values.len() - (GARBAGE * values.len() as f64).ceil() as usize);
    Some((values.iter().sum::<f64>() / values.len() as f64).sqrt())
}

fn column<'a>(
    rows: impl Iterator<Item = &'a LogRow>,
    corner: Corner,
    value: fn(&LogCorner) -> f64,
) -> impl Iterator<Item = f64> {
    rows.filter_map(move |row| row.corners[corner.index()].as_ref()).map(value)
}

#[derive(Debug, Clone, Copy)]
struct Pair {
    corner: Corner,
    body: Spread,
    wheel: Spread,
}

fn pairs<'a>(rows: impl Iterator<Item = &'a LogRow> + Clone) -> Vec<Pair> {
    let pair = |corner: Corner| {
        let of = |value| Spread::of(&column(rows.clone(), corner, value).collect::<Vec<_>>());
        Some(Pair { corner, body: of(|c| c.body_accel_m_s2)?, wheel: of(|c| c.wheel_accel_m_s2)? })
    };
    Corner::ALL.into_iter().filter_map(pair).collect()
}

/// Refuses numbers that cannot be in m/s², m/s and kPa. See the module. Errors: [`Problem::Units`], with what they seem to be and why.
pub fn check<'a>(rows: impl Iterator<Item = &'a LogRow> + Clone) -> Result<(), Problem> {
    let speeds = || rows.clone().map(|row| row.speed_m_s).filter(|speed| speed.is_finite());
    let fast = speeds().filter(|speed| *speed > FASTEST_M_S).count();
    let fastest = speeds().fold(0.0, f64::max);
    if fast as f64 > GARBAGE * speeds().count() as f64 {
        let evidence = format!("the car reaches {fastest:.1} m/s, {:.0} km/h", 3.6 * fastest);
        return Err(wrong_units("speed in km/h", "m/s", &evidence));
    }
    wheel_speeds_are_a_cars(rows.clone())?;
    let all = pairs(rows.clone());
    for pair in &all {
        let label = pair.corner.label();
        if GRAVITY_M_S2.contains(&pair.body.mean.abs()) && ONE_G.contains(&pair.wheel.mean.abs()) {
            let evidence = format!(
                "{label} body acceleration averages {:.2} and its wheel's {:.2}, gravity in two units",
                pair.body.mean, pair.wheel.mean
            );
            return Err(wrong_units("wheel accelerations in g", "m/s^2", &evidence));
        }
        if ONE_G.contains(&pair.body.mean.abs())
            && ONE_G.contains(&pair.wheel.mean.abs())
            && pair.body.rms < STEADY_BODY
        {
            let evidence = format!(
                "{label} body and wheel accelerations average {:.2} and {:.2}, gravity in g would",
                pair.body.mean, pair.wheel.mean
            );
            return Err(wrong_units("accelerations in g", "m/s^2", &evidence));
        }
    }
    violent(rows.clone())?;
    too_quiet(rows.clone(), &all)?;
    calm_wheels(rows.clone())?;
    truth::check(rows)
}

pub(super) fn wrong_units(suspicion: &str, expected: &str, evidence: &str) -> Problem {
    Problem::Units(format!("({suspicion}): {evidence}, expected {expected}"))
}

/// Faster than cars are is a wheel in km/h, too.
fn wheel_speeds_are_a_cars<'a>(rows: impl Iterator<Item = &'a LogRow> + Clone) -> Result<(), Problem> {
    for corner in Corner::ALL {
        let speeds = || {
            let of = |row: &LogRow| row.motion.wheel_speed_m_s[corner.index()];
            rows.clone().map(of).filter(|speed| speed.is_finite())
        };
        let fast = speeds().filter(|speed| *speed > FASTEST_M_S).count();
        if fast as f64 > GARBAGE * speeds().count() as f64 {
            let fastest = speeds().fold(0.0, f64::max);
            let evidence = format!("{} wheel speed reaches {fastest:.1} m/s", corner.label());
            return Err(wrong_units("wheel speeds in km/h", "m/s", &evidence));
        }
    }
    Ok(())
}

/// Refuses a number that comes again and again, far from all others.
fn stands_for_missing(values: impl Iterator<Item = f64>, label: &str, part: &str) -> Result<(), Problem> {
    let mut values: Vec<f64> = values.collect();
    let rows = values.len();
    values.retain(|value| value.is_finite());
    values.sort_unstable_by(f64::total_cmp);
    let Some(value) = stand_in(&values) else { return Ok(()) };
    let count = values.iter().filter(|other| **other == value).count();
    Err(format!(
        "{label} {part} acceleration is {value} in {count} of the first {rows} rows, far from all others, as where a number stands for no \
         value; expected NaN or nothing there"
    )
    .into())
}

fn violent<'a>(rows: impl Iterator<Item = &'a LogRow> + Clone) -> Result<(), Problem> {
    for corner in Corner::ALL {
        let rms = |value| core_rms(column(rows.clone(), corner, value)).unwrap_or(0.0);
        let (body, wheel) = (rms(|c| c.body_accel_m_s2), rms(|c| c.wheel_accel_m_s2));
        if body > VIOLENT_BODY_M_S2 || wheel > VIOLENT_WHEEL_M_S2 {
            let label = corner.label();
            stands_for_missing(column(rows.clone(), corner, |c| c.body_accel_m_s2), label, "body")?;
            stands_for_missing(column(rows.clone(), corner, |c| c.wheel_accel_m_s2), label, "wheel")?;
            let evidence = format!("{label} body and wheel accelerations are {body:.0} and {wheel:.0} rms");
            return Err(wrong_units("accelerations in mg, cm/s^2, mm/s^2 or raw counts", "m/s^2", &evidence));
        }
    }
    Ok(())
}

/// How much body and wheel of a corner change within half a swing of wheel hop, where the car moves or that is unknown.
fn hop<'a>(rows: impl Iterator<Item = &'a LogRow> + Clone, corner: Corner) -> Option<[f64; 2]> {
    let mut later = rows.clone().peekable();
    let mut changes = Vec::new();
    for row in rows {
        while later.next_if(|next| next.time_s - row.time_s < 0.99 * HALF_HOP_S).is_some() {}
        let next = later.peek().filter(|next| next.time_s - row.time_s < 1.5 * HALF_HOP_S);
        let both = next.and_then(|next| row.corners[corner.index()].zip(next.corners[corner.index()]));
        if let Some((now, then)) = both.filter(|_| !(row.speed_m_s <= MOVING_M_S)) {
            changes.push([
                then.body_accel_m_s2 - now.body_accel_m_s2,
                then.wheel_accel_m_s2 - now.wheel_accel_m_s2,
            ]);
        }
    }
    let [body, wheel] = [0, 1].map(|i| core_rms(changes.iter().map(|change| change[i])));
    Some([body?, wheel?])
}

fn calm_wheels<'a>(rows: impl Iterator<Item = &'a LogRow> + Clone) -> Result<(), Problem> {
    let driven = || rows.clone().filter(|row| row.speed_m_s > MOVING_M_S);
    // A sensor that is stuck says nothing about units.
    let alive = |[body, wheel]: &[f64; 2]| *body > 0.0 && *wheel > 0.0;
    let (mut all, mut evidence) = (true, None);
    for corner in Corner::ALL {
        let rms = |value| core_rms(column(driven(), corner, value));
        let rms = rms(|c| c.body_accel_m_s2).zip(rms(|c| c.wheel_accel_m_s2)).map(<[f64; 2]>::from);
        let [rms, hop] = [rms, hop(rows.clone(), corner)].map(|both| both.filter(alive));
        let calm = rms.filter(|[body, wheel]| *wheel < CALM_WHEEL * body);
        let stiff = hop.filter(|[body, wheel]| *wheel < CALM_HOP * body && *body > HOPPING_M_S2);
        all &= calm.or(stiff).is_some() || rms.or(hop).is_none();
        let label = corner.label();
        let found = match (calm, stiff) {
            (Some([body, wheel]), _) => format!(
                "{label} wheel acceleration is {wheel:.3} rms and its body's {body:.3} while the car moves"
            ),
            (_, Some([body, wheel])) => format!(
                "{label} wheel acceleration changes by {wheel:.3} rms within {HALF_HOP_S} s and its body's by {body:.3}"
            ),
            _ => continue,
        };
        // In m/s² a wheel's that is in g is ten times as large; it would still be calmer than its body.
        let exchanged = calm.or(stiff).is_some_and(|[body, wheel]| body > EXCHANGED * wheel);
        evidence.get_or_insert((found, exchanged));
    }
    match evidence.filter(|_| all) {
        Some((evidence, exchanged)) => {
            let suspicion = if exchanged {
                "body and wheel confused"
            } else {
                "wheel accelerations in g, or body and wheel confused"
            };
            Err(wrong_units(suspicion, "m/s^2", &evidence))
        }
        None => Ok(()),
    }
}

fn too_quiet<'a>(rows: impl Iterator<Item = &'a LogRow> + Clone, all: &[Pair]) -> Result<(), Problem> {
    let speeds = rows.clone().map(|row| row.speed_m_s).filter(|speed| speed.is_finite());
    let known = speeds.clone().next().is_some();
    let fast = speeds.filter(|speed| *speed > MOVING_M_S);
    let (count, sum) = fast.fold((0usize, 0.0), |(count, sum), speed| (count + 1, sum + speed));
    let (pairs, at) = match (known, count) {
        (true, 0) => return Ok(()),
        (true, _) => {
            let speed = sum / count as f64;
            (pairs(rows.filter(|row| row.speed_m_s > MOVING_M_S)), Some(speed))
        }
        (false, _) => (all.to_vec(), None),
    };
    let quiet = |pair: &Pair| match at {
        Some(speed) => {
            let scale = (speed / REFERENCE_M_S).sqrt();
            pair.body.rms < QUIET_BODY_M_S2 * scale && pair.wheel.rms < QUIET_WHEEL_M_S2 * scale
        }
        None => pair.body.rms < QUIET_BODY_UNKNOWN_SPEED_M_S2 && pair.wheel.rms > 4.0 * pair.body.rms,
    };
    // A sensor that is stuck says nothing about units.
    let alive = |pair: &&Pair| pair.body.rms > 0.0 && pair.wheel.rms > 0.0;
    let living: Vec<&Pair> = pairs.iter().filter(alive).collect();
    match living.first() {
        Some(pair) if living.iter().all(|pair| quiet(pair)) => {
            let speed = at.map_or("a rolling car".to_owned(), |speed| format!("a car at {speed:.1} m/s"));
            let evidence = format!(
                "{} body and wheel accelerations are {:.3} and {:.3} rms, quieter than {speed} on the smoothest road",
                pair.corner.label(),
                pair.body.rms,
                pair.wheel.rms
            );
            Err(wrong_units("accelerations in g", "m/s^2", &evidence))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::LogCorner;

    /// Body and wheel as sums of incommensurate sines of the given rms, about the given mean: what counts here are
    /// mean and rms, and both are known without a simulation.
    fn drive(speed: f64, mean: f64, body_rms: f64, wheel_rms: f64) -> Vec<LogRow> {
        (0..4000)
            .map(|i| {
                let t = f64::from(i) / 500.0;
                let wave = |f: f64| {
                    (std::f64::consts::TAU * f * t).sin() + (std::f64::consts::TAU * 1.37 * f * t).cos()
                };
                let corner = LogCorner::measured(mean + body_rms * wave(1.5), mean + wheel_rms * wave(11.0));
                LogRow::without_motion(t, speed, [Some(corner), None, None, None])
            })
            .collect()
    }

    fn verdict(speed: f64, mean: f64, body_rms: f64, wheel_rms: f64) -> Option<String> {
        check(drive(speed, mean, body_rms, wheel_rms).iter()).err().map(|problem| problem.to_string())
    }

    const G: f64 = 9.81;

    #[test]
    fn drives_in_g_are_refused() {
        // Class A, 20 and 80 km/h, rms by integrating the road's spectrum over the paper's car.
        for (speed, body, wheel) in [(5.56, 0.24, 2.35), (22.2, 0.52, 5.2)] {
            let text = verdict(speed, 0.0, body / G, wheel / G).unwrap();
            assert!(
                text.starts_with("wrong units suspected (accelerations in g): fl body and wheel"),
                "{text}"
            );
            assert!(verdict(f64::NAN, 0.0, body / G, wheel / G).is_some() || body > 0.3);
        }
        // With gravity any road will do, and standing still as well.
        for (body, wheel) in [(0.24, 2.35), (2.1, 20.0), (0.05, 0.05)] {
            let text = verdict(0.0, -1.0, body / G, wheel / G).unwrap();
            assert!(text.contains("average -1.0"), "{text}");
        }
        // Class A at 20 km/h in mm/s² and in mg, at 80 km/h in cm/s².
        for (body, wheel) in [(240.0, 2350.0), (24.5, 240.0), (52.0, 520.0)] {
            assert!(verdict(10.0, 0.0, body, wheel).unwrap().contains("mm/s^2"));
        }
        // A bad road is none of these.
        assert_eq!(verdict(22.2, 0.0, 8.0, 84.0), None);
    }

    #[test]
    fn a_speed_in_km_h_is_refused() {
        let text = verdict(100.0, 0.0, 0.5, 5.0).unwrap();
        assert!(text.contains("speed in km/h") && text.ends_with("360 km/h, expected m/s"), "{text}");
        assert_eq!(verdict(69.0, 0.0, 0.5, 5.0), None);
        assert_eq!(verdict(f64::NAN, 0.0, 0.5, 5.0), None);
    }

    #[test]
    fn wheels_that_are_calmer_than_their_bodies_are_refused() {
        // Class C at 60 km/h: wheels in g, and columns that carry each other's names.
        for (body, wheel, in_g) in [(1.8, 18.0 / G / 1.5, true), (18.0, 1.8, false)] {
            let text = verdict(16.7, 0.0, body, wheel).unwrap();
            assert!(text.contains("body and wheel confused"), "{text}");
            assert_eq!(text.contains("in g, or"), in_g, "{text}");
            // Standing still proves nothing; where that is unknown, a body that shakes while its wheel does not.
            assert_eq!(verdict(0.0, 0.0, body, wheel), None);
            assert_eq!(verdict(f64::NAN, 0.0, body, wheel).is_some(), body > 10.0);
        }
        // Noise alone in both.
        assert_eq!(verdict(16.7, 0.0, 1.0, 1.0), None);
        // A body that moves with its wheel's hop as a strut lets it, a fifteenth; a wheel in g; and the same so quiet that it
        // could be noise. Whether the speed is known does not matter.
        let hopping = |speed: f64, wheel: f64, body_share: f64| {
            let mut rows = drive(speed, 0.0, 0.1, wheel);
            for corner in rows.iter_mut().filter_map(|row| row.corners[0].as_mut()) {
                corner.body_accel_m_s2 += body_share * corner.wheel_accel_m_s2;
            }
            check(rows.iter()).is_err()
        };
        for speed in [16.7, f64::NAN] {
            assert!(!hopping(speed, 20.0, 1.0 / 15.0) && !hopping(speed, 20.0, 1.0 / 5.0));
            assert!(hopping(speed, 20.0 / G, G / 10.0) && !hopping(speed, 1.5 / G, G / 10.0));
        }
        // Gravity in both units, in any motion.
        let mut rows = drive(0.0, 0.0, 1.8, 2.0);
        for corner in rows.iter_mut().filter_map(|row| row.corners[0].as_mut()) {
            corner.body_accel_m_s2 += G;
            corner.wheel_accel_m_s2 += 1.0;
        }
        let text = check(rows.iter()).unwrap_err().to_string();
        assert!(text.contains("and its wheel's 1.00, gravity in two units"), "{text}");
    }

    #[test]
    fn single_garbage_is_no_unit() {
        for garbage in [-32768.0, 1e30, f64::MAX, f64::INFINITY] {
            let mut rows = drive(20.0, 0.0, 0.5, 5.0);
            rows[77].speed_m_s = garbage;
            rows[1000].corners[0].as_mut().unwrap().wheel_accel_m_s2 = garbage;
            rows[2000].corners[0].as_mut().unwrap().body_accel_m_s2 = garbage;
            assert!(check(rows.iter()).is_ok(), "{garbage}");
        }
    }

    #[test]
    fn quiet_drives_in_si_units_are_not() {
        // Class A at 20 km/h as above, a softer car on it, the smoothest road, each with and without gravity.
        for (body, wheel) in [(0.24, 2.35), (0.3, 1.0), (0.09, 0.37)] {
            for mean in [0.0, G, -G] {
                for speed in [5.56, f64::NAN] {
                    assert_eq!(verdict(speed, mean, body, wheel), None);
                }
            }
        }
        // Parked: noise alone, whatever its level.
        for noise in [0.005, 0.05, 0.3] {
            assert_eq!(verdict(0.0, 0.0, noise, noise), None);
            assert_eq!(verdict(f64::NAN, 0.0, noise, noise), None);
        }
        // One sensor with an offset of a tenth of g proves nothing.
        assert_eq!(verdict(20.0, 0.3, 0.5, 5.0), None);
    }
}
