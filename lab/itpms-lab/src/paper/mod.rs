//! The paper's study made again: every figure and table with numbers from our own drives, the paper's numbers beside
//! them, and an account of the agreement.
//!
//! Called by the binary's `reproduce`, which writes the [`File`]s. Deterministic: the same [`Request`] gives the same
//! bytes on any number of processors. Nothing here looks at a clock, a path or the network.
//!
//! | module | idea |
//! |---|---|
//! | `published`, `assumed` | the paper's numbers; what it does not say |
//! | `case`, `contestant`, `drive`, `plan`, `outcome` | the drives, who takes part, what became of it |
//! | `histories`, `standing`, `changes` | panels, tables and studies that several figures share |
//! | `tire`, `road_input`, `drop`, `readings`, `other_drops`, `mass` | Sections 2 and 4 of the paper |
//! | `bench_input`, `bench`, `bench_changes`, `noise` | Section 5 |
//! | `why` | what the accelerations can tell: the study of observability |
//! | `summary` | the table at the top |
//! | `section`, `data`, `page` | text, figures and tables as a page and as files |

mod assumed;
mod band_pass;
mod bench;
mod bench_changes;
mod bench_input;
mod case;
mod changes;
mod contestant;
mod data;
mod drive;
mod drop;
mod histories;
mod mass;
mod noise;
mod other_drops;
mod outcome;
mod page;
mod plan;
mod published;
mod readings;
mod road_input;
mod section;
mod standing;
mod summary;
mod tire;
mod why;

use itpms_core::model::Corner;
use itpms_sim::scenario::Scenario;

pub use data::Data;
pub use section::{Section, Table};

use crate::runner::{Progress, Result, refused};
use section::Part;

const CORNER: Corner = Corner::FrontLeft;

/// Open points of the paper, and the number of drives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request {
    pub seeds: usize,
    /// Seed of the first; the others follow. The first is the one that is drawn.
    pub first_seed: u64,
    pub rate_hz: f64,
    /// Accelerometer noise of the simulation study in m/s², rms per sample.
    pub noise_m_s2: f64,
    /// Level `Gd(n0)` of the road of both studies in m³; class A of ISO 8608 is 16e-6.
    pub road_gd_n0_m3: f64,
    pub bench_rate_hz: f64,
    pub bench_unsprung_mass_kg: f64,
    /// Natural frequency of the test bed's actuator in Hz.
    pub bench_actuator_hz: f64,
}

impl Default for Request {
    fn default() -> Self {
        Self {
            seeds: 40,
            first_seed: 1,
            rate_hz: 1000.0,
            noise_m_s2: 0.05,
            road_gd_n0_m3: 16e-6,
            bench_rate_hz: 500.0,
            bench_unsprung_mass_kg: 56.9,
            bench_actuator_hz: 30.0,
        }
    }
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct File {
    /// Without a folder.
    pub name: String,
    pub content: String,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    request: Request,
    sections: Vec<Section>,
}

/// Drives everything and lays it out. The progress counts drives; what follows them takes a few seconds.
pub fn reproduce(request: &Request, progress: Progress<'_>) -> Result<Study> {
    if request.seeds == 0 {
        return refused("0 seeds, expected at least one");
    }
    let outcomes = plan::run(request, progress)?;
    let speed_m_s = Scenario::builtin("paper-drop")?.speed.profile_m_s()?.value(0.0);
    let (input, slopes) = road_input::section(request, &outcomes.drop, speed_m_s)?;
    let sections = vec![
        summary::section(&outcomes, slopes, request.seeds)?,
        tire::section()?,
        input,
        drop::section(&outcomes.drop, readings::table(request)?, speed_m_s),
        other_drops::section(&outcomes.deep, &outcomes.recover),
        mass::section(&outcomes.mass),
        bench_input::section(request)?,
        bench::section(&outcomes.bench_drop, &outcomes.bench_recover, &outcomes.bench_slow),
        bench_changes::mass(&outcomes.bench_mass),
        bench_changes::noise(noise::section(request)?, &outcomes.bench_noise),
        why::section()?,
        assumed::section(request),
    ];
    Ok(Study { request: *request, sections })
}

impl Study {
    /// The paper's numbers and ours as text for a terminal.
    pub fn summary(&self) -> String {
        let parts = self.sections.iter().flat_map(|section| &section.parts);
        let table = parts.into_iter().find_map(|part| match part {
            Part::Table { table, .. } => Some(table),
            _ => None,
        });
        // Where, case, paper, ours; the comments are on the page.
        let drives = match self.request.seeds {
            1 => "of one drive".to_owned(),
            n => format!("median over {n} drives (10 - 90 %)"),
        };
        let head = format!("RMSE in kPa unless stated; ours: the default estimator, {drives}");
        table.map_or_else(String::new, |table| format!("{head}\n\n{}", table.text(4)))
    }

    /// The page, each figure as SVG, the data of each figure and table as CSV and JSON. Errors: JSON that cannot be written.
    pub fn files(&self) -> Result<Vec<File>> {
        let file = |name: String, content: String| File { name, content };
        let mut files = vec![file("index.html".to_owned(), page::page(&self.sections, &self.request))];
        let mut write = |data: &Data| -> Result<()> {
            files.push(file(format!("{}.csv", data.name), data.csv()));
            files.push(file(format!("{}.json", data.name), data.json()?));
            Ok(())
        };
        let mut figures = vec![];
        for part in self.sections.iter().flat_map(|section| &section.parts) {
            match part {
                Part::Text(_) => {}
                Part::Figure { figure, data, .. } => {
                    data.iter().try_for_each(&mut write)?;
                    figures.push(file(format!("{}.svg", figure.name()), figure.svg()));
                }
                Part::Table { table, .. } => write(&table.data)?,
            }
        }
        files.extend(figures);
        Ok(files)
    }
}
