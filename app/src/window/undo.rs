//! The one place of Undo: at the foot of the inspector, on every screen.

use egui::{Button, Label, Margin, Panel, Ui};
use plumbline_engine::View;
use plumbline_widgets::theme::{self, space};

use crate::operator::actions::undo::undo;
use crate::operator::words::capitalized;
use crate::operator::{Action, GapAction, Outbox, Screen, shortcut_text};
use crate::panels::rest::Rest;

pub(super) const HEIGHT: f32 = 40.0;

pub(super) fn show(view: &View, screen: Screen, rest: &mut Rest<()>, ui: &mut Ui, outbox: &mut Outbox) {
    let undo = undo(view, screen);
    let rests = rest.is_on(ui.ctx());
    let frame = egui::Frame::new().inner_margin(Margin { top: space::S as i8, ..Margin::ZERO });
    let foot = Panel::bottom("undo").frame(frame).exact_size(HEIGHT).resizable(false);
    foot.show_separator_line(false).show(ui, |ui| {
        ui.horizontal(|ui| {
            let button = ui.add_enabled(undo.is_ok() && !rests, Button::new("Undo"));
            let button = match &undo {
                Ok(undo) => {
                    let keys = shortcut_text(ui.ctx(), Action::Undo).unwrap_or_default();
                    button.on_hover_text(format!("{keys}: {}", undo.help()))
                }
                Err(why) => button.on_disabled_hover_text(capitalized(why)),
            };
            if button.clicked() {
                // Pressed twice at once it would take back two results, the second one unseen.
                rest.begin(ui.ctx());
                outbox.act(Action::Undo);
            }
            // Where the robot model can be taken back, what was taken back last can be put back.
            let redo = GapAction::Redo;
            let is_there = matches!(screen, Screen::Gap | Screen::HandEye | Screen::Timeline);
            if is_there && redo.refusal(view).is_none() {
                let button = ui.add_enabled(!rests, Button::new("Put back")).on_hover_text(redo.label());
                if button.clicked() {
                    rest.begin(ui.ctx());
                    outbox.act(Action::Gap(redo));
                }
            }
            if let Ok(undo) = &undo {
                ui.add(Label::new(theme::small(ui, undo.of)).truncate());
            }
        });
    });
}
