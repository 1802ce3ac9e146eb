//! What is looked at before anything moves.

use egui::{RichText, Ui};
use plumbline_engine::View;
use plumbline_engine::view::{Gate, GateState};
use plumbline_widgets::theme::{self, Role, space};

use crate::operator::guidance::way_to;
use crate::operator::{Action, Outbox};

/// Every gate, whether it lets pass, and why not, with the way to where that is mended.
pub(crate) fn show(ui: &mut Ui, gates: &[Gate], view: &View, outbox: &mut Outbox) {
    let tokens = theme::tokens(ui);
    for gate in gates {
        let (sign, role) = match gate.state {
            GateState::Open => ("ok", Role::Accepted),
            GateState::Doubtful => ("note", Role::Weak),
            GateState::Shut => ("not ok", Role::Warning),
        };
        ui.label(RichText::new(format!("{}: {sign}", gate.of.name())).color(role.color(tokens)));
        ui.label(theme::small(ui, gate.text.clone()));
        if let Some((label, screen)) = way_to(gate, view)
            && ui.button(label).clicked()
        {
            outbox.act(Action::Go(screen));
        }
        ui.add_space(space::XS);
    }
}
