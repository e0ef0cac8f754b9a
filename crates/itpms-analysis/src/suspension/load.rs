//! Mass on the axles. Springs are the scale that no load changes: with them at the reference's, the drive's mass and center of gravity come out in the
//! reference's kilograms (docs/math/dampers.md, section 4).

use itpms_data::reference::SuspensionReference;

use super::because::Because;
use super::car_body::CarBody;
use super::health::Measured;
use super::reading::SuspensionReading;

/// Sd of the error of a drive's load on cars whose springs are known, over many drives (docs/load.md), without friction, of the total and of an axle as shares; with friction by more, see
/// [`growth`].
const TOTAL_SD: f64 = 0.01;
const AXLE_SD: f64 = 0.011;
/// Share of dry friction in what the struts damp that doubles these, and most of it.
const FRICTION_SHARE: f64 = 0.4;
const MOST_FRICTION: f64 = 0.5;

itpms_core::labelled! {
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum LoadState {
        Known = "known",
        /// An axle carries more than it may.
        Overload = "overload",
        /// Too little has been driven so far.
        Learning = "learning",
        Unknown = "unknown",
    }
}

/// Masses in kg that the tires carry, wheels included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Masses {
    /// On the front and on the rear axle.
    pub axles_kg: [Measured; 2],
    pub total_kg: Measured,
    /// More than when the reference was learned.
    pub added_kg: Measured,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load {
    /// Axle loads, where they are known.
    pub masses: Option<Masses>,
    pub state: LoadState,
    pub because: Option<Because>,
    /// Permitted axle loads in kg, where the vehicle file has them.
    pub gross_axle_kg: Option<[f64; 2]>,
}

impl Load {
    pub(super) fn unknown(because: Because) -> Self {
        let state = if because == Because::Short { LoadState::Learning } else { LoadState::Unknown };
        Self { masses: None, state, because: Some(because), gross_axle_kg: None }
    }

    /// Of a drive against its reference; `gross_axle_kg`: what each axle may carry.
    pub(super) fn of(
        car: &CarBody,
        reading: &SuspensionReading,
        reference: &SuspensionReference,
        gross_axle_kg: Option<[f64; 2]>,
    ) -> Self {
        let friction = reading.found.friction_share.max(reference.friction_share);
        if !(friction < MOST_FRICTION) {
            return Self::unknown(Because::Smooth);
        }
        let (now, before) = (axles_kg(car, &reading.found), axles_kg(car, reference));
        let total = now[0] + now[1];
        let with_sd = |value: f64, share: f64| {
            let share = share * growth(friction);
            Measured { value, sd: value.abs() * share.hypot(reading.ln_mass_sd) }
        };
        let axles_kg = now.map(|kg| with_sd(kg, AXLE_SD));
        let total_kg = with_sd(total, TOTAL_SD);
        let added_kg = Measured { value: total - before[0] - before[1], sd: total_kg.sd };
        let masses = Some(Masses { axles_kg, total_kg, added_kg });
        let known = Self { masses, state: LoadState::Known, because: None, gross_axle_kg };
        let over = known.overloaded_axles().contains(&true);
        Self { state: if over { LoadState::Overload } else { LoadState::Known }, ..known }
    }

    /// Whether front and rear axle carry more than they may, surely so: at the permitted load one driver in twenty is warned.
    pub fn overloaded_axles(&self) -> [bool; 2] {
        let (Some(masses), Some(limits)) = (&self.masses, self.gross_axle_kg) else { return [false; 2] };
        std::array::from_fn(|i| masses.axles_kg[i].value - ONE_SIDED_95 * masses.axles_kg[i].sd > limits[i])
    }
}

const ONE_SIDED_95: f64 = 1.645;

/// By how much errors grow with the share of friction.
fn growth(friction_share: f64) -> f64 {
    1.0 + (friction_share / FRICTION_SHARE).powi(5)
}

/// Axle loads in kg, front and rear.
fn axles_kg(car: &CarBody, of: &SuspensionReference) -> [f64; 2] {
    let unsprung = &car.unsprung_mass_kg;
    let rear = of.sprung_mass_kg * of.rear_share;
    [of.sprung_mass_kg - rear + unsprung[0] + unsprung[1], rear + unsprung[2] + unsprung[3]]
}
