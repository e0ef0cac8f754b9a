//! Instructions a step of the published filters on a Cortex-M4F: `cd bare-metal && cargo run --release`, under QEMU with
//! one instruction every 64 ns (`.cargo/config.toml`). Instructions, not cycles: a division is one of either.
#![no_std]
#![no_main]

use core::hint::black_box;

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use itpms_core::model::{CornerSample, QuarterCar};
use itpms_core::published::{AekfUi, AekfUiLean, FilterConfig, LeanRecord, StepRecord, StepStatus};
use itpms_core::real::Real;
use panic_semihosting as _;

/// 40 ns of SysTick over 64 ns of an instruction.
const INSTRUCTIONS_PER_TICK: f64 = 40.0 / 64.0;
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

/// Ticks that `action` takes, less than 2^24.
fn ticks(clock: &mut SYST, action: impl FnOnce()) -> u32 {
    clock.clear_current();
    let before = SYST::get_current();
    action();
    before.wrapping_sub(SYST::get_current()) & 0x00ff_ffff
}

/// Prints mean and largest number of instructions of a step, until the filter diverges.
fn report<T: Real>(clock: &mut SYST, name: &str, mut step: impl FnMut(&CornerSample<T>) -> StepStatus) {
    let overhead = ticks(clock, || ());
    let (mut sum, mut largest, mut counted) = (0u64, 0, 0u32);
    let mut signal = Signal::new();
    for _ in 0..STEPS {
        let sample = black_box(signal.next::<T>());
        let mut status = StepStatus::Ignored;
        let taken = ticks(clock, || status = step(&sample)).saturating_sub(overhead);
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
    let instructions = |ticks: f64| (ticks * INSTRUCTIONS_PER_TICK + 0.5) as u32;
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

fn lean<T: Real>(clock: &mut SYST, name: &str, config: FilterConfig<T>) {
    let Ok(mut filter) = AekfUiLean::new(QuarterCar::paper_table_2(), config) else { return };
    report(clock, name, |sample| step_lean(black_box(&mut filter), black_box(T::lit(2e-3)), sample).status);
}

fn dense<T: Real>(clock: &mut SYST, name: &str, config: FilterConfig<T>) {
    let Ok(mut filter) = AekfUi::new(QuarterCar::paper_table_2(), config) else { return };
    report(clock, name, |sample| step_dense(black_box(&mut filter), black_box(T::lit(2e-3)), sample).status);
}

#[entry]
fn main() -> ! {
    if let Some(peripherals) = cortex_m::Peripherals::take() {
        let mut clock = peripherals.SYST;
        clock.set_clock_source(SystClkSource::Core);
        clock.set_reload(0x00ff_ffff);
        clock.enable_counter();
        // What a known number of instructions is counted as: 1000 times nop and the loop's own.
        let nops = ticks(&mut clock, || (0..1000).for_each(|_| cortex_m::asm::nop()));
        hprintln!("1000 nops in a loop: {}", (f64::from(nops) * INSTRUCTIONS_PER_TICK) as u32);
        lean(&mut clock, "closed form f32, simulation", FilterConfig::<f32>::paper_simulation());
        lean(&mut clock, "closed form f32, test bed", FilterConfig::<f32>::paper_bench());
        lean(&mut clock, "closed form f64, simulation", FilterConfig::<f64>::paper_simulation());
        dense(&mut clock, "dense f32, simulation", FilterConfig::<f32>::paper_simulation());
        dense(&mut clock, "dense f32, test bed", FilterConfig::<f32>::paper_bench());
        dense(&mut clock, "dense f64, simulation", FilterConfig::<f64>::paper_simulation());
    }
    debug::exit(debug::EXIT_SUCCESS);
    loop {
        cortex_m::asm::wfi();
    }
}
