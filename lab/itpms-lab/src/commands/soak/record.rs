//! The file of the hours that were driven: whose hours they are, and what may be added to them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use itpms_console::{Failure, fingerprint};
use itpms_data::out::Ledger;
use itpms_lab::soak::{Hour, Plan};
use serde_json::{Value, json};

/// Key of the lines that say by what program the hours after them were driven.
const KEY: &str = "itpms_soak";

/// Hours of one plan, by seed, in a file that only grows.
pub(super) struct Record {
    path: PathBuf,
    ledger: Ledger,
    /// The line that says what this program's hours are hours of.
    heading: Value,
    hours: BTreeMap<u64, Hour>,
    /// Whether the last of them were driven by this very program.
    own: bool,
}

impl Record {
    /// Opens or begins the file. Hours of another plan are refused.
    pub(super) fn open(path: PathBuf, plan: &Plan) -> Result<Self, Failure> {
        let (ledger, lines) = Ledger::open(&path)?;
        let heading = json!({ KEY: 1, "program": fingerprint()?, "plan": plan });
        let mut record = Self { path, ledger, heading, hours: BTreeMap::new(), own: false };
        for (i, line) in lines.iter().enumerate() {
            record.read(i + 1, line)?;
        }
        if lines.is_empty() {
            record.begin()?;
        }
        Ok(record)
    }

    fn read(&mut self, number: usize, line: &str) -> Result<(), Failure> {
        let found: Value = serde_json::from_str(line).unwrap_or(Value::Null);
        if number == 1 || found.get(KEY).is_some() {
            for (key, what) in [(KEY, KEY), ("plan", "the plan of the hours that are there")] {
                let expected = &self.heading[key];
                if found[key] != *expected {
                    let (path, found) = (self.path.display(), &found[key]);
                    return Err(Failure::Usage(format!(
                        "{path}: line {number}: {what} is {found}, expected {expected}; use another folder"
                    )));
                }
            }
            self.own = found["program"] == self.heading["program"];
            return Ok(());
        }
        let hour = Hour::from_line(line)
            .ok_or_else(|| Failure::Usage(format!("{}: line {number}: not an hour", self.path.display())))?;
        self.hours.insert(hour.seed, hour);
        Ok(())
    }

    /// Says that the hours from here on are this program's.
    fn begin(&mut self) -> Result<(), Failure> {
        self.ledger.append(&self.heading.to_string())?;
        self.own = true;
        Ok(())
    }

    /// Seeds of hours to drive again before this program may add its own: the first and the last, if another build drove
    /// those that are there.
    pub(super) fn doubtful(&self) -> Vec<u64> {
        if self.own {
            return vec![];
        }
        let [first, last] = [self.hours.keys().next(), self.hours.keys().next_back()];
        let mut seeds: Vec<u64> = [first, last].into_iter().flatten().copied().collect();
        seeds.dedup();
        seeds
    }

    /// Takes the hours that were driven again: hours of a program that drives them otherwise, in any digit, are not added to.
    pub(super) fn adopt(&mut self, again: &[Hour]) -> Result<(), Failure> {
        for hour in again {
            // As a line tells it, for that is what it is compared with.
            let reported = Hour::from_line(&hour.to_line()).map(|hour| Hour { wall_s: 0.0, ..hour });
            let kept = self.hours.get(&hour.seed).map(|hour| Hour { wall_s: 0.0, ..hour.clone() });
            if reported.is_none() || reported != kept {
                return Err(Failure::Usage(format!(
                    "{}: another program drove these hours, and this one drives that of seed {} otherwise; use another folder",
                    self.path.display(),
                    hour.seed
                )));
            }
        }
        if self.own { Ok(()) } else { self.begin() }
    }

    pub(super) fn add(&mut self, hour: Hour) -> Result<(), Failure> {
        self.ledger.append(&hour.to_line())?;
        self.hours.insert(hour.seed, hour);
        Ok(())
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn hours(&self) -> &BTreeMap<u64, Hour> {
        &self.hours
    }
}
