//! A journal is a replay: the same commands on the same pairs give the same state.

use plumbline_engine::journal::{self, Entry, Journal};
use plumbline_engine::{Command, EyesCommand, LiveCommand, Products};

use crate::common::{Desk, board, board_pairs};

/// What an operator did: collects by itself and by hand, drops, takes back, solves, accepts.
fn session() -> Vec<(Option<usize>, Command)> {
    let (columns, rows) = board().squares();
    let mut session: Vec<(Option<usize>, Command)> = vec![
        (None, EyesCommand::ChooseBoard { columns, rows, square_m: board().square_m }.into()),
        (None, LiveCommand::Want(Products { corners: true, ..Products::default() }).into()),
        (None, EyesCommand::AutoCapture(true).into()),
    ];
    for pair in 0..board_pairs().len() {
        session.push((Some(pair), EyesCommand::MinutesSinceOn(Some(pair as f64)).into()));
    }
    session.push((Some(3), EyesCommand::AutoCapture(false).into()));
    for pair in 0..board_pairs().len() {
        session.push((Some(pair), EyesCommand::Capture.into()));
    }
    for command in [
        EyesCommand::DeleteLast,
        EyesCommand::DropPair { pair: "02.png".into() },
        EyesCommand::Delete { pair: "04.png".into() },
        EyesCommand::Undo,
        EyesCommand::Solve,
        EyesCommand::Accept,
        EyesCommand::RestorePair { pair: "02.png".into() },
    ] {
        session.push((None, command.into()));
    }
    session
}

/// Everything of a state that does not depend on the time of day.
fn essence(desk: &mut Desk) -> String {
    let eyes = desk.view().eyes;
    let pairs: Vec<_> = eyes.collected.iter().map(|pair| (&pair.name, &pair.left, &pair.right)).collect();
    let cameras = eyes.in_use.as_ref().map(|in_use| in_use.calibration.cameras);
    format!("{pairs:?} {:?} {:?} {cameras:?} {:?}", eyes.dropped, eyes.coverage, eyes.minutes_since_on)
}

#[test]
fn the_same_commands_on_the_same_pairs_give_the_same_state() {
    let folders = [(); 3].map(|()| tempfile::tempdir().expect("temporary folder"));
    let mut operator = Desk::new(folders[0].path());
    let mut journal = Journal::start(folders[1].path()).expect("writable");
    let mut shown = Vec::new();
    for (pair, command) in session() {
        if let Some(pair) = pair {
            operator.show(&board_pairs()[pair]);
            shown.push(pair);
        }
        let newest_seq = operator.state.newest_seq();
        journal.note(Entry { at_secs: 0.0, newest_seq, command: command.clone() });
        operator.apply(command);
    }
    drop(journal);

    let file =
        std::fs::read_dir(folders[1].path()).expect("a folder").next().expect("a journal").expect("readable");
    let (_, entries) = journal::read(&file.path()).expect("readable");
    let mut replay = Desk::new(folders[2].path());
    for entry in entries {
        while entry.newest_seq.is_some_and(|seq| replay.state.newest_seq().is_none_or(|newest| newest < seq))
        {
            replay.show(&board_pairs()[shown[replay.seq as usize]]);
        }
        replay.apply(entry.command);
    }
    let essence_of_operator = essence(&mut operator);
    assert!(essence_of_operator.contains("07.png"));
    assert!(operator.view().eyes.in_use.is_some());
    assert_eq!(essence(&mut replay), essence_of_operator);
}
