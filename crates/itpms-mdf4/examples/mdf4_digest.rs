//! Reads all numbers of an MDF4 file and prints what they are, for the judge in .ci/mdf4_judge.py and for measuring:
//!
//!     cargo run --release -p itpms-mdf4 --example mdf4_digest -- FILE
//!
//! A line per channel, its cells separated by tabs: group, channel, unit, comment, number of samples, how many of them
//! are missing, and the digest of the others: for the n-th sample from zero, that is the bits of the value times 2n+1,
//! all added up modulo 2^64. What was repaired and the time it took are reported on standard error.

use std::error::Error;
use std::io::Write;
use std::path::Path;
use std::time::Instant;

use itpms_mdf4::{ChannelKind, Mdf4Reader};

#[derive(Default, Clone)]
struct Digest {
    missing: u64,
    sum: u64,
}

impl Digest {
    fn add(&mut self, value: f64, number: u64) {
        if value.is_nan() {
            self.missing += 1;
        } else {
            // Zero has one digest, whatever its sign.
            self.sum = self.sum.wrapping_add((value + 0.0).to_bits().wrapping_mul(2 * number + 1));
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let Some(file) = std::env::args().nth(1) else { return Err("expected FILE".into()) };
    let started = Instant::now();
    let reader = Mdf4Reader::open(Path::new(&file))?;
    let mut out = std::io::stdout().lock();
    for repair in reader.repairs() {
        eprintln!("{repair}");
    }
    let mut samples = 0;
    for (index, group) in reader.groups().iter().enumerate().filter(|(_, group)| group.has_time) {
        let numbers: Vec<usize> =
            (0..group.channels.len()).filter(|c| group.channels[*c].kind == ChannelKind::Number).collect();
        let mut cursor = reader.cursor(index, &numbers)?;
        let mut digests = vec![Digest::default(); numbers.len()];
        let mut values = vec![0.0; numbers.len()];
        let mut count = 0;
        while cursor.next(&mut values)?.is_some() {
            for (digest, value) in digests.iter_mut().zip(&values) {
                digest.add(*value, count);
            }
            count += 1;
        }
        samples += count;
        for repair in cursor.repairs() {
            eprintln!("{repair}");
        }
        for (channel, digest) in numbers.iter().map(|c| &group.channels[*c]).zip(digests) {
            let (name, unit, comment) = (&channel.name, &channel.unit, &channel.comment);
            let Digest { missing, sum } = digest;
            writeln!(out, "{}\t{name}\t{unit}\t{comment}\t{count}\t{missing}\t{sum}", group.name)?;
        }
    }
    let seconds = started.elapsed().as_secs_f64();
    let megabytes = std::fs::metadata(&file)?.len() as f64 / 1e6;
    eprintln!("{samples} samples, {megabytes:.0} MB, {seconds:.2} s, {:.0} MB/s", megabytes / seconds);
    Ok(())
}
