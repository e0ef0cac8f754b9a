//! The estimators to choose from, by the name that they have on the command line.

/// The default estimator, or one of the paper's filters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum EstimatorKind {
    /// The Bayes filter of [`itpms_core`].
    #[default]
    Informed,
    /// The paper's recursion, corrected and given the stiffness likelihood of the default estimator's frames.
    AekfUiInformed,
    /// As published, with the one-step forgetting factor. Cannot find the stiffness.
    AekfUi,
    /// As published, without forgetting. Cannot find the stiffness.
    EkfUi,
}

impl EstimatorKind {
    /// All kinds, the default first.
    pub const ALL: [Self; 4] = [Self::Informed, Self::AekfUiInformed, Self::AekfUi, Self::EkfUi];

    /// Whether it is a filter as published, which cannot find the stiffness: it is never valid and never warns.
    pub fn is_as_published(self) -> bool {
        matches!(self, Self::AekfUi | Self::EkfUi)
    }

    /// The name on the command line.
    pub fn label(self) -> &'static str {
        match self {
            Self::Informed => "informed",
            Self::AekfUiInformed => "aekf-ui-informed",
            Self::AekfUi => "aekf-ui",
            Self::EkfUi => "ekf-ui",
        }
    }

    pub fn from_label(label: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.label() == label)
    }
}
