//! The 9 by 4 evaluation: what is to be laid, and two figures side by side.

use egui::{Button, ComboBox, ScrollArea, Ui};
use plumbline_engine::view::{GridCorrection, GridDoing, GridFigure, GridRunView};
use plumbline_engine::{DriftCommand, GridCommand, GridSide};
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, space};

use super::grid_map;
use crate::operator::{GridAction, USUAL_THING};
use crate::panels::parts::{action_button, warning};
use crate::panels::{PanelContext, padded};

/// Figures stand side by side from this width on, points.
const SIDE_BY_SIDE: f32 = 440.0;
/// The longest arrow is drawn no longer than this on the table, m.
const LONGEST_M: f64 = 0.09;
/// Errors are blown up no further, times.
const MOST_TIMES: f64 = 10.0;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let grid = cx.view.drift.clone();
    let grid = &grid.grid;
    if grid.under_way().is_some() {
        cx.outbox.wanted.detections = true;
    }
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            match grid.under_way() {
                Some(run) => under_way(ui, cx, run),
                None => begin(ui, cx),
            }
            ui.add_space(space::S);
            figures(ui, cx);
        });
    });
}

fn begin(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let by_itself = cx.view.twin.running;
    let text = if by_itself {
        "A thing is laid at 36 known places, 9 by 4, and found by both eyes five times at each. The twin lays it by \
         itself, and puts its other toys away. The arm does not move."
    } else {
        "You lay a thing at 36 known places, 9 by 4; both eyes find it five times at each. The arm does not move."
    };
    ui.label(theme::weak(ui, text));
    let chosen = cx.state.grid_object.clone().unwrap_or_else(|| USUAL_THING.to_owned());
    ui.horizontal_wrapped(|ui| {
        let why = GridAction::Begin.refusal(cx.view);
        let button = ui.add_enabled(why.is_none(), Button::new("Begin 36 places"));
        if button.on_disabled_hover_text(why.unwrap_or_default()).clicked() {
            cx.outbox.send(DriftCommand::Grid(GridCommand::Begin { object: chosen.clone() }));
        }
        for class in cx.view.grasp.classes.iter() {
            if ui.selectable_label(chosen == *class, *class).clicked() {
                cx.state.grid_object = Some((*class).to_owned());
            }
        }
    });
    if let Some(run) = &cx.view.drift.grid.run {
        not_on_disk(ui, run);
        let text = format!("The last one saw the {} at {} of {} places.", run.object, run.measured, run.of);
        ui.label(theme::small(ui, text));
    }
}

fn under_way(ui: &mut Ui, cx: &mut PanelContext<'_>, run: &GridRunView) {
    let [x_mm, y_mm] = run.at_m.map(|m| format::fixed(1e3 * m, 0));
    let place = format!("Place {} of {}: x {x_mm}, y {y_mm} mm", run.place, run.of);
    ui.label(theme::strong(ui, place));
    let thing = run.object;
    match run.doing {
        GridDoing::Asks => {
            ui.label(format!(
                "Lay the middle of the {thing} {x_mm} mm in front of the torso and {}, then press Placed.",
                sideways(run.at_m[1])
            ));
        }
        GridDoing::Lays => {
            ui.label(format!("The {thing} comes to rest."));
        }
        GridDoing::Looks { looks, of } => {
            ui.label(format!("Looks at the {thing}: {looks} of {of}."));
        }
        GridDoing::NotSeen => warning(
            ui,
            &format!(
                "the eyes do not find the {thing} there: lay it again and press Placed, or leave the place out"
            ),
        ),
        GridDoing::NoDetector => {
            warning(
                ui,
                "nothing is being detected: choose a detector at the right of the screen Live, then it goes on",
            );
        }
        GridDoing::Ended => {}
    }
    not_on_disk(ui, run);
    ui.horizontal_wrapped(|ui| {
        if !run.places_by_itself {
            action_button(ui, cx, GridAction::Placed, "Placed");
        }
        action_button(ui, cx, GridAction::LeaveOut, "Leave out");
        action_button(ui, cx, GridAction::End, "End");
    });
}

fn not_on_disk(ui: &mut Ui, run: &GridRunView) {
    if let Some(why) = &run.unkept {
        let text = format!("What was measured is not on disk yet, and is tried again by itself: {why}");
        warning(ui, &text);
    }
}

fn sideways(y_m: f64) -> String {
    let mm = format::fixed(1e3 * y_m.abs(), 0);
    match y_m {
        y if y > 1e-6 => format!("{mm} mm to the robot's left"),
        y if y < -1e-6 => format!("{mm} mm to the robot's right"),
        _ => "straight ahead".to_owned(),
    }
}

fn figures(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let grid = &cx.view.drift.clone().grid;
    if grid.sessions.is_empty() {
        ui.label(theme::weak(ui, "No evaluation yet. One that was made elsewhere can be opened."));
        action_button(ui, cx, GridAction::Open, "Open folder…");
        return;
    }
    let times = times(grid.figures.iter().flatten());
    let beside = ui.available_width() >= SIDE_BY_SIDE;
    if beside {
        ui.columns(2, |columns| {
            for (side, ui) in GridSide::BOTH.into_iter().zip(columns) {
                figure(ui, cx, side, times);
            }
        });
    } else {
        for side in GridSide::BOTH {
            figure(ui, cx, side, times);
            ui.add_space(space::S);
        }
    }
    let scale = if times > 1.0 {
        format!("{times:.0} times as long as the error")
    } else {
        "in true length".to_owned()
    };
    let text = format!(
        "Rings: targets. Dots: where they come out, arrows {scale}, the same in both. Numbers: too high (+) or too low, mm."
    );
    ui.label(theme::small(ui, text));
    action_button(ui, cx, GridAction::Open, "Open folder…");
}

/// One scale for both.
fn times<'a>(figures: impl Iterator<Item = &'a GridFigure>) -> f64 {
    let judged = figures.filter_map(|figure| figure.judged.as_ref()?.as_ref().ok());
    let worst_m = judged.map(|judged| judged.errors.worst_m).fold(0.0, f64::max);
    (LONGEST_M / worst_m.max(1e-6)).clamp(1.0, MOST_TIMES).floor()
}

fn figure(ui: &mut Ui, cx: &mut PanelContext<'_>, side: GridSide, times: f64) {
    let grid = &cx.view.drift.clone().grid;
    let shown = grid.figures[side as usize].clone();
    let name = if side == GridSide::Left { "Left figure" } else { "Right figure" };
    chosen(ui, cx, side, shown.as_ref(), name);
    let Some(shown) = shown else {
        ui.label(theme::weak(ui, "Choose a session."));
        return;
    };
    match &shown.judged {
        None => {
            ui.horizontal(|ui| {
                ui.spinner();
                ui.label("Is being judged.");
            });
        }
        Some(Err(why)) => warning(ui, &why.to_string()),
        Some(Ok(judged)) => {
            let errors = &judged.errors;
            let [mean, median, worst] = [errors.mean_m, errors.median_m, errors.worst_m].map(format::mm);
            ui.label(theme::strong(ui, format!("Mean {mean}")));
            ui.label(format!("median {median}, worst {worst}"));
            let not_seen = match judged.not_seen {
                0 => String::new(),
                n => format!(", {n} not seen"),
            };
            let places = format::count(judged.places.len(), "place");
            ui.label(theme::small(ui, format!("{places}{not_seen}")));
            grid_map::show(ui, name, judged, times);
        }
    }
}

/// Which session, and with which correction.
fn chosen(ui: &mut Ui, cx: &mut PanelContext<'_>, side: GridSide, shown: Option<&GridFigure>, name: &str) {
    let grid = &cx.view.drift.clone().grid;
    let correction = shown.map_or(GridCorrection::Described, |shown| shown.correction);
    let title = shown.map_or("No session", |shown| shown.title.as_str());
    let mut ask = None;
    let width = ui.available_width();
    let combo = ComboBox::from_id_salt((name, "session")).selected_text(title).width(width).truncate();
    combo.show_ui(ui, |ui| {
        for (folder, title) in grid.sessions.iter() {
            let is_shown = shown.is_some_and(|shown| shown.session == *folder);
            if ui.selectable_label(is_shown, title).clicked() {
                ask = Some((folder.clone(), correction));
            }
        }
    });
    let combo = ComboBox::from_id_salt((name, "correction")).selected_text(correction.title()).width(width);
    combo.show_ui(ui, |ui| {
        for other in GridCorrection::ALL {
            if ui.selectable_label(other == correction, other.title()).clicked()
                && let Some(shown) = shown
            {
                ask = Some((shown.session.clone(), other));
            }
        }
    });
    if let Some((session, correction)) = ask {
        cx.outbox.send(DriftCommand::Grid(GridCommand::Show { side, session, correction }));
    }
}
