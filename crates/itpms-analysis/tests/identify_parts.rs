//! Identification of springs, dampers and tires: known answers, what is reported beside them, what is refused.

use crate::part_bench;

use std::fmt::Write as _;

use itpms_analysis::identify::{
    DamperResult, ErrorBasis, IdentifyError, SineRecord, SpringResult, Units, calibrate, damper, spring,
};
use part_bench::{COLORED, DAMPING_N_S_PER_M, DamperTest, Dice, Noise, SPRING_N_PER_M, Sine, SpringTest};

const SILENT: Noise = Noise { white_n: 0.0, slow_n: 0.0, slow_s: 1.0 };

fn identified(test: &SpringTest, seed: u64) -> SpringResult {
    let (x, load) = test.record(seed);
    spring(&x, &load, Units::Checked).unwrap()
}

fn assert_begins(text: &str, beginning: &str) {
    assert!(text.starts_with(beginning), "{text}");
}

fn assert_concern(concerns: &[String], beginning: &str) {
    assert!(concerns.iter().any(|concern| concern.starts_with(beginning)), "{concerns:?}");
}

// --- spring ---

#[test]
fn a_spring_without_noise_is_found_to_the_transducers_resolution() {
    let result = identified(&SpringTest { noise: SILENT, friction_n: 25.0, ..SpringTest::default() }, 1);
    // 5 micrometers in 1200 rows over ±27 mm: 5e-6 / (0.0156 sqrt(1080)) of the stiffness is 0.2 N/m.
    assert!((result.stiffness_n_per_m.value - SPRING_N_PER_M).abs() < 0.8, "{:?}", result.stiffness_n_per_m);
    let friction = result.friction_n.unwrap();
    assert!((friction.value - 25.0).abs() < 0.05, "{friction:?}");
    assert!((result.load_at_zero_n - 600.0).abs() < 0.05);
    assert_eq!(result.strokes, 10);
    assert!(result.concerns.is_empty(), "{:?}", result.concerns);
}

#[test]
fn either_sign_gives_the_same_spring() {
    let (x, load) = SpringTest::default().record(3);
    let straight = spring(&x, &load, Units::Checked).unwrap();
    let against: Vec<f64> = load.iter().map(|load| -load).collect();
    let opposite = spring(&x, &against, Units::Checked).unwrap();
    assert!(!straight.opposite_signs && opposite.opposite_signs);
    let (a, b) = (straight.stiffness_n_per_m, opposite.stiffness_n_per_m);
    assert!((a.value - b.value).abs() < 1e-6 && (a.standard_error - b.standard_error).abs() < 1e-6);
    let (a, b) = (straight.friction_n.unwrap(), opposite.friction_n.unwrap());
    assert!((a.value - b.value).abs() < 1e-9 && a.value > 20.0);
}

#[test]
fn a_bend_is_reported_with_its_size() {
    // Load k x (1 + 0.05 x/X): 5 % of a parabola. Its largest distance from its best line is 2/3 of the coefficient, of
    // a range of two: 1.7 %; the ends that are left out take a fifth of that.
    let result = identified(&SpringTest { progressive: 0.1, ..SpringTest::default() }, 5);
    let bend = result.nonlinearity.unwrap();
    assert!(bend.significant && (1.3..1.8).contains(&bend.percent), "{bend:?}");
    // Tangents: k (1 + 0.1 u) at u = -0.95, 0, 0.95 or a little within.
    for (tangent, share) in bend.tangent_n_per_m.iter().zip([0.906, 1.0, 1.094]) {
        assert!((tangent / SPRING_N_PER_M - share).abs() < 0.01, "{bend:?}");
    }
    assert_begins(&result.concerns[0], "not a straight line: 1.");
    let straight = identified(&SpringTest::default(), 5).nonlinearity.unwrap();
    assert!(straight.percent < 0.1, "{straight:?}");
}

#[test]
fn a_table_of_weights_is_enough_and_says_what_it_lacks() {
    // Ordinary least squares by hand: x = 0 ... 0.05, residuals +1, -1, -1, +1, 0, 0 N have no slope against x... almost:
    // the sums are taken below with the textbook's formulas.
    let x: Vec<f64> = (0..6).map(|i| 0.01 * f64::from(i)).collect();
    let errors = [1.0, -1.0, -1.0, 1.0, 0.5, -0.5];
    let load: Vec<f64> = x.iter().zip(errors).map(|(x, e)| 20_000.0 * x + e).collect();
    let result = spring(&x, &load, Units::Checked).unwrap();
    let mean = 0.025;
    let s_xx: f64 = x.iter().map(|x| (x - mean) * (x - mean)).sum();
    let k: f64 = x.iter().zip(&load).map(|(x, f)| (x - mean) * f).sum::<f64>() / s_xx;
    let f_mean = load.iter().sum::<f64>() / 6.0;
    let squares: f64 = x.iter().zip(&load).map(|(x, f)| (f - f_mean - k * (x - mean)).powi(2)).sum();
    // Student's t with 4 degrees of freedom: 2.7764.
    let standard_error = (squares / 4.0 / s_xx).sqrt() * 2.7764 / 1.959_96;
    assert!((result.stiffness_n_per_m.value - k).abs() < 1e-6);
    assert!((result.stiffness_n_per_m.standard_error / standard_error - 1.0).abs() < 1e-4);
    assert_eq!(result.error_basis, ErrorBasis::Independent);
    assert!(result.friction_n.is_none());
    assert_begins(&result.concerns[0], "only 1 stroke");
    assert_begins(&result.concerns[1], "one direction only");
}

#[test]
fn a_loop_that_runs_backwards_is_noticed() {
    let (mut x, mut load) = SpringTest::default().record(2);
    x.reverse();
    load.reverse();
    let result = spring(&x, &load, Units::Checked).unwrap();
    assert_concern(&result.concerns, "the loop runs backwards");
}

#[test]
fn springs_that_cannot_be_identified_are_refused_with_the_reason() {
    let (x, load) = SpringTest::default().record(1);
    let refused = |x: &[f64], load: &[f64]| spring(x, load, Units::Checked).unwrap_err().to_string();
    let times = |values: &[f64], factor: f64| values.iter().map(|v| v * factor).collect::<Vec<_>>();
    assert_eq!(refused(&x[..4], &load[..4]), "found 4 rows, expected at least 6");
    assert_eq!(refused(&x[..9], &load[..8]), "columns of 9 and 8 rows, expected equal lengths");
    assert_eq!(refused(&[0.02; 50], &load[..50]), "displacement_m is constant (0.02)");
    assert_eq!(refused(&x[..50], &[700.0; 50]), "load_n is constant (700)");
    assert!(refused(&times(&x, 1e3), &load).ends_with("expected at most 1 m; it looks like millimetres"));
    assert!(refused(&x, &times(&load, 1e-3)).ends_with("the load looks like kN"));
    let mut broken = load.clone();
    broken[16] = f64::NAN;
    assert_eq!(refused(&x, &broken), "row 17 of load_n is not finite");
    let clipped: Vec<f64> = load.iter().map(|load| load.min(900.0)).collect();
    let text = refused(&x, &clipped);
    assert!(
        text.starts_with("load_n looks clipped: ") && text.contains("exactly 900, its maximum"),
        "{text}"
    );
    let mut dice = Dice::new(4);
    let noise: Vec<f64> = x.iter().map(|_| 100.0 * dice.normal()).collect();
    assert_begins(&refused(&x, &noise), "the stiffness is not distinguishable from zero");
    // The user knows better.
    assert!(spring(&times(&x, 1e3), &load, Units::Trusted).is_ok());
}

// --- damper ---

fn identify(sines: &[Sine], spring: Option<f64>) -> Result<DamperResult, IdentifyError> {
    let records: Vec<SineRecord<'_>> = sines
        .iter()
        .map(|(t, x, force)| SineRecord { name: "sine", time_s: t, displacement_m: x, force_n: force })
        .collect();
    damper(&records, spring, Units::Checked)
}

#[test]
fn a_damper_its_friction_and_the_spring_beside_it_are_found() {
    let test = DamperTest { spring_n_per_m: SPRING_N_PER_M, ..DamperTest::default() };
    let sines = test.records(7);
    let result = identify(&sines, Some(SPRING_N_PER_M)).unwrap();
    assert!(result.damping_n_s_per_m.deviation(DAMPING_N_S_PER_M).abs() < 3.0, "{result:?}");
    assert!((result.friction_n.value - 15.0).abs() < 0.5, "{:?}", result.friction_n);
    assert!(result.concerns.is_empty(), "{:?}", result.concerns);
    for (run, (frequency, amplitude, periods)) in result.runs.iter().zip(&test.sines) {
        assert!((run.frequency_hz / frequency - 1.0).abs() < 1e-4, "{}", run.frequency_hz);
        assert!((run.amplitude_m / amplitude - 1.0).abs() < 1e-2);
        assert_eq!(run.periods, *periods);
        // A square wave of friction adds 4 f / (pi omega X) to the damping (docs/math/identification.md, eq. 13); turning
        // round within 0.2 mm takes a per cent of that away.
        let square = 4.0 * 15.0 / (std::f64::consts::PI * run.velocity_m_s);
        let expected = DAMPING_N_S_PER_M + square;
        assert!((run.equivalent_n_s_per_m - expected).abs() < 0.04 * square + 3.0, "{run:?}");
    }
}

#[test]
fn the_sign_of_the_force_does_not_matter_but_the_springs_must_agree() {
    let test = DamperTest { spring_n_per_m: SPRING_N_PER_M, ..DamperTest::default() };
    let sines = test.records(8);
    let turned = |factor: f64| -> Vec<Sine> {
        sines.iter().map(|(t, x, f)| (t.clone(), x.clone(), f.iter().map(|f| factor * f).collect())).collect()
    };
    let straight = identify(&sines, Some(SPRING_N_PER_M)).unwrap();
    let opposite = identify(&turned(-1.0), Some(SPRING_N_PER_M)).unwrap();
    assert!(opposite.opposite_signs && !straight.opposite_signs);
    assert!((straight.damping_n_s_per_m.value - opposite.damping_n_s_per_m.value).abs() < 1e-6);
    assert!((straight.friction_n.value - opposite.friction_n.value).abs() < 1e-6);
    // Time backwards: the spring pulls as it did, the damper pushes.
    let backwards: Vec<Sine> = sines
        .iter()
        .map(|(t, x, f)| (t.clone(), x.iter().rev().copied().collect(), f.iter().rev().copied().collect()))
        .collect();
    let error = identify(&backwards, Some(SPRING_N_PER_M)).unwrap_err();
    let text = error.to_string();
    let damping: f64 = text.split(' ').nth(3).unwrap().parse().unwrap();
    assert!(text.starts_with("the damping is -") && damping < -400.0, "{error}");
}

#[test]
fn bump_and_rebound_are_told_apart() {
    let test = DamperTest { asymmetry: 1.0, noise: COLORED, ..DamperTest::default() };
    let result = identify(&test.records(2), None).unwrap();
    // One to two with a mean of 435.2.
    let (bump, rebound) = (435.2 * 2.0 / 3.0, 435.2 * 4.0 / 3.0);
    assert!(result.rising_n_s_per_m.deviation(bump).abs() < 3.0, "{:?}", result.rising_n_s_per_m);
    assert!(result.falling_n_s_per_m.deviation(rebound).abs() < 3.0, "{:?}", result.falling_n_s_per_m);
    assert_concern(&result.concerns, "bump and rebound differ");
}

#[test]
fn a_damper_that_is_not_linear_is_called_so() {
    let agree = |exponent: f64, seed: u64| {
        let test = DamperTest { exponent, ..DamperTest::default() };
        identify(&test.records(seed), None).unwrap().consistency.unwrap().p
    };
    assert!(agree(0.8, 1) < 1e-4, "{}", agree(0.8, 1));
    // A linear one is blamed wrongly once in a hundred seeds; 40 of them may have three.
    let blamed = (0..40).filter(|seed| agree(1.0, *seed) < 0.01).count();
    assert!(blamed <= 3, "{blamed}");
}

#[test]
fn friction_that_is_slow_to_turn_round_is_noticed() {
    // Twenty seeds each; an honest one is suspected at three standard errors, which is next to never.
    let suspected = |turn_m: f64| {
        let test = DamperTest { turn_m, ..DamperTest::default() };
        let suspects = |seed: &u64| {
            let result = identify(&test.records(*seed), None).unwrap();
            result.concerns.iter().any(|c| c.starts_with("friction seems slow to turn round"))
        };
        (0..20).filter(suspects).count()
    };
    assert_eq!(suspected(2e-4), 0);
    // At 1 mm the bias is some 4 standard errors and the second opinion has an error of its own; at 2 mm it is plain.
    assert!(suspected(1e-3) >= 12 && suspected(2e-3) == 20, "{} {}", suspected(1e-3), suspected(2e-3));
}

#[test]
fn frequencies_that_follow_each_other_in_one_record_are_the_same_as_one_by_one() {
    let test = DamperTest::default();
    let sines = test.records(6);
    let apart = identify(&sines, None).unwrap();
    let (mut t, mut x, mut f): Sine = Default::default();
    for (time, displacement, force) in &sines {
        let start = t.last().map_or(0.0, |last| last + 0.005);
        t.extend(time.iter().map(|time| start + time));
        x.extend(displacement);
        f.extend(force);
    }
    let joined = identify(&[(t, x, f)], None).unwrap();
    assert_eq!(joined.runs.len(), 3);
    let (a, b) = (apart.damping_n_s_per_m, joined.damping_n_s_per_m);
    assert!((a.value - b.value).abs() < 3.0 * a.standard_error, "{a:?} {b:?}");
}

#[test]
fn dampers_that_cannot_be_identified_are_refused_with_the_reason() {
    let one = |frequency, amplitude, periods, rate_hz| {
        let test =
            DamperTest { sines: vec![(frequency, amplitude, periods)], rate_hz, ..DamperTest::default() };
        test.records(1).remove(0)
    };
    let refused = |sine: Sine| identify(&[sine], None).unwrap_err().to_string();
    let (t, x, f) = one(2.0, 0.02, 12, 200.0);
    let times = |values: &[f64], factor: f64| values.iter().map(|v| v * factor).collect::<Vec<_>>();
    assert_begins(&refused(one(2.0, 0.02, 4, 200.0)), "the longest stretch of one steady sine has ");
    assert_begins(
        &refused(one(4.0, 0.02, 40, 50.0)),
        "12.5 rows per period at 4.000 Hz, expected at least 20",
    );
    assert_eq!(refused((t.clone(), vec![0.01; t.len()], f.clone())), "displacement_m is constant (0.01)");
    assert!(refused((t.clone(), times(&x, 1e3), f.clone())).ends_with("it looks like millimetres"));
    assert!(refused((times(&t, 1e3), x.clone(), f.clone())).ends_with("time_s looks like milliseconds"));
    assert!(refused((t.clone(), x.clone(), times(&f, 1e-3))).ends_with("the force looks like kN"));
    let clip = |values: &[f64], limit: f64| values.iter().map(|v| v.min(limit)).collect::<Vec<_>>();
    let text = refused((t.clone(), x.clone(), clip(&f, 120.0)));
    assert!(text.starts_with("force_n looks clipped") && text.contains("exactly 120"), "{text}");
    let text = refused((t.clone(), clip(&x, 0.018), f.clone()));
    assert!(text.starts_with("displacement_m looks clipped"), "{text}");
    let mut stuck = t.clone();
    stuck[300] = stuck[299];
    assert_eq!(
        refused((stuck, x.clone(), f.clone())),
        "time_s does not increase at row 301: 1.495 is followed by 1.495"
    );
    let mut dice = Dice::new(1);
    let noise: Vec<f64> = x.iter().map(|_| 50.0 * dice.normal()).collect();
    assert!(
        refused((t.clone(), x.clone(), noise)).starts_with("the damping is not distinguishable from zero")
    );
    let mut broken = f.clone();
    broken[4] = f64::INFINITY;
    assert_eq!(refused((t, x, broken)), "row 5 of force_n is not finite");
}

// --- tire ---

/// Paper, Table 1.
const P: [f64; 5] = [186.2, 213.7, 241.3, 268.9, 296.5];
const K: [f64; 5] = [193_780.0, 213_450.0, 233_350.0, 252_960.0, 272_440.0];

/// Slope, intercept, their standard errors, R², half interval of the slope, band at 200 kPa, p of a parabola, studentized
/// residual of the last row (its distance from the line of the others over that distance's standard error): numpy and scipy.
const TABLE_1: (f64, f64, f64, f64, f64, f64, f64, f64, f64) = (
    713.668293,
    60973.56754,
    1.632341429,
    399.0287119,
    0.999984305639,
    5.194838948,
    295.1773134,
    0.1185265287,
    -2.540657792,
);

#[test]
fn table_1_gives_the_least_squares_line_with_its_errors() {
    // numpy.polyfit and the textbook's formulas in another program.
    let result = calibrate(&P, &K, Units::Checked).unwrap();
    let near =
        |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    near(result.stiffness_per_kpa.value, TABLE_1.0);
    near(result.stiffness_at_zero.value, TABLE_1.1);
    near(result.stiffness_per_kpa.standard_error, TABLE_1.2);
    near(result.stiffness_at_zero.standard_error, TABLE_1.3);
    near(result.r_squared, TABLE_1.4);
    near(result.stiffness_per_kpa.interval_95.1 - result.stiffness_per_kpa.value, TABLE_1.5);
    near(result.band_95_n_per_m(200.0), TABLE_1.6);
    near(result.curvature.unwrap().p, TABLE_1.7);
    near(result.rows[4].studentized.unwrap(), TABLE_1.8);
    assert!(result.lack_of_fit.is_none());
    // The paper's printed values differ by 0.03 % and 0.15 %.
    assert!((result.stiffness_per_kpa.value / 713.91 - 1.0).abs() < 4e-4);
    assert!((result.stiffness_at_zero.value / 60_880.0 - 1.0).abs() < 2e-3);
}

#[test]
fn repeats_show_whether_the_line_fits() {
    // Five tests at each pressure, as in the paper; once on the line, once on a curve.
    let table = |bend: f64, seed: u64| {
        let mut dice = Dice::new(seed);
        let p: Vec<f64> = P.iter().flat_map(|p| [*p; 5]).collect();
        let k =
            p.iter().map(|p| 713.9 * p + 60_880.0 - bend * (p - 241.3) * (p - 241.3) + 300.0 * dice.normal());
        let k: Vec<f64> = k.collect();
        calibrate(&p, &k, Units::Checked).unwrap()
    };
    let straight: Vec<_> = (0..100).map(|seed| table(0.0, seed)).collect();
    // Of a hundred honest tables one fails a test at 1 %; more than five would be a chance of 1 in 1000.
    let failed = |p: &dyn Fn(usize) -> f64| (0..100).filter(|i| p(*i) < 0.01).count();
    assert!(failed(&|i| straight[i].lack_of_fit.unwrap().p) <= 5);
    assert!(failed(&|i| straight[i].curvature.unwrap().p) <= 5);
    // And 95 of them have the true slope in their interval, 88 to 100 by binomial limits.
    let inside = straight
        .iter()
        .filter(|c| (c.stiffness_per_kpa.interval_95.0..=c.stiffness_per_kpa.interval_95.1).contains(&713.9));
    assert!(inside.count() >= 88);
    let bent = table(0.5, 1);
    assert!(bent.lack_of_fit.unwrap().p < 1e-4 && bent.curvature.unwrap().p < 1e-4);
    assert_eq!(bent.concerns.len(), 2, "{:?}", bent.concerns);
}

#[test]
fn a_row_that_stands_out_is_named() {
    let mut dice = Dice::new(3);
    let p: Vec<f64> = P.iter().flat_map(|p| [*p; 3]).collect();
    let mut k: Vec<f64> = p.iter().map(|p| 713.9 * p + 60_880.0 + 200.0 * dice.normal()).collect();
    k[7] += 4_000.0;
    let result = calibrate(&p, &k, Units::Checked).unwrap();
    assert_concern(&result.concerns, "row 8 (241.3 kPa");
}

#[test]
fn tables_that_give_no_line_are_refused_with_the_reason() {
    let refused = |p: &[f64], k: &[f64]| calibrate(p, k, Units::Checked).unwrap_err().to_string();
    let times = |values: &[f64], factor: f64| values.iter().map(|v| v * factor).collect::<Vec<_>>();
    assert_eq!(refused(&P[..2], &K[..2]), "found 2 rows, expected at least 3");
    assert_eq!(refused(&[200.0; 5], &K), "pressure_kpa is constant (200)");
    assert!(refused(&times(&P, 0.145_038), &K).contains("it looks like psi"));
    // 1e300 is not written out in full.
    assert!(refused(&times(&P, 1e300), &K).contains("e302 kPa, expected"));
    assert!(refused(&times(&P, 0.01), &K).contains("it looks like bar"));
    assert!(refused(&times(&P, 1000.0), &K).contains("it looks like Pa"));
    assert!(refused(&P, &times(&K, 1e-3)).contains("it looks like N/mm or kN/m"));
    let falling: Vec<f64> = K.iter().rev().copied().collect();
    assert_begins(&refused(&P, &falling), "stiffness falls with pressure (-713.7 ± ");
    assert_eq!(refused(&[186.2, f64::NAN, 241.3], &K[..3]), "row 2 of pressure_kpa is not finite");
    let steep: Vec<f64> = P.iter().map(|p| 1500.0 * p - 60_000.0).collect();
    assert_begins(&refused(&P, &steep), "the line meets zero pressure at -60000");
}

// --- examples ---

/// Writes the measurements under `examples/identify/`, from which the binary's tests and the documentation start:
/// `cargo test -p itpms-analysis --test all identify_parts -- --ignored`.
#[test]
#[ignore = "writes files"]
fn write_examples() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/identify");
    std::fs::create_dir_all(&folder).unwrap();
    let test = SpringTest { cycles: 3, rate_hz: 5.0, ..SpringTest::default() };
    let (x, load) = test.record(20_663);
    let mut text = String::from(
        "# spring of 20663 N/m, friction 25 N, preload 600 N, noise 2 N rms\ndisplacement_m,load_n\n",
    );
    for (x, load) in x.iter().zip(&load) {
        writeln!(text, "{x:.6},{load:.2}").unwrap();
    }
    std::fs::write(folder.join("load-displacement.csv"), text).unwrap();
    let test = DamperTest {
        sines: vec![(1.0, 0.02, 8), (2.0, 0.02, 10), (4.0, 0.012, 12)],
        rate_hz: 100.0,
        ..DamperTest::default()
    };
    let mut text = String::from(
        "# damper of 435.2 N s/m, friction 15 N, noise 2 N rms\nrun,time_s,displacement_m,force_n\n",
    );
    for (i, (t, x, force)) in test.records(4352).iter().enumerate() {
        for ((t, x), force) in t.iter().zip(x).zip(force) {
            writeln!(text, "{},{t:.2},{x:.6},{force:.2}", i + 1).unwrap();
        }
    }
    std::fs::write(folder.join("sine.csv"), text).unwrap();
    let mut text = String::from(
        "# the paper's Table 1: 225/45R17, each row the mean of five tests\npressure_kpa,stiffness_n_per_m\n",
    );
    for (p, k) in P.iter().zip(K) {
        writeln!(text, "{p},{k}").unwrap();
    }
    std::fs::write(folder.join("tire-tests.csv"), text).unwrap();
}
