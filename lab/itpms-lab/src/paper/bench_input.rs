//! Fig. 11: what the test bed does to the wheel.
//!
//! Called by [`super::reproduce`].

use itpms_sim::simulation::Simulation;

use super::case::Case;
use super::data::Data;
use super::plan::RESET_LONG_S;
use super::road_input::every;
use super::section::Section;
use super::{CORNER, Request};
use crate::runner::Result;
use itpms_analysis::plot::{Axis, Figure, Ink, Panel, Stroke};

/// Time after which the segment starts again, s.
const PERIOD_S: f64 = 0.66;
const PERIODS: f64 = 3.0;

pub(super) fn section(request: &Request) -> Result<Section> {
    let case = Case::bench("bench-drop", RESET_LONG_S, request)?;
    let (mut road, mut pressure, mut reading) = (vec![], vec![], vec![]);
    for row in Simulation::new(&case.scenario, request.first_seed)? {
        if let Some(corner) = row.corners[CORNER.index()] {
            pressure.push((row.time_s, corner.pressure_kpa));
            reading.push((row.time_s, corner.pressure_reading_kpa));
            if row.time_s <= PERIODS * PERIOD_S {
                road.push((row.time_s, 1e3 * corner.road_m));
            }
        }
    }
    let nth = (request.bench_rate_hz / 20.0).max(1.0) as usize;
    let time = Axis::linear("Time", "s").within(0.0, case.scenario.duration_s);
    let mut segment = Panel::new(
        "c",
        "Road played by the actuator",
        Axis::linear("Time", "s").within(0.0, PERIODS * PERIOD_S),
        Axis::linear("Height", "mm"),
    )
    .line("truth", Ink::Truth, Stroke::Solid, road.clone());
    for i in 1..PERIODS as u32 {
        let word = if i == 1 { "starts again" } else { "" };
        segment = segment.moment(Ink::Muted, PERIOD_S * f64::from(i), word);
    }
    let figure = Figure::new("figure-11", "Figure 11: The test bed")
        .describe(
            "Pressure falls from 224 to 142 kPa between 38 and 43 s; a road segment repeats every 0.66 s.",
        )
        .panel(
            Panel::new("b", "Tire pressure", time, Axis::linear("Pressure", "kPa").within(120.0, 240.0))
                .line("pressure sensor", Ink::Extra, Stroke::Bold, every(&reading, nth))
                .line("truth", Ink::Truth, Stroke::Solid, every(&pressure, nth)),
        )
        .panel(segment);
    let data = vec![
        Data::new("figure-11", "Pressure on the test bed")
            .curve("time_s", "pressure_kpa", &every(&pressure, nth))
            .numbers("pressure_sensor_kpa", every(&reading, nth).into_iter().map(|point| point.1)),
        Data::new("figure-11-road", "Road played by the actuator; first seed")
            .curve("time_s", "road_mm", &road),
    ];
    let text = "<p>We have no test bed. What follows is a digital twin of the one in the paper's Sec. 5: its spring (20 663 N/m) and damper \
                (435.2 N s/m), its sprung mass, its road segment that repeats every 0.66 s, an actuator of finite bandwidth, and the noise that Table 5 \
                states. What the paper does not say is assumed and listed <a href=\"#assumed\">below</a>; the paper's errors were measured on real \
                hardware, ours were not.</p>\
                <p>A repeated road is worth much: the wheel meets its own past every 0.66 s, and what changes from one pass to the next is the tire. The \
                default estimator looks for a repetition in the accelerations; the period is not given to it.</p>";
    Ok(Section::new("bench", "Test bed, input: Figure 11").text(text).figure(
        figure,
        "(b) the pressure of the main experiment, and what the slow and coarse sensor of the test bed shows of it; (c) three passes of the road segment. Panel (a) of the paper is a photograph; a \
         diagram of the test bed is in the documentation.",
        data,
    ))
}
