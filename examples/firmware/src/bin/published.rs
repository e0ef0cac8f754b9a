//! Instructions a step of the published filters on a Cortex-M4F: `cd examples/firmware && cargo run --features paper --bin published`,
//! under QEMU with one instruction every 64 ns (`.cargo/config.toml`). Instructions, not cycles: a division is one of either.
#![no_std]
#![no_main]

use core::hint::black_box;

use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use itpms_core::Real;
use itpms_core::model::{CornerSample, QuarterCar};
use itpms_firmware::{Counter, instructions};
use itpms_paper::{AekfUi, AekfUiLean, FilterConfig, LeanRecord, StepRecord, StepStatus};
use panic_semihosting as _;

const STEPS: u32 = 300;

/// A body at 1.4 Hz and a wheel at 11 Hz, by recursion, so that no library's sine is needed.
struct Signal {
    body: [f64; 2],
    wheel: [f64; 2],
}

impl Signal {
    fn new() -> Self {
        Self { body: [0.0, 0.0176], wheel: [0.0, 0.552] }
    }

    /// The next sample at 500 Hz, in m/s².
    fn next<T: Real>(&mut self) -> CornerSample<T> {
        // 2 cos(2 pi f / 500)
        let advance = |[before, now]: [f64; 2], twice_cosine: f64| [now, twice_cosine * now - before];
        self.body = advance(self.body, 1.999_690_5);
        self.wheel = advance(self.wheel, 1.980_931_4);
        CornerSample { body_accel_m_s2: T::lit(self.body[1]), wheel_accel_m_s2: T::lit(self.wheel[1]) }
    }
}

/// Prints mean and largest number of instructions of a step, until the filter diverges.
fn report<T: Real>(counter: &mut Counter, name: &str, mut step: impl FnMut(&CornerSample<T>) -> StepStatus) {
    let (mut sum, mut largest, mut counted) = (0u64, 0, 0u32);
    let mut signal = Signal::new();
    for _ in 0..STEPS {
        let sample = black_box(signal.next::<T>());
        let mut status = StepStatus::Ignored;
        let taken = counter.ticks(|| status = step(&sample));
        if status != StepStatus::Updated {
            break;
        }
        sum += u64::from(taken);
        largest = largest.max(taken);
        counted += 1;
    }
    if counted == 0 {
        hprintln!("{}: diverges at its first step", name);
        return;
    }
    let mean = instructions(sum as f64 / f64::from(counted));
    let largest = instructions(f64::from(largest));
    hprintln!("{}: mean {}, largest {}, over {} steps", name, mean, largest, counted);
}

/// A step as a controller's program calls it: a function of its own on a filter that lies in memory.
#[inline(never)]
fn step_lean<T: Real>(filter: &mut AekfUiLean<T>, dt_s: T, sample: &CornerSample<T>) -> LeanRecord<T> {
    filter.step(dt_s, sample)
}

/// The same for the dense filter.
#[inline(never)]
fn step_dense<T: Real>(filter: &mut AekfUi<T>, dt_s: T, sample: &CornerSample<T>) -> StepRecord<T> {
    filter.step(dt_s, sample)
}

fn lean<T: Real>(counter: &mut Counter, name: &str, config: FilterConfig<T>) {
    let Ok(mut filter) = AekfUiLean::new(QuarterCar::paper_table_2(), config) else { return };
    report(counter, name, |sample| step_lean(black_box(&mut filter), black_box(T::lit(2e-3)), sample).status);
}

fn dense<T: Real>(counter: &mut Counter, name: &str, config: FilterConfig<T>) {
    let Ok(mut filter) = AekfUi::new(QuarterCar::paper_table_2(), config) else { return };
    report(counter, name, |sample| {
        step_dense(black_box(&mut filter), black_box(T::lit(2e-3)), sample).status
    });
}

#[entry]
fn main() -> ! {
    if let Some(peripherals) = cortex_m::Peripherals::take() {
        let mut counter = Counter::new(peripherals.SYST);
        // The count for a known number of instructions: 1000 times nop and the loop's own.
        let nops = counter.ticks(|| (0..1000).for_each(|_| cortex_m::asm::nop()));
        hprintln!("1000 nops in a loop: {}", instructions(f64::from(nops)));
        lean(&mut counter, "closed form f32, simulation", FilterConfig::<f32>::paper_simulation());
        lean(&mut counter, "closed form f32, test bed", FilterConfig::<f32>::paper_bench());
        lean(&mut counter, "closed form f64, simulation", FilterConfig::<f64>::paper_simulation());
        dense(&mut counter, "dense f32, simulation", FilterConfig::<f32>::paper_simulation());
        dense(&mut counter, "dense f32, test bed", FilterConfig::<f32>::paper_bench());
        dense(&mut counter, "dense f64, simulation", FilterConfig::<f64>::paper_simulation());
    }
    debug::exit(debug::EXIT_SUCCESS);
    loop {
        cortex_m::asm::wfi();
    }
}
