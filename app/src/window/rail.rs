//! The rail: the steps in the order of work, and how far each one is.

use egui::{Panel, Response, ScrollArea, TextStyle, Ui};
use plumbline_engine::View;
use plumbline_engine::view::{Connection, EyesView, JobState, StepState as EngineStep, TouchPhase};
use plumbline_widgets::format;
use plumbline_widgets::rail::{RailStep, StepState};
use plumbline_widgets::theme::{self, space};

use super::PlumblineWindow;
use crate::operator::guidance::{dropped, guidance};
use crate::operator::{Action, Outbox, Screen};
use crate::panels::shown_calibration;

const WIDTH: f32 = 176.0;
/// Height of all steps with the parts of "Eyes"; where there is less, the parts stand only on their own
/// screens.
const ALL_ROWS: f32 = 602.0;
/// How many steps there are.
const STEPS: f32 = 13.0;
/// Height of what belongs to "Detect".
const DETECT_ROWS: f32 = 52.0;

pub(super) fn show(window: &PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
    let screen = window.settings.screen;
    let view = &window.view;
    let frame = egui::Frame::side_top_panel(ui.style()).inner_margin(space::S);
    let panel = Panel::left("rail").frame(frame).resizable(false).exact_size(WIDTH);
    panel.show_separator_line(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        let wanted = if screen.is_detect() { ALL_ROWS + DETECT_ROWS } else { ALL_ROWS };
        let parts = screen.is_eyes() || ui.available_height() >= wanted;
        let less = if parts { (wanted - ui.available_height()) / STEPS } else { 0.0 };
        // Where the window is lower still, no step is out of reach.
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            let step = |name, state| RailStep::new(name, state).lower_by(less);
            steps(ui, view, screen, parts, &step, outbox);
        });
    });
}

/// `parts`: whether the parts of "Eyes" stand below it; `step`: how one looks.
fn steps<'a>(
    ui: &mut Ui,
    view: &'a View,
    screen: Screen,
    parts: bool,
    step: &dyn Fn(&'a str, StepState<'a>) -> RailStep<'a>,
    outbox: &mut Outbox,
) {
    let commission = step("Commission", commission_state(view));
    if why(commission.selected(screen == Screen::Commission).show(ui), view, Screen::Commission).clicked() {
        outbox.act(Action::Go(Screen::Commission));
    }
    let live = step("Live", StepState::Always).selected(screen == Screen::Live).show(ui);
    if why(live, view, Screen::Live).clicked() {
        outbox.act(Action::Go(Screen::Live));
    }
    let eyes = step("Eyes", eyes_state(view)).number(1).selected(screen.is_eyes()).show(ui);
    if why(eyes, view, eyes_screen(&view.eyes)).clicked() {
        outbox.act(Action::Go(eyes_screen(&view.eyes)));
    }
    for part in Part::ALL.into_iter().filter(|_| parts) {
        part_row(ui, view, part, screen, outbox);
    }
    let mount = step("Mount", or_proposed(&view.mount.step, view.mount.proposal.is_some())).number(2);
    if why(mount.selected(screen == Screen::Mount).show(ui), view, Screen::Mount).clicked() {
        outbox.act(Action::Go(Screen::Mount));
    }
    for (name, number, state, target) in [
        ("Touch", 3, touch_state(view), Screen::Touch),
        ("Models", 4, models_state(view), Screen::Models),
        ("Gap", 5, gap_state(view), Screen::Gap),
        ("Hand-eye", 6, or_proposed(&view.handeye.step, view.handeye.proposal.is_some()), Screen::HandEye),
        ("Grasp", 7, step_state(&view.grasp.step), Screen::Grasp),
    ] {
        let one = step(name, state).number(number).selected(screen == target);
        if why(one.show(ui), view, target).clicked() {
            outbox.act(Action::Go(target));
        }
    }
    ui.add_space(space::S);
    let drift = step("Drift", drift_state(view)).selected(screen == Screen::Drift).show(ui);
    if why(drift, view, Screen::Drift).clicked() {
        outbox.act(Action::Go(Screen::Drift));
    }
    let timeline = step("Timeline", StepState::Always).selected(screen == Screen::Timeline);
    if why(timeline.show(ui), view, Screen::Timeline).clicked() {
        outbox.act(Action::Go(Screen::Timeline));
    }
    let robot = step("Robot", robot_state(view)).selected(screen == Screen::Robot).show(ui);
    if why(robot, view, Screen::Robot).clicked() {
        outbox.act(Action::Go(Screen::Robot));
    }
    let detect = step("Detect", detect_state(view)).selected(screen.is_detect()).show(ui);
    if why(detect, view, Screen::Images).clicked() && !screen.is_detect() {
        outbox.act(Action::Go(Screen::Images));
    }
    if screen.is_detect() {
        detect_rows(ui, view, screen, outbox);
    }
}

/// A step that is pointed at says what it waits for, or what comes next in it: the sentence of its screen.
fn why(step: Response, view: &View, target: Screen) -> Response {
    step.on_hover_ui(|ui| {
        ui.set_max_width(320.0);
        ui.label(guidance(view, target).sentence);
    })
}

/// The order of work within the step "Eyes".
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Board,
    Collect,
    Solve,
    Judge,
    Compare,
    Accept,
}

impl Part {
    const ALL: [Self; 6] =
        [Self::Board, Self::Collect, Self::Solve, Self::Judge, Self::Compare, Self::Accept];

    fn name(self) -> &'static str {
        match self {
            Self::Board => "Board",
            Self::Collect => "Collect",
            Self::Solve => "Solve",
            Self::Judge => "Judge",
            Self::Compare => "Compare",
            Self::Accept => "Accept",
        }
    }

    fn screen(self) -> Screen {
        match self {
            Self::Board | Self::Collect | Self::Solve => Screen::Collect,
            Self::Judge => Screen::Judge,
            Self::Compare | Self::Accept => Screen::Accept,
        }
    }

    /// How far it is, in a word or a number.
    fn value(self, eyes: &EyesView) -> String {
        let fresh = eyes.proposal.as_ref().filter(|proposal| proposal.stale.is_none());
        match self {
            Self::Board => {
                let (columns, rows) = eyes.board.squares();
                format!("{columns}×{rows}, {} mm", eyes.board.square_m * 1000.0)
            }
            Self::Collect if eyes.collected.is_empty() => String::new(),
            Self::Collect => format::count(eyes.collected.len() - dropped(eyes), "pair"),
            Self::Solve if eyes.solving.is_some() => "running".to_owned(),
            Self::Solve if eyes.proposal.is_some() && fresh.is_none() => "again".to_owned(),
            Self::Solve => fresh
                .and_then(|proposal| proposal.calibration.summary.as_ref())
                .map_or_else(String::new, |summary| format::px(summary.rms_stereo_px)),
            Self::Judge => shown_calibration(eyes)
                .and_then(|calibration| calibration.summary.as_ref()?.cross_validated_px)
                .map_or_else(String::new, format::px),
            Self::Compare => fresh
                .and_then(|proposal| proposal.difference.as_ref()?.median_m())
                .map_or_else(String::new, format::mm),
            Self::Accept if eyes.proposal.is_some() => "open".to_owned(),
            Self::Accept if eyes.in_use.is_some() => "in use".to_owned(),
            Self::Accept => String::new(),
        }
    }
}

fn part_row(ui: &mut Ui, view: &View, part: Part, screen: Screen, outbox: &mut Outbox) {
    row(ui, view, part.name(), part.value(&view.eyes), (part.screen(), screen), outbox);
}

/// What belongs to "Detect".
fn detect_rows(ui: &mut Ui, view: &View, screen: Screen, outbox: &mut Outbox) {
    let labeled = match &view.labels.set {
        Some(_) => format::count(view.labels.images.len(), "image"),
        None => String::new(),
    };
    let scored = view.scores.table.as_ref().map(|table| format::count(table.rows.len(), "model"));
    row(ui, view, "Images", labeled, (Screen::Images, screen), outbox);
    row(ui, view, "Scores", scored.unwrap_or_default(), (Screen::Scores, screen), outbox);
}

/// `target`: where a click leads; `open`: the screen that is open.
fn row(
    ui: &mut Ui,
    view: &View,
    name: &str,
    value: String,
    (target, open): (Screen, Screen),
    outbox: &mut Outbox,
) {
    let here = target == open;
    let tokens = theme::tokens(ui);
    let (rect, response) =
        ui.allocate_exact_size(egui::vec2(ui.available_width(), 24.0), egui::Sense::click());
    response.widget_info(|| {
        let mut info = egui::WidgetInfo::selected(egui::Role::Tab, true, here, name);
        info.current_text_value = Some(value.clone());
        info
    });
    if response.hovered() {
        ui.painter().rect_filled(rect, 4.0, tokens.raised);
    }
    if here {
        let line = egui::Rect::from_min_size(rect.left_top() + egui::vec2(15.0, -1.0), egui::vec2(2.0, 26.0));
        ui.painter().rect_filled(line, 0.0, tokens.text_strong);
    }
    let y = rect.center().y;
    let body = TextStyle::Body.resolve(ui.style());
    let small = TextStyle::Small.resolve(ui.style());
    let color = if here { tokens.text_strong } else { tokens.text };
    ui.painter().text(egui::pos2(rect.left() + 28.0, y), egui::Align2::LEFT_CENTER, name, body, color);
    ui.painter().text(
        egui::pos2(rect.right() - 8.0, y),
        egui::Align2::RIGHT_CENTER,
        value,
        small,
        tokens.text_weak,
    );
    if why(response, view, target).clicked() {
        outbox.act(Action::Go(target));
    }
}

/// Where clicking the step leads: to where the work is.
fn eyes_screen(eyes: &EyesView) -> Screen {
    match &eyes.proposal {
        Some(_) => Screen::Judge,
        None if eyes.in_use.is_some() && eyes.collected.is_empty() => Screen::Accept,
        None => Screen::Collect,
    }
}

fn eyes_state(view: &View) -> StepState<'_> {
    let solving = view.eyes.solving.and_then(|id| view.jobs.iter().find(|job| job.id == id));
    if let Some(JobState::Running { fraction, .. }) = solving.map(|job| &job.state) {
        return StepState::Running(*fraction as f32);
    }
    or_proposed(&view.eyes.step, view.eyes.proposal.as_ref().is_some_and(|open| open.stale.is_none()))
}

/// Where all that is missing is accepting what was solved.
const PROPOSED: f32 = 0.75;

fn or_proposed(step: &EngineStep, is_proposed: bool) -> StepState<'_> {
    match step {
        EngineStep::NotDone if is_proposed => StepState::Partly(PROPOSED),
        step => step_state(step),
    }
}

/// A run says how far it is.
fn touch_state(view: &View) -> StepState<'_> {
    let counts = &view.touch.counts;
    let wanted = counts.planned.saturating_sub(counts.unreachable);
    match view.touch.phase {
        TouchPhase::Running { .. } | TouchPhase::Paused { .. } | TouchPhase::Waiting { .. } if wanted > 0 => {
            let ended = counts.touched + counts.missed + counts.skipped + counts.rejected;
            StepState::Running((ended as f32 / wanted as f32).min(1.0))
        }
        // Where the screen lies is the first half of it, touches to learn from are the second.
        _ if view.touch.step == EngineStep::NotDone && view.touch.placement.is_some() => {
            StepState::Partly(0.5)
        }
        _ => step_state(&view.touch.step),
    }
}

/// How many of its steps are done.
fn commission_state(view: &View) -> StepState<'_> {
    let steps = &view.commission.steps;
    let done = steps.iter().filter(|step| step.done().is_some()).count();
    match (view.commission.is_on, view.commission.is_done()) {
        (_, true) => StepState::Done,
        (true, false) => StepState::Running(done as f32 / steps.len().max(1) as f32),
        (false, false) => StepState::NotDone,
    }
}

fn models_state(view: &View) -> StepState<'_> {
    step_state(&view.models.step)
}

/// The search says how far it is; one that failed says why.
fn gap_state(view: &View) -> StepState<'_> {
    let searching = view.gap.searching.and_then(|id| view.jobs.iter().find(|job| job.id == id));
    if let Some(JobState::Running { fraction, .. }) = searching.map(|job| &job.state) {
        return StepState::Running(*fraction as f32);
    }
    match &view.gap.failed {
        Some(why) => StepState::Failed(why),
        None => step_state(&view.gap.step),
    }
}

/// No step of the work: it says whether it watches, and when something moved.
fn drift_state(view: &View) -> StepState<'_> {
    match &view.drift.step {
        EngineStep::NotDone | EngineStep::Done => StepState::Always,
        other => step_state(other),
    }
}

/// The robot is no step of the work; it only says when it needs to be looked at.
fn robot_state(view: &View) -> StepState<'_> {
    match &view.robot.connection {
        Connection::Lost { reason, .. } => StepState::Failed(reason),
        Connection::Connecting { .. } => StepState::Running(0.5),
        Connection::None | Connection::Connected { .. } => StepState::Always,
    }
}

/// No step of the work either; it says how far an evaluation is, and what is not on disk.
fn detect_state(view: &View) -> StepState<'_> {
    let evaluating = view.scores.evaluating.and_then(|id| view.jobs.iter().find(|job| job.id == id));
    if let Some(JobState::Running { fraction, .. }) = evaluating.map(|job| &job.state) {
        return StepState::Running(*fraction as f32);
    }
    match &view.labels.unsaved {
        Some(why) => StepState::Failed(why),
        None => StepState::Always,
    }
}

fn step_state(step: &EngineStep) -> StepState<'_> {
    match step {
        EngineStep::NotDone => StepState::NotDone,
        EngineStep::Running => StepState::Running(0.5),
        EngineStep::Done => StepState::Done,
        EngineStep::Stale { why } => StepState::Stale(why),
    }
}
