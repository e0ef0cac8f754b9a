#![no_std]
#![no_main]
use core::panic::PanicInfo;
use itpms_core::{CarSample, MonitoredCar};

#[unsafe(no_mangle)]
extern "C" fn car_update(car: &mut MonitoredCar<f32>, sample: &CarSample<f32>) {
    car.update(sample);
}

#[cfg(not(feature = "count"))]
#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn a_panic_is_left() -> !;
    }
    unsafe { a_panic_is_left() }
}
#[cfg(feature = "count")]
#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    loop {}
}
