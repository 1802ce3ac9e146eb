//! Earlier attempts with their outcome.

use egui::{Button, RichText, ScrollArea, Ui, vec2};
use plumbline_engine::view::AttemptView;
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, Role, space};

use crate::operator::words::clock;
use crate::operator::words::grasp::{method, result};
use crate::panels::{PanelContext, padded};

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let attempts = cx.view.grasp.attempts.clone();
    if attempts.is_empty() {
        let message =
            Message::new("Nothing was grasped yet", "Each attempt is listed here and kept with its images.");
        EmptyState::empty(message).show(ui);
        return;
    }
    padded(ui, |ui| {
        let held = attempts.iter().filter(|attempt| attempt.is_success()).count();
        let unsaid = attempts.iter().filter(|attempt| attempt.is_success() && attempt.told.is_none()).count();
        let by_whom = match unsaid {
            0 => String::new(),
            n => format!(", {n} of them by fingers and eyes alone"),
        };
        let broken_off = attempts.iter().filter(|attempt| attempt.is_broken_off()).count();
        let ended = match broken_off {
            0 => String::new(),
            n => format!("; {n} more broken off"),
        };
        let all = attempts.len() - broken_off;
        ui.label(theme::weak(ui, format!("{held} of {all} held{by_whom}{ended}")));
        ui.add_space(space::XS);
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            for attempt in attempts.iter() {
                row(ui, cx, attempt);
            }
        });
    });
}

fn row(ui: &mut Ui, cx: &mut PanelContext<'_>, attempt: &AttemptView) {
    let chosen = cx.state.grasp.chosen.as_deref() == Some(&attempt.name);
    let role = if attempt.is_success() { Role::Accepted } else { Role::Warning };
    let beside = attempt.alignment_m.map_or_else(String::new, |m| format!(", {} beside", format::mm(m)));
    let text = format!(
        "{}   {}  {}   {}{beside}",
        clock(attempt.began),
        method(attempt.method),
        attempt.object.to_lowercase(),
        result(attempt)
    );
    let text = RichText::new(text).color(role.color(theme::tokens(ui)));
    let button = Button::selectable(chosen, text).truncate().min_size(vec2(ui.available_width(), 22.0));
    if ui.add(button).clicked() {
        cx.state.grasp.chosen = (!chosen).then(|| attempt.name.clone());
    }
}
