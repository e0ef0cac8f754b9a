//! Makes an MDF4 file of a wanted size, for the judge in .ci/mdf4_judge.py and for measuring:
//!
//!     cargo run --release -p itpms-mdf4 --example mdf4_make -- FILE MEGABYTES none|deflate|transposed
//!
//! Two groups, `fast` at 1 kHz with eight accelerations and a counter, `slow` at 10 Hz; MEGABYTES counts samples before
//! they are compressed. Every value is a formula of its number, which the judge has as well.

use std::error::Error;
use std::path::Path;

use itpms_mdf4::{ChannelSpec, Compression, GroupSpec, Mdf4Writer, SampleFormat};

/// Sample `i` of channel `k` in m/s²: 16 of 32 bits are noise, as a good sensor's are.
fn accel(i: u64, k: u64) -> f64 {
    let mixed = (i.wrapping_mul(2_654_435_761) + k * 40_503) & 0xffff_ffff;
    (mixed >> 16) as f64 / 4096.0 - 8.0
}

/// Sample `i` of the counter; every hundredth is missing.
fn counter(i: u64) -> f64 {
    if i % 100 == 99 { f64::NAN } else { (i % 60_000) as f64 - 30_000.0 }
}

fn specs() -> [GroupSpec; 2] {
    let corners = ["fl", "fr", "rl", "rr"].iter();
    let names = corners.flat_map(|c| ["body", "wheel"].map(|part| format!("{c}_{part}_accel_m_s2")));
    let mut channels: Vec<ChannelSpec> = names
        .map(|name| ChannelSpec {
            comment: format!("acceleration, {name}"),
            ..ChannelSpec::new(&name, "m/s²", SampleFormat::Float32)
        })
        .collect();
    channels.push(ChannelSpec::new("counter", "", SampleFormat::Signed16));
    let fast = GroupSpec { name: "fast".to_owned(), comment: "1 kHz".to_owned(), channels };
    let channels = vec![
        ChannelSpec::new("speed_m_s", "m/s", SampleFormat::Float64),
        ChannelSpec::new("gear", "", SampleFormat::Unsigned8),
    ];
    [fast, GroupSpec { name: "slow".to_owned(), comment: "10 Hz".to_owned(), channels }]
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, megabytes, compression] = arguments.as_slice() else {
        return Err("expected FILE MEGABYTES none|deflate|transposed".into());
    };
    let compression = match compression.as_str() {
        "none" => Compression::None,
        "deflate" => Compression::Deflate,
        "transposed" => Compression::Transposed,
        _ => return Err("expected none, deflate or transposed".into()),
    };
    // A fast sample has 8 + 8 * 4 + 2 + 1 bytes.
    let samples = (megabytes.parse::<f64>()? * 1e6 / 43.0) as u64;
    let mut writer = Mdf4Writer::create(Path::new(file), &specs(), compression)?;
    let mut values = [0.0; 9];
    for i in 0..samples {
        let time_s = i as f64 / 1000.0;
        (0..8).for_each(|k| values[k] = accel(i, k as u64));
        values[8] = counter(i);
        writer.write(0, time_s, &values)?;
        if i % 100 == 0 {
            let j = i / 100;
            writer.write(1, time_s, &[(j % 400) as f64 / 10.0, (j % 6) as f64])?;
        }
    }
    writer.finish()?.commit()?;
    Ok(())
}
