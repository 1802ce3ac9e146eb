//! All methods on the same held-out touches, which one is proposed, which one is in use.

use egui::{Grid, RichText, ScrollArea, Ui};
use plumbline_engine::view::{ModelsView, StepState, Subject};
use plumbline_engine::{Correction, ModelsCommand, View};
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::glyph::{self, Glyph};
use plumbline_widgets::intervals::{IntervalRow, Intervals, Level};
use plumbline_widgets::theme::{self, Role, space};

use super::parts::facts;
use super::verdict::Facts;
use crate::operator::snapshot::models::{CorrectionModel, Method};
use crate::operator::words::clock;
use crate::operator::{Action, ModelsAction};
use crate::panels::parts::{action_button, undo_button};
use crate::panels::{PanelContext, padded};

/// The line of the spread of repeats. What it is an rms of stands beside means, so it says so.
const REPEATS: &str = "repeats, rms";
/// What that line is, a sentence.
const REPEATS_HELP: &str = "The dashed line is the noise of repeats: how far touches of the same target \
     spread about their mean, rms in the plane.";

/// Less is nothing, m.
const LEAST_HEIGHT_M: f64 = 5e-7;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let models = &cx.view.models;
    if models.proposals.is_empty() && models.in_use.is_none() && models.comparison.is_none() {
        if models.training {
            EmptyState::loading("The models are being trained.").show(ui);
            return;
        }
        let why = format!(
            "Targets are {}. Train models on touches, or import one that was trained before.",
            without_a_model(cx.view)
        );
        let message = Message::new("No model yet", &why);
        if EmptyState::empty(message.button("Import a model…")).show(ui) {
            cx.outbox.act(Action::Models(ModelsAction::Import));
        }
        return;
    }
    let facts = facts(cx);
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            state(ui, models);
            if let Some(headline) = facts.headline() {
                ui.label(theme::strong(ui, headline));
            }
            for sentence in &facts.apart {
                ui.label(theme::small(ui, sentence));
            }
            ui.add_space(space::S);
            chart(ui, cx, &facts);
            // What is decided stands at the picture that it is decided by, in small windows, too.
            ui.add_space(space::XS);
            decide(ui, cx, &facts);
            ui.add_space(space::XS);
            in_use(ui, cx);
            ui.add_space(space::S);
            about_chart(ui, &facts);
            figures(ui, &facts);
            ui.add_space(space::S);
            files(ui, cx);
        });
    });
}

/// Why the model in use should not be trusted any more.
fn state(ui: &mut Ui, models: &ModelsView) {
    let StepState::Stale { why } = &models.step else { return };
    let tokens = theme::tokens(ui);
    let color = Role::Warning.color(tokens);
    ui.horizontal_top(|ui| {
        let (rect, _) = ui.allocate_exact_size(egui::vec2(18.0, 20.0), egui::Sense::hover());
        glyph::paint(ui.painter(), rect.center(), 14.0, Glyph::Warning, color);
        ui.add(egui::Label::new(RichText::new(why).color(color)).wrap());
    });
    ui.add_space(space::XS);
}

/// Means with intervals; the band is the best one's.
fn chart(ui: &mut Ui, cx: &mut PanelContext<'_>, facts: &Facts) {
    if facts.judged.is_empty() {
        return;
    }
    let models = &cx.view.models;
    let mut rows: Vec<IntervalRow> = facts
        .judged
        .iter()
        .map(|judged| IntervalRow {
            name: judged.method.name().to_owned(),
            note: note(models, judged.method).to_owned(),
            mean: Some(judged.errors.mean_2d_m),
            interval: Some(judged.interval_m),
            role: Role::HeldOut,
        })
        .collect();
    let methods: Vec<Method> = facts.judged.iter().map(|judged| judged.method).collect();
    rows.extend(facts.without_m.map(|mean| IntervalRow {
        name: "No model".to_owned(),
        note: String::new(),
        mean: Some(mean),
        interval: None,
        role: Role::Difference,
    }));
    let floor = facts.noise.as_ref().map(|noise| Level {
        name: REPEATS,
        value: noise.rms_2d_m,
        role: Role::NoiseFloor,
    });
    let levels: Vec<Level<'_>> = floor.into_iter().collect();
    let shown = models.shown.and_then(|shown| methods.iter().position(|method| *method == shown));
    let band = facts.best.filter(|_| facts.judged.len() > 1);
    let clicked = Intervals::new("Mean error on held-out touches", &rows, Quantity::Length)
        .levels(&levels)
        .band(band)
        .selected(shown)
        .show(ui);
    if let Some(method) = clicked.and_then(|row| methods.get(row)) {
        cx.outbox.send(ModelsCommand::Show(*method));
    }
}

/// What the chart counts, and from where.
fn about_chart(ui: &mut Ui, facts: &Facts) {
    if facts.judged.is_empty() {
        return;
    }
    let words = "Mean distance in the plane at touches whose whole set was held out, with its 95 % interval. \
                 All of it, also without a model, is counted from where the arm was sent at the contact; Touch counts \
                 from the target.";
    ui.label(theme::small(ui, words));
    if facts.noise.is_some() {
        ui.label(theme::small(ui, REPEATS_HELP));
    }
}

fn note(models: &ModelsView, method: Method) -> &'static str {
    let proposed = models.proposals.iter().any(|model| model.method() == method);
    let in_use = models.in_use.as_ref().is_some_and(|model| model.method() == method);
    match (proposed, in_use) {
        (true, true) => "proposed anew",
        (true, false) => "proposed",
        (false, true) => "in use",
        (false, false) => "",
    }
}

/// What the chart does not show: rms in the plane and of the height.
fn figures(ui: &mut Ui, facts: &Facts) {
    if facts.judged.is_empty() {
        return;
    }
    ui.add_space(space::XS);
    let spacing = [space::L, 2.0];
    Grid::new("figures of the models").num_columns(3).spacing(spacing).min_row_height(18.0).show(ui, |ui| {
        for heading in ["", "rms", "height rms"] {
            ui.label(theme::small(ui, heading));
        }
        ui.end_row();
        for judged in &facts.judged {
            ui.label(theme::weak(ui, judged.method.name()));
            ui.label(format::mm(judged.errors.rms_2d_m));
            // All touches may have been sent to one height; what remains is dust of the numbers.
            let height_m = judged.errors.rms_z_m;
            ui.label(format::mm(if height_m < LEAST_HEIGHT_M { 0.0 } else { height_m }));
            ui.end_row();
        }
        if let Some(noise) = &facts.noise {
            ui.label(theme::weak(ui, "repeats")).on_hover_text(REPEATS_HELP);
            ui.label(format::mm(noise.rms_2d_m));
            ui.label(theme::weak(ui, format::NONE));
            ui.end_row();
        }
    });
}

/// One button per proposal, the best first. Those of what is in use and of what was replaced stay in their places and do
/// nothing: no other button takes the place of one that was just pressed.
fn decide(ui: &mut Ui, cx: &mut PanelContext<'_>, facts: &Facts) {
    let models = &cx.view.models;
    if models.proposals.is_empty() {
        return;
    }
    ui.horizontal_wrapped(|ui| {
        let best = facts.simplest().or(facts.best.map(|best| facts.judged[best].method));
        let proposed = |method: Method| models.proposals.iter().find(|model| model.method() == method);
        let in_use = models.in_use.as_ref().map(|model| model.method());
        let judged = |method: Method| facts.judged.iter().any(|judged| judged.method == method);
        let offered =
            |method: &Method| proposed(*method).is_some() || in_use == Some(*method) || judged(*method);
        let mut methods: Vec<Method> = Method::ALL.into_iter().filter(offered).collect();
        methods.sort_by_key(|method| (Some(*method) != best, std::cmp::Reverse(*method)));
        for method in methods {
            let button = egui::Button::new(format!("Use {}", method.name()));
            let Some(model) = proposed(method) else {
                let why = match in_use == Some(method) {
                    true => "It is in use",
                    false => "Another one took its place: Undo brings it back",
                };
                ui.add_enabled(false, button).on_disabled_hover_text(why);
                continue;
            };
            if ui.add(button).on_hover_text(provenance(model)).clicked() {
                cx.outbox.send(ModelsCommand::Accept(method));
            }
        }
        action_button(ui, cx, ModelsAction::Discard, "Discard proposals");
    });
}

fn in_use(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let models = &cx.view.models;
    let said = match &models.in_use {
        Some(model) => format!("In use: {}{}", provenance(model), beside_effects(cx.view)),
        None => format!("No model is in use: targets are {}.", without_a_model(cx.view)),
    };
    ui.label(said);
    ui.horizontal_wrapped(|ui| {
        undo_button(ui, cx, Subject::Correction);
        if models.in_use.is_some() {
            action_button(ui, cx, ModelsAction::UseNone, "Use none");
        }
    });
}

/// Which of both corrects targets, where there are effects beside the model that is in use.
fn beside_effects(view: &View) -> &'static str {
    match view.touch.correct_with {
        _ if view.gap.model.effects.is_empty() => "",
        Some(Correction::Effects) => ". Targets are corrected by the named effects now, not by it.",
        Some(Correction::Model(_)) => {
            ". Targets are corrected by it alone: the named effects wait meanwhile."
        }
        None => ". Targets are sent as they are now: neither it nor the named effects correct them.",
    }
}

/// What happens to targets where no model is in use.
fn without_a_model(view: &View) -> &'static str {
    match view.touch.correct_with {
        Some(Correction::Effects) => "corrected by the effects that were added",
        Some(Correction::Model(_)) | None => "sent as they are",
    }
}

/// "M3 of 14:02, from 80 touches".
fn provenance(model: &CorrectionModel) -> String {
    let from = model.provenance();
    let touches = match from.touches.len() {
        0 => format!("imported from {}", from.session),
        n => format!("from {}", format::count(n, "touch")),
    };
    format!("{} of {}, {touches}", model.method().name(), clock(from.made))
}

fn files(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let models = &cx.view.models;
    let mut methods: Vec<Method> = models.proposals.iter().map(|model| model.method()).collect();
    methods.extend(models.in_use.as_ref().map(|model| model.method()));
    methods.sort_unstable();
    methods.dedup();
    ui.horizontal_wrapped(|ui| {
        if ui
            .button("Import a model…")
            .on_hover_text("Own JSON, ONNX, or published weights as JSON")
            .clicked()
        {
            cx.outbox.act(Action::Models(ModelsAction::Import));
        }
        let shown = models.shown.filter(|shown| methods.contains(shown)).or(methods.last().copied());
        let Some(method) = shown else { return };
        for (onnx, kind) in [(false, "JSON"), (true, "ONNX")] {
            let export = ModelsAction::Export { method, onnx };
            action_button(ui, cx, export, &format!("Export {} as {kind}…", method.name()));
        }
    });
}
