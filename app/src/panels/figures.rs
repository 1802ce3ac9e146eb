//! The verdict on a calibration, and the figures it rests on.

use egui::{RichText, ScrollArea, Ui};
use plumbline_engine::view::{EyesView, Proposal};
use plumbline_model::{FitSummary, StereoCalibration};
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::key_value::{KeyValue, big_figure, key_value_grid};
use plumbline_widgets::theme::{self, Role, space};

use super::PanelContext;
use crate::operator::{Action, Screen, verdict};

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let eyes = &cx.view.eyes;
    let Some(calibration) = super::shown_calibration(eyes) else {
        let message = Message::new("Nothing to judge yet", "Collect pairs of the board and solve them.");
        if EmptyState::empty(message.button("Collect pairs")).show(ui) {
            cx.outbox.act(Action::Go(Screen::Collect));
        }
        return;
    };
    super::padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            match &eyes.proposal {
                Some(proposal) => proposal_verdict(ui, proposal),
                None => {
                    ui.label(theme::strong(ui, "In use"));
                }
            }
            ui.add_space(space::XS);
            // What can be done is in sight also in a low tile.
            buttons(ui, cx);
            ui.add_space(space::S);
            figures(ui, &cx.view.eyes, &calibration);
        });
    });
}

fn proposal_verdict(ui: &mut Ui, proposal: &Proposal) {
    let tokens = theme::tokens(ui);
    if let Some(why) = &proposal.stale {
        ui.label(RichText::new(why).color(Role::Warning.color(tokens)));
        return;
    }
    super::verdict_line::show(ui, &verdict(proposal));
    for doubt in proposal.doubts.iter().skip(1) {
        ui.label(RichText::new(doubt).color(Role::Warning.color(tokens)));
    }
}

fn figures(ui: &mut Ui, eyes: &EyesView, calibration: &StereoCalibration) {
    if let Some(summary) = &calibration.summary {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = space::L;
            let unseen = summary.cross_validated_px.map_or(format::NONE.to_owned(), format::px);
            big_figure(ui, "on unseen pairs", &unseen, Role::Ink);
            big_figure(ui, "vertical error", &format::px(summary.epipolar_px), Role::Ink);
        });
        ui.add_space(space::S);
    }
    let (stated_at_m, depth_per_px_m) = match (&eyes.proposal, &eyes.in_use) {
        (Some(proposal), _) => (proposal.stated_at_m, proposal.depth_per_px_m),
        (None, Some(in_use)) => (in_use.stated_at_m, in_use.depth_per_px_m),
        (None, None) => (0.0, None),
    };
    let mut rows = Vec::new();
    if let Some(summary) = &calibration.summary {
        rows.extend(summary_rows(summary, eyes));
    }
    rows.push(KeyValue::quantity("Baseline", Quantity::Length, calibration.cameras.baseline_m()));
    rows.push(
        KeyValue::optional(
            format!("One pixel at {}", format::depth(stated_at_m)),
            Quantity::Length,
            depth_per_px_m,
        )
        .help("Change of distance, straight ahead, that moves the match by one pixel"),
    );
    rows.push(KeyValue::text("Pairs", calibration.per_pair.len().to_string()));
    let left_out = calibration.left_out_corners().count();
    rows.push(KeyValue::text("Bad corners left out", left_out.to_string()).help(left_out_names(calibration)));
    key_value_grid(ui, "figures", &rows);
    rejected(ui, calibration);
}

fn summary_rows(summary: &FitSummary, eyes: &EyesView) -> [KeyValue; 4] {
    let nominal_mm = format::mm(eyes.board.square_m);
    [
        KeyValue::quantity("Stereo rms", Quantity::Pixels, summary.rms_stereo_px)
            .help("Over the corners of both eyes, on the pairs that were fitted"),
        KeyValue::quantity("Left eye", Quantity::Pixels, summary.rms_left_px),
        KeyValue::quantity("Right eye", Quantity::Pixels, summary.rms_right_px),
        KeyValue::uncertain(
            "Squares measured back",
            Quantity::Length,
            summary.square_mean_m,
            summary.square_sd_m,
        )
        .help(format!("The board's squares as both eyes see them, with their spread; they are {nominal_mm}")),
    ]
}

fn left_out_names(calibration: &StereoCalibration) -> String {
    let mut lines: Vec<String> = calibration
        .left_out_corners()
        .take(12)
        .map(|(pair, corner)| {
            format!(
                "{pair}, {} eye, corner {}: {}",
                corner.eye,
                corner.corner + 1,
                format::px(corner.norm_px())
            )
        })
        .collect();
    if lines.is_empty() {
        lines.push("Every corner fits.".to_owned());
    }
    lines.join("\n")
}

fn rejected(ui: &mut Ui, calibration: &StereoCalibration) {
    if calibration.rejected.is_empty() {
        return;
    }
    ui.add_space(space::S);
    ui.label(theme::strong(ui, format!("{} not used", format::count(calibration.rejected.len(), "pair"))));
    for pair in &calibration.rejected {
        ui.label(theme::small(ui, format!("{}: {}", pair.name, pair.reason)));
    }
}

fn buttons(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    if cx.view.eyes.proposal.is_none() {
        return;
    }
    ui.horizontal_wrapped(|ui| {
        for (action, text) in [(Action::Solve, "Solve again"), (Action::Discard, "Discard the proposal")] {
            let refusal = action.refusal(cx.view);
            let button = ui.add_enabled(refusal.is_none(), egui::Button::new(text));
            if button.on_disabled_hover_text(refusal.unwrap_or_default()).clicked() {
                cx.outbox.act(action);
            }
        }
    });
}
