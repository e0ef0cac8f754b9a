//! Torsional analysis on simulated tooth pulses: as sharp as the spectrum allows, honest, silent where nothing is to be seen.

#[path = "../examples/corner_with_pulses.rs"]
#[allow(dead_code, reason = "the example prints what the test does not need")]
mod corner_with_pulses;

use itpms_core::torsion::{TorsionConfig, TorsionPiece, TorsionWheel};
use itpms_sim::pulses::{PulseSpec, PulseWheel};
use itpms_sim::road::RoadClass;

/// A wheel and its analysis; the teeth are known after a minute and a half.
struct Rolling {
    wheel: PulseWheel,
    analysis: TorsionWheel<f32>,
    time_s: f64,
}

impl Rolling {
    fn new(class: RoadClass, seed: u64, wheel: u64) -> Self {
        let spec = PulseSpec { roughness: class.into(), ..PulseSpec::default() };
        Self {
            wheel: PulseWheel::new(&spec, seed, wheel),
            analysis: TorsionWheel::new(&TorsionConfig::new()).unwrap(),
            time_s: 0.0,
        }
    }

    /// The pieces of so many s at speeds in m/s and pressures in kPa.
    fn on(&mut self, for_s: f64, at: impl Fn(f64) -> (f64, f64)) -> Vec<TorsionPiece<f32>> {
        let mut pieces = vec![];
        let Self { wheel, analysis, .. } = self;
        wheel.roll(for_s, at, |time_s| pieces.extend(analysis.push(time_s)));
        self.time_s += for_s;
        pieces
    }

    fn calibrate(&mut self, for_s: f64, at: impl Fn(f64) -> (f64, f64) + Copy) {
        self.on(90.0, at);
        self.analysis.begin_calibration();
        self.on(for_s, at);
        assert!(self.analysis.end_calibration());
        // Another day begins with it, whatever was rounded on the way.
        let mut later = TorsionWheel::new(&TorsionConfig::new()).unwrap();
        assert!(later.load_calibration(&self.analysis.calibration().unwrap()));
    }
}

#[test]
fn a_resonance_is_read_as_sharply_as_its_spectrum_allows() {
    // Cramér and Rao's bounds of the same model in kPa √s at 24 to 75 Hz: the spectrum's shape known but for its level, and level, slope and
    // curvature free. Between the two lies what a learned shape allows; the goal is 110.
    for (km_h, known, free) in [(50.0, 65.4, 115.6), (70.0, 47.0, 123.6), (90.0, 47.9, 164.9)] {
        let (mut square, mut reported, mut inside, mut number, mut shift_hz) = (0.0, 0.0, 0, 0, 0.0);
        for seed in 0..4 {
            let mut rolling = Rolling::new(RoadClass::B, seed, 0);
            rolling.calibrate(600.0, |_| (km_h / 3.6, 240.0));
            let [full, low] = [240.0, 192.0].map(|kpa| rolling.on(450.0, |_| (km_h / 3.6, kpa)));
            assert!(full.len() >= 14 && full.iter().all(|piece| piece.used), "{km_h} {full:?}");
            shift_hz += 0.25 * (mean_hz(&full) - mean_hz(&low));
            for piece in &full {
                let away = f64::from(piece.resonance_hz) - mean_hz(&full);
                let sd = f64::from(piece.resonance_sd_hz);
                (square, reported) = (square + away * away, reported + sd * sd);
                inside += i32::from(away.abs() < 1.96 * sd);
                number += 1;
            }
        }
        let number = f64::from(number);
        let root = |sum: f64| (sum / number).sqrt() / (shift_hz / 48.0) * 30f64.sqrt();
        let (reached, reported) = (root(square), root(reported));
        let seen = format!(
            "{km_h} km/h: {reached:.0} kPa √s, said {reported:.0}, {:.2} inside, {shift_hz:.2} Hz for a fifth",
            f64::from(inside) / number
        );
        println!("{seen}");
        // Sixty pieces: 9 % of a standard deviation (one sd).
        assert!(reached > 0.8 * known && reached < f64::min(free, 110.0), "{seen}");
        assert!(
            reported > 0.9 * reached && reported < 1.5 * reached && f64::from(inside) > 0.93 * number,
            "{seen}"
        );
    }
}

fn mean_hz(pieces: &[TorsionPiece<f32>]) -> f64 {
    pieces.iter().map(|p| f64::from(p.resonance_hz)).sum::<f64>() / pieces.len() as f64
}

#[test]
fn a_fifth_lost_by_all_four_is_found_within_half_an_hour_and_nothing_else() {
    // 14 to 26 m/s, a minute's leak of each wheel's own fifth after 25 minutes of calibration and 5 more.
    let speed_m_s = |time_s: f64| 20.0 + 5.5 * (time_s / 95.0).sin() + 0.5 * (time_s / 15.0).sin();
    for (seed, loss) in [(1, 0.2), (2, 0.2), (3, 0.0), (4, 0.0)] {
        let mut wheels: Vec<Rolling> = (0..4).map(|wheel| Rolling::new(RoadClass::B, seed, wheel)).collect();
        for wheel in &mut wheels {
            wheel.calibrate(1500.0, |time_s| (speed_m_s(time_s), 240.0));
        }
        let begun_s = wheels[0].time_s + 300.0;
        let pressure = |time_s: f64| 240.0 * (1.0 - loss * ((time_s - begun_s) / 60.0).clamp(0.0, 1.0));
        let mut found_s = None;
        while found_s.is_none() && wheels[0].time_s < begun_s + 60.0 + 1800.0 {
            let (mut mean, mut variance) = (0.0, 0.0);
            for wheel in &mut wheels {
                wheel.on(30.0, |time_s| (speed_m_s(time_s), pressure(time_s)));
                let change = wheel.analysis.change().unwrap();
                mean += 0.25 * f64::from(change.change_kpa);
                variance += 0.25 * f64::from(change.change_sd_kpa).powi(2);
            }
            // As if all errors were common: the mean of four is known no better than one. Surely more than 6 % of 240 kPa.
            if mean + 1.645 * variance.sqrt() < -0.06 * 240.0 {
                found_s = Some(wheels[0].time_s - begun_s - 60.0);
            }
        }
        println!("seed {seed}: a loss of {loss} found after {found_s:?} s");
        assert_eq!(found_s.is_some(), loss > 0.0, "seed {seed}: {found_s:?}");
        assert!(found_s.is_none_or(|s| s > -60.0), "seed {seed}: {found_s:?}");
    }
}

#[test]
fn a_smooth_road_at_low_speed_is_refused_and_lost_teeth_are_no_pieces() {
    let mut rolling = Rolling::new(RoadClass::A, 5, 0);
    let pieces = rolling.on(300.0, |_| (30.0 / 3.6, 240.0));
    assert!(!pieces.is_empty() && pieces.iter().all(|piece| !piece.used), "{pieces:?}");
    // Every thousandth edge lost: the ring is never known.
    let (mut analysis, mut wheel, mut edges) = (
        TorsionWheel::<f32>::new(&TorsionConfig::new()).unwrap(),
        PulseWheel::new(&PulseSpec::default(), 6, 0),
        0,
    );
    wheel.roll(
        120.0,
        |_| (20.0, 240.0),
        |time_s| {
            edges += 1;
            assert!(edges % 1000 == 0 || analysis.push(time_s).is_none());
        },
    );
}

#[test]
fn teeth_are_found_where_they_are() {
    let mut rolling = Rolling::new(RoadClass::B, 7, 0);
    // Fifteen minutes: at 20 m/s a wheel hops once a turn, and only the hops' phase parts them from the teeth.
    rolling.on(900.0, |_| (20.0, 240.0));
    let (found, truth) = (rolling.analysis.tooth_errors(), rolling.wheel.tooth_errors());
    assert_eq!(found.len(), 48);
    let apart = |shift: usize| -> f64 {
        let square = |i: usize| (f64::from(found[i]) - truth[(i + shift) % 48]).powi(2);
        ((0..48).map(square).sum::<f64>() / 48.0).sqrt()
    };
    let best = (0..48).map(apart).fold(f64::INFINITY, f64::min);
    // Of 3e-3 pitches a tenth: what edges vary by from turn to turn.
    assert!(best < 3e-4, "{best}");
}

/// A car whose wheels are 5 % lighter than its file says reads some 16 kPa too high by its accelerations; its pulses know nothing of that.
#[test]
fn pulses_know_the_level_that_a_file_does_not() {
    let [alone, with_pulses] = corner_with_pulses::drive(0.95, 4).unwrap();
    for (alone, with_pulses) in alone.iter().zip(&with_pulses) {
        let ([rms, sd, _], [joined_rms, joined_sd, inside]) = (alone.figures(), with_pulses.figures());
        assert!(joined_rms < 0.8 * rms && joined_sd < 0.85 * sd, "{rms} {joined_rms}, {sd} {joined_sd}");
        assert!(inside > 0.95, "{inside}");
    }
}
