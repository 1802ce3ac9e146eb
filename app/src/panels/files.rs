//! Reading and writing calibration files, and the calibrations accepted before.

use egui::{Button, ScrollArea, Ui};
use plumbline_engine::{ExportFormat, Exported, EyesCommand};
use plumbline_widgets::buttons::choice;
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, space};

use super::PanelContext;
use crate::operator::{Action, format_name};

const FORMATS: [ExportFormat; 5] = [
    ExportFormat::Plumbline,
    ExportFormat::RosCameraInfo,
    ExportFormat::OpenCv,
    ExportFormat::Kalibr,
    ExportFormat::MrcalCorners,
];

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    super::padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            export(ui, cx);
            ui.add_space(space::M);
            import(ui, cx);
            ui.add_space(space::M);
            earlier(ui, cx);
        });
    });
}

fn export(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    ui.label(theme::strong(ui, "Export"));
    let both = cx.view.eyes.proposal.is_some() && cx.view.eyes.in_use.is_some();
    if both {
        let options = [(Exported::Proposal, "The proposal"), (Exported::InUse, "The one in use")];
        choice(ui, "Which calibration is exported", &mut cx.state.exported, &options);
    }
    let what = match (both, cx.view.eyes.proposal.is_some()) {
        (true, _) => cx.state.exported,
        (false, true) => Exported::Proposal,
        (false, false) => Exported::InUse,
    };
    ui.horizontal_wrapped(|ui| {
        for format in FORMATS {
            let action = Action::Export(what, format);
            let refusal = action.refusal(cx.view);
            let button = ui.add_enabled(refusal.is_none(), Button::new(format!("{}…", format_name(format))));
            if button.on_disabled_hover_text(refusal.unwrap_or_default()).clicked() {
                cx.outbox.act(action);
            }
        }
    });
}

fn import(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    ui.label(theme::strong(ui, "Import"));
    ui.label(theme::small(
        ui,
        "Plumbline, ROS camera_info (both eyes' files), OpenCV, Kalibr. It becomes a proposal.",
    ));
    if ui.button("Import a calibration…").clicked() {
        cx.outbox.act(Action::Import);
    }
}

fn earlier(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let eyes = &cx.view.eyes;
    if eyes.earlier.is_empty() {
        return;
    }
    ui.label(theme::strong(ui, "Accepted before"));
    for calibration in eyes.earlier.iter() {
        ui.horizontal(|ui| {
            let age = jiff::Timestamp::now().duration_since(calibration.accepted);
            let age = format::age(std::time::Duration::try_from(age).unwrap_or_default());
            ui.label(format!("{age}: {}", calibration.description));
            if calibration.in_use {
                ui.label(theme::weak(ui, "in use"));
            } else if ui.add(Button::new("Propose again").small()).clicked() {
                cx.outbox.send(EyesCommand::ProposeEarlier { id: calibration.id.clone() });
            }
        });
    }
}
