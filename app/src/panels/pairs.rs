//! The collected pairs: capture, delete last or any.

use egui::{Button, ScrollArea, Ui};
use plumbline_engine::view::{CaptureEnded, CollectedPair, EyesView};
use plumbline_engine::{EyesCommand, Products, SourceSpec};
use plumbline_model::Eye;
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, Role, space};

use super::PanelContext;
use crate::operator::words::eyes::{minutes_on, warmth};
use crate::operator::{Action, RobotAction, capture_waits_for};

const ROW: f32 = 24.0;
/// A distance needs so much beside the name.
const DISTANCE: f32 = 60.0;
/// And so much how warm the eyes were.
const WARMTH: f32 = 95.0;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    cx.outbox.want(Products { corners: true, ..Products::default() });
    super::padded(ui, |ui| {
        controls(ui, cx);
        ui.add_space(space::S);
        let eyes = &cx.view.eyes;
        if eyes.collected.is_empty() && eyes.not_collected.is_empty() {
            empty(ui, cx);
        } else {
            list(ui, cx);
        }
    });
}

fn controls(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    ui.horizontal_wrapped(|ui| {
        action_button(ui, cx, Action::DeleteLast, "Delete last");
        action_button(ui, cx, Action::DeleteAll, "Delete all");
        if cx.view.source.replay.is_none() {
            let mut by_itself = cx.view.eyes.auto_capture;
            let hover = "Captures whenever the board is still, sharp, seen by both eyes and somewhere new";
            if ui.checkbox(&mut by_itself, "Capture by itself").on_hover_text(hover).changed() {
                cx.outbox.send(EyesCommand::AutoCapture(by_itself));
            }
        }
    });
    let live = cx.view.source.replay.is_none();
    if let (true, Some(ended)) = (live, cx.view.eyes.capture_ended) {
        let when = match ended {
            CaptureEnded::Accepted => "when the calibration was accepted",
            CaptureEnded::MountLooks => "when the head began to turn for the mount",
        };
        ui.label(theme::weak(ui, format!("Capturing by itself ended {when}.")));
    }
    if let (true, Some(hint)) = (live, capture_waits_for(cx.view)) {
        ui.label(theme::weak(ui, hint));
    }
}

fn action_button(ui: &mut Ui, cx: &mut PanelContext<'_>, action: Action, text: &str) {
    let refusal = action.refusal(cx.view);
    let button = ui.add_enabled(refusal.is_none(), Button::new(text));
    if button.on_disabled_hover_text(refusal.unwrap_or_default()).clicked() {
        cx.outbox.act(action);
    }
}

fn empty(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let tour = Action::Robot(RobotAction::TourBoard);
    let eyes_of_twin = matches!(cx.view.source.spec, Some(SourceSpec::Twin) | None);
    if eyes_of_twin && tour.refusal(cx.view).is_none() {
        let message = Message::new(
            "No pairs yet",
            "An unseen hand can hold the board for the twin; pairs are captured by themselves.",
        );
        if EmptyState::empty(message.button("Show the board at all places")).show(ui) {
            cx.outbox.act(tour);
        }
        return;
    }
    let message = if cx.view.source.replay.is_some() {
        let text = match cx.view.source.photographs {
            true => "Use all pairs of the folder, or step to a pair and capture it.",
            false => "Use all pairs of the recording, or step to a pair and capture it.",
        };
        Message::new("No pairs yet", text).button("Capture pair")
    } else {
        Message::new("No pairs yet", "Hold the board into both eyes and capture, at least ten times.")
            .button("Capture pair")
    };
    if EmptyState::empty(message).show(ui) {
        cx.outbox.act(Action::Capture);
    }
}

fn list(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let eyes = &cx.view.eyes;
    let left_out = eyes.not_collected.len();
    ui.label(theme::small(ui, summary(eyes)));
    let rows = eyes.collected.len() + left_out;
    ui.spacing_mut().item_spacing.y = 0.0;
    ScrollArea::vertical().auto_shrink(false).show_rows(ui, ROW, rows, |ui, range| {
        for i in range {
            match eyes.collected.get(i) {
                Some(pair) => pair_row(ui, cx, pair),
                None => {
                    let (name, why) = &eyes.not_collected[i - eyes.collected.len()];
                    not_taken_row(ui, name, why);
                }
            }
        }
    });
}

fn summary(eyes: &EyesView) -> String {
    let mut text = format::count(eyes.collected.len(), "pair");
    if !eyes.not_collected.is_empty() {
        text.push_str(&format!(", {} not taken", eyes.not_collected.len()));
    }
    text
}

fn pair_row(ui: &mut Ui, cx: &mut PanelContext<'_>, pair: &CollectedPair) {
    let chosen = cx.state.chosen_pair.as_deref() == Some(pair.name.as_str());
    let dropped = cx.view.eyes.dropped.contains(&pair.name);
    ui.horizontal(|ui| {
        ui.set_min_height(ROW);
        let mut name = egui::RichText::new(&pair.name);
        if dropped {
            name = name.strikethrough().color(Role::NoiseFloor.color(theme::tokens(ui)));
        }
        let label = ui.selectable_label(chosen, name);
        if label.on_hover_text(describe(pair, dropped)).clicked() {
            cx.state.chosen_pair = (!chosen).then(|| pair.name.clone());
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let delete = ui.add(Button::new(theme::small(ui, "Delete")).frame(false));
            delete.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Delete {}", pair.name))
            });
            if delete.clicked() {
                cx.outbox.send(EyesCommand::Delete { pair: pair.name.clone() });
            }
            // It stands under the mouse too; it must not run into the name.
            if let Some(place) = pair.place.filter(|_| ui.available_width() > DISTANCE) {
                ui.label(theme::small(ui, format!("≈ {}", format::depth(place.distance_m))));
            }
            if let Some(minutes) = minutes_on(&cx.view.eyes, &pair.name)
                && ui.available_width() > WARMTH
            {
                ui.label(theme::small(ui, warmth(minutes)));
            }
        });
    });
}

fn describe(pair: &CollectedPair, dropped: bool) -> String {
    let seen = |eye: Eye| {
        pair.corners(eye).map_or_else(
            || format!("{eye} eye: board not seen"),
            |corners| format!("{eye} eye: {}", format::count(corners.iter().flatten().count(), "corner")),
        )
    };
    let dropped = if dropped { "\nleft out of the next solution" } else { "" };
    format!("{}\n{}{dropped}", seen(Eye::Left), seen(Eye::Right))
}

fn not_taken_row(ui: &mut Ui, name: &str, why: &str) {
    ui.horizontal(|ui| {
        ui.set_min_height(ROW);
        let text =
            egui::RichText::new(format!("{name}: {why}")).color(Role::Warning.color(theme::tokens(ui)));
        ui.add(egui::Label::new(text).truncate()).on_hover_text(why);
    });
}
