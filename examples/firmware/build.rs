//! Simulates the drives that `car` and `wheels` are fed with, as a logger would store them: 16 bits a value. Lets the linker find `memory.x`.

use std::error::Error;
use std::ops::Range;
use std::path::Path;
use std::{env, fs};

use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;

/// `drive-puncture`: front left goes down from 20 s on.
const DRIVE_S: f64 = 30.0;
/// When the wire of the front right wheel's sensor is off.
const LOST_S: Range<f64> = 10.0..14.0;
/// Bits per unit of accelerations in m/s², and of the speed in m/s.
const PER_M_S2: f64 = 128.0;
const PER_M_S: f64 = 256.0;
/// The same of a bus with wheel speeds: steps of .03 km/h, of the yaw rate in 1/rad/s, of accelerations.
const BUS: [f64; 3] = [120.0, 1e3 / 1.745, 100.0];
/// What stands for a missing value.
const MISSING: i16 = i16::MIN;

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rustc-link-search={}", env::var("CARGO_MANIFEST_DIR")?);
    println!("cargo::rerun-if-changed=memory.x");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=wheels.toml");
    wheels()?;
    let scenario = Scenario { duration_s: DRIVE_S, ..Scenario::builtin("drive-puncture")? };
    let mut bytes = Vec::new();
    let mut samples = 0;
    for row in Simulation::new(&scenario, 1)? {
        let sample = row.car_sample();
        let mut put = |value: f64, per_unit: f64| {
            let value = match value.is_nan() {
                true => MISSING,
                false => (value * per_unit).round().clamp(-32_767.0, 32_767.0) as i16,
            };
            bytes.extend(value.to_le_bytes());
        };
        put(sample.speed_m_s, PER_M_S);
        for (i, corner) in sample.corners.iter().enumerate() {
            let corner = corner.ok_or("the drive has four wheels")?;
            let lost = i == 1 && LOST_S.contains(&sample.time_s);
            put(corner.body_accel_m_s2, PER_M_S2);
            put(if lost { f64::NAN } else { corner.wheel_accel_m_s2 }, PER_M_S2);
        }
        samples += 1;
    }
    let out = env::var("OUT_DIR")?;
    fs::write(Path::new(&out).join("drive.bin"), &bytes)?;
    let constants = format!(
        "/// Samples a second, and how many there are.\npub const RATE_HZ: f64 = {:?};\npub const SAMPLES: usize = {samples};\nconst PER_M_S2: f32 = {PER_M_S2:?};\n\
         const PER_M_S: f32 = {PER_M_S:?};\nconst MISSING: i16 = {MISSING};\n\
         /// The samples.\n         pub static DRIVE: [u8; {}] = *include_bytes!(\"drive.bin\");\n",
        scenario.rate_hz,
        bytes.len()
    );
    fs::write(Path::new(&out).join("drive.rs"), constants)?;
    Ok(())
}

/// A bus with wheel speeds, as its messages have them.
fn wheels() -> Result<(), Box<dyn Error>> {
    let scenario = Scenario::from_file(Path::new("wheels.toml"))?;
    let mut bytes = Vec::new();
    let mut messages = 0;
    for row in Simulation::new(&scenario, 2)? {
        let bus = row.wheel_speeds.ok_or("the drive has wheel speeds")?;
        let [speed, yaw, accel] = BUS;
        let values = bus.wheel_speed_m_s.map(|value| value * speed).into_iter().chain([
            bus.yaw_rate_rad_s * yaw,
            bus.accel_x_m_s2 * accel,
            bus.accel_y_m_s2 * accel,
            bus.brake,
        ]);
        bytes.extend(values.flat_map(|value| (value.round() as i16).to_le_bytes()));
        messages += 1;
    }
    let out = env::var("OUT_DIR")?;
    fs::write(Path::new(&out).join("wheels.bin"), &bytes)?;
    let [speed, yaw, accel] = BUS;
    let constants = format!(
        "/// Messages a second, and how many there are.\npub const RATE_HZ: f64 = {:?};\npub const MESSAGES: usize = {messages};\nconst PER_M_S: f32 = {speed:?};\n\
         const PER_RAD_S: f32 = {yaw:?};\nconst PER_M_S2: f32 = {accel:?};\n\
         /// The messages.\n         pub static WHEELS: [u8; {}] = *include_bytes!(\"wheels.bin\");\n",
        scenario.rate_hz,
        bytes.len()
    );
    fs::write(Path::new(&out).join("wheels.rs"), constants)?;
    Ok(())
}
