//! The chessboard in the twin's world.

use egui::Ui;
use plumbline_engine::TwinCommand;
use plumbline_widgets::NumberField;
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, space};

use crate::operator::RobotAction;
use crate::panels::PanelContext;
use crate::panels::parts::action_button;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let view = cx.view;
    let places = view.twin.board_places;
    theme::group_heading(ui, "Chessboard");
    ui.label(theme::small(ui, if view.twin.board.is_some() { "Out, see the eyes." } else { "Put away." }));
    if places > 0 {
        ui.horizontal_wrapped(|ui| {
            let mut place = cx.state.twin.board_place.clamp(1, places);
            let suffix = format!(" of {places}");
            let name = "Place of the board";
            NumberField { name, range: 1..=places, suffix: &suffix, speed: 0.1, decimals: 0 }
                .show(ui, &mut place);
            cx.state.twin.board_place = place;
            if ui.button("Hold it there").on_hover_text("A hand that nobody sees holds the board").clicked() {
                cx.outbox.send(TwinCommand::HoldBoard { place: place - 1 });
                cx.state.twin.board_place = place % places + 1;
            }
        });
    }
    ui.add_space(space::XS);
    ui.horizontal_wrapped(|ui| {
        action_button(
            ui,
            cx,
            RobotAction::TourBoard,
            &format!("Show at all {}", format::count(places, "place")),
        );
        action_button(ui, cx, RobotAction::LayBoard, "Lay on table");
        action_button(ui, cx, RobotAction::HideBoard, "Put away");
    });
}
