//! The first hour of a new user, measured: from the first start on the twin over eyes, mount, screen and
//! touches to a model that is in use and was checked, then the gap, by the button of the bottom line
//! wherever there is one. It counts the clicks, the minutes, the pauses of the arm that nobody asked for and
//! the frames that stutter, prints them as a table, and fails where a limit is broken.

#![allow(clippy::print_stdout, reason = "the table of the run, with --nocapture")]

mod album;
mod busy;
mod legs;
mod table;
mod walk;
mod watch;

use std::path::PathBuf;

use busy::Busy;
use legs::LEGS;
use walk::Walk;

/// From the first start to a model that was accepted.
const MOST_CLICKS: usize = 45;

/// The whole way, with two busy programs beside it as well, min.
const MOST_MIN: f64 = 25.0;

fn take_the_hour(title: &str) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // What came of it can be kept, to be looked at in the window.
    let kept = std::env::var_os("PLUMBLINE_KEEP_LAB").map(PathBuf::from);
    let mut walk = Walk::begin(&kept.unwrap_or_else(|| folder.path().join("data")));
    for leg in LEGS {
        walk.take(leg);
    }
    let taken = walk.end();
    println!("{title}\n{taken}");
    let until_model = taken.clicks_until("Models");
    let mut broken: Vec<String> = vec![];
    let mut limit = |holds: bool, said: String| {
        if !holds {
            broken.push(said);
        }
    };
    limit(until_model <= MOST_CLICKS, format!("{until_model} clicks to a model, at most {MOST_CLICKS}"));
    limit(taken.minutes() <= MOST_MIN, format!("{:.1} min, at most {MOST_MIN}", taken.minutes()));
    limit(taken.pauses.is_empty(), format!("pauses of the arm that nobody asked for: {:?}", taken.pauses));
    limit(taken.slow.is_empty(), format!("frames over 100 ms while nothing is computed: {:?}", taken.slow));
    limit(taken.lost.is_empty(), format!("the button of the bottom line led astray: {:?}", taken.lost));
    assert!(broken.is_empty(), "{broken:#?}");
}

#[test]
#[ignore = "takes a quarter of an hour: touches take as long as the robot's"]
fn a_new_user_gets_a_checked_model_and_a_smaller_gap_within_the_limits() {
    take_the_hour("nothing else started by the test");
}

#[test]
#[ignore = "takes a quarter of an hour: touches take as long as the robot's"]
fn two_busy_programs_beside_it_change_nothing_of_that() {
    let _busy = Busy::programs(2);
    take_the_hour("with two busy programs beside it");
}
