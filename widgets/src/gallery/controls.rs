//! Pages with what the window is made of.

use std::time::Duration;

use egui::{Panel, Ui, vec2};

use super::{GalleryState, pictures, sample, tables};
use crate::buttons::{ArmState, choice, primary_button, stop_button, stop_pressed};
use crate::lamp::{Health, Lamp};
use crate::notifications::Severity;
use crate::progress::{ProgressAction, ProgressLine};
use crate::rail::{RailStep, StepState};
use crate::theme::{self, space};

const STEPS: [(&str, Option<u32>, StepState<'static>); 10] = [
    ("Live", None, StepState::Always),
    ("Eyes", Some(1), StepState::Done),
    ("Mount", Some(2), StepState::Stale("the eyes were calibrated again 2 h ago")),
    ("Touch", Some(3), StepState::Running(0.42)),
    ("Models", Some(4), StepState::NotDone),
    ("Drift", Some(5), StepState::Failed("no point was found in both eyes; clean the lenses")),
    ("Grasp", Some(6), StepState::NotDone),
    ("Gap", Some(7), StepState::NotDone),
    ("Robot", None, StepState::Always),
    ("Sessions", None, StepState::Always),
];

/// A whole window, to see the widgets together.
pub(super) fn window(ui: &mut Ui, state: &mut GalleryState) {
    ui.set_min_height(640.0);
    Panel::top("gallery top").show(ui, |ui| top(ui, state));
    Panel::bottom("gallery bottom").show(ui, |ui| bottom(ui, state));
    Panel::left("gallery rail").exact_size(168.0).resizable(false).show(ui, |ui| rail(ui, state));
    Panel::right("gallery inspector").exact_size(280.0).resizable(false).show(ui, |ui| {
        ui.add_space(space::S);
        tables::inspector(ui, state);
    });
    egui::CentralPanel::default().show(ui, |ui| {
        ui.add_space(space::S);
        ui.horizontal(|ui| {
            theme::heading(ui, "Eyes");
            ui.add_space(space::M);
            choice(
                ui,
                "View",
                &mut state.option,
                &[(0, "Raw"), (1, "Rectified"), (2, "Anaglyph"), (3, "Depth")],
            );
        });
        ui.add_space(space::S);
        pictures::linked(ui, state);
        ui.add_space(space::M);
        tables::bars_of_height(ui, state, 120.0);
        ui.add_space(space::S);
        primary_button(ui, "Solve 30 pairs", None);
    });
}

/// STOP takes its place first, so that nothing can push it out of the window.
fn top(ui: &mut Ui, state: &mut GalleryState) {
    ui.add_space(space::XS);
    ui.horizontal(|ui| {
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if stop_pressed(&stop_button(ui, ArmState::Held)) {
                state.last = "stop".to_owned();
            }
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                ui.shrink_clip_rect(ui.max_rect());
                ui.label(theme::strong(ui, "Plumbline"));
                ui.add_space(space::S);
                lamps(ui, state);
            });
        });
    });
    ui.add_space(space::XS);
}

fn lamps(ui: &mut Ui, state: &mut GalleryState) {
    ui.spacing_mut().item_spacing.x = space::XS;
    let lamps = [
        Lamp::new("eyes", "30.0 Hz", Health::Good),
        Lamp::new("bus", "62.1 Hz", Health::Good),
        Lamp::new("servos", "58.2 °C", Health::Warning)
            .reason(Some("The elbow is hot. Let it rest before the next run.")),
        Lamp::new("warm-up", "4:10", Health::Working(0.6))
            .reason(Some("The lenses still move. Calibrate after the warm-up.")),
    ];
    for lamp in lamps {
        if lamp.show(ui).clicked() {
            state.last = "lamp".to_owned();
        }
    }
}

fn bottom(ui: &mut Ui, state: &mut GalleryState) {
    ui.add_space(space::XS);
    let line = ProgressLine::job("Touch: 34 of 80. The arm settles above target 35.", 0.42)
        .time_left(Some(Duration::from_secs(130)));
    if let Some(action) = line.show(ui) {
        state.last = format!("{action:?}");
    }
    ui.add_space(space::XS);
}

fn rail(ui: &mut Ui, state: &mut GalleryState) {
    ui.add_space(space::S);
    ui.spacing_mut().item_spacing.y = 2.0;
    for (index, (name, number, step)) in STEPS.into_iter().enumerate() {
        let mut entry = RailStep::new(name, step).selected(state.step == index);
        if let Some(number) = number {
            entry = entry.number(number);
        }
        if entry.show(ui).clicked() {
            state.step = index;
        }
    }
}

pub(super) fn buttons(ui: &mut Ui, state: &mut GalleryState) {
    theme::group_heading(ui, "Primary");
    if primary_button(ui, "Capture pair", None).clicked() {
        state.last = "capture".to_owned();
    }
    primary_button(ui, "Solve 0 pairs", Some("At least three pairs are needed."));
    theme::group_heading(ui, "Stop");
    ui.horizontal(|ui| {
        for arm in
            [ArmState::Held, ArmState::Moving, ArmState::HeadMoving, ArmState::Free, ArmState::NotConnected]
        {
            ui.push_id(arm.text(), |ui| stop_button(ui, arm));
        }
    });
    theme::group_heading(ui, "Lamps");
    ui.horizontal_wrapped(|ui| {
        lamps(ui, state);
        Lamp::new("left camera", "lost", Health::Failed).show(ui);
        Lamp::new("elbow", "78.0 °C", Health::Danger).show(ui);
        Lamp::new("touchscreen", "none", Health::Off).show(ui);
    });
    theme::group_heading(ui, "Progress");
    let lines = [
        ProgressLine::idle("Show the board to both eyes; the next pair is taken by itself."),
        ProgressLine::warning("The right camera is lost. Check its cable; it is tried again every second."),
        ProgressLine::job("Solving, iteration 4", 0.31).time_left(Some(Duration::from_millis(2_400))),
        ProgressLine::job("Touch: 34 of 80", 0.42),
        ProgressLine::job("Searching the gap", 0.9).cancelling(true),
    ];
    for (index, line) in lines.into_iter().enumerate() {
        ui.push_id(index, |ui| {
            if line.show(ui) == Some(ProgressAction::Cancel) {
                state.last = "cancel".to_owned();
            }
        });
    }
    theme::group_heading(ui, "Choice");
    choice(ui, "View", &mut state.option, &[(0, "Raw"), (1, "Rectified"), (2, "Anaglyph"), (3, "Depth")]);
}

pub(super) fn notifications(ui: &mut Ui, state: &mut GalleryState) {
    if state.notifications.history().next().is_none() {
        let messages = [
            (Severity::Info, "30 pairs were read from nico-chessboard."),
            (Severity::Done, "The calibration is in use."),
            (Severity::Warning, "Pair 09 does not fit: 0.21 px. Look at its corners, or drop it."),
            (
                Severity::Failed,
                "calibration.yaml was not saved: the disk is full. Free some space and save again.",
            ),
        ];
        for (severity, text) in messages {
            state.notifications.push(severity, text);
        }
    }
    let count = sample::pairs().len();
    ui.label(theme::weak(ui, format!("History, and toasts at the bottom right ({count} pairs loaded).")));
    ui.allocate_ui(vec2(ui.available_width(), 200.0), |ui| state.notifications.show_history(ui));
    let ctx = ui.ctx().clone();
    state.notifications.show_toasts(&ctx, vec2(space::M, space::M), None);
}
