//! How the left eye sits in the head: nominal, in use, and proposed, as differences to nominal.

use egui::{Grid, RichText, ScrollArea, Ui};
use jiff::Timestamp;
use plumbline_engine::view::{MountSummary, MountView};
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::key_value::big_figure;
use plumbline_widgets::theme::{self, Role, space};

use crate::operator::{Action, MountAction, Verdict, words};
use crate::panels::{PanelContext, padded, verdict_line};

/// Axes of the head: what moving along and turning about them means for an eye.
const AXES: [(&str, &str); 3] = [("forward", "roll"), ("left", "nod"), ("up", "turn")];

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let view = cx.view;
    let mount = &view.mount;
    if mount.proposal.is_none() && mount.in_use.is_none() {
        EmptyState::empty(Message::new(
            "The nominal mount is in use",
            "From the head's drawing; real eyes sit some degrees beside it, which is centimeters on the table. Take views and solve.",
        ))
        .show(ui);
        return;
    }
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            if let Some(proposal) = &mount.proposal {
                let (good, sentence) = words::mount::verdict(proposal);
                verdict_line::show(ui, &Verdict { good, sentence });
                ui.add_space(space::XS);
            }
            figures(ui, mount);
            // What the verdict rests on is read before its figures.
            if let Some(proposal) = &mount.proposal {
                notes(ui, proposal);
            }
            table(ui, mount);
            // A look at the hands tells it.
            if view.handeye.in_use.is_none() {
                ui.add_space(space::XS);
                ui.label(theme::small(ui, words::mount::NOT_IN_IT));
            }
            buttons(ui, cx);
        });
    });
}

fn figures(ui: &mut Ui, mount: &MountView) {
    let (summary, what) = match (&mount.proposal, &mount.in_use) {
        (Some(proposal), _) => (proposal, "proposed"),
        (None, Some(in_use)) => (in_use, "in use"),
        (None, None) => return,
    };
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = space::L;
        big_figure(ui, &format!("residual, {what}"), &format::px(summary.rms_px), Role::Ink);
        big_figure(ui, "turned", &format::degrees(norm(summary.turned_rad)), Role::Difference);
        big_figure(ui, "moved from nominal", &format::mm(norm(summary.moved_m)), Role::Difference);
    });
    let age = Timestamp::now().duration_since(summary.at);
    let age = format::age(std::time::Duration::try_from(age).unwrap_or_default());
    ui.label(theme::small(ui, format!("{}, solved {age}", format::count(summary.views, "view"))));
    ui.add_space(space::S);
}

fn norm(parts: [f64; 3]) -> f64 {
    parts.iter().map(|part| part * part).sum::<f64>().sqrt()
}

/// One row per direction, one column per mount.
fn table(ui: &mut Ui, mount: &MountView) {
    let columns: Vec<(&str, &MountSummary)> = [("in use", &mount.in_use), ("proposed", &mount.proposal)]
        .into_iter()
        .filter_map(|(name, summary)| Some((name, summary.as_ref()?)))
        .collect();
    ui.spacing_mut().interact_size.y = 20.0;
    Grid::new("mount").num_columns(columns.len() + 1).spacing([space::M, 3.0]).striped(false).show(
        ui,
        |ui| {
            ui.label(theme::small(ui, "against nominal"));
            for (name, _) in &columns {
                ui.label(theme::small(ui, *name));
            }
            ui.end_row();
            for (i, (along, _)) in AXES.iter().enumerate() {
                ui.label(theme::weak(ui, format!("{along}, mm")));
                for (_, summary) in &columns {
                    figure(ui, Quantity::Length, summary.moved_m[i], summary.moved_sd_m[i]);
                }
                ui.end_row();
            }
            for (i, (_, about)) in AXES.iter().enumerate() {
                ui.label(theme::weak(ui, format!("{about}, °")));
                for (_, summary) in &columns {
                    figure(ui, Quantity::Angle, summary.turned_rad[i], summary.turned_sd_rad[i]);
                }
                ui.end_row();
            }
        },
    );
}

fn figure(ui: &mut Ui, quantity: Quantity, value: f64, sigma: f64) {
    ui.label(RichText::new(quantity.number_with(value, sigma)).color(theme::tokens(ui).text_strong));
}

fn notes(ui: &mut Ui, proposal: &MountSummary) {
    let warning = Role::Warning.color(theme::tokens(ui));
    ui.add_space(space::S);
    let (doubts, held) = proposal.doubts();
    for sentence in doubts {
        ui.label(RichText::new(words::sentence(sentence)).color(warning));
    }
    for sentence in held {
        ui.label(theme::small(ui, words::sentence(sentence)));
    }
    for (name, why) in &proposal.rejected {
        ui.label(theme::small(ui, format!("{name} is left out: {why}.")));
    }
}

fn buttons(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    ui.add_space(space::S);
    ui.horizontal_wrapped(|ui| {
        for (action, text) in
            [(MountAction::Discard, "Discard proposal"), (MountAction::UseNominal, "Use nominal")]
        {
            if action.refusal(cx.view).is_none() && ui.button(text).on_hover_text(action.label()).clicked() {
                cx.outbox.act(Action::Mount(action));
            }
        }
    });
}
