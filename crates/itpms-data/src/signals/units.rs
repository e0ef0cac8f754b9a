//! From the unit a file names to the unit of a column: `km/h` to m/s, `g` to m/s², `bar` to kPa.
//!
//! Called by the map's reader and by the resolver. A unit is a spelling, a quantity and a factor; it knows nothing of
//! signals. Factors are those of the SI brochure and of NIST SP 811, appendix B.8.

use itpms_core::model::PressureUnit;

use super::Conversion;
use crate::log::{Quantity, Slot};

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Unit {
    /// Nothing, or a dash: the file does not say.
    Silent,
    /// A unit of this quantity, and how it becomes the quantity's own.
    Known(Quantity, Conversion),
    Unknown,
}

const STANDARD_GRAVITY_M_S2: f64 = 9.806_65;

impl Unit {
    /// The unit of this spelling, whatever its blanks, powers and case.
    pub(crate) fn of(text: &str) -> Self {
        let plain = plain(text);
        // `Unit_KiloMeterPerHour`, as descriptions of buses have it.
        let named = plain.strip_prefix("Unit").filter(|rest| rest.starts_with(char::is_uppercase));
        let plain = named.unwrap_or(&plain).to_owned();
        if ["", "-", "--", "1", "none", "n/a", "unitless", "nounit"].contains(&plain.to_lowercase().as_str())
        {
            return Unit::Silent;
        }
        // Mega and milli differ by their case; all else is recognised in any.
        let exact = UNITS.iter().find(|(name, ..)| *name == plain);
        let found = exact.or_else(|| {
            let lower = plain.to_lowercase();
            UNITS.iter().find(|(name, ..)| name.to_lowercase() == lower)
        });
        found.map_or(Unit::Unknown, |(name, quantity, factor)| {
            Unit::Known(*quantity, Conversion { factor: *factor, offset: offset(name) })
        })
    }

    /// The conversion to the unit of this column, if it is a unit of the column's quantity.
    pub(crate) fn conversion_to(self, slot: Slot) -> Option<Conversion> {
        match self {
            Unit::Known(quantity, conversion) if quantity == Quantity::of(slot) => Some(conversion),
            // A switch has no unit.
            Unit::Silent if Quantity::of(slot) == Quantity::Switch => Some(Conversion::IDENTITY),
            _ => None,
        }
    }
}

/// Zero of a unit in the quantity's own, where it has another one.
fn offset(unit: &str) -> f64 {
    match unit {
        "K" | "degK" | "Kelvin" => -273.15,
        "degF" | "°F" | "Fahrenheit" | "DegreesFahrenheit" => -32.0 * FAHRENHEIT,
        _ => 0.0,
    }
}

/// A degree Fahrenheit in K.
const FAHRENHEIT: f64 = 5.0 / 9.0;

/// A turn and a degree in rad.
const TURN: f64 = std::f64::consts::TAU;
const DEGREE: f64 = TURN / 360.0;

/// Without blanks, brackets and signs of multiplication and power: `m / s ^ 2`, `m·s⁻²` and `[m/s²]` are written in many ways.
fn plain(text: &str) -> String {
    let mut plain = String::new();
    for c in text.chars() {
        match c {
            '²' => plain.push('2'),
            '⁻' | '−' => plain.push('-'),
            'µ' | 'μ' => plain.push('u'),
            // The remains of UTF-8 read as cp1252: `Â²`.
            'Â' | '[' | ']' | '(' | ')' | '^' | '*' | '·' | '⋅' | '.' | '_' => {}
            c if c.is_whitespace() || c.is_control() => {}
            c => plain.push(c),
        }
    }
    plain
}

#[rustfmt::skip]
const UNITS: [(&str, Quantity, f64); 127] = {
    use Quantity::{Acceleration, Angle, Length, Mass, Pressure, Rotation, Speed, Temperature, Time};
    [
        ("kg", Mass, 1.0), ("Kilogram", Mass, 1.0), ("t", Mass, 1e3), ("lb", Mass, 0.453_592_37), ("lbs", Mass, 0.453_592_37),
        ("m/s2", Acceleration, 1.0), ("m/s/s", Acceleration, 1.0), ("ms-2", Acceleration, 1.0), ("mps2", Acceleration, 1.0),
        ("m/sec2", Acceleration, 1.0), ("m/ss", Acceleration, 1.0), ("mpss", Acceleration, 1.0), ("ms2", Acceleration, 1.0),
        ("MeterPerSecondSquared", Acceleration, 1.0), ("MeterPerSquareSecond", Acceleration, 1.0),
        ("g", Acceleration, STANDARD_GRAVITY_M_S2), ("gn", Acceleration, STANDARD_GRAVITY_M_S2),
        ("g0", Acceleration, STANDARD_GRAVITY_M_S2), ("mg", Acceleration, 1e-3 * STANDARD_GRAVITY_M_S2),
        ("ug", Acceleration, 1e-6 * STANDARD_GRAVITY_M_S2),
        ("dm/s2", Acceleration, 0.1), ("cm/s2", Acceleration, 0.01), ("Gal", Acceleration, 0.01),
        ("mm/s2", Acceleration, 1e-3), ("ft/s2", Acceleration, 0.3048),

        ("m/s", Speed, 1.0), ("ms-1", Speed, 1.0), ("mps", Speed, 1.0), ("m/sec", Speed, 1.0),
        ("km/h", Speed, 1.0 / 3.6), ("kmh", Speed, 1.0 / 3.6), ("kph", Speed, 1.0 / 3.6), ("kmph", Speed, 1.0 / 3.6),
        ("km/hr", Speed, 1.0 / 3.6), ("kmh-1", Speed, 1.0 / 3.6), ("kmperhour", Speed, 1.0 / 3.6), ("kmperhr", Speed, 1.0 / 3.6),
        ("mph", Speed, 0.44704), ("mi/h", Speed, 0.44704), ("mile/h", Speed, 0.44704), ("miles/h", Speed, 0.44704),
        ("kn", Speed, 1852.0 / 3600.0), ("kt", Speed, 1852.0 / 3600.0), ("knot", Speed, 1852.0 / 3600.0),
        ("knots", Speed, 1852.0 / 3600.0), ("cm/s", Speed, 0.01), ("mm/s", Speed, 1e-3), ("ft/s", Speed, 0.3048),
        ("KiloMeterPerHour", Speed, 1.0 / 3.6), ("MeterPerSecond", Speed, 1.0), ("MilePerHour", Speed, 0.44704),

        ("kPa", Pressure, 1.0), ("KiloPascal", Pressure, 1.0), ("Pa", Pressure, 1e-3), ("hPa", Pressure, 0.1), ("mbar", Pressure, 0.1),
        ("bar", Pressure, PressureUnit::Bar.kpa()), ("barg", Pressure, PressureUnit::Bar.kpa()), ("MPa", Pressure, 1000.0),
        ("psi", Pressure, PressureUnit::Psi.kpa()), ("psig", Pressure, PressureUnit::Psi.kpa()), ("kgf/cm2", Pressure, 98.066_5),
        ("inHg", Pressure, 3.386_389), ("mmHg", Pressure, 0.133_322_4),

        ("m", Length, 1.0), ("mm", Length, 1e-3), ("cm", Length, 0.01), ("dm", Length, 0.1), ("um", Length, 1e-6),
        ("meter", Length, 1.0), ("in", Length, 0.0254), ("inch", Length, 0.0254), ("ft", Length, 0.3048), ("km", Length, 1000.0),

        ("rad/s", Rotation, 1.0), ("rad/sec", Rotation, 1.0), ("rads-1", Rotation, 1.0), ("rads", Rotation, 1.0), ("radps", Rotation, 1.0),
        ("RadianPerSecond", Rotation, 1.0), ("deg/s", Rotation, DEGREE), ("deg/sec", Rotation, DEGREE), ("degs-1", Rotation, DEGREE),
        ("degree/s", Rotation, DEGREE), ("degrees/s", Rotation, DEGREE), ("degrees/sec", Rotation, DEGREE), ("°/s", Rotation, DEGREE),
        ("°/sec", Rotation, DEGREE), ("dps", Rotation, DEGREE), ("degps", Rotation, DEGREE),
        ("degpersec", Rotation, DEGREE), ("grad/s", Rotation, DEGREE), ("DegreOfArcPerSeco", Rotation, DEGREE), ("mrad/s", Rotation, 1e-3),
        ("rpm", Rotation, TURN / 60.0), ("1/min", Rotation, TURN / 60.0), ("min-1", Rotation, TURN / 60.0),
        ("rev/min", Rotation, TURN / 60.0), ("U/min", Rotation, TURN / 60.0),

        ("s", Time, 1.0), ("sec", Time, 1.0), ("ms", Time, 1e-3), ("us", Time, 1e-6), ("ns", Time, 1e-9), ("min", Time, 60.0), ("d", Time, 86_400.0), ("day", Time, 86_400.0),
        ("days", Time, 86_400.0),

        ("degC", Temperature, 1.0), ("°C", Temperature, 1.0), ("C", Temperature, 1.0), ("Cel", Temperature, 1.0), ("DegreesCelsius", Temperature, 1.0),
        ("K", Temperature, 1.0), ("degK", Temperature, 1.0), ("Kelvin", Temperature, 1.0),
        ("degF", Temperature, FAHRENHEIT), ("°F", Temperature, FAHRENHEIT), ("Fahrenheit", Temperature, FAHRENHEIT),
        ("DegreesFahrenheit", Temperature, FAHRENHEIT),

        ("deg", Angle, 1.0), ("°", Angle, 1.0), ("degree", Angle, 1.0), ("degrees", Angle, 1.0), ("DegreeOfArc", Angle, 1.0), ("rad", Angle, 1.0 / DEGREE),
        ("radian", Angle, 1.0 / DEGREE),
    ]
};

#[cfg(test)]
mod tests {
    use itpms_core::model::Corner;

    use super::*;
    use crate::log::{AirField, Field};

    fn factor(text: &str, slot: Slot) -> Option<f64> {
        Unit::of(text).conversion_to(slot).map(|conversion| conversion.factor)
    }

    #[test]
    fn one_unit_has_many_spellings() {
        let body = Slot::Corner(Corner::FrontLeft, Field::BodyAccel);
        for text in
            ["m/s^2", "m/s²", "m/s2", "m / s**2", "m·s⁻²", "[m/s^2]", "M/S^2", "m/sÂ²", "m/(s*s)", "m/s/s"]
        {
            assert_eq!(factor(text, body), Some(1.0), "{text}");
        }
        for text in ["km/h", "kmh", "KM/H", "km h^-1", "kph", "[km/h]"] {
            assert_eq!(factor(text, Slot::Speed), Some(1.0 / 3.6), "{text}");
        }
    }

    #[test]
    fn published_factors() {
        // NIST SP 811, B.8: exact, or to the digits printed there.
        let (body, pressure) = (
            Slot::Corner(Corner::FrontLeft, Field::BodyAccel),
            Slot::Corner(Corner::FrontLeft, Field::Pressure),
        );
        assert_eq!(factor("g", body), Some(9.80665));
        assert_eq!(factor("mph", Slot::Speed), Some(0.44704));
        assert!((factor("knot", Slot::Speed).unwrap() - 0.514_444_4).abs() < 1e-7);
        assert!((factor("psi", pressure).unwrap() - 6.894_757).abs() < 1e-6);
        assert_eq!(factor("bar", pressure), Some(100.0));
        assert_eq!(factor("mm", Slot::Corner(Corner::RearLeft, Field::Road)), Some(0.001));
    }

    #[test]
    fn the_air_is_measured_in_many_units() {
        let air = |text: &str, field, value: f64| {
            let conversion = Unit::of(text).conversion_to(Slot::Air(field));
            conversion.map(|conversion| (1e3 * conversion.apply(value)).round() / 1e3)
        };
        for (unit, value) in [("degC", -10.0), ("deg C", -10.0), ("K", 263.15), ("degF", 14.0), ("°F", 14.0)]
        {
            assert_eq!(air(unit, AirField::Temperature, value), Some(-10.0), "{unit}");
        }
        for (unit, value) in
            [("kPa", 101.325), ("hPa", 1013.25), ("mbar", 1013.25), ("bar", 1.01325), ("inHg", 29.921_26)]
        {
            assert_eq!(air(unit, AirField::Pressure, value), Some(101.325), "{unit}");
        }
        assert_eq!(air("ft", AirField::Altitude, 1000.0), Some(304.8));
        assert_eq!(
            (air("degC", AirField::Pressure, 1.0), air("m", AirField::Temperature, 1.0)),
            (None, None)
        );
    }

    #[test]
    fn wheels_and_yaw_turn() {
        let rotation = Slot::Corner(Corner::RearLeft, Field::WheelRotation);
        // A turn is 2 pi: 60 rpm are a turn a second, and so are 360 degrees.
        for (text, turns_per_s) in
            [("rpm", 60.0), ("1/min", 60.0), ("deg/s", 360.0), ("°/s", 360.0), ("Deg/Sec", 360.0)]
        {
            let rad_s = factor(text, rotation).unwrap() * turns_per_s;
            assert!((rad_s - std::f64::consts::TAU).abs() < 1e-12, "{text}");
        }
        assert_eq!(factor("rad/s", rotation), Some(1.0));
        assert_eq!(factor("km/h", rotation), None);
        let speed = Slot::Corner(Corner::RearLeft, Field::WheelSpeed);
        assert_eq!((factor("rad/s", speed), factor("km/h", speed)), (None, Some(1.0 / 3.6)));
    }

    #[test]
    fn mega_is_not_milli_and_g_is_no_speed() {
        let pressure = Slot::Corner(Corner::FrontLeft, Field::Pressure);
        assert_eq!(factor("MPa", pressure), Some(1000.0));
        assert_eq!(factor("g", Slot::Speed), None);
        assert_eq!(Unit::of("LSB"), Unit::Unknown);
        assert_eq!(Unit::of(" - "), Unit::Silent);
    }

    #[test]
    fn no_spelling_is_there_twice() {
        for (i, (name, ..)) in UNITS.iter().enumerate() {
            assert!(UNITS[..i].iter().all(|(other, ..)| other != name), "{name}");
        }
    }
}
