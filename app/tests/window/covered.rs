//! Every screen in both themes at small and usual sizes and at 200 %: no text is cut, no text lies on
//! another one, nothing that can be clicked covers a part of something else that can. Read from what is
//! painted and what senses clicks, so that nobody has to look.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::Rect;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use plumbline::{Pane, PlumblineWindow, Screen, ThemeChoice, WindowSettings};
use plumbline_engine::view::{
    KeptView, LiveView, RecordedSoFar, RecordingState, RecordingView, RobotView, SourceStatus, SourceView,
    ThreadFault,
};
use plumbline_engine::{RobotCommand, View, WatchedThread};

use crate::fake::Fake;
use crate::layout::{Line, SLACK, cut, lines, much_to_show, overlapping};
use crate::{made_up, made_up_gap, made_up_touch};

/// What senses clicks and is thinner than this is the bar of a scrolled area, which floats over its edge, pt.
const SCROLL_BAR: f32 = 12.0;

/// How high the bottom line is, pt.
const BOTTOM_LINE: f32 = 52.0;
/// The one button in it is at least so high, pt.
const NEXT_HEIGHT: f32 = 36.0;

/// Size, pt, and scale; the last one is a window of 1440 by 900 at 200 %.
const SIZES: [([f32; 2], f32); 4] =
    [([1024.0, 700.0], 1.0), ([1280.0, 800.0], 1.0), ([1440.0, 900.0], 1.0), NARROW];
const NARROW: ([f32; 2], f32) = ([720.0, 450.0], 2.0);

/// What senses clicks: parts of two of them that lie on each other. That one lies wholly within another is
/// how rows hold buttons.
fn covered(window: &Harness<'_, PlumblineWindow>) -> Vec<String> {
    let layers: Vec<Vec<Rect>> = window.ctx.viewport(|viewport| {
        let senses = |widgets: &[egui::WidgetRect]| {
            let clicked = widgets.iter().filter(|widget| widget.visible && widget.sense.senses_click());
            clicked.map(|widget| widget.interact_rect).filter(|rect| rect.is_positive()).collect()
        };
        viewport.prev_pass.widgets.layers().map(|(_, widgets)| senses(widgets)).collect()
    });
    assert!(layers.iter().flatten().count() > 5, "this test must be able to see what senses clicks");
    let mut faults = Vec::new();
    for rects in layers {
        let rects: Vec<&Rect> = rects.iter().filter(|rect| rect.size().min_elem() > SCROLL_BAR).collect();
        for (i, a) in rects.iter().enumerate() {
            for b in &rects[i + 1..] {
                let within = a.expand(SLACK).contains_rect(**b) || b.expand(SLACK).contains_rect(**a);
                if !within && a.intersect(**b).size().min_elem() > SLACK {
                    faults.push(format!("one part of the window takes the clicks of another: {a} and {b}"));
                }
            }
        }
    }
    faults
}

/// STOP and the one button of the bottom line stand whole in the window.
fn cut_buttons(window: &Harness<'_, PlumblineWindow>, size: [f32; 2]) -> Vec<String> {
    let room = Rect::from_min_size(egui::Pos2::ZERO, size.into());
    let buttons = window.query_all_by_role(egui::accesskit::Role::Button);
    let named = buttons.map(|button| (button.accesskit_node().label().unwrap_or_default(), button.rect()));
    let is_next = |rect: &Rect| {
        rect.height() >= NEXT_HEIGHT && (rect.center().y - room.bottom() + 0.5 * BOTTOM_LINE).abs() < 1.0
    };
    let kept: Vec<_> = named.filter(|(label, rect)| label.contains("STOP") || is_next(rect)).collect();
    assert!(kept.iter().any(|(label, _)| label.contains("STOP")), "STOP is there");
    let cut = kept.iter().filter(|(_, rect)| !room.contains_rect(*rect));
    cut.map(|(label, rect)| format!("outside of the window: {label:?} at {rect}")).collect()
}

fn faults(view: &View, screen: Screen, size: ([f32; 2], f32), theme: ThemeChoice) -> Vec<String> {
    let settings = WindowSettings { theme, screen, zoom: size.1, ..WindowSettings::default() };
    faults_of(view, settings, size)
}

fn faults_of(view: &View, settings: WindowSettings, (size, zoom): ([f32; 2], f32)) -> Vec<String> {
    let (screen, theme) = (settings.screen, settings.theme);
    let fake = Fake::over(view.clone());
    let mut window = fake.window_of_size(settings, size);
    window.run_steps(4);
    let lines = lines(&window);
    assert!(lines.len() > 10, "{screen:?} draws texts");
    let mut faults = overlapping(&lines);
    faults.extend(covered(&window));
    faults.extend(top_line(&lines));
    faults.extend(cut_buttons(&window, size));
    // Its tables scroll sideways.
    if screen != Screen::Scores {
        faults.extend(cut(&lines));
    }
    faults.iter().map(|fault| format!("{screen:?} {theme:?} {size:?} {zoom}: {fault}")).collect()
}

/// In all sizes and themes.
fn all_faults(view: &View, screen: Screen) -> Vec<String> {
    let mut all = Vec::new();
    for size in SIZES {
        for theme in [ThemeChoice::Light, ThemeChoice::Dark] {
            all.extend(faults(view, screen, size, theme));
        }
    }
    all
}

/// In the top line and the bottom line no text gives way.
fn top_line(lines: &[Line]) -> Vec<String> {
    let top = lines.iter().filter(|line| line.is_elided && line.rect.bottom() < 60.0);
    top.map(|line| format!("elided: {:?} at {}", line.text, line.rect)).collect()
}

fn assert_none(all: &[String]) {
    assert!(all.is_empty(), "{} faults:\n{}", all.len(), all.join("\n"));
}

/// Everything that the top line can hold at once, and STOP is latched.
fn crowded() -> View {
    let robot = RobotView { stopped: true, ..made_up::connected() };
    let fault = |thread: WatchedThread| ThreadFault {
        thread,
        meaning: thread.meaning_of_end().into(),
        said: Some("index out of bounds".into()),
        since: Instant::now(),
        can_start_again: true,
    };
    let so_far = RecordedSoFar { time: Duration::from_secs(3725), dropped: 12, ..RecordedSoFar::default() };
    let state = RecordingState::On { session: PathBuf::from("sessions/now"), so_far };
    let mut live = LiveView::default();
    live.statistics.source.newest_at = Instant::now().checked_sub(Duration::from_secs(700));
    View {
        robot: Arc::new(robot),
        recording: Arc::new(RecordingView { state, ..RecordingView::default() }),
        source: Arc::new(SourceView { status: SourceStatus::Running, ..SourceView::default() }),
        live: Arc::new(live),
        threads: Arc::from([fault(WatchedThread::Detect), fault(WatchedThread::Corners)]),
        touch: Arc::new(made_up_touch::running()),
        kept: Arc::new(KeptView {
            problem: Some("the disk is nearly full".into()),
            journal_lost: 12,
            ..KeptView::default()
        }),
        lost_commands: 3,
        ..made_up_gap::with(made_up_gap::added())
    }
}

#[test]
fn no_text_is_cut_or_covered_on_any_screen() {
    let mut all = Vec::new();
    for view in [View::default(), made_up::everything()] {
        for screen in Screen::ALL {
            all.extend(all_faults(&view, screen));
        }
    }
    assert_none(&all);
}

#[test]
fn no_text_is_cut_or_covered_where_the_top_line_is_full() {
    let mut all = Vec::new();
    for screen in [Screen::Live, Screen::Robot, Screen::Touch] {
        all.extend(all_faults(&crowded(), screen));
    }
    assert_none(&all);
}

#[test]
fn no_text_is_cut_or_covered_where_there_is_much_to_show() {
    let mut all = Vec::new();
    for (screen, view) in much_to_show() {
        all.extend(all_faults(&view, screen));
    }
    assert_none(&all);
}

/// In the narrow window the panes of a screen stand behind each other: each one is looked at.
#[test]
fn no_text_is_cut_or_covered_in_any_pane_at_twice_the_scale() {
    let mut views: Vec<(Screen, View)> =
        Screen::ALL.into_iter().map(|screen| (screen, made_up::everything())).collect();
    views.extend(much_to_show());
    let mut all = Vec::new();
    for (screen, view) in views {
        for pane in panes(screen) {
            let alone = egui_tiles::Tree::new_tabs(egui::Id::unique(("alone", pane)), vec![pane]);
            let mut settings = WindowSettings { screen, zoom: NARROW.1, ..WindowSettings::default() };
            settings.arrangements.insert(screen, alone);
            let faults = faults_of(&view, settings, NARROW);
            all.extend(faults.into_iter().map(|fault| format!("{pane:?}: {fault}")));
        }
    }
    assert_none(&all);
}

fn panes(screen: Screen) -> Vec<Pane> {
    let mut settings = WindowSettings::default();
    let tiles = settings.arrangement(screen).tiles.tiles();
    let panes = tiles.filter_map(|tile| match tile {
        egui_tiles::Tile::Pane(pane) => Some(*pane),
        egui_tiles::Tile::Container(_) => None,
    });
    panes.collect()
}

#[test]
fn release_works_all_over_whatever_stands_beside_it() {
    for (size, zoom) in SIZES {
        let fake = Fake::over(crowded());
        let settings = WindowSettings { zoom, ..WindowSettings::default() };
        let mut window = fake.window_of_size(settings, size);
        window.run_steps(3);
        let rect = window.get_by_label("Release STOP").rect();
        let room = Rect::from_min_size(egui::Pos2::ZERO, size.into());
        assert!(room.contains_rect(rect), "at {rect} of {size:?}");
        for part in [0.03, 0.25, 0.5, 0.75, 0.97] {
            fake.take_sent();
            let pos = egui::pos2(egui::lerp(rect.x_range(), part), rect.center().y);
            let modifiers = egui::Modifiers::NONE;
            window.event(egui::Event::PointerMoved(pos));
            for pressed in [true, false] {
                let button = egui::PointerButton::Primary;
                window.event(egui::Event::PointerButton { pos, button, pressed, modifiers });
                window.run_steps(1);
            }
            assert_eq!(
                fake.take_sent(),
                [plumbline_engine::Command::from(RobotCommand::ReleaseStop)],
                "{part} of the button at {size:?}, {zoom}"
            );
        }
    }
}
