//! Roads against the standard's spectrum, through the public face.

use std::f64::consts::{PI, SQRT_2, TAU};
use std::io::{Write as _, stderr};

use itpms_sim::road::{
    Amplitude, Iso8608, Line, Pothole, ProfileSpec, REFERENCE_CYCLES_PER_M, Road, RoadClass, RoadSpec,
    Roughness, Segment, Segments, Side, Step, Surface, Tracks, coherence,
};

const SPACING_M: f64 = 0.01;

fn heights(spec: &RoadSpec, side: Side, seed: u64, from_m: f64, count: usize) -> Vec<f64> {
    let mut road = Road::new(spec, side, seed, 0.005).unwrap();
    (0..count).map(|i| road.height_m(from_m + i as f64 * SPACING_M)).collect()
}

/// One-sided Welch spectrum: Hann windows of `n` points, half overlapped, means taken out.
pub(crate) fn welch(x: &[f64], n: usize, spacing: f64) -> Vec<f64> {
    let forward = itpms_fourier::forward(n);
    let window: Vec<f64> = (0..n).map(|i| 0.5 - 0.5 * (TAU * i as f64 / n as f64).cos()).collect();
    let power: f64 = window.iter().map(|w| w * w).sum();
    let (mut sum, mut count) = (vec![0.0; n / 2], 0.0);
    for segment in x.windows(n).step_by(n / 2) {
        let mean = segment.iter().sum::<f64>() / n as f64;
        let mut windowed: Vec<f64> = segment.iter().zip(&window).map(|(x, w)| (x - mean) * w).collect();
        let mut bins = forward.make_output_vec();
        forward.process(&mut windowed, &mut bins).unwrap();
        sum.iter_mut().zip(&bins).for_each(|(s, b)| *s += 2.0 * b.norm_sqr() * spacing / power);
        count += 1.0;
    }
    sum.into_iter().map(|s| s / count).collect()
}

/// Level at 0.1 cycle/m relative to `iso` and slope, by least squares on the logarithms, bins 0.1 to 10 cycles/m
/// weighted by 1/k so that every octave counts alike.
fn fit(spectrum: &[f64], n: usize, iso: &Iso8608) -> (f64, f64) {
    let bin = 1.0 / (n as f64 * SPACING_M);
    let (mut s, mut sx, mut sy, mut sxx, mut sxy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (k, g) in spectrum.iter().enumerate() {
        let f = k as f64 * bin;
        if !(0.1..=10.0).contains(&f) {
            continue;
        }
        let (weight, x, y) = (1.0 / k as f64, (f / REFERENCE_CYCLES_PER_M).ln(), (g / iso.psd_m3(f)).ln());
        s += weight;
        sx += weight * x;
        sy += weight * y;
        sxx += weight * x * x;
        sxy += weight * x * y;
    }
    let slope = (s * sxy - sx * sy) / (s * sxx - sx * sx);
    (((sy - slope * sx) / s).exp(), iso.slope - slope)
}

#[test]
fn the_spectrum_is_the_standards_line() {
    // 12.8 km, so that most of it lies beyond the first block and 12 fades are in it; segments of 82 m.
    let n = 8192;
    for (class, slope) in [(RoadClass::A, 2.14), (RoadClass::C, 1.6), (RoadClass::B, 2.6)] {
        let iso = Iso8608::new(class, slope);
        let spec = RoadSpec::iso8608(class, slope);
        let x = heights(&spec, Side::Left, 11, -50.0, 1_280_000);
        let spectrum = welch(&x, n, SPACING_M);
        let (level, fitted) = fit(&spectrum, n, &iso);
        // About 310 segments, half of them independent, and 100 decades-weighted bins: a per cent or two.
        assert!((level - 1.0).abs() < 0.05, "class {class}, w {slope}: level {level}");
        assert!((fitted - slope).abs() < 0.05, "class {class}, w {slope}: slope {fitted}");
        // And octave by octave; the lowest has 8 bins of 160 independent segments, sd 3 %.
        for octave in 0..6 {
            let (from, to) = (8 << octave, 16 << octave);
            let bin = 1.0 / (n as f64 * SPACING_M);
            let ratio = (from..to).map(|k| spectrum[k] / iso.psd_m3(k as f64 * bin)).sum::<f64>()
                / (to - from) as f64;
            assert!((ratio - 1.0).abs() < 0.1, "class {class}, w {slope}, octave {octave}: {ratio}");
        }
    }
}

#[test]
fn increments_are_gaussian_and_the_same_where_blocks_meet() {
    // Increments over 2 m: with w = 2 independent of each other. Block 0 counts alone up to 573 m and fades into block 1 until 901 m.
    for from_m in [200.0, 580.0] {
        let (count, mut square, mut fourth) = (1200.0, 0.0, 0.0);
        for seed in 0..8 {
            let spec = RoadSpec::iso8608(RoadClass::A, 2.0);
            for pair in heights(&spec, Side::Left, seed, from_m, 30_001)
                .chunks(200)
                .take(151)
                .collect::<Vec<_>>()
                .windows(2)
            {
                let d = pair[1][0] - pair[0][0];
                square += d * d / count;
                fourth += d.powi(4) / count;
            }
        }
        // Structure function of Gd n0² n^-2: 2 π² Gd n0² d. Sd of the variance sqrt(2/1200) = 4 %, of the kurtosis sqrt(24/1200) = 0.14.
        let expected = 2.0 * PI * PI * 16e-8 * 2.0;
        assert!((square / expected - 1.0).abs() < 0.16, "{from_m} m: {}", square / expected);
        assert!((fourth / (square * square) - 3.0).abs() < 0.5, "{from_m} m: {}", fourth / (square * square));
    }
}

#[test]
fn seeds_and_sides_are_independent_roads() {
    let spec = RoadSpec::iso8608(RoadClass::B, 2.0);
    let slopes = |side, seed| -> Vec<f64> {
        heights(&spec, side, seed, 0.0, 20_001).windows(2).map(|w| w[1] - w[0]).collect()
    };
    let correlation = |a: &[f64], b: &[f64]| {
        let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
        dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()
    };
    let left = slopes(Side::Left, 1);
    assert_eq!(left, slopes(Side::Left, 1));
    // White slopes: sd 1/sqrt(20000) = 0.007.
    assert!(correlation(&left, &slopes(Side::Right, 1)).abs() < 0.03);
    assert!(correlation(&left, &slopes(Side::Left, 2)).abs() < 0.03);
}

#[test]
fn a_road_can_be_read_backwards_and_from_anywhere() {
    let spec = RoadSpec::iso8608(RoadClass::A, 2.0);
    let mut there = Road::new(&spec, Side::Left, 4, 0.005).unwrap();
    let mut back = there.clone();
    let x = [-60.0, 0.0, 0.0037, 500.0, 1500.0, 10_000.123, 99_999.9];
    let up: Vec<f64> = x.iter().map(|&x| there.height_m(x)).collect();
    let down: Vec<f64> = x.iter().rev().map(|&x| back.height_m(x)).collect();
    assert!(up.iter().zip(down.iter().rev()).all(|(a, b)| (a - b).abs() < 1e-12));
    assert!(up.iter().all(|h| h.is_finite()));
}

#[test]
fn a_test_beds_segment_repeats_without_a_seam() {
    let period = 20.0 / 3.6 * 0.66;
    let iso = Iso8608 { repeat_every_m: Some(period), ..Iso8608::new(RoadClass::B, 2.0) };
    let spec = RoadSpec { surface: Surface::Iso8608(iso.clone()), ..RoadSpec::default() };
    let mut road = Road::new(&spec, Side::Left, 9, 0.005).unwrap();
    let mut square = 0.0;
    for i in 0..1000 {
        let x = f64::from(i) * period / 1000.0;
        let h = road.height_m(x);
        square += h * h / 1000.0;
        let later = road.height_m(x + 5.0 * period);
        // A period is a whole number of nodes: what remains is the rounding of the distance.
        assert!((h - later).abs() < 1e-13, "{x}: {h} {later}");
    }
    // Harmonics of the period up to the grid's limit: variance Σ Gd(k/L)/L, mostly in the first: a factor of 10 is
    // the 99.9 % range of a handful of exponential powers.
    let expected: f64 = (1..600).map(|k| iso.psd_m3(f64::from(k) / period) / period).sum();
    assert!(square / expected > 0.1 && square / expected < 10.0);
}

#[test]
fn obstacles_lie_on_the_tracks_they_name() {
    let spec = RoadSpec {
        pothole: vec![Pothole { at_m: 5.0, length_m: 0.5, depth_m: 0.03, edge_m: 0.1, tracks: Tracks::Left }],
        step: vec![Step { at_m: 8.0, height_m: 0.01, edge_m: 0.05, tracks: Tracks::Both }],
        contact_length_m: 0.1,
        ..RoadSpec::default()
    };
    let mut left = Road::new(&spec, Side::Left, 1, 0.005).unwrap();
    let mut right = Road::new(&spec, Side::Right, 1, 0.005).unwrap();
    assert!((left.height_m(5.25) + 0.03).abs() < 1e-9 && right.height_m(5.25).abs() < 1e-9);
    assert!((left.height_m(30.0) - 0.01).abs() < 1e-9 && (right.height_m(30.0) - 0.01).abs() < 1e-9);
    // In the middle of its edge a step is half as high, averaged or not; 5 cm before it the tire feels it, the point not.
    assert!((left.contact_height_m(8.025) - 0.005).abs() < 1e-5);
    assert!(left.height_m(7.99).abs() < 1e-9 && left.contact_height_m(7.99) > 5e-5);
}

#[test]
fn a_contact_length_takes_away_short_waves() {
    // Moving average over L: |sinc|². The ratio of the spectra at 2 cycles/m with L = 0.25 m: (sin(π/2)/(π/2))² = 0.405.
    let spec = RoadSpec { contact_length_m: 0.25, ..RoadSpec::iso8608(RoadClass::A, 2.0) };
    let mut road = Road::new(&spec, Side::Left, 2, 0.005).unwrap();
    let (point, contact): (Vec<f64>, Vec<f64>) = (0..100_000)
        .map(|i| f64::from(i) * SPACING_M)
        .map(|x| (road.height_m(x), road.contact_height_m(x)))
        .unzip();
    let n = 4096;
    let (point, contact) = (welch(&point, n, SPACING_M), welch(&contact, n, SPACING_M));
    // The same road in both, so the ratio hardly scatters; 1.95 to 2.05 cycles/m is bins 80 to 84.
    let ratio = (80..=84).map(|k| contact[k] / point[k]).sum::<f64>() / 5.0;
    assert!((ratio / (2.0 / PI).powi(2) - 1.0).abs() < 0.03, "{ratio}");
}

#[test]
fn fixed_amplitudes_make_every_road_equally_rough() {
    let iso = Iso8608 { amplitude: Amplitude::Fixed, ..Iso8608::new(Roughness::from(50e-6), 2.0) };
    let spec = RoadSpec { surface: Surface::Iso8608(iso), ..RoadSpec::default() };
    // The first half of a period of 1310.72 m, twice: its mean square of slopes hardly depends on the seed.
    let rough = |seed| -> f64 {
        heights(&spec, Side::Left, seed, 0.0, 50_000).windows(2).map(|w| (w[1] - w[0]).powi(2)).sum()
    };
    assert!((rough(1) / rough(2) - 1.0).abs() < 0.05);
}

#[test]
fn a_surveyed_road_is_read_and_extended() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/profile_1.txt");
    if !path.exists() {
        // Output of the macros in a test that passes is not shown.
        stderr().write_all(b"skipped: no ../shared/data/profile_1.txt\n").unwrap();
        return;
    }
    let profile = ProfileSpec { file: Some(path.clone()), ..ProfileSpec::default() };
    let spec = RoadSpec { surface: Surface::Profile(profile), ..RoadSpec::default() };
    let mut road = Road::new(&spec, Side::Left, 1, 0.005).unwrap();
    // At its stations the road is the file, but for the line through its ends (taken from the file's own text).
    let text = std::fs::read_to_string(path).unwrap();
    let points: Vec<(f64, f64)> = text
        .lines()
        .filter_map(|l| l.split_once(char::is_whitespace))
        .map(|(s, e)| (s.parse().unwrap(), e.trim().parse().unwrap()))
        .collect();
    let (first, last) = (points[0], points[points.len() - 1]);
    let grade = (last.1 - first.1) / (last.0 - first.0);
    for &(station, elevation) in points.iter().step_by(97) {
        let x = station - first.0;
        let expected = elevation - first.1 - grade * x;
        assert!((road.height_m(x) - expected).abs() < 1e-9, "{station}");
        assert!((road.height_m(x + last.0 - first.0) - expected).abs() < 1e-6, "{station}, second time");
    }
}

#[test]
fn bad_roads_are_refused_with_the_fields_name() {
    let error = |spec: &RoadSpec| Road::new(spec, Side::Left, 1, 0.005).unwrap_err().to_string();
    let steep = error(&RoadSpec::iso8608(RoadClass::A, -1.0));
    assert_eq!(steep, "surface.iso8608.slope is -1, expected a number from 0.5 to 4");
    assert!(error(&RoadSpec::iso8608(f64::NAN, 2.0)).starts_with("surface.iso8608.roughness is NaN"));
    let empty = RoadSpec { surface: Surface::Profile(ProfileSpec::default()), ..RoadSpec::default() };
    assert_eq!(error(&empty), "0 points, expected at least 4");
}

/// Welch cross-spectrum of two profiles over their own spectra: the real part of the coherence by bin, and the spectra.
fn welch_coherence(a: &[f64], b: &[f64], n: usize) -> Vec<f64> {
    let sum: Vec<f64> = a.iter().zip(b).map(|(a, b)| a + b).collect();
    let [saa, sbb, scc] = [a, b, &sum].map(|x| welch(x, n, SPACING_M));
    // |A + B|² = |A|² + |B|² + 2 Re A B*.
    (0..n / 2).map(|k| 0.5 * (scc[k] - saa[k] - sbb[k]) / (saa[k] * sbb[k]).sqrt()).collect()
}

#[test]
fn tracks_and_offsets_are_as_coherent_as_on_an_isotropic_surface() {
    // 5 km, segments of 41 m, half overlapped: 120 independent ones, so a coherence of 0 has an sd of 0.065 per bin.
    let (count, n) = (500_000, 4096);
    let segments = Surface::Segments(Segments {
        list: vec![Segment { length_m: 1e5, roughness: RoadClass::B.into(), slope: 1.8 }],
        after_last: itpms_sim::road::AfterLast::Hold,
        amplitude: Amplitude::Gaussian,
    });
    let segmented = RoadSpec { surface: segments, ..RoadSpec::default() };
    for (spec, w) in [(RoadSpec::iso8608(RoadClass::B, 2.14), 2.14), (segmented, 1.8)] {
        let along = |line: Line| -> Vec<f64> {
            let mut road = Road::along(&spec, line, 5, 0.005).unwrap();
            (0..count).map(|i| road.height_m(i as f64 * SPACING_M)).collect()
        };
        let [left, right] = [Side::Left, Side::Right].map(|side| Line::of_track(side, 1.55));
        let [on_left, on_right] = [left, right].map(along);
        let (beside_left, beside_right) = (along(left.beside(0.02)), along(right.beside(0.1)));
        let bin = 1.0 / (n as f64 * SPACING_M);
        for (a, b, distance_m) in
            [(&on_left, &on_right, 1.55), (&on_left, &beside_left, 0.02), (&on_right, &beside_right, 0.1)]
        {
            let found = welch_coherence(a, b, n);
            // Means over half octaves, 0.1 to 10 cycles/m; the lowest has two bins.
            let mut from = 0.1;
            while from < 10.0 {
                let bins: Vec<usize> =
                    (1..n / 2).filter(|&k| (from..SQRT_2 * from).contains(&(k as f64 * bin))).collect();
                let mean =
                    |f: &dyn Fn(usize) -> f64| bins.iter().map(|&k| f(k)).sum::<f64>() / bins.len() as f64;
                let got = mean(&|k| found[k]);
                let expected = mean(&|k| coherence(k as f64 * bin, distance_m, w));
                // sd of a coherence: (1 - γ²)/sqrt(2 * 120) per bin, less with more bins; the window's leakage adds some.
                let sd = (1.0 - expected * expected) / (240.0 * bins.len() as f64).sqrt();
                let error = (got - expected).abs();
                assert!(error < 4.0 * sd + 0.01, "w {w}, {distance_m} m, {from}: {got} {expected}");
                from *= SQRT_2;
            }
        }
        // Every line is a road of the spectrum itself.
        let iso = Iso8608::new(RoadClass::B, w);
        for line in [&on_right, &beside_left, &beside_right] {
            let (level, slope) = fit(&welch(line, n, SPACING_M), n, &iso);
            assert!((level - 1.0).abs() < 0.06 && (slope - w).abs() < 0.05, "w {w}: {level} {slope}");
        }
    }
}
