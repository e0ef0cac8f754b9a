//! The one table of variables: the description is made of it, and the functions of both versions read and write by it. A variable's value
//! reference is its place.

use itpms_core::model::Corner;
use itpms_data::Vehicle;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Causality {
    Independent,
    Parameter,
    /// Set before a step; NaN: the value is missing.
    Input,
    /// Read after a step.
    Output,
}

/// What kind of number it is. All values are kept as `f64`, which holds the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// `Real`, `Float64`.
    Real,
    /// `Integer`, `Int32`.
    Integer,
    /// `Boolean`.
    Boolean,
}

/// The quantity of a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    Time,
    Car(OfCar),
    Corner(Corner, OfCorner),
}

#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    pub name: String,
    pub role: Role,
    pub causality: Causality,
    pub kind: Kind,
    /// Its unit, one of [`UNITS`]; empty: none.
    pub unit: &'static str,
    pub text: &'static str,
    pub start: f64,
}

/// A unit by its name, by the exponents of kg, m, s, rad and K, with a factor and an offset.
pub const UNITS: [(&str, [i8; 5], f64, f64); 12] = [
    ("s", [0, 0, 1, 0, 0], 1.0, 0.0),
    ("m", [0, 1, 0, 0, 0], 1.0, 0.0),
    ("m/s", [0, 1, -1, 0, 0], 1.0, 0.0),
    ("m/s2", [0, 1, -2, 0, 0], 1.0, 0.0),
    ("rad/s", [0, 0, -1, 1, 0], 1.0, 0.0),
    ("kg", [1, 0, 0, 0, 0], 1.0, 0.0),
    ("kPa", [1, -1, -2, 0, 0], 1e3, 0.0),
    ("N/m", [1, 0, -2, 0, 0], 1.0, 0.0),
    ("N.s/m", [1, 0, -1, 0, 0], 1.0, 0.0),
    ("N/(m.kPa)", [0, 1, 0, 0, 0], 1e-3, 0.0),
    ("degC", [0, 0, 0, 0, 1], 1.0, 273.15),
    ("", [0; 5], 1.0, 0.0),
];

type Row<W> = (W, Causality, Kind, &'static str, &'static str, &'static str);

/// What there is, and a row of each: what it is for, its kind, name, unit and description.
macro_rules! table {
    ($(#[$doc:meta])* $of:ident $table:ident
     $($role:ident $causality:ident $kind:ident $name:literal $unit:literal $text:literal;)*) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum $of { $($role),* }

        const $table: &[Row<$of>] = &[$(($of::$role, Causality::$causality, Kind::$kind, $name, $unit, $text)),*];
    };
}

table! {
    OfCar CAR
    Wheelbase Parameter Real "wheelbase_m" "m" "Distance between the axles; 0: the road that front and rear share is not used.";
    CalibrateS Parameter Real "calibrate_s" "s" "So long from the first step on all tires have their placard pressures, and the car is learned; 0: no calibration.";
    UsesWheelSpeeds Parameter Boolean "uses_wheel_speeds" "" "Whether the wheel speeds are used.";
    Speed Input Real "speed_m_s" "m/s" "Speed of the car.";
    YawRate Input Real "yaw_rate_rad_s" "rad/s" "Yaw rate, positive to the left.";
    AccelX Input Real "accel_x_m_s2" "m/s2" "Acceleration forward.";
    AccelY Input Real "accel_y_m_s2" "m/s2" "Acceleration to the left.";
    Brake Input Real "brake" "" "1: the driver brakes, 0: not.";
    AmbientTemperature Input Real "ambient_temperature_c" "degC" "Temperature of the air: with it there are cold pressures, and warnings go by them.";
    Barometric Input Real "barometric_kpa" "kPa" "Absolute pressure of the air.";
    Altitude Input Real "altitude_m" "m" "Height above the sea, used where there is no barometer.";
    AnyLow Output Boolean "any_low" "" "A tire is warned of.";
    AnyMalfunction Output Boolean "any_malfunction" "" "A sensor is reported.";
    AllFine Output Boolean "all_fine" "" "Every wheel is known to be fine.";
    Alerts Output Integer "alerts" "" "Number of alerts that stand.";
    Calibrated Output Boolean "is_calibrated" "" "A calibration is over and has taught something.";
    FrontAxle Output Real "front_axle_kg" "kg" "What the front tires carry, wheels included, against a calibration before; NaN: not known.";
    FrontAxleSd Output Real "front_axle_sd_kg" "kg" "Its standard deviation.";
    RearAxle Output Real "rear_axle_kg" "kg" "What the rear tires carry.";
    RearAxleSd Output Real "rear_axle_sd_kg" "kg" "Its standard deviation.";
    Total Output Real "total_kg" "kg" "What all tires carry.";
    TotalSd Output Real "total_sd_kg" "kg" "Its standard deviation.";
    Added Output Real "added_kg" "kg" "More than in the calibration.";
    AddedSd Output Real "added_sd_kg" "kg" "Its standard deviation.";
    LoadState Output Integer "load_state" "" "0 unknown, 1 known, 2 overload, 3 learning.";
}

table! {
    OfCorner CORNER
    IsMeasured Parameter Boolean "is_measured" "" "Whether this corner's accelerations are there.";
    SprungMass Parameter Real "sprung_mass_kg" "kg" "Sprung mass.";
    UnsprungMass Parameter Real "unsprung_mass_kg" "kg" "Unsprung mass.";
    Damping Parameter Real "damping_n_s_per_m" "N.s/m" "Damping at the wheel.";
    Spring Parameter Real "spring_n_per_m" "N/m" "Spring rate at the wheel.";
    StiffnessPerKpa Parameter Real "stiffness_per_kpa" "N/(m.kPa)" "Tire stiffness over pressure.";
    StiffnessAtZero Parameter Real "stiffness_at_zero" "N/m" "Tire stiffness at no gauge pressure.";
    Placard Parameter Real "placard_kpa" "kPa" "Gauge pressure on the placard.";
    BodyAccel Input Real "body_accel_m_s2" "m/s2" "Vertical acceleration of the body over the wheel, positive upward.";
    WheelAccel Input Real "wheel_accel_m_s2" "m/s2" "Vertical acceleration of the wheel, positive upward.";
    WheelSpeed Input Real "wheel_speed_m_s" "m/s" "Speed of the wheel, by the radius that the car assumes.";
    Pressure Output Real "pressure_kpa" "kPa" "Gauge pressure.";
    PressureSd Output Real "pressure_sd_kpa" "kPa" "Its standard deviation.";
    Lost Output Real "lost_kpa" "kPa" "What the tire has lost in this drive; NaN as long as that is not counted, and where it was low before that.";
    LostSd Output Real "lost_sd_kpa" "kPa" "Its standard deviation.";
    ColdPressure Output Real "cold_pressure_kpa" "kPa" "Gauge pressure that the tire would have at the temperature of the air, where tires are filled; NaN: that temperature is not known.";
    ColdPressureSd Output Real "cold_pressure_sd_kpa" "kPa" "Its standard deviation.";
    ColdAdd Output Real "cold_add_kpa" "kPa" "What is to be added, cold, up to the placard's pressure; NaN: nothing.";
    ColdState Output Integer "cold_state" "" "0 unknown, 1 fine, 2 add.";
    LostShare Output Real "lost_share" "" "By wheel speeds: share of its pressure that the tire has lost since the calibration, against the others; NaN: not compared.";
    LostShareSd Output Real "lost_share_sd" "" "Its standard deviation.";
    DetectableLoss Output Real "detectable_loss" "" "By wheel speeds: the smallest loss of this tire alone that would have shown, as a share of its pressure.";
    Stiffness Output Real "stiffness_n_per_m" "N/m" "Tire stiffness.";
    Road Output Real "road_m" "m" "Height of the road under the wheel, without drift.";
    RoadSd Output Real "road_sd_m" "m" "Its standard deviation.";
    Valid Output Boolean "is_valid" "" "Whether the pressure may be shown.";
    Damper Output Real "damper_n_s_per_m" "N.s/m" "Damping at 0.1 m/s (rms), without friction; NaN: not known, as those that follow.";
    DamperSd Output Real "damper_sd_n_s_per_m" "N.s/m" "Its standard deviation.";
    OverReference Output Real "damper_over_reference" "" "That over the calibration's: 1 is as it was.";
    OverReferenceSd Output Real "damper_over_reference_sd" "" "Its standard deviation.";
    LeftRight Output Real "damper_left_right" "" "Left over right of its axle, less one.";
    LeftRightSd Output Real "damper_left_right_sd" "" "Its standard deviation.";
    FrontRear Output Real "damper_front_rear" "" "Front over rear, less one, over the calibration's.";
    FrontRearSd Output Real "damper_front_rear_sd" "" "Its standard deviation.";
    DampingRatio Output Real "wheel_damping_ratio" "" "Damping ratio of the wheel between tire and spring.";
    DampingRatioSd Output Real "wheel_damping_ratio_sd" "" "Its standard deviation.";
    DamperState Output Integer "damper_state" "" "0 unknown, 1 fine, 2 weak, 3 worn, 4 stiff, 5 learning.";
    State Output Integer "state" "" "0 unknown, 1 fine, 2 low, 3 over, 4 malfunction, 5 uncertain.";
    Warning Output Integer "warning" "" "0 none, 1 low, 2 malfunction.";
}

/// The variables of a vehicle: its corners' with the file's values as their start. Inputs and outputs are unknown until they are set.
pub fn variables(vehicle: &Vehicle) -> Vec<Variable> {
    let mut all = vec![Variable {
        name: "time".to_owned(),
        role: Role::Time,
        causality: Causality::Independent,
        kind: Kind::Real,
        unit: "s",
        text: "Simulation time.",
        start: f64::NAN,
    }];
    all.extend(CAR.iter().map(|&(of, causality, kind, name, unit, text)| {
        let start = match (causality, of) {
            (_, OfCar::Wheelbase) => vehicle.wheelbase_m.unwrap_or(0.0),
            (Causality::Parameter, _) => 0.0,
            _ => unknown(kind),
        };
        Variable { name: name.to_owned(), role: Role::Car(of), causality, kind, unit, text, start }
    }));
    for corner in Corner::ALL {
        all.extend(CORNER.iter().filter_map(|&(of, causality, kind, name, unit, text)| {
            let start = match causality {
                Causality::Parameter => parameter(vehicle, corner, of)?,
                _ => unknown(kind),
            };
            let name = format!("{}_{name}", corner.label());
            Some(Variable { name, role: Role::Corner(corner, of), causality, kind, unit, text, start })
        }));
    }
    all
}

fn unknown(kind: Kind) -> f64 {
    if kind == Kind::Real { f64::NAN } else { 0.0 }
}

/// The vehicle file's value of a parameter of a corner that it has.
pub fn parameter(vehicle: &Vehicle, corner: Corner, of: OfCorner) -> Option<f64> {
    let config = vehicle.corner(corner)?;
    let (car, tire) = (&config.quarter_car, &config.tire);
    Some(match of {
        OfCorner::IsMeasured => 1.0,
        OfCorner::SprungMass => car.sprung_mass_kg(),
        OfCorner::UnsprungMass => car.unsprung_mass_kg(),
        OfCorner::Damping => car.damping_n_s_per_m(),
        OfCorner::Spring => car.spring_n_per_m(),
        OfCorner::StiffnessPerKpa => tire.stiffness_per_kpa(),
        OfCorner::StiffnessAtZero => tire.stiffness_at_zero(),
        OfCorner::Placard => config.placard_kpa,
        _ => return None,
    })
}
