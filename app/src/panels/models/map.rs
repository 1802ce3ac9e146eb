//! A model over the table: what it corrects, what remains, and where the data end.

use egui::Ui;
use plumbline_engine::ModelsCommand;
use plumbline_engine::view::ModelsView;
use plumbline_widgets::buttons::choice;
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format;
use plumbline_widgets::seen::Seen;
use plumbline_widgets::table_map::{BeforeAfter, TableMap};
use plumbline_widgets::theme::{self, Role, space};

use super::drawn::{Drawn, Shown};
use crate::operator::snapshot::models::Method;
use crate::panels::arrows::{Errors, entry, entry_on_field};
use crate::panels::{PanelContext, padded};

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let models = &cx.view.models;
    let Some(map) = &models.map else {
        if models.training {
            EmptyState::loading("The map comes when the models are trained.").show(ui);
            return;
        }
        EmptyState::empty(Message::new(
            "No model to show",
            "Train models: this map then shows what they correct, what remains, and where the data end.",
        ))
        .show(ui);
        return;
    };
    let drawn = cx.state.models.map.get(Seen::of(map), || Drawn::of(map));
    padded(ui, |ui| {
        header(ui, cx, models);
        // A border is nothing to worry about; that there is none is.
        let warn = !drawn.border.is_known();
        let text = theme::strong(ui, &drawn.headline);
        let color = Role::Warning.color(theme::tokens(ui));
        ui.label(if warn { text.color(color) } else { text });
        ui.add_space(space::XS);
        let legend_height = 62.0;
        let height = (ui.available_height() - legend_height).max(160.0);
        draw(ui, cx, &drawn, height);
        let state = &cx.state.models;
        let field = match state.field {
            Shown::Uncertainty => &drawn.sd,
            Shown::Correction => &drawn.shift,
        };
        legend(ui, state.errors, &drawn, field.is_some());
    });
}

/// Which model, which errors, which field.
fn header(ui: &mut Ui, cx: &mut PanelContext<'_>, models: &ModelsView) {
    let shown = models.map.as_ref().and_then(|map| map.method).or(models.shown);
    let mut methods: Vec<Method> = models.proposals.iter().map(|model| model.method()).collect();
    methods.extend(models.in_use.as_ref().map(|model| model.method()));
    methods.sort_unstable();
    methods.dedup();
    ui.horizontal(|ui| {
        if let Some(mut method) = shown {
            let options: Vec<(Method, &str)> =
                methods.iter().map(|method| (*method, method.name())).collect();
            if choice(ui, "Model on the map", &mut method, &options) {
                cx.outbox.send(ModelsCommand::Show(method));
            }
            let proposed = models.map.as_ref().is_some_and(|map| map.proposed);
            ui.label(theme::small(ui, if proposed { "proposed" } else { "in use" }));
        }
    });
    let state = &mut cx.state.models;
    let errors = [(Errors::Before, "Before"), (Errors::After, "After"), (Errors::Both, "Both")];
    choice(ui, "Errors", &mut state.errors, &errors);
    let fields = [(Shown::Uncertainty, "Uncertainty"), (Shown::Correction, "Correction")];
    choice(ui, "Field", &mut state.field, &fields);
}

fn draw(ui: &mut Ui, cx: &PanelContext<'_>, drawn: &Drawn, height: f32) {
    let state = &cx.state.models;
    let scene = drawn.scene(state.errors);
    let words = |at_m| drawn.words(at_m);
    let map = TableMap::new("Map of the model", &scene).words(&words).height(height);
    let field = match state.field {
        Shown::Uncertainty => &drawn.sd,
        Shown::Correction => &drawn.shift,
    };
    match field {
        Some((field, scale)) => map.field(field, *scale).show(ui),
        None => map.show(ui),
    };
}

/// What the arrows mean, in their colors, with their magnification and means.
fn legend(ui: &mut Ui, errors: Errors, drawn: &Drawn, on_field: bool) {
    let Some([before, after]) = drawn.means_m else {
        ui.label(theme::small(ui, "The touches of this model are not known, so no errors can be drawn."));
        return;
    };
    ui.spacing_mut().item_spacing.y = 2.0;
    let scale = drawn.scale(errors);
    let times =
        if scale > 1.0 { format!("{scale} times as long as the error") } else { "in true length".to_owned() };
    ui.label(theme::small(ui, format!("Arrows {times}.")));
    let entry = if on_field { entry_on_field } else { entry };
    if errors != Errors::After {
        entry(
            ui,
            BeforeAfter::BEFORE,
            &format!("Before, without a model: {} on average.", format::mm(before)),
        );
    }
    if errors != Errors::Before {
        entry(
            ui,
            BeforeAfter::AFTER,
            &format!("After, each touch held out: {} on average.", format::mm(after)),
        );
    }
}
