//! A program that saves references is killed without warning, at 200 random moments: the file is the old one or the new
//! one, every time, and what lies beside it disturbs nothing.
//!
//! What a kill cannot show is a power cut, where what the system still held in memory is lost. There the order counts (contents to the
//! disk, then the name, then the directory; `AtomicFile`), and the checksum (tests/reference.rs tears files at every byte).

use crate::stored;

use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;
use std::{env, fs};

use itpms_data::reference::StoredReference;
use stored::{new, old};

/// Where the child saves; without it, the child has nothing to do.
const WHERE: &str = "ITPMS_TEST_SAVES_TO";
const KILLS: u32 = 200;

/// No test of its own: the program that is killed. Saves the two references in turn until it dies.
#[test]
#[ignore = "the child of the test below"]
fn the_child() {
    let Some(path) = env::var_os(WHERE).map(PathBuf::from) else { return };
    let (old, new) = (old(), new());
    let mut stated = false;
    loop {
        old.save(&path).unwrap();
        new.save(&path).unwrap();
        if !stated {
            // Something on standard error says that the loop has begun; the harness talks on standard output.
            std::io::stderr().write_all(b"!").unwrap();
            stated = true;
        }
    }
}

fn start(path: &Path) -> Child {
    let mut child = Command::new(env::current_exe().unwrap())
        .args(["--exact", "reference_killed::the_child", "--ignored", "--nocapture", "--quiet"])
        .env(WHERE, path)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stderr.as_mut().unwrap().read_exact(&mut [0]).unwrap();
    child
}

/// The next of a fixed row of moments, 0 to 4 ms: several saves on a quick disk, part of one on a slow one.
fn moment(state: &mut u64) -> Duration {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    Duration::from_nanos((*state >> 33) % 4_000_000)
}

fn leftovers(dir: &Path) -> usize {
    fs::read_dir(dir).unwrap().filter(|e| e.as_ref().unwrap().file_name() != "reference").count()
}

#[test]
#[cfg_attr(not(unix), ignore = "killing without warning is tested on Unix only")]
fn killed_at_any_moment_the_file_is_the_old_one_or_the_new_one() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("reference");
    let (old, new) = (old(), new());
    old.save(&path).unwrap();
    let (mut state, mut found_old, mut found_new, mut left_something) = (20_260_301, 0, 0, 0);
    for kill in 0..KILLS {
        let mut child = start(&path);
        std::thread::sleep(moment(&mut state));
        // SIGKILL: nothing in the child gets to know of it.
        child.kill().unwrap();
        child.wait().unwrap();
        match StoredReference::read(&path).unwrap() {
            read if read == old => found_old += 1,
            read if read == new => found_new += 1,
            read => unreachable!("kill {kill}: a third reference: {read:?}"),
        }
        // Every child removes what the one before it left: never more than one's own.
        let left = leftovers(dir.path());
        assert!(left <= 1, "kill {kill}: {left} files beside the reference");
        left_something += left;
    }
    println!("{KILLS} kills: {found_old} old, {found_new} new, {left_something} in the middle of writing");
    // A kill that never meets a save would show nothing. Half of a save's time lies between making the temporary and
    // its renaming, at the very least.
    assert!(left_something > 0 && found_old > 0 && found_new > 0);
    new.save(&path).unwrap();
    assert_eq!(leftovers(dir.path()), 0);
    assert_eq!(StoredReference::read(&path).unwrap(), new);
}
