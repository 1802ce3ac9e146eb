//! The top line: where the images come from, how everything is, and STOP.

use std::time::Duration;

use egui::{Align, Button, Layout, Panel, Popup, Response, Ui};
use jiff::Timestamp;
use plumbline_engine::view::{
    AddedEffect, Gate, GateState, Need, RecordingState, SourceStatus, StepState, Subject,
};
use plumbline_engine::{EyesCommand, View};
use plumbline_model::duration;
use plumbline_widgets::NumberField;
use plumbline_widgets::buttons::{STOP_SIZE, stop_button, stop_pressed};
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::key_value::{KeyValue, key_value_grid};
use plumbline_widgets::lamp::Health;
use plumbline_widgets::theme::{self, space};

use super::lamps::{Then, TopLamp};
use super::{PlumblineWindow, faults, lamps, robot_lamps, running_lamp, world_menu};
use crate::operator::words::effect;
use crate::operator::words::eyes::WARM_AFTER_MINUTES;
use crate::operator::{Action, Outbox, RobotAction, Screen, shortcut_text};
use crate::panels::source_age;

/// Below this width, points, the lamps take a row of their own.
const NARROW: f32 = 1400.0;
/// Below this width, points, the program's name and the keys of buttons give way to buttons; beside *Release
/// STOP* below the second one.
const TIGHT: [f32; 2] = [900.0, 1500.0];
const LAMPS_HEIGHT: f32 = 30.0;
/// A live picture older than this is worth a warning.
const OLD: Duration = Duration::from_millis(500);
/// A pair that is older than this is the last for now.
const STOPPED: Duration = Duration::from_millis(1500);

pub(super) fn show(window: &PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
    let width = ui.available_width();
    let narrow = width < NARROW;
    let tight = width < TIGHT[0];
    let is_named = width >= TIGHT[usize::from(robot_lamps::can_be_released(&window.view.robot))];
    let margin = egui::Margin { left: 16, right: 8, top: 6, bottom: 6 };
    let frame = egui::Frame::side_top_panel(ui.style()).inner_margin(margin);
    let height = STOP_SIZE.y + 12.0 + if narrow { LAMPS_HEIGHT } else { 0.0 };
    let top = Panel::top("health").frame(frame).exact_size(height).show_separator_line(false);
    top.show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let first_row = egui::vec2(ui.available_width(), STOP_SIZE.y);
        ui.allocate_ui_with_layout(first_row, Layout::right_to_left(Align::Center), |ui| {
            let stop = stop_button(ui, robot_lamps::arm_state(&window.view));
            if stop_pressed(&stop) {
                // At once; the action ends everything else after the frame.
                window.backend.stop();
                outbox.act(Action::Stop);
            }
            ui.add_space(space::S);
            robot_lamps::release_button(tight, &window.view, ui, outbox);
            view_menu(window, ui, outbox);
            messages_button(window, ui, outbox);
            commands_button(tight, ui, outbox);
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                if is_named {
                    ui.heading("Plumbline");
                    ui.add_space(space::S);
                }
                world_menu::show(&window.view, &window.settings.recent_sources, ui, outbox);
                if !narrow {
                    lamps(window, ui, outbox);
                }
            });
        });
        if narrow {
            ui.horizontal(|ui| lamps(window, ui, outbox));
        }
    });
}

fn lamps(window: &PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
    let view = &window.view;
    let mut all = faults::lamps(view);
    all.extend(running_lamp::lamp(view));
    all.extend(recording_lamp(view));
    all.push(eyes_lamp(view));
    all.extend(robot_lamps::lamps(view));
    all.push(calibration_lamp(view));
    all.extend(model_lamp(view));
    all.push(if view.twin.running { twin_clock_lamp(view) } else { clock_lamp(window) });
    lamps::show(&all, window, ui, outbox);
}

fn commands_button(tight: bool, ui: &mut Ui, outbox: &mut Outbox) {
    let keys = shortcut_text(ui.ctx(), Action::Palette).filter(|_| !tight).unwrap_or_default();
    let button = Button::new("Commands");
    let button = if keys.is_empty() { button } else { button.shortcut_text(keys) };
    if ui.add(button).on_hover_text("Everything that can be done, by name").clicked() {
        outbox.act(Action::Palette);
    }
}

fn messages_button(window: &PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
    let unread = window.notices.unread();
    let text = if unread == 0 { "Messages".to_owned() } else { format!("Messages ({unread})") };
    if ui.button(text).on_hover_text("What was said before").clicked() {
        outbox.act(Action::ToggleNotices);
    }
}

fn view_menu(window: &PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
    let dark = ui.visuals().dark_mode;
    let response = ui.button("View");
    Popup::menu(&response).show(|ui| {
        ui.set_min_width(260.0);
        let mut entry = |ui: &mut Ui, text: &str, action: Action| {
            let button = Button::new(text);
            let button = match shortcut_text(ui.ctx(), action) {
                Some(keys) => button.shortcut_text(keys),
                None => button,
            };
            if ui.add(button).clicked() {
                outbox.act(action);
                ui.close();
            }
        };
        entry(ui, if dark { "Light theme" } else { "Dark theme" }, Action::ToggleTheme);
        let inspector = if window.settings.inspector_open { "Hide inspector" } else { "Show inspector" };
        entry(ui, inspector, Action::ToggleInspector);
        entry(ui, if window.settings.log_open { "Hide log" } else { "Show log" }, Action::ToggleLog);
        ui.separator();
        entry(ui, "Reset the tiles of this screen", Action::ResetArrangement);
        entry(ui, "Reset the tiles of all screens", Action::ResetAllArrangements);
        ui.separator();
        entry(ui, "Save a picture of the window…", Action::SaveWindow);
        entry(ui, "Frame times", Action::ToggleFrameTimes);
        ui.separator();
        entry(ui, "Help", Action::Help);
        entry(ui, "About Plumbline", Action::About);
        entry(ui, "Quit", Action::Quit);
    });
}

/// While it records.
fn recording_lamp(view: &View) -> Option<TopLamp> {
    let RecordingState::On { so_far, .. } = &view.recording.state else { return None };
    let seconds = so_far.time.as_secs();
    let mut value = format!("{}:{:02}", seconds / 60, seconds % 60);
    let (health, reason) = match so_far.dropped {
        0 => (Health::Working(0.0), None),
        n => {
            value += &format!(", {n} lost");
            (Health::Warning, Some("Disk or processor did not keep up: these pairs and messages are not in the recording. Stop other work, or record to a faster disk.".to_owned()))
        }
    };
    Some(TopLamp { name: "Recording", value, health, reason, then: Then::Open(240.0, recording_details) })
}

fn recording_details(window: &PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
    let RecordingState::On { session, so_far } = &window.view.recording.state else { return };
    let pairs = usize::try_from(so_far.pairs).unwrap_or(usize::MAX);
    ui.label(format!("{}, {:.1} MB", format::count(pairs, "pair"), so_far.bytes as f64 * 1e-6));
    ui.label(theme::small(ui, session.display().to_string()));
    if ui.button("Stop recording").clicked() {
        outbox.act(Action::ToggleRecording);
        ui.close();
    }
}

/// The lamp of the eyes.
fn eyes_lamp(view: &View) -> TopLamp {
    let statistics = &view.live.statistics;
    let per_second = statistics.source.per_second;
    let rate = per_second.map(format::hertz);
    let (value, health, reason): (String, Health, Option<String>) = match &view.source.status {
        SourceStatus::None => ("no source".to_owned(), Health::Off, None),
        SourceStatus::Opening => ("opening".to_owned(), Health::Working(0.5), None),
        SourceStatus::Running => running(view, rate, per_second),
        SourceStatus::Paused => ("held still".to_owned(), Health::Good, None),
        SourceStatus::Ended => ("ended".to_owned(), Health::Good, None),
        SourceStatus::Lost { reason, attempts, .. } => {
            let tried = format!("{reason}\nTried again {}.", format::count(*attempts as usize, "time"));
            ("lost".to_owned(), Health::Failed, Some(tried))
        }
    };
    let then = Then::Open(300.0, eyes_details);
    TopLamp { name: "Eyes", value, health, reason, then }
}

/// Eyes that give pairs, or should: how many, and whether the newest is old. Pairs that come that slowly are old whenever
/// one looks, and not now and then.
fn running(view: &View, rate: Option<String>, per_second: Option<f64>) -> (String, Health, Option<String>) {
    let age = source_age(view);
    let is_live = age.is_some();
    let stopped = age.filter(|age| *age > STOPPED);
    let is_slow = is_live && per_second.is_some_and(|rate| rate * OLD.as_secs_f64() < 1.0);
    let cause = if view.twin.running {
        "this computer is busy, or the twin is held still."
    } else {
        "look at the cameras and their cables, and at what else this computer does."
    };
    match (stopped, rate) {
        (Some(age), _) => (format::age(age), Health::Warning, Some(format!("No new pair has come: {cause}"))),
        (None, Some(rate)) if is_slow => (rate, Health::Warning, Some(format!("Few pairs come: {cause}"))),
        (None, rate) => (rate.unwrap_or_else(|| "starting".to_owned()), Health::Good, None),
    }
}

fn eyes_details(window: &PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
    let view = &window.view;
    let statistics = &view.live.statistics;
    ui.label(theme::strong(
        ui,
        if view.source.description.is_empty() { "No source" } else { &view.source.description },
    ));
    let stage = |name: &str, stage: &plumbline_engine::view::StageStatistics| {
        let rate = stage.per_second.map_or(format::NONE.to_owned(), format::hertz);
        let busy = stage.busy.map_or(format::NONE.to_owned(), |busy| format::ms(busy.as_secs_f64()));
        KeyValue::text(name, format!("{rate}, {busy} each, {} skipped", stage.skipped))
    };
    let rows = [
        stage("Pairs", &statistics.source),
        stage("Rectify and match", &statistics.rectify),
        stage("Find the board", &statistics.corners),
        KeyValue::optional("Right after left", Quantity::Time, statistics.time_difference_s)
            .help("Capture time of the right image minus that of the left"),
    ];
    key_value_grid(ui, "eyes details", &rows);
    if view.source.status != SourceStatus::None && ui.button("Close the source").clicked() {
        outbox.act(Action::CloseSource);
        ui.close();
    }
}

fn calibration_lamp(view: &View) -> TopLamp {
    let name = "Calibration";
    let Some(in_use) = &view.eyes.in_use else {
        let (value, health, reason) = if view.live.nominal_lenses {
            let reason = "Views, depth and measured points rest on the lens data of the description, not on these eyes: go to step 1, Eyes.";
            ("nominal", Health::Warning, reason)
        } else {
            ("none", Health::Off, "Nothing can be measured without one: go to step 1, Eyes.")
        };
        let (value, reason, then) = (value.to_owned(), Some(reason.to_owned()), Then::Go(Screen::Collect));
        return TopLamp { name, value, health, reason, then };
    };
    let made = in_use.calibration.evidence.as_ref().map_or(in_use.accepted, |evidence| evidence.created);
    let age = Timestamp::now().duration_since(made);
    let value = format::age(Duration::try_from(age).unwrap_or_default());
    let (health, reason) = match (standing(&view.eyes.step), other_warmth(view)) {
        ((Health::Good, _), Some(why)) => (Health::Warning, Some(why)),
        (stands, _) => stands,
    };
    TopLamp { name, value, health, reason, then: Then::Go(Screen::Accept) }
}

/// Why the calibration does not hold for how warm the eyes are now; `None`: they are as warm, or nobody knows.
fn other_warmth(view: &View) -> Option<String> {
    let doubt = |gate: &&Gate| gate.of == Need::Warmth && gate.state == GateState::Doubtful;
    view.grasp.gates.iter().find(doubt).map(|gate| gate.text.clone())
}

/// How a step that was done stands.
fn standing(step: &StepState) -> (Health, Option<String>) {
    match step {
        StepState::Stale { why } => (Health::Warning, Some(why.to_string())),
        _ => (Health::Good, None),
    }
}

/// With which effects the robot is predicted; nothing stands here while it is as described.
fn model_lamp(view: &View) -> Option<TopLamp> {
    let gap = &view.gap;
    if gap.model.effects.is_empty() {
        return None;
    }
    let in_use = view.timeline.in_use.iter().find(|now| now.subject == Subject::Effects);
    let (health, reason) = match in_use.filter(|now| !now.against.is_empty()) {
        Some(now) => (Health::Warning, Some(now.against.clone())),
        None => {
            let (health, reason) = standing(&gap.step);
            (health, reason.or_else(|| Some(effect::in_use(&gap.model))))
        }
    };
    // The lamp has little room; its screen says all of it.
    let named = gap.model.effects.iter().filter(|effect| effect.counts());
    let mut kinds: Vec<&str> = named.map(AddedEffect::kind).collect();
    kinds.sort_unstable();
    kinds.dedup();
    // What has one name for every joint counts once, as where it was added.
    let value = match kinds.len() {
        0 if gap.model.effects.iter().all(|effect| effect.is_left_out) => "left out".to_owned(),
        0 => "small shares".to_owned(),
        kinds => kinds.to_string(),
    };
    Some(TopLamp { name: "Effects", value, health, reason, then: Then::Go(Screen::Gap) })
}

/// How long the cameras have been on: as said, else since the program was started.
fn minutes_on(window: &PlumblineWindow) -> f64 {
    window.view.eyes.minutes_since_on.unwrap_or(window.started.elapsed().as_secs_f64() / 60.0)
}

fn clock_lamp(window: &PlumblineWindow) -> TopLamp {
    let live = window.view.source.replay.is_none() && window.view.source.status == SourceStatus::Running;
    let minutes = minutes_on(window);
    let warming = live && minutes < WARM_AFTER_MINUTES;
    let health = if warming { Health::Working((minutes / WARM_AFTER_MINUTES) as f32) } else { Health::Good };
    let reason = warming.then(|| {
        "Lenses move while cameras get warm: calibrate after about 20 minutes, and again if unsure."
            .to_owned()
    });
    let (name, value) = match window.view.eyes.minutes_since_on {
        Some(minutes) => {
            ("Cameras on", duration::seconds(minutes * 60.0).map_or(format::NONE.to_owned(), format::clock))
        }
        None => ("Since start", format::clock(window.started.elapsed())),
    };
    TopLamp { name, value, health, reason, then: Then::Open(300.0, clock_details) }
}

fn clock_details(window: &PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
    let source = &window.view.source;
    let minutes_on = window.view.eyes.minutes_since_on;
    ui.label("How long the cameras were on when the pairs were taken is kept with the calibration.");
    if source.replay.is_some() && !source.photographs {
        ui.label(
            "Of a recording nothing else uses it: it is not known how long they had been on at each pair.",
        );
    }
    ui.horizontal(|ui| {
        let label = ui.label("Cameras on for");
        if let Some(minutes) = minutes_field(ui, &label, minutes_on) {
            outbox.send(EyesCommand::MinutesSinceOn(Some(minutes)));
        }
        if minutes_on.is_some() && ui.button("Not known").clicked() {
            outbox.send(EyesCommand::MinutesSinceOn(None));
        }
    });
}

/// The minutes, once the operator is done with them: whoever watches by them begins anew with each that are said.
/// While they are edited the clock that runs does not change them.
fn minutes_field(ui: &mut Ui, label: &Response, minutes_on: Option<f64>) -> Option<f64> {
    let draft = label.id.with("draft");
    let held: Option<(f64, bool)> = ui.data(|data| data.get_temp(draft));
    let (mut minutes, was_dragged) = held.unwrap_or((minutes_on.map_or(0.0, f64::round), false));
    let field = NumberField {
        name: "Minutes since on",
        range: 0.0..=10_000.0,
        suffix: " min",
        speed: 1.0,
        decimals: 0,
    };
    let response = field.show(ui, &mut minutes).labelled_by(label.id);
    let (dragged, changed) = (response.dragged(), response.changed());
    if dragged || response.has_focus() {
        ui.data_mut(|data| data.insert_temp(draft, (minutes, dragged && (was_dragged || changed))));
    } else {
        ui.data_mut(|data| data.remove_temp::<(f64, bool)>(draft));
    }
    let is_done = !dragged && changed || response.drag_stopped() && was_dragged;
    is_done.then_some(minutes)
}

/// The twin knows how long its eyes have been on.
fn twin_clock_lamp(view: &View) -> TopLamp {
    let on = duration::seconds(view.twin.eyes_on_s).unwrap_or_default();
    let fraction = on.as_secs_f64() / 60.0 / WARM_AFTER_MINUTES;
    let warming = fraction < 1.0;
    let health = if warming { Health::Working(fraction as f32) } else { Health::Good };
    let reason = warming
        .then(|| "The twin's eyes turn in their mounts while they warm up, as real ones do.".to_owned());
    let then = Then::Open(240.0, twin_clock_details);
    TopLamp { name: "Warm-up", value: format::clock(on), health, reason, then }
}

fn twin_clock_details(_: &PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
    for action in [RobotAction::WarmUp, RobotAction::CoolEyes] {
        if ui.button(action.label()).clicked() {
            outbox.act(Action::Robot(action));
            ui.close();
        }
    }
}
