//! The roads of a fleet: the roughness in squares of 20 m, from all cars that drove there, and by how much each car reads rougher than the others.
//!
//! What a drive reads of a road has a factor of its car's: its tires and unsprung masses are not quite those of its file. Where cars share roads
//! their factors show, `ln IRI(car, square) = factor(car) + road(square)`, but for one that they have in common: its mean over cars is one.
//! Positions are kept only where the map was asked for, and put right against each other by `align` first.

use std::collections::BTreeMap;

use itpms_analysis::roughness::{MapCell, SurveyError, Way, WheelSurvey, cells_picture};
use itpms_core::model::Corner;
use itpms_data::out::AtomicFile;
use serde_json::{Value, json};

use super::align::{Track, align};
use super::record::{DriveRecord, RoadPiece};
use super::squares::{PIECE_M, SIDE_M, corners_deg};
use crate::error::DriveError;
use crate::road::LateRow;

/// Least length of road in a square, over all wheels of a drive, that says anything of it.
const LEAST_M: f64 = 10.0;
/// What a reading of a square differs by beside the factor is so much, where nothing tells; more counts less.
const USUAL: f64 = 0.1;
const ROUNDS: usize = 200;

/// The squares of a drive under way.
#[derive(Debug)]
pub(super) struct DriveRoad {
    wheels: Vec<(Corner, WheelSurvey)>,
    way: Way,
    wheelbase_m: f64,
}

impl DriveRoad {
    pub(super) fn new(
        corners: &[Corner],
        wheelbase_m: Option<f64>,
        rate_hz: f64,
    ) -> Result<Self, SurveyError> {
        let wheel = |corner: &Corner| Ok((*corner, WheelSurvey::new(PIECE_M, rate_hz)?));
        let wheels = corners.iter().map(wheel).collect::<Result<_, _>>()?;
        Ok(Self { wheels, way: Way::default(), wheelbase_m: wheelbase_m.unwrap_or(0.0) })
    }

    pub(super) fn take(&mut self, late: &LateRow) {
        self.way.push(late.distance_m, late.row.motion.position_deg);
        for (corner, survey) in &mut self.wheels {
            let height_m = late.estimates[corner.index()].map_or(f64::NAN, |estimate| estimate.road_m);
            survey.push(late.row.time_s, late.distance_m, height_m, late.speed_m_s);
        }
    }

    pub(super) fn finish(self) -> Vec<RoadPiece> {
        let mut sums: BTreeMap<i64, [f64; 2]> = BTreeMap::new();
        for (corner, survey) in self.wheels {
            let behind_m = if corner.index() >= 2 { self.wheelbase_m } else { 0.0 };
            for piece in survey.finish().segments {
                let Ok(iri) = piece.iri_m_per_km else { continue };
                let middle_m = piece.start_m + 0.5 * piece.length_m - behind_m;
                let [sum, length_m] = sums.entry((middle_m / PIECE_M).floor() as i64).or_default();
                (*sum, *length_m) = (*sum + iri * piece.known_m, *length_m + piece.known_m);
            }
        }
        let piece = |(number, [sum, length_m]): (i64, [f64; 2])| {
            let at = self.way.at((number as f64 + 0.5) * PIECE_M)?;
            let rounded = |value: f64, digits: f64| ((value * digits).round() / digits) as f32;
            Some(RoadPiece(
                at.map(|deg| (1e7 * deg).round() as i32),
                rounded(sum / length_m, 1e3),
                rounded(length_m, 10.0),
            ))
        };
        sums.into_iter().filter_map(piece).collect()
    }
}

/// Roughness of a square by all cars.
#[derive(Debug, Clone, PartialEq)]
pub struct FleetCell {
    /// Squares from the equator, and along its parallel from Greenwich.
    pub place: [i64; 2],
    /// Roughness in m/km, the cars' factors taken off, and its standard deviation, but for what all cars have in common.
    pub iri_m_per_km: [f64; 2],
    /// Cars and drives that were there.
    pub cars: usize,
    pub drives: usize,
}

/// By how much a car reads roads rougher than the others.
#[derive(Debug, Clone, PartialEq)]
pub struct CarFactor {
    pub car: String,
    /// One: like the others; `None` of a car that shares too little road with any.
    pub factor: Option<f64>,
    pub sd: f64,
    /// Squares that it shares.
    pub shared: usize,
}

/// The roads of a fleet.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FleetRoads {
    /// Squares, from south to north.
    pub cells: Vec<FleetCell>,
    /// Cars, in the order of their names.
    pub cars: Vec<CarFactor>,
    /// What drives of cars differ by in a square full of road that they share, their factors taken off, as a share; NaN where none is shared.
    pub between_cars: f64,
}

/// One car in one square.
struct Seen {
    car: usize,
    cell: usize,
    ln_iri: f64,
    weight: f64,
    drives: usize,
}

impl FleetRoads {
    /// Of all drives that have their roads.
    pub fn of(drives: &[DriveRecord]) -> Self {
        let drives: Vec<(&str, &[RoadPiece])> =
            drives.iter().filter_map(|drive| Some((drive.car.as_str(), drive.road.as_deref()?))).collect();
        let mut names: Vec<&str> = drives.iter().map(|(car, _)| *car).collect();
        names.sort_unstable();
        names.dedup();
        let track = |(car, pieces)| Track::new(names.binary_search(&car).unwrap_or(0), pieces);
        let mut tracks: Vec<Track<'_>> = drives.into_iter().map(track).collect();
        align(&mut tracks, |tracks| {
            Self::of_tracks(&names, tracks).cars.iter().map(|car| car.factor.map_or(0.0, f64::ln)).collect()
        });
        Self::of_tracks(&names, &tracks)
    }

    fn of_tracks(names: &[&str], tracks: &[Track<'_>]) -> Self {
        let mut sums: BTreeMap<(usize, [i64; 2]), (f64, f64, usize)> = BTreeMap::new();
        for track in tracks {
            for (place, [iri, length]) in
                track.squares().into_iter().filter(|(_, [sum, length])| *length >= LEAST_M && *sum > 0.0)
            {
                let (sum, length_m, count) = sums.entry((track.car, place)).or_default();
                (*sum, *length_m, *count) = (*sum + iri, *length_m + length, *count + 1);
            }
        }
        let mut places: Vec<[i64; 2]> = sums.keys().map(|(_, place)| *place).collect();
        places.sort_unstable();
        places.dedup();
        let seen: Vec<Seen> = sums
            .iter()
            .filter_map(|((car, place), (sum, length_m, drives))| {
                let weight = (length_m / (4.0 * SIDE_M)).min(4.0);
                let cell = places.binary_search(place).ok()?;
                Some(Seen { car: *car, cell, ln_iri: (sum / length_m).ln(), weight, drives: *drives })
            })
            .collect();
        Self::solve(names, &places, &seen)
    }

    fn solve(names: &[&str], places: &[[i64; 2]], seen: &[Seen]) -> Self {
        let mut cars_of = vec![0usize; places.len()];
        seen.iter().for_each(|one| cars_of[one.cell] += 1);
        let shared: Vec<&Seen> = seen.iter().filter(|one| cars_of[one.cell] > 1).collect();
        let groups = groups(names.len(), places.len(), &shared);
        let (mut factor, mut road) = (vec![0.0; names.len()], vec![0.0; places.len()]);
        // Least squares, one kind of unknowns after the other; what does not fit counts less.
        for _ in 0..ROUNDS {
            let weight = |one: &Seen, factor: &[f64], road: &[f64]| {
                one.weight / (1.0 + ((one.ln_iri - factor[one.car] - road[one.cell]) / USUAL).powi(2))
            };
            road = means(seen, road.len(), |one| {
                (one.cell, one.ln_iri - factor[one.car], weight(one, &factor, &road))
            });
            let free = means(shared.iter().copied(), factor.len(), |one| {
                (one.car, one.ln_iri - road[one.cell], weight(one, &factor, &road))
            });
            // The mean of each group of cars that share roads is one.
            let of_group = |car: usize| {
                let like = groups.iter().zip(&free).filter(|(group, _)| **group == groups[car]);
                let (sum, count) =
                    like.fold((0.0, 0.0), |(sum, count), (_, factor)| (sum + factor, count + 1.0));
                sum / count
            };
            factor = (0..free.len()).map(|car| free[car] - of_group(car)).collect();
        }
        let rest = |one: &Seen| one.ln_iri - factor[one.car] - road[one.cell];
        // Its squares, its factor, and an offset along the road for every five squares are taken from a car.
        let known =
            shared.iter().map(|one| one.cell).collect::<std::collections::BTreeSet<_>>().len() + names.len();
        let freedom = (shared.len() - shared.len() / 5).saturating_sub(known) as f64;
        let between_cars =
            (shared.iter().map(|one| one.weight * rest(one).powi(2)).sum::<f64>() / freedom).sqrt();
        let spread = if between_cars.is_finite() { between_cars } else { USUAL };
        let cells = places.iter().enumerate().map(|(cell, place)| {
            let there = || seen.iter().filter(|one| one.cell == cell);
            let iri = road[cell].exp();
            let drives = there().map(|one| one.drives).sum();
            FleetCell {
                place: *place,
                iri_m_per_km: [iri, iri * spread / there().map(|one| one.weight).sum::<f64>().sqrt()],
                cars: cars_of[cell],
                drives,
            }
        });
        let cars = names.iter().enumerate().map(|(car, name)| {
            let count = shared.iter().filter(|one| one.car == car).count();
            let value = factor[car].exp();
            CarFactor {
                car: (*name).to_owned(),
                factor: (count > 1).then_some(value),
                sd: value * spread / (count as f64).sqrt(),
                shared: count,
            }
        });
        let cells: Vec<FleetCell> = cells.collect();
        Self { cells, cars: cars.collect(), between_cars }
    }

    /// A square for every cell, as GeoJSON.
    pub fn geojson(&self) -> Value {
        let degrees = |value: f64| (1e7 * value).round() / 1e7;
        let feature = |cell: &FleetCell| {
            let [[west, south], [east, north]] = corners_deg(cell.place).map(|corner| corner.map(degrees));
            json!({
                "type": "Feature",
                "geometry": { "type": "Polygon", "coordinates": [[[west, south], [east, south], [east, north], [west, north], [west, south]]] },
                "properties": { "iri_m_per_km": cell.iri_m_per_km[0], "iri_sd_m_per_km": cell.iri_m_per_km[1], "cars": cell.cars, "drives": cell.drives },
            })
        };
        let cars = |car: &CarFactor| json!({ "car": car.car, "factor": car.factor, "factor_sd": car.factor.map(|_| car.sd), "shared_cells": car.shared });
        json!({
            "type": "FeatureCollection",
            "features": self.cells.iter().map(feature).collect::<Vec<_>>(),
            "cars": self.cars.iter().map(cars).collect::<Vec<_>>(),
            "between_cars": Some(self.between_cars).filter(|share| share.is_finite()),
        })
    }

    /// The roads as a part of the fleet's page.
    pub(super) fn section(&self) -> String {
        let cells: Vec<MapCell> = self
            .cells
            .iter()
            .map(|cell| MapCell {
                corners_deg: corners_deg(cell.place),
                iri_m_per_km: cell.iri_m_per_km[0],
                title: format!(
                    "{:.2} ± {:.2} m/km, {} cars, {} drives",
                    cell.iri_m_per_km[0], cell.iri_m_per_km[1], cell.cars, cell.drives
                ),
            })
            .collect();
        if cells.is_empty() {
            return "<section id=\"roads\"><h2>The roads</h2><p class=\"note\">No drive has positions (latitude_deg, longitude_deg) where its road is known.</p></section>\n".to_owned();
        }
        let shared = self.cells.iter().filter(|cell| cell.cars > 1).count();
        let known = self.cars.iter().filter_map(|car| car.factor);
        let (low, high) =
            known.fold((f64::INFINITY, 0.0f64), |(low, high), factor| (low.min(factor), high.max(factor)));
        let agree = match shared {
            0 => "No two cars were on the same road, so that no car is compared with another.".to_owned(),
            _ => format!(
                "In {shared} of {} squares more than one car was: by what each reads on all of them the cars differ by factors of {low:.2} to {high:.2}, which are taken off; then they agree to {:.1} %.",
                cells.len(),
                100.0 * self.between_cars
            ),
        };
        format!(
            "<section id=\"roads\"><h2>The roads</h2><p class=\"note\">Roughness in squares of 20 m, as the cars’ wheels found it. {agree} What all cars have in common stays in it. The numbers: road.geojson.</p>{}</section>\n",
            cells_picture(&cells)
        )
    }
}

/// Weighted means by place.
fn means<'a>(
    seen: impl IntoIterator<Item = &'a Seen>,
    length: usize,
    of: impl Fn(&Seen) -> (usize, f64, f64),
) -> Vec<f64> {
    let mut sums = vec![[0.0; 2]; length];
    for one in seen {
        let (place, value, weight) = of(one);
        sums[place][0] += weight * value;
        sums[place][1] += weight;
    }
    sums.into_iter().map(|[sum, weight]| if weight > 0.0 { sum / weight } else { 0.0 }).collect()
}

/// Numbers of groups of cars that share roads, one by one or over others.
fn groups(cars: usize, cells: usize, shared: &[&Seen]) -> Vec<usize> {
    let mut groups: Vec<usize> = (0..cars).collect();
    loop {
        let mut least = vec![usize::MAX; cells];
        shared.iter().for_each(|one| least[one.cell] = least[one.cell].min(groups[one.car]));
        let before = groups.clone();
        shared.iter().for_each(|one| groups[one.car] = groups[one.car].min(least[one.cell]));
        if groups == before {
            return groups;
        }
    }
}

pub(super) fn write(out: &std::path::Path, roads: &FleetRoads) -> Result<(), DriveError> {
    Ok(AtomicFile::save(&out.join("road.geojson"), format!("{}\n", roads.geojson()).as_bytes())?)
}
