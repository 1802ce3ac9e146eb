//! What stands in the middle of the window while no source is open: where images can come from.

use std::collections::VecDeque;

use egui::{Align, Button, Layout, RichText, Ui, UiBuilder, vec2};
use plumbline_engine::{SourceCommand, SourceSpec};
use plumbline_widgets::theme::{self, space};

use crate::operator::words::source_name;
use crate::operator::{Action, Outbox, RobotAction};

/// What can be opened, and in which case one would.
const WAYS: [(Action, &str); 5] = [
    (Action::OpenFolder, "Image pairs in one folder, or in a folder with left and right in it."),
    (Action::OpenTwoFolders, "One folder per eye; the same file name is one pair."),
    (Action::OpenVideos, "One video per eye."),
    (Action::OpenCameras, "The eyes themselves, live."),
    (Action::Robot(RobotAction::ConnectTwin), "A simulated robot, to try everything on."),
];
const WIDTH: f32 = 560.0;
const BUTTON_WIDTH: f32 = 190.0;

/// Draws it in the middle of the available space.
pub fn show(ui: &mut Ui, recent: &VecDeque<SourceSpec>, outbox: &mut Outbox) {
    let rect = ui.available_rect_before_wrap();
    ui.painter().rect_filled(rect, 0.0, theme::tokens(ui).background);
    let rows = WAYS.len() + recent.len().min(4);
    let height = 176.0 + rows as f32 * 36.0;
    let size = vec2(WIDTH.min(rect.width() - 2.0 * space::L), height.min(rect.height()));
    let middle = egui::Rect::from_center_size(rect.center(), size);
    let layout = Layout::top_down(Align::Min);
    ui.scope_builder(UiBuilder::new().max_rect(middle).layout(layout), |ui| contents(ui, recent, outbox));
}

fn contents(ui: &mut Ui, recent: &VecDeque<SourceSpec>, outbox: &mut Outbox) {
    ui.heading("Where do the images come from?");
    ui.add_space(space::M);
    for (action, when) in WAYS {
        ui.horizontal(|ui| {
            let button = Button::new(action.label()).min_size(vec2(BUTTON_WIDTH, 30.0));
            if ui.add(button).clicked() {
                outbox.act(action);
            }
            ui.add_space(space::S);
            ui.add(egui::Label::new(theme::weak(ui, when)).wrap());
        });
    }
    ui.add_space(space::M);
    ui.label(theme::weak(ui, "Or drop a folder, two videos or a calibration file anywhere on the window."));
    ui.label(theme::weak(
        ui,
        "Without a robot: plumbline sample --out FOLDER renders pairs of a made-up lab.",
    ));
    if recent.is_empty() {
        return;
    }
    ui.add_space(space::L);
    ui.label(theme::strong(ui, "Opened before"));
    ui.add_space(space::XS);
    for spec in recent.iter().take(4) {
        let name = RichText::new(source_name(spec));
        if ui.add(Button::new(name).min_size(vec2(BUTTON_WIDTH, 30.0))).clicked() {
            outbox.send(SourceCommand::Open(spec.clone()));
        }
    }
}
