//! The list of tests: which regulation, which wheels or which fault.

use itpms_core::model::{Corner, Wheels};
use itpms_sim::fault::FaultPlace;

use super::rules::Rule;
use super::test_case::{Failure, Test};
use crate::sensors::Sensors;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// Every wheel, every combination that a regulation names, every sensor.
    Full,
    Quick,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Procedure {
    pub rule: Rule,
    pub test: Test,
}

const PLACES: [FaultPlace; 2] = [FaultPlace::Wheel, FaultPlace::Body];

impl Procedure {
    pub fn all(extent: Extent, sensors: Sensors) -> Vec<Self> {
        let every = Rule::ALL.into_iter().flat_map(|rule| Self::of_rule(rule, sensors));
        match extent {
            Extent::Full => every.collect(),
            Extent::Quick => every.filter(|procedure| procedure.is_quick()).collect(),
        }
    }

    fn of_rule(rule: Rule, sensors: Sensors) -> Vec<Self> {
        let lows: Vec<Wheels> = match (rule, sensors) {
            (Rule::UnR141, Sensors::Accelerations) => Corner::ALL.map(Wheels::from).to_vec(),
            // One to three of four; all four follow. R141 asks for one: what wheel speeds show of several is driven, too.
            _ => combinations(),
        };
        let mut tests: Vec<Test> = lows.into_iter().map(Test::Low).collect();
        tests.push(Test::LowAll);
        if sensors.are_of_wheels() {
            return tests.into_iter().map(|test| Self { rule, test }).collect();
        }
        let sensors = || Corner::ALL.into_iter().flat_map(|corner| PLACES.map(|place| (corner, place)));
        tests.extend(sensors().map(|(corner, place)| Test::Malfunction(Failure::Unplugged(corner, place))));
        tests.push(Test::Malfunction(Failure::Stuck(Corner::FrontRight, FaultPlace::Wheel)));
        tests.push(Test::Malfunction(Failure::Stuck(Corner::RearLeft, FaultPlace::Body)));
        tests.push(Test::Malfunction(Failure::Exchanged(Corner::FrontLeft, Corner::FrontRight)));
        tests.into_iter().map(|test| Self { rule, test }).collect()
    }

    /// One wheel in front for the one and in the rear for the other regulation, all four, one unplugged sensor.
    fn is_quick(&self) -> bool {
        match self.test {
            Test::Low(wheels) => {
                let corner = if self.rule == Rule::UnR141 { Corner::FrontLeft } else { Corner::RearRight };
                wheels == corner.into()
            }
            Test::LowAll => true,
            Test::Malfunction(failure) => failure == Failure::Unplugged(Corner::RearLeft, FaultPlace::Wheel),
        }
    }

    pub(super) fn number(&self, sensors: Sensors) -> u64 {
        Self::all(Extent::Full, sensors).iter().position(|other| other == self).map_or(0, |i| i as u64)
    }

    /// A name for files and for `--only`: `un-r141-puncture-fl`, `fmvss-138-low-fl-rr`, `un-r141-unplugged-rl-wheel`.
    pub fn name(&self) -> String {
        let rule = self.rule.label().to_lowercase().replace(' ', "-");
        let test = match (self.rule, self.test) {
            (Rule::UnR141, Test::Low(wheels)) => format!("puncture-{wheels}"),
            (Rule::Fmvss138, Test::Low(wheels)) => format!("low-{wheels}"),
            (Rule::UnR141, Test::LowAll) => "diffusion".to_owned(),
            (Rule::Fmvss138, Test::LowAll) => "low-all".to_owned(),
            (_, Test::Malfunction(failure)) => failure.name(),
        };
        format!("{rule}-{}", test.replace(' ', "-"))
    }

    pub fn text(&self) -> String {
        match (self.rule, self.test) {
            (Rule::UnR141, Test::Low(wheels)) => format!("puncture: {wheels}"),
            (Rule::Fmvss138, Test::Low(wheels)) => format!("low: {wheels}"),
            (Rule::UnR141, Test::LowAll) => "diffusion: all four".to_owned(),
            (Rule::Fmvss138, Test::LowAll) => "low: all four".to_owned(),
            (_, Test::Malfunction(failure)) => format!("malfunction: {}", failure.text()),
        }
    }

    pub fn low_wheels(&self) -> Wheels {
        match self.test {
            Test::Low(wheels) => wheels,
            Test::LowAll => Corner::ALL.into_iter().collect(),
            Test::Malfunction(_) => Wheels::NONE,
        }
    }

    /// The wheels that a warning may name.
    pub fn concerned(&self) -> Wheels {
        match self.test {
            Test::Malfunction(Failure::Unplugged(corner, _) | Failure::Stuck(corner, _)) => corner.into(),
            Test::Malfunction(Failure::Exchanged(a, b)) => Wheels::from(a) | b.into(),
            _ => self.low_wheels(),
        }
    }
}

/// One to three of the wheels, fewer ones first.
fn combinations() -> Vec<Wheels> {
    let mut sets: Vec<u8> = (1..15).collect();
    sets.sort_by_key(|bits| (bits.count_ones(), *bits));
    let wheels = |bits: u8| Corner::ALL.into_iter().filter(move |corner| bits & (1 << corner.index()) != 0);
    sets.into_iter().map(|bits| wheels(bits).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn the_list_has_every_wheel_and_every_combination_under_a_name_of_its_own() {
        let all = Procedure::all(Extent::Full, Sensors::Accelerations);
        let names: BTreeSet<String> = all.iter().map(Procedure::name).collect();
        assert_eq!(names.len(), all.len());
        let count = |part: &str| names.iter().filter(|name| name.contains(part)).count();
        // Four wheels; of four wheels, one to four: 2^4 - 1; of eight sensors each.
        assert_eq!((count("r141-puncture"), count("r141-diffusion"), count("138-low")), (4, 1, 15));
        assert_eq!((count("r141-unplugged"), count("138-unplugged")), (8, 8));
        let quick = Procedure::all(Extent::Quick, Sensors::Accelerations);
        assert_eq!(quick.len(), 6);
        assert!(
            quick
                .iter()
                .all(|procedure| all[procedure.number(Sensors::Accelerations) as usize] == *procedure)
        );
    }
}
