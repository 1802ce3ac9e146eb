//! Which detector, what it is, and whether its names can be trusted.

use egui::{RichText, Ui};
use plumbline_engine::view::{DetectView, DetectorFacts, DetectorState};
use plumbline_engine::{DetectCommand, DetectorChoice, Provider};
use plumbline_model::{ClassIndex, ClassNames};
use plumbline_widgets::class_words;
use plumbline_widgets::theme::{self, Role, space};

use super::drawing::DOUBT;
use crate::operator::{Action, DetectAction, Outbox};

/// The detector in use, or why there is none, with what can be done about it.
pub fn state(ui: &mut Ui, detect: &DetectView, outbox: &mut Outbox) {
    let tokens = theme::tokens(ui);
    match &detect.detector {
        DetectorState::Ready(facts) => {
            ui.label(theme::strong(ui, &facts.name));
            let names: Vec<&str> = facts.names.iter().map(|(_, name)| class_words(name)).collect();
            ui.label(theme::small(ui, names.join(", ")));
            names_differ(ui, facts);
            for remark in &facts.remarks {
                ui.label(RichText::new(remark).color(DOUBT.color(tokens)));
            }
        }
        DetectorState::Loading { name } => {
            ui.horizontal(|ui| {
                ui.spinner();
                ui.label(format!("Reading {name}"));
            });
            ui.label(theme::weak(ui, "The pictures go on meanwhile."));
        }
        DetectorState::Failed { name, why } => {
            ui.label(RichText::new(format!("No objects: {name} cannot be used")).color(DOUBT.color(tokens)));
            ui.label(why);
            if ui.button("Read it again").clicked() {
                outbox.act(Action::Detect(DetectAction::Retry));
            }
        }
        DetectorState::Off => {
            ui.label(theme::weak(ui, "Detection is off."));
        }
        DetectorState::None => {
            ui.label(theme::weak(ui, "The detector is read once a picture is there."));
        }
    }
    if let Some(name) = &detect.opening
        && detect.facts().is_some()
    {
        ui.label(theme::weak(ui, format!("Reading {name}; the one in use goes on until then.")));
    }
    if let Some(why) = &detect.refused {
        ui.label(RichText::new(why).color(DOUBT.color(tokens)));
        ui.label(theme::weak(ui, "The detector before stays in use."));
    }
    if let Some(why) = &detect.failed {
        ui.label(RichText::new(why).color(DOUBT.color(tokens)));
    }
}

/// Buttons that change the detector.
pub fn choice(ui: &mut Ui, detect: &DetectView, outbox: &mut Outbox) {
    ui.horizontal_wrapped(|ui| {
        for action in [DetectAction::ChooseFile, DetectAction::UseShipped, DetectAction::Off] {
            let in_use = match action {
                DetectAction::UseShipped => detect.settings.detector == DetectorChoice::Shipped,
                DetectAction::Off => detect.settings.detector == DetectorChoice::Off,
                _ => false,
            };
            if !in_use && ui.button(action.button()).on_hover_text(action.label()).clicked() {
                outbox.act(Action::Detect(action));
            }
        }
    });
    if detect.facts().is_none() {
        provider(ui, detect, outbox);
    }
}

/// What computes the network.
fn provider(ui: &mut Ui, detect: &DetectView, outbox: &mut Outbox) {
    let before = detect.settings.provider;
    let mut provider = before;
    ui.horizontal_wrapped(|ui| {
        let label = ui.label(theme::weak(ui, "Computed by"));
        egui::ComboBox::from_id_salt("provider")
            .width(72.0)
            .selected_text(provider.to_string())
            .show_ui(ui, |ui| {
                for other in Provider::ALL {
                    ui.selectable_value(&mut provider, other, other.to_string());
                }
            })
            .response
            .labelled_by(label.id);
    });
    if provider != before {
        outbox.send(DetectCommand::Provider(provider));
    }
}

/// What is known of the detector in use.
pub fn about(ui: &mut Ui, detect: &DetectView, facts: &DetectorFacts, outbox: &mut Outbox) {
    provider(ui, detect, outbox);
    if let Some(file) = &facts.file {
        ui.label(theme::small(ui, file.display().to_string()));
    }
    for (name, value) in &facts.rows {
        ui.label(theme::small(ui, format!("{name}: {value}")));
    }
    ui.label(theme::small(ui, format!("Names of the classes: {}", facts.names_from)));
}

/// Why the names of the classes cannot be trusted; `None` when there is one list only.
fn names_problem(facts: &DetectorFacts) -> Option<String> {
    let (other, from) = facts.other_names.as_ref()?;
    let differing = lines(&facts.names, other).filter(|(a, b)| a != b).count();
    Some(format!(
        "Check the classes: {} of them are named differently by {} and by {from}. The names of {} are used.",
        differing, facts.names_from, facts.names_from
    ))
}

/// Both lists side by side, with what differs marked by color, by weight and by a sign.
fn names_differ(ui: &mut Ui, facts: &DetectorFacts) {
    let (Some(problem), Some((other, from))) = (names_problem(facts), &facts.other_names) else { return };
    let warning = DOUBT.color(theme::tokens(ui));
    let frame = egui::Frame::new().stroke(egui::Stroke::new(1.5, warning)).corner_radius(4.0);
    ui.add_space(space::XS);
    frame.inner_margin(space::S).show(ui, |ui| {
        ui.label(RichText::new(problem).text_style(theme::strong_style(ui)).color(warning));
        ui.add_space(space::XS);
        let grid = egui::Grid::new("names").num_columns(4).spacing([space::S, 2.0]);
        grid.show(ui, |ui| {
            for title in ["", facts.names_from.as_str(), from.as_str(), ""] {
                ui.add(egui::Label::new(theme::small(ui, title)).wrap());
            }
            ui.end_row();
            for (number, (used, other)) in lines(&facts.names, other).enumerate() {
                let differs = used != other;
                ui.label(theme::small(ui, number.to_string()));
                for name in [used, other] {
                    let text = RichText::new(name.unwrap_or("none"));
                    let color = if differs { Role::Warning } else { Role::Weak }.color(theme::tokens(ui));
                    let text = text.color(color);
                    ui.label(if differs { text.text_style(theme::strong_style(ui)) } else { text });
                }
                ui.label(RichText::new(if differs { "≠" } else { "" }).color(warning));
                ui.end_row();
            }
        });
    });
    ui.add_space(space::XS);
}

/// The two lists, class by class.
fn lines<'a>(
    used: &'a ClassNames,
    other: &'a ClassNames,
) -> impl Iterator<Item = (Option<&'a str>, Option<&'a str>)> {
    let count = used.len().max(other.len());
    (0..count).map(|i| (used.get(ClassIndex(i)), other.get(ClassIndex(i))))
}
