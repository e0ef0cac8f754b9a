//! Scenarios from TOML: built in, from a text, from a file; and back to text.

use std::path::Path;

use super::Scenario;
use crate::error::ScenarioError;
use crate::road::Surface;
use crate::text_file::read_text;

/// The scenarios that come with the program, by name.
const BUILT_IN: [(&str, &str); 10] = [
    ("paper-drop", include_str!("../../scenarios/paper-drop.toml")),
    ("paper-deep-drop", include_str!("../../scenarios/paper-deep-drop.toml")),
    ("paper-drop-recover", include_str!("../../scenarios/paper-drop-recover.toml")),
    ("bench-drop", include_str!("../../scenarios/bench-drop.toml")),
    ("bench-drop-recover", include_str!("../../scenarios/bench-drop-recover.toml")),
    ("bench-slow", include_str!("../../scenarios/bench-slow.toml")),
    ("drive-puncture", include_str!("../../scenarios/drive-puncture.toml")),
    ("drive-slow-leak", include_str!("../../scenarios/drive-slow-leak.toml")),
    ("drive-diffusion", include_str!("../../scenarios/drive-diffusion.toml")),
    ("drive-normal", include_str!("../../scenarios/drive-normal.toml")),
];

/// Bytes of a scenario file, at most: a person writes it.
const LARGEST: u64 = 1 << 20;

/// How alike two names must be (Jaro-Winkler, 0 to 1) for one to be suggested for the other.
const ALIKE: f64 = 0.7;

impl Scenario {
    pub fn builtin_names() -> impl Iterator<Item = &'static str> {
        BUILT_IN.iter().map(|(name, _)| *name)
    }

    /// A built-in scenario. Errors: [`ScenarioError::Unknown`] lists the known names and the one most like what was asked for.
    pub fn builtin(name: &str) -> Result<Self, ScenarioError> {
        match BUILT_IN.iter().find(|(known, _)| *known == name) {
            Some((known, text)) => Self::from_toml(text, known),
            None => Err(unknown(name)),
        }
    }

    /// A scenario by what a user writes on a command line: a built-in name or the path of a TOML file.
    /// Errors: neither a known name nor a file, or the file's errors.
    pub fn load(name_or_path: &str) -> Result<Self, ScenarioError> {
        let path = Path::new(name_or_path);
        let built_in = BUILT_IN.iter().any(|(known, _)| *known == name_or_path);
        let is_toml = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
        if !built_in && (is_toml || path.is_file()) {
            Self::from_file(path)
        } else {
            Self::builtin(name_or_path)
        }
    }

    /// A scenario from a TOML file. A road profile's path is taken relative to the file.
    /// Errors: the file cannot be read; or line, column and reason of the first thing that is no scenario.
    pub fn from_file(path: &Path) -> Result<Self, ScenarioError> {
        let text = read_text(path, LARGEST)
            .map_err(|source| ScenarioError::Read { path: path.to_path_buf(), source })?;
        let mut scenario = Self::from_toml(&text, &path.display().to_string())?;
        if let Surface::Profile(profile) = &mut scenario.road.surface
            && let (Some(file), Some(folder)) = (profile.file.as_mut(), path.parent())
        {
            *file = folder.join(&*file);
        }
        Ok(scenario)
    }

    /// A scenario from TOML; `origin` is what errors call the text.
    /// Errors: line, column and reason of the first thing that is no scenario, or the first value out of range.
    pub fn from_toml(text: &str, origin: &str) -> Result<Self, ScenarioError> {
        let scenario: Self = toml::from_str(text).map_err(|e| {
            let (line, column) = e.span().map_or((1, 1), |span| line_and_column(text, span.start));
            let message = e.message().trim().replace('\n', "; ");
            ScenarioError::Syntax { origin: origin.to_owned(), line, column, message }
        })?;
        scenario.validate()?;
        Ok(scenario)
    }

    /// The scenario as TOML, every default written out. Errors: only for a path that is not Unicode.
    pub fn to_toml(&self) -> Result<String, ScenarioError> {
        toml::to_string_pretty(self).map_err(|e| ScenarioError::Write(e.to_string()))
    }
}

fn unknown(name: &str) -> ScenarioError {
    let nearest = Scenario::builtin_names()
        .map(|known| (strsim::jaro_winkler(name, known), known))
        .filter(|(alike, _)| *alike > ALIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, known)| known.to_owned());
    let known = Scenario::builtin_names().map(str::to_owned).collect();
    ScenarioError::Unknown { name: name.to_owned(), nearest, known }
}

fn line_and_column(text: &str, byte: usize) -> (usize, usize) {
    let before = text.get(..byte).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |i| i + 1);
    (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}
