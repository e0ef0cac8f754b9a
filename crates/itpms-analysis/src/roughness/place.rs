//! Where on earth a distance of the drive is: positions as a receiver sent them, on straight lines between.

/// Longest way in m between two positions that a straight line goes over: a short tunnel, not a lost receiver.
const LONGEST_WAY_M: f64 = 250.0;
/// Mean radius of the earth in m.
const EARTH_M: f64 = 6.371e6;

/// Positions over the distance driven.
#[derive(Debug, Clone, Default)]
pub struct Way {
    /// Distance in m, latitude and longitude in degrees.
    fixes: Vec<(f64, [f64; 2])>,
}

impl Way {
    /// The position at a distance, in degrees; one that is not known, that is held, or that no place has is passed over.
    pub fn push(&mut self, distance_m: f64, position_deg: [f64; 2]) {
        let [latitude, longitude] = position_deg;
        // A receiver without satellites sends this.
        let is_nowhere = latitude == 0.0 && longitude == 0.0;
        let is_one =
            latitude.abs() <= 90.0 && longitude.abs() <= 180.0 && !is_nowhere && distance_m.is_finite();
        let is_new = |(before_m, before): &(f64, [f64; 2])| distance_m > *before_m && position_deg != *before;
        if is_one && self.fixes.last().is_none_or(is_new) {
            self.fixes.push((distance_m, position_deg));
        }
    }

    pub fn is_empty(&self) -> bool {
        self.fixes.len() < 2
    }

    /// Where a distance is, in degrees: latitude and longitude.
    pub fn at(&self, distance_m: f64) -> Option<[f64; 2]> {
        let later = self.fixes.partition_point(|(at_m, _)| *at_m < distance_m);
        let later = later.clamp(1, self.fixes.len().max(2) - 1);
        let (&(from_m, from), &(to_m, to)) = (self.fixes.get(later - 1)?, self.fixes.get(later)?);
        let share = (distance_m - from_m) / (to_m - from_m);
        // A little beyond the ends the line goes on.
        if !(to_m - from_m <= LONGEST_WAY_M && (-1.0..=2.0).contains(&share)) {
            return None;
        }
        // The short way round, where the date line is between.
        let around = |degrees: f64| (degrees + 180.0).rem_euclid(360.0) - 180.0;
        let longitude = around(from[1] + share * around(to[1] - from[1]));
        Some([from[0] + share * (to[0] - from[0]), longitude])
    }

    /// How far the positions are apart over how far the car has driven between the first and the last, if that is a way: a check of units.
    pub fn length_share(&self) -> Option<f64> {
        let metres = |a: [f64; 2], b: [f64; 2]| {
            let [north, east] = [b[0] - a[0], (b[1] - a[1]) * (0.5 * (a[0] + b[0])).to_radians().cos()];
            EARTH_M * north.to_radians().hypot(east.to_radians())
        };
        let pairs = self.fixes.iter().zip(self.fixes.iter().skip(1));
        let apart_m: f64 = pairs.map(|((_, a), (_, b))| metres(*a, *b)).sum();
        let driven_m = self.fixes.last()?.0 - self.fixes.first()?.0;
        (driven_m > LONGEST_WAY_M).then_some(apart_m / driven_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_two_positions_is_a_straight_line() {
        let mut way = Way::default();
        way.push(0.0, [48.0, 11.0]);
        way.push(0.05, [48.0, 11.0]);
        way.push(50.0, [0.0, 0.0]);
        way.push(60.0, [f64::NAN, 11.0]);
        way.push(100.0, [48.0009, 11.0]);
        assert_eq!(way.fixes.len(), 2);
        assert!((way.at(50.0).unwrap()[0] - 48.000_45).abs() < 1e-9);
        assert!((way.at(110.0).unwrap()[0] - 48.000_99).abs() < 1e-9);
        assert_eq!(way.at(1000.0), None);
        way.push(900.0, [48.009, 11.0]);
        assert_eq!(way.at(500.0), None, "a way of 800 m without a position");
        // One thousandth of a degree of latitude is 111.2 m.
        assert!((way.length_share().unwrap() - 1.112).abs() < 1e-3);
    }

    #[test]
    fn the_date_line_is_crossed_the_short_way() {
        let mut way = Way::default();
        way.push(0.0, [-16.0, 179.9995]);
        way.push(100.0, [-16.0, -179.9995]);
        assert!((way.at(50.0).unwrap()[1].abs() - 180.0).abs() < 1e-9);
        assert_eq!(Way::default().at(5.0), None);
        assert!(Way::default().is_empty());
    }
}
