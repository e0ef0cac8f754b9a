//! `itpms lab score`: a table for people, JSON for scripts.

use serde_json::Value;

use crate::common::Bench;

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
