//! `itpms lab score`: a table for people, JSON for scripts.

use crate::common;

use common::Bench;
use serde_json::Value;

#[test]
fn a_row_as_json() {
    let run = || Bench::new().run("score --seeds 2 --row paper-drop --json").success().to_owned();
    let text = run();
    let score: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(score["version"], 1);
    assert_eq!(score["estimators"], serde_json::json!(["informed"]));
    assert_eq!((&score["seeds"], &score["first_seed"]), (&2.into(), &1.into()));
    let rows = score["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 1);
    assert_eq!((&rows[0]["part"], &rows[0]["name"]), (&"paper".into(), &"paper-drop".into()));
    assert_eq!(rows[0]["drives"], 2);
    let cells = rows[0]["cells"].as_array().unwrap();
    let cell = |name: &str| cells.iter().find(|cell| cell["name"] == name).unwrap();
    let rmse = cell("rmse_median_kpa");
    assert_eq!(rmse["goal"], serde_json::json!({"at_most_stretch": [14.0, 12.5]}));
    assert!(["missed", "met", "stretch"].contains(&rmse["verdict"].as_str().unwrap()));
    // Constant 220 000 N/m would be 58.8 kPa off; two drives of a working estimator are not half of that.
    assert!(rmse["value"].as_f64().unwrap() < 30.0, "{rmse}");
    assert!(cell("coverage")["goal"].is_null() && cell("bound_rms_kpa")["value"].as_f64().unwrap() > 5.0);
    // The same seeds give the same figures, in whatever order the drives were done.
    assert_eq!(text, run());
}

#[test]
fn a_table_fits_a_terminal() {
    let outcome = Bench::new().run("score --seeds 1 --estimator all");
    let table = outcome.success();
    for name in ["paper-drop-recover", "aekf-ui-informed", "ekf-ui", "stretch"] {
        assert!(table.contains(name), "{table}");
    }
    assert!(table.lines().all(|line| line.chars().count() <= 110), "{table}");
    assert!(table.is_ascii(), "{table}");
    // No progress where standard error is no terminal; what is not in the table is.
    assert!(outcome.stderr.lines().count() == 1 && outcome.stderr.contains("--row own"), "{outcome:?}");
}

#[test]
fn what_makes_no_sense_is_refused() {
    let bench = Bench::new();
    let refusal = bench.run("score --seeds 1 --estimator all --row road");
    assert!(refusal.refusal().starts_with("road is scored for one estimator at a time"));
    for line in ["score --seeds 0", "score --row nonsense", "score --estimator nobody"] {
        assert_eq!(bench.run(line).code, Some(2), "{line}");
    }
}

#[test]
fn a_missed_goal_ends_with_exit_code_1_where_it_is_strict() {
    // The published filters find no stiffness: their rows miss.
    let line = "score --seeds 1 --row paper-drop --estimator ekf-ui";
    let bench = Bench::new();
    let (lenient, strict) = (bench.run(line), bench.run(&format!("{line} --strict")));
    assert!(lenient.success().contains("MISSED"), "{lenient:?}");
    assert_eq!((strict.code, &strict.stdout), (Some(1), &lenient.stdout));
    assert!(strict.stderr.starts_with("error: --strict: rows that miss a goal: 1"), "{strict:?}");
}
