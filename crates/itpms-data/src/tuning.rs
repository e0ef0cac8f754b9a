//! Numbers of the monitor that are not their defaults, from a TOML file with a table for each module, and all of them as such a text.

use std::fmt::Write as _;
use std::path::Path;

use itpms_core::monitor::Tuning;
use toml::de::DeTable;

use crate::error::{DataError, FileProblem, Problem};
use crate::toml_table::{Table, syntax_problem};

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
    root.check_keys(&["decision", "diagnosis", "warning"])?;
    let mut tuning = Tuning::default();
    take!(root, "decision", tuning.decision);
    take!(root, "warning", tuning.warning);
    take!(root, "diagnosis", tuning.diagnosis);
    Ok(tuning)
}

/// All numbers as such a file, each below what it means.
pub fn text(tuning: &Tuning) -> String {
    let mut out = String::from("[decision]\n");
    tuning.decision.each(lines(&mut out));
    out.push_str("\n[warning]\n");
    tuning.warning.each(lines(&mut out));
    out.push_str("\n[diagnosis]\n");
    tuning.diagnosis.each(lines(&mut out));
    out
}

fn lines(out: &mut String) -> impl FnMut(&'static str, &'static str, &[f64]) {
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
        (tuning.decision.surely_low, tuning.warning.low.set_s) = (0.95, 1.0);
        assert_eq!(parse(&text(&tuning)).unwrap(), tuning);
        assert_eq!(parse("").unwrap(), Tuning::default());
        let one = parse("[warning]\nlow = [1, 10.0]\n[decision]\nsurely_low = 0.95").unwrap();
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
