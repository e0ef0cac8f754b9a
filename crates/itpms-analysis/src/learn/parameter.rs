//! A parameter of the car before and after drives have shown something of it.

/// Of a standard deviation, what has to be left for a parameter still to count as the file's alone.
const NOT_LEARNED_SD: f64 = 0.8;

/// A parameter before and after, with its standard deviations in its own unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    pub before: f64,
    pub before_sd: f64,
    pub after: f64,
    pub after_sd: f64,
}

impl Parameter {
    /// Of a positive value that is `exp` of a normal deviation, given as mean and standard deviation.
    pub(super) fn share(before: f64, before_relative_sd: f64, [deviation, sd]: [f64; 2]) -> Self {
        let after = before * deviation.exp();
        Self { before, before_sd: before * before_relative_sd, after, after_sd: after * sd }
    }

    /// Whether the drives have shown it, and not the file alone. Shares count where a value has grown, since its deviation grows with it; one
    /// that has shrunk to next to nothing, such as friction, is known by its deviation itself.
    pub fn is_learned(&self) -> bool {
        self.after_sd < NOT_LEARNED_SD * self.before_sd * (self.after / self.before).max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::Parameter;

    #[test]
    fn what_is_known_no_better_is_not_learned_whatever_became_of_its_value() {
        let of = |after: f64, after_sd: f64| Parameter { before: 40.0, before_sd: 30.0, after, after_sd };
        // Next to nothing, give or take a fifth of before: friction that is not there.
        assert!(of(3.6, 5.9).is_learned());
        assert!(!of(40.0, 29.0).is_learned());
        assert!(!of(20.0, 25.0).is_learned());
        // Twice the value at half the share is the same deviation.
        assert!(of(80.0, 30.0).is_learned());
        assert!(!of(80.0, 58.0).is_learned());
    }
}
