//! The bar below a recording that is played.

use std::sync::Arc;

use plumbline::{Action, Screen, WindowSettings};
use plumbline_engine::view::{Growth, RecordingView, ReplayView, SourceStatus, SourceView};
use plumbline_engine::{Command, JobId, RecordingCommand, SourceCommand, SourceSpec, View};

use crate::fake::{Fake, click, click_containing, says, shows};

fn played(growth: Growth) -> View {
    let replay = ReplayView {
        position: Some(3),
        length: 90,
        playing: true,
        looping: true,
        pairs_per_second: Some(30.0),
        growth,
    };
    let source = SourceView { status: SourceStatus::Running, replay: Some(replay), ..SourceView::default() };
    View { source: Arc::new(source), ..View::default() }
}

#[test]
fn a_recording_that_is_still_written_can_be_followed_and_left() {
    for (growth, asked) in [(Growth::Open, true), (Growth::Followed, false)] {
        let fake = Fake::over(played(growth));
        let mut window = fake.window(WindowSettings { screen: Screen::Live, ..WindowSettings::default() });
        click(&mut window, "Follow");
        assert_eq!(fake.take_sent(), [Command::from(SourceCommand::Follow(asked))]);
    }
    let fake = Fake::over(played(Growth::Ended));
    let window = fake.window(WindowSettings { screen: Screen::Live, ..WindowSettings::default() });
    assert!(shows(&window, "Loop") && !shows(&window, "Follow"), "nothing comes any more");
}

/// A recording of a session is open.
fn opened() -> View {
    let source = SourceView {
        spec: Some(SourceSpec::Recording { file: "sessions/grasped/log.mcap".into(), of_twin: true }),
        ..SourceView::clone(&played(Growth::Ended).source)
    };
    View { source: Arc::new(source), ..View::default() }
}

#[test]
fn a_recording_that_is_open_is_exported_as_a_data_set() {
    let fake = Fake::over(opened());
    let mut window = fake.window(WindowSettings { screen: Screen::Live, ..WindowSettings::default() });
    click(&mut window, "World: recording grasped");
    click_containing(&mut window, "Export as LeRobot data set");
    assert!(says(&window, "one episode with both eyes") && says(&window, "What was being done"));
    fake.take_sent();
    click(&mut window, "Write the data set");
    let wanted = RecordingCommand::ExportLerobot {
        file: "sessions/grasped/log.mcap".into(),
        folder: "sessions/grasped/lerobot".into(),
        task: "Recorded with Plumbline.".to_owned(),
    };
    assert_eq!(fake.take_sent(), [Command::from(wanted)]);
}

#[test]
fn one_at_a_time_is_exported_and_only_where_there_is_one() {
    let exporting = RecordingView { exporting: Some(JobId(3)), ..RecordingView::default() };
    let is_refused = |view: &View| Action::ExportRecording.refusal(view).is_some();
    assert!(!is_refused(&opened()));
    assert!(is_refused(&View { recording: Arc::new(exporting), ..opened() }));
    assert!(is_refused(&View::default()), "nothing was recorded");
}
