//! Identified parameters of a strut (docs/math/learn.md, section 3).

/// A strut as the body's equation of motion has it, over the last minute. All forces in it times one factor, together with the body's mass,
/// move the body alike: damping, spring and friction are those that belong to the *file's* sprung mass.
///
/// The standard deviations are those of the fit alone. On a car that is not its file in what the equation holds fixed (how the body rests on the axles,
/// passengers, a body that bends) they are 10 to 30 times too small: whoever believes a reading adds what such a car leaves open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrutReading<T> {
    /// Logarithm of the damping over the file's.
    pub ln_damping: T,
    /// Its standard deviation.
    pub ln_damping_sd: T,
    /// Logarithm of the spring over the file's.
    pub ln_spring: T,
    /// Its standard deviation.
    pub ln_spring_sd: T,
    /// Friction in N, all that sticks and slips.
    pub friction_n: T,
    /// Its standard deviation.
    pub friction_sd_n: T,
    /// Logarithm of the whole sprung mass over the file's that the fit has arrived at. It rests on what springs and dampers of the file are
    /// taken to be, not on the drive.
    pub ln_sprung_mass: T,
}
