//! What the panes of this folder share.

use std::sync::Arc;

use egui::{Label, RichText, Sense, Ui, vec2};
use plumbline_engine::View;
use plumbline_engine::view::ShownFinding;
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::glyph::{self, Glyph};
use plumbline_widgets::theme::{self, Role};

use crate::operator::{Action, GapAction};
use crate::panels::PanelContext;
use crate::panels::parts::progress;

/// The finding, or what stands in its place: not looked for yet, under way, failed. The button of the bottom line looks
/// for it.
pub fn finding(ui: &mut Ui, cx: &mut PanelContext<'_>, what: &str) -> Option<Arc<ShownFinding>> {
    let gap = &cx.view.gap;
    if let Some(shown) = &gap.shown {
        return Some(shown.clone());
    }
    if let Some((fraction, doing)) = progress(cx.view, cx.view.gap.searching) {
        let percent = plumbline_widgets::format::percent(fraction);
        EmptyState::loading(&format!("Looking for the gap: {doing} ({percent}).")).show(ui);
        return None;
    }
    if let Some(why) = &gap.failed {
        let message = Message::new("The gap could not be looked for", why);
        if EmptyState::failed(message.button("Try again")).show(ui) {
            cx.outbox.act(Action::Gap(GapAction::Find));
        }
        return None;
    }
    EmptyState::empty(Message::new("Nothing was looked for yet", what)).show(ui);
    None
}

/// That what is shown is old, or that a new search is under way.
pub fn state(ui: &mut Ui, view: &View) {
    if let Some((fraction, doing)) = progress(view, view.gap.searching) {
        ui.horizontal(|ui| {
            ui.spinner();
            let percent = plumbline_widgets::format::percent(fraction);
            let said = match view.gap.shown.is_some() {
                true => format!("Looking again: {doing} ({percent}). Below is the finding before."),
                false => format!("Looking for the gap: {doing} ({percent})."),
            };
            ui.add(Label::new(theme::weak(ui, said)).wrap());
        });
    } else if let Some(why) = &view.gap.failed {
        line(ui, Glyph::Cross, Role::Warning, why);
    } else if let Some(why) = &view.gap.stale {
        line(ui, Glyph::Clock, Role::Warning, why);
    }
}

/// A sentence with its sign.
pub fn line(ui: &mut Ui, sign: Glyph, role: Role, text: &str) {
    let tokens = theme::tokens(ui);
    ui.horizontal_top(|ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(18.0, 20.0), Sense::hover());
        glyph::paint(ui.painter(), rect.center(), 14.0, sign, role.color(tokens));
        let color = if role == Role::Warning { role.color(tokens) } else { tokens.text };
        ui.add(Label::new(RichText::new(text).color(color)).wrap());
    });
}
