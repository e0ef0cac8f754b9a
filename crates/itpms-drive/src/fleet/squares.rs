//! Squares of 20 m that the roads of a fleet are laid out in, from the equator and along each parallel from Greenwich.

/// Side of a square in m, and length of the pieces of road that it is made of.
pub(super) const SIDE_M: f64 = 20.0;
pub(super) const PIECE_M: f64 = 2.5;
/// Meters in a degree of latitude.
pub(super) const PER_DEGREE_M: f64 = 111_195.0;

fn per_degree_east_m(north: i64) -> f64 {
    PER_DEGREE_M * ((north as f64 + 0.5) * SIDE_M / PER_DEGREE_M).to_radians().cos().max(1e-3)
}

pub(super) fn place_of([latitude, longitude]: [f64; 2]) -> [i64; 2] {
    let north = (latitude * PER_DEGREE_M / SIDE_M).floor() as i64;
    [north, (longitude * per_degree_east_m(north) / SIDE_M).floor() as i64]
}

/// South-west and north-east, longitude first.
pub(super) fn corners_deg([north, east]: [i64; 2]) -> [[f64; 2]; 2] {
    [0, 1].map(|end| {
        [
            (east + end) as f64 * SIDE_M / per_degree_east_m(north),
            (north + end) as f64 * SIDE_M / PER_DEGREE_M,
        ]
    })
}
