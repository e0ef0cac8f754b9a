//! Stamps of the system's clock as times that go on when that clock is set: a car starts in 1970, and learns what day
//! it is from a satellite or a network while it drives.

/// A clock that moves by so many seconds against one that no one can set was set.
const SET_S: f64 = 1.0;
/// A stamp that seems older than this, or younger than now, was made before the clock was set.
const OLDEST_S: f64 = 1.0;

/// The stamp clock's time when the first frame was read, and by how much it has been set since.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct BusTime {
    began_s: Option<f64>,
    set_s: f64,
}

impl BusTime {
    /// The time of a stamp, in seconds of the clock as it was at first. `now_s` is that clock's time now, `steady_s` that of
    /// one which only goes forwards.
    pub(crate) fn of(&mut self, stamp_s: f64, now_s: f64, steady_s: f64) -> f64 {
        let apart_s = now_s - steady_s;
        let set_s = apart_s - *self.began_s.get_or_insert(apart_s);
        let before_s = self.set_s;
        if !((set_s - before_s).abs() < SET_S) {
            self.set_s = set_s;
        }
        let is_old = !(0.0..OLDEST_S).contains(&(now_s - stamp_s));
        stamp_s - if is_old { before_s } else { self.set_s }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOW_S: f64 = 1.8e9;

    /// Times of frames every 10 ms that are read 1 ms later, under a clock that is ahead by `ahead_s` of the time since the start.
    fn times(ahead_s: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut bus = BusTime::default();
        let of = |i: i32| {
            let stamped_s = 0.01 * f64::from(i);
            let read_s = stamped_s + 0.001;
            bus.of(NOW_S + stamped_s + ahead_s(stamped_s), NOW_S + read_s + ahead_s(read_s), 77.0 + read_s)
                - NOW_S
        };
        (0..2000).map(of).collect()
    }

    #[test]
    fn a_clock_that_nobody_sets_tells_the_stamps_as_they_are() {
        // One that is slewed, too.
        for rate in [0.0, 5e-4] {
            for (i, time_s) in times(|s| rate * s).into_iter().enumerate() {
                assert!((time_s - 0.01 * (1.0 + rate) * i as f64).abs() < 1e-5, "{i}: {time_s}");
            }
        }
    }

    #[test]
    fn a_clock_that_is_set_is_no_event() {
        for by_s in [1.8e9, 3600.0, 2.5, -2.5, -3600.0, -1.8e9] {
            // In the moment between a frame's arrival and its being read, and while nothing is under way.
            for at_s in [10.0005, 10.005] {
                for (i, time_s) in times(|s| if s < at_s { 0.0 } else { by_s }).into_iter().enumerate() {
                    assert!((time_s - 0.01 * i as f64).abs() < 1e-5, "{by_s} at {at_s}, {i}: {time_s}");
                }
            }
        }
    }

    #[test]
    fn a_thread_that_is_late_reads_what_was_stamped() {
        let mut bus = BusTime::default();
        assert_eq!(bus.of(NOW_S, NOW_S, 5.0), NOW_S);
        // For three seconds it was not run.
        for i in 0..300 {
            let stamp_s = NOW_S + 0.01 * f64::from(i);
            assert_eq!(bus.of(stamp_s, NOW_S + 3.0, 8.0), stamp_s);
        }
    }
}
