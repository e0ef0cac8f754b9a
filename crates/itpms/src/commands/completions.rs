//! `itpms completions`: tab completion for shells.

use crate::args::{Args, CompletionsArgs};
use crate::exit::Failure;
use crate::screen::Screen;

pub(crate) fn run(args: &CompletionsArgs, screen: &Screen) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Args::shown(), "itpms", &mut script);
    screen.write(&script);
    Ok(())
}
