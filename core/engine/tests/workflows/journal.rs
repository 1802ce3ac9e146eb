//! A journal is a replay: the same commands on the same pairs give the same state.

use std::path::Path;
use std::time::Duration;

use plumbline_engine::ground::Time;
use plumbline_engine::journal::{self, Entry, Journal};
use plumbline_engine::{
    BoxEdit, Command, ContactWith, EyesCommand, GapCommand, LabelsCommand, LiveCommand, ModelsCommand,
    MountCommand, NoticeCommand, NoticeLevel, Products, ScoresCommand, ScreenContact, SourceCommand,
    TouchCommand,
};
use plumbline_model::{ClassIndex, PixelBox};

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
        journal.note(Entry { at_secs: 0.0, day: None, newest_seq, command: command.clone() });
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

/// A little of every workflow: what is done, and what is refused.
fn a_bit_of_everything(folder: &Path) -> Vec<(Option<usize>, Command)> {
    let (columns, rows) = board().squares();
    let set = folder.join("set");
    let area = PixelBox { x0_px: 20.0, y0_px: 30.0, x1_px: 60.0, y1_px: 80.0 };
    let add = BoxEdit::Add { class: ClassIndex(0), area };
    let contact = |down| ScreenContact { u_px: 5.0, v_px: 7.0, age_s: 0.02, with: ContactWith::Touch, down };
    let names = vec!["cup".to_owned()];
    let products = Products { corners: true, rectified: true, ..Products::default() };
    let mut commands: Vec<(Option<usize>, Command)> = vec![
        (None, EyesCommand::ChooseBoard { columns, rows, square_m: board().square_m }.into()),
        (None, LiveCommand::Want(products).into()),
        (None, EyesCommand::AutoCapture(true).into()),
        (None, LabelsCommand::Create { folder: set, names }.into()),
    ];
    for pair in 0..board_pairs().len() {
        commands.push((Some(pair), LabelsCommand::Capture.into()));
    }
    let others: [Command; 20] = [
        LabelsCommand::Step(1).into(),
        LabelsCommand::NothingHere.into(),
        LabelsCommand::Edit { image: "no such image".to_owned(), edit: add }.into(),
        LabelsCommand::Undo.into(),
        EyesCommand::DeleteLast.into(),
        EyesCommand::Undo.into(),
        EyesCommand::MinutesSinceOn(Some(7.0)).into(),
        MountCommand::Plan.into(),
        MountCommand::Tour.into(),
        MountCommand::Accept.into(),
        TouchCommand::Start.into(),
        TouchCommand::Contact(contact(true)).into(),
        TouchCommand::Contact(contact(false)).into(),
        ModelsCommand::ListSessions.into(),
        ModelsCommand::UseNone.into(),
        GapCommand::UseNominal.into(),
        GapCommand::Find { seed: 1 }.into(),
        ScoresCommand::Evaluate.into(),
        SourceCommand::PairsPerSecond(0.0).into(),
        NoticeCommand::Add { level: NoticeLevel::Info, text: "that was all".to_owned() }.into(),
    ];
    commands.extend(others.map(|command| (None, command)));
    commands
}

/// Everything that the window is shown in the end.
fn shown_in_the_end(mut desk: Desk) -> String {
    format!("{:?}", desk.view())
}

#[test]
fn a_replay_is_exact() {
    let data = tempfile::tempdir().expect("temporary folder");
    let folder = data.path().join("data");
    let journals = tempfile::tempdir().expect("temporary folder");
    let began = Time::now();
    let mut operator = Desk::new(&folder);
    let mut journal = Journal::start(journals.path()).expect("writable");
    let mut shown = Vec::new();
    for (i, (pair, command)) in a_bit_of_everything(&folder).into_iter().enumerate() {
        // A whole number of milliseconds, as exact in the journal as here.
        let at_secs = 0.25 * (i + 1) as f64;
        operator.time = Some(began.after(Duration::from_secs_f64(at_secs)));
        if let Some(pair) = pair {
            operator.show(&board_pairs()[pair]);
            shown.push(pair);
        }
        let newest_seq = operator.state.newest_seq();
        journal.note(Entry { at_secs, day: None, newest_seq, command: command.clone() });
        operator.apply(command);
    }
    drop(journal);
    let in_the_end = shown_in_the_end(operator);
    std::fs::remove_dir_all(&folder).expect("removed");

    let file =
        std::fs::read_dir(journals.path()).expect("a folder").next().expect("a journal").expect("readable");
    let (_, entries) = journal::read(&file.path()).expect("readable");
    let mut replay = Desk::new(&folder);
    for entry in entries {
        replay.time = Some(began.after(Duration::from_secs_f64(entry.at_secs)));
        while entry.newest_seq.is_some_and(|seq| replay.state.newest_seq().is_none_or(|newest| newest < seq))
        {
            replay.show(&board_pairs()[shown[replay.seq as usize]]);
        }
        replay.apply(entry.command);
    }
    let replayed = shown_in_the_end(replay);
    assert!(in_the_end.contains("that was all"), "it came to its end");
    if replayed != in_the_end {
        let same = replayed.bytes().zip(in_the_end.bytes()).take_while(|(a, b)| a == b).count();
        let around = |text: &str| -> String {
            let begin = text.char_indices().map(|(at, _)| at).rfind(|at| *at + 300 <= same);
            text[begin.unwrap_or_default()..].chars().take(600).collect()
        };
        panic!("the replay differs:\n{}\n\nand not\n{}", around(&replayed), around(&in_the_end));
    }
}
