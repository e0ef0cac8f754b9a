//! The air around the car: what the library gives is the core's, whether a tire lacks air, what is refused.

use itpms_capi::*;
use itpms_core::model::{Air, CarConfig, CarSample, CornerConfig, CornerSample, standard_atmosphere_kpa};
use itpms_core::monitor::{MonitorConfig, MonitoredCar};
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;

/// A car in memory that is aligned for it.
struct Made {
    _memory: Vec<f64>,
    car: *mut itpms_car,
}

fn made(config: &itpms_config) -> Result<Made, itpms_status> {
    let mut memory = vec![0.0f64; itpms_car_size().div_ceil(8)];
    let mut car = std::ptr::null_mut();
    // SAFETY: all of it is there for as long as the call lasts, the memory as long as the car.
    let status = unsafe {
        itpms_car_init(memory.as_mut_ptr().cast(), 8 * memory.len(), config, &mut car, std::ptr::null_mut())
    };
    if status == itpms_status::Ok { Ok(Made { _memory: memory, car }) } else { Err(status) }
}

/// The paper's corner at four wheels.
fn config() -> itpms_config {
    let mut config = std::mem::MaybeUninit::<itpms_config>::uninit();
    // SAFETY: the configuration is written whole.
    let mut config = unsafe {
        assert_eq!(itpms_config_init(config.as_mut_ptr(), size_of::<itpms_config>()), itpms_status::Ok);
        config.assume_init()
    };
    let of = CornerConfig::<itpms_real>::paper();
    config.sample_rate_hz = 500.0;
    config.wheelbase_m = 2.7;
    config.confidence = itpms_confidence::Measured as u32;
    for corner in &mut config.corners {
        corner.is_measured = 1;
        corner.sprung_mass_kg = of.quarter_car.sprung_mass_kg();
        corner.unsprung_mass_kg = of.quarter_car.unsprung_mass_kg();
        corner.damping_n_s_per_m = of.quarter_car.damping_n_s_per_m();
        corner.spring_n_per_m = of.quarter_car.spring_n_per_m();
        corner.stiffness_per_kpa = of.tire.stiffness_per_kpa();
        corner.stiffness_at_zero = of.tire.stiffness_at_zero();
        corner.placard_kpa = of.placard_kpa;
    }
    config
}

fn samples() -> Vec<CarSample<itpms_real>> {
    let scenario = Scenario { duration_s: 12.0, ..Scenario::builtin("drive-puncture").unwrap() };
    let narrowed = |sample: CarSample<f64>| CarSample {
        time_s: sample.time_s,
        speed_m_s: sample.speed_m_s as itpms_real,
        corners: sample.corners.map(|corner| {
            corner.map(|corner| CornerSample {
                body_accel_m_s2: corner.body_accel_m_s2 as itpms_real,
                wheel_accel_m_s2: corner.wheel_accel_m_s2 as itpms_real,
            })
        }),
        wheel_speeds: None,
    };
    Simulation::new(&scenario, 3).unwrap().map(|row| narrowed(row.car_sample())).collect()
}

fn cold(made: &Made) -> itpms_cold_report {
    let mut report = std::mem::MaybeUninit::<itpms_cold_report>::uninit();
    // SAFETY: the report is written whole.
    unsafe {
        assert_eq!(itpms_car_cold(made.car, report.as_mut_ptr()), itpms_status::Ok);
        report.assume_init()
    }
}

#[test]
fn cold_pressures_are_the_cores_and_say_what_is_to_be_added() {
    let stated = itpms_config { home_altitude_m: 400.0, ..config() };
    let made = made(&stated).ok().unwrap();
    let corner = CornerConfig::<itpms_real>::paper();
    let of_core = CarConfig { corners: [Some(corner); 4], wheelbase_m: Some(2.7) };
    let mut core = Box::new(MonitoredCar::unconfigured());
    let of_core = MonitorConfig { home_kpa: standard_atmosphere_kpa(400.0), ..MonitorConfig::new(&of_core) };
    core.configure(&of_core, 500.0).unwrap();
    let air = itpms_air { ambient_temperature_c: -25.0, barometric_kpa: itpms_real::NAN, altitude_m: 1400.0 };
    let nothing = cold(&made);
    assert!(nothing.ambient_temperature_c.is_nan() && nothing.wheels[0].state == 0);
    let mut estimate = None;
    for (k, sample) in samples().iter().enumerate() {
        if k == 3000 {
            // SAFETY: the car and the air are there.
            assert_eq!(unsafe { itpms_car_update_air(made.car, &air) }, itpms_status::Ok);
            core.follow_air(&Air {
                ambient_temperature_c: -25.0,
                barometric_kpa: itpms_real::NAN,
                altitude_m: 1400.0,
            });
        }
        let given = itpms_sample {
            time_s: sample.time_s,
            speed_m_s: sample.speed_m_s,
            body_accel_m_s2: sample.corners.map(|corner| corner.unwrap().body_accel_m_s2),
            wheel_accel_m_s2: sample.corners.map(|corner| corner.unwrap().wheel_accel_m_s2),
        };
        // SAFETY: the car and the sample are there.
        assert_eq!(unsafe { itpms_car_update(made.car, &given, std::ptr::null_mut()) }, itpms_status::Ok);
        estimate = Some(core.update(sample));
    }
    let found = cold(&made);
    assert_eq!(found.ambient_temperature_c, -25.0);
    let corners = estimate.unwrap().corners;
    for (wheel, corner) in found.wheels.iter().zip(corners.iter().flatten()) {
        assert!(corner.validity.is_valid());
        let expected = corner.cold.unwrap();
        assert_eq!(wheel.pressure_kpa.to_bits(), expected.pressure_kpa.to_bits());
        assert_eq!(wheel.pressure_sd_kpa.to_bits(), expected.sd_kpa.to_bits());
        // The tires have their 241.3 kPa on a pass, 1000 m above where they are filled: some 11 kPa too little there.
        assert!((corner.pressure_kpa - wheel.pressure_kpa - 11.0).abs() < 3.0, "{wheel:?}");
        let short = 241.3 - wheel.pressure_kpa;
        let lacks = short > wheel.pressure_sd_kpa.max(5.0);
        assert_eq!(wheel.state, if lacks { itpms_cold_state::Add } else { itpms_cold_state::Fine } as u32);
        assert!(
            if lacks { (wheel.add_kpa - short).abs() < 1e-3 } else { wheel.add_kpa.is_nan() },
            "{wheel:?}"
        );
    }
}

#[test]
fn what_cannot_be_is_refused_or_missing() {
    for home_altitude_m in [-600.0, 7000.0, itpms_real::INFINITY] {
        let refused = made(&itpms_config { home_altitude_m, ..config() });
        assert_eq!(refused.err(), Some(itpms_status::BadParameter), "{home_altitude_m}");
    }
    let made = made(&config()).ok().unwrap();
    // SAFETY: null is refused before it is read.
    unsafe {
        assert_eq!(itpms_car_update_air(made.car, std::ptr::null()), itpms_status::NullPointer);
        assert_eq!(itpms_car_cold(made.car, std::ptr::null_mut()), itpms_status::NullPointer);
        assert_eq!(itpms_car_cold(std::ptr::null_mut(), std::ptr::null_mut()), itpms_status::NullPointer);
    }
    // 85 C is a sensor that is not there.
    let air = itpms_air { ambient_temperature_c: 85.0, barometric_kpa: 1013.0, altitude_m: itpms_real::NAN };
    // SAFETY: the car and the air are there.
    assert_eq!(unsafe { itpms_car_update_air(made.car, &air) }, itpms_status::Ok);
    assert!(cold(&made).ambient_temperature_c.is_nan());
}
