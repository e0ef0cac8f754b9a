//! A parameter of the car before and after drives have told something of it.

/// Of a standard deviation, what has to be left for a parameter still to count as the file's alone.
const NOT_LEARNED_SD: f64 = 0.8;

/// A parameter before and after, with its standard deviations in its own unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// What the file says.
    pub before: f64,
    /// And how well it says that is known.
    pub before_sd: f64,
    /// What is believed now.
    pub after: f64,
    /// And how well that is known.
    pub after_sd: f64,
}

impl Parameter {
    /// Of a positive value that is `exp` of a normal deviation, told as mean and standard deviation.
    pub(super) fn share(before: f64, before_relative_sd: f64, [deviation, sd]: [f64; 2]) -> Self {
        let after = before * deviation.exp();
        Self { before, before_sd: before * before_relative_sd, after, after_sd: after * sd }
    }

    /// Whether the drives have told it, and not the file alone.
    #[must_use]
    pub fn is_learned(&self) -> bool {
        self.after_sd / self.after < NOT_LEARNED_SD * self.before_sd / self.before
    }
}
