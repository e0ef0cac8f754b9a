//! Section 2 of the paper: Table 1, the line through it (Fig. 3, eq. 5), and the parameters of Table 2.
//!
//! Called by [`super::reproduce`].

use itpms_core::model::PressureMap;

use super::data::Data;
use super::published::{REGRESSION, TABLE_1, TABLE_2};
use super::section::{Section, Table, number, signed};
use crate::runner::Result;
use itpms_analysis::plot::{Axis, Figure, Ink, Panel, Stroke};

/// The least-squares line through Table 1 and its R².
pub(super) fn regression() -> Result<(PressureMap<f64>, f64)> {
    let pressures = TABLE_1.map(|row| row.1);
    let stiffnesses = TABLE_1.map(|row| row.2);
    Ok(PressureMap::regression(&pressures, &stiffnesses)?)
}

pub(super) fn section() -> Result<Section> {
    let (map, r2) = regression()?;
    let (slope, intercept, paper_r2) = REGRESSION;
    let paper = PressureMap::<f64>::paper_eq_5();
    // What reading a stiffness by the printed line instead of ours does to a pressure.
    let shift = |p: f64| paper.pressure_kpa(map.stiffness_n_per_m(p)) - p;
    let (low, placard, high) = (shift(137.9), shift(241.3), shift(296.5));
    let worst = low.abs().max(placard.abs()).max(high.abs());
    let text = format!(
        "<p>Least squares through the five rows of Table 1 give {ours_slope:.2} N/m per kPa and {ours_zero:.0} N/m, with R² = \
         {r2:.6}. The paper prints {slope} N/m per kPa, {intercept} N/m and R² = {paper_r2}. Ours differ by {d_slope} N/m per kPa \
         ({d_slope_percent} %) and {d_zero} N/m ({d_zero_percent} %). Read by the printed line, a stiffness on our line gives a \
         pressure that is off by {low} kPa at 137.9 kPa, {placard} at 241.3 and {high} at 296.5: at most {worst:.2} kPa, which is \
         nothing beside the errors of any estimator. The points lie so well on a line that R² rounds to 1.000; the printed \
         {paper_r2} does not follow from the printed table. One guess is that it belongs to the single measurements, of which \
         Table 1 gives the means of five.</p>\
         <p>All runs below use the printed line, eq. (5), in the simulated tire and in the estimators alike.</p>",
        ours_slope = map.stiffness_per_kpa(),
        ours_zero = map.stiffness_at_zero(),
        d_slope = signed(map.stiffness_per_kpa() - slope, 3),
        d_slope_percent = signed(100.0 * (map.stiffness_per_kpa() / slope - 1.0), 3),
        d_zero = signed(map.stiffness_at_zero() - intercept, 1),
        d_zero_percent = signed(100.0 * (map.stiffness_at_zero() / intercept - 1.0), 2),
        low = signed(low, 2),
        placard = signed(placard, 2),
        high = signed(high, 2),
    );
    Ok(Section::new("tire", "Tire and car: Tables 1 and 2, Figure 3")
        .table(table_1(&map, &paper), "Measured vertical stiffness as the paper prints it, and what is left of it over both lines.")
        .text(text)
        .figure(
            figure(&map, &paper),
            "Stiffness over pressure: the five measured points, the line that least squares draws through them and its \
             95 % band (t distribution, 3 degrees of freedom), and (b) what is left. The band and the printed line \
             cannot be told from ours at the scale of (a).",
            vec![data(&map, &paper)],
        )
        .table(table_2(), "The simulated car. Simulated plant and estimators use these values unless stated otherwise."))
}

fn table_1(map: &PressureMap<f64>, paper: &PressureMap<f64>) -> Table {
    let column = |pick: fn(&(f64, f64, f64)) -> f64| TABLE_1.iter().map(pick).collect::<Vec<_>>();
    let left = |line: &PressureMap<f64>| TABLE_1.map(|(_, p, k)| k - line.stiffness_n_per_m(p));
    let (ours, theirs) = (left(map), left(paper));
    let data = Data::new("table-01", "Vertical stiffness of the tire over pressure")
        .numbers("pressure_psi", column(|row| row.0))
        .numbers("pressure_kpa", column(|row| row.1))
        .numbers("stiffness_n_per_m", column(|row| row.2))
        .numbers("residual_least_squares_n_per_m", ours)
        .numbers("residual_printed_line_n_per_m", theirs);
    let head =
        ["Pressure (psi)", "Pressure (kPa)", "Stiffness (N/m)", "Over our line (N/m)", "Over eq. (5) (N/m)"];
    let mut table = Table::new("Table 1: Tire tests", &head, data);
    for ((psi, kpa, k), (ours, theirs)) in TABLE_1.iter().zip(ours.iter().zip(theirs)) {
        table =
            table.row([number(*psi, 0), number(*kpa, 1), number(*k, 0), signed(*ours, 0), signed(theirs, 0)]);
    }
    table
}

/// Two-sided 95 % point of Student's t with 3 degrees of freedom.
const T_95_3: f64 = 3.182_446;

fn figure(map: &PressureMap<f64>, paper: &PressureMap<f64>) -> Figure {
    let grid: Vec<f64> = (0..=60).map(|i| 180.0 + 2.0 * f64::from(i)).collect();
    let line = |map: &PressureMap<f64>| grid.iter().map(|&p| (p, map.stiffness_n_per_m(p) / 1e3)).collect();
    let half = |p: f64| T_95_3 * map.map_sd_kpa(p) * map.stiffness_per_kpa();
    let x = || Axis::linear("Pressure", "kPa").within(180.0, 300.0);
    let over = |line: &PressureMap<f64>, p: f64, k: f64| k - line.stiffness_n_per_m(p);
    let above = Panel::new("a", "Stiffness over pressure", x(), Axis::linear("Tire stiffness", "kN/m"))
        .band("95 % of our line", Ink::Default, {
            let edge = |p: f64| {
                (p, (map.stiffness_n_per_m(p) - half(p)) / 1e3, (map.stiffness_n_per_m(p) + half(p)) / 1e3)
            };
            grid.iter().map(|&p| edge(p)).collect()
        })
        .line("least squares, ours", Ink::Default, Stroke::Solid, line(map))
        .line("eq. (5) as printed", Ink::Paper, Stroke::Dashed, line(paper))
        .dots("Table 1", Ink::Truth, TABLE_1.map(|(_, p, k)| (p, k / 1e3, 0.0)).to_vec());
    let below = Panel::new("b", "What is left over our line", x(), Axis::linear("Residual", "N/m"))
        .band("95 % of our line", Ink::Default, grid.iter().map(|&p| (p, -half(p), half(p))).collect())
        .line(
            "eq. (5) as printed",
            Ink::Paper,
            Stroke::Dashed,
            grid.iter().map(|&p| (p, paper.stiffness_n_per_m(p) - map.stiffness_n_per_m(p))).collect(),
        )
        .level(Ink::Default, 0.0, "")
        .dots("Table 1", Ink::Truth, TABLE_1.map(|(_, p, k)| (p, over(map, p, k), 0.0)).to_vec());
    Figure::new("figure-03", "Figure 3: Tire stiffness over pressure")
        .describe("Five measured points on a straight line; residuals below 100 N/m.")
        .panel(above)
        .panel(below)
}

fn data(map: &PressureMap<f64>, paper: &PressureMap<f64>) -> Data {
    let grid: Vec<f64> = (0..=60).map(|i| 180.0 + 2.0 * f64::from(i)).collect();
    let half = |p: f64| T_95_3 * map.map_sd_kpa(p) * map.stiffness_per_kpa();
    Data::new("figure-03", "Lines through Table 1; the points are in table-01")
        .numbers("pressure_kpa", grid.clone())
        .numbers("least_squares_n_per_m", grid.iter().map(|&p| map.stiffness_n_per_m(p)))
        .numbers("half_width_95_n_per_m", grid.iter().map(|&p| half(p)))
        .numbers("eq_5_as_printed_n_per_m", grid.iter().map(|&p| paper.stiffness_n_per_m(p)))
}

fn table_2() -> Table {
    let data = Data::new("table-02", "Parameters of the simulated car")
        .text("symbol", TABLE_2.map(|row| row.0.to_owned()))
        .text("meaning", TABLE_2.map(|row| row.1.to_owned()))
        .numbers("value", TABLE_2.map(|row| row.2))
        .text("unit", TABLE_2.map(|row| row.3.to_owned()));
    let mut table =
        Table::new("Table 2: Parameters of the simulation", &["Symbol", "Meaning", "Value", "Unit"], data);
    for (symbol, meaning, value, unit) in TABLE_2 {
        table = table.row([symbol.to_owned(), meaning.to_owned(), format!("{value}"), unit.to_owned()]);
    }
    table
}
