//! Instructions a step of the published filter on other people's Kalman filters and on this project's, in `f32` on a Cortex-M4F:
//! `cargo run --features peers --bin peers`. Prints key, mean and largest; the example `peers` of `itpms-bench` makes the table.
#![no_std]
#![no_main]

use core::hint::black_box;

use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use itpms_bench::peers::corner::Drive;
use itpms_bench::peers::{Peer, STEPS, on_kfilter, on_minikalman, on_nalgebra, ours};
use itpms_firmware::{Counter, instructions};
use panic_semihosting as _;

/// As a controller's program calls it: a function of its own on a filter that lies in memory.
#[inline(never)]
fn counted_step<P: Peer<Scalar = f32>>(filter: &mut P, measured: [f32; 2]) {
    filter.step(measured);
}

#[inline(never)]
fn count<P: Peer<Scalar = f32>>(counter: &mut Counter, key: &str) -> Option<()> {
    let (mut filter, mut drive) = (P::fresh(), Drive::default());
    let (mut sum, mut largest) = (0u64, 0u32);
    for _ in 0..STEPS {
        let measured = black_box(drive.sample());
        let taken = counter.ticks(|| counted_step(black_box(&mut filter), measured));
        sum += u64::from(taken);
        largest = largest.max(taken);
    }
    if !filter.found().iter().all(|value| value.is_finite()) {
        hprintln!("{}: diverged", key);
        return None;
    }
    hprintln!("{} {} {}", key, instructions(sum as f64 / STEPS as f64), instructions(f64::from(largest)));
    Some(())
}

fn all(counter: &mut Counter) -> Option<()> {
    count::<ours::Lean<f32>>(counter, "lean")?;
    count::<ours::Dense<f32>>(counter, "dense")?;
    count::<on_nalgebra::Step<f32>>(counter, "nalgebra")?;
    count::<on_kfilter::Step<f32>>(counter, "kfilter")?;
    count::<on_minikalman::Step<f32>>(counter, "minikalman")?;
    count::<on_nalgebra::Ordinary<f32>>(counter, "ordinary-nalgebra")?;
    count::<on_kfilter::Ordinary<f32>>(counter, "ordinary-kfilter")?;
    count::<on_minikalman::Ordinary<f32>>(counter, "ordinary-minikalman")
}

#[entry]
fn main() -> ! {
    let done = cortex_m::Peripherals::take().and_then(|peripherals| all(&mut Counter::new(peripherals.SYST)));
    debug::exit(if done.is_some() { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {
        cortex_m::asm::wfi();
    }
}
