//! Tables of what moves and touches: joints, the head's views, touches, hands, grasps.

use plumbline_engine::View;
use plumbline_engine::view::{AttemptView, HandMiss, HeadViewSummary, JointView, TouchOutcome, TouchState};

use super::{Table, degrees, meters, mm, number, pixels};
use crate::operator::snapshot::trials::HEADINGS;
use crate::operator::words::grasp::{hand, method, result};

pub fn joints(view: &View) -> Table {
    let headings = [
        "joint",
        "name",
        "servo",
        "angle_deg",
        "goal_deg",
        "load_percent",
        "temperature_c",
        "voltage_v",
        "torque",
        "problem",
    ];
    Table::new(&headings, view.robot.joints.iter().map(joint))
}

fn joint(joint: &JointView) -> Vec<String> {
    let torque = joint.torque_on.map_or("", |on| if on { "on" } else { "off" });
    vec![
        joint.name.clone(),
        joint.title.clone(),
        joint.servo.to_string(),
        degrees(joint.angle_rad),
        degrees(joint.goal_rad),
        number(joint.load, 100.0, 1),
        number(joint.temperature_c, 1.0, 1),
        number(joint.voltage_v, 1.0, 1),
        torque.to_owned(),
        joint.problem.clone().unwrap_or_default(),
    ]
}

pub fn head_views(view: &View) -> Table {
    let row = |view: &HeadViewSummary| {
        let (left, right) = view.corners;
        vec![
            view.name.clone(),
            degrees(Some(view.pan_rad)),
            degrees(Some(view.tilt_rad)),
            left.to_string(),
            right.to_string(),
            pixels(view.rms_px),
        ]
    };
    let headings = ["view", "head_left_deg", "head_up_deg", "left_corners", "right_corners", "rms_px"];
    Table::new(&headings, view.mount.views.iter().map(row))
}

/// The axes of shifts and turns against what is nominal, robot axes.
const AXES: [&str; 3] = ["forward", "left", "up"];

/// Shift and turn of something, m and rad, each with one standard deviation.
type Shifted = ([f64; 3], [f64; 3], [f64; 3], [f64; 3]);

fn shifted(columns: &[(&str, Option<Shifted>)]) -> Table {
    let known: Vec<(&str, Shifted)> = columns.iter().filter_map(|(name, of)| Some((*name, (*of)?))).collect();
    let mut rows = vec![];
    for (name, (moved_m, moved_sd_m, turned_rad, turned_sd_rad)) in &known {
        for (i, axis) in AXES.iter().enumerate() {
            let row = vec![
                (*name).to_owned(),
                format!("shift {axis}, mm"),
                mm(Some(moved_m[i])),
                mm(Some(moved_sd_m[i])),
            ];
            rows.push(row);
        }
        for (i, axis) in AXES.iter().enumerate() {
            let (turn, sd) = (degrees(Some(turned_rad[i])), degrees(Some(turned_sd_rad[i])));
            rows.push(vec![(*name).to_owned(), format!("turn about {axis}, deg"), turn, sd]);
        }
    }
    Table::new(&["which", "against_nominal", "value", "one_standard_deviation"], rows)
}

pub fn mount(view: &View) -> Table {
    let of = |mount: &plumbline_engine::view::MountSummary| {
        (mount.moved_m, mount.moved_sd_m, mount.turned_rad, mount.turned_sd_rad)
    };
    let mount = &view.mount;
    shifted(&[("in use", mount.in_use.as_ref().map(of)), ("proposed", mount.proposal.as_ref().map(of))])
}

pub fn screen(view: &View) -> Table {
    let of = |placed: &std::sync::Arc<plumbline_model::touchscreen::ScreenPlacement>| {
        (placed.moved_m, placed.sd_m, placed.turned_rad, placed.sd_rad)
    };
    let touch = &view.touch;
    shifted(&[
        ("in use", touch.placement.as_ref().map(of)),
        ("proposed", touch.placement_proposal.as_ref().map(of)),
    ])
}

pub const TOUCHES: [&str; 11] = [
    "touch",
    "target_u_px",
    "target_v_px",
    "touched_u_px",
    "touched_v_px",
    "error_u_mm",
    "error_v_mm",
    "group",
    "set",
    "outcome",
    "why",
];

pub fn touches(view: &View) -> Table {
    Table::new(&TOUCHES, view.touch.touches.iter().map(touch))
}

fn touch(touch: &TouchState) -> Vec<String> {
    let touched = |of: fn(&plumbline_model::Pixel<plumbline_model::session::Screen>) -> f64| {
        number(touch.touched.as_ref().map(of), 1.0, 2)
    };
    let error = |axis: usize| mm(touch.error_m.map(|error_m| error_m[axis]));
    let (outcome, why) = outcome(&touch.outcome);
    vec![
        touch.number.to_string(),
        number(Some(touch.target.u_px), 1.0, 2),
        number(Some(touch.target.v_px), 1.0, 2),
        touched(|pixel| pixel.u_px),
        touched(|pixel| pixel.v_px),
        error(0),
        error(1),
        touch.group.clone(),
        touch.set.clone(),
        outcome.to_owned(),
        why.to_owned(),
    ]
}

fn outcome(outcome: &TouchOutcome) -> (&'static str, &str) {
    match outcome {
        TouchOutcome::Waiting => ("waiting", ""),
        TouchOutcome::Unreachable(why) => ("out of reach", why),
        TouchOutcome::UnderWay => ("under way", ""),
        TouchOutcome::Touched => ("touched", ""),
        TouchOutcome::Missed(why) => ("missed", why),
        TouchOutcome::Skipped => ("skipped", ""),
        TouchOutcome::Rejected => ("does not count", ""),
    }
}

/// Every look at a hand, before and after.
pub fn hands(view: &View) -> Table {
    let summary = view.handeye.proposal.as_ref().or(view.handeye.in_use.as_ref());
    let mut rows = vec![];
    for (hand, said) in summary.iter().flat_map(|summary| &summary.hands) {
        let Some(figures) = said.figures() else { continue };
        for (before, after) in figures.before.iter().zip(&figures.after) {
            let off = |miss: &HandMiss, axis: usize| mm(miss.off_m.map(|off_m| off_m[axis]));
            rows.push(vec![
                hand.name().to_owned(),
                meters(before.at_m[0]),
                meters(before.at_m[1]),
                off(before, 0),
                off(before, 1),
                off(after, 0),
                off(after, 1),
            ]);
        }
    }
    let headings =
        ["hand", "x_m", "y_m", "before_forward_mm", "before_left_mm", "after_forward_mm", "after_left_mm"];
    Table::new(&headings, rows)
}

pub fn attempts(view: &View) -> Table {
    let headings =
        ["attempt", "began", "method", "hand", "object", "result", "beside_mm", "palm_height_mm", "seconds"];
    Table::new(&headings, view.grasp.attempts.iter().map(attempt))
}

fn attempt(attempt: &AttemptView) -> Vec<String> {
    vec![
        attempt.name.clone(),
        attempt.began.to_string(),
        method(attempt.method),
        hand(attempt.hand),
        attempt.object.clone(),
        result(attempt).to_owned(),
        mm(attempt.alignment_m),
        mm(attempt.closed_at_m.map(|[.., z_m]| z_m)),
        number(attempt.seconds, 1.0, 1),
    ]
}

/// The methods of the experiment, as they stand on its page.
pub fn experiment(view: &View) -> Table {
    let headings: Vec<&str> = std::iter::once("method").chain(HEADINGS).collect();
    let methods = view.trials.shown.iter().flat_map(|shown| &shown.page.methods);
    let rows = methods.map(|method| {
        let mut row = vec![method.name.clone()];
        row.extend(method.cells.iter().cloned());
        row.resize(headings.len(), String::new());
        row
    });
    Table::new(&headings, rows)
}
