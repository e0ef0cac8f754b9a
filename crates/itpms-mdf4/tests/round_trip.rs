//! MDF4 written by us is read by us: names, units, comments and every value, at native rates, compressed or not. (That
//! others read it too is for .ci/mdf4_judge.py.)

use std::path::Path;

use itpms_mdf4::{ChannelSpec, Compression, GroupSpec, Mdf4Reader, Mdf4Writer, SampleFormat};
use proptest::prelude::*;

const COMPRESSIONS: [Compression; 3] = [Compression::None, Compression::Deflate, Compression::Transposed];

fn group(name: &str, channels: Vec<ChannelSpec>) -> GroupSpec {
    GroupSpec { name: name.to_owned(), comment: format!("about {name}"), channels }
}

/// All samples of a group: time first.
fn read(path: &Path, group: usize) -> Vec<Vec<f64>> {
    let reader = Mdf4Reader::open(path).unwrap();
    assert_eq!(reader.repairs(), []);
    let channels: Vec<usize> = (1..reader.groups()[group].channels.len()).collect();
    let mut cursor = reader.cursor(group, &channels).unwrap();
    let (mut rows, mut values) = (Vec::new(), vec![0.0; channels.len()]);
    while let Some(time_s) = cursor.next(&mut values).unwrap() {
        rows.push([&[time_s][..], &values].concat());
    }
    assert_eq!(cursor.repairs(), []);
    assert_eq!(reader.groups()[group].samples, Some(rows.len() as u64));
    rows
}

#[test]
fn groups_at_their_own_rates_come_back_with_names_units_and_values() {
    let dir = tempfile::tempdir().unwrap();
    // A million records of 16 bytes are 17 blocks in two lists, 30 of the other group one block.
    let (fast, slow) = (1_110_000, 30);
    let accel = |i: usize| ((i * i) % 1009) as f64 / 64.0 - 7.0;
    let raw = |i: usize| if i.is_multiple_of(7) { f64::NAN } else { (i % 5000) as f64 - 2500.0 };
    for compression in COMPRESSIONS {
        let path = dir.path().join("two.mf4");
        let channels = vec![
            ChannelSpec {
                comment: "front <left>".to_owned(),
                ..ChannelSpec::new("fl_body", "m/s²", SampleFormat::Float32)
            },
            ChannelSpec::new("raw", "", SampleFormat::Signed16),
            ChannelSpec::new("few", "1", SampleFormat::Unsigned8),
        ];
        let specs = [
            group("fast", channels),
            group("slow", vec![ChannelSpec::new("speed", "m/s", SampleFormat::Float64)]),
            group("never", vec![ChannelSpec::new("nothing", "Pa", SampleFormat::Unsigned64)]),
        ];
        let mut writer = Mdf4Writer::create(&path, &specs, compression).unwrap();
        writer.set_start_ns(1_700_000_000_000_000_000);
        for i in 0..fast {
            writer.write(0, i as f64 * 1e-3, &[accel(i), raw(i), (i % 250) as f64]).unwrap();
            if i % (fast / slow) == 0 {
                writer.write(1, i as f64 * 1e-3, &[i as f64 / 3.0]).unwrap();
            }
        }
        writer.finish().unwrap().commit().unwrap();

        let reader = Mdf4Reader::open(&path).unwrap();
        assert_eq!(reader.start_ns(), 1_700_000_000_000_000_000);
        let names: Vec<&str> = reader.groups().iter().map(|group| group.name.as_str()).collect();
        assert_eq!(names, ["fast", "slow", "never"]);
        let messages: Vec<_> = reader.groups()[0]
            .channels
            .iter()
            .map(|c| (c.name.as_str(), c.unit.as_str(), c.comment.as_str(), c.is_time))
            .collect();
        assert_eq!(
            messages,
            [
                ("time", "s", "", true),
                ("fl_body", "m/s²", "front <left>", false),
                ("raw", "", "", false),
                ("few", "1", "", false)
            ]
        );
        let rows = read(&path, 0);
        assert_eq!(rows.len(), fast);
        for (i, row) in rows.iter().enumerate() {
            assert_eq!((row[0], row[1], row[3]), (i as f64 * 1e-3, accel(i), (i % 250) as f64));
            assert!(row[2] == raw(i) || (row[2].is_nan() && i.is_multiple_of(7)));
        }
        let rows = read(&path, 1);
        assert_eq!(rows.len(), slow);
        assert!(rows.iter().enumerate().all(|(j, row)| row[1] == (j * (fast / slow)) as f64 / 3.0));
        assert_eq!(read(&path, 2), Vec::<Vec<f64>>::new());
    }
}

#[test]
fn what_cannot_be_written_is_named_and_leaves_no_trace() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("narrow.mf4");
    let channels = vec![
        ChannelSpec::new("wide", "", SampleFormat::Float64),
        ChannelSpec::new("byte", "", SampleFormat::Signed8),
    ];
    let specs = [group("g", channels)];
    let mut writer = Mdf4Writer::create(&path, &specs, Compression::None).unwrap();
    let mut refused =
        |group, time, values: &[f64]| writer.write(group, time, values).unwrap_err().to_string();
    assert!(refused(1, 0.0, &[1.0, 2.0]).ends_with("there is no channel group 1"));
    assert!(refused(0, f64::NAN, &[1.0, 2.0]).contains("has the time NaN, expected a finite number"));
    assert!(refused(0, 0.0, &[1.0]).ends_with("has 1 values, expected 2"));
    assert!(refused(0, 0.0, &[1.0, 128.0]).ends_with("is to hold 128, expected a number from -128 to 127"));
    assert!(refused(0, 0.0, &[1.0, f64::INFINITY]).contains("is to hold inf"));
    writer.write(0, 1.0, &[f64::INFINITY, -128.4]).unwrap();
    writer.finish().unwrap().commit().unwrap();
    assert_eq!(read(&path, 0), [[1.0, f64::INFINITY, -128.0]]);
    assert!(Mdf4Writer::create(&dir.path().join("no/such.mf4"), &specs, Compression::None).is_err());
    let many = vec![ChannelSpec::new("x", "", SampleFormat::Float64); (4 << 20) / 8];
    let long = Mdf4Writer::create(&path, &[group("long", many)], Compression::None).unwrap_err().to_string();
    assert!(
        long.ends_with("the records of channel group \"long\" have 4194312 bytes, expected at most 4194304")
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_pipe_is_refused() {
    let refused = Mdf4Writer::create(Path::new("/dev/null"), &[], Compression::None).unwrap_err().to_string();
    assert_eq!(refused, "/dev/null: MDF4 cannot be written into a pipe or device, expected a file");
}

/// A number that a format holds exactly, or none.
fn number(format: SampleFormat) -> BoxedStrategy<f64> {
    use SampleFormat::*;
    // 64-bit integers as far as f64 counts without gaps.
    let whole = |least: i64, most: i64| (least..=most).prop_map(|v| v as f64).boxed();
    let numbers = match format {
        Float64 => any::<f64>().boxed(),
        Float32 => any::<f32>().prop_map(f64::from).boxed(),
        Unsigned8 => whole(0, 255),
        Unsigned16 => whole(0, 65_535),
        Unsigned32 => whole(0, u32::MAX.into()),
        Unsigned64 => whole(0, 1 << 53),
        Signed8 => whole(-128, 127),
        Signed16 => whole(-32_768, 32_767),
        Signed32 => whole(i32::MIN.into(), i32::MAX.into()),
        Signed64 => whole(-(1 << 53), 1 << 53),
    };
    prop_oneof![9 => numbers, 1 => Just(f64::NAN)].boxed()
}

fn format() -> impl Strategy<Value = SampleFormat> {
    use SampleFormat::*;
    prop::sample::select(vec![
        Float64, Float32, Unsigned8, Unsigned16, Unsigned32, Unsigned64, Signed8, Signed16, Signed32,
        Signed64,
    ])
}

type Rows = Vec<(f64, Vec<f64>)>;

fn table() -> impl Strategy<Value = (Vec<SampleFormat>, Rows)> {
    prop::collection::vec(format(), 0..12).prop_flat_map(|formats| {
        let row: Vec<_> = formats.iter().map(|format| number(*format)).collect();
        (Just(formats), prop::collection::vec((-1e9..1e9f64, row), 0..40))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn any_numbers_come_back(
        (formats, rows) in table(), method in 0usize..3, name in "\\PC{0,30}", unit in "\\PC{0,8}",
    ) {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("any.mf4");
        let channels = formats.iter().map(|format| ChannelSpec::new(&name, &unit, *format)).collect();
        let spec = GroupSpec { name: name.clone(), comment: String::new(), channels };
        let mut writer = Mdf4Writer::create(&path, &[spec], COMPRESSIONS[method]).unwrap();
        for (time_s, values) in &rows {
            writer.write(0, *time_s, values).unwrap();
        }
        writer.finish().unwrap().commit().unwrap();
        let found = read(&path, 0);
        prop_assert_eq!(found.len(), rows.len());
        for (found, (time_s, values)) in found.iter().zip(&rows) {
            prop_assert_eq!(found[0], *time_s);
            for (found, value) in found[1..].iter().zip(values) {
                prop_assert!(found == value || (found.is_nan() && value.is_nan()), "{} not {}", found, value);
            }
        }
        let reader = Mdf4Reader::open(&path).unwrap();
        // Names begin and end with what can be seen.
        for channel in reader.groups()[0].channels.iter().skip(1) {
            prop_assert!(name.trim().is_empty() || channel.name == name.trim());
            prop_assert_eq!(&channel.unit, unit.trim());
        }
    }
}
