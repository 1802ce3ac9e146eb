//! Pages with what moves the robot: joints, jog pad.

use std::time::Duration;

use egui::Ui;

use super::{GalleryState, sample};
use crate::jog_pad::{JogPad, JogSpeed};
use crate::joint_row::{Freshness, JointHistory, JointRow, JointState, ReducedRange, joint_header};
use crate::theme::{self, space};

pub(super) const JOINTS: usize = 10;

struct Sample {
    name: &'static str,
    id: &'static str,
    limits_deg: [f64; 2],
    present_deg: f64,
    goal_deg: f64,
    load: f64,
    temperature_c: f64,
}

const fn joint(
    name: &'static str,
    id: &'static str,
    limits_deg: [f64; 2],
    angles_deg: [f64; 2],
    load: f64,
    temperature_c: f64,
) -> Sample {
    let [present_deg, goal_deg] = angles_deg;
    Sample { name, id, limits_deg, present_deg, goal_deg, load, temperature_c }
}

const SAMPLES: [Sample; JOINTS] = [
    joint("head turn", "head_z", [-90.0, 90.0], [-12.4, -12.0], 0.04, 36.0),
    joint("head nod", "head_y", [-50.0, 25.0], [-29.6, -30.0], -0.12, 38.0),
    joint("right shoulder turn", "r_shoulder_z", [-25.0, 80.0], [18.2, 42.0], 0.21, 44.0),
    joint("right shoulder lift", "r_shoulder_y", [-90.0, 180.0], [55.1, 55.0], -0.46, 57.0),
    joint("right arm out", "r_arm_x", [0.0, 70.0], [41.0, 41.3], 0.30, 47.0),
    joint("right elbow", "r_elbow_y", [50.0, 180.0], [104.4, 128.0], -0.86, 71.0),
    joint("right wrist turn", "r_wrist_z", [-90.0, 90.0], [0.3, 0.0], 0.02, 34.0),
    joint("right wrist bend", "r_wrist_x", [-45.0, 45.0], [-47.3, -44.0], 0.11, 35.0),
    joint("right thumb", "r_thumb_x", [-147.0, 0.0], [-60.0, -60.0], 0.0, 33.0),
    joint("right index finger", "r_indexfinger_x", [-147.0, 0.0], [-20.0, -20.0], 0.0, 33.0),
];

pub(super) fn joints(ui: &mut Ui, state: &mut GalleryState) {
    ui.set_max_width(820.0);
    theme::heading(ui, "Joints");
    ui.add_space(space::S);
    ui.spacing_mut().item_spacing.y = 2.0;
    joint_header(ui);
    for (index, sample) in SAMPLES.iter().enumerate() {
        row(ui, state, index, sample, false);
    }
    ui.add_space(space::M);
    ui.label(theme::small(ui, format!("last: {}", state.last)));
    ui.add_space(space::M);
    ui.label(theme::small(ui, "The same in a narrow panel, the last one open"));
    ui.push_id("narrow", |ui| {
        ui.set_max_width(470.0);
        joint_header(ui);
        for (index, sample) in SAMPLES.iter().enumerate().skip(2).take(4) {
            row(ui, state, index, sample, index == 5);
        }
    });
}

fn row(ui: &mut Ui, state: &mut GalleryState, index: usize, sample: &Sample, open: bool) {
    let limits_rad = sample.limits_deg.map(f64::to_radians);
    let now = JointState {
        present_rad: Some(sample.present_deg.to_radians()),
        goal_rad: Some(sample.goal_deg.to_radians()),
        proposed_rad: state.proposed_rad[index],
        load: Some(sample.load),
        temperature_c: Some(sample.temperature_c),
        torque_on: Some(index != 6),
    };
    let history = history(index, &now);
    let reduced = ReducedRange {
        range_rad: [-35f64.to_radians(), 8f64.to_radians()],
        reason: "the head is turned by −12.4°",
    };
    let freshness = match index {
        4 => Freshness::Stale(Some(Duration::from_millis(2_400))),
        8 => Freshness::NoAnswer { from: "servo 43", since: Some(Duration::from_secs(3)) },
        _ => Freshness::Live,
    };
    let shown = JointRow::new(sample.name, sample.id, limits_rad, now)
        .reduced((index == 1).then_some(reduced))
        .freshness(freshness)
        .history(&history)
        .expanded(open || state.open_joint == Some(index))
        .show(ui);
    if let Some(angle_rad) = shown.proposed_rad {
        state.proposed_rad[index] = Some(angle_rad);
        state.last = format!("{} to {}", sample.name, crate::format::degrees(angle_rad));
    }
    if let Some(reason) = shown.refused {
        state.last = format!("refused: {reason}");
    }
    if let Some(on) = shown.torque {
        state.last = format!("{} torque {}", sample.name, if on { "on" } else { "off" });
    }
    if shown.expand_toggled {
        state.open_joint = if state.open_joint == Some(index) { None } else { Some(index) };
    }
}

fn history(index: usize, now: &JointState) -> JointHistory {
    let mut history = JointHistory::new(60.0);
    for i in 0..300 {
        let t = f64::from(i) / 300.0;
        let wave = (9.0 * t + index as f64).sin();
        let mut past = *now;
        past.load = now.load.map(|load| load * (0.6 + 0.4 * wave) + 0.03 * sample::noise(i as usize));
        past.temperature_c = now.temperature_c.map(|c| c - 9.0 * (1.0 - t) * (1.0 - t));
        if (140..160).contains(&i) {
            (past.load, past.temperature_c) = (None, None);
        }
        history.push(60.0 * t, &past);
    }
    history.push(60.0, now);
    history
}

pub(super) fn jog(ui: &mut Ui, state: &mut GalleryState) {
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = space::L;
        ui.vertical(|ui| {
            ui.set_width(400.0);
            theme::heading(ui, "Jog");
            let shown = JogPad::new("right hand").show(ui, &mut state.speed);
            state.jog = shown.intent;
            ui.add_space(space::L);
            let why_not = "The left arm is free. Switch its torque on first.";
            ui.push_id("free", |ui| {
                JogPad::new("left hand").why_not(Some(why_not)).show(ui, &mut JogSpeed::default());
            });
        });
    });
}
