//! What is looked at before anything moves.

use egui::{RichText, Ui};
use plumbline_engine::view::{Gate, GateState};
use plumbline_widgets::theme::{self, Role, space};

/// Every gate, whether it lets pass, and why not.
pub(crate) fn show(ui: &mut Ui, gates: &[Gate]) {
    let tokens = theme::tokens(ui);
    for gate in gates {
        let (sign, role) = match gate.state {
            GateState::Open => ("ok", Role::Accepted),
            GateState::Doubtful => ("note", Role::Weak),
            GateState::Shut => ("not ok", Role::Warning),
        };
        ui.label(RichText::new(format!("{}: {sign}", gate.name)).color(role.color(tokens)));
        ui.label(theme::small(ui, gate.text.clone()));
        ui.add_space(space::XS);
    }
}
