//! Dampers and load (`itpms_analysis::suspension`) on cars of another simulation: scatter of healthy drives, losses found, error of the load.
//!
//! ```sh
//! cargo run --release -p itpms-lab --example other_cars -- CARS HEALTHY SECONDS FIRST REFERENCE_S
//! ```
//!
//! With `V=1` a line for each drive, with `HEALTHY=1` healthy ones alone, with `UNTOLD=1` the springs' stiffening is not in the file.
#![allow(clippy::unwrap_used, clippy::expect_used, missing_docs, unreachable_pub)]

mod plant;

use itpms_analysis::suspension::{
    CarBody, DamperState, SuspensionReading, SuspensionSpectra, SuspensionVerdict, Terms,
};
use plant::{Car, Day, normal, uniform};
use rand::SeedableRng as _;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

fn listen(car: &Car, day: &Day, seed: u64) -> SuspensionSpectra {
    let mut r = Pcg64Mcg::seed_from_u64(seed);
    let mut spectra = SuspensionSpectra::new(0.005);
    plant::drive(car, day, &mut r, |t, v, rows| spectra.push(t, v, rows));
    spectra
}

fn file(car: &Car, r: &mut Pcg64Mcg) -> CarBody {
    let mut f = || [0.05, 0.2, 0.25, 0.05].map(|sd| (sd * normal(r)).exp());
    let e = [f(), f()];
    let mass_f = e[0][0];
    CarBody {
        sprung_mass_kg: std::array::from_fn(|i| car.ms[i] * if i < 2 { mass_f } else { e[1][0] }),
        unsprung_mass_kg: car.mu,
        damping_n_s_per_m: std::array::from_fn(|i| car.cs[i / 2 * 2] * e[i / 2][2]),
        spring_n_per_m: std::array::from_fn(|i| car.ks[i / 2 * 2] * e[i / 2][1]),
        spring_stiffening_per_m: car.prog,
        accel_noise_m_s2: [0.05; 4],
        tire_n_per_m: car.kt,
        tire_damping_n_s_per_m: [50.0; 4],
    }
}

struct Out {
    kind: &'static str,
    car: usize,
    lost: [bool; 4],
    read: Result<Read, String>,
}
struct Read {
    ln: [f64; 4],
    states: [DamperState; 4],
    rough: bool,
    unexplained: f64,
    usable: f64,
    total: f64,
    rear_kg: f64,
    true_total: f64,
    true_rear_kg: f64,
    total_sd: f64,
    lr_alone: [f64; 2],
    temp: f64,
    fit_sd: f64,
    fs: f64,
    lr_sd: [f64; 2],
    fr_sd: f64,
    or_sd: f64,
}

fn sd(v: &[f64]) -> f64 {
    (v.iter().map(|x| x * x).sum::<f64>() / v.len().max(1) as f64).sqrt()
}
fn worst(v: &[f64]) -> f64 {
    v.iter().fold(0.0f64, |a, b| a.max(b.abs()))
}

fn main() {
    let arg = |i: usize, d: f64| std::env::args().nth(i).and_then(|a| a.parse().ok()).unwrap_or(d);
    let (cars, healthy, seconds, first) =
        (arg(1, 8.0) as usize, arg(2, 5.0) as usize, arg(3, 200.0), arg(4, 1.0) as usize);
    let reference_s = arg(5, 400.0);
    let verbose = std::env::var("V").is_ok();
    let all: Vec<Out> = (first..first + cars)
        .into_par_iter()
        .flat_map(|k| {
            let mut r = Pcg64Mcg::seed_from_u64(1000 + k as u64);
            let car = plant::car(&mut r, k % 4 == 3);
            let mut body = file(&car, &mut r);
            if std::env::var("UNTOLD").is_ok() { body.spring_stiffening_per_m = 0.0; }
            let mut refused = Vec::new();
            let (ref_day, spectra, reference) = loop {
                let d = plant::day(&mut r, reference_s, true);
                let spectra = listen(&car, &d, 7 * k as u64 + 100 * refused.len() as u64);
                match SuspensionReading::alone(&body, &spectra).and_then(|reading| Ok((reading.as_reference()?, reading))) {
                    Ok((_, reading)) => break (d, spectra, reading),
                    Err(e) => refused.push(Out { kind: "reference", car: k, lost: [false; 4], read: Err(format!("reference {e:?}")) }),
                }
            };
            if verbose {
                let s = body.sprung_mass_kg.iter().sum::<f64>() / car.ms.iter().sum::<f64>();
                println!("car {k} other {} unexpl {:.4} rough {} usable {} fs [{:.2}] c/true {:.2?} k/true {:.2?} fric {:.0?} true {:.0?} late {:.2?} {:?} warp {:.3} bar {:.2?} {:.2?}", car.other, reference.unexplained, reference.is_rough, spectra.usable_s(), reference.found.friction_share,
                    (0..4).map(|i| reference.found.hydraulic_n_s_per_m[i] / car.cs[i] / s).collect::<Vec<_>>(),
                    (0..4).map(|i| reference.found.spring_n_per_m[i] / car.ks[i] / s).collect::<Vec<_>>(),
                    reference.found.friction_n, car.friction, reference.found.lateness_s.map(|x| x * 2000.0), car.late, reference.found.warp, (0..2).map(|i| reference.found.bar_n_per_m[i] / reference.found.spring_n_per_m[2*i]).collect::<Vec<_>>(), car.bar);
            }
            let reference = reference.found;
            let mut todo: Vec<(&'static str, [f64; 4])> = vec![("healthy", [1.0; 4]); healthy];
            if std::env::var("HEALTHY").is_err() {
                for (kind, left) in [("-30 %", 0.7), ("-50 %", 0.5), ("-70 %", 0.3)] {
                    let w = uniform(&mut r, 0.0, 3.999) as usize;
                    let mut one = [1.0; 4];
                    one[w] = left;
                    todo.push((kind, one));
                    let a = usize::from(uniform(&mut r, 0.0, 1.0) < 0.5);
                    let mut axle = [1.0; 4];
                    axle[2 * a] = left;
                    axle[2 * a + 1] = left;
                    todo.push((kind, axle));
                }
            }
            let out: Vec<Out> = todo.into_iter().enumerate().map(|(n, (kind, damper))| {
                let mut d = plant::day(&mut r, seconds, false);
                d.damper = damper;
                let spectra = listen(&car, &d, 1_000_000 + 1000 * k as u64 + n as u64);
                let lost = damper.map(|x| x < 0.95);
                let verdict = SuspensionVerdict::of(&body, &spectra, Some(&reference), &Terms::default());
                let read = verdict.dampers[0].because.map_or(Ok(()), Err).and_then(|()| SuspensionReading::against(&body, &spectra, &reference)).map_err(|e| format!("{e:?}")).map(|reading| {
                    let health = verdict.dampers;
                    let load = verdict.load;
                    let alone = SuspensionReading::alone(&body, &spectra).ok();
                    let h = &reading.found.hydraulic_n_s_per_m;
                    let lr_alone = alone.map_or([f64::NAN; 2], |a| { let h = a.found.hydraulic_n_s_per_m; [(h[0] / h[1]).ln(), (h[2] / h[3]).ln()] });
                    let (m0, r0) = (car.ms.iter().sum::<f64>(), car.ms[2] + car.ms[3]);
                    let m1 = (m0 - r0) * (1.0 + d.load[0]) + r0 * (1.0 + d.load[1]);
                    let scale = reference.sprung_mass_kg / m0;
                    let found = &reading.found;
                    Read {
                        ln: std::array::from_fn(|i| (h[i] / reference.hydraulic_n_s_per_m[i]).ln()),
                        states: health.map(|h| h.state),
                        rough: reading.is_rough,
                        unexplained: reading.unexplained,
                        usable: found.driving_s,
                        total: found.sprung_mass_kg / reference.sprung_mass_kg,
                        rear_kg: found.sprung_mass_kg * found.rear_share - reference.sprung_mass_kg * reference.rear_share,
                        true_total: m1 / m0,
                        true_rear_kg: r0 * d.load[1] * scale,
                        total_sd: load.masses.map_or(f64::NAN, |m| m.total_kg.sd / m.total_kg.value),
                        lr_sd: [0, 2].map(|i| health[i].left_right.map_or(f64::NAN, |m| m.sd)),
                        fr_sd: health[0].front_rear.map_or(f64::NAN, |m| m.sd),
                        or_sd: health[0].over_reference.map_or(f64::NAN, |m| m.sd),
                        lr_alone,
                        temp: d.temperature - ref_day.temperature,
                        fs: reading.found.friction_share,
                        fit_sd: reading.ln_damping_covariance[0][0].sqrt(),
                    }
                });
                if verbose {
                    match &read {
                        Ok(x) => println!("  {k} {kind} {lost:?} gd {:.0} v {:.0} holes {} used {} fs [{:.2}] rough {} un {:.4} ln {:.3?} sd {:.3} tot {:.3} true {:.3} rear {:.0} true {:.0} load {:.2?} {:?}", d.gd * 1e6, d.speed * 3.6, d.holes, x.usable, x.fs, x.rough, x.unexplained, x.ln, x.fit_sd, x.total, x.true_total, x.rear_kg, x.true_rear_kg, d.load, x.states.map(DamperState::label)),
                        Err(e) => println!("  {k} {kind} {lost:?} gd {:.0} v {:.0} holes {} {e}", d.gd * 1e6, d.speed * 3.6, d.holes),
                    }
                }
                Out { kind, car: k, lost, read }
            }).chain(refused).collect();
            out
        })
        .collect();
    let _ = |o: &Out| o.car;
    for kind in ["healthy", "-30 %", "-50 %", "-70 %"] {
        let of: Vec<&Out> = all.iter().filter(|o| o.kind == kind).collect();
        let read: Vec<(&Out, &Read)> = of.iter().filter_map(|o| Some((*o, o.read.as_ref().ok()?))).collect();
        if of.is_empty() {
            continue;
        }
        if kind == "healthy" {
            let lr: Vec<f64> =
                read.iter().flat_map(|(_, x)| [x.ln[0] - x.ln[1], x.ln[2] - x.ln[3]]).collect();
            let fr: Vec<f64> =
                read.iter().map(|(_, x)| 0.5 * (x.ln[0] + x.ln[1] - x.ln[2] - x.ln[3])).collect();
            let al: Vec<f64> =
                read.iter().map(|(_, x)| x.ln.iter().sum::<f64>() / 4.0 + 0.0035 * x.temp).collect();
            let one: Vec<f64> = read.iter().flat_map(|(_, x)| x.ln).collect();
            let la: Vec<f64> = read.iter().flat_map(|(_, x)| x.lr_alone).filter(|x| x.is_finite()).collect();
            let loaded: Vec<&Read> =
                read.iter().map(|(_, x)| *x).filter(|x| x.total_sd.is_finite()).collect();
            let tot: Vec<f64> = loaded.iter().map(|x| x.total / x.true_total - 1.0).collect();
            let rear: Vec<f64> = loaded.iter().map(|x| x.rear_kg - x.true_rear_kg).collect();
            let inside =
                loaded.iter().filter(|x| (x.total / x.true_total - 1.0).abs() < 1.96 * x.total_sd).count();
            let z = |v: Vec<f64>| 100.0 * v.iter().filter(|z| z.abs() < 1.96).count() as f64 / v.len() as f64;
            println!(
                "inside 95 %: left-right {:.1}, front-rear {:.1}, over reference {:.1}",
                z(read
                    .iter()
                    .flat_map(|(_, x)| [(x.ln[0] - x.ln[1]) / x.lr_sd[0], (x.ln[2] - x.ln[3]) / x.lr_sd[1]])
                    .collect()),
                z(read
                    .iter()
                    .map(|(_, x)| 0.5 * (x.ln[0] + x.ln[1] - x.ln[2] - x.ln[3]) / x.fr_sd)
                    .collect()),
                z(read.iter().map(|(_, x)| x.ln[0] / x.or_sd).collect())
            );
            let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
            let wrong = read.iter().filter(|(_, x)| x.states.iter().any(|s| *s != DamperState::Fine)).count();
            println!(
                "healthy: {} drives, {} read, {} rough; left-right sd {:.1} % worst {:.1}; front-rear {:.1} worst {:.1}; all four (temperature known) {:.1} worst {:.1}; one over reference {:.1}; fit sd {:.2} %; left-right alone {:.1} worst {:.1}; false states {wrong}",
                of.len(),
                read.len(),
                read.iter().filter(|(_, x)| x.rough).count(),
                100.0 * sd(&lr),
                100.0 * worst(&lr),
                100.0 * sd(&fr),
                100.0 * worst(&fr),
                100.0 * sd(&al),
                100.0 * worst(&al),
                100.0 * sd(&one),
                100.0 * mean(&read.iter().map(|(_, x)| x.fit_sd).collect::<Vec<_>>()),
                100.0 * sd(&la),
                100.0 * worst(&la)
            );
            println!(
                "  load of {} drives: mean sd {:.2} %; total {:.1} % mean {:+.1} worst {:.1}, inside 95 %: {:.1} %; rear added rms {:.0} kg mean {:+.0} worst {:.0}",
                loaded.len(),
                100.0 * mean(&loaded.iter().map(|x| x.total_sd).collect::<Vec<_>>()),
                100.0 * sd(&tot),
                100.0 * mean(&tot),
                100.0 * worst(&tot),
                100.0 * inside as f64 / loaded.len() as f64,
                sd(&rear),
                mean(&rear),
                worst(&rear)
            );
        } else {
            let low = |s: DamperState| matches!(s, DamperState::Weak | DamperState::Worn);
            let hit = read
                .iter()
                .filter(|(o, x)| {
                    o.lost.iter().zip(x.states).all(|(l, s)| *l == low(s) && s != DamperState::Stiff)
                })
                .count();
            let part =
                read.iter().filter(|(o, x)| o.lost.iter().zip(x.states).any(|(l, s)| *l && low(s))).count();
            println!(
                "{kind}: {} drives, {} read, exactly named {hit}, lost one named {part}",
                of.len(),
                read.len()
            );
        }
    }
    let reasons = ["Short", "Smooth", "Rough", "Unexplained"];
    for why in reasons.map(str::to_owned).into_iter().chain(reasons.map(|why| format!("reference {why}"))) {
        let is_it = |o: &&Out| o.read.as_ref().is_err_and(|e| *e == why);
        println!("not read, {why}: {}", all.iter().filter(is_it).count());
    }
}
