//! Prints the heights of a line along an OpenCRG road as CSV: distance along the reference line and height, both in m.
//!
//!     cargo run --release -p itpms-opencrg --example crg_line -- ROAD.crg 0.5
//!
//! The second word is the line's place in m to the left of the reference line.

use std::error::Error;
use std::path::Path;

use itpms_opencrg::CrgRoad;

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [file, lateral_m] = words.as_slice() else { return Err("expected ROAD.crg LATERAL_M".into()) };
    let road = CrgRoad::read(Path::new(file))?;
    let heights_m = road.line_m(lateral_m.parse()?)?;
    println!("distance_m,height_m");
    for (row, height_m) in heights_m.iter().enumerate() {
        println!("{},{height_m}", road.start_m() + row as f64 * road.increment_m());
    }
    Ok(())
}
