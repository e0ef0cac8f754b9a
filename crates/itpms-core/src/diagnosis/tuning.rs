//! The numbers of the diagnosis.

use crate::diagnosis::debounce::{AT_ONCE, DebounceTimes};

crate::tuning::tuning! {
    /// Numbers of the sensor fault detection: thresholds, times and lengths of averages (docs/math/monitor.md, sections 2 and 3). A block is half
    /// a second; logs are natural ones.
    pub struct Tuning {
        // All detectors.
        /// Speed in m/s above which a car moves.
        moving_m_s: f64 = 1.5,
        /// Speed in m/s above which sensors are compared with each other: from 2.5 on 4 % of a city drive were lost.
        driving_m_s: f64 = 3.0,
        /// Blocks after something was wrong until the filters have forgotten it.
        settling_blocks: u32 = 6,
        /// Blocks with something wrong after which what is suspected, not reported, and cannot be checked meanwhile is dropped.
        dropping_blocks: u32 = 20,
        /// Share of an average that must be filled before it counts.
        filled: f64 = 0.4,
        /// Hysteresis: share of its threshold below which a noise, a standing car's motion, a shift of the hop frequency or a pending gain is over.
        hysteresis: f64 = 0.5,

        // A single sensor.
        /// Longest time between samples that follow one another, in periods.
        longest_step: f64 = 1.5,
        /// Share of missing values up to which a sensor is fine and compared with others.
        few_missing: f64 = 0.1,
        /// Share of missing values that is too much.
        many_missing: f64 = 0.4,
        /// Time constant in s of the share of missing values.
        missing_s: f64 = 1.0,
        /// Debouncing of too many missing values.
        dropout: DebounceTimes = DebounceTimes { set_s: 1.0, clear_s: 2.0 },
        /// Seconds without a change after which a sensor of a moving car may be stuck.
        stuck_doubt_s: f64 = 0.2,
        /// Debouncing of a stuck sensor.
        stuck: DebounceTimes = DebounceTimes { set_s: 0.0, clear_s: 1.5 },
        /// Least deviation in m/s² of a spike from what its neighbors say.
        spike_m_s2: f64 = 1.0,
        /// Least deviation of a spike over the usual one.
        spike_over_usual: f64 = 10.0,
        /// Time constant in s of the usual deviation.
        spike_usual_s: f64 = 0.3,
        /// Spikes that are too many within the time constant of their count.
        many_spikes: f64 = 2.2,
        /// Time constant in s of the count of spikes.
        spike_count_s: f64 = 10.0,
        /// Seconds of doubt after a spike.
        spike_doubt_s: f64 = 2.0,
        /// Debouncing of too many spikes.
        spikes: DebounceTimes = DebounceTimes { set_s: 0.0, clear_s: 15.0 },

        // Noise.
        /// Noise power over that of the same sensors at the other corners that is too much.
        noisy: f64 = 6.0,
        /// Length in s of the parts of a block whose quietest one counts as its noise: a pothole is not in all of them.
        noise_part_s: f64 = 0.1,
        /// Upper bound of the power of white noise in the hop band, relative to the quietest of the block's five parts, which has half of it:
        /// 99 % of blocks have less.
        white_at_most: f64 = 8.0,
        /// Debouncing of a sensor that is compared with others, of noise and of body and wheel swapped: six blocks are no chance.
        compared: DebounceTimes = DebounceTimes { set_s: 3.0, clear_s: 5.0 },

        // Moments of all sensors.
        /// Blocks over which the moments in the hop band are averaged.
        hop_blocks: f64 = 12.0,
        /// Blocks over which the moments in the bounce band are averaged.
        bounce_blocks: f64 = 5.0,
        /// Power over the sensors' noise in a band from which it counts.
        over_noise: f64 = 10.0,
        /// The same in the hop band, of the bodies' motion caused by the wheels.
        hop_over_noise: f64 = 3.0,

        // Body and wheel swapped.
        /// Blocks over which the ratio of a corner's wheel to its body is averaged.
        ratio_blocks: f64 = 4.0,
        /// Log of wheel over body power in the hop band below which a body moves like a wheel or a wheel like a body. A healthy corner has 4 to 6.
        swapped_ratio: f64 = 0.7,
        /// The same above which neither does.
        normal_ratio: f64 = 1.7,
        /// The same below which both do.
        crossed_ratio: f64 = -1.5,
        /// Log of powers by which a body that is a wheel moves more than the other bodies, and a wheel that is a body less than the other wheels.
        over_alike: f64 = 2.0,

        // Sensors of corners swapped, and wheels upside down.
        /// Sum of evidence for a swap (7a) from which it is reported, if that shall happen once in a hundred hours by chance: the log
        /// of those over the memory of the moments, 6 s.
        swap_sum: f64 = 11.0,
        /// Share of that sum from which the two sensors are not trusted.
        swap_suspected: f64 = 0.25,
        /// Debouncing of swapped corners and of a wheel sensor upside down.
        swap: DebounceTimes = DebounceTimes { set_s: 4.0, clear_s: 4.0 },
        /// Warp of the bodies' plane, as a share of all power, below which it is flat. A healthy car has less.
        flat_warp: f64 = 0.01,
        /// Warp that is a sensor's fault.
        bent_warp: f64 = 0.04,
        /// Warp from which corners may be in each other's place.
        swapped_warp: f64 = 0.1,
        /// Share of the warp that may be left when they are put back.
        restored_share: f64 = 0.1,
        /// Warp that may be left by whatever explains it. A healthy car has less than 0.01; what is no rigid body is not judged by it.
        left_warp: f64 = 0.02,

        // Gain of a body sensor.
        /// Log of a body sensor's gain that is wrong.
        body_gain_wrong: f64 = 0.2,
        /// The same that is fine again.
        body_gain_fine: f64 = 0.12,
        /// Share of the warp that one sensor's gain must explain; noise has its part in it, too.
        body_gain_explains: f64 = 0.65,
        /// Debouncing of a body sensor's gain.
        body_gain: DebounceTimes = DebounceTimes { set_s: 5.0, clear_s: 5.0 },

        // Gain of a wheel sensor: balance of the four.
        /// Blocks over which ratios in the slow band and power in the hop band are averaged.
        balance_blocks: f64 = 20.0,
        /// The most that a block counts of a ratio's log, where it is judged: a hole under one wheel makes two of a single block.
        balance_step: f64 = 0.35,
        /// The same where it is reported.
        balance_step_reported: f64 = 2.0,
        /// The same of the hop's log.
        balance_step_hop: f64 = 1.0,
        /// Log of a gain that is wrong.
        balance_wrong: f64 = 0.14,
        /// The same that is fine again.
        balance_fine: f64 = 0.11,
        /// Share of the most that a gain was off, below which it is fine again.
        balance_fine_share: f64 = 0.4,
        /// The most that a gain was off, from which on that is enough, whatever its hop does: averages of so much take long to be forgotten.
        balance_large: f64 = 0.31,
        /// Mean log of hop power over that of the other wheels that a wrong gain must have, in the direction of the gain. It alone is no sign of
        /// one: a tire with little air hops less, too.
        balance_hop: f64 = 0.15,
        /// Debouncing of a wheel sensor's gain.
        balance: DebounceTimes = DebounceTimes { set_s: 5.0, clear_s: 10.0 },

        // Gain of a wheel sensor: changes, by a jump or a shift.
        /// Debouncing of a change, which is only suspected.
        change: DebounceTimes = AT_ONCE,
        /// Seconds of driving after which a change that nothing else explains is taken for another car: a load that was moved, a damper that broke.
        change_longest_s: f64 = 120.0,

        // A jump, in the middle one of the newest blocks.
        /// Blocks over which the usual ratio is averaged.
        jump_usual_blocks: u32 = 40,
        /// Blocks after which it is known.
        jump_known_blocks: u32 = 12,
        /// The most by which a single block moves the usual ratio, over their number.
        jump_step: f64 = 1.0,
        /// Log of powers by which a corner's ratio is off from its usual one, more than the others', from which it has jumped. A gain of one half
        /// or two makes 1.39.
        jump: f64 = 0.75,
        /// The same while another corner's hop frequency has changed: a wheel on a flat tire shakes the other bodies, too.
        jump_beside: f64 = 1.1,
        /// The same below which it has not jumped.
        jump_fine: f64 = 0.5,
        /// The same of the hop's log of frequencies squared from which on it is the tire that has changed. One that loses 100 kPa makes 0.3, two
        /// hours of everyday driving no more than 0.25.
        jump_hop: f64 = 0.2,

        // A shift, in averages over seconds.
        /// Share of the average that must be filled before it counts.
        shift_filled: f64 = 0.6,
        /// Power that a wheel gives the body over another one, as a share of that it gives the one over itself.
        shift_to_others: f64 = 0.05,
        /// Averages that the usual one is the mean of.
        shift_usual_blocks: u32 = 60,
        /// Averages after which the usual hop frequency is known.
        shift_hop_known_blocks: u32 = 16,
        /// Averages after which all of it is.
        shift_known_blocks: u32 = 48,
        /// Log of powers by which a corner is off from its usual, more than the others, from which it has shifted. A gain of 0.75 makes 0.52, five
        /// hours over holes and humps 0.38.
        shift: f64 = 0.35,
        /// The same while another corner's tire is another one.
        shift_beside: f64 = 0.55,
        /// The same below which it has not shifted, and is taken for usual.
        shift_fine: f64 = 0.2,
        /// The same of the hop's log of frequencies squared from which on it is the tire that has changed.
        shift_hop: f64 = 0.14,
        /// What a tire that changes by less may make of the other log, over that.
        shift_by_tire: f64 = 2.0,
        /// Seconds for which what is unusual, and no tire makes, is a reason to wait with a tire of its side that looks low.
        shift_wait_s: f64 = 15.0,

        // Standstill.
        /// Speed in m/s, forwards or backwards, up to which a car counts as standing. On the worst road it shakes its wheels with 1 m/s² rms at 0.2 m/s.
        standing_m_s: f64 = 0.1,
        /// Seconds over which the wheels' motion is measured.
        standing_s: f64 = 1.0,
        /// Rms of a wheel's acceleration in m/s², white noise taken off, that no car that stands has: engines and doors make a tenth to a third.
        rolling_m_s2: f64 = 1.0,

        // Decorrelation of front and rear.
        /// Incoherence near wheel hop above which tracks may be parting. No puncture on a shared road brings it above 0.01.
        parting: f64 = 0.03,
        /// Times what it was before above which it is: where it is higher anyway, no puncture quadruples it.
        parting_over_usual: f64 = 5.0,
    }
}
