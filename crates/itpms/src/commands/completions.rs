//! `itpms completions`: tab completion for shells.

use itpms_console::{Failure, Screen};

use crate::args::{Args, CompletionsArgs};

pub(crate) fn run(args: &CompletionsArgs, screen: &Screen) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Args::shown(), "itpms", &mut script);
    screen.write(&script);
    Ok(())
}
