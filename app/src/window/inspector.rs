//! The inspector: what is known about the thing that is looked at or chosen.

use egui::{Panel, RichText, ScrollArea, Slider, Ui};
use plumbline_engine::view::{AimView, BoardPlace, SourceStatus};
use plumbline_engine::{AimChoice, Destination, EyesCommand, HeadPose, LiveCommand, RobotCommand, View};
use plumbline_model::{Eye, PairFit};
use plumbline_widgets::buttons::choice;
use plumbline_widgets::colormap::Colormap;
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::key_value::{KeyValue, big_figure, key_value_grid};
use plumbline_widgets::theme::{self, Role, group_heading, space};

use super::{PlumblineWindow, undo};
use crate::operator::words::sources;
use crate::operator::{Outbox, Screen, capture_waits_for, wanted_board};
use crate::panels::{
    PanelState, chosen_fit, probe_readout, show_commission_inspector, show_drift_inspector,
    show_gap_inspector, show_grasp_inspector, show_handeye_inspector, show_labels_inspector,
    show_models_inspector, show_objects_inspector, show_robot_inspector, show_scores_inspector,
    show_timeline_inspector, show_touch_inspector,
};

/// In a window that is not wider than this the tiles need what the inspector can spare, pt.
const NARROW: f32 = 1120.0;

/// What stands beside a slider takes so much, pt.
const BESIDE_SLIDER: f32 = 160.0;
const LEAST_SLIDER: f32 = 32.0;
const MOST_SLIDER: f32 = 100.0;

pub(super) fn show(window: &mut PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
    let margin = egui::Margin::symmetric(space::M as i8, space::S as i8);
    let frame = egui::Frame::side_top_panel(ui.style()).inner_margin(margin);
    let usual = if ui.ctx().content_rect().width() < NARROW { 232.0 } else { 248.0 };
    let panel = Panel::right("inspector").frame(frame).default_size(usual).size_range(200.0..=420.0);
    let (view, screen) = (std::sync::Arc::clone(&window.view), window.settings.screen);
    let (state, undo_rest) = (&mut window.panels, &mut window.undo_rest);
    let shown = panel.show_separator_line(false).show(ui, |ui| {
        undo::show(&view, screen, undo_rest, ui, outbox);
        // Beside the number and the name of a slider: more would make the whole inspector wider, for good.
        ui.spacing_mut().slider_width =
            (ui.available_width() - BESIDE_SLIDER).clamp(LEAST_SLIDER, MOST_SLIDER);
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| match screen {
            Screen::Commission => show_commission_inspector(ui, &view, outbox),
            Screen::Live => live(ui, &view, state, outbox),
            Screen::Collect => collecting(ui, &view, state, outbox),
            Screen::Judge => judged_pair(ui, &view, state, outbox),
            Screen::Accept => provenance(ui, &view),
            Screen::Mount => mount(ui, &view),
            Screen::Touch => show_touch_inspector(ui, &view, state, outbox),
            Screen::Models => show_models_inspector(ui, &view, state, outbox),
            Screen::Gap => show_gap_inspector(ui, &view, state, outbox),
            Screen::HandEye => show_handeye_inspector(ui, &view, outbox),
            Screen::Grasp => show_grasp_inspector(ui, &view, state, outbox),
            Screen::Scores => show_scores_inspector(ui, &view, state, outbox),
            Screen::Images => show_labels_inspector(ui, &view, state, outbox),
            Screen::Drift => show_drift_inspector(ui, &view, outbox),
            Screen::Timeline => show_timeline_inspector(ui, &view),
            Screen::Robot => show_robot_inspector(ui, &view, &mut state.robot, outbox),
        });
    });
    window.inspector_width = shown.response.rect.width();
}

fn live(ui: &mut Ui, view: &View, state: &mut PanelState, outbox: &mut Outbox) {
    group_heading(ui, "Measured point");
    probe_readout(ui, view.live.probe.as_ref());
    if state.probe.pinned.is_some() && ui.button("Let the point go").clicked() {
        state.probe.pinned = None;
    }
    look_there(ui, view, outbox);
    show_objects_inspector(ui, view, &mut state.objects, outbox);
    group_heading(ui, "Picture");
    let maps = [(Colormap::Viridis, "Viridis"), (Colormap::Spectrum, "Spectrum"), (Colormap::Gray, "Gray")];
    choice(ui, "Colors of depth", &mut state.live.colormap, &maps);
    ui.checkbox(&mut state.live.epipolar_lines, "Lines that both eyes share");
    if ui.button("Fit colors to what is seen").clicked() {
        state.live.depth_range_m = None;
    }
    if let Some(aim) = &view.live.aim {
        group_heading(ui, "Aim of the rectified pair");
        aim_controls(ui, aim, outbox);
        if view.robot.connection.is_connected() {
            let head = view.live.head;
            let rows = [
                KeyValue::text("Head left", encoder(head.head_z_rad)).unit("°").help("By the encoder"),
                KeyValue::text("Head up", encoder(head.head_y_rad)).unit("°").help("By the encoder"),
            ];
            key_value_grid(ui, "head", &rows);
        } else {
            head_controls(ui, view.live.head, outbox);
        }
    }
    source(ui, view);
}

/// The head can be turned to a measured point; the move is shown first.
fn look_there(ui: &mut Ui, view: &View, outbox: &mut Outbox) {
    let reading = view.live.probe.as_ref().and_then(|probe| probe.reading.as_ref().ok());
    let Some(reading) = reading.filter(|_| view.robot.connection.is_connected()) else { return };
    let button = ui.button("Turn the head there");
    if button.on_hover_text("Shows how the head would turn; nothing moves yet").clicked() {
        let point_m = reading.point_in_robot.coords.into();
        outbox.send(RobotCommand::Preview(Destination::LookAt { point_m }));
    }
}

/// An angle as finely as encoders read it.
fn encoder(angle_rad: f64) -> String {
    format::fixed(angle_rad.to_degrees(), 1)
}

fn mount(ui: &mut Ui, view: &View) {
    group_heading(ui, "Head");
    let robot = &view.robot;
    let angles = robot
        .rig
        .as_ref()
        .zip(robot.measured.as_ref())
        .filter(|(rig, posture)| posture.len() == rig.description.movable_count());
    match angles {
        Some((rig, posture)) => {
            // Named by the side, as the planned poses are.
            let side = |angle_rad: f64, [plus, minus]: [&str; 2]| {
                let name = if angle_rad < 0.0 { minus } else { plus };
                KeyValue::text(name, encoder(angle_rad.abs())).unit("°")
            };
            let rows = [
                side(posture[rig.eyes.pan], ["Left", "Right"]),
                side(posture[rig.eyes.tilt], ["Up", "Down"]),
            ];
            key_value_grid(ui, "head", &rows);
        }
        None => {
            ui.label(theme::weak(ui, "Its angles are known once the robot is connected."));
        }
    }
    group_heading(ui, "What this is for");
    ui.label(theme::weak(
        ui,
        "Points that the eyes measure become places in the robot's frame through the mount. One degree here is 8 mm on the table.",
    ));
}

fn aim_controls(ui: &mut Ui, aim: &AimView, outbox: &mut Outbox) {
    let by_hand =
        AimChoice::Manual { pitch_rad: aim.pitch_rad, horizontal_field_of_view_rad: aim.field_of_view_rad.0 };
    let mut manual = aim.choice != AimChoice::Table;
    if choice(ui, "Aim", &mut manual, &[(false, "At the table"), (true, "By hand")]) {
        outbox.send(LiveCommand::Aim(if manual { by_hand } else { AimChoice::Table }));
    }
    if manual {
        let (mut pitch_deg, mut width_deg) =
            (aim.pitch_rad.to_degrees(), aim.field_of_view_rad.0.to_degrees());
        let before = [pitch_deg, width_deg];
        let down = ui.add(Slider::new(&mut pitch_deg, -90.0..=90.0).suffix("°").text("down").max_decimals(1));
        let wide = ui.add(Slider::new(&mut width_deg, 20.0..=150.0).suffix("°").text("wide").max_decimals(1));
        if moved(&(down | wide), before, [pitch_deg, width_deg]) {
            outbox.send(LiveCommand::Aim(AimChoice::Manual {
                pitch_rad: pitch_deg.to_radians(),
                horizontal_field_of_view_rad: width_deg.to_radians(),
            }));
        }
    }
    let (width, height) = aim.size_px;
    key_value_grid(
        ui,
        "aim",
        &[
            KeyValue::quantity("Down", Quantity::Angle, aim.pitch_rad),
            KeyValue::quantity("Wide", Quantity::Angle, aim.field_of_view_rad.0),
            KeyValue::text("Size", format!("{width}×{height}")).unit("px"),
            KeyValue::quantity("Focal length", Quantity::Pixels, aim.focal_px)
                .help("Pixels per radian at the middle of the rectified images"),
        ],
    );
}

/// Whether the operator moved a slider. A slider also rounds what it is given, which is no wish.
fn moved(sliders: &egui::Response, before_deg: [f64; 2], after_deg: [f64; 2]) -> bool {
    let by_deg = (before_deg[0] - after_deg[0]).abs().max((before_deg[1] - after_deg[1]).abs());
    sliders.changed() && by_deg > 0.051
}

fn head_controls(ui: &mut Ui, head: HeadPose, outbox: &mut Outbox) {
    let mut left_deg = head.head_z_rad.to_degrees();
    let mut up_deg = head.head_y_rad.to_degrees();
    let before = [left_deg, up_deg];
    ui.add_space(space::XS);
    ui.label(theme::small(ui, "Head"))
        .on_hover_text("Where the head looked: it places the eyes over the table");
    let left = ui.add(Slider::new(&mut left_deg, -90.0..=90.0).suffix("°").text("left").max_decimals(1));
    let up = ui.add(Slider::new(&mut up_deg, -50.0..=25.0).suffix("°").text("up").max_decimals(1));
    if moved(&(left | up), before, [left_deg, up_deg]) {
        let head = HeadPose { head_z_rad: left_deg.to_radians(), head_y_rad: up_deg.to_radians() };
        outbox.send(LiveCommand::Head(head));
    }
}

fn source(ui: &mut Ui, view: &View) {
    if view.source.status == SourceStatus::None {
        return;
    }
    group_heading(ui, "Source");
    in_short(ui, &view.source.description, |_, short| RichText::new(short));
    let mut rows = Vec::new();
    if let Some(frame) = &view.live.raw {
        if let Some(name) = &frame.name {
            ui.add(egui::Label::new(theme::weak(ui, name)).truncate());
        }
        rows.push(
            KeyValue::text("Size", format!("{}×{}", frame.left.width(), frame.left.height())).unit("px"),
        );
    }
    let statistics = &view.live.statistics;
    rows.push(KeyValue::optional("Rate", Quantity::Rate, statistics.source.per_second));
    rows.push(
        KeyValue::optional("Right after left", Quantity::Time, statistics.time_difference_s)
            .help("Capture time of the right image minus that of the left"),
    );
    rows.push(
        KeyValue::text("Skipped", statistics.rectify.skipped.to_string())
            .help("Pairs that came faster than they could be rectified and matched"),
    );
    let latency = statistics.rectify.latency.map(|latency| latency.as_secs_f64());
    rows.push(KeyValue::optional("Delay of depth", Quantity::Time, latency));
    if let Some(disparity) = &view.live.disparity {
        rows.push(KeyValue::quantity("Depth found", Quantity::Ratio, disparity.valid_fraction));
    }
    key_value_grid(ui, "source", &rows);
}

fn collecting(ui: &mut Ui, view: &View, state: &mut PanelState, outbox: &mut Outbox) {
    let eyes = &view.eyes;
    group_heading(ui, "Next pair");
    if let Some(hint) = capture_waits_for(view) {
        ui.label(hint);
    }
    match wanted_board(view) {
        Some(ghost) => {
            ui.label(format!("Hold the board {}.", ghost.reason));
            key_value_grid(ui, "ghost", &place_rows(&ghost.place));
        }
        // Nobody holds the board: the pane Coverage says what is missing.
        None if eyes.ghost.is_some() => {}
        None if eyes.collected.is_empty() => {
            ui.label(theme::weak(ui, "The outline in both eyes will show where to hold the board."));
        }
        None => {
            ui.label(theme::weak(ui, "No place is missing any more."));
        }
    }
    let chosen = state.chosen_pair.clone();
    let Some(pair) = chosen.and_then(|name| eyes.collected.iter().find(|pair| pair.name == name)) else {
        return;
    };
    group_heading(ui, &format!("Pair {}", pair.name));
    let count = |eye: Eye| pair.corners(eye).map_or(0, |corners| corners.iter().flatten().count());
    let mut rows = vec![
        KeyValue::text("Corners left", count(Eye::Left).to_string()),
        KeyValue::text("Corners right", count(Eye::Right).to_string()),
    ];
    if let Some(place) = pair.place {
        rows.extend(place_rows(&place));
    }
    key_value_grid(ui, "pair", &rows);
    ui.add_space(space::S);
    ui.horizontal_wrapped(|ui| {
        if ui.button("Show the live picture").clicked() {
            state.chosen_pair = None;
        }
        if ui.button("Delete this pair").clicked() {
            outbox.send(EyesCommand::Delete { pair: pair.name.clone() });
        }
    });
}

/// Where a board is, in whole millimeters and degrees: a hand holds it no better.
fn place_rows(place: &BoardPlace) -> [KeyValue; 3] {
    let degrees = |angle_rad: f64| format::fixed(angle_rad.to_degrees(), 0);
    [
        KeyValue::text("Distance", format::fixed(place.distance_m * 1000.0, 0)).unit("mm"),
        KeyValue::text("Top away by", degrees(place.tilt_up_down_rad)).unit("°"),
        KeyValue::text("Left away by", degrees(place.tilt_left_right_rad)).unit("°"),
    ]
}

fn judged_pair(ui: &mut Ui, view: &View, state: &mut PanelState, outbox: &mut Outbox) {
    let Some(fit) = chosen_fit(view, state.chosen_pair.as_deref()) else {
        group_heading(ui, "Pair");
        ui.label(theme::weak(ui, "Click a bar to see a pair here."));
        return;
    };
    let worst = state.chosen_pair.as_deref() != Some(fit.name.as_str());
    group_heading(ui, &format!("Pair {}{}", fit.name, if worst { " (the worst)" } else { "" }));
    let error = fit.left_px.unwrap_or(0.0).max(fit.right_px.unwrap_or(0.0));
    big_figure(ui, "worse eye", &format::px(error), Role::Ink);
    ui.add_space(space::S);
    key_value_grid(ui, "fit", &fit_rows(fit));
    left_out(ui, fit);
    ui.add_space(space::S);
    drop_or_restore(ui, view, fit, outbox);
}

fn fit_rows(fit: &PairFit) -> [KeyValue; 5] {
    let distance_m = fit.left_from_board.translation_m().norm();
    [
        KeyValue::optional("Left eye", Quantity::Pixels, fit.left_px),
        KeyValue::optional("Right eye", Quantity::Pixels, fit.right_px),
        KeyValue::optional("Vertical error", Quantity::Pixels, fit.epipolar_px)
            .help("Distance of matched corners from each other's epipolar line"),
        KeyValue::quantity("Distance", Quantity::Depth, distance_m),
        KeyValue::text("Corners", fit.residuals.len().to_string()),
    ]
}

fn left_out(ui: &mut Ui, fit: &PairFit) {
    let mut corners = fit.residuals.iter().filter(|corner| corner.left_out).peekable();
    if corners.peek().is_none() {
        return;
    }
    ui.add_space(space::XS);
    ui.label(theme::small(ui, "Bad corners, left out of the fit"));
    for corner in corners {
        ui.label(format!(
            "corner {}, {} eye: {} off",
            corner.corner + 1,
            corner.eye,
            format::px(corner.norm_px())
        ));
    }
}

fn drop_or_restore(ui: &mut Ui, view: &View, fit: &PairFit, outbox: &mut Outbox) {
    let collected = view.eyes.collected.iter().any(|pair| pair.name == fit.name);
    if !collected {
        return;
    }
    if view.eyes.dropped.contains(&fit.name) {
        if ui.button(format!("Restore pair {}", fit.name)).clicked() {
            outbox.send(EyesCommand::RestorePair { pair: fit.name.clone() });
        }
    } else if ui.button(format!("Drop pair {}", fit.name)).clicked() {
        outbox.send(EyesCommand::DropPair { pair: fit.name.clone() });
    }
}

fn provenance(ui: &mut Ui, view: &View) {
    group_heading(ui, "How it was made");
    let eyes = &view.eyes;
    let proposed = eyes.proposal.as_ref().map(|proposal| &proposal.calibration);
    let Some(calibration) = proposed.or(eyes.in_use.as_ref().map(|in_use| &in_use.calibration)) else {
        ui.label(theme::weak(ui, "There is no calibration yet."));
        return;
    };
    let Some(evidence) = &calibration.evidence else {
        ui.label("The file says nothing about how it was made.");
        return;
    };
    let created = evidence.created.to_zoned(jiff::tz::TimeZone::system());
    let (date, time) = (created.strftime("%Y-%m-%d").to_string(), created.strftime("%H:%M").to_string());
    let minutes =
        evidence.minutes_since_on.map_or("not known".to_owned(), |minutes| format!("{minutes:.0} min"));
    key_value_grid(
        ui,
        "evidence",
        &[
            KeyValue::text("Solved on", date),
            KeyValue::text("At", time),
            KeyValue::text("Cameras on", minutes).help("For how long, when the pairs were taken"),
            KeyValue::text("Pairs offered", evidence.observations.len().to_string()),
            KeyValue::text("Pairs dropped", evidence.dropped_pairs.len().to_string()),
        ],
    );
    for text in [evidence.board.to_string(), evidence.source.clone(), evidence.software.clone()] {
        if !text.is_empty() {
            in_short(ui, &text, |ui, short| theme::weak(ui, short));
        }
    }
}

/// Pairs by the names of their folders; the whole paths where it is pointed at.
fn in_short(ui: &mut Ui, text: &str, drawn: impl FnOnce(&Ui, &str) -> RichText) {
    let short = sources::in_short(text);
    let label = ui.label(drawn(ui, &short));
    if short != text {
        label.on_hover_text(text);
    }
}
