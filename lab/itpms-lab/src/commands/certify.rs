//! `itpms lab certify`: the regulations' test procedures, driven and held against their limits.

use itpms_console::{Failure, Folder, Interrupt, Screen, threads};
use itpms_data::out::AtomicFile;
use itpms_lab::certify::{Certificate, Extent, Request, certify, list, procedures};

use super::{driven, failure, json};
use crate::args::CertifyArgs;

pub(crate) fn run(args: &CertifyArgs, screen: &Screen, interrupt: &Interrupt) -> Result<(), Failure> {
    threads::set(args.jobs)?;
    let extent = if args.quick { Extent::Quick } else { Extent::Full };
    let request = Request {
        extent,
        only: args.only.clone(),
        seed: args.seed,
        sensors: args.sensors,
        loads: args.loads,
        repeats: args.repeats,
    };
    let tests = procedures(&request).map_err(|error| failure(error, Failure::Interrupted))?;
    if args.list {
        screen.print_lines(list(&tests).trim_end());
        return Ok(());
    }
    let page = args.report.as_ref().map(|path| AtomicFile::create(path)).transpose()?;
    let folder = args.out.as_deref().map(Folder::open).transpose()?;
    let certificate = driven(screen, interrupt, |look| certify(&request, look))?;
    let json = json(&certificate)?;
    if let Some(folder) = &folder {
        folder.fill(files(&certificate, &json), screen)?;
    }
    if let Some(mut page) = page {
        page.append(certificate.page().as_bytes())?;
        page.commit()?;
    }
    screen.print_lines(if args.json { json } else { certificate.table().trim_end().to_owned() });
    args.strict.judge(certificate.failed(), "tests that failed")
}

/// Page, figures, pressures over time, and everything as JSON.
fn files(certificate: &Certificate, json: &str) -> Vec<(String, String)> {
    let mut files = vec![
        ("certify.json".to_owned(), format!("{json}\n")),
        ("certify.txt".to_owned(), certificate.table()),
        ("index.html".to_owned(), certificate.page()),
    ];
    files.extend(certificate.figures().iter().map(|figure| (format!("{}.svg", figure.name()), figure.svg())));
    files.extend(certificate.outcomes.iter().map(|outcome| (format!("{}.csv", outcome.name), outcome.csv())));
    files
}
