//! The tracks of a road side by side, with their mean (MRI): as lines to read, as CSV, as JSON.
//!
//! Called by the roughness command with what the surveys found; computes nothing but means.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::survey::{SegmentRoughness, TrackRoughness};

/// Which side of the car a track is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Left,
    Right,
}

fn side(track: &str) -> Option<Side> {
    match track {
        "left" | "fl" | "rl" => Some(Side::Left),
        "right" | "fr" | "rr" => Some(Side::Right),
        _ => None,
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct RoughnessTable {
    segment_m: f64,
    tracks: Vec<(String, TrackRoughness)>,
}

/// A segment on a map.
pub(super) struct Place<'a> {
    pub(super) start_m: f64,
    pub(super) length_m: f64,
    /// The mean over both sides, or of the tracks that there are.
    pub(super) iri_m_per_km: f64,
    pub(super) tracks: Vec<(&'a str, f64)>,
}

impl RoughnessTable {
    /// From named tracks whose segments begin at the same places; `segment_m` is the length asked for. `left`, `fl` and
    /// `rl` are on one side, `right`, `fr` and `rr` on the other.
    pub fn new(segment_m: f64, tracks: Vec<(String, TrackRoughness)>) -> Self {
        Self { segment_m, tracks }
    }

    /// IRI of its roughest track in m/km, if that of any is known.
    pub fn roughest_m_per_km(&self) -> Option<f64> {
        self.tracks.iter().filter_map(|(_, track)| track.iri_m_per_km).reduce(f64::max)
    }

    pub fn tracks(&self) -> &[(String, TrackRoughness)] {
        &self.tracks
    }

    /// Mean over the two sides of each side's mean IRI, in m/km; `None` unless both sides have one.
    fn mean(&self, iri: impl Fn(&TrackRoughness) -> Option<f64>) -> Option<f64> {
        let of = |wanted: Side| {
            let found: Vec<f64> = self
                .tracks
                .iter()
                .filter(|(name, _)| side(name) == Some(wanted))
                .filter_map(|(_, track)| iri(track))
                .collect();
            (!found.is_empty()).then(|| found.iter().sum::<f64>() / found.len() as f64)
        };
        Some(0.5 * (of(Side::Left)? + of(Side::Right)?))
    }

    pub fn mri_m_per_km(&self, segment: usize) -> Option<f64> {
        self.mean(|track| track.segments.get(segment)?.iri_m_per_km.ok())
    }

    pub fn whole_mri_m_per_km(&self) -> Option<f64> {
        self.mean(|track| track.iri_m_per_km)
    }

    fn segments(&self) -> usize {
        self.tracks.iter().map(|(_, track)| track.segments.len()).max().unwrap_or(0)
    }

    fn segment(&self, i: usize) -> impl Iterator<Item = (&str, &SegmentRoughness)> {
        self.tracks.iter().filter_map(move |(name, track)| Some((name.as_str(), track.segments.get(i)?)))
    }

    /// The segments that any track has a roughness of, for a map.
    pub(super) fn places(&self) -> impl Iterator<Item = Place<'_>> {
        (0..self.segments()).filter_map(|i| {
            let tracks: Vec<(&str, f64)> = self
                .segment(i)
                .filter_map(|(name, segment)| Some((name, segment.iri_m_per_km.ok()?)))
                .collect();
            let (_, first) = self.segment(i).find(|(_, segment)| segment.iri_m_per_km.is_ok())?;
            let mean = tracks.iter().map(|(_, iri)| iri).sum::<f64>() / tracks.len() as f64;
            let iri_m_per_km = self.mri_m_per_km(i).unwrap_or(mean);
            Some(Place { start_m: first.start_m, length_m: first.length_m, iri_m_per_km, tracks })
        })
    }

    fn rows(&self) -> impl Iterator<Item = (usize, &str, &SegmentRoughness)> {
        (0..self.segments()).flat_map(move |i| self.segment(i).map(move |(name, segment)| (i, name, segment)))
    }

    /// A line per segment and track, under a heading; no more than `most` lines.
    pub fn lines(&self, most: usize) -> Vec<String> {
        let mut lines = vec![format!(
            "{:>16}  {:<5}  {:>8}  {:>5}  {:>16}  {:>11}  {:>12}",
            "m", "track", "IRI m/km", "class", "Gd(n0) 1e-6 m^3", "slope w", "waves m"
        )];
        let total = self.rows().count();
        for (i, name, segment) in self.rows().take(most) {
            lines.push(self.line(name, segment));
            let last = self.tracks.iter().rev().find(|(_, track)| track.segments.len() > i);
            if let (true, Some(mri)) = (last.is_some_and(|(n, _)| n == name), self.mri_m_per_km(i)) {
                lines.push(format!("{:>16}  {:<5}  {mri:>8.2}", "", "MRI"));
            }
        }
        if total > most {
            lines.push(format!("... and {} lines more: see the table (-o) or the JSON", total - most));
        }
        for (name, track) in &self.tracks {
            if let Some(iri) = track.iri_m_per_km {
                let known = format!("{:.1} m known", track.known_m);
                lines.push(format!("{known:>16}  {name:<5}  {iri:>8.2}  all of it"));
            }
        }
        if let Some(mri) = self.whole_mri_m_per_km() {
            lines.push(format!("{:>16}  {:<5}  {mri:>8.2}  all of it", "", "MRI"));
        }
        lines
    }

    fn line(&self, name: &str, segment: &SegmentRoughness) -> String {
        let place = format!("{:.1} - {:.1}", segment.start_m, segment.end_m());
        let mut line = format!("{place:>16}  {name:<5}  ");
        match segment.iri_m_per_km {
            Ok(iri) => _ = write!(line, "{iri:>8.2}"),
            Err(_) => line += "       -",
        }
        if let Ok(fit) = segment.fit {
            let level = format!("{:.1} +-{:.0} %", 1e6 * fit.law.gd_n0_m3, 100.0 * fit.level_sd_ln);
            let slope = format!("{:.2} +-{:.2}", fit.law.waviness, fit.waviness_sd);
            let waves = format!("{:.2} - {:.1}", 1.0 / fit.band_per_m.1, 1.0 / fit.band_per_m.0);
            _ = write!(line, "  {:>5}  {level:>16}  {slope:>11}  {waves:>12}", fit.class.label());
        }
        let note = segment.note();
        if note.is_empty() { line } else { format!("{line}  {note}") }
    }

    /// A row per segment and track: `start_m, end_m, track, known_m, iri_m_per_km, mri_m_per_km, iri_share, iso_class,
    /// gd_n0_m3, gd_n0_sd_ln, waviness, waviness_sd, shortest_wave_m, longest_wave_m, note`. Empty cells are unknown.
    pub fn csv(&self) -> String {
        let mut text = String::from(
            "start_m,end_m,track,known_m,iri_m_per_km,mri_m_per_km,iri_share,iso_class,gd_n0_m3,gd_n0_sd_ln,waviness,\
             waviness_sd,shortest_wave_m,longest_wave_m,note\n",
        );
        let cell = |value: Option<f64>| value.map(|v| format!("{v:.6}")).unwrap_or_default();
        for (i, name, segment) in self.rows() {
            let fit = segment.fit.ok();
            let iri = segment.iri_m_per_km.ok();
            let cells = [
                cell(Some(segment.start_m)),
                cell(Some(segment.end_m())),
                name.to_owned(),
                cell(Some(segment.known_m)),
                cell(iri),
                cell(self.mri_m_per_km(i)),
                cell(iri.map(|_| segment.iri_share)),
                fit.map(|fit| fit.class.label().to_owned()).unwrap_or_default(),
                fit.map(|fit| format!("{:.6e}", fit.law.gd_n0_m3)).unwrap_or_default(),
                cell(fit.map(|fit| fit.level_sd_ln)),
                cell(fit.map(|fit| fit.law.waviness)),
                cell(fit.map(|fit| fit.waviness_sd)),
                cell(fit.map(|fit| 1.0 / fit.band_per_m.1)),
                cell(fit.map(|fit| 1.0 / fit.band_per_m.0)),
                segment.note().replace(',', ";"),
            ];
            text += &cells.join(",");
            text.push('\n');
        }
        text
    }

    /// Everything: `segment_m`, `tracks` by name (`iri_m_per_km`, `known_m`), `mri_m_per_km`, and `segments` with their tracks.
    pub fn json(&self) -> Value {
        let whole = |(name, track): &(String, TrackRoughness)| json!({ "track": name, "iri_m_per_km": track.iri_m_per_km, "known_m": track.known_m });
        let segment = |i: usize| {
            let tracks: Vec<Value> =
                self.segment(i).map(|(name, segment)| segment_json(name, segment)).collect();
            let start_m = self.segment(i).map(|(_, segment)| segment.start_m).next();
            json!({
                "start_m": start_m,
                "end_m": self.segment(i).map(|(_, segment)| segment.end_m()).reduce(f64::max),
                "mri_m_per_km": self.mri_m_per_km(i),
                "tracks": tracks,
            })
        };
        json!({
            "segment_m": self.segment_m,
            "mri_m_per_km": self.whole_mri_m_per_km(),
            "tracks": self.tracks.iter().map(whole).collect::<Vec<_>>(),
            "segments": (0..self.segments()).map(segment).collect::<Vec<_>>(),
        })
    }
}

fn segment_json(name: &str, segment: &SegmentRoughness) -> Value {
    let iri = segment.iri_m_per_km.ok();
    json!({
        "track": name,
        "known_m": segment.known_m,
        "iri_m_per_km": iri,
        "iri_share": iri.map(|_| segment.iri_share),
        "fit": segment.fit.ok().map(|fit| json!({
            "iso_class": fit.class.label(),
            "gd_n0_m3": fit.law.gd_n0_m3,
            "gd_n0_sd_ln": fit.level_sd_ln,
            "waviness": fit.law.waviness,
            "waviness_sd": fit.waviness_sd,
            "shortest_wave_m": 1.0 / fit.band_per_m.1,
            "longest_wave_m": 1.0 / fit.band_per_m.0,
        })),
        "note": segment.note(),
    })
}
