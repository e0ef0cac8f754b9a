//! `itpms completions`: tab completion for shells.

use std::io;

use clap::CommandFactory as _;

use crate::args::{Args, CompletionsArgs};
use crate::exit::Failure;

pub(crate) fn run(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Args::command(), "itpms", &mut script);
    // A pager that was closed early is no failure.
    let _ = io::Write::write_all(&mut io::stdout(), &script);
    Ok(())
}
