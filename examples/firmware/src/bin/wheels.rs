//! The monitor of a car's four wheel speeds on a Cortex-M4F: `cargo run --bin wheels`. Speeds, yaw rate, accelerations and brake at 100 Hz in
//! `f32`, then every second message as at 50 Hz. A minute of calibration, later a nail. Prints warnings, instructions, stack and size.
#![no_std]
#![no_main]

use core::hint::black_box;

use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use itpms_core::monitor::MonitoredWheels;
use itpms_core::wheel_speed::{DrivenAxle, WheelSpeedConfig};
use itpms_firmware::memory::Sizes;
use itpms_firmware::wheels::{MESSAGES, RATE_HZ, WHEELS, message};
use itpms_firmware::{Counter, instructions, memory};
use panic_semihosting as _;

const CALIBRATION_S: f64 = 60.0;

/// Every so many messages.
fn drive(wheels: &mut MonitoredWheels<f32>, counter: &mut Counter, every: usize) -> Option<()> {
    wheels.configure(&WheelSpeedConfig::new(2.7, 1.55, 1.55, DrivenAxle::Front)).ok()?;
    wheels.begin_calibration(CALIBRATION_S).ok()?;
    memory::paint_stack();
    let (mut sum, mut worst, mut least, mut stack) = (0u64, 0u32, u32::MAX, 0);
    let mut warned = false;
    for index in (0..MESSAGES).step_by(every) {
        let sample = black_box(message(index));
        let taken = counter.ticks(|| {
            wheels.update(&sample);
            black_box(wheels.alert());
        });
        sum += u64::from(taken);
        worst = worst.max(taken);
        least = least.min(taken);
        if let Some(alert) = wheels.alert().filter(|_| !warned) {
            warned = true;
            stack = memory::stack_high_water()?;
            hprintln!("WARNING: {}", alert);
            memory::paint_stack();
        }
    }
    let rate_hz = RATE_HZ / every as f64;
    let mean = sum as f64 / MESSAGES.div_ceil(every) as f64;
    hprintln!("wheels_{}_hz_instructions_mean {}", rate_hz, instructions(mean));
    hprintln!("wheels_{}_hz_instructions_worst {}", rate_hz, instructions(f64::from(worst)));
    hprintln!("wheels_{}_hz_instructions_least {}", rate_hz, instructions(f64::from(least)));
    hprintln!("wheels_{}_hz_instructions_per_s {}", rate_hz, instructions(mean * rate_hz));
    hprintln!("wheels_{}_hz_stack_bytes {}", rate_hz, stack.max(memory::stack_high_water()?));
    Some(())
}

fn run(wheels: &mut MonitoredWheels<f32>, counter: &mut Counter) -> Option<()> {
    drive(wheels, counter, 1)?;
    drive(wheels, counter, 2)?;
    let sizes = Sizes::of_program();
    hprintln!("wheels_bytes {}", size_of::<MonitoredWheels<f32>>());
    hprintln!("wheels_flash_bytes {}", sizes.text + sizes.rodata + sizes.data - WHEELS.len());
    Some(())
}

#[entry]
fn main() -> ! {
    static mut MONITOR: MonitoredWheels<f32> = MonitoredWheels::unconfigured();
    let done = cortex_m::Peripherals::take()
        .and_then(|peripherals| run(MONITOR, &mut Counter::new(peripherals.SYST)));
    debug::exit(if done.is_some() { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {
        cortex_m::asm::wfi();
    }
}
