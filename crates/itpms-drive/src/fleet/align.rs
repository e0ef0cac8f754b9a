//! How far off each drive's positions are: a receiver is meters off, for minutes alike, and two drives that differ by that cut a road into
//! squares at other places. The roughness itself says where a drive was against the others (docs/math/road.md, section 9).
//!
//! Called by the fleet's map. A drive has an offset, north and east, at knots along its way and on straight lines between them. Knots are
//! moved one after the other, each to where the drive's squares fit best to those of all other drives.

use std::collections::BTreeMap;

use super::record::RoadPiece;
use super::squares::{PER_DEGREE_M, PIECE_M, SIDE_M, place_of};

/// Pieces from knot to knot: 100 m.
const KNOT: usize = 40;
/// A piece is cut into so many for the borders of squares.
const CUTS: usize = 5;
/// Standard deviation in m of an offset, and of its change from knot to knot.
const OFF_M: f64 = 5.0;
const DRIFT_M: f64 = 2.0;
/// What squares of two drives differ by where nothing is off, as a share, in units of which Student's distribution with three degrees of freedom
/// holds: one that does not fit counts less.
const USUAL: f64 = 0.05;
const FREEDOM: f64 = 3.0;
/// Steps of the search in m.
const STEPS_M: [f64; 5] = [4.0, 2.0, 1.0, 0.5, 0.25];
const ROUNDS: usize = 4;

/// Sums of roughness times length, and of length, by square.
pub(super) type Squares = BTreeMap<[i64; 2], [f64; 2]>;

/// A drive's road, and how far off its positions are.
pub(super) struct Track<'a> {
    pub(super) car: usize,
    pieces: &'a [RoadPiece],
    /// North and east in m.
    knots: Vec<[f64; 2]>,
}

impl<'a> Track<'a> {
    pub(super) fn new(car: usize, pieces: &'a [RoadPiece]) -> Self {
        Self { car, pieces, knots: vec![[0.0; 2]; pieces.len() / KNOT + 2] }
    }

    pub(super) fn squares(&self) -> Squares {
        let mut squares = Squares::new();
        let last = self.knots.len() - 2;
        for at in 0..=last {
            for (place, [sum, length]) in self.passes(at * KNOT, (at + 1) * KNOT, &self.knots[at..=at + 1]) {
                let square = squares.entry(place).or_default();
                *square = [square[0] + sum, square[1] + length];
            }
        }
        squares
    }

    /// The squares between two pieces in the order of the way, with offsets on straight lines between these knots, even ones apart.
    fn passes(&self, from: usize, to: usize, knots: &[[f64; 2]]) -> Vec<([i64; 2], [f64; 2])> {
        let mut passes: Vec<([i64; 2], [f64; 2])> = Vec::new();
        let degrees = |piece: &RoadPiece| piece.0.map(|e7| f64::from(e7) * 1e-7);
        for i in from..to.min(self.pieces.len()) {
            let RoadPiece(_, iri, length_m) = self.pieces[i];
            let here = degrees(&self.pieces[i]);
            let [per_north, per_east] =
                [1.0 / PER_DEGREE_M, 1.0 / (PER_DEGREE_M * here[0].to_radians().cos().max(1e-3))];
            let share = ((i - from) as f64 + 0.5) / KNOT as f64;
            let at = (share as usize).min(knots.len() - 2);
            let offset: [f64; 2] = std::array::from_fn(|k| {
                knots[at][k] + (share - at as f64) * (knots[at + 1][k] - knots[at][k])
            });
            // The way to a neighbor, where it is one.
            let step = |neighbor: Option<&RoadPiece>, sign: f64| {
                let there = neighbor.map_or(here, degrees);
                let way = [sign * (there[0] - here[0]), sign * (there[1] - here[1])];
                let is_next = (way[0] / per_north).hypot(way[1] / per_east) < 2.0 * PIECE_M;
                if is_next { way } else { [0.0; 2] }
            };
            let ways = [
                step(i.checked_sub(1).map(|before| &self.pieces[before]), -1.0),
                step(self.pieces.get(i + 1), 1.0),
            ];
            let part = f64::from(length_m) / CUTS as f64;
            for cut in 0..CUTS {
                let along = (cut as f64 + 0.5) / CUTS as f64 - 0.5;
                let way = ways[usize::from(along > 0.0)];
                let place = place_of([
                    here[0] + along * way[0] + offset[0] * per_north,
                    here[1] + along * way[1] + offset[1] * per_east,
                ]);
                // A way along a border goes to and fro.
                match passes.iter_mut().rev().take(4).find(|pass| pass.0 == place) {
                    Some((_, [sum, length])) => {
                        (*sum, *length) = (*sum + f64::from(iri) * part, *length + part);
                    }
                    None => passes.push((place, [f64::from(iri) * part, part])),
                }
            }
        }
        passes
    }

    /// Twice the negative logarithm of how well the way between two pieces fits to the others with these knots.
    fn misfit(&self, others: &Map, factor: f64, from: usize, to: usize, knots: &[[f64; 2]]) -> f64 {
        let passes = self.passes(from, to, knots);
        // Squares at the ends are not whole.
        let inner = passes.len().saturating_sub(1).max(1);
        passes[1.min(passes.len())..inner]
            .iter()
            .map(|(place, [sum, length])| {
                let road = others.ln_iri(place);
                let rest = road.map_or(USUAL, |road| (sum / length).ln() - factor - road);
                (length / (4.0 * SIDE_M)).min(1.0) * (1.0 + FREEDOM) * (1.0 + (rest / USUAL).powi(2)).ln()
            })
            .sum()
    }

    /// Whether another drive was there.
    fn shares(&self, others: &Map, from: usize, to: usize, knots: &[[f64; 2]]) -> bool {
        self.passes(from, to, knots).iter().any(|(place, _)| others.ln_iri(place).is_some())
    }

    fn align(&mut self, others: &Map, factor: f64) {
        let (count, end) = (self.knots.len(), self.pieces.len());
        if !self.shares(others, 0, end, &self.knots) {
            return;
        }
        // All of it at first, then knot by knot.
        let moved = |by: [f64; 2], knots: &[[f64; 2]]| -> Vec<[f64; 2]> {
            knots.iter().map(|knot| [knot[0] + by[0], knot[1] + by[1]]).collect()
        };
        let off = |knot: &[f64; 2]| (knot[0].powi(2) + knot[1].powi(2)) / OFF_M.powi(2);
        let by = search([0.0; 2], |by| {
            let knots = moved(by, &self.knots);
            off(&knots[count / 2]) + self.misfit(others, factor, 0, end, &knots)
        });
        self.knots = moved(by, &self.knots);
        for at in 0..count {
            let (first, last) = (at.saturating_sub(1), (at + 1).min(count - 1));
            let mut near = self.knots[first..=last].to_vec();
            if !self.shares(others, first * KNOT, last * KNOT, &near) {
                continue;
            }
            let start = self.knots[at];
            self.knots[at] = search(start, |knot| {
                near[at - first] = knot;
                let drift: f64 = near
                    .windows(2)
                    .map(|pair| {
                        ((pair[0][0] - pair[1][0]).powi(2) + (pair[0][1] - pair[1][1]).powi(2))
                            / DRIFT_M.powi(2)
                    })
                    .sum();
                off(&knot) / count as f64
                    + drift
                    + self.misfit(others, factor, first * KNOT, last * KNOT, &near)
            });
        }
    }
}

/// Where a misfit is least, by steps to the eight sides that become shorter.
fn search(mut at: [f64; 2], mut misfit: impl FnMut([f64; 2]) -> f64) -> [f64; 2] {
    let mut least = misfit(at);
    for step in STEPS_M {
        for _ in 0..4 {
            let from = at;
            for (north, east) in (-1..=1).flat_map(|north| (-1..=1).map(move |east| (north, east))) {
                let there = [from[0] + step * f64::from(north), from[1] + step * f64::from(east)];
                let found = if there == from { least } else { misfit(there) };
                if found < least {
                    (least, at) = (found, there);
                }
            }
            if at == from {
                break;
            }
        }
    }
    at
}

/// Squares of several drives, their cars' factors taken off: sums of the logarithm times length, and of length.
#[derive(Default)]
struct Map(BTreeMap<[i64; 2], [f64; 2]>);

impl Map {
    fn add(&mut self, squares: &Squares, factor: f64, sign: f64) {
        for (place, [sum, length]) in squares.iter().filter(|(_, [sum, _])| *sum > 0.0) {
            let square = self.0.entry(*place).or_default();
            square[0] += sign * length * ((sum / length).ln() - factor);
            square[1] += sign * length;
        }
    }

    fn ln_iri(&self, place: &[i64; 2]) -> Option<f64> {
        self.0.get(place).filter(|[_, length]| *length > 1.0).map(|[sum, length]| sum / length)
    }
}

/// Finds the offsets of all tracks. `factors` makes of them the logarithms of the cars' factors.
pub(super) fn align(tracks: &mut [Track<'_>], factors: impl Fn(&[Track<'_>]) -> Vec<f64>) {
    for _ in 0..ROUNDS {
        let factors = factors(tracks);
        let mut map = Map::default();
        for track in tracks.iter() {
            map.add(&track.squares(), factors[track.car], 1.0);
        }
        for track in tracks.iter_mut() {
            let factor = factors[track.car];
            map.add(&track.squares(), factor, -1.0);
            track.align(&map, factor);
            map.add(&track.squares(), factor, 1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const METERS: usize = 1500;

    /// Roughness of a road, meter by meter: nothing in common from one to the one after the next.
    fn road(meter: i64) -> f64 {
        let mixed = (meter / 2).wrapping_mul(0x9e37_79b9_7f4a_7c15_u64 as i64) as u64;
        1.0 + 2.0 * ((mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 11) as f64
            / (1u64 << 53) as f64
    }

    /// A drive that begins so far down the road, north-east; its positions are off by this at each piece's place, north and east in m.
    fn drive(begin_m: f64, off_m: impl Fn(f64) -> [f64; 2]) -> Vec<RoadPiece> {
        let piece = |i: u32| {
            let at_m = begin_m + PIECE_M * (f64::from(i) + 0.5);
            let meters = (0..25).map(|k| road((at_m + 0.1 * f64::from(k) - 1.2).floor() as i64));
            let [north, east] = off_m(at_m).map(|off_m| 0.5f64.sqrt() * at_m + off_m);
            let latitude = 48.0 + north / PER_DEGREE_M;
            let longitude = 11.0 + east / (PER_DEGREE_M * 48.0f64.to_radians().cos());
            let e7 = |degrees: f64| (1e7 * degrees) as i32;
            RoadPiece([e7(latitude), e7(longitude)], (meters.sum::<f64>() / 25.0) as f32, 10.0)
        };
        (0..(METERS as f64 / PIECE_M) as u32).map(piece).collect()
    }

    /// What squares of two drives differ by, as a share, and by how many meters along the road the first is off against the second.
    fn apart(tracks: &[Track<'_>]) -> (f64, f64) {
        let [one, other] = [tracks[0].squares(), tracks[1].squares()];
        let whole = |square: &[f64; 2]| square[1] > 60.0;
        let both = one.iter().filter(|(_, square)| whole(square));
        let rest: Vec<f64> = both
            .filter_map(|(place, square)| {
                let other = other.get(place).filter(|other| whole(other))?;
                Some((square[0] / square[1]).ln() - (other[0] / other[1]).ln())
            })
            .collect();
        let along = |track: &Track<'_>| {
            track.knots.iter().map(|knot| 0.5f64.sqrt() * (knot[0] + knot[1])).sum::<f64>()
                / track.knots.len() as f64
        };
        let square = rest.iter().map(|rest| rest * rest).sum::<f64>() / rest.len() as f64;
        (square.sqrt(), along(&tracks[1]) - along(&tracks[0]))
    }

    fn aligned(drives: &[Vec<RoadPiece>]) -> (f64, f64) {
        let mut tracks: Vec<Track<'_>> = drives.iter().map(|drive| Track::new(0, drive)).collect();
        align(&mut tracks, |_| vec![0.0]);
        apart(&tracks)
    }

    #[test]
    fn the_road_says_by_how_much_positions_are_off() {
        let drives = [drive(3.3, |_| [4.0, -1.0]), drive(20.0, |_| [-2.0, -3.0])];
        let tracks = drives.each_ref().map(|drive| Track::new(0, drive));
        // 3 and 5 m: (3 - -5) / sqrt 2 apart along the road.
        let (before, (after, along_m)) = (apart(&tracks).0, aligned(&drives));
        assert!((along_m - 8.0 * 0.5f64.sqrt()).abs() < 0.5, "{along_m}");
        assert!(before > 0.05 && after < 0.2 * before, "{before} {after}");
        // The same where a drive's positions wander by 4 m in half a minute.
        let wander = |at_m: f64| [4.0 * (at_m / 100.0).sin(), 4.0 * (at_m / 130.0).cos()];
        let drives = [drive(3.3, wander), drive(20.0, |_| [0.0; 2])];
        let tracks = drives.each_ref().map(|drive| Track::new(0, drive));
        let (before, (after, _)) = (apart(&tracks).0, aligned(&drives));
        assert!(before > 0.04 && after < 0.4 * before, "{before} {after}");
    }

    #[test]
    fn nothing_moves_where_positions_are_right_or_nobody_else_was() {
        let drives = [drive(3.3, |_| [0.0; 2]), drive(20.0, |_| [0.0; 2])];
        let (apart, along_m) = aligned(&drives);
        assert!(apart < 0.02 && along_m.abs() < 0.5, "{apart} {along_m}");
        let mut alone = [Track::new(0, &drives[0])];
        align(&mut alone, |_| vec![0.0]);
        assert!(alone[0].knots.iter().all(|knot| *knot == [0.0; 2]));
        align(&mut [Track::new(0, &[])], |_| vec![0.0]);
    }
}
