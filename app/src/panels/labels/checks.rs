//! What is wrong in a data set, and what an import would do.

use egui::{Label, RichText, ScrollArea, Ui};
use plumbline_engine::LabelsCommand;
use plumbline_engine::view::ImportView;
use plumbline_widgets::buttons::accent_button;
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, Role, group_heading, space};

use super::parts::action_button;
use crate::operator::{Action, LabelsAction};
use crate::panels::PanelContext;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        if let Some(import) = cx.view.labels.import.clone() {
            import_plan(ui, cx, &import);
        }
        group_heading(ui, "Problems");
        let problems = cx.view.labels.problems.clone();
        if problems.is_empty() {
            ui.label(theme::weak(ui, "None: every box lies on its image, is large enough and stands once."));
        }
        for problem in problems.iter() {
            if problem.image.is_empty() {
                ui.add(Label::new(&problem.text).wrap());
                continue;
            }
            let color = Role::Warning.color(theme::tokens(ui));
            if ui.link(RichText::new(&problem.image).color(color)).clicked() {
                cx.outbox.send(LabelsCommand::Choose { image: problem.image.clone() });
            }
            ui.add(Label::new(theme::weak(ui, &*problem.text)).wrap());
            ui.add_space(space::XS);
        }
    });
}

fn import_plan(ui: &mut Ui, cx: &mut PanelContext<'_>, import: &ImportView) {
    group_heading(ui, "Import, nothing is written yet");
    ui.add(Label::new(import.from.display().to_string()).wrap());
    let boxes = format::count(import.boxes, "box");
    ui.label(format!("{} with {boxes} would come in.", format::count(import.images, "image")));
    if import.renumbered {
        let text = "Class numbers differ: classes are matched by name, and the numbers are changed to those of this data set.";
        let color = Role::Warning.color(theme::tokens(ui));
        ui.add(Label::new(RichText::new(text).color(color)).wrap());
    }
    ui.add_space(space::S);
    let names = cx.view.labels.set.as_ref().map(|set| set.names.clone()).unwrap_or_default();
    egui::Grid::new("import classes").num_columns(2).spacing([space::M, 2.0]).show(ui, |ui| {
        ui.label(theme::small(ui, "There"));
        ui.label(theme::small(ui, "Here"));
        ui.end_row();
        for (number, (name, here)) in import.classes.iter().enumerate() {
            ui.label(format!("{number}  {name}"));
            match here {
                Some(class) => ui.label(format!("{}  {}", class.0, names.get(*class).unwrap_or("?"))),
                None => ui.label(RichText::new("left out").color(Role::Warning.color(theme::tokens(ui)))),
            };
            ui.end_row();
        }
    });
    if import.classes.iter().any(|(_, here)| here.is_none()) {
        let text = "Boxes of classes that this data set does not have are left out. To keep them, add the names at the end of its data.yaml and open it again.";
        ui.add(Label::new(theme::weak(ui, text)).wrap());
    }
    if !import.skipped.is_empty() {
        let text = match import.skipped.as_slice() {
            [one] => format!("{one} is there already by name and stays as it is."),
            more => format!(
                "{} images are there already by name and stay as they are: {}.",
                more.len(),
                some(more)
            ),
        };
        ui.add(Label::new(theme::weak(ui, text)).wrap());
    }
    for problem in &import.problems {
        ui.add(Label::new(theme::weak(ui, &**problem)).wrap());
    }
    ui.add_space(space::S);
    ui.horizontal(|ui| {
        if ui.add(accent_button(ui, "Accept the import")).clicked() {
            cx.outbox.act(Action::Labels(LabelsAction::AcceptImport));
        }
        action_button(ui, cx, LabelsAction::DiscardImport, "Discard");
    });
}

/// The first few of many names.
fn some(names: &[String]) -> String {
    const FEW: usize = 4;
    let first = names.iter().take(FEW).cloned().collect::<Vec<_>>().join(", ");
    if names.len() > FEW { format!("{first} and {} more", names.len() - FEW) } else { first }
}
