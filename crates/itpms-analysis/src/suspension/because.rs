//! Why a drive says nothing of dampers or load.

itpms_core::labelled! {
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Because {
        /// Too short so far.
        Short = "short",
        /// The struts hardly move: friction holds them.
        Smooth = "smooth",
        /// They move faster or further than dampers and springs are alike.
        Rough = "rough",
        /// The forces of struts as they are modeled do not move the body as it moves.
        Unexplained = "unexplained",
        /// The dampers are adaptive: their damping follows a controller.
        Adaptive = "adaptive",
        /// There is nothing to compare with.
        NoReference = "no reference",
        /// Springs that follow the load do not show it.
        LevelControl = "level control",
    }
}

impl Because {
    /// As the end of a sentence.
    pub fn text(self) -> &'static str {
        match self {
            Self::Short => {
                "half a minute of driving at more than 11 km/h on a road that moves the wheels is needed"
            }
            Self::Smooth => "the road was so smooth that friction held the struts",
            Self::Rough => "the road was so rough that dampers and springs were beyond their usual range",
            Self::Unexplained => "the struts' forces do not explain how the body moves",
            Self::Adaptive => "the vehicle file says that the dampers are adaptive",
            Self::NoReference => "a calibration of this car is needed to compare with",
            Self::LevelControl => "the vehicle file says that springs follow the load (level control)",
        }
    }
}
