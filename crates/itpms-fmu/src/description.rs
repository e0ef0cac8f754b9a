//! `modelDescription.xml` of FMI 2.0 and 3.0, of the one table of variables.

use std::fmt::Write as _;

use itpms_data::Vehicle;
use itpms_data::reference::crc64;

use crate::variables::{Causality, Kind, UNITS, Variable, variables};

/// Name of the shared library inside the package, and the prefix of nothing: the functions have none.
pub const MODEL_IDENTIFIER: &str = "itpms";

/// A version of the standard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fmi {
    Two,
    Three,
}

/// Token of this unit: of the program's version and the vehicle file. A tool hands it back.
pub fn token(vehicle: &Vehicle) -> String {
    let text = vehicle.to_toml();
    let of = |salt: &str| crc64(&[salt.as_bytes(), env!("CARGO_PKG_VERSION").as_bytes(), text.as_bytes()]);
    let (a, b) = (of("itpms-fmu"), of("itpms-fmu 2"));
    let (c, d) = (a & 0xffff, b >> 48);
    format!("{{{:08x}-{:04x}-{c:04x}-{d:04x}-{:012x}}}", a >> 32, (a >> 16) & 0xffff, b & 0xffff_ffff_ffff)
}

/// The description of a vehicle's unit; `step_s` is the step that a tool takes unless stated otherwise.
pub fn description(fmi: Fmi, vehicle: &Vehicle, step_s: f64) -> String {
    let table = variables(vehicle);
    let mut xml = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    // Writing into a string cannot fail.
    let _ = match fmi {
        Fmi::Two => write_two(&mut xml, vehicle, &table, step_s),
        Fmi::Three => write_three(&mut xml, vehicle, &table, step_s),
    };
    xml
}

fn head(vehicle: &Vehicle) -> String {
    let name = escaped(&vehicle.name);
    let version = env!("CARGO_PKG_VERSION");
    format!(
        "modelName=\"itpms\" description=\"Tire pressures of {name} from the accelerations of its body and wheels\" version=\"{version}\" \
         license=\"MIT OR Apache-2.0\" generationTool=\"itpms {version}\" variableNamingConvention=\"flat\""
    )
}

fn write_two(xml: &mut String, vehicle: &Vehicle, table: &[Variable], step_s: f64) -> std::fmt::Result {
    let (head, token) = (head(vehicle), token(vehicle));
    writeln!(
        xml,
        "<fmiModelDescription fmiVersion=\"2.0\" guid=\"{token}\" {head} numberOfEventIndicators=\"0\">"
    )?;
    writeln!(
        xml,
        "  <CoSimulation modelIdentifier=\"{MODEL_IDENTIFIER}\" canHandleVariableCommunicationStepSize=\"true\" \
         canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\" canNotUseMemoryManagementFunctions=\"true\"/>"
    )?;
    units(xml)?;
    writeln!(xml, "  <DefaultExperiment startTime=\"0\" stepSize=\"{step_s}\"/>\n  <ModelVariables>")?;
    for (reference, variable) in table.iter().enumerate() {
        let Variable { name, kind, text, .. } = variable;
        let kind = match kind {
            Kind::Real => "Real",
            Kind::Integer => "Integer",
            Kind::Boolean => "Boolean",
        };
        writeln!(
            xml,
            "    <ScalarVariable name=\"{name}\" valueReference=\"{reference}\" {} description=\"{}\"><{kind}{}/></ScalarVariable>",
            properties(variable),
            escaped(text),
            unit_and_start(variable, variable.causality == Causality::Output)
        )?;
    }
    writeln!(xml, "  </ModelVariables>\n  <ModelStructure>")?;
    // Variables are counted from one there.
    for list in ["Outputs", "InitialUnknowns"] {
        writeln!(xml, "    <{list}>")?;
        for reference in outputs(table) {
            writeln!(xml, "      <Unknown index=\"{}\"/>", reference + 1)?;
        }
        writeln!(xml, "    </{list}>")?;
    }
    writeln!(xml, "  </ModelStructure>\n</fmiModelDescription>")
}

fn write_three(xml: &mut String, vehicle: &Vehicle, table: &[Variable], step_s: f64) -> std::fmt::Result {
    let (head, token) = (head(vehicle), token(vehicle));
    writeln!(xml, "<fmiModelDescription fmiVersion=\"3.0\" instantiationToken=\"{token}\" {head}>")?;
    writeln!(
        xml,
        "  <CoSimulation modelIdentifier=\"{MODEL_IDENTIFIER}\" canHandleVariableCommunicationStepSize=\"true\" \
         canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\"/>"
    )?;
    units(xml)?;
    writeln!(xml, "  <DefaultExperiment startTime=\"0\" stepSize=\"{step_s}\"/>\n  <ModelVariables>")?;
    for (reference, variable) in table.iter().enumerate() {
        let kind = match variable.kind {
            Kind::Real => "Float64",
            Kind::Integer => "Int32",
            Kind::Boolean => "Boolean",
        };
        writeln!(
            xml,
            "    <{kind} name=\"{}\" valueReference=\"{reference}\" {} description=\"{}\"{}/>",
            variable.name,
            properties(variable),
            escaped(variable.text),
            unit_and_start(variable, variable.causality == Causality::Output)
        )?;
    }
    writeln!(xml, "  </ModelVariables>\n  <ModelStructure>")?;
    for element in ["Output", "InitialUnknown"] {
        for reference in outputs(table) {
            writeln!(xml, "    <{element} valueReference=\"{reference}\"/>")?;
        }
    }
    writeln!(xml, "  </ModelStructure>\n</fmiModelDescription>")
}

fn units(xml: &mut String) -> std::fmt::Result {
    writeln!(xml, "  <UnitDefinitions>")?;
    for (name, exponents, factor, offset) in UNITS.iter().filter(|(name, ..)| !name.is_empty()) {
        write!(xml, "    <Unit name=\"{name}\"><BaseUnit")?;
        for (base, exponent) in
            ["kg", "m", "s", "rad", "K"].iter().zip(exponents).filter(|(_, exponent)| **exponent != 0)
        {
            write!(xml, " {base}=\"{exponent}\"")?;
        }
        if *factor != 1.0 {
            write!(xml, " factor=\"{factor}\"")?;
        }
        if *offset != 0.0 {
            write!(xml, " offset=\"{offset}\"")?;
        }
        writeln!(xml, "/></Unit>")?;
    }
    writeln!(xml, "  </UnitDefinitions>")
}

fn properties(variable: &Variable) -> String {
    let varies = if variable.kind == Kind::Real { "continuous" } else { "discrete" };
    match variable.causality {
        Causality::Independent => "causality=\"independent\" variability=\"continuous\"".to_owned(),
        Causality::Parameter => "causality=\"parameter\" variability=\"fixed\"".to_owned(),
        Causality::Input => format!("causality=\"input\" variability=\"{varies}\""),
        Causality::Output => format!("causality=\"output\" variability=\"{varies}\" initial=\"calculated\""),
    }
}

/// A calculated variable has no start, time neither.
fn unit_and_start(variable: &Variable, is_calculated: bool) -> String {
    let unit = if variable.unit.is_empty() { String::new() } else { format!(" unit=\"{}\"", variable.unit) };
    if is_calculated || variable.causality == Causality::Independent {
        return unit;
    }
    let start = match variable.kind {
        Kind::Boolean => (variable.start > 0.5).to_string(),
        Kind::Real | Kind::Integer => format!("{}", variable.start),
    };
    format!("{unit} start=\"{start}\"")
}

fn outputs(table: &[Variable]) -> impl Iterator<Item = usize> + '_ {
    table
        .iter()
        .enumerate()
        .filter(|(_, variable)| variable.causality == Causality::Output)
        .map(|(place, _)| place)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
