//! A table whose speed stands in every tenth row, as exports of a slow signal beside fast ones have it: whatever is made of it is what
//! the full table gives.

use serde_json::Value;

use crate::common::{Bench, Outcome, table};

/// Two and a half minutes with a puncture, at speeds that lie on straight lines: `full.csv`, `slow.csv` and `car.toml`, of which the
/// wheelbase is assumed.
fn drives() -> Bench {
    let bench = Bench::new();
    let mut scenario = String::from(
        "name = \"own\"\ndescription = \"a puncture\"\nduration_s = 150.0\nrate_hz = 200.0\nsettle_s = 4.0\nwheelbase_m = 2.6\n\
         [speed]\npoints_s_km_h = [[0.0, 70.0], [60.0, 90.0], [150.0, 60.0]]\n[road.surface.iso8608]\nroughness = \"B\"\n\
         slope = 2.0\n[sensor]\nnoise_m_s2 = 0.05\n[car]\n",
    );
    for corner in ["fr", "rl", "rr"] {
        scenario += &format!("[corner.{corner}]\npressure.constant_kpa = 241.3\n");
    }
    scenario += "[corner.fl]\npressure.points_s_kpa = [[110.0, 241.3], [120.0, 150.0]]\n";
    bench.write("own.toml", scenario);
    bench.run("simulate own.toml --seed 5 -o full.csv --vehicle-out real.toml --no-truth").success();
    let assumed =
        bench.read("real.toml").replacen("wheelbase_m = 2.6", "wheelbase_m = 2.7\nwheelbase_sd_m = 0.15", 1);
    bench.write("car.toml", assumed);
    let (header, rows) = table(&bench.read("full.csv"));
    let speed = header.iter().position(|name| name == "speed_m_s").unwrap();
    let line = |(k, row): (usize, &Vec<String>)| {
        let cells = row.iter().enumerate();
        let cells =
            cells.map(|(at, cell)| if at == speed && !k.is_multiple_of(10) { "" } else { cell.as_str() });
        cells.collect::<Vec<_>>().join(",") + "\n"
    };
    let lines: String = rows.iter().enumerate().map(line).collect();
    bench.write("slow.csv", header.join(",") + "\n" + &lines);
    bench
}

/// The same words, whatever the log is called and the last digit of a number is.
fn same_text(full: &str, slow: &str) {
    let slow = slow.replace("slow.", "full.");
    let (full, slow): (Vec<&str>, Vec<&str>) =
        (full.split_whitespace().collect(), slow.split_whitespace().collect());
    assert_eq!(full.len(), slow.len(), "{full:?} {slow:?}");
    for (one, other) in full.iter().zip(&slow) {
        let numbers = one.parse::<f64>().ok().zip(other.parse::<f64>().ok());
        let close = numbers.is_some_and(|(a, b)| (a - b).abs() <= 0.002 * a.abs().max(1.0));
        assert!(one == other || close, "{one} {other}: {full:?} {slow:?}");
    }
}

#[test]
fn every_command_gives_what_the_full_table_gives() {
    let bench = drives();
    let both = |line: &str| -> [Outcome; 2] {
        ["full", "slow"].map(|log| {
            let outcome = bench.run(&line.replace("LOG", log));
            outcome.success();
            outcome
        })
    };
    for line in [
        "vehicle learn LOG.csv --pressure-kpa 241.3 --from car.toml -o LOG.toml -q",
        "vehicle check LOG.csv --vehicle full.toml -q",
        "plot LOG.csv -o LOG.html -q",
        "roughness LOG.csv --vehicle full.toml -q",
        "estimate LOG.csv --vehicle full.toml -o LOG.est.csv --report LOG.report.html --road-out LOG.road.csv -q",
    ] {
        let [full, slow] = both(line);
        same_text(&full.stdout, &slow.stdout);
        assert!(!slow.stderr.contains("speed"), "{}", slow.stderr);
    }
    let wheelbase = |name: &str| {
        let text = bench.read(name);
        let line = text.lines().find_map(|line| line.strip_prefix("wheelbase_m = ")).unwrap().to_owned();
        line.split_whitespace().next().unwrap().parse::<f64>().unwrap()
    };
    assert!((wheelbase("slow.toml") - wheelbase("full.toml")).abs() < 2e-3);
    assert!((wheelbase("slow.toml") - 2.6).abs() < 0.08, "{}", wheelbase("slow.toml"));

    // Tables, fleet and monitor: the pressures.
    let close = |full: &[f64], slow: &[f64], what: &str| {
        assert_eq!(full.len(), slow.len(), "{what}");
        let worst = full.iter().zip(slow).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 0.1, "{what}: {worst} kPa");
    };
    let column = |name: &str, column: &str| -> Vec<f64> {
        let (header, rows) = table(&bench.read(name));
        let at = header.iter().position(|name| name == column).unwrap();
        rows.iter().map(|row| row[at].parse().unwrap()).collect()
    };
    let last = |values: Vec<f64>| values.last().copied().unwrap();
    for corner in ["fl", "fr", "rl", "rr"] {
        let name = format!("{corner}_pressure_kpa");
        let of = |log: &str| column(&format!("{log}.est.csv"), &name)[600..].to_vec();
        close(&of("full"), &of("slow"), &name);
    }
    assert!((last(column("slow.est.csv", "fl_pressure_kpa")) - 150.0).abs() < 25.0);
    both("monitor -q --replay LOG.csv --speed max --vehicle full.toml --json LOG.jsonl");
    let live = |log: &str| -> Vec<f64> {
        let text = bench.read(&format!("{log}.jsonl"));
        let last: Value =
            serde_json::from_str(text.lines().rfind(|line| line.contains("estimate")).unwrap()).unwrap();
        last["wheels"]
            .as_array()
            .unwrap()
            .iter()
            .map(|wheel| wheel["pressure_kpa"].as_f64().unwrap())
            .collect()
    };
    close(&live("full"), &live("slow"), "monitor");
    both("fleet LOG.csv --vehicle full.toml --out LOG.fleet -q");
    let fleet = |log: &str| bench.read(&format!("{log}.fleet/fleet.csv"));
    same_text(&fleet("full").replace(',', " "), &fleet("slow").replace(',', " "));
}
