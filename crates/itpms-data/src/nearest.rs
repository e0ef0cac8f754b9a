//! "Did you mean": the name nearest to a mistyped one. Called by whoever reports an unknown or missing name.

/// The candidate nearest to `name`, if any is near enough to be a slip of the finger: similarity (Jaro-Winkler on
/// lower case) of 0.8 or more. Column names share long endings, so lower values would match nearly everything.
pub(crate) fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let name = name.to_lowercase();
    candidates
        .into_iter()
        .map(|candidate| (strsim::jaro_winkler(&name, &candidate.to_lowercase()), candidate))
        .filter(|(similarity, _)| *similarity >= 0.8)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_recognised_and_strangers_are_not() {
        let columns = ["time_s", "speed_m_s", "fl_body_accel_m_s2"];
        assert_eq!(nearest("Time", columns), Some("time_s"));
        assert_eq!(nearest("speed_mps", columns), Some("speed_m_s"));
        assert_eq!(nearest("fl_body_acc_ms2", columns), Some("fl_body_accel_m_s2"));
        assert_eq!(nearest("engine_rpm", columns), None);
    }
}
