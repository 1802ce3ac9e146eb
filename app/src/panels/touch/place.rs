//! Where the screen lies: nominal, in use, proposed.

use egui::{Grid, RichText, ScrollArea, Ui};
use plumbline_engine::view::TouchView;
use plumbline_model::touchscreen::ScreenPlacement;
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::key_value::big_figure;
use plumbline_widgets::theme::{self, Role, space};

use super::words;
use crate::operator::words::{screen, sentence};
use crate::operator::{Action, Preset, TouchAction, Verdict};
use crate::panels::parts::{action_button, warning};
use crate::panels::{PanelContext, padded, verdict_line};

/// Axes of the robot frame: what moving along and turning about them means for the screen.
const AXES: [(&str, &str); 3] =
    [("forward", "right side down"), ("left", "far side down"), ("up", "to the left")];

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let view = cx.view;
    let touch = &view.touch;
    let Some((shown, what)) = shown(touch) else {
        let corners = Action::Touch(TouchAction::Plan(Preset::Corners));
        let possible = corners.refusal(view).is_none();
        let message = Message::new(
            "The described place is in use",
            "As it is described; a real screen lies some millimeters beside it. Touch its corners to measure it.",
        );
        let message = if possible { message.button("Plan to touch the corners") } else { message };
        if EmptyState::empty(message).show(ui) {
            cx.outbox.act(corners);
        }
        return;
    };
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            figures(ui, shown, what);
            ui.horizontal_wrapped(|ui| buttons(ui, cx));
            ui.add_space(space::S);
            table(ui, touch);
            let doubts = shown.doubts();
            for remark in &shown.remarks {
                if doubts.contains(remark) {
                    warning(ui, remark);
                } else {
                    ui.label(theme::weak(ui, sentence(remark)));
                }
            }
        });
    });
}

/// The proposal, else the place in use.
fn shown(touch: &TouchView) -> Option<(&ScreenPlacement, &'static str)> {
    let proposed = touch.placement_proposal.as_deref().map(|placement| (placement, "proposed"));
    proposed.or_else(|| touch.placement.as_deref().map(|placement| (placement, "in use")))
}

pub(super) fn figures(ui: &mut Ui, placement: &ScreenPlacement, what: &str) {
    let (good, sentence) = screen::verdict(placement);
    verdict_line::show(ui, &Verdict { good, sentence });
    ui.add_space(space::XS);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = space::L;
        big_figure(ui, &format!("moved, {what}"), &format::mm(norm(placement.moved_m)), Role::Difference);
        big_figure(ui, "turned", &format::degrees(norm(placement.turned_rad)), Role::Difference);
        big_figure(ui, "residual, rms", &format::mm(placement.rms_m), Role::Ink);
    });
    let age = jiff::Timestamp::now().duration_since(placement.at);
    let age = format::age(std::time::Duration::try_from(age).unwrap_or_default());
    ui.label(theme::small(ui, format!("{}, measured {age}", words::touches(placement.touches))));
    ui.add_space(space::XS);
}

fn norm(parts: [f64; 3]) -> f64 {
    parts.iter().map(|part| part * part).sum::<f64>().sqrt()
}

/// One row per direction, one column per place.
fn table(ui: &mut Ui, touch: &TouchView) {
    let columns: Vec<(&str, &ScreenPlacement)> =
        [("in use", touch.placement.as_deref()), ("proposed", touch.placement_proposal.as_deref())]
            .into_iter()
            .filter_map(|(name, placement)| Some((name, placement?)))
            .collect();
    ui.spacing_mut().interact_size.y = 20.0;
    Grid::new("screen place").num_columns(columns.len() + 1).spacing([space::M, 2.0]).show(ui, |ui| {
        ui.label(theme::small(ui, "against nominal"));
        for (name, _) in &columns {
            ui.label(theme::small(ui, *name));
        }
        ui.end_row();
        for (i, (along, _)) in AXES.iter().enumerate() {
            ui.label(theme::weak(ui, format!("{along}, mm")));
            for (_, placement) in &columns {
                figure(ui, Quantity::Length, placement.moved_m[i], placement.sd_m[i]);
            }
            ui.end_row();
        }
        for (i, (_, about)) in AXES.iter().enumerate() {
            ui.label(theme::weak(ui, format!("{about}, °")));
            for (_, placement) in &columns {
                figure(ui, Quantity::Angle, placement.turned_rad[i], placement.sd_rad[i]);
            }
            ui.end_row();
        }
    });
}

fn figure(ui: &mut Ui, quantity: Quantity, value: f64, sigma: f64) {
    ui.label(RichText::new(quantity.number_with(value, sigma)).color(theme::tokens(ui).text_strong));
}

fn buttons(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    for (action, text) in [
        (TouchAction::AcceptScreen, "Use this place"),
        (TouchAction::DiscardScreen, "Discard proposal"),
        (TouchAction::NominalScreen, "Use nominal"),
    ] {
        if action.refusal(cx.view).is_none() {
            action_button(ui, cx, action, text);
        }
    }
}
