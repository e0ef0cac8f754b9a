//! Problems of the crates that read one format each, as this crate's.

use super::Problem;

#[cfg(feature = "mdf4")]
impl From<crate::mdf4::Mdf4Problem> for Problem {
    fn from(problem: crate::mdf4::Mdf4Problem) -> Self {
        match problem {
            crate::mdf4::Mdf4Problem::File(problem) => Self::File(problem),
            other => Self::Mdf4(other),
        }
    }
}

#[cfg(feature = "can")]
impl From<crate::can::CanProblem> for Problem {
    fn from(problem: crate::can::CanProblem) -> Self {
        match problem {
            crate::can::CanProblem::File(problem) => Self::File(problem),
            #[cfg(feature = "mdf4")]
            crate::can::CanProblem::Mdf4(problem) => problem.into(),
            other => Self::Can(other),
        }
    }
}

impl From<crate::crg::CrgProblem> for Problem {
    fn from(problem: crate::crg::CrgProblem) -> Self {
        match problem {
            crate::crg::CrgProblem::File(problem) => Self::File(problem),
            other => Self::Crg(other),
        }
    }
}
