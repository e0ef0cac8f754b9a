//! One recording, however a logger or a person has laid it down: each table gives the rows of its plain twin. Two recordings in one are
//! refused, and what the refusal says, followed, gives the twin's rows.

mod made;

use std::fs;

use itpms_core::model::Corner;
use itpms_data::LogRow;

use made::{NAMES, RATE_HZ, clocked, day, drive, number, plain, read, read_where, same, table};

use crate::common::Bench;

#[test]
fn every_clock_and_every_dialect_of_a_recording_is_its_plain_twin() {
    let bench = Bench::new();
    let rows = drive(0);
    let expected = read(&bench.write("plain.csv", plain(&rows))).unwrap().rows;
    let names = NAMES.join(",");
    let called = |time: &str| names.replace("time_s", time);
    let (first, second) = rows.split_at(3000);
    let swapped = |row: &[f64; 6]| [row[0], row[1], row[4], row[5], row[2], row[3]];
    let other_order =
        "time_s,speed_m_s,rl_body_accel_m_s2,rl_wheel_accel_m_s2,fl_body_accel_m_s2,fl_wheel_accel_m_s2";
    let reordered =
        plain(first) + &table(other_order, &second.iter().map(swapped).collect::<Vec<_>>(), |_, v| number(v));
    let with_units = plain(first) + &plain(second).replacen('\n', "\ns,m/s,m/s2,m/s2,m/s2,m/s2\n", 1);
    let held: String = plain(&rows)
        .lines()
        .enumerate()
        .flat_map(|(k, line)| {
            let again = |i: usize| match line.split_once(',') {
                Some((_, rest)) if k > 0 => {
                    format!("{:.5},{rest}\n", (k - 1) as f64 / RATE_HZ + i as f64 / 800.0)
                }
                _ => format!("{line}\n"),
            };
            (0..if k == 0 { 1 } else { 4 }).map(again).collect::<Vec<_>>()
        })
        .collect();
    let bars: Vec<String> =
        NAMES[1..].iter().map(|name| format!("\"{name}\"|\"\"|-100.0|100.0|200")).collect();
    let bars = format!("\"Interval\"|\"ms\"|0|0|200,{}", bars.join(","));
    let race = format!(
        "This file is created by a logger ( http://x.y/ ).\nFormat,3\nNote,\"two\nlines\"\n\n\
         timestamp,lap,speed,speed,{}\nunix time,,m/s,m/s,m/s2,m/s2,m/s2,m/s2\n,,100: gps,calc,101: imu,101: imu,101: imu,101: imu",
        NAMES[2..].join(",")
    );
    let race: String = rows.iter().enumerate().fold(race + "\n", |text, (k, row)| {
        let gps = if k % 10 == 0 { number(row[1]) } else { String::new() };
        let rest = row[2..].iter().map(|value| number(*value)).collect::<Vec<_>>().join(",");
        text + &format!("{:.3},1,{gps},{},{rest}\n", 1.7e9 + row[0], row[1])
    });
    let vbox = rows.iter().fold(
        format!(
            "File created on 01/08/2026 at 23:59:45\n\n[header]\nsatellites\ntime\nvelocity kmh\nFL body\n\n[comments]\nby hand\n\n\
             [column names]\nsats time velocity {}\n\n[data]\n",
            NAMES[2..].join(" ")
        ),
        |text, row| {
            let rest = row[2..].iter().map(|value| number(*value)).collect::<Vec<_>>().join(" ");
            text + &format!("009 {} {} {rest}\n", day(86_385.0 + row[0], ""), 22.22 * 3.6)
        },
    );
    let months = "05-Aug-2026 18:57:46";
    let dated = |t: f64| months.replace("18:57:46", &day(68_266.0 + t, ":"));
    let fortran = |v: f64| format!("{v:.4E}").replace('E', "D");
    let others =
        "Zeit_ms;v_Fzg [km/h];az_Aufbau_VL [m/s2];az_Rad_VL [m/s2];az_Aufbau_HL [m/s2];az_Rad_HL [m/s2]";
    let comma = |place: usize, v: f64| match place {
        0 => number((v * 1e6).round() / 1e3),
        _ => number(if place == 1 { v * 3.6 } else { v }),
    };
    let others =
        table(&others.replace(';', ","), &rows, comma).replace('.', "#").replace(',', ";").replace('#', ",");
    for (name, text, words) in [
        ("midnight.csv", clocked(&called("Time"), &rows, |t| day(86_385.0 + t, ":")), "midnight"),
        (
            "midnight as a number.csv",
            clocked(&names, &rows, |t| number((86_385.0 + t) % 86_400.0)),
            "midnight",
        ),
        (
            "summer time ends.csv",
            clocked(&called("Time"), &rows, |t| {
                format!("2026-10-25 {}", day(10_785.0 + t - if t < 15.0 { 0.0 } else { 3600.0 }, ":"))
            }),
            "an hour",
        ),
        ("packed.csv", clocked(&called("time"), &rows, |t| day(34_245.0 + t, "")), "packed"),
        ("packed at midnight.csv", clocked(&called("time"), &rows, |t| day(86_385.0 + t, "")), "packed"),
        ("reordered.csv", reordered, ""),
        ("with units again.csv", with_units, ""),
        ("minus.csv", plain(&rows).replace('-', "\u{2212}"), ""),
        ("fortran.csv", table(&names, &rows, |place, v| if place == 0 { number(v) } else { fortran(v) }), ""),
        ("held.csv", held, "stand for several rows"),
        ("bars.csv", clocked(&bars, &rows, |t| number((t * 1e3).round())), "Interval"),
        ("race.csv", race, "speed is there 2 times"),
        ("drive.vbo", vbox, "midnight"),
        ("telephone.csv", clocked(&called("Device Time"), &rows, dated), "Device Time"),
        ("other names.csv", others, "az_Rad_VL"),
    ] {
        let found = read(&bench.write(name, text)).unwrap_or_else(|text| panic!("{name}: {text}"));
        let rounded = |row: &LogRow| LogRow { speed_m_s: (row.speed_m_s * 1e9).round() / 1e9, ..*row };
        let rows: Vec<LogRow> = found.rows.iter().map(rounded).collect();
        same(&rows, &expected, name);
        assert!(
            found.remarks.iter().any(|remark| remark.contains(words)) || words.is_empty(),
            "{name}: {:?}",
            found.remarks
        );
    }
}

#[test]
fn a_speed_in_every_tenth_row_is_a_remark() {
    let bench = Bench::new();
    let rising = |row: &[f64; 6]| [row[0], 10.0 + row[0], row[2], row[3], row[4], row[5]];
    let rows: Vec<_> = drive(0).iter().map(rising).collect();
    let expected = read(&bench.write("plain.csv", plain(&rows))).unwrap().rows;
    let every_tenth = table(&NAMES.join(","), &rows, |_, value| number(value));
    let sparse: String = every_tenth
        .lines()
        .enumerate()
        .map(|(k, line)| {
            let cells: Vec<&str> = line.split(',').collect();
            let speed = if k == 0 || (k - 1) % 10 == 0 { cells[1] } else { "" };
            format!("{},{speed},{}\n", cells[0], cells[2..].join(","))
        })
        .collect();
    let found = read(&bench.write("sparse.csv", sparse)).unwrap();
    assert_eq!(found.warnings, Vec::<String>::new());
    assert!(found.remarks.iter().any(|remark| remark.contains("20 times a second")), "{:?}", found.remarks);
    assert_eq!(found.rows.len(), expected.len());
    for (row, plain) in found.rows.iter().zip(&expected).take(5991) {
        assert!((row.speed_m_s - plain.speed_m_s).abs() < 1e-9, "{row:?}");
    }
    // Where each value stands until the next comes, at 20 Hz and at GPS's one a second, also through a stop.
    for every in [10, 200] {
        let moving = |k: usize| if (3000..4400).contains(&k) { 0.0 } else { 10.0 + rows[k][0] };
        let held =
            |k: usize| [rows[k][0], moving(k - k % every), rows[k][2], rows[k][3], rows[k][4], rows[k][5]];
        let table = plain(&(0..rows.len()).map(held).collect::<Vec<_>>());
        let found = read(&bench.write("held.csv", table)).unwrap();
        let remark = format!("{} times a second", 200 / every);
        assert!(found.remarks.iter().any(|text| text.contains(&remark)), "{:?}", found.remarks);
        assert_eq!(found.warnings, Vec::<String>::new());
        let edge = |k: usize| (2800..3200).contains(&k) || (4200..4600).contains(&k) || k > 5800;
        for (k, row) in found.rows.iter().enumerate().filter(|(k, _)| !edge(*k)) {
            assert!((row.speed_m_s - moving(k)).abs() < 1e-9, "{every} {k}: {row:?}");
        }
    }
}

/// -9999, 655.35 and their like.
#[test]
fn a_number_that_stands_for_no_value_is_missing_counted_and_named() {
    let bench = Bench::new();
    let rows = drive(0);
    let with = |stand_in: &str, of: usize| {
        let lines = plain(&rows);
        let lines = lines.lines().enumerate().map(|(k, line)| {
            let cells = line.split(',').enumerate();
            let cells = cells.map(|(at, cell)| if at == of && k % 150 == 9 { stand_in } else { cell });
            cells.collect::<Vec<_>>().join(",") + "\n"
        });
        bench.write("drive.csv", lines.collect::<String>())
    };
    for of in [1, 2, 3] {
        let expected = read(&with("", of)).unwrap().rows;
        for stand_in in ["-9999", "655.35", "1e30"] {
            let found = read(&with(stand_in, of)).unwrap();
            let values = |rows: &[LogRow]| format!("{rows:?}");
            assert_eq!(values(&found.rows), values(&expected), "{stand_in} of {of}");
            let named = |text: &String| text.contains(NAMES[of]) && text.contains(" in 40 rows");
            assert!(found.warnings.iter().any(named), "{:?}", found.warnings);
        }
    }
}

#[test]
fn two_recordings_in_one_table_are_refused_and_the_way_out_gives_one() {
    let bench = Bench::new();
    let (a, b) = (drive(0), drive(1));
    let expected = read(&bench.write("a.csv", plain(&a))).unwrap().rows;
    let lines = |car: &str, rows: &[[f64; 6]]| -> Vec<String> {
        plain(rows).lines().skip(1).map(|line| format!("{car},{line}\n")).collect()
    };
    let header = format!("car,{}\n", NAMES.join(","));
    let in_turns = lines("A", &a).into_iter().zip(lines("B", &b)).map(|(a, b)| a + &b).collect::<String>();
    let mixed = bench.write("mixed.csv", header.clone() + &in_turns);
    let text = read(&mixed).err().unwrap();
    assert!(text.contains("two recordings in turns") && text.contains("--where car=A"), "{text}");
    same(&read_where(&mixed, "car=A").unwrap().rows, &expected, "--where car=A");
    let text = read_where(&mixed, "car=C").err().unwrap();
    assert!(text.contains("no row has car=C"), "{text}");
    let text = read_where(&mixed, "auto=A").err().unwrap();
    assert!(text.contains("no column auto") && !text.contains("mixed.csv: mixed"), "{text}");

    // Three, with the same stamps or between each other's, without a column that tells them apart.
    let c = drive(2);
    for shift in [0.0, 0.001] {
        let at = |k: usize, rows: &[[f64; 6]], of: f64| {
            let time = ((rows[k][0] + of * shift) * 1e6).round() / 1e6;
            [time, rows[k][1], rows[k][2], rows[k][3], rows[k][4], rows[k][5]]
        };
        let three: Vec<[f64; 6]> =
            (0..a.len()).flat_map(|k| [at(k, &a, 0.0), at(k, &b, 1.0), at(k, &c, 2.0)]).collect();
        let text = read(&bench.write("three.csv", plain(&three))).err().unwrap();
        assert!(text.contains("two recordings in turns, or more"), "{text}");
    }

    // Slow ones, of which some stand.
    for (speeds, text) in [
        ([3.0, 3.5, 4.0], "three that are slow"),
        ([20.0, 0.0, 0.0], "one of three that moves"),
        ([0.0, 20.0, 15.0], "one of three that stands"),
    ] {
        let at = |k: usize| {
            let of = |(rows, speed): (&Vec<[f64; 6]>, f64)| {
                let still = if speed > 0.0 { 1.0 } else { 0.05 };
                let [time, _, rest @ ..] = rows[k];
                let [a, b, c, d] = rest.map(|value: f64| (value * still * 100.0).round() / 100.0);
                [time, speed, a, b, c, d]
            };
            [&a, &b, &c].into_iter().zip(speeds).map(of).collect::<Vec<_>>()
        };
        let three: Vec<[f64; 6]> = (0..a.len()).flat_map(at).collect();
        let found = read(&bench.write("slow.csv", plain(&three))).err();
        assert!(
            found.as_ref().is_some_and(|found| found.contains("two recordings in turns, or more")),
            "{text}: {found:?}"
        );
    }

    // A clock that begins again: cut there, each part is a drive; sorted, the halves are in turns.
    let (first, second) = (&a[..3000], &a[3000..]);
    let again: Vec<[f64; 6]> = second
        .iter()
        .map(|row| [((row[0] - 15.0) * 1e3).round() / 1e3, row[1], row[2], row[3], row[4], row[5]])
        .collect();
    let restarted = plain(first) + lines("", &again).concat().replace("\n,", "\n").trim_start_matches(',');
    let text = read(&bench.write("restarted.csv", &restarted)).err().unwrap();
    assert!(text.contains("begins again at line 3002"), "{text}");
    assert!(
        text.contains("cut the file before line 3002") && text.contains("header") && !text.contains("sort"),
        "{text}"
    );
    let all: Vec<&str> = restarted.lines().collect();
    let parts = [all[..3001].join("\n") + "\n", format!("{}\n{}\n", all[0], all[3001..].join("\n"))];
    for (part, rows) in parts.iter().zip([&expected[..3000], &expected[3000..]]) {
        same(&read(&bench.write("part.csv", part)).unwrap().rows, rows, "a part");
    }
    let mut sorted = all[1..].to_vec();
    sorted.sort_by(|a, b| {
        let time = |line: &str| line.split(',').next().unwrap().parse::<f64>().unwrap();
        time(a).total_cmp(&time(b)).then(a.cmp(b))
    });
    let text =
        read(&bench.write("sorted.csv", format!("{}\n{}\n", all[0], sorted.join("\n")))).err().unwrap();
    assert!(text.contains("two recordings"), "{text}");
}

#[test]
fn a_header_with_other_columns_is_where_to_cut() {
    let bench = Bench::new();
    let rows = drive(0);
    let lacking = "time_s,speed_m_s,fl_body_accel_m_s2,fl_wheel_accel_m_s2";
    let second: String = plain(&rows[3000..])
        .lines()
        .skip(1)
        .map(|line| line.split(',').take(4).collect::<Vec<_>>().join(",") + "\n")
        .collect();
    let text =
        read(&bench.write("other.csv", plain(&rows[..3000]) + lacking + "\n" + &second)).err().unwrap();
    assert!(text.contains("line 3002: the header comes again with other columns"), "{text}");
    let part = bench.write("part.csv", format!("{lacking}\n{second}"));
    assert_eq!(read(&part).unwrap().rows.len(), 3000);
}

#[cfg(feature = "parquet")]
#[test]
fn folders_of_parts_hold_one_recording_or_say_which() {
    let bench = Bench::new();
    let [a, b] = [0, 1].map(|k| read(&bench.write("drive.csv", plain(&drive(k)))).unwrap().rows);
    bench.parquet("hive/car=A/part-0.parquet", &a, true);
    bench.parquet("hive/car=B/part-0.parquet", &b, true);
    let hive = bench.path("hive");
    let text = read(&hive).err().unwrap();
    assert!(text.contains("car=A, car=B") && text.contains("--where car=A"), "{text}");
    same(&read_where(&hive, "car=A").unwrap().rows, &a, "car=A");
    same(&read_where(&hive, "car=B").unwrap().rows, &b, "car=B");
    assert!(
        read_where(&hive, "car=*").err().unwrap().contains("car=A/part-0.parquet and car=B/part-0.parquet")
    );
    // Parts by their time are one drive, whatever the folders are called.
    bench.parquet("days/day=1/part-0.parquet", &a[..3000], true);
    bench.parquet("days/day=2/part-0.parquet", &a[3000..], true);
    same(&read(&bench.path("days")).unwrap().rows, &a, "days");
    // Beside each other, without a key.
    bench.parquet("beside/a.parquet", &a, true);
    bench.parquet("beside/b.parq", &b, true);
    let text = read(&bench.path("beside")).err().unwrap();
    assert!(text.contains("the parts a.parquet and b.parq have rows of the same time"), "{text}");

    // The same part under two names, and its rows in another file.
    fs::create_dir_all(bench.path("twice/again")).unwrap();
    bench.parquet("twice/a.parquet", &a, true);
    fs::copy(bench.path("twice/a.parquet"), bench.path("twice/again/a (1).parquet")).unwrap();
    let text = read(&bench.path("twice")).err().unwrap();
    assert!(text.contains("a.parquet and") && text.contains("a (1).parquet have the same bytes"), "{text}");
    bench.parquet("twice/again/a (1).parquet", &a[1000..], true);
    let text = read(&bench.path("twice")).err().unwrap();
    assert!(text.contains("the parts a.parquet and a (1).parquet have rows of the same time"), "{text}");

    // A column that only a later part has.
    bench.parquet("later/part-0.parquet", &a[..3000], false);
    bench.parquet("later/part-1.parquet", &a[3000..], true);
    let later = read(&bench.path("later")).unwrap();
    let front = |row: &LogRow| row.corners[Corner::FrontLeft.index()].unwrap().wheel_accel_m_s2;
    assert!(later.rows[..3000].iter().all(|row| front(row).is_nan()));
    assert!(later.rows[3000..].iter().zip(&a[3000..]).all(|(row, full)| front(row) == front(full)));
    assert!(later.warnings.iter().any(|text| text.contains("fl_wheel_accel_m_s2 is not in one part")));

    // Tables with a log of their own.
    for (name, log) in
        [("delta", "_delta_log/0.json"), ("iceberg", "metadata/v1.metadata.json"), ("hudi", ".hoodie/x")]
    {
        bench.parquet(&format!("{name}/data/part-0.parquet"), &a, true);
        bench.write(&format!("{name}/{log}"), "{}");
        let text = read(&bench.path(name)).err().unwrap();
        assert!(
            text.contains(": a table of") && text.ends_with("'drive.parquet')\"") || name == "hudi",
            "{text}"
        );
    }
    assert!(read(&bench.path("iceberg/data")).is_err());
    // Also where they lie further down.
    bench.parquet("warehouse/db/drive/data/part-0.parquet", &a, true);
    bench.write("warehouse/db/drive/metadata/v1.metadata.json", "{}");
    let text = read(&bench.path("warehouse")).err().unwrap();
    assert!(text.contains("a table of Iceberg"), "{text}");

    // The time of day, over midnight: the parts before it come first, also where the clock goes over it within a part.
    for midnight in [3000, 2000, 4000] {
        let of_day =
            |row: &LogRow| LogRow { time_s: (86_400.0 + row.time_s - a[midnight].time_s) % 86_400.0, ..*row };
        let rows: Vec<LogRow> = a.iter().map(of_day).collect();
        for (name, part) in [("b", &rows[..3000]), ("a", &rows[3000..])] {
            bench.parquet(&format!("night-{midnight}/{name}.parquet"), part, true);
        }
        let found = read(&bench.path(&format!("night-{midnight}"))).unwrap();
        same(&found.rows, &a, "over midnight");
        assert!(found.remarks.iter().any(|remark| remark.contains("midnight")), "{:?}", found.remarks);
    }
    // Two drives of one day stay in their order.
    let later = |row: &LogRow| LogRow { time_s: row.time_s + 50_000.0, ..*row };
    bench.parquet("day/a.parquet", &a[3000..].iter().map(later).collect::<Vec<_>>(), true);
    bench.parquet("day/b.parquet", &a[..3000], true);
    assert!(read(&bench.path("day")).unwrap().rows[0].time_s < 1.0);
}

#[test]
fn what_is_not_read_says_what_makes_it_so() {
    let bench = Bench::new();
    for (name, words) in [
        ("a.zip", "unzip '"),
        ("a.log.gz", "gunzip -k '"),
        ("a.csv.zst", "zstd -d '"),
        ("a.feather", "a.parquet')\""),
        ("a.tdms", "nptdms"),
        ("a.ulg", "ulog2csv"),
        ("a.xlsx", "read_excel"),
        ("a.arrows", "open_stream"),
        ("a.mat", "loadmat"),
        ("a.h5", "h5py"),
        ("a.pcap", "scapy"),
        ("car.arxml", "--dbc"),
    ] {
        let text = read(&bench.write(name, "x")).err().unwrap();
        assert!(text.contains(words) && text.contains("which is not read"), "{name}: {text}");
    }
}
