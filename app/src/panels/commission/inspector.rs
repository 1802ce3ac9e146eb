//! What commissioning took, and its rare buttons.

use egui::{Button, Ui};
use plumbline_engine::View;
use plumbline_widgets::key_value::{KeyValue, big_figure, key_value_grid};
use plumbline_widgets::theme::{Role, group_heading, space};

use super::steps::note;
use crate::operator::words::clock;
use crate::operator::{Action, CommissionAction, Outbox};

pub fn show(ui: &mut Ui, view: &View, outbox: &mut Outbox) {
    let commission = &view.commission;
    group_heading(ui, "Spent so far");
    let minutes = commission.spent.time.as_secs() / 60;
    big_figure(ui, "minutes", &minutes.to_string(), Role::Measured);
    let rows = [
        KeyValue::text("Touches", commission.spent.touches.to_string()).help("Contacts with the screen"),
        KeyValue::text("Board views", commission.spent.views.to_string())
            .help("Pairs that were captured of the board in the hand, and head poses from which it was looked at as it lies on the table"),
        KeyValue::text("Begun", commission.began.map_or_else(|| "not yet".to_owned(), clock)),
    ];
    key_value_grid(ui, "commission spent", &rows);
    ui.add_space(space::XS);
    note(ui, "Counted while the program is open, and kept: after a restart it goes on.");
    group_heading(ui, "This way");
    // Once it is left the bar above goes and all moves up: what ends all lies above, never under the pointer.
    for action in [CommissionAction::StartAnew, CommissionAction::Leave] {
        let why = action.refusal(view);
        let button = ui.add_enabled(why.is_none(), Button::new(action.label()));
        if button.on_disabled_hover_text(why.unwrap_or_default()).clicked() {
            outbox.act(Action::Commission(action));
        }
    }
    note(ui, "What was accepted stays in use. Each step can also be done by itself, on its own screen.");
}
