//! Tracks from a road profile: OpenCRG, text or Parquet.

use itpms_analysis::roughness::{
    Enveloping, EvenProfile, RoughnessTable, SurveyError, SurveyOptions, TrackRoughness, TrackSurvey,
    WheelSurvey,
};
use itpms_console::Failure;
use itpms_data::Problem;
use itpms_data::crg::CrgRoad;
use itpms_data::profile::RoadProfile;

use super::Found;
use crate::args::RoughnessArgs;

/// A survey holds all waves that its points can.
const LONGEST_WAVE_M: f64 = 1000.0;
/// Points per wave that a density can be read from.
const POINTS_PER_WAVE: f64 = 2.5;

pub(super) fn survey(args: &RoughnessArgs) -> Result<Found, Failure> {
    let crg = args.input.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("crg"));
    if crg { from_crg(args) } else { from_table(args) }
}

fn no_vehicle(args: &RoughnessArgs) -> Failure {
    let path = args.input.display();
    Failure::Usage(format!(
        "{path}: looks like a drive log, whose road has to be estimated: expected --vehicle V.toml"
    ))
}

fn from_crg(args: &RoughnessArgs) -> Result<Found, Failure> {
    let road = CrgRoad::read(&args.input)?;
    let refuse = |why: String| Failure::Usage(format!("{}: {why}", args.input.display()));
    let names: &[&str] = match args.lateral_m.as_slice() {
        [_] => &["road"],
        [_, _] => &["left", "right"],
        more => return Err(refuse(format!("--lateral-m has {} places, expected 1 or 2", more.len()))),
    };
    let mut warnings = Vec::new();
    let mut tracks = Vec::new();
    for (name, v_m) in names.iter().zip(&args.lateral_m) {
        let heights = road.line_m(*v_m).map_err(|error| refuse(error.to_string()))?;
        let even = EvenProfile::of_even(road.start_m(), road.increment_m(), heights);
        remark_holes(name, &even, &mut warnings);
        tracks.push(((*name).to_owned(), track(args, &even)?));
    }
    let places: Vec<String> =
        names.iter().zip(&args.lateral_m).map(|(name, v)| format!("{name} at {v:+} m")).collect();
    let length_m = (road.rows() - 1) as f64 * road.increment_m();
    let about = format!("{length_m:.1} m by {} m, {}", road.increment_m(), places.join(", "));
    Ok(Found::of_table(about, RoughnessTable::new(args.segment_m, tracks), warnings))
}

fn from_table(args: &RoughnessArgs) -> Result<Found, Failure> {
    let profile = RoadProfile::read(&args.input).map_err(|error| match *error.problem {
        Problem::DriveLog => no_vehicle(args),
        _ => error.into(),
    })?;
    let mut warnings = Vec::new();
    if profile.rows_left_out > 0 {
        warnings.push(format!("{} rows no farther than the one before left out", profile.rows_left_out));
    }
    let mut tracks = Vec::new();
    for road in &profile.tracks {
        let roughness = if road.is_wheel() {
            wheel(args, &profile, &road.height_m)?
        } else {
            let even = EvenProfile::new(&profile.distance_m, &road.height_m)
                .map_err(|error| Failure::Usage(format!("{}: {error}", args.input.display())))?;
            remark_holes(road.name, &even, &mut warnings);
            if even.spacing_m > 0.3 {
                let spacing =
                    format!("heights {:.2} m apart, expected 0.3 m or less (ASTM E1926)", even.spacing_m);
                warnings.push(format!("{}: {spacing}: short waves are missed", road.name));
            }
            track(args, &even)?
        };
        tracks.push((road.name.to_owned(), roughness));
    }
    let x = &profile.distance_m;
    let about = format!("{:.1} m, {} points", x[x.len() - 1] - x[0], x.len());
    Ok(Found::of_table(about, RoughnessTable::new(args.segment_m, tracks), warnings))
}

fn remark_holes(name: &str, even: &EvenProfile, warnings: &mut Vec<String>) {
    let missing = even.heights_m.iter().filter(|z| !z.is_finite()).count();
    if even.bridged > 0 {
        warnings
            .push(format!("{name}: {} missing heights bridged, in holes of 0.25 m or less", even.bridged));
    }
    if missing > 0 {
        let length = missing as f64 * even.spacing_m;
        warnings.push(format!("{name}: {length:.1} m without a height, in holes of more than 0.25 m"));
    }
}

fn refused(args: &RoughnessArgs, error: SurveyError) -> Failure {
    Failure::Usage(format!("{}: {error}", args.input.display()))
}

fn track(args: &RoughnessArgs, even: &EvenProfile) -> Result<TrackRoughness, Failure> {
    let mut survey = TrackSurvey::new(SurveyOptions {
        origin_m: even.start_m,
        segment_m: args.segment_m,
        spacing_m: even.spacing_m,
        enveloping: Enveloping::MovingAverage,
        sampling: even.sampling,
    })
    .map_err(|error| refused(args, error))?;
    let waves_m = (POINTS_PER_WAVE * even.spacing_m, LONGEST_WAVE_M);
    for (i, height_m) in even.heights_m.iter().enumerate() {
        survey.push(even.start_m + i as f64 * even.spacing_m, *height_m, waves_m);
    }
    Ok(survey.finish())
}

/// The road that an estimate has left: a wheel has felt it, at a speed.
fn wheel(args: &RoughnessArgs, profile: &RoadProfile, height_m: &[f64]) -> Result<TrackRoughness, Failure> {
    let (x, t) = (&profile.distance_m, &profile.time_s);
    let Some(rate_hz) = profile.rate_hz() else {
        let path = args.input.display();
        return Err(Failure::Usage(format!("{path}: the road under a wheel needs time_s beside distance_m")));
    };
    let mut survey = WheelSurvey::new(args.segment_m, rate_hz).map_err(|error| refused(args, error))?;
    for i in 0..x.len() {
        let from = i.saturating_sub(1);
        let to = from + 1;
        survey.push(t[i], x[i], height_m[i], (x[to] - x[from]) / (t[to] - t[from]));
    }
    Ok(survey.finish())
}
