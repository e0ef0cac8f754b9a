//! The report of a tire's own sensor: its state in a sentence, as an event and as JSON.

use itpms_core::model::{Corner, PressureUnit};
use serde_json::{Map, Value, json};

use super::SDS;

itpms_core::labelled! {
    /// State of a tire's own sensor at a drive's end.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    pub enum SensorState {
        /// Too few readings, or it sends nothing.
        #[default]
        Learning = "learning",
        /// Neither of the others.
        Fine = "fine",
        /// It sees its tire lose air.
        Leak = "leak",
        /// Its reading changes otherwise than its tire.
        Drift = "drift",
        /// Its reading has stopped changing, and its tire's pressure has not.
        Stuck = "stuck",
    }
}

/// A tire's own sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WatchedSensor {
    pub state: SensorState,
    /// Its last reading in kPa; NaN: none.
    pub pressure_kpa: f64,
    /// The tire's loss since the first reading, warmth and the other tires taken off, in kPa, and its standard deviation.
    pub lost_kpa: [f64; 2],
    /// The same per hour.
    pub lost_kpa_per_h: [f64; 2],
    /// By how much its change exceeds the estimate's, and its standard deviation, in kPa; NaN: no estimate.
    pub against_estimate_kpa: [f64; 2],
    /// Since when it has been that, in s of the log.
    pub since_s: f64,
}

impl WatchedSensor {
    pub(super) const NOTHING: Self = Self {
        state: SensorState::Learning,
        pressure_kpa: f64::NAN,
        lost_kpa: [f64::NAN; 2],
        lost_kpa_per_h: [f64::NAN; 2],
        against_estimate_kpa: [f64::NAN; 2],
        since_s: f64::NAN,
    };

    /// That in words; `None` while there is nothing to say.
    pub fn text(&self, corner: Corner, origin_s: f64, unit: PressureUnit) -> Option<String> {
        let [say, since] = [corner.label().to_owned(), format!("found at {:.0} s", self.since_s - origin_s)];
        let shown =
            |[value, sd]: [f64; 2]| format!("{} {unit} (sd {})", unit.number(value, 0), unit.number(sd, 0));
        let wrong = format!(
            "its change is {} beside the estimate's; {since}: do not rely on it",
            shown(self.against_estimate_kpa)
        );
        match self.state {
            SensorState::Learning | SensorState::Fine => None,
            SensorState::Stuck => Some(format!(
                "{say}: the tire's own sensor stays at {} {unit} whatever its tire does: it is stuck; {wrong}",
                unit.number(self.pressure_kpa, 0)
            )),
            SensorState::Drift => {
                let [value, sd] = self.against_estimate_kpa;
                let rises = format!(
                    "it has risen by {}, and a tire gains no air while it rolls; {since}: do not rely on it",
                    shown([-self.lost_kpa[0], self.lost_kpa[1]])
                );
                // The rise was it, where the estimate says little.
                let why = if value.abs() > SDS * sd { wrong } else { rises };
                Some(format!("{say}: the tire's own sensor drifts: {why}"))
            }
            SensorState::Leak => {
                let [value, sd] = self.against_estimate_kpa;
                // The estimate has an opinion where half of the loss would stand out.
                let agrees = match 2.0 * sd < 0.5 * self.lost_kpa[0] {
                    true if value.abs() < 2.0 * sd => "the estimate sees the same",
                    true => "the estimate sees another loss",
                    false => "the estimate knows nothing against it",
                };
                Some(format!(
                    "{say}: by its own sensor the tire has lost {}, {} an hour; {since}; {agrees}",
                    shown(self.lost_kpa),
                    shown(self.lost_kpa_per_h)
                ))
            }
        }
    }

    /// That as a line of `events.jsonl`.
    pub fn event(&self, corner: Corner) -> Option<Map<String, Value>> {
        let text = self.text(corner, 0.0, PressureUnit::Kpa)?;
        let mut event = self.object();
        let kind = format!("tire-sensor-{}", self.state.label());
        for (key, value) in [
            ("time_s", json!(self.since_s)),
            ("event", json!("begun")),
            ("kind", json!(kind)),
            ("wheels", json!([corner.label()])),
            ("text", json!(text)),
        ] {
            event.insert(key.to_owned(), value);
        }
        Some(event)
    }

    fn object(&self) -> Map<String, Value> {
        let number = |value: f64| json!(Some(value).filter(|value| value.is_finite()));
        let pairs = [
            ("lost_kpa", "lost_sd_kpa", self.lost_kpa),
            ("lost_kpa_per_h", "lost_sd_kpa_per_h", self.lost_kpa_per_h),
            ("against_estimate_kpa", "against_estimate_sd_kpa", self.against_estimate_kpa),
        ];
        let pairs = pairs
            .into_iter()
            .flat_map(|(name, sd, value)| [(name, number(value[0])), (sd, number(value[1]))]);
        let rest = [
            ("state", json!(self.state.label())),
            ("pressure_kpa", number(self.pressure_kpa)),
            ("since_s", number(self.since_s)),
        ];
        rest.into_iter().chain(pairs).map(|(key, value)| (key.to_owned(), value)).collect()
    }
}

/// The sensors that sent anything, by wheel; null where none did.
pub(in crate::beside) fn sensors_json(sensors: &[WatchedSensor; 4]) -> Value {
    let sent = Corner::ALL.iter().zip(sensors).filter(|(_, sensor)| sensor.pressure_kpa.is_finite());
    let sent: Map<String, Value> =
        sent.map(|(corner, sensor)| (corner.label().to_owned(), Value::Object(sensor.object()))).collect();
    if sent.is_empty() { Value::Null } else { Value::Object(sent) }
}
