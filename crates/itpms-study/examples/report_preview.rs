//! Writes a report about an invented drive, to look at the page:
//! `cargo run --example report_preview OUT.html [CORNERS [SECONDS [no-truth]]]`.

use std::error::Error;
use std::fs::File;
use std::io::BufWriter;

#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("expected the path of the page to write")?;
    let corners = arguments.next().map_or(Ok(1), |n| n.parse())?;
    let seconds = arguments.next().map_or(Ok(40.0), |s| s.parse())?;
    let truth_known = arguments.next().as_deref() != Some("no-truth");
    let drive = synthetic::Drive { seconds, rate_hz: 500.0, corners, truth_known };
    let data = synthetic::report(&drive, "mid-size sedan");
    itpms_study::report::write_report(BufWriter::new(File::create(path)?), &data)?;
    Ok(())
}
