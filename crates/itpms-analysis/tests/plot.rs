//! Figures seen from outside: complete, deterministic, self-contained.

use itpms_analysis::plot::{Axis, Figure, Ink, Panel, Stroke};

fn figure() -> Figure {
    let wave = |i: i32| (f64::from(i) * 0.004, 240.0 - 60.0 * (f64::from(i) * 0.001).sin());
    let truth: Vec<_> = (0..10_000).map(wave).collect();
    let band = truth.iter().map(|(x, y)| (*x, y - 12.0, y + 12.0)).collect();
    let diverged = truth.iter().map(|(x, _)| (*x, 220.0 + (x - 10.0).exp())).collect();
    let log = (1..400).map(|i| (f64::from(i) * 0.05, 1e-3 * f64::from(i).powf(-2.1))).collect();
    let time = || Axis::linear("Time", "s").within(0.0, 40.0);
    Figure::new("figure-99", "An <example> & its panels")
        .describe("Two panels.")
        .panel(
            Panel::new("a", "Tire pressure", time(), Axis::linear("Pressure", "kPa").within(100.0, 320.0))
                .stretch(5.0, 9.0, "reset")
                .band("95 % of informed", Ink::Default, band)
                .line("truth", Ink::Truth, Stroke::Solid, truth)
                .line("aekf-ui", Ink::Adaptive, Stroke::Dashed, diverged)
                .level(Ink::Muted, 193.0, "warning threshold")
                .moment(Ink::Muted, 20.0, "drop"),
        )
        .panel(
            Panel::new(
                "b",
                "Spectrum",
                Axis::logarithmic("Frequency", "Hz"),
                Axis::logarithmic("Density", "m²/Hz"),
            )
            .line("Welch", Ink::Extra, Stroke::Solid, log),
        )
        .panel(
            Panel::new("c", "Noise", Axis::linear("Noise", "m/s²"), Axis::linear("Density", ""))
                .bars("histogram", Ink::Light, vec![(-1.0, 0.0, 0.4), (0.0, 1.0, 0.35)])
                .dots("measured", Ink::Truth, vec![(0.5, 0.3, 0.05), (-0.5, 0.2, 0.0)]),
        )
}

#[test]
fn a_figure_is_well_formed_and_the_same_each_time() {
    let svg = figure().svg();
    assert_eq!(svg, figure().svg());
    assert!(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 "));
    assert!(svg.contains("<title>An &lt;example&gt; &amp; its panels</title><desc>Two panels.</desc>"));
    for element in ["svg", "g", "text", "title"] {
        let opened =
            svg.matches(&format!("<{element} ")).count() + svg.matches(&format!("<{element}>")).count();
        assert_eq!(opened, svg.matches(&format!("</{element}>")).count(), "{element}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf "), "no number that is none");
    // Nothing but the namespace names an address, and nothing is loaded.
    assert_eq!(svg.matches("http").count(), 1);
    assert!(!svg.contains("href") && !svg.contains("url("));
}

#[test]
fn many_points_are_thinned_to_what_can_be_seen() {
    // Three curves and a band of 10 000 points each would be over 400 kB.
    assert!(figure().svg().len() < 80_000, "{}", figure().svg().len());
}

#[test]
fn a_curve_that_leaves_the_axes_is_marked() {
    // The arrow is the only filled triangle in the diverged curve's color.
    let svg = figure().svg();
    assert!(svg.contains(&format!("Z\" fill=\"{}\"/>", Ink::Adaptive.color())));
}

#[test]
fn panels_stand_alone_in_html() {
    let html = figure().html();
    assert_eq!(html.matches("<svg xmlns").count(), 3);
    assert!(html.contains("(a) Tire pressure: Pressure (kPa) over Time (s)"));
    assert!(html.contains("class=\"plot-legend\"") && html.contains("class=\"plot-panels plot-columns-2\""));
}

#[test]
fn no_data_is_no_reason_to_fail() {
    let empty = Panel::new("", "Nothing", Axis::linear("x", ""), Axis::logarithmic("y", ""))
        .line("nothing", Ink::Truth, Stroke::Solid, vec![(f64::NAN, 1.0), (0.0, f64::INFINITY)])
        .band("", Ink::Truth, vec![]);
    let svg = Figure::new("empty", "Nothing").panel(empty).svg();
    assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN"));
}

/// Whatever numbers a file has, a chart of them is a chart: well-formed, without a number that is none, of usual length.
#[test]
fn no_number_breaks_a_chart() {
    const NUMBERS: [f64; 15] = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        241.3,
        1e308,
        -1e308,
        1e300,
        1e200,
        1e-320,
        -1e-320,
        5e-324,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
    ];
    for a in NUMBERS {
        for b in NUMBERS {
            for c in NUMBERS {
                for axis in [Axis::linear, Axis::logarithmic] {
                    let panel = Panel::new("", "Extremes", axis("x", "s"), axis("y", "m"))
                        .line("line", Ink::Truth, Stroke::Solid, vec![(0.0, a), (1.0, b), (c, 2.0)])
                        .band("band", Ink::Light, vec![(0.0, a, b), (1.0, b, c)])
                        .bars("bars", Ink::Extra, vec![(a, b, c)])
                        .dots("dots", Ink::Plain, vec![(a, b, c), (0.5, c, a)])
                        .level(Ink::Muted, a, "level")
                        .moment(Ink::Muted, b, "moment")
                        .stretch(a, c, "stretch");
                    let svg = Figure::new("f", "Extremes").panel(panel).svg();
                    assert!(svg.len() < 20_000, "{a} {b} {c}: {} bytes", svg.len());
                    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{a} {b} {c}");
                    assert_eq!(svg.matches("<svg").count(), svg.matches("</svg>").count());
                }
            }
        }
    }
}
