//! Text behind gzip whose end is missing, padded or without an end; and what lies beside the parts of a table.

use std::fs;
use std::io::Write as _;

use flate2::Compression;
use flate2::write::GzEncoder;
use itpms_data::log::LogOptions;

use crate::common::{Bench, found};

fn table(rows: u32) -> String {
    let row = |k: u32| {
        let wave = f64::from(k * 7919 % 1001) / 100.0 - 5.0;
        format!("{:.3},20.0,{:.2},{wave:.2}\n", f64::from(k) * 0.005, wave / 9.0)
    };
    "time_s,speed_m_s,fl_body_accel_m_s2,fl_wheel_accel_m_s2\n".to_owned()
        + &(0..rows).map(row).collect::<String>()
}

fn packed(text: &str) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(text.as_bytes()).unwrap();
    encoder.finish().unwrap()
}

/// How many rows a file has, and the remarks on it.
fn read(bench: &Bench, bytes: &[u8]) -> Result<(usize, String), String> {
    let found = found(&bench.write("drive.csv.gz", bytes), &LogOptions::default())?;
    Ok((found.rows.len(), found.warnings.join("\n")))
}

#[test]
fn a_packed_table_is_read_up_to_its_last_whole_row() {
    let bench = Bench::new();
    let text = table(20_000);
    let whole = packed(&text);
    assert_eq!(read(&bench, &whole).unwrap(), (20_000, String::new()));
    for share in [0.3, 0.7, 0.99] {
        let (rows, messages) = read(&bench, &whole[..(share * whole.len() as f64) as usize]).unwrap();
        // Deflate holds back some kilobytes.
        let expected = share * 20_000.0;
        assert!((rows as f64) < expected * 1.05 && rows as f64 > expected - 3000.0, "{share}: {rows}");
        assert!(messages.contains("cut off"), "{messages}");
    }
    // Only the checksum is missing: every row is there, and so is the word.
    let (rows, messages) = read(&bench, &whole[..whole.len() - 6]).unwrap();
    assert!(rows == 20_000 && messages.contains("cut off"), "{rows} {messages}");
    // Padding, and members one after the other, as pigz and loggers write them.
    let padded = |zeros: usize| [whole.clone(), vec![0; zeros]].concat();
    for zeros in [1, 511, 200_000] {
        assert_eq!(read(&bench, &padded(zeros)).unwrap(), (20_000, String::new()), "{zeros}");
    }
    let (first, second) = text.split_at(text.len() / 2);
    let members = [packed(first), vec![0; 100], packed(second)].concat();
    assert_eq!(read(&bench, &members).unwrap(), (20_000, String::new()));
    let text = read(&bench, &[whole.clone(), b"rest".to_vec()].concat()).unwrap_err();
    assert!(text.contains("something else than gzip follows"), "{text}");
}

#[test]
fn what_unpacks_without_an_end_is_refused() {
    let bench = Bench::new();
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(table(4000).as_bytes()).unwrap();
    let comment = [&b"#"[..], &[b' '; 4094], b"\n"].concat().repeat(256);
    for _ in 0..420 {
        encoder.write_all(&comment).unwrap();
    }
    let bytes = encoder.finish().unwrap();
    let text = read(&bench, &bytes).unwrap_err();
    assert!(text.contains("bytes unpack to more than") && text.contains("gunzip"), "{text}");
}

#[cfg(feature = "parquet")]
#[test]
fn a_folder_names_what_it_leaves_out() {
    use std::ops::ControlFlow;

    use itpms_data::convert::{Request, convert};
    use itpms_data::log::LogOptions;
    use itpms_data::out::Packing;

    let folder = tempfile::tempdir().unwrap();
    let parts = folder.path().join("drive");
    fs::create_dir(&parts).unwrap();
    let text = folder.path().join("b.csv");
    fs::write(&text, table(4000)).unwrap();
    let options = LogOptions::default();
    let output = parts.join("a.parquet");
    let request = Request {
        input: &text,
        output: &output,
        options: &options,
        packing: Packing::Plain,
        position: false,
    };
    convert(&request, &mut |_| ControlFlow::Continue(())).unwrap().unwrap().file.commit().unwrap();
    let messages = || {
        let mut log = itpms_data::LogReader::open(&parts).unwrap();
        while log.next_row().unwrap().is_some() {}
        log.repairs().warnings().join("\n")
    };
    fs::write(parts.join("_SUCCESS"), "").unwrap();
    assert_eq!(messages(), "");
    fs::copy(&text, parts.join("b.csv")).unwrap();
    fs::write(parts.join("c.mf4"), "x").unwrap();
    assert!(
        messages().contains("2 files of the folder are no Parquet and were left out: "),
        "{}",
        messages()
    );
}
