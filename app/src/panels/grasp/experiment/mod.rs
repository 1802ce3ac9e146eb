//! The experiment with grasps: what is compared, how far it is, a map of each method beside the published
//! counts, the table of all.

mod begin;
mod map;
mod table;

pub use begin::Drafted;

use egui::{ScrollArea, Ui};
use plumbline_engine::view::{ShownTrials, TrialStage, TrialsPhase};
use plumbline_engine::{TrialsFormat, View};
use plumbline_widgets::buttons::choice;
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, space};

use crate::operator::words::trials::ask;
use crate::operator::{GraspAction, TrialsAction};
use crate::panels::parts::{action_button, warning};
use crate::panels::{PanelContext, padded};

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| match cx.view.trials.shown.clone() {
            None => begin::show(ui, cx),
            Some(shown) => under_way(ui, cx, &shown),
        });
    });
}

fn under_way(ui: &mut Ui, cx: &mut PanelContext<'_>, shown: &ShownTrials) {
    ui.label(theme::strong(ui, headline(cx.view, shown)));
    ui.label(theme::weak(ui, doing(cx.view, shown)));
    ui.add_space(space::XS);
    buttons(ui, cx);
    ui.add_space(space::S);
    let methods = &shown.page.methods;
    let chosen = cx.state.grasp.experiment_method.min(methods.len().saturating_sub(1));
    ui.horizontal(|ui| {
        let names: Vec<(usize, &str)> =
            methods.iter().enumerate().map(|(i, method)| (i, method.name.as_str())).collect();
        let mut now = chosen;
        if methods.len() > 1 && choice(ui, "Method on the map", &mut now, &names) {
            cx.state.grasp.experiment_method = now;
        }
    });
    if let Some(method) = methods.get(chosen) {
        map::show(ui, &shown.page, method);
        ui.label(theme::small(
            ui,
            "In the dots: lifted; small beside them: lifted of three on the published robot. Gray: touchscreen.",
        ));
    }
    ui.add_space(space::S);
    table::show(ui, &shown.page);
}

fn headline(view: &View, shown: &ShownTrials) -> String {
    let left = view.trials.remaining.filter(|_| shown.made < shown.all);
    let left = left.map_or_else(String::new, |left| format!(", {}", format::time_left(left)));
    format!("{} of {} attempts{left}", shown.made, shown.all)
}

/// What is done just now, or what a person has to do.
fn doing(view: &View, shown: &ShownTrials) -> String {
    let place = |position: usize| format!("place {} of {}", position + 1, shown.experiment.positions_m.len());
    match &view.trials.phase {
        TrialsPhase::Running { trial, doing, pausing } => {
            let doing = match doing {
                TrialStage::Laying => "lays the thing down",
                TrialStage::Grasping => "grasps",
                TrialStage::Judging => "looks whether it was lifted",
                TrialStage::Clearing => "empties the hand and goes home",
            };
            let method = trial.method.name().to_uppercase();
            let then = if *pausing { "; holds after that" } else { "" };
            format!("{method}, {}: {doing}{then}", place(trial.position))
        }
        TrialsPhase::Asks { at_m, .. } => ask(&shown.experiment.object, *at_m),
        TrialsPhase::WaitsForWord { .. } => "Look: is it held?".to_owned(),
        TrialsPhase::Paused { why } => why.clone(),
        TrialsPhase::Idle if shown.made == shown.all => "All attempts are made.".to_owned(),
        TrialsPhase::Idle => "Goes on exactly where it was.".to_owned(),
    }
}

fn buttons(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    ui.horizontal_wrapped(|ui| {
        match &cx.view.trials.phase {
            TrialsPhase::Idle | TrialsPhase::Paused { .. } => {
                action_button(ui, cx, TrialsAction::GoOn, "Go on");
                action_button(ui, cx, TrialsAction::Close, "Close");
            }
            TrialsPhase::Asks { .. } => {
                action_button(ui, cx, TrialsAction::Placed, "Placed");
                action_button(ui, cx, TrialsAction::Pause, "Pause");
            }
            TrialsPhase::WaitsForWord { .. } => {
                action_button(ui, cx, GraspAction::Held, "Held");
                action_button(ui, cx, GraspAction::NotHeld, "Not held");
            }
            TrialsPhase::Running { .. } => {
                action_button(ui, cx, TrialsAction::Pause, "Pause after this attempt");
            }
        }
        for (format, name) in
            [(TrialsFormat::Csv, "CSV…"), (TrialsFormat::Html, "HTML…"), (TrialsFormat::Pdf, "PDF…")]
        {
            action_button(ui, cx, TrialsAction::Export(format), name);
        }
    });
    if let TrialsPhase::Paused { why } = &cx.view.trials.phase {
        warning(ui, why);
    }
}
