//! The proposal and the calibration in use, figure by figure.

use egui::{Align, Grid, Label, Layout, RichText, ScrollArea, Ui};
use plumbline_engine::view::Origin;
use plumbline_model::StereoCalibration;
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, space};

use super::PanelContext;
use crate::window::{Action, Screen, verdict};

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let eyes = &cx.view.eyes;
    if eyes.proposal.is_none() && eyes.in_use.is_none() {
        let message = Message::new("No calibration yet", "Collect pairs of the board and solve them, or import a file.");
        if EmptyState::empty(message.button("Collect pairs")).show(ui) {
            cx.outbox.act(Action::Go(Screen::Collect));
        }
        return;
    }
    egui::Frame::new().inner_margin(space::M).show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            if let Some(proposal) = eyes.proposal.as_ref().filter(|proposal| proposal.stale.is_none()) {
                super::verdict_line::show(ui, &verdict(proposal));
                ui.add_space(space::S);
            }
            let proposed = eyes.proposal.as_ref().map(|p| (&*p.calibration, origin_text(&p.origin), p.depth_per_px_m));
            let in_use = eyes.in_use.as_ref().map(|a| {
                let accepted = format::age(age_of(a.accepted));
                (&*a.calibration, format!("accepted {accepted}"), a.depth_per_px_m)
            });
            columns(ui, proposed, in_use);
            if eyes.proposal.is_some() {
                ui.add_space(space::M);
                if ui.button("Discard the proposal").clicked() {
                    cx.outbox.act(Action::Discard);
                }
            }
        });
    });
}

fn age_of(at: jiff::Timestamp) -> std::time::Duration {
    std::time::Duration::try_from(jiff::Timestamp::now().duration_since(at)).unwrap_or_default()
}

fn origin_text(origin: &Origin) -> String {
    match origin {
        Origin::Solved => "solved just now".to_owned(),
        Origin::Imported { file } => format!("from {file}"),
        Origin::Earlier { accepted } => format!("accepted {}", format::age(age_of(*accepted))),
    }
}

/// A calibration, where it is from, and what a pixel means in meters.
type Column<'a> = Option<(&'a StereoCalibration, String, Option<f64>)>;

fn columns(ui: &mut Ui, proposed: Column<'_>, in_use: Column<'_>) {
    let none = || format::NONE.to_owned();
    let of = |column: &Column<'_>, text: &dyn Fn(&StereoCalibration) -> Option<String>| {
        column.as_ref().and_then(|(calibration, ..)| text(calibration)).unwrap_or_else(none)
    };
    let summary = |pick: fn(&plumbline_model::FitSummary) -> Option<String>| {
        move |calibration: &StereoCalibration| calibration.summary.as_ref().and_then(pick)
    };
    let origin = |column: &Column<'_>| column.as_ref().map_or_else(none, |(_, text, _)| text.clone());
    let per_px = |column: &Column<'_>| {
        column.as_ref().and_then(|(.., per_px)| *per_px).map_or_else(none, format::mm)
    };
    Grid::new("comparison").num_columns(3).spacing([space::L, space::XS]).min_row_height(22.0).show(ui, |ui| {
        ui.label("");
        right(ui, theme::strong(ui, "Proposal"));
        right(ui, theme::strong(ui, "In use"));
        ui.end_row();
        row(ui, "Where from", origin(&proposed), origin(&in_use));
        let mut figure = |name: &str, text: &dyn Fn(&StereoCalibration) -> Option<String>| {
            row(ui, name, of(&proposed, text), of(&in_use, text));
        };
        figure("Pairs", &|c| (!c.per_pair.is_empty()).then(|| c.per_pair.len().to_string()));
        figure("On unseen pairs", &summary(|s| s.cross_validated_px.map(format::px)));
        figure("Stereo rms", &summary(|s| Some(format::px(s.rms_stereo_px))));
        figure("Epipolar", &summary(|s| Some(format::px(s.epipolar_px))));
        figure("Squares measured back", &summary(|s| Some(format::mm_with(s.square_mean_m, s.square_sd_m))));
        figure("Baseline", &|c| Some(format::mm(c.cameras.baseline_m())));
        figure("Focal length left", &|c| Some(format::px(c.cameras.left.model.focal_px().0)));
        figure("Focal length right", &|c| Some(format::px(c.cameras.right.model.focal_px().0)));
        row(ui, "One pixel in depth", per_px(&proposed), per_px(&in_use));
    });
}

fn row(ui: &mut Ui, name: &str, proposed: String, in_use: String) {
    ui.label(theme::weak(ui, name));
    let tokens = theme::tokens(ui);
    right(ui, RichText::new(proposed).color(tokens.text_strong));
    right(ui, RichText::new(in_use).color(tokens.text));
    ui.end_row();
}

fn right(ui: &mut Ui, text: RichText) {
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| ui.add(Label::new(text).extend()));
}
