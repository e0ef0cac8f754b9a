//! The numbers of the diagnosis.

use crate::diagnosis::debounce::DebounceTimes;

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
        /// Hysteresis: share of its threshold below which a noise or a standing car's motion is over.
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
        /// The same in the hop band of what wheels do to the bodies.
        hop_over_noise: f64 = 3.0,

        // Body and wheel swapped.
        /// Blocks over which ratios of a corner's powers are averaged that may change at once: wheel over body, wheel over strut.
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
        /// Sum of log-likelihood ratios from which a swap (7a) or a wheel sensor's gain is reported, if that shall happen once in a hundred hours by
        /// chance: the log of those over the memory of the moments, 6 s.
        cusum: f64 = 11.0,
        /// Share of that sum from which sensors that may be swapped are not trusted.
        cusum_suspected: f64 = 0.25,
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

        // Gain of a wheel sensor.
        /// Log of the least gain that is looked for.
        gain_least: f64 = 0.2,
        /// Standard deviations in a block of what two corners differ by: logs of strut over body, of the slow band, and of hop.
        gain_sd: [f64; 3] = [0.36, 0.45, 0.4],
        /// Shares of the sum from which a tire of that side is not called low, and from which the corner is not learned from.
        gain_doubted: [f64; 2] = [0.15, 0.35],
        /// The most of them that a block counts: a hole under one wheel makes two of a single block.
        gain_outlier: f64 = 2.0,
        /// Share of the gain reported that is looked for from then on: the least of it is left at half of that.
        gain_fine: f64 = 0.75,
        /// Blocks after which the usual strut over body is known.
        gain_known_blocks: u32 = 24,
        /// Blocks that it is the mean of.
        gain_usual_blocks: u32 = 160,
        /// Seconds after a stop in which strut over body may change by a load.
        gain_load_s: f64 = 10.0,
        /// Seconds of driving after which a change that nothing else explains is taken for another car: a load that was moved, a damper that broke.
        change_longest_s: f64 = 120.0,

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
