//! The result as lines for people, and as JSON for scripts. Called by the binary.

use serde_json::{Map, Value, json};

use super::super::estimate::Estimate;
use super::super::text::{ending, estimate_line, line};
use super::{BumpFit, BumpResult};

impl BumpResult {
    pub fn table(&self) -> String {
        self.corners.iter().chain(&self.axles).map(BumpFit::table).collect::<Vec<_>>().join("\n")
    }

    /// `corners` and `axles`, by label. Every number stands beside its standard error, which has the same key with `_se`;
    /// what could not be had is null.
    pub fn json(&self) -> Value {
        let by_label = |fits: &[BumpFit]| -> Map<String, Value> {
            fits.iter().map(|fit| (fit.label.clone(), fit.json())).collect()
        };
        json!({ "corners": by_label(&self.corners), "axles": by_label(&self.axles) })
    }
}

impl BumpFit {
    fn table(&self) -> String {
        let mut out = String::new();
        let axle = matches!(self.label.as_str(), "front" | "rear");
        line(&mut out, &self.label, if axle { "mean of left and right" } else { "" }, "");
        let mut row =
            |name: &str, estimate: &Estimate, unit: &str| estimate_line(&mut out, name, estimate, unit);
        match &self.parts {
            Some(parts) => {
                row("spring ks", &parts.spring_n_per_m, "N/m");
                row("damping cs", &parts.damping_n_s_per_m, "N s/m");
                row("friction", &parts.friction_n, "N");
                row("tire kt", &parts.tire_n_per_m, "N/m");
                row("tire damping", &parts.tire_damping_n_s_per_m, "N s/m");
            }
            None => row("friction / sprung mass", &self.friction_m_s2, "m/s²"),
        }
        row("body on its spring", &self.body_hz, "Hz");
        row("its damping ratio", &self.body_damping_ratio, "");
        if let (Some(hz), Some(ratio)) = (&self.hop_hz, &self.hop_damping_ratio) {
            row("wheel hop", hz, "Hz");
            row("its damping ratio", ratio, "");
        }
        line(&mut out, "motion used", &format!("{:.3} to {:.3} s", self.used_s.0, self.used_s.1), "");
        let mut explained = format!("{:.2} % body", 100.0 * self.body_explained);
        if let Some(parts) = &self.parts {
            explained += &format!(", {:.2} % tire", 100.0 * parts.tire_explained);
        }
        line(&mut out, "explained below 4 Hz", &explained, "");
        ending(&mut out, &self.concerns);
        out
    }

    fn json(&self) -> Value {
        let mut out = Map::new();
        let mut put = |key: &str, estimate: Option<&Estimate>| {
            out.insert(key.to_owned(), json!(estimate.map(|e| e.value)));
            out.insert(format!("{key}_se"), json!(estimate.map(|e| e.standard_error)));
        };
        let parts = self.parts.as_ref();
        put("spring_n_per_m", parts.map(|p| &p.spring_n_per_m));
        put("damping_n_s_per_m", parts.map(|p| &p.damping_n_s_per_m));
        put("friction_n", parts.map(|p| &p.friction_n));
        put("tire_n_per_m", parts.map(|p| &p.tire_n_per_m));
        put("tire_damping_n_s_per_m", parts.map(|p| &p.tire_damping_n_s_per_m));
        put("hop_hz", self.hop_hz.as_ref());
        put("hop_damping_ratio", self.hop_damping_ratio.as_ref());
        put("body_hz", Some(&self.body_hz));
        put("body_damping_ratio", Some(&self.body_damping_ratio));
        put("friction_m_s2", Some(&self.friction_m_s2));
        out.insert("body_explained".to_owned(), json!(self.body_explained));
        out.insert("tire_explained".to_owned(), json!(parts.map(|p| p.tire_explained)));
        out.insert("used_s".to_owned(), json!([self.used_s.0, self.used_s.1]));
        out.insert("concerns".to_owned(), json!(self.concerns));
        Value::Object(out)
    }
}
