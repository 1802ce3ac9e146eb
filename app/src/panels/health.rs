//! Whether the calibration in use still holds, and whether the proposed one is better: one button, and what came of it.

use egui::{Button, Ui};
use jiff::Timestamp;
use plumbline_engine::View;
use plumbline_engine::view::{EyesHealth, HealthFigures, HealthState, HealthView};
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::key_value::{KeyValue, key_value_grid};
use plumbline_widgets::theme::{self, group_heading, space};

use super::parts::warning;
use crate::operator::words::health as words;
use crate::operator::{Action, Outbox};

const ROWS: [&str; 3] = ["Near", "Middle", "Far"];

pub fn show(ui: &mut Ui, view: &View, outbox: &mut Outbox) {
    group_heading(ui, "Does the calibration hold?");
    match &view.eyes.health.state {
        HealthState::NotAsked => {
            let text = "Four pairs of whatever lies there, without a board, say how far off it puts places. It takes \
                some seconds.";
            ui.label(theme::weak(ui, text));
        }
        HealthState::Gathering { pairs, of } => busy(ui, &format!("Looks: {pairs} of {of} pairs.")),
        HealthState::Judging => busy(ui, "Compares what both eyes see."),
        HealthState::Failed(why) => warning(ui, why),
        HealthState::Judged(health) => judged(ui, health, &view.eyes.health),
    }
    // What is not offered is said where it would be, and what does not stand any more is not said.
    let health = &view.eyes.health;
    let is_outdated = health.when.is_some_and(|when| when.is_outdated(Timestamp::now()));
    let stands = health.judged.as_deref().filter(|_| !health.is_against_proposal() && !is_outdated);
    if let Some(said) = stands.and_then(words::proposed) {
        ui.label(said);
    }
    ui.add_space(space::XS);
    let action = Action::JudgeHealth;
    let why = action.refusal(view);
    let button = ui.add_enabled(why.is_none(), Button::new(action.label()));
    if button.on_disabled_hover_text(why.unwrap_or_default()).clicked() {
        outbox.act(action);
    }
}

fn busy(ui: &mut Ui, text: &str) {
    ui.horizontal(|ui| {
        ui.spinner();
        ui.label(text);
    });
}

fn judged(ui: &mut Ui, health: &EyesHealth, view: &HealthView) {
    let now = Timestamp::now();
    if let Some(why) = view.when.as_ref().and_then(|when| words::outdated(when, now)) {
        warning(ui, &why);
        ui.label(theme::weak(ui, words::said_then(health)));
    } else {
        let said = words::in_use(health, view.colder_wait_min);
        if health.in_use.is_good {
            ui.label(said);
        } else {
            warning(ui, &said);
        }
    }
    if let Some(when) = &view.when {
        ui.label(theme::small(ui, words::judged(when, now)));
    }
    figures(ui, "In use", &health.in_use);
    if let Some((proposed, _)) = &health.proposed {
        figures(ui, "Proposed", proposed);
    }
    let (places, pairs) = (format::count(health.places, "place"), format::count(health.pairs, "pair"));
    ui.label(theme::small(ui, format!("By {places} in {pairs}.")));
}

fn figures(ui: &mut Ui, name: &str, figures: &HealthFigures) {
    group_heading(ui, name);
    let off = figures.off_m.into_iter().zip(figures.sigma_m);
    let mut rows: Vec<KeyValue> = ROWS
        .into_iter()
        .zip(off)
        .map(|(row, (off_m, sigma_m))| KeyValue::text(row, format::whole_mm_with(off_m, sigma_m)))
        .collect();
    rows.push(KeyValue::quantity("Right eye has turned", Quantity::Angle, figures.turn_rad));
    rows.push(
        KeyValue::text("Matches off", format::px(figures.epipolar_px))
            .help("How far matched places leave the epipolar lines, vertically. They are matched some ten times less finely than corners of a board"),
    );
    key_value_grid(ui, &format!("health {name}"), &rows);
}
