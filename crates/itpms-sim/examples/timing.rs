//! How long drives take to simulate: the paper's scenario, an hour at 100 km/h with one and four wheels, and of a whole car.
//!
//! `cargo run --release -p itpms-sim --example timing`

use std::time::Instant;

use itpms_sim::error::ScenarioError;
use itpms_sim::scenario::{CornerSpec, Scenario};
use itpms_sim::simulation::Simulation;
use itpms_sim::time_profile::{Pressure, Speed};

fn main() -> Result<(), ScenarioError> {
    let scenario = Scenario::builtin("paper-drop")?;
    for seed in 0..4 {
        let start = Instant::now();
        let rows = Simulation::new(&scenario, seed)?.count();
        println!("paper-drop, seed {seed}: {rows} rows in {:.1} ms", 1e3 * start.elapsed().as_secs_f64());
    }
    let mut hour = Scenario { duration_s: 3600.0, speed: Speed::ConstantKmH(100.0), ..scenario };
    let start = Instant::now();
    let rows = Simulation::new(&hour, 1)?.count();
    println!("an hour, one corner: {rows} rows in {:.1} s", start.elapsed().as_secs_f64());
    hour.corner.fr = Some(CornerSpec::paper(Pressure::ConstantKpa(241.3)));
    hour.corner.rl = hour.corner.fr.clone();
    hour.corner.rr = hour.corner.fr.clone();
    let start = Instant::now();
    let rows = Simulation::new(&hour, 1)?.count();
    println!("an hour, four corners: {rows} rows in {:.1} s", start.elapsed().as_secs_f64());
    let normal = Scenario::builtin("drive-normal")?;
    let straight = Scenario { duration_s: 3600.0, rate_hz: 200.0, ..Scenario::builtin("drive-puncture")? };
    for scenario in [straight, normal] {
        let start = Instant::now();
        let rows = Simulation::new(&scenario, 1)?.count();
        println!("an hour of {}: {rows} rows in {:.1} s", scenario.name, start.elapsed().as_secs_f64());
    }
    Ok(())
}
