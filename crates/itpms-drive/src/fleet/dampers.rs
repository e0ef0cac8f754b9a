//! Dampers over a car's drives: one is reported in the third drive in a row that finds it weak, worn or stiff. One drive alone may be of a road that is like no other;
//! drives that say nothing of dampers neither count nor break a row.

use std::collections::BTreeMap;

use super::record::DriveRecord;

pub(super) const ROW: u32 = 3;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    Less,
    More,
}

/// Adds to each drive, in the order of a car's drives, the dampers that are reported in it.
pub(super) fn judge(drives: &mut [DriveRecord]) {
    let mut rows: BTreeMap<(String, String), (Way, u32)> = BTreeMap::new();
    for drive in drives {
        // A calibration is a new beginning: dampers may have been replaced.
        if drive.taught {
            rows.retain(|(car, _), _| *car != drive.car);
        }
        let mut sentences = Vec::new();
        for wheel in &mut drive.wheels {
            let Some(damper) = &mut wheel.damper else { continue };
            let way = match damper.state.as_str() {
                "weak" | "worn" => Some(Way::Less),
                "stiff" => Some(Way::More),
                "fine" => None,
                _ => continue,
            };
            let key = (drive.car.clone(), wheel.wheel.clone());
            let Some(way) = way else {
                rows.remove(&key);
                continue;
            };
            let row = rows.entry(key).or_insert((way, 0));
            *row = if row.0 == way { (way, row.1 + 1) } else { (way, 1) };
            (damper.row, damper.reported) = (row.1, row.1 >= ROW);
            if damper.reported {
                let does = if way == Way::Less { "less" } else { "more" };
                let now =
                    damper.over_reference.map_or_else(String::new, |over| format!(", {over:.2} of it now"));
                sentences.push(format!(
                    "{}: its damper has damped {does} than after the calibration in {} drives in a row ({}{now}): have it looked at",
                    wheel.wheel, row.1, damper.state
                ));
            }
        }
        drive.alerts.extend(sentences);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fleet::damper_cell::is_reported;
    use crate::fleet::record::sample;

    fn drive(state: &str) -> DriveRecord {
        sample("rl", state, 0.7)
    }

    fn reported(states: &[&str]) -> Vec<bool> {
        let mut drives: Vec<_> = states.iter().map(|state| drive(state)).collect();
        judge(&mut drives);
        let beside = |n: usize| is_reported(&drives[..=n].iter().collect::<Vec<_>>());
        let judged = |n: &usize| drives[*n].wheels[0].damper.as_ref().unwrap().state != "unknown";
        for n in (0..drives.len()).filter(judged) {
            assert_eq!(beside(n), !drives[n].alerts.is_empty(), "the badge of drive {n}");
        }
        drives.iter().map(|drive| !drive.alerts.is_empty()).collect()
    }

    #[test]
    fn a_damper_is_reported_in_the_third_drive_in_a_row() {
        assert_eq!(reported(&["weak", "weak", "worn", "weak"]), [false, false, true, true]);
        // A drive without a verdict does not count; one that is fine, or off the other way, begins the count anew.
        assert_eq!(reported(&["weak", "unknown", "weak", "weak"]), [false, false, false, true]);
        assert_eq!(reported(&["weak", "weak", "fine", "weak", "weak"]), [false; 5]);
        assert_eq!(reported(&["weak", "weak", "stiff", "stiff"]), [false; 4]);
        let mut drives: Vec<_> = ["weak"; 4].map(drive).into();
        drives[2].taught = true;
        judge(&mut drives);
        assert!(drives.iter().all(|drive| drive.alerts.is_empty()));
    }
}
