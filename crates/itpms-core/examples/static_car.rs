//! A car as a controller has it, in a `static`: `cargo run --release -p itpms-core --example static_car`.
//!
//! Its memory is zeros until it is configured, so it lies in `.bss` and costs no flash; `.ci/run stack` looks.

use std::sync::{Mutex, PoisonError};

use itpms_core::{
    CarConfig, CarSample, CornerConfig, CornerSample, MonitorConfig, MonitoredCar, ParameterError,
};

/// Whatever guards a static on the controller takes the place of the mutex.
static CAR: Mutex<MonitoredCar<f32>> = Mutex::new(MonitoredCar::unconfigured());

const RATE_HZ: f64 = 200.0;

fn main() -> Result<(), ParameterError> {
    let corner = CornerConfig::<f32>::paper();
    let config = CarConfig { corners: [Some(corner); 4], wheelbase_m: Some(2.7) };
    let mut car = CAR.lock().unwrap_or_else(PoisonError::into_inner);
    car.configure(&MonitorConfig::new(&config), RATE_HZ)?;
    for k in 0..400 {
        let time_s = f64::from(k) / RATE_HZ;
        let wheel_accel_m_s2 = 4.0 * (70.0 * time_s as f32).sin();
        let corner = CornerSample { body_accel_m_s2: 0.1 * wheel_accel_m_s2, wheel_accel_m_s2 };
        car.update(&CarSample { time_s, speed_m_s: 22.0, corners: [Some(corner); 4], wheel_speeds: None });
    }
    println!("{} bytes: {:?}", size_of_val(&*car), car.report().wheels[0].map(|wheel| wheel.state));
    Ok(())
}
