//! Where the hands are seen, over the table: an arrow per look, before and after.

use egui::Ui;
use plumbline_engine::view::{GraspHand, HandEyeSummary, HandMiss};
use plumbline_widgets::buttons::choice;
use plumbline_widgets::format;
use plumbline_widgets::table_map::{BeforeAfter, Outline, Place, TableMap, TableMark, TableScene};
use plumbline_widgets::theme::{self, Role, space};

use crate::panels::arrows::{Errors, arrow_scale, entry};
use crate::panels::{PanelContext, padded};

/// Around everything that is shown, m.
const MARGIN_M: f64 = 0.05;
/// A place is meant that is nearer than this, m.
const NEAR_M: f64 = 0.03;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let view = cx.view.handeye.clone();
    let Some(summary) = view.proposal.as_ref().or(view.in_use.as_ref()) else {
        let title = match view.is_looking {
            true => "The hands are being looked at",
            false if view.stale.is_some() => "What the eyes saw of the hands is not in use",
            false => "No hands were looked at yet",
        };
        let message = plumbline_widgets::empty::Message::new(
            title,
            "The map then shows where each hand was held, and how far beside that the eyes saw it.",
        );
        plumbline_widgets::empty::EmptyState::empty(message).show(ui);
        return;
    };
    let pairs = pairs(summary);
    padded(ui, |ui| {
        let options = [(Errors::Before, "Before"), (Errors::After, "After"), (Errors::Both, "Both")];
        choice(ui, "Errors of the hands", &mut cx.state.handeye.errors, &options);
        ui.add_space(space::XS);
        let errors = cx.state.handeye.errors;
        let scene = scene(cx, &pairs, errors);
        let words = |at_m: [f64; 2]| words(&pairs, at_m);
        let height = (ui.available_height() - 58.0).max(140.0);
        TableMap::new("Map of the hands", &scene).words(&words).height(height).show(ui);
        legend(ui, &scene, errors);
    });
}

/// A look before and after.
struct Pair<'a> {
    hand: GraspHand,
    before: &'a HandMiss,
    after: &'a HandMiss,
}

fn pairs(summary: &HandEyeSummary) -> Vec<Pair<'_>> {
    let mut pairs = vec![];
    for (hand, said) in &summary.hands {
        let Some(figures) = said.figures() else { continue };
        let looks = figures.before.iter().zip(&figures.after);
        pairs.extend(looks.map(|(before, after)| Pair { hand: *hand, before, after }));
    }
    pairs
}

fn scene(cx: &PanelContext<'_>, pairs: &[Pair<'_>], errors: Errors) -> TableScene {
    let screen_m = cx.view.gap.rig.as_ref().map_or_else(Vec::new, |rig| {
        rig.touchscreen.corners().map(|corner| [corner.coords.x, corner.coords.y]).to_vec()
    });
    let range = |axis: usize| {
        let places = pairs.iter().map(|pair| pair.before.at_m).chain(screen_m.iter().copied());
        let ends = places
            .map(|at_m| at_m[axis])
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        if ends.0 < ends.1 { [ends.0 - MARGIN_M, ends.1 + MARGIN_M] } else { [-0.5, 0.7] }
    };
    let length = |off_m: Option<[f64; 2]>| off_m.map(|[x, y]| x.hypot(y));
    let lengths = pairs.iter().filter_map(|pair| match errors {
        Errors::After => length(pair.after.off_m),
        Errors::Before | Errors::Both => length(pair.before.off_m),
    });
    let outlines = match screen_m.is_empty() {
        true => vec![],
        false => vec![Outline {
            place: Place::Touchscreen,
            name: "touchscreen".to_owned(),
            corners_m: screen_m.clone(),
        }],
    };
    let unseen = pairs.iter().filter(|pair| pair.before.off_m.is_none() && pair.after.off_m.is_none());
    let arrow = |pair: &Pair<'_>| BeforeAfter {
        at_m: pair.before.at_m,
        before_m: pair.before.off_m.filter(|_| errors != Errors::After),
        after_m: pair.after.off_m.filter(|_| errors != Errors::Before),
    };
    TableScene {
        x_m: range(0),
        y_m: range(1),
        outlines,
        marks: unseen
            .map(|pair| TableMark {
                at_m: pair.before.at_m,
                vector_m: None,
                ink: Role::NoiseFloor.into(),
                text: "not found".to_owned(),
            })
            .collect(),
        before_after: pairs.iter().map(arrow).collect(),
        vector_scale: arrow_scale(lengths),
        ..TableScene::new()
    }
}

/// "right hand: 12.1 mm before, 1.4 mm after" of the nearest place.
fn words(pairs: &[Pair<'_>], at_m: [f64; 2]) -> String {
    let far = |pair: &&Pair<'_>| (pair.before.at_m[0] - at_m[0]).hypot(pair.before.at_m[1] - at_m[1]);
    let nearest = pairs.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
    let Some(pair) = nearest.filter(|pair| far(pair) < NEAR_M) else {
        return "no hand was held here".to_owned();
    };
    let mm = |off_m: Option<[f64; 2]>| {
        off_m.map_or("not found".to_owned(), |[x_m, y_m]| format::mm(x_m.hypot(y_m)))
    };
    format!("{} hand: before {}, after {}", pair.hand.name(), mm(pair.before.off_m), mm(pair.after.off_m))
}

fn legend(ui: &mut Ui, scene: &TableScene, errors: Errors) {
    ui.spacing_mut().item_spacing.y = 2.0;
    let times = match scene.vector_scale {
        scale if scale > 1.0 => format!("{scale} times as long as the error"),
        _ => "in true length".to_owned(),
    };
    let what = "Where the eyes see the hand − where its arm has it";
    ui.label(theme::small(ui, format!("{what}, {times}. After: with all looks learned from.")));
    ui.horizontal_wrapped(|ui| {
        if errors != Errors::After {
            entry(ui, BeforeAfter::BEFORE, "before");
        }
        if errors != Errors::Before {
            entry(ui, BeforeAfter::AFTER, "after");
        }
    });
}
