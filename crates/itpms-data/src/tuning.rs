//! Numbers of the monitors that are not their defaults, from a TOML file with a table for each module, and all of them as such a text.

use std::fmt::Write as _;
use std::path::Path;

use itpms_core::{monitor, wheel_speed};
use toml::de::DeTable;

use crate::error::{DataError, FileProblem, Problem};
use crate::toml_table::{Table, syntax_problem};

/// The numbers of a file.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tuning {
    pub monitor: monitor::Tuning,
    /// Of wheel speeds, where any is not its default.
    pub wheel_speed: Option<&'static wheel_speed::Tuning>,
}

/// Reads a file of numbers; what is not in it has its default.
/// Errors: unknown names and numbers that cannot be meant, with the line.
pub fn read(path: &Path) -> Result<Tuning, DataError> {
    let text =
        std::fs::read_to_string(path).map_err(|error| DataError::new(path, FileProblem::Read(error)))?;
    parse(&text).map_err(|problem| DataError::new(path, problem))
}

/// One table of the file into the module's.
macro_rules! take {
    ($root:expr, $name:literal, $tuning:expr) => {
        if let Some(table) = $root.table($name)? {
            let mut known = vec![];
            $tuning.each(|name, _, numbers| known.push((name, numbers.len())));
            table.check_keys(&known.iter().map(|(name, _)| *name).collect::<Vec<_>>())?;
            for (name, count) in known {
                if let Some(numbers) = table.numbers(name, count)?
                    && !$tuning.set(name, &numbers)
                {
                    return Err(table.wrong(name, "no whole number", "one"));
                }
            }
            $tuning.check().map_err(|error| table.refuse(error))?;
        }
    };
}

fn parse(text: &str) -> Result<Tuning, Problem> {
    let file = DeTable::parse(text).map_err(|error| syntax_problem(text, &error))?;
    let root = Table::root(text, file.get_ref());
    root.check_keys(&["decision", "diagnosis", "warning", "wheel_speed"])?;
    let (mut monitor, mut wheel_speed) = (monitor::Tuning::default(), wheel_speed::Tuning::DEFAULT);
    take!(root, "decision", monitor.decision);
    take!(root, "warning", monitor.warning);
    take!(root, "diagnosis", monitor.diagnosis);
    take!(root, "wheel_speed", wheel_speed);
    // Monitors point to them as long as the program runs.
    let is_set = wheel_speed != wheel_speed::Tuning::DEFAULT;
    Ok(Tuning { monitor, wheel_speed: is_set.then(|| &*Box::leak(Box::new(wheel_speed))) })
}

/// All numbers as such a file, each below what it means.
pub fn text(tuning: &Tuning) -> String {
    let mut out = String::new();
    tuning.monitor.decision.each(lines(&mut out, "[decision]"));
    tuning.monitor.warning.each(lines(&mut out, "\n[warning]"));
    tuning.monitor.diagnosis.each(lines(&mut out, "\n[diagnosis]"));
    tuning.wheel_speed.unwrap_or(&wheel_speed::Tuning::DEFAULT).each(lines(&mut out, "\n[wheel_speed]"));
    out
}

fn lines(out: &mut String, table: &str) -> impl FnMut(&'static str, &'static str, &[f64]) {
    out.extend([table, "\n"]);
    |name, meaning, numbers| {
        let _ = match numbers {
            [number] => writeln!(out, "#{meaning}\n{name} = {number:?}"),
            several => writeln!(out, "#{meaning}\n{name} = {several:?}"),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let mut tuning = Tuning::default();
        (tuning.monitor.decision.surely_low, tuning.monitor.warning.low.set_s) = (0.95, 1.0);
        tuning.wheel_speed = Some(&wheel_speed::Tuning { least_days: 5, ..wheel_speed::Tuning::DEFAULT });
        assert_eq!(parse(&text(&tuning)).unwrap(), tuning);
        assert_eq!(parse("").unwrap(), Tuning::default());
        let some = "[warning]\nlow = [1, 10.0]\n[decision]\nsurely_low = 0.95\n[wheel_speed]\nleast_days = 5";
        let one = parse(some).unwrap();
        assert_eq!(one, tuning);
    }

    #[test]
    fn what_cannot_be_meant_is_refused_with_its_line() {
        let sign = "expected a number of the same sign as its default";
        for (text, found, expected) in [
            ("[decision]\nsurely_lo = 0.9", "line 2: unknown key surely_lo in [decision]", "surely_low?"),
            ("[decisions]", "line 1: unknown key decisions in the file", "did you mean decision?"),
            ("[warning]\n\nlow = 2.0", "line 3: [warning] low is of type float", "an array of 2 numbers"),
            ("[warning]\nstanding_s = [2.0]", "line 2: [warning] standing_s is of type array", "a number"),
            ("[warning]\nstanding_s = -2.0", "line 2: [warning] standing_s is -2", sign),
            ("[decision]\nlow = [1.0, nan]", "line 2: [decision] low is NaN", sign),
        ] {
            let problem = parse(text).unwrap_err().to_string();
            assert!(problem.starts_with(found) && problem.contains(expected), "{text:?}: {problem}");
        }
    }
}
