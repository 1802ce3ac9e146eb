//! The bar below a recording that is played.

use std::sync::Arc;

use plumbline::{Screen, WindowSettings};
use plumbline_engine::view::{Growth, ReplayView, SourceStatus, SourceView};
use plumbline_engine::{Command, SourceCommand, View};

use crate::fake::{Fake, click, shows};

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
