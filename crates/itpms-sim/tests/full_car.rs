//! The full car against independent physics: quarter cars, eigenvalues, statics, closed forms.

use std::f64::consts::TAU;

use itpms_core::model::QuarterCar;
use itpms_sim::antialias::AntiAliasSpec;
use itpms_sim::plant::{Body, CarInput, Deviations, FullCar, Load, Plant, StepInput};
use itpms_sim::road::RoadSpec;
use itpms_sim::scenario::Scenario;
use itpms_sim::sensor::SensorSpec;
use itpms_sim::simulation::Simulation;
use itpms_sim::time_profile::Speed;
use nalgebra::{Complex, SMatrix, SVector};

pub(crate) const H: f64 = 1.0 / 4000.0;
const K_T: [f64; 4] = [233_000.0, 220_000.0, 205_000.0, 190_000.0];

/// A lopsided family car.
pub(crate) fn body() -> Body {
    Body {
        mass_kg: 913.6,
        pitch_kg_m2: 913.6 * 1.25 * 1.25,
        roll_kg_m2: 913.6 * 0.62 * 0.62,
        height_m: 0.55,
        struts_m: [[1.277, 0.78], [1.277, -0.76], [-1.423, 0.77], [-1.423, -0.77]],
        antiroll_n_m_per_rad: [20_000.0, 8_000.0],
        bending: None,
    }
}

pub(crate) fn corners() -> [(QuarterCar<f64>, Deviations); 4] {
    let corner = |m_w, c, k| (QuarterCar::new(228.4, m_w, c, k).unwrap(), Deviations::default());
    [
        corner(56.9, 925.8, 29_114.0),
        corner(56.9, 1000.0, 28_000.0),
        corner(50.0, 900.0, 27_000.0),
        corner(50.0, 980.0, 26_000.0),
    ]
}

pub(crate) fn at_rest(road_m: [f64; 4]) -> CarInput {
    CarInput {
        road_m: road_m.map(|r| [r; 3]),
        stiffness_n_per_m: K_T.map(|k| [k; 2]),
        wheel_force_n: [[0.0; 3]; 4],
        car_m_s2: [[0.0; 2]; 3],
    }
}

/// Mass, damping and stiffness matrices in the coordinates of Lagrange's equations, built from the energies by
/// summing over springs and dampers; and which road drives what.
fn matrices() -> [SMatrix<f64, 7, 7>; 3] {
    matrices_of(&body(), &corners(), K_T)
}

fn matrices_of(
    b: &Body,
    cars: &[(QuarterCar<f64>, Deviations); 4],
    k_t: [f64; 4],
) -> [SMatrix<f64, 7, 7>; 3] {
    let mut m = SMatrix::<f64, 7, 7>::zeros();
    let wheel = |i: usize| cars[i].0.unsprung_mass_kg();
    let diagonal = [b.mass_kg, b.pitch_kg_m2, b.roll_kg_m2, wheel(0), wheel(1), wheel(2), wheel(3)];
    m.set_diagonal(&SVector::from(diagonal));
    let (mut c, mut k) = (SMatrix::<f64, 7, 7>::zeros(), SMatrix::<f64, 7, 7>::zeros());
    let mut stretch = [SVector::<f64, 7>::zeros(); 4];
    for i in 0..4 {
        let [x, y] = b.struts_m[i];
        stretch[i] = SVector::from([1.0, -x, y, 0.0, 0.0, 0.0, 0.0]);
        stretch[i][3 + i] = -1.0;
        c += cars[i].0.damping_n_s_per_m() * stretch[i] * stretch[i].transpose();
        k += cars[i].0.spring_n_per_m() * stretch[i] * stretch[i].transpose();
        k[(3 + i, 3 + i)] += k_t[i];
    }
    for axle in 0..2 {
        let twist = (stretch[2 * axle] - stretch[2 * axle + 1])
            / (b.struts_m[2 * axle][1] - b.struts_m[2 * axle + 1][1]);
        k += b.antiroll_n_m_per_rad[axle] * twist * twist.transpose();
    }
    [m, c, k]
}

/// Response of all freedoms to unit sines of the given generalised forces at `f` Hz.
fn response(f: f64, force: SVector<f64, 7>) -> SVector<Complex<f64>, 7> {
    response_of(matrices(), f, force)
}

fn response_of(
    [m, c, k]: [SMatrix<f64, 7, 7>; 3],
    f: f64,
    force: SVector<f64, 7>,
) -> SVector<Complex<f64>, 7> {
    let w = TAU * f;
    let dynamic = (k - m * w * w).map(|x| Complex::new(x, 0.0)) + c.map(|x| Complex::new(0.0, w * x));
    dynamic.lu().solve(&force.map(|x| Complex::new(x, 0.0))).unwrap()
}

/// Acceleration of the struts' tops and of the wheels from that of the freedoms.
fn corner_accelerations(f: f64, x: SVector<Complex<f64>, 7>) -> [[Complex<f64>; 2]; 4] {
    let s_squared = -(TAU * f).powi(2);
    let places = body().struts_m;
    [0, 1, 2, 3].map(|i| {
        let [along, across] = places[i];
        let top = x[0] - x[1] * along + x[2] * across;
        [top * s_squared, x[3 + i] * s_squared]
    })
}

/// Fourier coefficients of the corners' accelerations over whole periods after `settle_s`.
fn simulated(f: f64, settle_s: f64, input: impl Fn(f64) -> CarInput) -> [[Complex<f64>; 2]; 4] {
    let mut car = FullCar::new(&body(), &corners(), [0.0; 4]).unwrap();
    let mut sums = [[Complex::new(0.0, 0.0); 2]; 4];
    let (skip, count) = ((settle_s / H) as usize, (2.0 / H) as usize);
    for i in 0..skip + count {
        car.step(H, &input(i as f64 * H));
        if i < skip {
            continue;
        }
        let turn = Complex::from_polar(2.0 / count as f64, -TAU * f * (i + 1) as f64 * H);
        for (sum, a) in sums.iter_mut().flatten().zip(car.accelerations_m_s2().into_iter().flatten()) {
            // For a = Re(A e^{iwt}).
            *sum += turn * a;
        }
    }
    sums
}

/// Accelerations of body and wheel at each corner, in a sine.
type Lines = [[Complex<f64>; 2]; 4];

pub(crate) fn assert_close(simulated: Lines, exact: Lines, tolerance: f64, what: &str) {
    let largest = exact.iter().flatten().map(|x| x.norm()).fold(0.0, f64::max);
    for (s, e) in simulated.iter().flatten().zip(exact.iter().flatten()) {
        assert!((s - e).norm() < tolerance * largest, "{what}: {s} {e}");
    }
}

#[test]
fn the_transfer_from_each_wheels_road_is_the_linear_systems() {
    for (wheel, f) in [(0, 1.0), (3, 1.5), (1, 5.0), (2, 11.0), (0, 20.0), (3, 60.0)] {
        let got = simulated(f, 10.0, |t| {
            let mut input = at_rest([0.0; 4]);
            input.road_m[wheel] = [0.0, 0.5, 1.0].map(|part| 1e-3 * (TAU * f * (t + part * H)).cos());
            input
        });
        let mut force = SVector::zeros();
        force[3 + wheel] = 1e-3 * K_T[wheel];
        // A millimeter keeps the tires on the road. RK4: (ωh)^4/120 per radian, 7e-6 at 60 Hz. What started the car has decayed to exp(-1.5 * 10) of 1 mm at 1 Hz,
        // where accelerations are 0.04 m/s2.
        let exact = corner_accelerations(f, response(f, force));
        assert_close(got, exact, 1e-4, &format!("wheel {wheel}, {f} Hz"));
    }
}

#[test]
fn a_free_swing_has_the_eigenvalues_of_the_linear_system() {
    // State matrix of (freedoms, rates); its slowest pairs are heave, pitch and roll, then four wheel hops.
    let [m, c, k] = matrices();
    let inverse = m.try_inverse().unwrap();
    let mut a = SMatrix::<f64, 14, 14>::zeros();
    a.fixed_view_mut::<7, 7>(0, 7).copy_from(&SMatrix::identity());
    a.fixed_view_mut::<7, 7>(7, 0).copy_from(&(-inverse * k));
    a.fixed_view_mut::<7, 7>(7, 7).copy_from(&(-inverse * c));
    let eigenvalues = a.complex_eigenvalues();
    let mut hertz: Vec<f64> = eigenvalues.iter().filter(|l| l.im > 0.0).map(|l| l.norm() / TAU).collect();
    hertz.sort_by(f64::total_cmp);
    assert_eq!(hertz.len(), 7);
    // Body modes of a family car lie between 1 and 3 Hz, wheel hops around 10.
    assert!(hertz[..3].iter().all(|f| (0.9..3.0).contains(f)), "{hertz:?}");
    assert!(hertz[3..].iter().all(|f| (9.0..13.0).contains(f)), "{hertz:?}");
    // Seen by the simulation: the state after a second is exp(A) times the state before.
    let road = [0.002, -0.001, 0.0015, 0.0005];
    let mut car = FullCar::new(&body(), &corners(), road).unwrap();
    let mut start = SVector::<f64, 14>::zeros();
    start.fixed_rows_mut::<3>(0).copy_from_slice(&car.attitude());
    start.fixed_rows_mut::<4>(3).copy_from_slice(&road);
    for _ in 0..4000 {
        car.step(H, &at_rest([0.0; 4]));
    }
    // exp(A) by scaling and squaring of its Taylor series, with 2^-12 s to a step and 12 terms: exact to rounding.
    let small = a / 4096.0;
    let (mut term, mut propagator) = (SMatrix::<f64, 14, 14>::identity(), SMatrix::<f64, 14, 14>::identity());
    for n in 1..=12 {
        term = term * small / f64::from(n);
        propagator += term;
    }
    for _ in 0..12 {
        propagator = propagator * propagator;
    }
    let end = propagator * start;
    let got = car.attitude();
    let wheels = car.heights_m().map(|h| h[1]);
    for (i, x) in got.into_iter().chain(wheels).enumerate() {
        // RK4 over a second of wheel hop: 5e-8 of millimeters.
        assert!((x - end[i]).abs() < 1e-9, "{i}: {x} {}", end[i]);
    }
}

#[test]
fn with_a_dynamic_index_of_one_the_corners_part_into_quarter_cars() {
    // A rigid body has three freedoms, four quarter cars have four: the roads must not warp. Then, with equal corners,
    // k_y^2 = a b and k_x^2 = (t/2)^2, every corner moves on its own.
    let (a, half) = (1.35, 0.775);
    let mass = 4.0 * 240.8;
    let body = Body {
        mass_kg: mass,
        pitch_kg_m2: mass * a * a,
        roll_kg_m2: mass * half * half,
        height_m: 0.5,
        struts_m: [[a, half], [a, -half], [-a, half], [-a, -half]],
        antiroll_n_m_per_rad: [0.0; 2],
        bending: None,
    };
    let configured = QuarterCar::paper_table_2();
    let mut car = FullCar::new(&body, &[(configured, Deviations::default()); 4], [0.0; 4]).unwrap();
    let mut quarters: Vec<Plant> =
        (0..4).map(|_| Plant::new(&configured, &Deviations::default(), 0.0).unwrap()).collect();
    let road = |t: f64| {
        let wave =
            |amplitude: f64, f: f64, phase: f64| amplitude * ((TAU * f * t + phase).sin() - phase.sin());
        let fl = wave(0.004, 1.3, 0.3) + wave(0.0008, 9.0, 1.0);
        let fr = wave(0.003, 2.1, 0.7) + wave(0.0008, 12.0, 0.1);
        let rl = wave(0.005, 0.8, 2.0) + wave(0.0005, 17.0, 0.5);
        [fl, fr, rl, fr + rl - fl]
    };
    let mut largest = 0.0f64;
    for step in 0..12_000 {
        let t = step as f64 * H;
        let [r0, r1, r2] = [road(t), road(t + 0.5 * H), road(t + H)];
        let road_m = [0, 1, 2, 3].map(|i| [r0[i], r1[i], r2[i]]);
        car.step(H, &CarInput { road_m, stiffness_n_per_m: [[233_146.0; 2]; 4], ..at_rest([0.0; 4]) });
        for (i, (quarter, [body, wheel])) in quarters.iter_mut().zip(car.accelerations_m_s2()).enumerate() {
            quarter.step(H, &StepInput { road_m: road_m[i], stiffness_n_per_m: [233_146.0; 2] });
            let [b, w] = quarter.accelerations_m_s2();
            // The same integrator on the same equations: rounding, some 1e-12 of 20 m/s2.
            assert!((body - b).abs() < 1e-9 && (wheel - w).abs() < 1e-9, "{t} s, corner {i}: {body} {b}");
            largest = largest.max(w.abs());
        }
    }
    assert!(largest > 3.0);
}

#[test]
fn corners_are_coupled_as_the_rigid_body_says() {
    // The first instant after a kick on one wheel: only its strut's damper pulls, and the body's corners answer with
    // 1/M + x_i x_j / I_y + y_i y_j / I_x.
    let b = body();
    let mut car = FullCar::new(&b, &corners(), [0.0; 4]).unwrap();
    let tiny = 1e-6;
    let mut input = at_rest([0.0; 4]);
    input.wheel_force_n[1] = [1e6; 3];
    car.step(tiny, &input);
    let tops = car.accelerations_m_s2().map(|a| a[0]);
    let answer = |i: usize, j: usize| {
        let ([xi, yi], [xj, yj]) = (b.struts_m[i], b.struts_m[j]);
        1.0 / b.mass_kg + xi * xj / b.pitch_kg_m2 + yi * yj / b.roll_kg_m2
    };
    for i in [0, 2, 3] {
        // Springs have had a microsecond: k t / 2c = 1.5e-5 of the damper's force.
        assert!((tops[i] / tops[1] - answer(i, 1) / answer(1, 1)).abs() < 1e-3, "{i}");
    }
}

/// Runs until at rest under a constant input.
fn settled(car: &mut FullCar, input: &CarInput) {
    for _ in 0..80_000 {
        car.step(H, input);
    }
}

#[test]
fn a_load_sinks_the_car_as_statics_say() {
    let load = Load { mass_kg: 150.0, at_m: [-1.0, 0.3] };
    let mut car = FullCar::new(&body(), &corners(), [0.0; 4]).unwrap();
    car.load(&[load]);
    settled(&mut car, &at_rest([0.0; 4]));
    // Static equilibrium of the stiffness matrix of the energies.
    let [_, _, k] = matrices();
    let weight = -150.0 * 9.80665;
    let force = SVector::<f64, 7>::from([weight, -weight * -1.0, weight * 0.3, 0.0, 0.0, 0.0, 0.0]);
    let expected = k.lu().solve(&force).unwrap();
    for (i, x) in car.attitude().into_iter().enumerate() {
        // 20 s of decay at 1.5/s: 1e-13.
        assert!((x - expected[i]).abs() < 1e-9, "{i}: {x} {}", expected[i]);
    }
    // The tires carry the load, all of it.
    let tires: f64 = car.heights_m().iter().zip(K_T).map(|(h, k)| -k * h[1]).sum();
    assert!((tires + weight).abs() < 1e-6);
    // Behind and to the left it lies, so the nose is up (pitch < 0) and the left side down (roll < 0).
    assert!(car.attitude()[1] < 0.0 && car.attitude()[2] < 0.0);
    // The quick start is there at once but for the anti-roll bars, which hold back a part of the roll.
    let mut quick =
        FullCar::new(&Body { antiroll_n_m_per_rad: [0.0; 2], ..body() }, &corners(), [0.0; 4]).unwrap();
    quick.load(&[load]);
    quick.settle([0.0; 4], K_T);
    let start = quick.attitude();
    settled(&mut quick, &at_rest([0.0; 4]));
    for (before, after) in start.into_iter().zip(quick.attitude()) {
        assert!((before - after).abs() < 1e-12, "{before} {after}");
    }
}

#[test]
fn braking_and_cornering_move_the_wheel_loads_as_statics_say() {
    let mut car = FullCar::new(&body(), &corners(), [0.0; 4]).unwrap();
    settled(&mut car, &CarInput { car_m_s2: [[-4.0, 0.0]; 3], ..at_rest([0.0; 4]) });
    let loads = |car: &FullCar| [0, 1, 2, 3].map(|i| -K_T[i] * car.heights_m()[i][1]);
    // M a h / L onto the front axle.
    let [fl, fr, rl, rr] = loads(&car);
    let transfer = 913.6 * 4.0 * 0.55 / 2.7;
    assert!((fl + fr - transfer).abs() < 1e-6 && (rl + rr + transfer).abs() < 1e-6, "{fl} {fr} {rl} {rr}");
    assert!(car.attitude()[1] > 0.0);
    // A left turn: moments about the roll axis sum to M a h; the right wheels carry more.
    let mut car = FullCar::new(&body(), &corners(), [0.0; 4]).unwrap();
    settled(&mut car, &CarInput { car_m_s2: [[0.0, 3.0]; 3], ..at_rest([0.0; 4]) });
    let moment: f64 = loads(&car).iter().zip(body().struts_m).map(|(load, [_, y])| load * y).sum();
    assert!((moment + 913.6 * 3.0 * 0.55).abs() < 1e-6, "{moment}");
    assert!(car.attitude()[2] > 0.0);
    // And the whole attitude is the stiffness matrix's.
    let [_, _, k] = matrices();
    let force = SVector::<f64, 7>::from([0.0, 0.0, 913.6 * 3.0 * 0.55, 0.0, 0.0, 0.0, 0.0]);
    let expected = k.lu().solve(&force).unwrap();
    assert!(car.attitude().iter().zip(expected.iter()).all(|(x, e)| (x - e).abs() < 1e-9));
}

#[test]
fn a_force_on_a_wheel_shakes_it_as_the_closed_form_says() {
    // An imbalance of 20 g m at 100 km/h on 0.31 m: 14.26 Hz, 161 N; here with a round 14 Hz.
    let f = 14.0;
    let got = simulated(f, 10.0, |t| {
        let mut input = at_rest([0.0; 4]);
        input.wheel_force_n[2] = [0.0, 0.5, 1.0].map(|part| 161.0 * (TAU * f * (t + part * H)).cos());
        input
    });
    let mut force = SVector::zeros();
    force[5] = 161.0;
    assert_close(got, corner_accelerations(f, response(f, force)), 1e-4, "imbalance");
}

#[test]
fn work_is_energy_and_heat_for_a_crooked_car() {
    // Damper asymmetry, digression and friction only take energy; the progressive spring's energy is its integral.
    let truth = Deviations {
        damper_asymmetry: 0.3,
        damper_digression_s_per_m: 1.0,
        spring_progression_per_m: 3.0,
        friction_n: 20.0,
        ..Deviations::default()
    };
    let cars = corners().map(|(configured, _)| (configured, truth));
    let road = [0.03, -0.02, 0.01, 0.02];
    let mut car = FullCar::new(&body(), &cars, road).unwrap();
    let energy = |car: &FullCar, before: [[f64; 2]; 4], h: f64| {
        let now = car.heights_m();
        let b = body();
        let potential: f64 = (0..4)
            .map(|i| {
                let x = now[i][1] - now[i][0];
                let k = cars[i].0.spring_n_per_m();
                k / 9.0 * ((3.0 * x).exp() - 1.0 - 3.0 * x) + 0.5 * K_T[i] * now[i][1] * now[i][1]
            })
            .sum::<f64>()
            + (0..2)
                .map(|axle| {
                    let stretch = |i: usize| now[i][0] - now[i][1];
                    let track = b.struts_m[2 * axle][1] - b.struts_m[2 * axle + 1][1];
                    let twist = (stretch(2 * axle) - stretch(2 * axle + 1)) / track;
                    0.5 * b.antiroll_n_m_per_rad[axle] * twist * twist
                })
                .sum::<f64>();
        let wheels = cars.iter().enumerate();
        let kinetic: f64 = wheels
            .map(|(i, (configured, _))| {
                0.5 * configured.unsprung_mass_kg() * ((now[i][1] - before[i][1]) / h).powi(2)
            })
            .sum();
        (potential, kinetic)
    };
    let mut last = f64::INFINITY;
    let h = 1e-4;
    for i in 0..30_000 {
        let (heights, attitude) = (car.heights_m(), car.attitude());
        car.step(h, &at_rest([0.0; 4]));
        let (potential, wheels) = energy(&car, heights, h);
        let rate: Vec<f64> = car.attitude().iter().zip(attitude).map(|(a, b)| (a - b) / h).collect();
        let b = body();
        let kinetic = wheels
            + 0.5
                * (b.mass_kg * rate[0].powi(2)
                    + b.pitch_kg_m2 * rate[1].powi(2)
                    + b.roll_kg_m2 * rate[2].powi(2));
        if i % 1000 == 0 {
            // Rates are those of half a step ago: a little energy may seem to come back, never a per cent of the start.
            assert!(potential + kinetic < last + 0.5, "{i}: {} {last}", potential + kinetic);
            last = potential + kinetic;
        }
    }
    // 3 s later all is gone but what friction holds.
    assert!(last < 2.0, "{last}");
}

#[test]
fn a_tire_does_not_pull() {
    // The road falls away by half a meter at once: the wheel goes after it with its static load and its own strut, no
    // more. Static load (228.4 + 50) g on 50 kg; in a microsecond its damper has come to c t/m = 2e-5 of it.
    let mut car = FullCar::new(&body(), &corners(), [0.0; 4]).unwrap();
    let mut input = at_rest([0.0; 4]);
    input.road_m[3] = [-0.5; 3];
    car.step(1e-6, &input);
    let falling = car.accelerations_m_s2()[3][1];
    assert!((falling / ((228.4 + 50.0) * 9.80665 / 50.0) + 1.0).abs() < 1e-3, "{falling}");
}

#[test]
fn an_imbalance_shakes_the_logged_wheel_as_the_closed_form_says() {
    // 5 g m on one wheel of the puncture's car before its puncture, on a flat road.
    let mut scenario = Scenario::builtin("drive-puncture").unwrap();
    scenario.duration_s = 10.0;
    scenario.settle_s = 12.0;
    scenario.road = RoadSpec::default();
    scenario.sensor = SensorSpec::with_noise(0.0);
    scenario.antialias = AntiAliasSpec { order: 0, corner: 0.3 };
    // 13 Hz on 0.31 m.
    scenario.speed = Speed::ConstantKmH(3.6 * 0.31 * TAU * 13.0);
    scenario.corner.rl.as_mut().unwrap().truth.imbalance_kg_m = 0.005;
    let mut square = [[0.0; 2]; 4];
    for row in Simulation::new(&scenario, 9).unwrap() {
        for (sum, corner) in square.iter_mut().zip(row.corners) {
            let c = corner.unwrap();
            // 130 whole periods: twice the mean square is the amplitude's.
            sum[0] += 2.0 * c.body_accel_m_s2.powi(2) / 5000.0;
            sum[1] += 2.0 * c.wheel_accel_m_s2.powi(2) / 5000.0;
        }
    }
    let mass = 2.0 * (240.8 + 216.0);
    let front = 2.7 * 432.0 / mass;
    let body = Body {
        mass_kg: mass,
        pitch_kg_m2: mass * 1.25 * 1.25,
        roll_kg_m2: mass * 0.62 * 0.62,
        height_m: 0.55,
        struts_m: [[front, 0.775], [front, -0.775], [front - 2.7, 0.775], [front - 2.7, -0.775]],
        antiroll_n_m_per_rad: [20_000.0, 8000.0],
        bending: None,
    };
    let corner = |m_w| (QuarterCar::new(1.0, m_w, 925.8, 29_114.0).unwrap(), Deviations::default());
    let cars = [corner(56.9), corner(56.9), corner(50.0), corner(50.0)];
    let k_t = 713.91 * 241.3 + 60_880.0;
    let mut force = SVector::zeros();
    force[5] = 0.005 * (TAU * 13.0).powi(2);
    let x = response_of(matrices_of(&body, &cars, [k_t; 4]), 13.0, force);
    let s_squared = (TAU * 13.0).powi(2);
    for i in 0..4 {
        let [along, across] = body.struts_m[i];
        let top = (x[0] - x[1] * along + x[2] * across).norm() * s_squared;
        // The settled rest and the cubic between fine-grid steps: 1e-5.
        assert!((square[i][0].sqrt() / top - 1.0).abs() < 1e-3, "{i}: {} {top}", square[i][0].sqrt());
        let wheel = x[3 + i].norm() * s_squared;
        assert!((square[i][1].sqrt() / wheel - 1.0).abs() < 1e-3, "{i}: {} {wheel}", square[i][1].sqrt());
    }
}
