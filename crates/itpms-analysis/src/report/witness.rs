//! The reading of the car's own tire sensor beside the estimate: a witness, which may be wrong itself.
//!
//! Called by the collector for every row; the page and the summary show the last reading, and name one that contradicts the estimate for good.

use itpms_core::model::{CornerEstimate, PressureUnit};

/// Standard deviation of such a sensor in kPa: makers state 7 kPa (1 psi) or better over the temperatures of driving.
const SENSOR_SD_KPA: f64 = 7.0;
/// Standard deviations of both together by which they contradict each other.
const SDS: f64 = 3.0;
/// Seconds, and readings, for which they have to: a sensor sends with every minute, and a tire that loses air is ahead of it.
const FOR_GOOD_S: f64 = 120.0;
const FOR_GOOD_READINGS: u64 = 2;
/// Seconds after which a reading says nothing of now: some sensors send every ten minutes.
const OLD_S: f64 = 900.0;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TireSensor {
    /// When it last sent, in s after [`DriveFigures::origin_s`](super::DriveFigures::origin_s).
    pub time_s: f64,
    pub pressure_kpa: f64,
    /// Since when it has contradicted the estimate, in the same time; `None` where it does not for good.
    pub contradicts_since_s: Option<f64>,
}

impl TireSensor {
    /// That in words beside an estimate; `None` where they agree.
    pub fn contradiction(&self, estimate_kpa: f64, sd_kpa: f64, unit: PressureUnit) -> Option<String> {
        let since_s = self.contradicts_since_s?;
        Some(format!(
            "the tire's own sensor sends {} {unit}, the estimate is {} with an sd of {}, and they have contradicted each other since {since_s:.0} s: the sensor is wrong, sits in another wheel, or the vehicle file does not describe this tire",
            unit.number(self.pressure_kpa, 0),
            unit.number(estimate_kpa, 0),
            unit.number(sd_kpa, 0),
        ))
    }
}

/// The sensor in the middle of a drive.
#[derive(Debug, Default)]
pub(super) struct Witness {
    last: Option<(f64, f64)>,
    /// Since when they contradict each other, and readings since then.
    since: Option<(f64, u64)>,
    now_s: f64,
}

impl Witness {
    /// Takes a row; `sensor_kpa` is NaN where nothing was sent.
    pub(super) fn push(&mut self, time_s: f64, estimate: &CornerEstimate<f64>, sensor_kpa: f64) {
        let sent = sensor_kpa.is_finite();
        if sent {
            self.last = Some((time_s, sensor_kpa));
        }
        self.now_s = time_s;
        let Some((_, kpa)) = self.last.filter(|(sent_s, _)| time_s - sent_s <= OLD_S) else { return };
        if !estimate.validity.is_valid() {
            return;
        }
        let sd_kpa = estimate.pressure_sd_kpa.hypot(SENSOR_SD_KPA);
        self.since = match ((kpa - estimate.pressure_kpa).abs() > SDS * sd_kpa, self.since) {
            (false, _) => None,
            (true, None) => Some((time_s, u64::from(sent))),
            (true, Some((since_s, readings))) => Some((since_s, readings + u64::from(sent))),
        };
    }

    pub(super) fn finish(&self) -> Option<TireSensor> {
        let (time_s, pressure_kpa) = self.last?;
        let for_good = |(since_s, readings): &(f64, u64)| {
            self.now_s - since_s >= FOR_GOOD_S && *readings >= FOR_GOOD_READINGS
        };
        let contradicts_since_s = self.since.filter(for_good).map(|(since_s, _)| since_s);
        Some(TireSensor { time_s, pressure_kpa, contradicts_since_s })
    }
}
