//! A wheel's state in one word, the same in every file and on every face of the program.

use itpms_core::warning::WheelState;

/// The monitor's states, in the order of [`Corner::ALL`](itpms_core::model::Corner::ALL); `None` where no monitor runs.
pub type States = [Option<WheelState>; 4];

/// `fine`, `low`, `over`, `malfunction`, `uncertain` where there is a pressure that could be low as well as not, or else `unknown`.
pub fn state_label(state: Option<WheelState>) -> &'static str {
    state.map_or("unknown", WheelState::label)
}

#[cfg(test)]
mod tests {
    use super::*;
    use itpms_core::warning::Doubt;

    #[test]
    fn what_could_be_low_is_not_what_was_never_seen() {
        let words = [
            (None, "unknown"),
            (Some(WheelState::Unknown(Doubt::Starting)), "unknown"),
            (Some(WheelState::Unknown(Doubt::Uncertain)), "uncertain"),
            (Some(WheelState::Fine), "fine"),
            (Some(WheelState::Low), "low"),
            (Some(WheelState::Over), "over"),
            (Some(WheelState::Malfunction), "malfunction"),
        ];
        for (state, word) in words {
            assert_eq!(state_label(state), word);
        }
    }
}
