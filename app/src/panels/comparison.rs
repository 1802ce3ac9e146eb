//! The proposal and the calibration in use, figure by figure.

use egui::{Align2, ScrollArea, Sense, TextStyle, Ui, WidgetInfo, vec2};
use plumbline_engine::view::Origin;
use plumbline_model::StereoCalibration;
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, space};

use super::PanelContext;
use crate::operator::words::health;
use crate::operator::{Action, Screen, Verdict, verdict};

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let eyes = &cx.view.eyes;
    if eyes.proposal.is_none() && eyes.in_use.is_none() {
        let message = Message::new(
            "No calibration yet",
            "Collect pairs of the board and solve them, or import a file.",
        );
        if EmptyState::empty(message.button("Collect pairs")).show(ui) {
            cx.outbox.act(Action::Go(Screen::Collect));
        }
        return;
    }
    super::padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            if let Some(proposal) = eyes.proposal.as_ref().filter(|proposal| proposal.stale.is_none()) {
                let against = health::not_offered(eyes, jiff::Timestamp::now())
                    .map(|why| Verdict { good: false, sentence: why.sentence });
                super::verdict_line::show(ui, &against.unwrap_or_else(|| verdict(proposal)));
                ui.add_space(space::S);
            }
            // What can be done stands over the figures: below them a small window would hide it.
            if eyes.proposal.is_some() && ui.button("Discard the proposal").clicked() {
                cx.outbox.act(Action::Discard);
            }
            if eyes.in_use.is_some() {
                super::health::show(ui, cx.view, cx.outbox);
            }
            ui.add_space(space::M);
            let proposed =
                eyes.proposal.as_ref().map(|p| (&*p.calibration, origin_text(&p.origin), p.depth_per_px_m));
            let in_use = eyes
                .in_use
                .as_ref()
                .map(|a| (&*a.calibration, format::age(age_of(a.accepted)), a.depth_per_px_m));
            columns(ui, proposed, in_use);
        });
    });
}

fn age_of(at: jiff::Timestamp) -> std::time::Duration {
    std::time::Duration::try_from(jiff::Timestamp::now().duration_since(at)).unwrap_or_default()
}

fn origin_text(origin: &Origin) -> String {
    match origin {
        Origin::Solved => "just solved".to_owned(),
        Origin::Imported { file } => file.clone(),
        Origin::Earlier { accepted } => format::age(age_of(*accepted)),
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
    let per_px =
        |column: &Column<'_>| column.as_ref().and_then(|(.., per_px)| *per_px).map_or_else(none, format::mm);
    ui.spacing_mut().item_spacing.y = 0.0;
    row(ui, "", "Proposal", "In use", true);
    row(ui, "Made", &origin(&proposed), &origin(&in_use), false);
    let mut figure = |name: &str, text: &dyn Fn(&StereoCalibration) -> Option<String>| {
        row(ui, name, &of(&proposed, text), &of(&in_use, text), false);
    };
    figure("Pairs", &|c| (!c.per_pair.is_empty()).then(|| c.per_pair.len().to_string()));
    figure("On unseen pairs", &summary(|s| s.cross_validated_px.map(format::px)));
    figure("Stereo rms", &summary(|s| Some(format::px(s.rms_stereo_px))));
    figure("Vertical error", &summary(|s| Some(format::px(s.epipolar_px))));
    figure("Squares", &summary(|s| Some(format::mm_with(s.square_mean_m, s.square_sd_m))));
    figure("Baseline", &|c| Some(format::mm(c.cameras.baseline_m())));
    figure("Focal length left", &|c| Some(format::px(c.cameras.left.model.focal_px().0)));
    figure("Focal length right", &|c| Some(format::px(c.cameras.right.model.focal_px().0)));
    row(ui, "One pixel in depth", &per_px(&proposed), &per_px(&in_use), false);
}

/// The name beside two figures takes so much of a line, points.
const NAME: f32 = 120.0;
/// What the longest figure takes: "30.01 ± 0.61 mm".
const FIGURE: f32 = 112.0;
const LINE: f32 = 24.0;
/// Of two lines that belong together.
const NARROW_LINE: f32 = 18.0;

/// One line of three columns, the figures aligned at their right ends; in a narrow panel the name stands over them.
fn row(ui: &mut Ui, name: &str, proposed: &str, in_use: &str, heading: bool) {
    let is_narrow = ui.available_width() < NAME + 2.0 * FIGURE;
    let is_folded = is_narrow && !heading;
    let line = if is_folded { NARROW_LINE } else { LINE };
    let height = if is_folded { 2.0 * line } else { line };
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    response.widget_info(|| {
        WidgetInfo::labeled(egui::Role::Row, true, format!("{name}: proposal {proposed}, in use {in_use}"))
    });
    let tokens = theme::tokens(ui);
    let style = if heading { theme::strong_style(ui) } else { TextStyle::Body };
    let text = |ui: &Ui, text: &str, [x, y]: [f32; 2], anchor: Align2, color| {
        let font = style.resolve(ui.style());
        ui.painter().text(egui::pos2(x, y), anchor, text, font, color);
    };
    let figures = if is_narrow { rect.width() / 2.0 } else { (rect.width() - NAME) / 2.0 };
    let [first_y, last_y] = [rect.top() + 0.5 * line, rect.bottom() - 0.5 * line];
    text(ui, name, [rect.left(), first_y], Align2::LEFT_CENTER, tokens.text_weak);
    text(ui, proposed, [rect.right() - figures, last_y], Align2::RIGHT_CENTER, tokens.text_strong);
    let in_use_color = if heading { tokens.text_strong } else { tokens.text };
    text(ui, in_use, [rect.right(), last_y], Align2::RIGHT_CENTER, in_use_color);
}
