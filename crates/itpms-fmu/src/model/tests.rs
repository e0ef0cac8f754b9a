use super::*;

fn reference(model: &Model, name: &str) -> u32 {
    model.variables().iter().position(|variable| variable.name == name).unwrap() as u32
}

fn set(model: &mut Model, name: &str, value: f64) -> bool {
    model.set(reference(model, name), value)
}

fn get(model: &Model, name: &str) -> f64 {
    model.get(reference(model, name)).unwrap().1
}

fn initialized() -> Model {
    let mut model = Model::new(Vehicle::paper());
    model.enter(Phase::Initialized).unwrap();
    model
}

/// Two sines at every wheel, for so many steps.
fn drive(model: &mut Model, steps: std::ops::Range<u32>) {
    for k in steps {
        let time_s = f64::from(k) / 500.0;
        for corner in ["fl", "fr", "rl", "rr"] {
            set(model, &format!("{corner}_body_accel_m_s2"), 0.3 * (9.0 * time_s).sin());
            set(model, &format!("{corner}_wheel_accel_m_s2"), 4.0 * (70.0 * time_s).sin());
        }
        set(model, "speed_m_s", 20.0);
        model.step(time_s, 0.002).unwrap();
    }
}

#[test]
fn parameters_are_the_files_until_they_are_set_and_fixed_from_the_first_step_on() {
    let mut model = initialized();
    assert_eq!(get(&model, "rr_unsprung_mass_kg"), 56.9);
    assert!(set(&mut model, "rr_unsprung_mass_kg", f64::NAN));
    let error = model.step(0.0, 0.002).unwrap_err().to_string();
    assert!(error.starts_with("unsprung_mass_kg is NaN"), "{error}");
    model.reset();
    assert!(model.step(0.0, 0.002).unwrap_err().to_string().contains("before the initialization"));
    model.enter(Phase::Initialized).unwrap();
    for wheelbase_m in [-1.0, f64::NAN, 1e308, f64::INFINITY] {
        assert!(set(&mut model, "wheelbase_m", wheelbase_m));
        let error = model.step(0.0, 0.002).unwrap_err().to_string();
        assert!(error.starts_with("wheelbase_m is"), "{error}");
    }
    for step_s in [0.04, 0.011, 0.0004, 1.0] {
        let error = model.step(0.0, step_s).unwrap_err().to_string();
        assert!(error.contains("expected 0.0005 to 0.01 s") && error.contains("output_interval"), "{error}");
    }
    assert!(set(&mut model, "wheelbase_m", 2.6) && !set(&mut model, "fl_pressure_kpa", 200.0));
    drive(&mut model, 0..10);
    assert!(!set(&mut model, "wheelbase_m", 2.7) && set(&mut model, "speed_m_s", 21.0));
    assert_eq!(get(&model, "time"), 9.0 / 500.0 + 0.002);
    assert!(!model.set(10_000, 0.0) && model.get(10_000).is_none());
    for step_s in [0.0, -0.002, f64::NAN, f64::INFINITY] {
        assert!(model.step(1.0, step_s).is_err());
    }
    model.enter(Phase::Terminated).unwrap();
    assert!(model.step(1.0, 0.002).unwrap_err().to_string().contains("after the end"));
    assert!(model.enter(Phase::Initialized).is_err());
}

#[test]
fn with_the_temperature_of_the_air_there_are_cold_pressures() {
    let mut model = initialized();
    drive(&mut model, 0..3000);
    let names =
        ["cold_pressure_kpa", "cold_pressure_sd_kpa", "cold_add_kpa"].map(|name| format!("fl_{name}"));
    assert!(names.iter().all(|name| get(&model, name).is_nan()) && get(&model, "fl_cold_state") == 0.0);
    assert!(set(&mut model, "ambient_temperature_c", -10.0) && set(&mut model, "barometric_kpa", 101.325));
    drive(&mut model, 3000..3100);
    let [warm_kpa, cold_kpa, sd_kpa, add_kpa] =
        ["pressure_kpa", "cold_pressure_kpa", "cold_pressure_sd_kpa", "cold_add_kpa"]
            .map(|name| get(&model, &format!("fl_{name}")));
    // Six seconds have hardly warmed it: by less than 1 K, which is 1.3 kPa.
    assert!(cold_kpa <= warm_kpa && warm_kpa - cold_kpa < 1.5, "{warm_kpa} {cold_kpa}");
    assert!(sd_kpa >= get(&model, "fl_pressure_sd_kpa"));
    // Two sines are no road: it is not valid, and nothing is asked for.
    let valid = get(&model, "fl_is_valid") == 1.0;
    assert!((get(&model, "fl_cold_state") == 0.0) != valid);
    assert!(valid || add_kpa.is_nan());
}

#[test]
fn a_car_without_sensors_is_refused_and_wheel_speeds_need_their_keys() {
    let mut model = initialized();
    for corner in ["fl", "fr", "rl", "rr"] {
        assert!(set(&mut model, &format!("{corner}_is_measured"), 0.0));
    }
    assert!(model.step(0.0, 0.002).unwrap_err().to_string().contains("no corner is measured"));
    assert!(set(&mut model, "uses_wheel_speeds", 1.0));
    let error = model.step(0.0, 0.02).unwrap_err().to_string();
    assert!(error.contains("track_front_m"), "{error}");
}

#[test]
fn a_saved_state_goes_on_and_a_damaged_one_changes_nothing() {
    let mut model = initialized();
    drive(&mut model, 0..2000);
    let mut bytes = model.to_bytes().unwrap();
    let mut other = Model::new(Vehicle::paper());
    other.restore(&bytes).unwrap();
    drive(&mut model, 2000..2500);
    drive(&mut other, 2000..2500);
    assert!(get(&model, "fl_pressure_kpa").is_finite());
    for (a, b) in model.values.iter().zip(&other.values) {
        assert_eq!(a.to_bits(), b.to_bits());
    }
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    assert!(other.restore(&bytes).unwrap_err().to_string().contains("damaged"));
    assert!(other.restore(b"itpms").is_err());
    bytes[middle] ^= 1;
    let mut file = Vehicle::paper();
    file.name = "another".to_owned();
    assert!(Model::new(file).restore(&bytes).unwrap_err().to_string().contains("another vehicle file"));
}

/// A simulated drive, calibrated for its first half minute; against the same rows to what `itpms estimate` listens with.
#[test]
fn dampers_and_load_are_those_of_a_log_and_of_a_saved_state() {
    use itpms_analysis::beside::SuspensionWatch;
    use itpms_sim::scenario::Scenario;
    use itpms_sim::simulation::Simulation;

    let scenario = Scenario { duration_s: 73.0, ..Scenario::builtin("drive-puncture").unwrap() };
    let (mut model, mut other) = (initialized(), Model::new(Vehicle::paper()));
    assert!(set(&mut model, "calibrate_s", 32.0));
    let mut watch = SuspensionWatch::new(&Vehicle::paper(), &Corner::ALL, 0.002, None).unwrap();
    let mut expected = None;
    for (k, row) in Simulation::new(&scenario, 3).unwrap().enumerate() {
        let sample = row.car_sample();
        if k == 20_000 {
            other.restore(&model.to_bytes().unwrap()).unwrap();
        }
        for model in [&mut model, &mut other].into_iter().take(if k < 20_000 { 1 } else { 2 }) {
            for (corner, sample) in Corner::ALL.into_iter().zip(&sample.corners) {
                let (label, sample) = (corner.label(), sample.unwrap());
                set(model, &format!("{label}_body_accel_m_s2"), sample.body_accel_m_s2);
                set(model, &format!("{label}_wheel_accel_m_s2"), sample.wheel_accel_m_s2);
            }
            set(model, "speed_m_s", sample.speed_m_s);
            model.step(sample.time_s, 0.002).unwrap();
        }
        watch.take(&model.row(sample.time_s, &Corner::ALL));
        if k == 16_000 {
            watch.calibrate();
        } else if k == 36_000 {
            expected = Some(watch.conclude());
        }
    }
    for (a, b) in model.values.iter().zip(&other.values) {
        assert_eq!(a.to_bits(), b.to_bits());
    }
    let verdict = expected.unwrap();
    let over = verdict.dampers[2].over_reference.unwrap();
    assert_eq!(get(&model, "rl_damper_over_reference"), over.value);
    assert_eq!(get(&model, "rl_damper_over_reference_sd"), over.sd);
    assert_eq!(get(&model, "rl_damper_state"), 1.0);
    let masses = verdict.load.masses.unwrap();
    assert_eq!(get(&model, "rear_axle_kg"), masses.axles_kg[1].value);
    assert_eq!((get(&model, "total_sd_kg"), get(&model, "load_state")), (masses.total_kg.sd, 1.0));
    // Nothing was added.
    assert!(get(&model, "added_kg").abs() < 3.0 * get(&model, "added_sd_kg"));
}
