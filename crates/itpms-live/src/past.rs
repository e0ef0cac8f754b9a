//! Rows whose time is not after the one before: late ones are left out, those of a clock that was set back go on.
//!
//! Called by the engine with every row, before the estimate; the estimator has a steady clock of its own.

/// Rows of the past, each later than the one before it, after which the clock is believed to have been set back.
const SET_BACK: u32 = 16;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Place {
    Next,
    /// It is late, or has no time: to be left out.
    Late,
    /// The clock was set back by so many seconds: the row is the next one.
    SetBack(f64),
}

#[derive(Debug)]
pub(crate) struct Past {
    last_s: f64,
    in_a_row: u32,
    pub(crate) left_out: u64,
}

impl Past {
    pub(crate) fn new() -> Self {
        Self { last_s: f64::NAN, in_a_row: 0, left_out: 0 }
    }

    /// Where a row belongs, given the time of the one before it, NaN for none, in s.
    pub(crate) fn place(&mut self, before_s: f64, time_s: f64) -> Place {
        let back_s = before_s - time_s;
        if time_s.is_finite() && !(back_s >= 0.0) {
            self.in_a_row = 0;
            return Place::Next;
        }
        if time_s.is_finite() {
            self.in_a_row = if time_s > self.last_s { self.in_a_row + 1 } else { 1 };
            self.last_s = time_s;
        }
        if self.in_a_row < SET_BACK {
            self.left_out += 1;
            return Place::Late;
        }
        self.in_a_row = 0;
        Place::SetBack(back_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_that_is_set_back_is_believed_and_late_rows_are_not() {
        let mut past = Past::new();
        assert_eq!(past.place(f64::NAN, 5.0), Place::Next);
        // A late row now and then, one stamp again and again, and none at all.
        for _ in 0..100 {
            assert_eq!(past.place(5.0, 4.0), Place::Late);
            assert_eq!(past.place(5.0, f64::NAN), Place::Late);
            assert_eq!(past.place(5.0, 5.01), Place::Next);
        }
        assert!((0..100).all(|_| past.place(9.0, 8.0) == Place::Late));
        let places: Vec<Place> = (0..16).map(|i| past.place(9.0, 3.0 + 0.01 * f64::from(i))).collect();
        assert!(places[..15].iter().all(|place| *place == Place::Late), "{places:?}");
        assert!(matches!(places[15], Place::SetBack(back_s) if (back_s - 5.85).abs() < 1e-9), "{places:?}");
        assert_eq!(past.left_out, 315);
    }
}
