//! The words of a signal's name: `FL_BodyAccZ`, `AccZ_Wheel_RR`, `ESP_02.VehicleSpeed`, `v_veh`.
//!
//! Called by the resolver for names that are no column's own. A name is taken apart into words; the message or group
//! it is in helps out with what the name itself leaves open. Cautious: a word that makes it another quantity (`lateral`,
//! `target`, `status`) rules it out. Knows nothing of units.

#[cfg(test)]
mod tests;

use itpms_core::model::Corner;

use crate::log::{AirField, AxleField, Field, Motion, PositionField, Slot};

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Fit {
    /// Every word of the name is understood, an acceleration says that it is vertical.
    AllWords,
    /// Some words are unknown, or something was left open.
    SomeWords,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Word {
    Corner(Corner),
    Front,
    Rear,
    Left,
    Right,
    Body,
    Wheel,
    Acceleration,
    Vertical,
    Vehicle,
    Speed,
    Tire,
    Pressure,
    Road,
    Height,
    Yaw,
    Rate,
    Lateral,
    Longitudinal,
    Temperature,
    /// Of the air around the car, and words that go with it.
    Ambient,
    Air,
    Barometer,
    Altitude,
    Gps,
    Latitude,
    Longitude,
    Axle,
    /// Of a second rear axle and so on.
    FurtherAxle,
    /// Against another speed.
    Relative,
    Location,
    /// On an axle.
    Weight,
    /// A vehicle's speed that is based on its wheels'.
    Based,
    /// As a group's name: what other instruments have measured.
    Reference,
    /// A unit in which nothing but a speed over ground is given, so that of a corner it is its wheel's.
    OverGround,
    /// Says nothing: `signal`, `value`, a unit.
    Filler,
    /// Makes it something else: another axis, a limit, a status.
    Other,
    /// The same, and as a group's name, too.
    Machine,
    Unknown,
}

#[rustfmt::skip]
const WORDS: [(&str, Word); 211] = [
    ("fl", Word::Corner(Corner::FrontLeft)), ("lf", Word::Corner(Corner::FrontLeft)), ("vl", Word::Corner(Corner::FrontLeft)),
    ("fr", Word::Corner(Corner::FrontRight)), ("rf", Word::Corner(Corner::FrontRight)), ("vr", Word::Corner(Corner::FrontRight)),
    ("rl", Word::Corner(Corner::RearLeft)), ("lr", Word::Corner(Corner::RearLeft)), ("hl", Word::Corner(Corner::RearLeft)),
    ("rr", Word::Corner(Corner::RearRight)), ("hr", Word::Corner(Corner::RearRight)),
    ("front", Word::Front), ("frnt", Word::Front), ("rear", Word::Rear), ("left", Word::Left), ("lft", Word::Left),
    ("right", Word::Right), ("rgt", Word::Right), ("rght", Word::Right),
    ("body", Word::Body), ("chassis", Word::Body), ("sprung", Word::Body), ("dome", Word::Body), ("top", Word::Body),
    ("wheel", Word::Wheel), ("whl", Word::Wheel), ("unsprung", Word::Wheel), ("hub", Word::Wheel), ("knuckle", Word::Wheel),
    ("acc", Word::Acceleration), ("accel", Word::Acceleration), ("accl", Word::Acceleration), ("acceleration", Word::Acceleration),
    ("accelerometer", Word::Acceleration), ("a", Word::Acceleration),
    ("z", Word::Vertical), ("vert", Word::Vertical), ("vertical", Word::Vertical), ("vrt", Word::Vertical),
    ("vehicle", Word::Vehicle), ("veh", Word::Vehicle), ("vhcl", Word::Vehicle), ("car", Word::Vehicle), ("ego", Word::Vehicle),
    ("speed", Word::Speed), ("spd", Word::Speed), ("velocity", Word::Speed), ("vel", Word::Speed), ("v", Word::Speed),
    // German.
    ("aufbau", Word::Body), ("karosserie", Word::Body), ("rad", Word::Wheel), ("beschl", Word::Acceleration),
    ("beschleunigung", Word::Acceleration), ("vertikal", Word::Vertical), ("fahrzeug", Word::Vehicle), ("fzg", Word::Vehicle),
    ("geschwindigkeit", Word::Speed), ("geschw", Word::Speed), ("speeds", Word::Speed),
    ("gier", Word::Yaw), ("inline", Word::Longitudinal),
    ("ambient", Word::Ambient), ("amb", Word::Ambient), ("outside", Word::Ambient), ("outdoor", Word::Ambient), ("exterior", Word::Ambient),
    ("external", Word::Ambient), ("aussen", Word::Ambient), ("umgebung", Word::Ambient), ("umgebungs", Word::Ambient), ("aat", Word::Ambient), ("oat", Word::Ambient),
    ("air", Word::Air), ("luft", Word::Air), ("atmospheric", Word::Ambient), ("barometric", Word::Barometer), ("barometer", Word::Barometer), ("baro", Word::Barometer),
    ("luftdruck", Word::Barometer), ("altitude", Word::Altitude), ("alt", Word::Altitude),
    ("gps", Word::Gps), ("gnss", Word::Gps), ("latitude", Word::Latitude), ("longitude", Word::Longitude),
    // SAE J1939 and ISO 11992-2.
    ("axle", Word::Axle), ("axle1", Word::Axle), ("axle2", Word::FurtherAxle), ("axle3", Word::FurtherAxle), ("relative", Word::Relative), ("rel", Word::Relative),
    ("rltv", Word::Relative), ("rlv", Word::Relative), ("location", Word::Location), ("loc", Word::Location), ("position", Word::Location), ("weight", Word::Weight), ("load", Word::Weight), ("based", Word::Based),
    ("temperatur", Word::Temperature), ("druck", Word::Pressure),
    // A speed of rotation, as in `WhlFl_W_Meas` and `VehYaw_W_Actl`.
    ("w", Word::Speed), ("meas", Word::Filler), ("actl", Word::Filler), ("esp", Word::Filler), ("abs", Word::Filler),
    ("tire", Word::Tire), ("tyre", Word::Tire), ("tpms", Word::Tire),
    ("pressure", Word::Pressure), ("press", Word::Pressure), ("prs", Word::Pressure),
    ("road", Word::Road), ("height", Word::Height), ("elevation", Word::Height), ("profile", Word::Height),
    ("signal", Word::Filler), ("sig", Word::Filler), ("value", Word::Filler), ("val", Word::Filler), ("sensor", Word::Filler),
    ("sens", Word::Filler), ("sns", Word::Filler), ("m", Word::Filler), ("s", Word::Filler), ("s2", Word::Filler),
    ("ms2", Word::Filler), ("mps2", Word::Filler), ("mps", Word::Filler), ("g", Word::Filler), ("mg", Word::Filler),
    ("km", Word::OverGround), ("h", Word::Filler), ("kmh", Word::OverGround), ("kph", Word::OverGround), ("mph", Word::OverGround),
    ("reference", Word::Reference), ("truth", Word::Reference), ("kpa", Word::Filler), ("bar", Word::Filler), ("psi", Word::Filler), ("mm", Word::Filler),
    ("x", Word::Longitudinal), ("y", Word::Lateral), ("lat", Word::Lateral), ("lateral", Word::Lateral), ("lon", Word::Longitudinal),
    ("long", Word::Longitudinal), ("longitudinal", Word::Longitudinal), ("pedal", Word::Other), ("gyro", Word::Filler), ("yaw", Word::Yaw),
    ("roll", Word::Other), ("pitch", Word::Other), ("angle", Word::Other), ("angular", Word::Other), ("orientation", Word::Other), ("rate", Word::Rate),
    ("temp", Word::Temperature), ("temperature", Word::Temperature), ("status", Word::Other), ("stat", Word::Other), ("state", Word::Other),
    ("sts", Word::Other), ("valid", Word::Other), ("validity", Word::Other), ("quality", Word::Other), ("qual", Word::Other),
    ("qualifier", Word::Other), ("qf", Word::Other), ("error", Word::Other), ("err", Word::Other), ("fault", Word::Other),
    ("counter", Word::Other), ("cnt", Word::Other), ("crc", Word::Other), ("checksum", Word::Other), ("offset", Word::Other),
    ("bias", Word::Other), ("min", Word::Other), ("max", Word::Other), ("rms", Word::Other), ("peak", Word::Other),
    ("mean", Word::Other), ("avg", Word::Other), ("sd", Word::Other), ("target", Word::Other), ("set", Word::Other),
    ("setpoint", Word::Other), ("request", Word::Other), ("req", Word::Other), ("limit", Word::Other), ("limiter", Word::Other),
    ("targ", Word::Other), ("tgt", Word::Other), ("trgt", Word::Other), ("desired", Word::Other), ("cmd", Word::Other),
    ("command", Word::Other), ("demand", Word::Other),
    ("cruise", Word::Machine), ("nominal", Word::Other), ("warning", Word::Other), ("warn", Word::Other), ("engine", Word::Machine),
    ("motor", Word::Machine), ("fan", Word::Machine), ("wind", Word::Machine), ("brake", Word::Machine), ("estimated", Word::Other),
];

/// What comma's logs call the message of a car's signals, where its fields are columns: no state of anything.
const MESSAGE: &str = "carState_";

/// The column this signal's name and group speak of.
pub(crate) fn meaning(group: &str, name: &str) -> Option<(Slot, Fit)> {
    meaning_in(group, name, "")
}

/// The same of a signal whose unit is stated beside its name.
pub(crate) fn meaning_in(group: &str, name: &str, unit: &str) -> Option<(Slot, Fit)> {
    // A table's column may carry its message's name, as `ESP_Status::VehicleSpeed`.
    let (group, name) = name.rsplit_once("::").filter(|_| group.is_empty()).unwrap_or((group, name));
    // A speed against another is none until that is added.
    let (spoken, is_sum) = name.split_once(" + ").map_or((name, false), |(first, _)| (first, true));
    let (own, around) = (words(spoken.strip_prefix(MESSAGE).unwrap_or(spoken)), words(group));
    if own.contains(&Word::FurtherAxle) || own.contains(&Word::Relative) && !is_sum {
        return None;
    }
    // `v_FL` is a damper's as well as a wheel's, unless its unit tells; without one it is asked for.
    let over_ground = own.contains(&Word::OverGround) || words(unit).contains(&Word::OverGround);
    let alone = |word: &Word| *word == Word::Speed || is_of_a_corner(word);
    let bare_speed = over_ground || unit.is_empty() && own.iter().all(alone);
    let has = |word| own.contains(&word);
    let says = |word| own.contains(&word) || around.contains(&word);
    if let Some(field) = air(&own) {
        let sure = !has(Word::Unknown) && !has(Word::Reference);
        return Some((Slot::Air(field), if sure { Fit::AllWords } else { Fit::SomeWords }));
    }
    if let Some(field) = position(&own) {
        return Some((
            Slot::Position(field),
            if has(Word::Unknown) { Fit::SomeWords } else { Fit::AllWords },
        ));
    }
    if has(Word::Other) || says(Word::Machine) || has(Word::Temperature) && !says(Word::Tire) {
        return None;
    }
    if let (true, true, Some(field)) = (has(Word::Weight), has(Word::Axle), axle(&own)) {
        let sure = !has(Word::Unknown) && !has(Word::Reference);
        return Some((Slot::Axle(field), if sure { Fit::AllWords } else { Fit::SomeWords }));
    }
    let corner = corner(&own).or_else(|| if names_corner(&own) { None } else { corner(&around) });
    let stranger = [
        Word::Unknown,
        Word::Reference,
        Word::Ambient,
        Word::Air,
        Word::Barometer,
        Word::Altitude,
        Word::Gps,
        Word::Latitude,
        Word::Longitude,
        Word::Location,
        Word::Weight,
    ];
    // A wheel's speed of two signals stands behind that of one: it is coarser.
    let complete = !stranger.into_iter().any(has) && !is_sum;
    let fit = |sure: bool| if sure && complete { Fit::AllWords } else { Fit::SomeWords };
    if [Word::Yaw, Word::Rate, Word::Lateral, Word::Longitudinal].into_iter().any(has) {
        let of_the_car = corner.is_none() && !says(Word::Wheel) && !names_corner(&own);
        return motion(&own).filter(|_| of_the_car).map(|motion| (Slot::Motion(motion), fit(true)));
    }
    if let Some(corner) = corner {
        let field = if has(Word::Temperature) {
            (!has(Word::Pressure)).then_some((Field::TireTemperature, fit(true)))
        } else if has(Word::Pressure) {
            let field = if around.contains(&Word::Reference) { Field::Pressure } else { Field::TireSensor };
            says(Word::Tire).then_some((field, fit(true)))
        } else if has(Word::Speed) || says(Word::Speed) && own.iter().all(names_a_corner_or_nothing) {
            let of_a_wheel = (says(Word::Wheel) || bare_speed && !says(Word::Body))
                && !has(Word::Vertical)
                && !has(Word::Acceleration);
            of_a_wheel.then_some((Field::WheelSpeed, fit(says(Word::Wheel))))
        } else if has(Word::Road) && (has(Word::Height) || has(Word::Vertical)) {
            Some((Field::Road, fit(true)))
        } else if says(Word::Acceleration) {
            mass(&own).or_else(|| mass(&around)).map(|field| (field, fit(says(Word::Vertical))))
        } else {
            None
        };
        return field.map(|(field, fit)| (Slot::Corner(corner, field), fit));
    }
    let of_a_wheel = says(Word::Wheel) && !has(Word::Based) || names_corner(&own);
    if has(Word::Speed) && !of_a_wheel && !has(Word::Vertical) {
        return Some((Slot::Speed, fit(says(Word::Vehicle))));
    }
    None
}

/// The whole that a signal is part of, where a column is made of two of a message.
#[cfg(feature = "can")]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    FrontAxleSpeed,
    /// Of a wheel against the front axle's.
    RelativeSpeed,
    /// The same of a wheel of a second rear axle.
    FurtherSpeed,
    TireLocation,
    TirePressure,
    TireTemperature,
    AxleLocation,
    AxleWeight,
}

#[cfg(feature = "can")]
pub(crate) fn part(name: &str) -> Option<Part> {
    let own = words(name);
    let has = |word| own.contains(&word);
    if has(Word::Other) || has(Word::Machine) {
        return None;
    }
    match (has(Word::Speed), has(Word::Relative), has(Word::Tire)) {
        (true, true, _) if has(Word::FurtherAxle) => Some(Part::FurtherSpeed),
        (true, true, _) => corner(&own).map(|_| Part::RelativeSpeed),
        (true, false, false) if has(Word::Front) && has(Word::Axle) && corner(&own).is_none() => {
            Some(Part::FrontAxleSpeed)
        }
        (false, false, false) if has(Word::Axle) && !names_corner(&own) && !has(Word::Unknown) => {
            match (has(Word::Location), has(Word::Weight)) {
                (true, false) => Some(Part::AxleLocation),
                (false, true) => Some(Part::AxleWeight),
                _ => None,
            }
        }
        (false, false, true) if names_corner(&own) || has(Word::Unknown) => None,
        (false, false, true) => match (has(Word::Location), has(Word::Pressure), has(Word::Temperature)) {
            (true, false, false) => Some(Part::TireLocation),
            (false, true, false) => Some(Part::TirePressure),
            (false, false, true) => Some(Part::TireTemperature),
            _ => None,
        },
        _ => None,
    }
}

/// What of the air it is, if it is of that: all by its own name, and nothing of a corner or an engine in it.
fn air(words: &[Word]) -> Option<AirField> {
    let has = |word| words.contains(&word);
    let others = [
        Word::Other,
        Word::Machine,
        Word::Tire,
        Word::Wheel,
        Word::Body,
        Word::Road,
        Word::Speed,
        Word::Rate,
    ];
    if others.into_iter().any(has) || names_corner(words) {
        return None;
    }
    match (has(Word::Ambient), has(Word::Temperature), has(Word::Pressure)) {
        (true, true, false) => Some(AirField::Temperature),
        (true, false, true) => Some(AirField::Pressure),
        (false, false, _) if has(Word::Barometer) => Some(AirField::Pressure),
        (false, false, false) if has(Word::Altitude) => Some(AirField::Altitude),
        _ => None,
    }
}

/// Where the car is, if it is of that: `Latitude`, `gps_lat`; nothing that has a speed, an acceleration or a spread.
fn position(words: &[Word]) -> Option<PositionField> {
    let has = |word| words.contains(&word);
    if [Word::Other, Word::Machine, Word::Acceleration, Word::Speed, Word::Rate].into_iter().any(has) {
        return None;
    }
    let north = has(Word::Latitude) || has(Word::Gps) && has(Word::Lateral);
    let east = has(Word::Longitude) || has(Word::Gps) && has(Word::Longitudinal);
    match (north, east) {
        (true, false) => Some(PositionField::Latitude),
        (false, true) => Some(PositionField::Longitude),
        _ => None,
    }
}

/// How a car moves, if it is that: yaw has a rate or a speed, an acceleration one direction.
fn motion(words: &[Word]) -> Option<Motion> {
    let has = |word| words.contains(&word);
    match (has(Word::Yaw), has(Word::Lateral), has(Word::Longitudinal)) {
        (true, false, false) if has(Word::Rate) || has(Word::Speed) => Some(Motion::YawRate),
        _ if has(Word::Rate) || has(Word::Speed) || !has(Word::Acceleration) => None,
        (false, true, false) => Some(Motion::AccelY),
        (false, false, true) => Some(Motion::AccelX),
        _ => None,
    }
}

/// The one axle that is named, if no wheel of it is.
fn axle(words: &[Word]) -> Option<AxleField> {
    let has = |word| words.contains(&word);
    match (has(Word::Front), has(Word::Rear), has(Word::Left) || has(Word::Right)) {
        (true, false, false) => Some(AxleField::Front),
        (false, true, false) => Some(AxleField::Rear),
        _ => None,
    }
}

/// Body or wheel, if it is one of the two.
fn mass(words: &[Word]) -> Option<Field> {
    match (words.contains(&Word::Body), words.contains(&Word::Wheel)) {
        (true, false) => Some(Field::BodyAccel),
        (false, true) => Some(Field::WheelAccel),
        _ => None,
    }
}

fn corner(words: &[Word]) -> Option<Corner> {
    let has = |word| words.contains(&word);
    let side = match (has(Word::Front), has(Word::Rear), has(Word::Left), has(Word::Right)) {
        (true, false, true, false) => Some(Corner::FrontLeft),
        (true, false, false, true) => Some(Corner::FrontRight),
        (false, true, true, false) => Some(Corner::RearLeft),
        (false, true, false, true) => Some(Corner::RearRight),
        _ => None,
    };
    let mut named =
        Corner::ALL.into_iter().filter(|corner| side == Some(*corner) || has(Word::Corner(*corner)));
    named.next().filter(|_| named.next().is_none())
}

/// Whether anything is reported of a corner, be it contradictory.
fn names_corner(words: &[Word]) -> bool {
    words.iter().any(is_of_a_corner)
}

fn names_a_corner_or_nothing(word: &Word) -> bool {
    is_of_a_corner(word) || matches!(word, Word::Filler | Word::OverGround)
}

fn is_of_a_corner(word: &Word) -> bool {
    matches!(word, Word::Corner(_) | Word::Front | Word::Rear | Word::Left | Word::Right)
}

/// The words of a name: at `_` and the like, where small letters turn into capitals, and inside `vehspd`.
fn words(name: &str) -> Vec<Word> {
    let mut words = Vec::new();
    for part in name.split(|c: char| !c.is_ascii_alphanumeric()) {
        for piece in camel(part) {
            let piece = piece.to_ascii_lowercase();
            match WORDS.iter().find(|(word, _)| *word == piece) {
                Some((_, meaning)) => words.push(*meaning),
                None if piece == "az" => words.extend([Word::Acceleration, Word::Vertical]),
                None => compound(&piece, &mut words),
            }
        }
    }
    words
}

/// `BodyAccZ` to `Body`, `Acc`, `Z`; `FLBody` to `FL`, `Body`. ASCII only, so that every index is a character.
fn camel(part: &str) -> Vec<&str> {
    let bytes = part.as_bytes();
    let mut cuts = vec![0];
    for i in 1..bytes.len() {
        let (before, here) = (bytes[i - 1], bytes[i]);
        let next_small = bytes.get(i + 1).is_some_and(u8::is_ascii_lowercase);
        let rises = here.is_ascii_uppercase() && !before.is_ascii_uppercase();
        let acronym_ends = here.is_ascii_uppercase() && before.is_ascii_uppercase() && next_small;
        if rises || acronym_ends {
            cuts.push(i);
        }
    }
    cuts.push(bytes.len());
    cuts.windows(2).map(|cut| &part[cut[0]..cut[1]]).filter(|piece| !piece.is_empty()).collect()
}

/// A word without seams, `vehspd` or `accz`: the longest known words from its beginning, if they use it up; words of one
/// letter count only at the end, where an axis stands.
fn compound(piece: &str, words: &mut Vec<Word>) {
    let (mut rest, mut found) = (piece, Vec::new());
    while !rest.is_empty() {
        let longest = WORDS
            .iter()
            .filter(|(word, _)| rest.starts_with(word) && (word.len() > 1 || rest.len() == 1))
            .max_by_key(|(word, _)| word.len());
        let Some((word, meaning)) = longest else { return words.push(Word::Unknown) };
        found.push(*meaning);
        rest = &rest[word.len()..];
    }
    words.extend(found);
}
