//! Which signal becomes which column: by a map, by names, and what is reported where that is not clear.

use std::path::Path;

use itpms_core::model::Corner;
use itpms_data::log::{Field, Slot};
use itpms_data::signals::{Candidate, Lister, Resolved, SignalMap, Source, resolve};

const FL_BODY: Slot = Slot::Corner(Corner::FrontLeft, Field::BodyAccel);
const FL_WHEEL: Slot = Slot::Corner(Corner::FrontLeft, Field::WheelAccel);

fn candidates(list: &[(&str, &str, &str)]) -> Vec<Candidate> {
    let candidate = |(group, name, unit): &(&str, &str, &str)| Candidate {
        group: (*group).to_owned(),
        name: (*name).to_owned(),
        unit: (*unit).to_owned(),
    };
    list.iter().map(candidate).collect()
}

fn map(text: &str) -> Result<SignalMap, String> {
    SignalMap::parse(text, Path::new("map.toml")).map_err(|error| error.to_string())
}

fn by_map(list: &[(&str, &str, &str)], text: &str) -> Result<Resolved, String> {
    resolve(&candidates(list), Some(&map(text)?)).map_err(|error| error.to_string())
}

fn by_name(list: &[(&str, &str, &str)]) -> Resolved {
    resolve(&candidates(list), None).unwrap()
}

/// The full name of the signal that a column gets.
fn signal(resolved: &Resolved, slot: Slot) -> &str {
    resolved.get(slot).map_or("", |chosen| chosen.signal.as_str())
}

const CAR: [(&str, &str, &str); 5] = [
    ("ESP_02", "VehicleSpeed", "km/h"),
    ("Chassis_FL", "BodyAccZ", "g"),
    ("Hub_FL", "AccZ", "m/s²"),
    ("Chassis_FL", "Counter", ""),
    ("Misc", "Counter", ""),
];

#[test]
fn a_map_says_which_signal_and_how_to_convert_it() {
    let text = r#"
        [signals]
        speed_m_s = "ESP_02.VehicleSpeed"
        fl_body_accel_m_s2 = { signal = "BodyAccZ", unit = "m/s^2" }
        fl_wheel_accel_m_s2 = { signal = "Hub_FL.AccZ", factor = -1.0, offset = 9.81 }
    "#;
    let resolved = by_map(&CAR, text).unwrap();
    assert_eq!(resolved.slots(), [Slot::Speed, FL_BODY, FL_WHEEL]);
    // 36 km/h are 10 m/s.
    let speed = resolved.get(Slot::Speed).unwrap();
    assert!((speed.conversion.apply(36.0) - 10.0).abs() < 1e-12);
    // The map's unit, not the file's.
    assert_eq!(resolved.get(FL_BODY).unwrap().conversion.apply(2.0), 2.0);
    // Downwards and with gravity taken off: -x + 9.81.
    assert_eq!(resolved.get(FL_WHEEL).unwrap().conversion.apply(9.81), 0.0);
    assert!(resolved.iter().all(|chosen| chosen.source == Source::Map));
    assert_eq!(resolved.corners(), [Corner::FrontLeft]);
}

#[test]
fn without_a_map_the_units_of_the_file_count() {
    let resolved = by_name(&CAR);
    assert_eq!(signal(&resolved, Slot::Speed), "ESP_02.VehicleSpeed");
    assert_eq!(signal(&resolved, FL_BODY), "Chassis_FL.BodyAccZ");
    assert_eq!(resolved.get(FL_BODY).unwrap().conversion.apply(1.0), 9.80665);
    assert_eq!(signal(&resolved, FL_WHEEL), "Hub_FL.AccZ");
    assert!(resolved.remarks().is_empty() && resolved.unusable().is_none());
}

#[test]
fn a_columns_own_name_goes_before_what_its_words_say() {
    let list = [
        ("A", "FL_BodyAccZ", "m/s^2"),
        ("B", "fl_body_accel_m_s2", ""),
        ("C", "FL_BodyAccel_mS2", "m/s^2"),
        ("D", "FL_WheelAccel_M_S2", ""),
        ("E", "FL_WheelAccZ", "m/s^2"),
    ];
    let resolved = by_name(&list);
    assert_eq!(signal(&resolved, FL_BODY), "B.fl_body_accel_m_s2");
    assert_eq!(resolved.get(FL_BODY).unwrap().source, Source::Name);
    assert_eq!(signal(&resolved, FL_WHEEL), "D.FL_WheelAccel_M_S2");
    assert_eq!(resolved.get(FL_WHEEL).unwrap().source, Source::Letters);
}

#[test]
fn of_two_that_could_be_it_neither_is_taken() {
    let resolved = by_name(&[("A", "VehicleSpeed", "km/h"), ("B", "VehSpd", "m/s")]);
    assert!(resolved.get(Slot::Speed).is_none());
    assert_eq!(
        resolved.remarks()[0].to_string(),
        "speed_m_s could be any of A.VehicleSpeed, B.VehSpd: not taken; say which in a map, \
         speed_m_s = \"A.VehicleSpeed\""
    );
    // A unit that cannot be a speed rules one of them out.
    let resolved = by_name(&[("A", "VehicleSpeed", "km/h"), ("B", "VehSpd", "kPa")]);
    assert_eq!(signal(&resolved, Slot::Speed), "A.VehicleSpeed");
    // And so does an unknown word.
    let resolved = by_name(&[("A", "VehicleSpeedZzz", "km/h"), ("B", "VehSpd", "m/s")]);
    assert_eq!(signal(&resolved, Slot::Speed), "B.VehSpd");
}

#[test]
fn a_unit_that_says_nothing_is_asked_for() {
    let list = [("A", "VehicleSpeed", ""), ("A", "FL_BodyAccZ", "LSB")];
    let resolved = by_name(&list);
    assert!(resolved.slots().is_empty());
    assert_eq!(
        resolved.remarks()[0].to_string(),
        "speed_m_s could be A.VehicleSpeed, whose unit is not stated: not taken; say it in a map, \
         speed_m_s = { signal = \"A.VehicleSpeed\", unit = \"m/s\" } (or m/s, km/h, mph, kn, cm/s, mm/s or ft/s), or \
         factor = ..., offset = ..."
    );
    let text = resolved.unusable().unwrap();
    assert!(text.starts_with("none of 2 signals is known to be an acceleration"), "{text}");
    assert!(
        text.contains("fl_body_accel_m_s2 could be A.FL_BodyAccZ, whose unit is stated as \"LSB\""),
        "{text}"
    );
    assert_eq!(
        by_map(&list, "[signals]\nfl_body_accel_m_s2 = \"A.FL_BodyAccZ\"").unwrap_err(),
        "map.toml: line 2: fl_body_accel_m_s2 is to be \"A.FL_BodyAccZ\", whose unit is stated as \"LSB\", expected \
         an acceleration: give it in the map, fl_body_accel_m_s2 = { signal = \"A.FL_BodyAccZ\", factor = ..., offset = ... }, \
         which make m/s^2 of it"
    );
}

#[test]
fn every_problem_of_a_map_is_reported_with_its_line() {
    for (text, message) in [
        ("", "the file has no table [signals]"),
        (
            "[signal]\n",
            "line 1: unknown key signal in the file (did you mean signals?), expected one of: signals",
        ),
        (
            "[signals]\nspeed_m_s = 5\n",
            "line 2: [signals] speed_m_s is of type integer, expected text in quotes or a table in braces",
        ),
        (
            "[signals]\nspeed_m_s = { unit = \"km/h\" }\n",
            "[signals.speed_m_s] has no signal (table at line 2)",
        ),
        (
            "[signals]\nspeed_m_s = { signal = \"VehicleSpeed\", unit = \"kPa\" }\n",
            "line 2: speed_m_s has unit \"kPa\", expected m/s, km/h, mph, kn, cm/s, mm/s or ft/s (or factor and offset \
             instead)",
        ),
        (
            "[signals]\nspeed_m_s = { signal = \"VehicleSpeed\", unit = \"km/h\", factor = 2 }\n",
            "line 2: speed_m_s has a unit and a factor or offset, expected one of the two",
        ),
        (
            "[signals]\nspeed_m_s = { signal = \"VehicleSpeed\", factor = 0 }\n",
            "line 2: speed_m_s has factor 0 and offset 0, expected a finite factor that is not 0 and a finite offset",
        ),
        (
            "[signals]\n\nspeed_m_s = \"ESP_2.VehicleSpeed\"\n",
            "line 3: speed_m_s is to be \"ESP_2.VehicleSpeed\", but there is no such signal; the nearest name of 5 is \
             \"ESP_02.VehicleSpeed\"",
        ),
        (
            "[signals]\nspeed_m_s = \"Counter\"\n",
            "line 2: speed_m_s is to be \"Counter\", which could be Chassis_FL.Counter, Misc.Counter: expected one of \
             these",
        ),
    ] {
        assert_eq!(by_map(&CAR, text).unwrap_err(), format!("map.toml: {message}"), "{text}");
    }
    let text = by_map(&CAR, "[signals]\nspeed = \"A\"\n").unwrap_err();
    assert!(
        text.starts_with("map.toml: line 2: unknown key speed in [signals] (did you mean speed_m_s?)"),
        "{text}"
    );
    // The clock of a table is no signal: whoever opens the log says whether it has one of its own.
    let resolved = by_map(&CAR, "[signals]\ntime_s = \"A\"\n").unwrap();
    assert!(resolved.get(Slot::Time).is_none());
    let text = by_map(&CAR, "[signals]\ntime_s = { signal = \"A\", unit = \"km/h\" }\n").unwrap_err();
    assert!(text.starts_with("map.toml: line 2: time_s has unit \"km/h\", expected s, ms"), "{text}");
}

#[test]
fn a_column_can_be_left_without_a_signal() {
    let resolved = by_map(&CAR, "[signals]\nspeed_m_s = \"\"\n").unwrap();
    assert!(resolved.get(Slot::Speed).is_none() && resolved.remarks().is_empty());
    assert_eq!(signal(&resolved, FL_BODY), "Chassis_FL.BodyAccZ");
}

#[test]
fn one_signal_for_two_columns_is_mentioned() {
    let text = "[signals]\nfl_body_accel_m_s2 = \"BodyAccZ\"\nfr_body_accel_m_s2 = \"BodyAccZ\"\n";
    let resolved = by_map(&CAR, text).unwrap();
    let remark = resolved.remarks()[0].to_string();
    assert_eq!(remark, "Chassis_FL.BodyAccZ is both fl_body_accel_m_s2 and fr_body_accel_m_s2");
}

#[test]
fn names_with_dots_are_found_as_they_are() {
    let list = [("CAN1.ESP", "Speed.Vehicle", "km/h"), ("", "acc.fl", "g")];
    let text = "[signals]\nspeed_m_s = \"CAN1.ESP.Speed.Vehicle\"\nfl_body_accel_m_s2 = \"acc.fl\"\n";
    let resolved = by_map(&list, text).unwrap();
    assert_eq!(resolved.get(Slot::Speed).unwrap().candidate, 0);
    assert_eq!(resolved.get(FL_BODY).unwrap().candidate, 1);
}

#[test]
fn the_map_that_was_found_reads_back_as_the_same() {
    let list = [
        ("ESP_02", "VehicleSpeed", "km/h"),
        ("", "fl_body_accel_m_s2", ""),
        ("Hub \"FL\"", "AccZ", "m/s²"),
        ("A", "FR_BodyAccZ", "g"),
        ("B", "BodyAccZ_FR", "g"),
    ];
    let text =
        "[signals]\nfl_wheel_accel_m_s2 = { signal = \"Hub \\\"FL\\\".AccZ\", factor = -2, offset = 1.5 }\n";
    let first = by_map(&list, text).unwrap();
    let second = by_map(&list, &first.to_toml(None)).unwrap();
    assert_eq!(first.slots(), [Slot::Speed, FL_BODY, FL_WHEEL]);
    let summary = |resolved: &Resolved| {
        resolved.iter().map(|chosen| (chosen.slot, chosen.candidate, chosen.conversion)).collect::<Vec<_>>()
    };
    assert_eq!(summary(&first), summary(&second));
    assert!(
        first.to_toml(None).contains("# fr_body_accel_m_s2 could be any of A.FR_BodyAccZ, B.BodyAccZ_FR")
    );
}

/// Headers of tables: clock, speed, body and wheel of the front left corner as loggers name them, and what makes m/s and m/s² of the last
/// three (NIST SP 811, appendix B.8).
const TABLES: [(&str, [f64; 3]); 8] = [
    ("time_s,speed_m_s,fl_body_accel_m_s2,fl_wheel_accel_m_s2", [1.0, 1.0, 1.0]),
    ("Zeit;v_Fahrzeug [km/h];Aufbau_az_VL [g];Rad_az_VL [g]", [1.0 / 3.6, 9.806_65, 9.806_65]),
    (
        "timestamp;VehicleSpeed [Unit_KiloMeterPerHour];FL_BodyAccZ (mg);FL_WheelAccZ [Unit_MeterPerSecondSquared]",
        [1.0 / 3.6, 9.806_65e-3, 1.0],
    ),
    ("t [ms],v_veh_mph,body_acc_z_fl_m_s2,wheel_acc_z_fl_g", [0.447_04, 1.0, 9.806_65]),
    ("Time,VehSpd (kn),BodyAccZ_FL [ft/s^2],WheelAccZ_FL [cm/s²]", [1852.0 / 3600.0, 0.3048, 0.01]),
    ("Time;veh.speed.km.h;FL_BodyAccZ [mm/s^2];FL_HubAccZ [Gal]", [1.0 / 3.6, 1e-3, 0.01]),
    ("Timestamp,VehicleSpeed_kmh,AccZ_Body_FL_g,AccZ_Hub_FL_mg", [1.0 / 3.6, 9.806_65, 9.806_65e-3]),
    ("t,VehicleSpeed [m/s],sprungAccZ_FL [m·s⁻²],unsprungAccZ_FL [m/s**2]", [1.0, 1.0, 1.0]),
];

/// The table of this header; with `;` it has dates for a clock and decimal commas.
fn listed(header: &str) -> Vec<Candidate> {
    let german = header.contains(';');
    let rows = (0..500).map(|row| {
        let value = 0.01 * f64::from(row);
        let line = format!("{value},{value},{value},{value}");
        match german {
            true => format!("2026-03-01 08:00:0{value:.2};1,5;{0};{0}", value.to_string().replace('.', ",")),
            false => line,
        }
    });
    let text = std::iter::once(header.to_owned()).chain(rows).collect::<Vec<_>>().join("\n");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.csv");
    std::fs::write(&path, text).unwrap();
    let mut lister = Lister::open(&path, None, &[]).unwrap();
    while lister.step().unwrap() {}
    lister.finish().candidates()
}

#[test]
fn the_map_that_is_written_says_what_the_header_states() {
    for (header, factors) in TABLES {
        let candidates = listed(header);
        let resolved = resolve(&candidates, None).unwrap();
        assert_eq!(resolved.slots(), [Slot::Speed, FL_BODY, FL_WHEEL], "{header}");
        assert_eq!(resolved.remarks(), [], "{header}");
        let text = resolved.to_toml(Some("Time [s]"));
        assert!(text.contains("time_s = \"Time [s]\"\n"), "{text}");
        // No unit beside that of the name, which could contradict it.
        let messages = text.lines().filter(|line| !line.starts_with('#') && line.contains(" = "));
        assert!(
            messages.clone().count() >= 3 && messages.clone().all(|line| !line.contains("unit")),
            "{header}: {text}"
        );
        let again = resolve(&candidates, Some(&map(&text).unwrap())).unwrap();
        for resolved in [&resolved, &again] {
            for (slot, factor) in [Slot::Speed, FL_BODY, FL_WHEEL].into_iter().zip(factors) {
                let found = resolved.get(slot).unwrap().conversion;
                assert!(
                    (found.factor / factor - 1.0).abs() < 1e-12 && found.offset == 0.0,
                    "{header}: {found:?}"
                );
            }
        }
    }
}

#[test]
fn a_unit_that_is_stated_is_not_contradicted() {
    let columns = ["Time", "FL_BodyAccZ [m/s^2]", "FL_WheelAccZ [m/s^2]"];
    // Stated, and none of a speed's or of no quantity at all.
    for unit in ["rpm", "LSB", "Unit_Furlong", "bar", "km", "%", "m/s^2"] {
        let header = format!("{},VehicleSpeed [{unit}]", columns.join(","));
        let candidates = listed(&header);
        let resolved = resolve(&candidates, None).unwrap();
        assert_eq!(resolved.slots(), [FL_BODY, FL_WHEEL], "{unit}");
        let text =
            "[signals]\ntime_s = \"Time\"\nspeed_m_s = \"VehicleSpeed [UNIT]\"\n".replace("UNIT", unit);
        let refused = resolve(&candidates, Some(&map(&text).unwrap())).unwrap_err().to_string();
        assert!(refused.contains(&format!("is stated as {unit:?}")), "{refused}");
        for messages in resolved.assumptions().into_iter().chain([resolved.to_toml(None), refused]) {
            assert!(!messages.contains("unit = "), "{unit}: {messages}");
        }
    }
    // Not stated: asked for, with a column's own unit and the others that it may have.
    let candidates = listed("Time,FL_BodyAccZ [g],FL_WheelAccZ [g],VehicleSpeed");
    let messages = resolve(&candidates, None).unwrap().assumptions().join("\n");
    assert!(messages.contains("unit = \"m/s\" } (or m/s, km/h"), "{messages}");
}
