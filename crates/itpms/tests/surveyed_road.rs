//! Ten minutes on a road that was surveyed, not generated: its spectrum follows no power law that an estimator
//! could have been built for. Back and forth over 544 m at 60 to 90 km/h, 500 Hz, noise 0.05 m/s².
//!
//! The road's points lie 0.25 m apart with a cubic spline between, so that below half a meter it is smoother
//! than any real one. That is a hard case: an estimator that reads stiffness from roughness sees it as another spectrum.

use std::fmt;
use std::io::{Write as _, stderr};
use std::path::{Path, PathBuf};

use crate::common::{Bench, table};

/// Nothing is asked of the first half minute, and of the half minute after a loss.
const SETTLE_S: f64 = 30.0;
const DRIVE_S: f64 = 600.0;
const LOSS_AT_S: f64 = 300.0;
const LOSS_TAKES_S: f64 = 2.5;
/// 95 % is what the band promises; ten minutes hold some fifteen independent estimates (the estimator forgets
/// within 40 s), of which one outside is chance. Two would be 87 %.
const SHARE_INSIDE: f64 = 0.9;

/// `None` where it is not, which is reported on the stream itself: what the macros print in a test that passes is not shown.
fn surveyed_profile() -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/profile_1.txt");
    if !path.exists() {
        stderr().write_all(b"skipped: no ../shared/data/profile_1.txt\n").unwrap();
        return None;
    }
    Some(path.canonicalize().unwrap())
}

/// How the estimates of a stretch of the drive compare with the truth.
struct Stretch {
    share_inside: f64,
    bias_kpa: f64,
    rmse_kpa: f64,
}

impl fmt::Display for Stretch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { share_inside, bias_kpa, rmse_kpa } = self;
        write!(f, "{share_inside:.3} of the time inside, bias {bias_kpa:+.1} kPa, RMSE {rmse_kpa:.1} kPa")
    }
}

fn stretch(est: &str, truth_kpa: f64, from_s: f64, to_s: f64) -> Stretch {
    let (_, rows) = table(est);
    let (mut n, mut inside, mut sum, mut squares) = (0.0, 0.0, 0.0, 0.0);
    for row in &rows {
        let value = |i: usize| row[i].parse::<f64>().unwrap();
        if !(from_s..to_s).contains(&value(0)) {
            continue;
        }
        let error = value(1) - truth_kpa;
        n += 1.0;
        inside += f64::from(u8::from(error.abs() <= 1.96 * value(2)));
        sum += error;
        squares += error * error;
    }
    Stretch { share_inside: inside / n, bias_kpa: sum / n, rmse_kpa: f64::sqrt(squares / n) }
}

/// The estimates of a drive over the surveyed road with these points of time and pressure.
fn drive(profile: &Path, points_s_kpa: &str, seed: u64) -> String {
    let speeds: Vec<_> = (0..=15).map(|i| format!("[{}.0, {:?}]", i * 40, [60.0, 90.0][i % 2])).collect();
    let bench = Bench::new();
    bench.write(
        "survey.toml",
        format!(
            "name = \"survey\"\ndescription = \"a surveyed road\"\nduration_s = {DRIVE_S:?}\nrate_hz = 500.0\n\
             [speed]\npoints_s_km_h = [{}]\n\
             [road]\nsurface.profile = {{ file = {profile:?}, extend = \"mirror\" }}\n\
             [sensor]\nnoise_m_s2 = 0.05\n\
             [corner.fl]\npressure.points_s_kpa = [{points_s_kpa}]\n",
            speeds.join(", ")
        ),
    );
    bench
        .run(&format!("-q simulate survey.toml --seed {seed} -o drive.csv --vehicle-out car.toml"))
        .success();
    bench.run("-q estimate drive.csv --vehicle car.toml -o est.csv").success();
    bench.read("est.csv")
}

fn warned_at_s(est: &str) -> Option<f64> {
    table(est).1.iter().find(|row| row[5] == "low").map(|row| row[0].parse().unwrap())
}

/// 241.3 kPa is the placard; the other two are 17 % below it and 16 % above.
#[test]
fn a_constant_pressure_is_inside_its_own_band() {
    let Some(profile) = surveyed_profile() else { return };
    for (pressure_kpa, seed) in [(241.3, 1), (200.0, 2), (280.0, 3)] {
        let est = drive(&profile, &format!("[0.0, {pressure_kpa:?}]"), seed);
        let held = stretch(&est, pressure_kpa, SETTLE_S, DRIVE_S);
        println!("{pressure_kpa} kPa: {held}");
        assert!(held.share_inside >= SHARE_INSIDE, "{pressure_kpa} kPa: {held}");
        if pressure_kpa >= 241.3 {
            assert_eq!(warned_at_s(&est), None, "{pressure_kpa} kPa: nothing is wrong");
        }
    }
}

#[test]
fn after_a_loss_of_a_fifth_the_new_pressure_is_inside_its_band_and_warned_of() {
    let Some(profile) = surveyed_profile() else { return };
    for (before_kpa, seed) in [(241.3, 1), (220.0, 2), (200.0, 3)] {
        let after_kpa = 0.8 * before_kpa;
        let lost_at_s = LOSS_AT_S + LOSS_TAKES_S;
        let points = format!("[{LOSS_AT_S:?}, {before_kpa:?}], [{lost_at_s:?}, {after_kpa:?}]");
        let est = drive(&profile, &points, seed);
        let before = stretch(&est, before_kpa, SETTLE_S, LOSS_AT_S);
        let after = stretch(&est, after_kpa, lost_at_s + SETTLE_S, DRIVE_S);
        let warned = warned_at_s(&est);
        println!("{before_kpa} kPa: {before}\n  then {after_kpa:.1}: {after}, low at {warned:?} s");
        assert!(before.share_inside >= SHARE_INSIDE, "{before_kpa} kPa: {before}");
        assert!(after.share_inside >= SHARE_INSIDE, "{after_kpa} kPa: {after}");
        // UN R141 grants ten minutes; the drive ends five after the loss.
        assert!(warned.is_some(), "{after_kpa} kPa: low at {warned:?} s");
        // Below 0.88 of the placard a tire is low, and may be warned of, before it loses anything.
        if before_kpa > 0.88 * 241.3 {
            assert!(warned.is_some_and(|at| at > LOSS_AT_S), "{before_kpa} kPa: low at {warned:?} s");
        }
    }
}
