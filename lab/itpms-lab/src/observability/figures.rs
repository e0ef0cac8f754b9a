//! The result as figures.
//!
//! Called by the page and by the binary. A source has the same color in all of them.

use super::{Car, Observability, SWEEP_S, Situation, Twin, Varied};
use itpms_analysis::plot::{Axis, Figure, Ink, Panel, Stroke};

type Line = (&'static str, Ink, Stroke);

/// Curves over time; the others are in the tables.
const OVER_TIME: [Line; 8] = [
    ("a", Ink::Default, Stroke::Solid),
    ("b", Ink::Adaptive, Stroke::Solid),
    ("b'", Ink::Adaptive, Stroke::Dashed),
    ("c", Ink::Plain, Stroke::Solid),
    ("d", Ink::Mended, Stroke::Solid),
    ("a+d", Ink::Mended, Stroke::Dashed),
    ("a+b+c+d", Ink::Truth, Stroke::Bold),
    ("road known", Ink::Muted, Stroke::Dotted),
];

/// Drawn over time alone: after a loss a reset knows nothing.
const OVER_TIME_ALONE: [&str; 2] = ["d", "a+d"];

/// Part of the drive that is shown from near, in s: after the loss.
const NEAR_S: (f64, f64) = (7.0, 7.6);

impl Observability {
    /// All figures: the twins, the bounds over time, the bounds over circumstances.
    pub fn figures(&self) -> Vec<Figure> {
        vec![self.twin_figure(), self.time_figure(), self.sweep_figure()]
    }

    fn twin_figure(&self) -> Figure {
        let inks = [
            (Ink::Truth, Stroke::Bold),
            (Ink::Adaptive, Stroke::Solid),
            (Ink::Plain, Stroke::Dashed),
            (Ink::Default, Stroke::Dotted),
        ];
        let whole = |_: f64| true;
        let near = |t: f64| t >= NEAR_S.0 && t <= NEAR_S.1;
        let panel = |letter: &str,
                     title: &str,
                     unit: &str,
                     seen: &dyn Fn(f64) -> bool,
                     quantity: &dyn Fn(&Twin) -> Vec<f64>| {
            let empty = Panel::new(letter, title, Axis::linear("Time", "s"), Axis::linear("", unit));
            self.twins.drives.iter().zip(inks).fold(empty, |panel, (twin, (ink, stroke))| {
                let points = self.twins.time_s.iter().copied().zip(quantity(twin)).filter(|(t, _)| seen(*t));
                panel.line(twin.label.clone(), ink, stroke, points.collect())
            })
        };
        let roads = |twin: &Twin| twin.road_m.iter().map(|r| 1e3 * r).collect();
        Figure::new("observability-twins", "Four tires, four roads, one measurement")
            .describe("Pressures and roads differ; the wheel's acceleration is the same line four times.")
            .columns(3)
            .panel(panel("a", "Tire pressure", "kPa", &whole, &|twin| twin.pressure_kpa.clone()))
            .panel(panel("b", "Road height", "mm", &near, &roads))
            .panel(panel("c", "Wheel acceleration", "m/s²", &near, &|twin| twin.wheel_accel_m_s2.clone()))
    }

    fn time_figure(&self) -> Figure {
        let mut figure = Figure::new("observability-time", "What each source of information allows to know")
            .describe(
                "Least standard deviation of the pressure over time, for each source alone and together.",
            );
        let panels = Car::ALL.into_iter().flat_map(|car| Situation::ALL.map(|situation| (car, situation)));
        for ((car, situation), letter) in panels.zip(["a", "b", "c", "d"]) {
            let known = match car {
                Car::Exact => "car known",
                Car::AsFiled => "car uncertain",
            };
            let (title, time) = match situation {
                Situation::Constant => ("Constant pressure", "Time since the start"),
                Situation::AfterLoss => ("After a loss", "Time since the loss"),
            };
            let y = Axis::logarithmic("Least sd", "kPa").within(lowest(car), 60.0);
            let panel = Panel::new(letter, format!("{title}, {known}"), Axis::logarithmic(time, "s"), y);
            let curve = |sources: &str| self.curve(sources, situation, car).map(|curve| &*curve.points);
            figure = figure.panel(with_lines(panel, &OVER_TIME, curve));
        }
        figure
    }

    /// Bounds over speed, damping and noise, both cars.
    fn sweep_figure(&self) -> Figure {
        let mut figure = Figure::new(
            "observability-sweeps",
            format!("{SWEEP_S:.0} s after a loss, over speed, damping, noise"),
        )
        .describe("Least standard deviation of the pressure over speed, damping, sensor noise and the road's incoherent share.");
        let panels = Varied::ALL.into_iter().flat_map(|varied| Car::ALL.map(|car| (car, varied)));
        for ((car, varied), letter) in panels.zip(["a", "b", "c", "d", "e", "f", "g", "h"]) {
            let known = match car {
                Car::Exact => "Car known",
                Car::AsFiled => "Car uncertain",
            };
            let x = match varied {
                Varied::SpeedKmH => Axis::linear("Speed", "km/h"),
                Varied::DampingNSPerM => Axis::logarithmic("Damping", "N s/m"),
                Varied::NoiseMS2 => Axis::logarithmic("Noise", "m/s²"),
                Varied::IncoherentShare => Axis::logarithmic("Share of the road not common", ""),
            };
            let y = Axis::logarithmic("Least sd", "kPa").within(lowest(car), 30.0);
            let sweep = |sources: &str| {
                let drawn = self.sweep(sources, varied, car).filter(|_| !OVER_TIME_ALONE.contains(&sources));
                drawn.map(|sweep| &*sweep.points)
            };
            figure = figure.panel(with_lines(Panel::new(letter, known, x, y), &OVER_TIME, sweep));
        }
        figure
    }
}

/// Where the axis begins, in kPa: an uncertain car hides all that is finer than a kilopascal.
fn lowest(car: Car) -> f64 {
    match car {
        Car::Exact => 0.01,
        Car::AsFiled => 1.0,
    }
}

/// Adds what has points; of these the finite ones, without any there is no line.
fn with_lines<'a>(panel: Panel, lines: &[Line], points: impl Fn(&str) -> Option<&'a [(f64, f64)]>) -> Panel {
    lines.iter().fold(panel, |panel, &(sources, ink, stroke)| match points(sources) {
        Some(points) => {
            let finite = points.iter().copied().filter(|(_, sd)| sd.is_finite()).collect();
            panel.line(sources, ink, stroke, finite)
        }
        None => panel,
    })
}
