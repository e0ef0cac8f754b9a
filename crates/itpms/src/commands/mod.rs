//! One file per command. A command reads its inputs, writes its outputs and says in a few lines what it found.

pub(crate) mod completions;
pub(crate) mod simulate;
