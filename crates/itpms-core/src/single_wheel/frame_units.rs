//! The work of a pair of frames, in units of which a grid step does one at most: no sample costs much more than another. What a pair says is
//! known [`ORDER`]'s length of steps later, or as much later as there was other work, and always before the next pair is complete.

use super::dynamics::LEVEL_MODES;
use super::gate::SpeedKnowledge;
use super::road_fits::RoadFits;
use super::road_model::Evidence;
use super::{Frame, HOP_S, INDEPENDENT, Informed};
use crate::conditioning::{LEAST_GRID_HZ, STANDING_M_S};
use crate::memory::{Blank, Placed};
use crate::real::Real;

#[derive(Clone, Copy)]
enum Unit {
    /// The road wanders, and is faster or slower met, in every cell; it is decided in which of them roads are fitted.
    Roads,
    /// Roads are fitted to the frame in some of these.
    Fit,
    /// The fit is interpolated between them.
    Interpolate,
    /// Every cell is weighed.
    Weigh,
    /// The pressure begins to leak, or ends it; or nothing is known but that it may have wandered.
    Leaks,
    /// It moves, in one level mode.
    Move(usize),
    /// The road becomes smoother or rougher: what it is then in every cell, and how likely that is.
    MixRoads,
    MixLevels,
    /// The tables follow the car, by two bins of a cell.
    Tables,
}

/// Units in which cells are fitted.
const FITS: u32 = 13;
/// All units, in the order in which they are done. The prediction to the next frame comes before that is there: what is published with
/// it is read for a hop that has the next frame in its middle.
const ORDER: [Unit; 23] = {
    let mut order = [Unit::Fit; 23];
    order[0] = Unit::Roads;
    [order[14], order[15], order[16]] = [Unit::Interpolate, Unit::Weigh, Unit::Leaks];
    [order[17], order[18], order[19]] = [Unit::Move(0), Unit::Move(1), Unit::Move(2)];
    [order[20], order[21], order[22]] = [Unit::MixRoads, Unit::MixLevels, Unit::Tables];
    order
};
const _: () = assert!(LEVEL_MODES == 3 && ORDER.len() == 10 + FITS as usize);
/// A frame's units have to fit into its hop.
const _: () = assert!(ORDER.len() < (HOP_S * LEAST_GRID_HZ) as usize);

/// Whether a grid step does a unit, or leaves it to a later one if there are enough before the next pair: because it is another corner's turn, which is every second
/// step, or because there is other work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Pace {
    Works,
    Yields,
    Waits,
}

/// Remaining work on a pair of frames.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct FrameWork<T: Real> {
    /// Whether there is any, and how many units are done.
    under_way: bool,
    done: usize,
    /// Whether the pressure is to be moved on, and not on a road that repeats itself.
    moves: bool,
    evidence: Evidence<T>,
    log_speed_ratio: T,
    /// Power of the frames over their expectation, the larger of the two.
    nis: T,
    /// The first frame of a pair whose second one is awaited.
    first: Placed<FirstFrame<T>>,
    /// Whether its pairs end when those of the car's other axle begin: no sample works on all corners' frames.
    is_late: bool,
    /// Variance of the pressure in cells² before it moved.
    before_cells2: T,
    fits: RoadFits<T>,
}

impl<T: Real> FrameWork<T> {
    pub(super) fn clear(&mut self) {
        let is_late = self.is_late;
        *self = Self::BLANK;
        self.is_late = is_late;
        if is_late {
            self.first.place(|first| *first = FirstFrame::BLANK);
        }
    }

    /// There is nothing to do, and its pairs end when those of the other axle begin, or with them.
    pub(super) fn set_late(&mut self, is_late: bool) {
        self.is_late = is_late;
        self.clear();
    }

    /// After a pause no frame from before it waits for another one.
    pub(super) fn drop_first(&mut self) {
        if self.first.as_ref().is_some() {
            self.first.place(|first| *first = FirstFrame::BLANK);
        }
    }

    /// Takes a frame; with the second of a pair the work begins.
    fn take(&mut self, frame: FirstFrame<T>, moves: bool) {
        let FirstFrame { evidence, nis, log_speed_ratio } = frame;
        let Some(first) = self.first.as_ref() else {
            return self.first.place(|first| *first = frame);
        };
        self.evidence = first.evidence.with(&evidence);
        self.nis = first.nis.max(nis);
        self.log_speed_ratio = first.log_speed_ratio + log_speed_ratio;
        self.first.clear();
        (self.under_way, self.done, self.moves) = (true, 0, moves);
    }
}

/// A frame that waits for the next one, with which it is learned from: at half the cost, and the pressure moves little meanwhile.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct FirstFrame<T> {
    evidence: Evidence<T>,
    nis: T,
    log_speed_ratio: T,
}

impl<T: Real> Informed<T> {
    /// Takes a complete frame: what it is worth, and what is to be done with it.
    pub(super) fn begin_frame(&mut self, frame: &Frame<T>, speed_m_s: T) {
        let (cell, road) = self.posterior.most_likely();
        let mut evidence = self.evidence(frame, speed_m_s, road.longest_envelope_m());
        let speed = if speed_m_s.is_finite() { SpeedKnowledge::Known } else { SpeedKnowledge::Unknown };
        self.gate.look(&evidence, &self.tables, cell, &road, speed);
        if self.invalid || speed_m_s < T::lit(STANDING_M_S) {
            self.gate.close();
        }
        self.invalid = false;
        let theta = self.tables.theta.get(cell).copied().unwrap_or(T::ZERO);
        let road_near_hop = self.road_near_hop(frame, theta);
        self.persistence.take(road_near_hop);
        let counts = if self.persistence.is_line() { T::zero() } else { self.gate.open() };
        evidence.weight = T::lit(INDEPENDENT) * counts;
        let ratio = speed_m_s / self.last_speed_m_s;
        self.last_speed_m_s = speed_m_s;
        // Where another source follows the tire frames say nothing new: the same road again has the same spectrum again.
        let moves = self.outside.as_ref().is_none();
        if moves {
            self.learned_s += self.gate.open() * T::lit(self.clock.hop_s());
        }
        let known = ratio > T::zero() && ratio.is_finite();
        let log_speed_ratio = if known { ratio.ln() } else { T::zero() };
        self.work.take(FirstFrame { evidence, nis: self.gate.nis(), log_speed_ratio }, moves);
    }

    /// How many units of the newest pair of frames are done.
    pub(crate) fn units_done(&self) -> usize {
        self.work.done
    }

    /// Does one unit of the newest frame's work; true if there is something new to say after it.
    pub(super) fn work_on(&mut self, pace: Pace) -> bool {
        if !self.work.under_way {
            return false;
        }
        let hops_left = u32::from(self.work.first.as_ref().is_none());
        let units_left = ORDER.len() - self.work.done;
        let needed = match pace {
            Pace::Works => usize::MAX,
            Pace::Yields => units_left + units_left / 2,
            Pace::Waits => units_left + 1,
        };
        if needed < self.clock.steps_until(hops_left) {
            return false;
        }
        let unit = ORDER.get(self.work.done).copied().unwrap_or(Unit::Tables);
        self.work.done += 1;
        self.work.under_way = self.work.done < ORDER.len();
        self.do_unit(unit);
        matches!(unit, Unit::Weigh | Unit::Tables)
    }

    fn do_unit(&mut self, unit: Unit) {
        let Self { posterior, tables, work, .. } = self;
        let counts = work.moves && work.evidence.weight > T::zero();
        match unit {
            Unit::Roads if counts => {
                posterior.diffuse_roads(work.log_speed_ratio);
                posterior.meet_road(&work.evidence, tables);
                work.fits.begin(posterior, work.nis, FITS);
            }
            Unit::Fit if counts => work.fits.fit_some(posterior, &work.evidence, tables),
            Unit::Interpolate if counts => work.fits.finish(posterior),
            Unit::Weigh if counts => posterior.weigh(work.fits.log_evidence()),
            Unit::Leaks => {
                work.before_cells2 = posterior.summary().variance_cells2;
                match work.moves {
                    true if counts => posterior.begin_or_end_leaks(),
                    true => posterior.hold(),
                    false => {}
                }
            }
            Unit::Move(level) if counts => posterior.move_cells(level),
            Unit::MixRoads if counts => posterior.mix_roads(),
            Unit::MixLevels if counts => posterior.mix_level_modes(),
            Unit::Tables => {
                tables.refresh_next(&self.body, &self.friction);
                if work.moves {
                    self.note_growth();
                }
            }
            _ => {}
        }
    }

    /// Notes by how much the pressure's variance grew as it moved on.
    fn note_growth(&mut self) {
        let after = self.posterior.summary().variance_cells2;
        self.variance_growth = (after / self.work.before_cells2.max(T::lit(1e-3))).max(T::one());
    }
}
