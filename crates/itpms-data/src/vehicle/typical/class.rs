//! Typical values of a class of cars (docs/vehicle.md, table 1). A row per class; knows no particular car.

itpms_core::labelled! {
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum CarClass {
        Compact = "compact",
        #[default]
        Sedan = "sedan",
        /// Sport utility vehicles and crossovers.
        Suv = "suv",
        Van = "van",
    }
}

/// Typical figures of a class, front then rear where there are two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ClassFigures {
    /// Four unsprung masses over the car's mass.
    pub(super) unsprung_share: f64,
    pub(super) body_hz: [f64; 2],
    pub(super) damping_ratio: [f64; 2],
    /// Wheelbase in m, where it is not given.
    pub(super) wheelbase_m: f64,
}

impl CarClass {
    pub(super) fn figures(self) -> ClassFigures {
        let row = |unsprung_share, body_hz, wheelbase_m| ClassFigures {
            unsprung_share,
            body_hz,
            damping_ratio: [0.29, 0.33],
            wheelbase_m,
        };
        match self {
            Self::Compact => row(0.115, [1.35, 1.55], 2.6),
            Self::Sedan => row(0.12, [1.30, 1.45], 2.8),
            Self::Suv => row(0.125, [1.40, 1.55], 2.7),
            Self::Van => row(0.12, [1.50, 1.70], 3.0),
        }
    }
}
