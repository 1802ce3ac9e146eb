//! Training: from which touches, which methods, how; and how it goes.

use egui::{Button, Checkbox, Ui, vec2};
use plumbline_engine::ModelsCommand;
use plumbline_engine::view::{JobState, ModelsView};
use plumbline_widgets::NumberField;
use plumbline_widgets::buttons::choice;
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::loss_curves::{LossCurve, LossCurves, loss_legend, loss_range};
use plumbline_widgets::theme::{self, Role, space};

use super::parts::about;
use super::sessions;
use crate::operator::actions::{too_few_for, training_refusal};
use crate::operator::snapshot::models::{LossPoint, Method};
use crate::operator::{Action, Screen};
use crate::panels::{PanelContext, padded};

const CHART_HEIGHT: f32 = 150.0;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let models = &cx.view.models;
    if models.sessions.is_empty() && models.session.is_none() {
        let message = Message::new(
            "Nothing to learn from yet",
            "Models learn from touches of the screen: touch it first (step 3), or open a session that was recorded elsewhere.",
        );
        if EmptyState::empty(message.button("Go to Touch")).show(ui) {
            cx.outbox.act(Action::Go(Screen::Touch));
        }
        return;
    }
    padded(ui, |ui| {
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            sessions::show(ui, cx);
            ui.add_space(space::S);
            methods(ui, cx);
            more(ui, cx);
            ui.add_space(space::S);
            button(ui, cx);
            ui.add_space(space::S);
            failed(ui, cx);
            curves(ui, &cx.view.models);
        });
    });
}

fn methods(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    ui.label(theme::strong(ui, "Models"));
    ui.spacing_mut().item_spacing.y = 2.0;
    for (i, method) in Method::ALL.into_iter().enumerate() {
        ui.horizontal(|ui| {
            let too_few = too_few_for(cx.view, method);
            // What was chosen stays for a session that has enough.
            let mut none = false;
            let on = if too_few.is_some() { &mut none } else { &mut cx.state.models.methods[i] };
            ui.add_enabled(too_few.is_none(), Checkbox::new(on, method.name()))
                .on_disabled_hover_text(too_few.unwrap_or_default());
            ui.add(egui::Label::new(theme::small(ui, about(method))).truncate());
        });
    }
}

fn more(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let state = &mut cx.state.models;
    egui::CollapsingHeader::new("More").id_salt("more of training").show(ui, |ui| {
        choice(
            ui,
            "Recipe",
            &mut state.published_recipe,
            &[(false, "Ours: ensemble, shrinkage from the data"), (true, "As published: Adam, 200 epochs")],
        );
        ui.horizontal(|ui| {
            let label = ui.label("Seed");
            NumberField { name: "Seed", range: 0..=999_999_999, suffix: "", speed: 0.1, decimals: 0 }
                .show(ui, &mut state.seed)
                .labelled_by(label.id);
            ui.label(theme::small(ui, "the same seed gives the same models"));
        });
    });
}

fn button(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let models = &cx.view.models;
    let chosen: Vec<Method> = Method::ALL
        .into_iter()
        .zip(cx.state.models.methods)
        .filter_map(|(method, on)| (on && too_few_for(cx.view, method).is_none()).then_some(method))
        .collect();
    let on = match &models.data {
        Some(Ok(data)) => format!(" on {}", format::count(data.len(), "touch")),
        _ => String::new(),
    };
    let text = format!("Train {}{on}", listed(&chosen));
    let why = if chosen.is_empty() {
        Some("Choose at least one model.".to_owned())
    } else {
        let why = training_refusal(cx.view, &chosen);
        why.map(|why| format!("{}.", crate::operator::words::capitalized(why.trim_end_matches('.'))))
    };
    // Why the session cannot be used stands below its name already.
    let why =
        why.map(
            |why| {
                if matches!(models.data, Some(Err(_))) { "Choose another session.".to_owned() } else { why }
            },
        );
    // The bottom line has what comes next; here are other choices than its own.
    let pressed = ui.add_enabled(why.is_none(), Button::new(text).wrap()).clicked();
    if let Some(why) = why {
        ui.label(theme::small(ui, why));
    }
    if pressed {
        cx.outbox.send(ModelsCommand::Train {
            methods: chosen,
            seed: cx.state.models.seed,
            published_recipe: cx.state.models.published_recipe,
        });
    }
}

/// "M1, M2 and M3".
fn listed(methods: &[Method]) -> String {
    let names: Vec<&str> = methods.iter().map(|method| method.name()).collect();
    if names.is_empty() { "models".to_owned() } else { plumbline_model::listed(&names) }
}

/// How the last training ended, when it did not end well.
fn failed(ui: &mut Ui, cx: &PanelContext<'_>) {
    if cx.view.models.training || !cx.view.models.proposals.is_empty() {
        return;
    }
    let job = cx.view.jobs.iter().rev().find(|job| job.title.starts_with("Train"));
    let reason = match job.map(|job| &job.state) {
        Some(JobState::Failed { reason }) => reason.clone(),
        Some(JobState::Panicked { message }) => {
            format!("Training stopped with a defect of this program: {message}. Nothing was changed.")
        }
        _ => return,
    };
    let color = Role::Warning.color(theme::tokens(ui));
    ui.label(egui::RichText::new(reason).color(color));
    ui.add_space(space::S);
}

/// A chart per network, all on one scale.
fn curves(ui: &mut Ui, models: &ModelsView) {
    if models.losses.is_empty() && !models.training {
        return;
    }
    let charts: Vec<(Method, Vec<LossCurve>)> = [Method::M2, Method::M3]
        .into_iter()
        .map(|method| (method, of_method(&models.losses, method)))
        .filter(|(_, curves)| models.training || !curves.is_empty())
        .collect();
    let all: Vec<LossCurve> = charts.iter().flat_map(|(_, curves)| curves.iter().cloned()).collect();
    let range = loss_range(&all);
    loss_legend(ui);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = space::S;
        let count = charts.len().max(1) as f32;
        let width = (ui.available_width() - space::S * (count - 1.0)) / count;
        for (method, curves) in &charts {
            let caption = caption(curves);
            LossCurves::new(method.name(), curves, Quantity::Length)
                .caption(&caption)
                .range(range.filter(|_| !curves.is_empty()))
                .running(models.training)
                .step("step")
                .size(vec2(width, CHART_HEIGHT))
                .show(ui);
        }
    });
}

/// One curve per block that is held out, then one per network of the final model.
fn of_method(losses: &[LossPoint], method: Method) -> Vec<LossCurve> {
    let mut blocks: Vec<(bool, usize, LossCurve)> = Vec::new();
    for point in losses.iter().filter(|point| point.method == method) {
        let held_out = point.held_out_rms_m.is_some();
        let place =
            blocks.iter().position(|(of_block, member, _)| (*of_block, *member) == (held_out, point.member));
        let place = place.unwrap_or_else(|| {
            let what = if held_out { "block" } else { "final network" };
            let name = format!("{what} {}", point.member + 1);
            blocks.push((held_out, point.member, LossCurve { name, ..LossCurve::default() }));
            blocks.len() - 1
        });
        let curve = &mut blocks[place].2;
        let iteration = point.iteration as f64;
        curve.train.push((iteration, point.train_rms_m));
        curve.held_out.extend(point.held_out_rms_m.map(|loss| (iteration, loss)));
    }
    blocks.into_iter().map(|(.., curve)| curve).collect()
}

/// Mean of where the held-out curves stand now.
fn caption(curves: &[LossCurve]) -> String {
    let ends: Vec<f64> = curves.iter().filter_map(|curve| Some(curve.held_out.last()?.1)).collect();
    if ends.is_empty() {
        return if curves.is_empty() { "not begun" } else { "learning" }.to_owned();
    }
    format!("held out {}", format::mm(ends.iter().sum::<f64>() / ends.len() as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_told_apart_by_block_and_by_network() {
        let point = |member, iteration, held_out_rms_m| LossPoint {
            method: Method::M3,
            member,
            iteration,
            train_rms_m: 0.01 / iteration as f64,
            held_out_rms_m,
        };
        let losses = [
            point(0, 1, Some(0.02)),
            point(1, 1, Some(0.03)),
            point(0, 2, Some(0.01)),
            point(1, 2, Some(0.02)),
            point(0, 1, None),
        ];
        let curves = of_method(&losses, Method::M3);
        let names: Vec<&str> = curves.iter().map(|curve| curve.name.as_str()).collect();
        assert_eq!(names, ["block 1", "block 2", "final network 1"]);
        assert_eq!(curves[0].held_out, [(1.0, 0.02), (2.0, 0.01)]);
        assert!(curves[2].held_out.is_empty());
        assert_eq!(caption(&curves), "held out 15.0 mm");
        assert!(of_method(&losses, Method::M2).is_empty());
    }

    #[test]
    fn methods_are_listed_as_one_says_them() {
        assert_eq!(listed(&Method::ALL), "M1, M2 and M3");
        assert_eq!(listed(&[Method::M2]), "M2");
    }
}
