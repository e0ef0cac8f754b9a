//! `itpms man`: a manual page for each command.

use itpms_console::{Failure, Folder, Screen};

use crate::args::{Args, ManArgs};

pub(crate) fn run(args: &ManArgs, screen: &Screen) -> Result<(), Failure> {
    let folder = Folder::open(&args.out)?;
    let mut command = Args::shown();
    command.build();
    let mut pages = Vec::new();
    render(&command, &mut pages).map_err(|error| Failure::Directory(args.out.clone(), error))?;
    folder.fill(pages, screen)
}

/// The page of a command, then those of the commands under it.
fn render(command: &clap::Command, pages: &mut Vec<(String, String)>) -> std::io::Result<()> {
    let name = command.get_display_name().unwrap_or(command.get_name()).to_owned();
    let mut page = Vec::new();
    clap_mangen::Man::new(command.clone()).render(&mut page)?;
    pages.push((format!("{name}.1"), String::from_utf8_lossy(&page).into_owned()));
    // `help` has no page, and the older spellings have that of `lab`.
    let shown = |under: &&clap::Command| !under.is_hide_set() && under.get_name() != "help";
    command.get_subcommands().filter(shown).try_for_each(|under| render(under, pages))
}
