//! Targets and touches, on the screen or on the table.

use egui::{Sense, Ui, vec2};
use plumbline_engine::view::{TouchOutcome, TouchPhase, TouchState, TouchView};
use plumbline_model::session::Touchscreen;
use plumbline_model::touch_plan::TouchArea;
use plumbline_widgets::buttons::choice;
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::table_map::{Outline, Place, TableMap, TableMark, TableScene};
use plumbline_widgets::theme::{self, Role, space};
use plumbline_widgets::touch_pattern::{PatternArea, TouchMark, TouchMarkState, TouchPattern, error_scale};

use super::parts::{error_length_m, next_touch};
use super::{draft, words};
use crate::operator::{is_under_way, screen_of};
use crate::panels::{PanelContext, padded};

/// The longest error is drawn this long, as a share of the screen's width.
const LONGEST_SHARE: f64 = 0.1;
/// A click on the table chooses a touch within this distance, m.
const NEAR_M: f64 = 0.012;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    draft::keep_up(ui, cx);
    let Some(screen) = screen_of(cx.view).cloned() else {
        let message = Message::new("No touchscreen is known", "Connect the twin or a robot first.");
        EmptyState::empty(message).show(ui);
        return;
    };
    padded(ui, |ui| {
        ui.horizontal(|ui| {
            choice(ui, "Map of", &mut cx.state.touch.on_table, &[(false, "Screen"), (true, "Table")]);
            ui.add_space(space::S);
            legend(ui, &cx.view.touch);
        });
        ui.add_space(space::XS);
        if cx.state.touch.on_table {
            table(ui, cx, &screen);
        } else {
            glass(ui, cx, &screen);
        }
    });
}

/// Only what is on the map.
fn legend(ui: &mut Ui, touch: &TouchView) {
    let counts = &touch.counts;
    let to_come = touch.touches.iter().filter(|one| one.outcome == TouchOutcome::Waiting).count();
    let to_come_name = if touch.phase == TouchPhase::Finished { "never made" } else { "to come" };
    let all = [
        (to_come, to_come_name, Role::Predicted),
        (counts.touched, "touched", Role::Measured),
        (counts.missed, "no contact", Role::Warning),
        (counts.skipped + counts.rejected, "left out", Role::NoiseFloor),
        (counts.unreachable, "out of reach", Role::NoiseFloor),
    ];
    ui.spacing_mut().item_spacing.x = space::XS;
    if touch.touches.is_empty() {
        ui.label(theme::small(ui, "Nothing is planned."));
    }
    for (count, name, role) in all.into_iter().filter(|(count, ..)| *count > 0) {
        let text = format!("{count} {name}");
        let width = ui.painter().layout_no_wrap(text.clone(), small(ui), egui::Color32::WHITE).size().x;
        // What has no room is in the hover of the map.
        if ui.available_width() < width + 16.0 {
            return;
        }
        let (dot, _) = ui.allocate_exact_size(vec2(8.0, 8.0), Sense::hover());
        ui.painter().circle_filled(dot.center(), 3.5, role.color(theme::tokens(ui)));
        ui.label(theme::small(ui, text));
        ui.add_space(space::XS);
    }
}

fn small(ui: &Ui) -> egui::FontId {
    egui::TextStyle::Small.resolve(ui.style())
}

fn glass(ui: &mut Ui, cx: &mut PanelContext<'_>, screen: &Touchscreen) {
    let touch = &cx.view.touch;
    let pitch_m = screen.pitch_m();
    let next = next_touch(touch);
    let marks: Vec<TouchMark> = touch.touches.iter().map(|one| mark(one, next, pitch_m)).collect();
    let longest_px = LONGEST_SHARE * f64::from(screen.width_px);
    let lengths = marks.iter().filter_map(|mark| mark.error_px).map(|[u, v]| u.hypot(v));
    let scale = error_scale(lengths, longest_px);
    let locked = is_under_way(&touch.phase) || touch.phase == TouchPhase::Planning;
    let area = cx.state.touch.draft.options().map(|options| pattern_area(&options.area));
    let size_px = [screen.width_px, screen.height_px];
    let shown = TouchPattern::new("Touches on the screen", size_px, pitch_m[0] / pitch_m[1], &marks)
        .area(area)
        .editable(area.is_some() && !locked)
        .selected(cx.state.touch.chosen)
        .error_scale(scale)
        .pixel_width_m(pitch_m[0])
        .show(ui);
    if let Some(number) = shown.clicked {
        choose(cx, number);
    }
    if let Some(PatternArea { u_px, v_px }) = shown.area {
        cx.state.touch.draft.change_area(TouchArea { u_px, v_px });
    }
}

fn choose(cx: &mut PanelContext<'_>, number: usize) {
    let chosen = &mut cx.state.touch.chosen;
    *chosen = (*chosen != Some(number)).then_some(number);
}

fn pattern_area(area: &TouchArea) -> PatternArea {
    PatternArea { u_px: area.u_px, v_px: area.v_px }
}

fn mark(touch: &TouchState, next: Option<usize>, pitch_m: [f64; 2]) -> TouchMark {
    let state = match touch.outcome {
        _ if next == Some(touch.number) => TouchMarkState::Next,
        TouchOutcome::Waiting | TouchOutcome::UnderWay => TouchMarkState::Planned,
        TouchOutcome::Unreachable(_) => TouchMarkState::Unreachable,
        TouchOutcome::Touched => TouchMarkState::Touched,
        TouchOutcome::Missed(_) => TouchMarkState::Missed,
        TouchOutcome::Skipped => TouchMarkState::Skipped,
        TouchOutcome::Rejected => TouchMarkState::Rejected,
    };
    TouchMark {
        number: touch.number,
        target_px: [touch.target.u_px, touch.target.v_px],
        error_px: touch.error_m.map(|[u, v]| [u / pitch_m[0], v / pitch_m[1]]),
        state,
        about: words::outcome(touch),
    }
}

fn table(ui: &mut Ui, cx: &mut PanelContext<'_>, screen: &Touchscreen) {
    let touch = &cx.view.touch;
    let lengths = touch.touches.iter().filter_map(error_length_m);
    let scale = error_scale(lengths, LONGEST_SHARE * screen.width_m);
    let scene = scene(touch, screen, cx.state.touch.chosen, scale);
    let room = ui.available_height();
    let shown = TableMap::new("Touches on the table", &scene).height(room.max(80.0)).show(ui);
    let near = |at: [f64; 2]| {
        let distance = |one: &TouchState| {
            let place = one.target_place.coords;
            (place.x - at[0]).hypot(place.y - at[1])
        };
        let nearest = touch.touches.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        (distance(nearest) <= NEAR_M).then_some(nearest.number)
    };
    if let Some(number) = shown.clicked_m.and_then(near) {
        choose(cx, number);
    }
}

fn scene(touch: &TouchView, screen: &Touchscreen, chosen: Option<usize>, scale: f64) -> TableScene {
    let outline = |place, name: &str, corners: [plumbline_model::Point<plumbline_model::Robot>; 4]| Outline {
        place,
        name: name.to_owned(),
        corners_m: corners.iter().map(|corner| [corner.coords.x, corner.coords.y]).collect(),
    };
    let mut scene = TableScene { vector_scale: scale, ..TableScene::new() };
    scene.outlines.push(outline(Place::Touchscreen, "touchscreen", screen.corners()));
    if let Some(plan) = &touch.plan {
        let corners = plan.options.area.corners().map(|pixel| screen.point_at(pixel));
        scene.outlines.push(outline(Place::Training, "", corners));
    }
    let next = next_touch(touch);
    for one in touch.touches.iter() {
        let at = one.target_place.coords;
        let vector = one.error_m.map(|[u, v]| screen.u_axis.vector() * u + screen.v_axis.vector() * v);
        let is_chosen = chosen == Some(one.number) || next == Some(one.number);
        let text = if is_chosen { one.number.to_string() } else { String::new() };
        let role = if is_chosen { Role::Ink } else { role(one) };
        let vector_m = vector.map(|vector| [vector.x, vector.y]);
        scene.marks.push(TableMark { at_m: [at.x, at.y], vector_m, ink: role.into(), text });
    }
    scene
}

fn role(touch: &TouchState) -> Role {
    match touch.outcome {
        TouchOutcome::Waiting | TouchOutcome::UnderWay => Role::Predicted,
        TouchOutcome::Touched => Role::Difference,
        TouchOutcome::Missed(_) => Role::Warning,
        TouchOutcome::Unreachable(_) | TouchOutcome::Skipped | TouchOutcome::Rejected => Role::NoiseFloor,
    }
}
