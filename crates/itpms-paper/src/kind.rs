//! The estimators to choose from, by the name that they have on the command line.

itpms_core::labelled! {
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    pub enum EstimatorKind {
        /// The Bayes filter of [`itpms_core`].
        #[default]
        Informed = "informed",
        /// The paper's recursion, corrected and given the stiffness likelihood of the default estimator's frames.
        AekfUiInformed = "aekf-ui-informed",
        /// As published, with the one-step forgetting factor. Cannot find the stiffness.
        AekfUi = "aekf-ui",
        /// As published, without forgetting. Cannot find the stiffness.
        EkfUi = "ekf-ui",
    }
}

impl EstimatorKind {
    /// Whether it is a filter as published, which cannot find the stiffness: it is never valid and never warns.
    pub fn is_as_published(self) -> bool {
        matches!(self, Self::AekfUi | Self::EkfUi)
    }
}
