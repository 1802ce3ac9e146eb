//! The whole life of a run, with a robot that does what it is told when the test says so.

mod planning;
mod raised;
mod screen;
mod session;
mod under_way;

use std::path::Path;

use plumbline_model::Session;

use super::testing::Desk;
use super::view::TouchPhase;

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder for the test")
}

fn rows(session: &Path) -> usize {
    Session::read(session).expect("readable").touches.map_or(0, |table| table.row_count())
}

fn paused(desk: &Desk) -> String {
    match desk.view().phase {
        TouchPhase::Paused { why } => why.unwrap_or_default(),
        other => panic!("not paused: {other:?}"),
    }
}
