//! Dampers: what each one damps without friction, over what it did when the car was healthy, over its neighbors; and what that says of it
//! (docs/math/dampers.md, section 3).

use itpms_data::reference::SuspensionReference;

use super::because::Because;
use super::car_body::CarBody;
use super::reading::SuspensionReading;

/// A number and its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    pub value: f64,
    pub sd: f64,
}

itpms_core::labelled! {
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum DamperState {
        /// Too little has been driven so far.
        Learning = "learning",
        Fine = "fine",
        /// It damps less than it did, by 18 % or more.
        Weak = "weak",
        /// By half or more.
        Worn = "worn",
        /// It damps more than it did, by a quarter or more.
        Stiff = "stiff",
        Unknown = "unknown",
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DamperHealth {
    /// Damping in N s/m at a tenth of a meter per second (rms), without friction, for the mass of the vehicle file.
    pub damping_n_s_per_m: Option<Measured>,
    /// That over the reference's.
    pub over_reference: Option<Measured>,
    /// Left over right of its axle, less one; over the reference's where there is one.
    pub left_right: Option<Measured>,
    /// Front over rear, less one, over the reference's.
    pub front_rear: Option<Measured>,
    /// Damping ratio of the wheel between its tire, at the pressure that it should have, and its spring.
    pub wheel_damping_ratio: Option<Measured>,
    pub state: DamperState,
    /// Why that is not more.
    pub because: Option<Because>,
}

/// What healthy cars scatter by from drive to drive beyond the fit, as logarithms and without friction (docs/dampers.md): left over right
/// against the reference, and without one, where it is also how dampers of an axle differ; front over rear; one damper over its reference at a
/// temperature that is not known; the absolute value.
const LEFT_RIGHT_SD: f64 = 0.012;
const LEFT_RIGHT_ALONE_SD: f64 = 0.045;
const FRONT_REAR_SD: f64 = 0.015;
const OVER_REFERENCE_SD: f64 = 0.06;
const DAMPING_SD: f64 = 0.1;
/// Share of friction in what the struts damp that doubles these, and up to which they are judged.
const FRICTION_SHARE: f64 = 0.5;
const MOST_FRICTION: f64 = 0.6;
/// By how much, as logarithms, dampers of one axle and of different ones may be apart and agree: 18 and 20 %.
const APART: [f64; 2] = [0.198, 0.223];
/// Over those that agree.
const WEAK: f64 = 0.82;
const WORN: f64 = 0.52;
const STIFF: f64 = 1.25;
/// All four together, over the reference: oil that is cold or hot accounts for less.
const ALL_WORN: f64 = 0.55;
const ALL_STIFF: f64 = 1.8;

impl DamperHealth {
    pub(super) fn unknown(because: Because) -> Self {
        let state = if because == Because::Short { DamperState::Learning } else { DamperState::Unknown };
        Self {
            damping_n_s_per_m: None,
            over_reference: None,
            left_right: None,
            front_rear: None,
            wheel_damping_ratio: None,
            state,
            because: Some(because),
        }
    }

    /// Of all four dampers, in the order of [`Corner::ALL`](itpms_core::model::Corner::ALL); `doubt`: why they are not judged, whatever they
    /// do.
    pub(super) fn of(
        car: &CarBody,
        reading: &SuspensionReading,
        reference: Option<&SuspensionReference>,
        doubt: Option<Because>,
    ) -> [Self; 4] {
        let found = &reading.found;
        let friction = reference.map_or(0.0, |reference| reference.friction_share).max(found.friction_share);
        if !(friction < MOST_FRICTION) {
            return [Self::unknown(Because::Smooth); 4];
        }
        let growth = 1.0 + (friction / FRICTION_SHARE).powi(3);
        let now = &found.hydraulic_n_s_per_m;
        let before = reference.map_or([1.0; 4], |reference| reference.hydraulic_n_s_per_m);
        let ln: [f64; 4] = std::array::from_fn(|i| (now[i] / before[i]).ln());
        let covariance = &reading.ln_damping_covariance;
        let spread = |weights: [f64; 4], floor: f64| {
            let row = |i: usize| (0..4).map(|j| weights[i] * covariance[i][j] * weights[j]).sum::<f64>();
            (0..4).map(row).sum::<f64>().max(0.0).sqrt().hypot(floor * growth)
        };
        let ratio = |weights: [f64; 4], floor: f64, less: f64| {
            let value = weights.iter().zip(&ln).map(|(w, ln)| w * ln).sum::<f64>().exp();
            Measured { value: value - less, sd: value * spread(weights, floor) }
        };
        let doubt = doubt.or(reference.is_none().then_some(Because::NoReference));
        let level = doubt == Some(Because::LevelControl);
        let states = match doubt {
            Some(Because::LevelControl) => states(&within_axles(&ln)),
            Some(_) => [DamperState::Unknown; 4],
            None => states(&ln),
        };
        std::array::from_fn(|i| {
            let mut own = [0.0; 4];
            own[i] = 1.0;
            let sides = if i < 2 { [1.0, -1.0, 0.0, 0.0] } else { [0.0, 0.0, 1.0, -1.0] };
            let floor = if reference.is_some() { LEFT_RIGHT_SD } else { LEFT_RIGHT_ALONE_SD };
            let damping = Measured { value: now[i], sd: now[i] * spread(own, DAMPING_SD) };
            // Damping read against springs that follow the load is not this car's.
            let against = |measured: Measured| (reference.is_some() && !level).then_some(measured);
            Self {
                damping_n_s_per_m: Some(damping),
                over_reference: against(ratio(own, OVER_REFERENCE_SD, 0.0)),
                left_right: Some(ratio(sides, floor, 1.0)),
                front_rear: against(ratio([0.5, 0.5, -0.5, -0.5], FRONT_REAR_SD, 1.0)),
                wheel_damping_ratio: Some(wheel_damping_ratio(car, i, damping)),
                state: states[i],
                because: doubt,
            }
        })
    }
}

/// Damping ratio of a wheel between its tire and its spring: without dimension, so that it is the same whatever the unit of mass.
fn wheel_damping_ratio(car: &CarBody, i: usize, damping: Measured) -> Measured {
    let stiffness = car.tire_n_per_m[i] + car.spring_n_per_m[i];
    let critical = 2.0 * (car.unsprung_mass_kg[i] * stiffness).sqrt();
    let value = (damping.value + car.tire_damping_n_s_per_m[i]) / critical;
    Measured { value, sd: value * damping.sd / damping.value }
}

/// Each damper over the better one of its axle: what is left where a load's scale is not known.
fn within_axles(ln: &[f64; 4]) -> [f64; 4] {
    std::array::from_fn(|i| ln[i] - ln[i].max(ln[i ^ 1]))
}

/// The largest set of dampers that agree is healthy, of equally large ones that nearest to the reference; the others are judged over it.
fn states(ln: &[f64; 4]) -> [DamperState; 4] {
    let members = |set: u32| (0..4usize).filter(move |i| set & (1 << i) != 0);
    let agree = |set: u32| {
        members(set)
            .all(|i| members(set).all(|j| (ln[i] - ln[j]).abs() <= APART[usize::from(i / 2 != j / 2)]))
    };
    let mean = |set: u32| members(set).map(|i| ln[i]).sum::<f64>() / f64::from(set.count_ones());
    let larger = |a: &u32, b: &u32| {
        a.count_ones().cmp(&b.count_ones()).then(mean(*b).abs().total_cmp(&mean(*a).abs()))
    };
    let Some(set) = (1..16u32).filter(|set| agree(*set)).max_by(larger) else {
        return [DamperState::Unknown; 4];
    };
    let (common, all_differ) = match mean(set).exp() {
        all if !(ALL_WORN..=ALL_STIFF).contains(&all) => (0.0, true),
        _ => (mean(set), false),
    };
    std::array::from_fn(|i| match (ln[i] - common).exp() {
        over if !over.is_finite() => DamperState::Unknown,
        _ if set & (1 << i) != 0 && !all_differ => DamperState::Fine,
        over if over < WORN => DamperState::Worn,
        over if over < WEAK => DamperState::Weak,
        over if over > STIFF => DamperState::Stiff,
        _ => DamperState::Fine,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dampers_that_differ_from_the_others_are_named() {
        use DamperState::{Fine, Stiff, Unknown, Weak, Worn};
        let states = |over: [f64; 4]| super::states(&over.map(f64::ln));
        assert_eq!(states([1.02, 0.98, 0.95, 1.01]), [Fine; 4]);
        // Cold oil.
        assert_eq!(states([1.22, 1.2, 1.28, 1.18]), [Fine; 4]);
        assert_eq!(states([0.7, 1.0, 1.05, 1.0]), [Weak, Fine, Fine, Fine]);
        assert_eq!(states([1.0, 1.0, 0.31, 0.3]), [Fine, Fine, Worn, Worn]);
        assert_eq!(states([0.72, 1.03, 0.69, 1.0]), [Weak, Fine, Weak, Fine]);
        assert_eq!(states([1.0, 1.5, 1.0, 1.02]), [Fine, Stiff, Fine, Fine]);
        assert_eq!(states([0.5, 0.5, 0.48, 0.51]), [Worn; 4]);
        assert_eq!(states([f64::NAN, 1.0, 1.0, 1.0]), [Unknown, Fine, Fine, Fine]);
    }

    #[test]
    fn where_the_load_is_not_known_the_better_damper_of_an_axle_is_the_measure() {
        // The rear springs follow a load of 40 %.
        let ln = [1.0, 0.68, 0.71, 0.7].map(f64::ln);
        use DamperState::{Fine, Weak};
        assert_eq!(states(&within_axles(&ln)), [Fine, Weak, Fine, Fine]);
    }
}
