//! What is looked at, part by part, and what was seen of it.

use egui::{RichText, ScrollArea, Ui};
use plumbline_engine::view::{
    GraspHand, HandEyePart, HandEyeSeen, HandEyeSummary, HandEyeView, HandFigures, HandOutcome, PartState,
};
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::key_value::big_figure;
use plumbline_widgets::theme::{self, Role, space};

use crate::operator::HandEyeAction;
use crate::operator::words::clock;
use crate::panels::parts::{action_button, warning};
use crate::panels::{PanelContext, padded};

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let view = cx.view.handeye.clone();
    let summary = view.proposal.as_ref().or(view.in_use.as_ref());
    if summary.is_none() && view.parts.is_empty() && view.stale.is_some() && cx.view.gap.model.can_redo {
        return padded(ui, |ui| taken_back(ui, cx));
    }
    if summary.is_none() && view.parts.is_empty() {
        EmptyState::empty(Message::new(
            "The arms are not tied to the eyes",
            "Touches say how the arm errs, the board how the eyes sit. Looking at the hands says how both stand to each other.",
        ))
        .show(ui);
        return;
    }
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            match summary.filter(|_| !view.is_looking) {
                Some(summary) => came_of_it(ui, &view, summary),
                None => under_way(ui, &view),
            }
            ui.add_space(space::S);
            ui.horizontal_wrapped(|ui| {
                for (action, text) in [(HandEyeAction::Discard, "Discard"), (HandEyeAction::End, "End")] {
                    if action.refusal(cx.view).is_none() {
                        action_button(ui, cx, action, text);
                    }
                }
            });
        });
    });
}

/// What was learned of the hands is not in the model any more, and may be put back.
fn taken_back(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    if let Some(why) = &cx.view.handeye.stale {
        warning(ui, why);
    }
    let how = "What was taken back of the robot model last can be put back, beside Undo; nothing moves.";
    ui.label(theme::weak(ui, how));
}

/// One line per part, while they are looked at, or were until it was broken off.
fn under_way(ui: &mut Ui, view: &HandEyeView) {
    if !view.is_looking {
        warning(
            ui,
            "This look was broken off: nothing of it is kept. The next one begins at the first part.",
        );
        ui.add_space(space::XS);
    }
    for part in view.parts.iter() {
        let (text, role) = match &part.state {
            PartState::Waits => ("waits".to_owned(), Role::Weak),
            PartState::Looks(number, of) => (format!("look {number} of {of}"), Role::Ink),
            PartState::Done(seen) => words(seen),
        };
        line(ui, name(part.part), &text, role);
    }
}

fn came_of_it(ui: &mut Ui, view: &HandEyeView, summary: &HandEyeSummary) {
    let what = if view.proposal.is_some() { "proposed" } else { "in use" };
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = space::L;
        if let Some((hand, [before_m, after_m])) = summary.worse() {
            let role = if after_m > before_m { Role::Warning } else { Role::Accepted };
            big_figure(ui, &format!("{} hand, {what}", hand.name()), &format::mm(after_m), role);
            big_figure(ui, &format!("{} hand, before", hand.name()), &format::mm(before_m), Role::Ink);
        }
    });
    let worse = if summary.hands.len() > 1 { ", of both hands the one that is worse now" } else { "" };
    let said = format!(
        "How far beside its arm it is seen, rms on looks that were not used{worse}. Looked at {}.",
        clock(summary.at)
    );
    ui.label(theme::small(ui, said));
    ui.add_space(space::S);
    if let Some(why) = &view.stale {
        warning(ui, why);
    }
    let seen = [
        HandEyeSeen::Body(summary.body),
        HandEyeSeen::Screen(summary.screen.clone().map(Box::new)),
        HandEyeSeen::Table(summary.table),
    ];
    let parts = [HandEyePart::Body, HandEyePart::Screen, HandEyePart::Table];
    for (part, seen) in parts.into_iter().zip(&seen) {
        let (text, role) = words(seen);
        line(ui, name(part), &text, role);
    }
    for (hand, said) in &summary.hands {
        let (text, role) = words_of_hand(said);
        line(ui, name(HandEyePart::Hand(*hand)), &text, role);
    }
}

fn line(ui: &mut Ui, name: &str, text: &str, role: Role) {
    ui.label(theme::strong(ui, name));
    ui.label(RichText::new(text).color(role.color(theme::tokens(ui))));
    ui.add_space(space::XS);
}

fn name(part: HandEyePart) -> &'static str {
    match part {
        HandEyePart::Body => "The robot's body",
        HandEyePart::Screen => "The screen's frame",
        HandEyePart::Table => "The table around it",
        HandEyePart::Hand(GraspHand::Right) => "The right hand",
        HandEyePart::Hand(GraspHand::Left) => "The left hand",
    }
}

fn words(seen: &HandEyeSeen) -> (String, Role) {
    let unseen = |what: &str| (what.to_owned(), Role::Warning);
    match seen {
        HandEyeSeen::Body(Some(body)) => {
            let off = Quantity::Angle.text_with(body.neck_rad, body.neck_sd_rad);
            (format!("the neck's turn is off by {off}"), Role::Ink)
        }
        HandEyeSeen::Body(None) => unseen("its edges are not seen: the neck's zero stays less sure"),
        HandEyeSeen::Screen(Some(screen)) => {
            (format!("seen, {} of edges are left over", format::px(screen.rms_px)), Role::Ink)
        }
        HandEyeSeen::Screen(None) => unseen("its edges are not seen: clear the table, and look again"),
        HandEyeSeen::Table(Some(table)) => {
            let over = format::mm_with(table.glass_over_m, table.sd_m);
            (format!("the glass lies {over} over it"), Role::Ink)
        }
        HandEyeSeen::Table(None) => {
            ("too even to be measured: the glass is taken to lie 2 mm over it".to_owned(), Role::Weak)
        }
        HandEyeSeen::Hand(_, said) => words_of_hand(said),
    }
}

fn words_of_hand(said: &HandOutcome) -> (String, Role) {
    match said {
        HandOutcome::Sized(figures) => {
            let mm = |m: Option<f64>| m.map_or("not known".to_owned(), format::mm);
            let HandFigures { found, looked, before_m, after_m, .. } = figures;
            let text = format!(
                "found at {found} of {looked} places; beside its arm {} → {}",
                mm(*before_m),
                mm(*after_m)
            );
            (text, Role::Ink)
        }
        HandOutcome::Stays(why) => (format!("its arm stays as it was: {why}"), Role::Warning),
    }
}
