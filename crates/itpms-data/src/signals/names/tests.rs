use super::*;

fn column(group: &str, name: &str) -> Option<String> {
    meaning(group, name).map(|(slot, _)| slot.name())
}

#[test]
fn usual_names_are_understood() {
    for (group, name, expected) in [
        ("", "FL_BodyAccZ", "fl_body_accel_m_s2"),
        ("Chassis_FL", "BodyAccZ", "fl_body_accel_m_s2"),
        ("", "AccZ_Wheel_RR", "rr_wheel_accel_m_s2"),
        ("", "accz_whl_rr", "rr_wheel_accel_m_s2"),
        ("", "VertAccelHubRearLeft", "rl_wheel_accel_m_s2"),
        ("WheelAcceleration", "FrontRight_Z", "fr_wheel_accel_m_s2"),
        ("", "sprungAccelRL", "rl_body_accel_m_s2"),
        ("", "az_body_fl", "fl_body_accel_m_s2"),
        ("ESP_02", "VehicleSpeed", "speed_m_s"),
        ("ESP_Status", "VehicleSpeed", "speed_m_s"),
        ("", "ESP_Status::VehicleSpeed [km/h]", "speed_m_s"),
        ("", "Chassis::FL_BodyAccZ", "fl_body_accel_m_s2"),
        ("", "v_veh", "speed_m_s"),
        ("", "VehSpd", "speed_m_s"),
        ("ABS", "vehspd", "speed_m_s"),
        ("GPS", "Speed", "speed_m_s"),
        ("TPMS", "Pressure_FL", "fl_tpms_kpa"),
        ("", "TirePressFrontRight", "fr_tpms_kpa"),
        ("Reference_FL", "TirePressure_FL", "fl_pressure_kpa"),
        ("TPMS", "Temp_RR", "rr_tpms_c"),
        ("", "TireTemperatureRearLeft", "rl_tpms_c"),
        ("", "road_height_rl", "rl_road_m"),
        // Toyota, Honda; Volkswagen; Hyundai; Ford; General Motors; Subaru, as in public DBC files.
        ("WHEEL_SPEEDS", "WHEEL_SPEED_FL", "fl_wheel_speed_m_s"),
        ("ESP_19", "ESP_HR_Radgeschw_02", "rr_wheel_speed_m_s"),
        ("Bremse_3", "Radgeschw__VR_4_1", "fr_wheel_speed_m_s"),
        ("WHL_SPD11", "WHL_SPD_RL", "rl_wheel_speed_m_s"),
        ("WheelSpeed", "WhlRr_W_Meas", "rr_wheel_speed_m_s"),
        ("EBCMWheelSpdRear", "RLWheelSpd", "rl_wheel_speed_m_s"),
        ("Wheel_Speeds", "FR", "fr_wheel_speed_m_s"),
        ("WheelSpeeds", "Speed_FL", "fl_wheel_speed_m_s"),
        ("Yaw_Data_FD1", "VehYaw_W_Actl", "yaw_rate_rad_s"),
        ("KINEMATICS", "YAW_RATE", "yaw_rate_rad_s"),
        ("KINEMATICS", "ACCEL_Y", "accel_y_m_s2"),
        // MoTeC, AiM; comma's logs as tables.
        ("", "Gyro Yaw Velocity", "yaw_rate_rad_s"),
        ("", "InlineAcc", "accel_x_m_s2"),
        ("carState.wheelSpeeds", "fl", "fl_wheel_speed_m_s"),
        ("carState", "vEgo", "speed_m_s"),
        ("carState.wheelSpeeds", "rr", "rr_wheel_speed_m_s"),
        ("", "carState_wheelSpeeds_fl", "fl_wheel_speed_m_s"),
        ("", "carState_vEgo", "speed_m_s"),
        // The air around a car: J1939 (AMB), OBD, a telephone's GPS.
        ("AMB", "AmbientAirTemp", "ambient_temperature_c"),
        ("AMB", "BarometricPress", "barometric_kpa"),
        ("", "Ambient air temperature [°C]", "ambient_temperature_c"),
        ("Engine", "OutsideTemp", "ambient_temperature_c"),
        ("", "ABSOLUTE_BAROMETRIC_PRESSURE", "barometric_kpa"),
        ("", "BarometricPressure", "barometric_kpa"),
        ("", "AtmosphericPressure", "barometric_kpa"),
        ("", "Aussentemperatur", "ambient_temperature_c"),
        ("GPS", "Altitude", "altitude_m"),
        // German: vorne, hinten; links, rechts.
        ("", "Radgeschwindigkeit VL", "fl_wheel_speed_m_s"),
        ("", "Radgeschwindigkeit HR [km/h]", "rr_wheel_speed_m_s"),
        ("", "v_VL [km/h]", "fl_wheel_speed_m_s"),
        ("", "v_VR_kmh", "fr_wheel_speed_m_s"),
        ("", "v_HL", "rl_wheel_speed_m_s"),
        ("", "az_Rad_HR", "rr_wheel_accel_m_s2"),
        ("", "az_Aufbau_VR", "fr_body_accel_m_s2"),
        ("", "Gierrate", "yaw_rate_rad_s"),
        ("", "LongitudinalAcceleration", "accel_x_m_s2"),
        // SAE J1939: HRW, EBC2 as it is put together, CCVS.
        ("HRW", "FrontAxleLeftWheelSpeed", "fl_wheel_speed_m_s"),
        ("HRW", "RearAxleRightWheelSpeed", "rr_wheel_speed_m_s"),
        ("EBC2", "RelativeSpeedRearAxle1LeftWheel + FrontAxleSpeed", "rl_wheel_speed_m_s"),
        ("TIRE", "TirePressure rear right", "rr_tpms_kpa"),
        ("CCVS1", "WheelBasedVehicleSpeed", "speed_m_s"),
        ("", "FrontAxleLoad", "front_axle_kg"),
        ("VW", "AxleWeight rear", "rear_axle_kg"),
    ] {
        assert_eq!(column(group, name).unwrap_or_default(), expected, "{group}.{name}");
    }
}

#[test]
fn what_is_something_else_is_left_alone() {
    for (group, name) in [
        ("", "FL_BodyAccX"),
        ("", "LateralVelocity"),
        ("", "ACC_X_FL"),
        ("", "YawAngle"),
        ("", "Gyro_Z"),
        ("", "WheelSpeed"),
        ("WHL_SPD11", "WHL_SPD_AliveCounter_LSB"),
        ("WheelSpeeds", "FL_Status"),
        ("", "WheelAccel_Speed_FL"),
        ("Engine", "Speed"),
        ("", "VehicleSpeedLimit"),
        ("", "BodyAccZ"),
        // Of the body or of the wheel.
        ("", "az_VL"),
        // A damper's or a wheel's.
        ("", "v_VL [m/s]"),
        ("", "v_Aufbau_VL [km/h]"),
        ("", "vz_VL [km/h]"),
        ("", "v_VL_VR [km/h]"),
        ("", "FL_FR_BodyAccZ"),
        ("", "FL_WheelAccZ_Status"),
        ("", "BrakePressure_FL"),
        ("", "Pressure_FL"),
        ("", "Temp_FL"),
        ("Brakes", "BrakeTemp_FL"),
        ("AMB", "EngAirIntakeTemp"),
        ("AMB", "CabInteriorTemp"),
        ("AMB", "RoadSurfaceTemp"),
        ("", "AmbientAirTempStatus"),
        ("", "AirPressure"),
        ("EBC2", "FrontAxleSpeed"),
        ("EBC2", "RelativeSpeedFrontAxleLeftWheel"),
        ("EBC2", "RelativeSpeedRearAxle2LeftWheel + FrontAxleSpeed"),
        ("TIRE", "TireLocation"),
        ("VW", "AxleWeight"),
        ("", "LoadFrontLeft"),
        ("TIRE", "TirePressure"),
        ("", "counter"),
        ("", ""),
    ] {
        assert_eq!(column(group, name), None, "{group}.{name}");
    }
}

#[test]
fn unknown_words_make_it_less_sure() {
    assert_eq!(meaning("", "VehicleSpeed").unwrap().1, Fit::AllWords);
    assert_eq!(meaning("", "VehicleSpeedDisplay").unwrap().1, Fit::SomeWords);
    assert_eq!(meaning("", "FL_BodyAccZ").unwrap().1, Fit::AllWords);
    assert_eq!(meaning("", "FL_BodyAcc").unwrap().1, Fit::SomeWords);
}

#[test]
fn no_word_is_there_twice() {
    for (i, (word, _)) in WORDS.iter().enumerate() {
        assert!(WORDS[..i].iter().all(|(other, _)| other != word), "{word}");
    }
}
