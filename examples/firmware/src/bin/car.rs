//! A whole car under its monitor on a Cortex-M4F: `cd examples/firmware && cargo run`, under QEMU. Four wheels at 500 Hz in `f32`,
//! fed by a drive that is compiled in: a calibration, a sensor that is lost and comes back, a nail. Prints warnings as they
//! come, and what all of it took.
#![no_std]
#![no_main]

use core::hint::black_box;

use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use itpms_core::model::{CarConfig, Corner, CornerConfig, QuarterCar};
use itpms_core::monitor::{MonitorConfig, MonitoredCar};
use itpms_core::torsion::NoWheelSpeeds;
use itpms_core::warning::{Change, MonitorReport};
use itpms_firmware::drive::{DRIVE, RATE_HZ, SAMPLES, sample};
use itpms_firmware::memory::{self, Sizes};
use itpms_firmware::{Counter, instructions};
use panic_semihosting as _;

/// Without the code for wheel speeds, as in a program that has none; its memory has room for them.
type Car = MonitoredCar<f32, NoWheelSpeeds>;

/// When the button is pressed, and for how long the car then learns.
const CALIBRATION_S: [f64; 2] = [4.0, 5.0];
/// How often pressures are printed.
const EVERY_S: f64 = 5.0;

/// The estimator's configuration: the car of `drive-puncture`.
fn config() -> Option<MonitorConfig<f32>> {
    let front = CornerConfig::<f32>::paper();
    let car = &front.quarter_car;
    let rear = QuarterCar::new(216.0, 50.0, car.damping_n_s_per_m(), car.spring_n_per_m()).ok()?;
    let rear = CornerConfig { quarter_car: rear, ..front };
    let corners = [Some(front), Some(front), Some(rear), Some(rear)];
    Some(MonitorConfig::new(&CarConfig { corners, wheelbase_m: Some(2.7) }))
}

/// Builds the car where it lies; gives the stack that took.
#[inline(never)]
fn build(car: &mut Car, counter: &mut Counter) -> Option<usize> {
    let config = config()?;
    memory::paint_stack();
    let mut built = Ok(());
    let ticks = counter.ticks(|| built = car.configure(black_box(&config), RATE_HZ));
    if let Err(error) = built {
        hprintln!("the car cannot be built: {}", error);
        return None;
    }
    let stack = memory::stack_high_water()?;
    hprintln!("built with {} instructions", instructions(f64::from(ticks)));
    Some(stack)
}

/// The samples' cost.
#[derive(Default)]
struct Taken {
    sum: u64,
    worst: u32,
    worst_s: f64,
    least: u32,
    stack: usize,
}

/// Takes all samples of the drive. `before`: memory for the report before the last one; on the stack it would count as the car's.
#[inline(never)]
fn drive(car: &mut Car, before: &mut Option<MonitorReport<f32>>, counter: &mut Counter) -> Option<Taken> {
    let mut all = Taken { least: u32::MAX, ..Taken::default() };
    remember(before, car);
    memory::paint_stack();
    for index in 0..SAMPLES {
        let sample = black_box(sample(index));
        if sample.time_s == CALIBRATION_S[0] {
            hprintln!("{:5.1} s  calibration: all tires have what the placard says", sample.time_s);
            car.begin_calibration(CALIBRATION_S[1]).ok()?;
        }
        let taken = counter.ticks(|| {
            black_box(car.update(&sample));
        });
        all.sum += u64::from(taken);
        all.least = all.least.min(taken);
        if taken > all.worst {
            (all.worst, all.worst_s) = (taken, sample.time_s);
        }
        let due = index % (EVERY_S * RATE_HZ) as usize == 0;
        if due || has_changed(car, before) {
            // Printing is not part of the car's stack.
            all.stack = all.stack.max(memory::stack_high_water()?);
            print_changes(car, before, sample.time_s);
            if due {
                print_pressures(car, sample.time_s);
            }
            remember(before, car);
            memory::paint_stack();
        }
    }
    all.stack = all.stack.max(memory::stack_high_water()?);
    Some(all)
}

fn run(car: &mut Car, before: &mut Option<MonitorReport<f32>>, counter: &mut Counter) -> Option<()> {
    let to_build = build(car, counter)?;
    let taken = drive(car, before, counter)?;
    print_pressures(car, SAMPLES as f64 / RATE_HZ);

    let mean = instructions(taken.sum as f64 / SAMPLES as f64);
    let sizes = Sizes::of_program();
    hprintln!();
    hprintln!("instructions_mean {}", mean);
    hprintln!("instructions_worst {}", instructions(f64::from(taken.worst)));
    hprintln!("instructions_least {}", instructions(f64::from(taken.least)));
    hprintln!("stack_to_build_bytes {}", to_build);
    hprintln!("stack_to_run_bytes {}", taken.stack);
    hprintln!("car_bytes {}", size_of::<Car>());
    hprintln!("flash_bytes {}", sizes.text + sizes.rodata + sizes.data - DRIVE.len());
    hprintln!("text_bytes {}", sizes.text);
    hprintln!("ram_bytes {}", sizes.data + sizes.bss);
    hprintln!();
    hprintln!(
        "{} samples at {} Hz: {} instructions a second; the worst sample at {:.3} s; {} kB of drive left out",
        SAMPLES,
        RATE_HZ,
        f64::from(mean) * RATE_HZ,
        taken.worst_s,
        DRIVE.len() / 1000
    );
    Some(())
}

#[inline(never)]
fn remember(before: &mut Option<MonitorReport<f32>>, car: &Car) {
    *before = Some(car.report().clone());
}

#[inline(never)]
fn has_changed(car: &Car, before: &Option<MonitorReport<f32>>) -> bool {
    before.as_ref().is_some_and(|before| car.report().changes_since(before).next().is_some())
}

#[inline(never)]
fn print_changes(car: &Car, before: &Option<MonitorReport<f32>>, time_s: f64) {
    let Some(before) = before else { return };
    for change in car.report().changes_since(before) {
        match change {
            Change::Begun(alert) => hprintln!("{:5.1} s  WARNING: {}", time_s, alert),
            Change::Ended(alert) => hprintln!("{:5.1} s  over: {}", time_s, alert),
        }
    }
}

#[inline(never)]
fn print_pressures(car: &Car, time_s: f64) {
    let wheels = car.report().wheels;
    for (corner, wheel) in Corner::ALL.into_iter().zip(&wheels) {
        let Some(wheel) = wheel else { continue };
        hprintln!(
            "{:5.1} s  {} {:5.1} kPa, sd {:4.1}: {}",
            time_s,
            corner.label(),
            wheel.pressure_kpa,
            wheel.pressure_sd_kpa,
            wheel.state.label()
        );
    }
}

#[entry]
fn main() -> ! {
    // Zeros until it is configured, so it lies in `.bss`.
    static mut CAR: Car = Car::unconfigured_with(NoWheelSpeeds);
    static mut BEFORE: Option<MonitorReport<f32>> = None;
    let done = cortex_m::Peripherals::take()
        .and_then(|peripherals| run(CAR, BEFORE, &mut Counter::new(peripherals.SYST)));
    debug::exit(if done.is_some() { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {
        cortex_m::asm::wfi();
    }
}
