//! The bottom line: what is happening and what to do next, with the one button that does it.

use std::borrow::Cow;

use egui::{Align, Layout, Panel, Ui};
use plumbline_engine::view::{JobState, JobView, MotionState};
use plumbline_engine::{JobCommand, JobId, View};
use plumbline_widgets::buttons::accent_button;
use plumbline_widgets::progress::{ProgressAction, ProgressLine};
use plumbline_widgets::theme::space;

use super::PlumblineWindow;
use crate::operator::guidance::{Guidance, failed_inside, guidance};
use crate::operator::{
    Action, Course, GraspAction, Outbox, RobotAction, Screen, TouchAction, course, led_by, shortcut_text,
    words,
};

const HEIGHT: f32 = 52.0;

/// On which screen each job that is listed was begun, or first seen.
#[derive(Default)]
pub(super) struct BegunOn(Vec<(JobId, Screen)>);

impl BegunOn {
    fn see(&mut self, jobs: &[JobView], screen: Screen) {
        self.0.retain(|(id, _)| jobs.iter().any(|job| job.id == *id));
        for job in jobs {
            if !self.0.iter().any(|(id, _)| *id == job.id) {
                self.0.push((job.id, screen));
            }
        }
    }

    /// Whether a job is of this screen: the parts of the eyes are one.
    fn is_of(&self, job: &JobView, screen: Screen) -> bool {
        let is_same = |on: Screen| on == screen || on.is_eyes() && screen.is_eyes();
        self.0.iter().any(|(id, on)| *id == job.id && is_same(*on))
    }
}

pub(super) fn show(window: &mut PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
    let screen = window.settings.screen;
    window.begun_on.see(&window.view.jobs, screen);
    let line = line_of(&window.view, screen);
    let next = match &line {
        Line::Running(_) => None,
        Line::Guided { guidance, .. } => guidance.next.as_ref().map(|next| next.action),
    };
    window.primary_rest.see(ui.ctx(), next);
    let keys = keys_come_here(ui.ctx()) || window.script.is_set();
    let margin = egui::Margin { left: 16, right: 8, top: 8, bottom: 8 };
    let frame = egui::Frame::side_top_panel(ui.style()).inner_margin(margin);
    let bottom = Panel::bottom("bottom line").frame(frame).exact_size(HEIGHT).show_separator_line(false);
    bottom.show(ui, |ui| {
        let resting = match next {
            // What ends something is not locked by pressing it.
            None | Some(Action::Touch(TouchAction::Pause) | Action::Grasp(GraspAction::Pause)) => {
                window.primary_rest.is_on_at_first(ui.ctx())
            }
            Some(_) => window.primary_rest.is_on(ui.ctx()),
        };
        let layout = Layout::right_to_left(Align::Center);
        let failed = failed_job(&window.view, |job| window.begun_on.is_of(job, screen));
        let look = Stands { resting, keys };
        ui.with_layout(layout, |ui| contents(&window.view, line, failed, look, ui, outbox));
    });
}

/// How it stands with what can be pressed.
#[derive(Clone, Copy)]
struct Stands {
    /// The button meant something else a moment ago.
    resting: bool,
    /// Keys come to this program.
    keys: bool,
}

/// Whether one of the program's windows has the keys; where the desktop does not say, it has.
fn keys_come_here(ctx: &egui::Context) -> bool {
    ctx.input(|input| {
        let mut known = input.raw.viewports.values().filter_map(|viewport| viewport.focused).peekable();
        known.peek().is_none() || known.any(|focused| focused)
    })
}

/// Which keys stop, where they would be heard.
const KEYS: &str = "Esc or space stops.";

fn by_keys(sentence: &str, keys: bool) -> Cow<'_, str> {
    match keys {
        true => sentence.into(),
        false => sentence.replace(KEYS, "STOP stops it: another window has the keys.").into(),
    }
}

/// What stands in it.
enum Line<'a> {
    /// Work is under way.
    Running(&'a JobView),
    /// What to do next; `led`: by commissioning, whose strip has the primary button.
    Guided { guidance: Guidance, led: bool },
}

fn line_of(view: &View, screen: Screen) -> Line<'_> {
    let failed = failed_inside(view, screen);
    // What failed inside is not hidden behind work that goes on.
    // An attempt that holds waits for the operator: what its button does next stands where the button was that
    // began it, and not what ends it.
    let waits = screen == Screen::Grasp && view.grasp.phase.is_paused();
    if let (Some(job), None, false) = (view.running_job(), &failed, waits) {
        return Line::Running(job);
    }
    match (failed, course(view)) {
        (Some(guidance), _) => Line::Guided { guidance, led: false },
        (None, Some(course)) => Line::Guided { guidance: of_course(view, screen, course), led: true },
        (None, None) => Line::Guided { guidance: with_what_moves(guidance(view, screen), view), led: false },
    }
}

/// On a screen that says nothing of it: that the robot moves meanwhile, and what stops it.
fn with_what_moves(guidance: Guidance, view: &View) -> Guidance {
    let is_said = guidance.sentence.contains(KEYS) || !moves(view) || view.robot.rests_on_the_way;
    match is_said {
        true => guidance,
        false => {
            let sentence = format!("The robot moves meanwhile; {KEYS} {}", guidance.sentence);
            Guidance { sentence, ..guidance }
        }
    }
}

/// `failed`: what was begun on this screen and failed.
fn contents(
    view: &View,
    line: Line<'_>,
    failed: Option<(&JobView, &str)>,
    Stands { resting, keys }: Stands,
    ui: &mut Ui,
    outbox: &mut Outbox,
) {
    let (guidance, led) = match line {
        Line::Running(job) => return running(view, job, Stands { resting, keys }, ui, outbox),
        Line::Guided { guidance, led } => (guidance, led),
    };
    let accepts = guidance.next.as_ref().is_some_and(|next| next.action.puts_in_use());
    if !accepts {
        next_button(view, &guidance, Look { led, resting }, ui, outbox);
    }
    // What moves, or would, is not hidden behind what failed before; and what the screen says itself is said once.
    let would_move = match course(view).filter(|_| led) {
        Some(course) => course.begins_to_move(),
        None => guidance.next.as_ref().is_some_and(|next| next.action.begins_to_move()),
    };
    let failed =
        failed.filter(|(_, reason)| !moves(view) && !would_move && !guidance.sentence.contains(*reason));
    if let Some((job, _)) = failed
        && ui.button("Dismiss").clicked()
    {
        outbox.send(JobCommand::Dismiss(job.id));
    }
    let said = failed.map(|(job, reason)| format!("{}: {reason}", job.title));
    let sentence = by_keys(&guidance.sentence, keys);
    let said = match &said {
        Some(said) => ProgressLine::warning(said),
        None if guidance.warning => ProgressLine::warning(&sentence),
        None => ProgressLine::idle(&sentence),
    };
    ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
        // Accepting is never where collecting was.
        if accepts {
            next_button(view, &guidance, Look { led, resting }, ui, outbox);
        }
        answer(said.show(ui), outbox);
    });
}

fn running(view: &View, job: &JobView, Stands { resting, keys }: Stands, ui: &mut Ui, outbox: &mut Outbox) {
    let JobState::Running { fraction, doing, remaining, cancelling } = &job.state else { return };
    let stops = match moves(view) && !view.robot.rests_on_the_way && !view.grasp.phase.is_paused() {
        true => ". The robot moves; Esc or space stops.",
        false => "",
    };
    let sentence = format!("{}: {doing}{stops}", job.title);
    let sentence = by_keys(&sentence, keys);
    // Steps of a hand, and looks at it, take as long as the arm and the eyes need: how many are done says little of how
    // long.
    let left = remaining.filter(|_| !view.grasp.phase.moves() && !view.handeye.is_looking);
    let progress = ProgressLine::job(&sentence, *fraction).time_left(left);
    // Who hammers the button that began it does not cancel it.
    let progress = progress.cancelling(*cancelling).resting(resting);
    let asked = ui.with_layout(Layout::left_to_right(Align::Center), |ui| progress.show(ui)).inner;
    if asked == Some(ProgressAction::Cancel) {
        outbox.send(JobCommand::Cancel(job.id));
    }
    answer(asked, outbox);
}

fn answer(asked: Option<ProgressAction>, outbox: &mut Outbox) {
    if asked == Some(ProgressAction::OpenLog) {
        outbox.act(Action::ToggleLog);
    }
}

/// While commissioning leads, its button is the primary one: here stands what it says, with nothing but a
/// way to hold what moves. Where the operator looks elsewhere, that screen says its own.
fn of_course(view: &View, screen: Screen, course: Course) -> Guidance {
    let own = guidance(view, screen);
    // A move that is shown is gone from where it is shown, also on the way.
    if matches!(own.next.as_ref().map(|next| next.action), Some(Action::Robot(RobotAction::Move))) {
        return own;
    }
    let of_eyes = course.screen.is_eyes() && screen.is_eyes();
    let is_elsewhere = !of_eyes && screen != course.screen && screen != Screen::Commission;
    // What would only lead on gives way to what leads.
    let leads_on = matches!(own.next.as_ref().map(|next| next.action), Some(Action::Go(_))) && !own.warning;
    if is_elsewhere && !leads_on {
        // Two things do not come next at once.
        return Guidance { sentence: own.sentence.replace("Next: ", "Possible here: "), ..own };
    }
    let holds = |action: Action| {
        matches!(action, Action::Touch(TouchAction::Pause) | Action::Grasp(GraspAction::Pause))
    };
    Guidance {
        sentence: course.sentence,
        warning: course.warning,
        next: own.next.filter(|next| holds(next.action)),
    }
}

/// How the one button looks.
#[derive(Clone, Copy)]
struct Look {
    /// Another one is the primary button.
    led: bool,
    /// It meant something else a moment ago.
    resting: bool,
}

fn next_button(view: &View, guidance: &Guidance, look: Look, ui: &mut Ui, outbox: &mut Outbox) {
    let Some(next) = &guidance.next else { return };
    let refusal = next.action.refusal(view);
    let keys = shortcut_text(ui.ctx(), Action::Next).unwrap_or_default();
    let button = if look.led { egui::Button::new(&next.label) } else { accent_button(ui, &next.label) };
    let button = button.min_size(egui::vec2(120.0, 36.0));
    ui.spacing_mut().button_padding.x = space::M;
    let button = ui.add_enabled(refusal.is_none() && !look.resting, button);
    let button = button.on_hover_text(format!("{keys} does the same"));
    let why = refusal.unwrap_or_else(|| crate::panels::rest::WHY.into());
    if button.on_disabled_hover_text(why).clicked() {
        outbox.act(next.action);
    }
    ui.reset_style();
    ui.add_space(space::S);
}

/// Whether something moves the robot, or goes on moving it by itself.
pub(super) fn moves(view: &View) -> bool {
    // The evaluation on a grid is none of them: only things are laid, by a person or in the twin.
    led_by(view).is_some() || matches!(view.robot.motion, MotionState::Moving { .. })
}

fn failed_job(view: &View, is_of_screen: impl Fn(&JobView) -> bool) -> Option<(&JobView, &str)> {
    view.jobs.iter().rev().filter(|job| is_of_screen(job)).find_map(|job| match &job.state {
        // Who pressed it knows, and what to do next stands here.
        JobState::Failed { reason } if reason.starts_with(words::robot::BY_STOP) => None,
        JobState::Failed { reason } => Some((job, reason.as_str())),
        JobState::Panicked { message } => Some((job, message.as_str())),
        _ => None,
    })
}
