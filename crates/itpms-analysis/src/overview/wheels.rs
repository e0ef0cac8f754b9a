//! The speeds of a log's wheels, and the ratios in which a tire of another size shows, before anything is calibrated. Filled by `Overview`, read
//! by `page`.

use super::trace::{Statistics, Trace};
use super::{CORNERS, extremes, known, means};
use crate::plot::{Axis, Figure, Ink, Panel, Stroke};

/// Speed in m/s below which ratios are those of steps and sharp bends.
const LEAST_M_S: f64 = 5.0;
const RATIOS: [(&str, Ink); 3] = [
    ("front left over right", Ink::Truth),
    ("rear left over right", Ink::Extra),
    ("front over rear", Ink::Light),
];
const INKS: [Ink; 4] = [Ink::Default, Ink::Adaptive, Ink::Mended, Ink::Plain];

/// A log's wheel speeds at one time; NaN where a value is missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelSignals {
    /// Speeds in m/s, or in rad/s where the log has those, front left, front right, rear left, rear right.
    pub speeds: [f64; 4],
    pub in_rad_s: bool,
    pub yaw_rate_rad_s: f64,
    pub accel_x_m_s2: f64,
}

#[derive(Debug)]
pub(super) struct Wheels {
    speeds: [Trace; 4],
    ratios: [Trace; 3],
    yaw_rate: Trace,
    accel_x: Trace,
    in_rad_s: bool,
}

#[derive(Debug)]
pub struct FoundWheels {
    /// Of the speeds, in the order of the corners; `None` of one that never came.
    pub speeds: [Option<Statistics>; 4],
    pub unit: &'static str,
    /// Of the log ratios in thousandths above 18 km/h: front left over right, rear left over right, front over rear.
    pub ratios_1e3: [Option<Statistics>; 3],
    pub yaw_rate_rad_s: Option<Statistics>,
    pub accel_x_m_s2: Option<Statistics>,
    speed_means: [Vec<(f64, f64)>; 4],
    ratio_means: [Vec<(f64, f64)>; 3],
    yaw_extremes: Vec<(f64, f64, f64)>,
}

impl Wheels {
    pub(super) fn new(start_s: f64, step_s: f64) -> Self {
        let trace = || Trace::new(start_s, step_s);
        let (speeds, ratios) = ([(); 4].map(|()| trace()), [(); 3].map(|()| trace()));
        Self { speeds, ratios, yaw_rate: trace(), accel_x: trace(), in_rad_s: false }
    }

    pub(super) fn push(&mut self, time_s: f64, signals: &WheelSignals) {
        let [fl, fr, rl, rr] = signals.speeds;
        self.in_rad_s |= signals.in_rad_s;
        self.speeds.iter_mut().zip(signals.speeds).for_each(|(trace, speed)| trace.push(time_s, speed));
        let least = if signals.in_rad_s { 3.0 * LEAST_M_S } else { LEAST_M_S };
        let rolls = signals.speeds.iter().all(|speed| *speed > least);
        let ratio = |a: f64, b: f64| if rolls { 1e3 * (a / b).ln() } else { f64::NAN };
        let ratios = [ratio(fl, fr), ratio(rl, rr), 0.5 * (ratio(fl, rl) + ratio(fr, rr))];
        self.ratios.iter_mut().zip(ratios).for_each(|(trace, ratio)| trace.push(time_s, ratio));
        self.yaw_rate.push(time_s, signals.yaw_rate_rad_s);
        self.accel_x.push(time_s, signals.accel_x_m_s2);
    }

    /// `None` where no wheel ever had a speed.
    pub(super) fn found(self) -> Option<FoundWheels> {
        let speeds = self.speeds.each_ref().map(known);
        speeds.iter().any(Option::is_some).then(|| FoundWheels {
            speeds,
            unit: if self.in_rad_s { "rad/s" } else { "m/s" },
            ratios_1e3: self.ratios.each_ref().map(known),
            yaw_rate_rad_s: known(&self.yaw_rate),
            accel_x_m_s2: known(&self.accel_x),
            speed_means: self.speeds.each_ref().map(means),
            ratio_means: self.ratios.each_ref().map(means),
            yaw_extremes: extremes(&self.yaw_rate),
        })
    }
}

impl FoundWheels {
    pub fn summary(&self) -> String {
        let missing: Vec<&str> = CORNERS
            .into_iter()
            .zip(&self.speeds)
            .filter(|(_, found)| found.is_none())
            .map(|(name, _)| name)
            .collect();
        if !missing.is_empty() {
            return format!(
                "No speed of {}: wheel speeds are compared where all four are there.",
                missing.join(", ")
            );
        }
        let ratios: Vec<String> = RATIOS
            .iter()
            .zip(&self.ratios_1e3)
            .filter_map(|((name, _), found)| {
                Some(format!("{name} {:+.1} ‰ (sd {:.1})", found.as_ref()?.mean, found.as_ref()?.sd))
            })
            .collect();
        match &ratios[..] {
            [] => "No ratio: the car was not driven above 18 km/h with all four speeds.".to_owned(),
            _ => format!(
                "Speeds above 18 km/h: {}. Tires of unequal size, bends and slip are in them; what a tire loses shows once a drive has calibrated them (itpms estimate --calibrate-s).",
                ratios.join(", ")
            ),
        }
    }

    pub(super) fn signals(&self) -> impl Iterator<Item = (String, &'static str, &Statistics)> {
        let speeds = CORNERS.into_iter().zip(&self.speeds);
        let speeds = speeds
            .filter_map(|(name, found)| Some((format!("{name}, wheel speed"), self.unit, found.as_ref()?)));
        let others = [
            ("yaw rate", "rad/s", &self.yaw_rate_rad_s),
            ("acceleration along the car", "m/s²", &self.accel_x_m_s2),
        ];
        let others = others
            .into_iter()
            .filter_map(|(name, unit, found)| Some((name.to_owned(), unit, found.as_ref()?)));
        let ratios = RATIOS.iter().zip(&self.ratios_1e3);
        speeds.chain(others).chain(
            ratios.filter_map(|((name, _), found)| Some((format!("speeds, {name}"), "‰", found.as_ref()?))),
        )
    }

    pub(super) fn figure(&self) -> Figure {
        let time = || Axis::linear("Time", "s");
        let mut speeds =
            Panel::new("", "Speeds of the wheels", time(), Axis::linear("Speed", self.unit).holding(0.0));
        for ((name, ink), course) in CORNERS.into_iter().zip(INKS).zip(&self.speed_means) {
            speeds = speeds.line(name, ink, Stroke::Solid, course.clone());
        }
        let mut ratios = Panel::new(
            "",
            "Ratios of the speeds, means of each stretch",
            time(),
            Axis::linear("Log ratio", "‰"),
        );
        for ((name, ink), course) in RATIOS.into_iter().zip(&self.ratio_means) {
            ratios = ratios.line(name, ink, Stroke::Solid, course.clone());
        }
        let figure =
            Figure::new("log-wheels", "Wheel speeds").describe(self.summary()).panel(speeds).panel(ratios);
        match &self.yaw_rate_rad_s {
            Some(_) => figure.panel(
                Panel::new("", "Yaw rate, positive to the left", time(), Axis::linear("Yaw rate", "rad/s"))
                    .band("lowest to highest", Ink::Default, self.yaw_extremes.clone()),
            ),
            None => figure,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Overview;
    use super::*;

    /// A minute at 20 m/s, the front left wheel three thousandths smaller than the right one, the rear ones alike and slower by one.
    #[test]
    fn ratios_are_those_of_the_tires_and_the_page_shows_them() {
        let mut overview = Overview::new(0.02);
        for k in 0..3000 {
            let time_s = 0.02 * f64::from(k);
            // At first it is too slow for that.
            let v = if k < 500 { 2.0 } else { 20.0 };
            overview.push(time_s, f64::NAN, &[None; 4]);
            let speeds = [v * 3e-3f64.exp(), v, v * (-1e-3f64).exp(), v * (-1e-3f64).exp()];
            let in_rad_s = false;
            let signals = WheelSignals { speeds, in_rad_s, yaw_rate_rad_s: 0.01, accel_x_m_s2: f64::NAN };
            overview.push_wheels(time_s, &signals);
        }
        let found = overview.finish().unwrap();
        let wheels = found.wheels.as_ref().unwrap();
        for (ratio, expected) in wheels.ratios_1e3.iter().zip([3.0, 0.0, 2.5]) {
            let ratio = ratio.as_ref().unwrap();
            assert!((ratio.mean - expected).abs() < 1e-9 && ratio.samples == 2500, "{ratio:?}");
        }
        assert!(wheels.accel_x_m_s2.is_none() && wheels.yaw_rate_rad_s.is_some());
        // Speeds of the wheels are speeds.
        assert_eq!(found.doubts(), Vec::<String>::new());
        let page = found.page("bus.log");
        for part in ["<h2>Wheel speeds</h2>", "fl, wheel speed", "front left over right +3.0 ‰", "Yaw rate"]
        {
            assert!(page.contains(part), "{part}");
        }
    }
}
