//! One corner by itself on a Cortex-M4F, without a car and its monitor: `cargo run --bin corner`. Front left of the drive that `car` takes,
//! no road heights. Prints instructions, stack and size.
#![no_std]
#![no_main]

use core::hint::black_box;

use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use itpms_core::estimator::Estimator;
use itpms_core::model::CornerConfig;
use itpms_firmware::drive::{RATE_HZ, SAMPLES, sample};
use itpms_firmware::{Counter, instructions, memory};
use panic_semihosting as _;

fn run(estimator: &mut Estimator<f32>, counter: &mut Counter) -> Option<()> {
    estimator.configure(&CornerConfig::paper(), RATE_HZ).ok()?;
    memory::paint_stack();
    let (mut sum, mut worst, mut pressure_kpa) = (0u64, 0u32, 0.0);
    for index in 0..SAMPLES {
        let sample = black_box(sample(index));
        let corner = sample.corners[0]?;
        let taken = counter.ticks(|| {
            let (body, wheel) = (corner.body_accel_m_s2, corner.wheel_accel_m_s2);
            let estimate = estimator.update(sample.time_s, sample.speed_m_s, body, wheel);
            pressure_kpa = black_box(estimate).pressure_kpa;
        });
        sum += u64::from(taken);
        worst = worst.max(taken);
    }
    hprintln!("{:.1} kPa in the end", pressure_kpa);
    hprintln!("instructions_mean {}", instructions(sum as f64 / SAMPLES as f64));
    hprintln!("instructions_worst {}", instructions(f64::from(worst)));
    hprintln!("stack_to_run_bytes {}", memory::stack_high_water()?);
    hprintln!("corner_bytes {}", size_of::<Estimator<f32>>());
    Some(())
}

#[entry]
fn main() -> ! {
    static mut CORNER: Estimator<f32> = Estimator::unconfigured();
    let done = cortex_m::Peripherals::take()
        .and_then(|peripherals| run(CORNER, &mut Counter::new(peripherals.SYST)));
    debug::exit(if done.is_some() { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {
        cortex_m::asm::wfi();
    }
}
