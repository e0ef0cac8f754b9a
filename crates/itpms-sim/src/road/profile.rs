//! A surveyed road profile: points read from a text file or given, made into a smooth and endless road.
//!
//! Called by the surfaces and by roughness studies. Before it is continued, the profile's straight line is taken
//! out; whether it is put back is the scenario's choice.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::spline::Spline;
use crate::error::ProfileError;
use crate::text_file::read_text;

/// Bytes of a profile, at most: 1000 km, surveyed every 2 cm, have less.
const LARGEST: u64 = 1 << 30;

/// How a profile goes on beyond its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Extension {
    /// Starts again: the line through its two ends is taken out first, so that there is no step.
    #[default]
    Repeat,
    /// Runs back and forth: no step whatever its ends.
    Mirror,
    /// Stays level at its ends.
    Hold,
}

/// Treatment of a profile's linear trend.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Trend {
    /// Left out: the road starts and stays near zero. No accelerometer can tell the difference.
    #[default]
    Remove,
    /// Kept: a hill goes on climbing for ever.
    Keep,
}

/// A surveyed profile as written in a scenario: from a file, or from points if no file is named.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ProfileSpec {
    /// Text file of `station elevation` lines in m; relative to the scenario's file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
    /// Points `[station in m, elevation in m]`, used when no file is named.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub points_m: Vec<[f64; 2]>,
    /// How it goes on beyond its ends.
    pub extend: Extension,
    /// Treatment of its linear trend.
    pub trend: Trend,
}

impl ProfileSpec {
    pub(crate) fn load(&self) -> Result<MeasuredProfile, ProfileError> {
        match &self.file {
            Some(path) => MeasuredProfile::new(&read_points(path)?, self.extend, self.trend),
            None => MeasuredProfile::new(&self.points_m, self.extend, self.trend),
        }
    }
}

/// A surveyed profile as a function of the distance from its first station.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredProfile {
    length_m: f64,
    /// Residual of the line.
    residual: Spline,
    intercept_m: f64,
    grade: f64,
    extend: Extension,
    trend: Trend,
}

impl MeasuredProfile {
    /// From `[station_m, elevation_m]` points with increasing stations.
    /// Errors: fewer than four points, a value that is not finite, or stations that do not increase.
    pub fn new(points_m: &[[f64; 2]], extend: Extension, trend: Trend) -> Result<Self, ProfileError> {
        let first = match points_m {
            [first, _, _, _, ..] => first[0],
            _ => return Err(ProfileError::TooFewPoints { found: points_m.len() }),
        };
        for (i, p) in points_m.iter().enumerate() {
            if !(p[0].is_finite() && p[1].is_finite()) {
                return Err(ProfileError::NotFinite { row: i + 1 });
            }
            if i > 0 && !(p[0] > points_m[i - 1][0]) {
                return Err(ProfileError::NotIncreasing {
                    row: i + 1,
                    found: p[0],
                    previous: points_m[i - 1][0],
                });
            }
        }
        let x: Vec<f64> = points_m.iter().map(|p| p[0] - first).collect();
        let mut y: Vec<f64> = points_m.iter().map(|p| p[1]).collect();
        let length_m = x[x.len() - 1];
        let (intercept_m, grade) = match extend {
            Extension::Repeat => (y[0], (y[y.len() - 1] - y[0]) / length_m),
            Extension::Mirror | Extension::Hold => least_squares(&x, &y),
        };
        y.iter_mut().zip(&x).for_each(|(y, x)| *y -= intercept_m + grade * x);
        Ok(Self { length_m, residual: Spline::natural(x, y), intercept_m, grade, extend, trend })
    }

    /// From a text file: two columns, station and elevation in m, parted by blanks, tabs, commas or semicolons;
    /// empty lines, lines that start with `#` and one heading are skipped. Errors: the file cannot be read, or names its first bad line.
    pub fn from_file(path: &Path, extend: Extension, trend: Trend) -> Result<Self, ProfileError> {
        Self::new(&read_points(path)?, extend, trend)
    }

    /// Distance in m from the first station to the last.
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    /// Height in m at a distance in m from the first station.
    pub fn height_m(&self, distance_m: f64) -> f64 {
        let within = match self.extend {
            Extension::Repeat => distance_m.rem_euclid(self.length_m),
            Extension::Mirror => {
                let there_and_back = distance_m.rem_euclid(2.0 * self.length_m);
                there_and_back.min(2.0 * self.length_m - there_and_back)
            }
            Extension::Hold => distance_m.clamp(0.0, self.length_m),
        };
        let line = match self.trend {
            Trend::Remove => 0.0,
            Trend::Keep if self.extend == Extension::Hold => self.intercept_m + self.grade * within,
            Trend::Keep => self.intercept_m + self.grade * distance_m,
        };
        line + self.residual.value(within)
    }
}

/// Intercept and slope of the least-squares line.
fn least_squares(x: &[f64], y: &[f64]) -> (f64, f64) {
    let n = x.len() as f64;
    let (x_mean, y_mean) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let (mut s_xx, mut s_xy) = (0.0, 0.0);
    for (x, y) in x.iter().zip(y) {
        s_xx += (x - x_mean) * (x - x_mean);
        s_xy += (x - x_mean) * (y - y_mean);
    }
    let slope = s_xy / s_xx;
    (y_mean - slope * x_mean, slope)
}

fn read_points(path: &Path) -> Result<Vec<[f64; 2]>, ProfileError> {
    let text =
        read_text(path, LARGEST).map_err(|source| ProfileError::Read { path: path.to_path_buf(), source })?;
    let mut points = Vec::new();
    let mut heading_allowed = true;
    for (i, line) in text.lines().enumerate() {
        let content = line.trim().trim_start_matches('\u{feff}');
        if content.is_empty() || content.starts_with('#') {
            continue;
        }
        let mut numbers = content
            .split(|c: char| c.is_whitespace() || c == ',' || c == ';')
            .filter(|word| !word.is_empty())
            .map(str::parse::<f64>);
        match (numbers.next(), numbers.next()) {
            (Some(Ok(station)), Some(Ok(elevation))) => points.push([station, elevation]),
            _ if heading_allowed => {}
            _ => {
                let found = content.chars().take(40).collect();
                return Err(ProfileError::Line { path: path.to_path_buf(), line: i + 1, found });
            }
        }
        heading_allowed = false;
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wave of 2 m on a slope of 1 %, every 0.25 m over 10 m, from station 478.
    fn points() -> Vec<[f64; 2]> {
        (0..=40).map(|i| f64::from(i) * 0.25).map(|x| [478.0 + x, 583.0 + 0.01 * x + wave(x)]).collect()
    }

    fn wave(x: f64) -> f64 {
        0.005 * (std::f64::consts::PI * x).sin()
    }

    #[test]
    fn between_its_points_a_profile_is_smooth() {
        let p = MeasuredProfile::new(&points(), Extension::Repeat, Trend::Keep).unwrap();
        for i in 0..1000 {
            let x = f64::from(i) * 0.01;
            // Cubic spline: 5/384 h^4 max|y''''| = 5/384 0.25^4 0.005 π^4 = 2.5e-5 m.
            assert!((p.height_m(x) - 583.0 - 0.01 * x - wave(x)).abs() < 2.5e-5, "{x}");
        }
        assert!((p.length_m() - 10.0).abs() < 1e-12);
    }

    #[test]
    fn repeated_it_joins_and_climbs_or_stays() {
        let stay = MeasuredProfile::new(&points(), Extension::Repeat, Trend::Remove).unwrap();
        let climb = MeasuredProfile::new(&points(), Extension::Repeat, Trend::Keep).unwrap();
        assert!((stay.height_m(9.999_999) - stay.height_m(10.000_001)).abs() < 1e-6);
        for x in [0.3, 4.6, 9.9] {
            assert!((stay.height_m(x) - stay.height_m(x - 20.0)).abs() < 1e-12);
            assert!((climb.height_m(x + 10.0) - climb.height_m(x) - 0.1).abs() < 1e-12);
            assert!((stay.height_m(x) - wave(x)).abs() < 2.5e-5);
        }
    }

    #[test]
    fn mirrored_it_runs_back() {
        let p = MeasuredProfile::new(&points(), Extension::Mirror, Trend::Remove).unwrap();
        for x in [0.3, 4.6, 9.9] {
            assert!((p.height_m(10.0 + x) - p.height_m(10.0 - x)).abs() < 1e-12);
            assert!((p.height_m(-x) - p.height_m(x)).abs() < 1e-12);
        }
        let hold = MeasuredProfile::new(&points(), Extension::Hold, Trend::Keep).unwrap();
        assert!((hold.height_m(50.0) - 583.1).abs() < 1e-9 && (hold.height_m(-5.0) - 583.0).abs() < 1e-9);
    }

    #[test]
    fn files_are_read_and_bad_lines_named() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("road.txt");
        std::fs::write(&path, "station;elevation\n# survey\n0;1.0\n0.25, 1.1\n0.5\t1.2\n0.75 1.1 extra\n")
            .unwrap();
        let p = MeasuredProfile::from_file(&path, Extension::Hold, Trend::Keep).unwrap();
        assert!((p.height_m(0.25) - 1.1).abs() < 1e-12);
        std::fs::write(&path, "0 1\n0.25 x\n").unwrap();
        let e = MeasuredProfile::from_file(&path, Extension::Hold, Trend::Keep).unwrap_err().to_string();
        assert!(e.ends_with("line 2: found `0.25 x`, expected a station and an elevation in m"), "{e}");
        let missing = MeasuredProfile::from_file(&dir.path().join("no"), Extension::Hold, Trend::Keep);
        assert!(matches!(missing, Err(ProfileError::Read { .. })));
    }

    #[test]
    fn bad_points_are_refused() {
        let new = |p: &[[f64; 2]]| MeasuredProfile::new(p, Extension::Repeat, Trend::Remove).unwrap_err();
        assert!(matches!(new(&[[0.0, 0.0]; 3]), ProfileError::TooFewPoints { found: 3 }));
        let backwards = new(&[[0.0, 0.0], [1.0, 0.0], [0.5, 0.0], [2.0, 0.0]]);
        assert!(matches!(backwards, ProfileError::NotIncreasing { row: 3, .. }));
        let nan = new(&[[0.0, 0.0], [1.0, f64::NAN], [1.5, 0.0], [2.0, 0.0]]);
        assert!(matches!(nan, ProfileError::NotFinite { row: 2 }));
    }
}
