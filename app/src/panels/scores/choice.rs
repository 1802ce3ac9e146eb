//! Which detectors are judged on which data set.

use egui::{Button, Label, ScrollArea, Ui};
use plumbline_engine::{ScoresCommand, SetPart};
use plumbline_widgets::buttons::choice;
use plumbline_widgets::format;
use plumbline_widgets::progress::progress_bar;
use plumbline_widgets::theme::{self, space};

use crate::operator::{Action, ScoresAction};
use crate::panels::PanelContext;
use crate::panels::parts::{action_button, progress};

/// Room for the button, or for how far the evaluation is.
const START_HEIGHT: f32 = 44.0;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    // The button stays in sight however many detectors there are.
    let room = (ui.available_height() - START_HEIGHT).max(60.0);
    ScrollArea::vertical().auto_shrink(false).max_height(room).show(ui, |ui| {
        ui.label(theme::strong(ui, "Detectors"));
        models(ui, cx);
        action_button(ui, cx, ScoresAction::AddModels, "Add a detector…");
        ui.add_space(space::S);
        ui.label(theme::strong(ui, "Data set"));
        set(ui, cx);
    });
    ui.add_space(space::XS);
    start(ui, cx);
}

fn models(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let models = cx.view.scores.models.clone();
    if models.is_empty() {
        ui.label(theme::weak(ui, "None yet. Add ONNX files, or drop them here."));
    }
    for model in models.iter() {
        ui.horizontal(|ui| {
            ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Truncate);
            let mut chosen = model.chosen;
            let name =
                model.file.file_name().unwrap_or(model.file.as_os_str()).to_string_lossy().into_owned();
            let text = if model.shipped { format!("{name} (shipped)") } else { name.clone() };
            if ui.checkbox(&mut chosen, text).on_hover_text(model.file.display().to_string()).changed() {
                cx.outbox.send(ScoresCommand::ChooseModel { file: model.file.clone(), chosen });
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if model.shipped {
                    return;
                }
                let remove = ui.add(egui::Button::new(theme::small(ui, "Remove")).frame(false));
                remove.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Remove {name}"))
                });
                if remove.clicked() {
                    cx.outbox.send(ScoresCommand::RemoveModel { file: model.file.clone() });
                }
            });
        });
    }
}

fn set(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    match &cx.view.scores.set {
        None => {
            ui.label(theme::weak(ui, "None yet. Choose a folder with a data.yaml, or drop it here."));
        }
        Some(path) => {
            let name = super::parts::set_name(path);
            ui.add(Label::new(name).truncate()).on_hover_text(path.display().to_string());
        }
    }
    ui.horizontal_wrapped(|ui| {
        action_button(ui, cx, ScoresAction::ChooseSet, "Choose…");
        if cx.view.labels.set.is_some() {
            action_button(ui, cx, ScoresAction::UseOpenSet, "Use the open one");
        }
    });
    let mut part = cx.view.scores.part;
    let parts = [(SetPart::Val, "Val"), (SetPart::Train, "Train"), (SetPart::Test, "Test")];
    if choice(ui, "Part", &mut part, &parts) {
        cx.outbox.send(ScoresCommand::ChoosePart(part));
    }
}

fn start(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    if let Some((fraction, doing)) = progress(cx.view, cx.view.scores.evaluating) {
        let width = ui.available_width();
        progress_bar(ui, "Evaluation", fraction, egui::vec2(width, 6.0));
        ui.horizontal(|ui| {
            if ui.button("Cancel").clicked() {
                cx.outbox.act(Action::CancelJob);
            }
            let text = format!("{} · {doing}", format::percent(fraction));
            ui.add(Label::new(theme::weak(ui, text)).truncate());
        });
        return;
    }
    let why = ScoresAction::Evaluate.refusal(cx.view);
    let button = ui.add_enabled(why.is_none(), Button::new("Evaluate"));
    if button.on_disabled_hover_text(why.clone().unwrap_or_default()).clicked() {
        cx.outbox.act(Action::Scores(ScoresAction::Evaluate));
    }
}
