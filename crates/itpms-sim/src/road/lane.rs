//! The road under the wheels of one side, the rear ones beside the front ones' track by a distance that changes.
//!
//! Called by the simulation. In between lines at fixed distances from the track the road is a mixture of the two
//! nearest ones, which are made of the same independent roads in nearly the same shares (simulation.md, "Beside the
//! track"). A line is laid when a wheel first needs it.

use super::{Line, Road, RoadError, RoadSpec};

/// Distances of the lines in m for wheels that wander.
const WANDERING_M: [f64; 10] = [0.0025, 0.005, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32, 0.64, 1.28];

/// How the rear wheels keep to the front ones' track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Following {
    /// Always as far beside it as this, in m.
    Beside(f64),
    /// By a distance that changes.
    Wandering,
}

/// A line beside the track.
#[derive(Debug, Clone)]
struct Beside {
    distance_m: f64,
    road: Option<Road>,
}

/// The road under the wheels of one side.
#[derive(Debug, Clone)]
pub(crate) struct Lane {
    spec: RoadSpec,
    line: Line,
    seed: u64,
    spacing_m: f64,
    speed_m_s: Option<f64>,
    track: Road,
    beside: Vec<Beside>,
}

impl Lane {
    /// Lays the front wheels' track; see [`Road::along`]. `speed_m_s` is the drive's, where it has one.
    pub(crate) fn new(
        spec: &RoadSpec,
        line: Line,
        seed: u64,
        spacing_m: f64,
        speed_m_s: Option<f64>,
        following: Following,
    ) -> Result<Self, RoadError> {
        let distances_m = match following {
            Following::Beside(0.0) => Vec::new(),
            Following::Beside(distance_m) => vec![distance_m.abs()],
            Following::Wandering => WANDERING_M.to_vec(),
        };
        let beside = distances_m.into_iter().map(|distance_m| Beside { distance_m, road: None }).collect();
        let track = Road::lay_out(spec, line, seed, spacing_m, speed_m_s)?;
        Ok(Self { spec: spec.clone(), line, seed, spacing_m, speed_m_s, track, beside })
    }

    /// Height in m at a distance along the road and one beside the track, both in m.
    pub(crate) fn height_m(&mut self, distance_m: f64, beside_m: f64) -> f64 {
        self.read(beside_m, |road| road.height_m(distance_m))
    }

    /// Height in m as the tire feels it: averaged over the contact length.
    pub(crate) fn contact_height_m(&mut self, distance_m: f64, beside_m: f64) -> f64 {
        self.read(beside_m, |road| road.contact_height_m(distance_m))
    }

    fn read(&mut self, beside_m: f64, height: impl Fn(&mut Road) -> f64) -> f64 {
        let beside_m = beside_m.abs();
        let Some(last) = self.beside.len().checked_sub(1).filter(|_| beside_m > 0.0) else {
            return height(&mut self.track);
        };
        let outer = self.beside.partition_point(|line| line.distance_m < beside_m).min(last);
        let outer_m = self.beside[outer].distance_m;
        if beside_m >= outer_m {
            return self.line(outer).map_or(f64::NAN, height);
        }
        let inner_m = outer.checked_sub(1).map_or(0.0, |inner| self.beside[inner].distance_m);
        let share = (beside_m - inner_m) / (outer_m - inner_m);
        let inner_height = match outer.checked_sub(1) {
            Some(inner) => self.line(inner).map_or(f64::NAN, &height),
            None => height(&mut self.track),
        };
        let outer_height = self.line(outer).map_or(f64::NAN, &height);
        inner_height + share * (outer_height - inner_height)
    }

    /// A line, laid now if it was not before. What could be wrong with it would have been wrong with the track.
    fn line(&mut self, number: usize) -> Option<&mut Road> {
        let beside = &mut self.beside[number];
        if beside.road.is_none() {
            let line = self.line.beside(beside.distance_m);
            beside.road = Road::lay_out(&self.spec, line, self.seed, self.spacing_m, self.speed_m_s).ok();
        }
        beside.road.as_mut()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::road::{RoadClass, Side};

    fn lane(following: Following) -> Lane {
        let line = Line::of_track(Side::Right, 1.5);
        Lane::new(&RoadSpec::iso8608(RoadClass::A, 2.0), line, 1, 0.005, None, following).unwrap()
    }

    #[test]
    fn on_the_track_it_is_the_track() {
        let (mut wandering, mut following) = (lane(Following::Wandering), lane(Following::Beside(0.0)));
        let mut road =
            Road::along(&RoadSpec::iso8608(RoadClass::A, 2.0), Line::of_track(Side::Right, 1.5), 1, 0.005)
                .unwrap();
        for x in [-3.0, 0.0, 17.77] {
            assert_eq!(wandering.height_m(x, 0.0), road.height_m(x));
            assert_eq!(following.contact_height_m(x, 0.0), road.contact_height_m(x));
        }
    }

    #[test]
    fn wandering_is_continuous_and_meets_the_lines() {
        let (mut wandering, mut fixed) = (lane(Following::Wandering), lane(Following::Beside(-0.04)));
        for x in [0.0, 5.123, 99.0] {
            let there = fixed.height_m(x, -0.04);
            assert_eq!(wandering.height_m(x, 0.04), there);
            for d in [0.0399999, 0.0400001] {
                assert!((wandering.height_m(x, d) - there).abs() < 1e-7);
            }
        }
        // Farther out than the last line it is the last line.
        assert_eq!(wandering.height_m(1.0, 1.28), wandering.height_m(1.0, 7.0));
    }
}
