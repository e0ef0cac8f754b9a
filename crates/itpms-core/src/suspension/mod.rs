//! The force in the struts: spring, damper, anti-roll bar and friction, identified from the body's own equation of motion, in which
//! neither roads nor tires appear (docs/math/unknown-car.md). What the roads tell never comes back here.
//!
//! Entered corner by corner with grid samples ([`Strut`]) and, whenever all corners have a frame, with those frames
//! ([`BodyEquation`]). Knows nothing of tires, pressures and beliefs.
//!
//! | module | idea |
//! |---|---|
//! | `maxwell_slip` | friction that sticks before it slips, from the relative motion alone |
//! | `strut` | one corner: its friction force, and the spectra of the forces on its body |
//! | `coherence` | how far a corner's body goes with its wheel |
//! | `rigid_body` | how a force at one corner accelerates the body at another |
//! | `body_equation` | the fit of all corners together, how much of the body's motion it leaves unexplained, and what that makes of the tires |

mod body_equation;
mod coherence;
mod maxwell_slip;
mod rigid_body;
mod strut;

pub(crate) use self::body_equation::{BodyEquation, Learning, MEMORY_S};
pub(crate) use self::strut::{Strut, StrutFrame};
