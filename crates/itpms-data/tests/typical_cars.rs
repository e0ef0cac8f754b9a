//! `vehicle init` against cars whose parameters are published: is what it writes within the deviation that it states?

use itpms_core::model::Corner;
use itpms_data::Vehicle;
use itpms_data::vehicle::typical::{CarClass, FrontRear, TypicalCar};
use itpms_data::vehicle::{Confidence, CornerFigures};

fn typical(mass_kg: f64, front_share: f64, tire: &str, class: CarClass, placard_kpa: f64) -> TypicalCar {
    let (tire, placard_kpa) = (tire.parse().unwrap(), FrontRear::both(placard_kpa));
    TypicalCar { name: None, mass_kg, front_share, tire, class, placard_kpa, wheelbase_m: None, wheels: None }
}

fn car(mass_kg: f64, front_share: f64, tire: &str, class: CarClass, placard_kpa: f64) -> Vehicle {
    typical(mass_kg, front_share, tire, class, placard_kpa).vehicle_file().unwrap().1
}

fn figures(vehicle: &Vehicle, corner: Corner) -> CornerFigures {
    let damping = vehicle.uncertainty(corner).tire_damping_n_s_per_m;
    CornerFigures::of(vehicle.corner(corner).unwrap(), damping)
}

/// Kerb mass, front share, tire and placard of cars on the road: makers' data sheets, rounded.
fn on_the_road() -> [(&'static str, Vehicle); 5] {
    [
        ("VW Golf VII 1.4", car(1_270.0, 0.60, "205/55R16", CarClass::Compact, 230.0)),
        ("Toyota Corolla XII", car(1_370.0, 0.60, "205/55R16", CarClass::Sedan, 240.0)),
        ("BMW 320i F30", car(1_505.0, 0.50, "225/50R17", CarClass::Sedan, 230.0)),
        ("Toyota RAV4 XA50", car(1_620.0, 0.58, "225/65R17", CarClass::Suv, 230.0)),
        ("VW Transporter T6", car(2_100.0, 0.55, "215/65R16C", CarClass::Van, 300.0)),
    ]
}

#[test]
fn cars_on_the_road_hop_and_sway_as_cars_do() {
    for (name, vehicle) in on_the_road() {
        assert_eq!(vehicle.details.confidence, Confidence::Typical);
        for corner in Corner::ALL {
            let f = figures(&vehicle, corner);
            // Wheels hop at 10 to 15 Hz, bodies at 1 to 1.8 Hz damped 0.2 to 0.4 (Gillespie, Fundamentals of Vehicle Dynamics, ch. 5;
            // Mitschke and Wallentowitz, Dynamik der Kraftfahrzeuge); car tires have 180 to 280 kN/m, a van's at 3 bar more.
            assert!((10.0..15.0).contains(&f.hop_hz), "{name} {corner:?}: hop at {} Hz", f.hop_hz);
            assert!((1.0..1.8).contains(&f.body_hz), "{name} {corner:?}: body at {} Hz", f.body_hz);
            assert!((0.2..0.4).contains(&f.body_damping_ratio), "{name}: {}", f.body_damping_ratio);
            let stiffest = if name.contains("Transporter") { 310e3 } else { 280e3 };
            assert!((180e3..stiffest).contains(&f.tire_n_per_m), "{name}: {} N/m", f.tire_n_per_m);
        }
        // The corners carry the whole car.
        let weight = |c: Corner| {
            let q = vehicle.corner(c).unwrap().quarter_car;
            q.sprung_mass_kg() + q.unsprung_mass_kg()
        };
        let mass: f64 = Corner::ALL.into_iter().map(weight).sum();
        assert!(
            [1_270.0, 1_370.0, 1_505.0, 1_620.0, 2_100.0].iter().any(|m| (mass - m).abs() < 0.5),
            "{name}: {mass}"
        );
    }
}

/// A published car: mass in kg, share on the front axle, tire, placard, and per corner front and rear unsprung mass (kg),
/// spring (N/m), damping (N s/m), and tire stiffness (N/m).
struct Published {
    name: &'static str,
    stated: Vehicle,
    unsprung_kg: f64,
    spring_n_per_m: [f64; 2],
    damping_n_s_per_m: [f64; 2],
    tire_n_per_m: f64,
}

/// Allen et al., Vehicle dynamic stability and rollover, NHTSA DOT HS 807 956 (1992), as in Althoff and Würsching, CommonRoad
/// vehicle models (2020), parameters_vehicle1 to 3: lb s²/ft, lb/ft and lb s/ft turned into SI units. The tires are
/// those of the models' data sheets; the report leaves size and pressure out.
fn published() -> [Published; 3] {
    const SLUG: f64 = 14.593_903;
    const LB_PER_FT: f64 = 14.593_903;
    [
        Published {
            name: "Ford Escort",
            stated: car(84.0 * SLUG, 4.95 / 7.85, "175/70R13", CarClass::Compact, 210.0),
            unsprung_kg: 0.5 * 4.5 * SLUG,
            spring_n_per_m: [1_500.0 * LB_PER_FT; 2],
            damping_n_s_per_m: [100.0 * LB_PER_FT; 2],
            tire_n_per_m: 13_000.0 * LB_PER_FT,
        },
        Published {
            name: "BMW 320i",
            stated: car(74.914_52 * SLUG, 4.667_707 / 8.461, "185/70R13", CarClass::Sedan, 200.0),
            unsprung_kg: 0.5 * 4.371_153 * SLUG,
            spring_n_per_m: [1_675.0 * LB_PER_FT, 1_345.0 * LB_PER_FT],
            damping_n_s_per_m: [122.396_6 * LB_PER_FT, 112.998_1 * LB_PER_FT],
            tire_n_per_m: 10_842.89 * LB_PER_FT,
        },
        Published {
            name: "VW Vanagon",
            stated: car(101.336_7 * SLUG, 4.334_437 / 8.11, "185/80R14", CarClass::Van, 250.0),
            unsprung_kg: 0.5 * 5.560_15 * SLUG,
            spring_n_per_m: [2_300.0 * LB_PER_FT, 2_680.0 * LB_PER_FT],
            damping_n_s_per_m: [164.833_5 * LB_PER_FT, 189.786_6 * LB_PER_FT],
            tire_n_per_m: 14_565.6 * LB_PER_FT,
        },
    ]
}

#[test]
fn published_cars_are_within_two_of_the_stated_deviations() {
    for car in published() {
        for (i, corner) in [Corner::FrontLeft, Corner::RearLeft].into_iter().enumerate() {
            let config = car.stated.corner(corner).unwrap();
            let sd = car.stated.uncertainty(corner);
            let quarter = config.quarter_car;
            let tire = config.tire.stiffness_n_per_m(config.placard_kpa);
            for (what, ours, published, sd) in [
                ("unsprung mass", quarter.unsprung_mass_kg(), car.unsprung_kg, sd.unsprung_mass_relative_sd),
                ("spring", quarter.spring_n_per_m(), car.spring_n_per_m[i], sd.spring_relative_sd),
                ("damping", quarter.damping_n_s_per_m(), car.damping_n_s_per_m[i], sd.damping_relative_sd),
                ("tire", tire, car.tire_n_per_m, sd.stiffness_relative_sd),
            ] {
                let off = (ours / published - 1.0) / sd;
                assert!(
                    off.abs() < 2.0,
                    "{} {corner:?} {what}: {ours:.0} for {published:.0}, {off:.1} sd",
                    car.name
                );
            }
        }
    }
}

#[test]
fn values_that_make_no_car_are_refused_in_one_sentence() {
    let refused = |mass_kg: f64, front_share: f64, placard_kpa: f64| {
        let car = typical(mass_kg, front_share, "205/55R16", CarClass::Sedan, placard_kpa);
        car.vehicle_file().unwrap_err().to_string()
    };
    for (found, message) in [
        (refused(1.5, 0.5, 240.0), "the mass is 1.5 kg, expected 300 to 20000 kg"),
        (refused(f64::NAN, 0.5, 240.0), "the mass is NaN kg, expected 300 to 20000 kg"),
        (refused(1_500.0, 55.0, 240.0), "the front share is 55, expected 0.3 to 0.75"),
        (
            refused(1_500.0, 0.5, 2.4),
            "the placard pressure is 2.4 kPa, expected 100 to 900 kPa (another unit? 2.4 bar is 240 kPa)",
        ),
    ] {
        assert_eq!(found, message);
    }
}

#[test]
fn a_name_may_hold_anything_and_the_wheelbase_is_the_given_one() {
    let name = Some("my \"car\" \\ # 1".to_owned());
    let car = typical(1_500.0, 0.55, "205/55R16", CarClass::Sedan, 240.0);
    let car = TypicalCar { name, wheelbase_m: Some(2.651), ..car };
    let (text, vehicle) = car.vehicle_file().unwrap();
    assert_eq!(vehicle.name, "my \"car\" \\ # 1");
    assert_eq!(vehicle.wheelbase_m, Some(2.651));
    // Every value of a corner or tire has a comment or is the deviation of one that has.
    for line in text.lines().filter(|line| line.contains(" = ") && !line.starts_with("name")) {
        assert!(line.contains('#') || line.contains("_sd") || line.starts_with("confidence"), "{line}");
    }
}

#[test]
fn an_axle_may_have_a_tire_and_a_placard_of_its_own() {
    let tires = ["225/45R18", "255/40R18"];
    let mixed = TypicalCar {
        name: None,
        mass_kg: 1_600.0,
        front_share: 0.5,
        tire: tires.join(",").parse().unwrap(),
        class: CarClass::Sedan,
        placard_kpa: "230,260".parse().unwrap(),
        wheelbase_m: None,
        wheels: None,
    };
    let (text, mixed) = mixed.vehicle_file().unwrap();
    assert!(text.contains("name = \"sedan, 1600 kg, 225/45R18 front, 255/40R18 rear\""));
    // Each axle is that of the car that has its tire and its placard all around.
    for (axle, (tire, placard_kpa)) in tires.into_iter().zip([230.0, 260.0]).enumerate() {
        let alike = car(1_600.0, 0.5, tire, CarClass::Sedan, placard_kpa);
        for corner in &Corner::ALL[2 * axle..2 * axle + 2] {
            assert_eq!(mixed.corner(*corner), alike.corner(*corner), "{corner:?}");
            let tire_of = |vehicle: &Vehicle| vehicle.details.corners[corner.index()].tire;
            assert_eq!(tire_of(&mixed), tire_of(&alike), "{corner:?}");
        }
    }
}
