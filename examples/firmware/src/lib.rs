//! A program's cost on the board: instructions, stack, flash and memory.
#![no_std]

pub mod drive;
pub mod memory;
pub mod wheels;

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::exception;

/// 40 ns of SysTick over 64 ns of an instruction (`.cargo/config.toml`).
pub const INSTRUCTIONS_PER_TICK: f64 = 40.0 / 64.0;

/// How often the counter came round.
static ROUNDS: AtomicU32 = AtomicU32::new(0);
/// Ticks of a round.
const ROUND: u32 = 1 << 24;

#[exception]
fn SysTick() {
    ROUNDS.fetch_add(1, Ordering::Relaxed);
}

/// Counts instructions.
pub struct Counter {
    clock: SYST,
    overhead: u32,
}

impl Counter {
    /// Runs from now on.
    #[must_use]
    pub fn new(mut clock: SYST) -> Self {
        clock.set_clock_source(SystClkSource::Core);
        clock.set_reload(ROUND - 1);
        clock.enable_counter();
        clock.enable_interrupt();
        let mut counter = Self { clock, overhead: 0 };
        counter.overhead = counter.ticks(|| ());
        counter
    }

    /// Ticks that `action` takes, at most a hundred rounds.
    pub fn ticks(&mut self, action: impl FnOnce()) -> u32 {
        self.clock.clear_current();
        // Leaving zero is a round.
        while SYST::get_current() == 0 {}
        ROUNDS.store(0, Ordering::Relaxed);
        let before = SYST::get_current();
        action();
        let after = SYST::get_current();
        let rounds = ROUNDS.load(Ordering::Relaxed);
        (ROUND * rounds + before).wrapping_sub(after).saturating_sub(self.overhead)
    }
}

#[must_use]
pub fn instructions(ticks: f64) -> u32 {
    (ticks * INSTRUCTIONS_PER_TICK + 0.5) as u32
}
