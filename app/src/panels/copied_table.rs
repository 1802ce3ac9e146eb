//! What stands in the tables of the tiles, as CSV for the clipboard: one row per thing, numbers as they
//! are known, units in the headings. What is not known is left empty.

use plumbline_engine::View;
use plumbline_engine::view::{
    AttemptView, CollectedPair, HeadViewSummary, JointView, TouchOutcome, TouchState,
};
use plumbline_model::Eye;

use crate::operator::Pane;
use crate::operator::words::grasp::{hand, method, result};

/// The table of a tile; `None`: it has none, or it is empty.
pub fn csv_of(pane: Pane, view: &View) -> Option<String> {
    match pane {
        Pane::Joints => table(&JOINTS, view.robot.joints.iter().map(joint)),
        Pane::Pairs => {
            let eyes = &view.eyes;
            let taken = eyes.collected.iter().map(|pair| collected(pair, eyes.dropped.contains(&pair.name)));
            let not_taken = eyes.not_collected.iter().map(|(name, why)| {
                let empty = std::iter::repeat_n(String::new(), 5);
                [name.clone()].into_iter().chain(empty).chain([format!("not taken: {why}")]).collect()
            });
            table(&PAIRS, taken.chain(not_taken))
        }
        Pane::HeadViews => table(&HEAD_VIEWS, view.mount.views.iter().map(head_view)),
        Pane::TouchRun => table(&TOUCHES, view.touch.touches.iter().map(touch)),
        Pane::GraspAttempts => table(&ATTEMPTS, view.grasp.attempts.iter().map(attempt)),
        _ => None,
    }
}

/// Whether a tile has a table with something in it.
pub fn has_table(pane: Pane, view: &View) -> bool {
    match pane {
        Pane::Joints => !view.robot.joints.is_empty(),
        Pane::Pairs => !(view.eyes.collected.is_empty() && view.eyes.not_collected.is_empty()),
        Pane::HeadViews => !view.mount.views.is_empty(),
        Pane::TouchRun => !view.touch.touches.is_empty(),
        Pane::GraspAttempts => !view.grasp.attempts.is_empty(),
        _ => false,
    }
}

fn table(headings: &[&str], rows: impl Iterator<Item = Vec<String>>) -> Option<String> {
    let mut rows = rows.peekable();
    rows.peek()?;
    let mut writer = csv::Writer::from_writer(Vec::new());
    let written =
        writer.write_record(headings).and_then(|()| rows.try_for_each(|row| writer.write_record(row)));
    if let Err(error) = written {
        log::error!("a table could not be written as CSV: {error}");
        return None;
    }
    String::from_utf8(writer.into_inner().ok()?).ok()
}

fn number(value: Option<f64>, factor: f64, digits: usize) -> String {
    value.map_or_else(String::new, |value| format!("{:.digits$}", factor * value))
}

fn degrees(value_rad: Option<f64>) -> String {
    number(value_rad.map(f64::to_degrees), 1.0, 3)
}

fn mm(value_m: Option<f64>) -> String {
    number(value_m, 1e3, 3)
}

const JOINTS: [&str; 10] = [
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

const PAIRS: [&str; 7] = [
    "pair",
    "left_corners",
    "right_corners",
    "distance_m",
    "tilt_up_down_deg",
    "tilt_left_right_deg",
    "remark",
];

fn collected(pair: &CollectedPair, is_dropped: bool) -> Vec<String> {
    let corners = |eye: Eye| {
        let seen = pair.corners(eye).map(|corners| corners.iter().flatten().count());
        seen.map_or_else(String::new, |count| count.to_string())
    };
    let remark = if is_dropped { "left out of the next solution" } else { "" };
    vec![
        pair.name.clone(),
        corners(Eye::Left),
        corners(Eye::Right),
        number(pair.place.map(|place| place.distance_m), 1.0, 3),
        degrees(pair.place.map(|place| place.tilt_up_down_rad)),
        degrees(pair.place.map(|place| place.tilt_left_right_rad)),
        remark.to_owned(),
    ]
}

const HEAD_VIEWS: [&str; 5] = ["view", "head_left_deg", "head_up_deg", "left_corners", "right_corners"];

fn head_view(view: &HeadViewSummary) -> Vec<String> {
    let (left, right) = view.corners;
    vec![
        view.name.clone(),
        degrees(Some(view.pan_rad)),
        degrees(Some(view.tilt_rad)),
        left.to_string(),
        right.to_string(),
    ]
}

const TOUCHES: [&str; 11] = [
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

const ATTEMPTS: [&str; 9] =
    ["attempt", "began", "method", "hand", "object", "result", "beside_mm", "palm_height_mm", "seconds"];

fn attempt(attempt: &AttemptView) -> Vec<String> {
    vec![
        attempt.name.clone(),
        attempt.began.to_string(),
        method(attempt.method),
        hand(attempt.hand),
        attempt.object.clone(),
        result(attempt).to_owned(),
        mm(attempt.alignment_m),
        mm(attempt.closed_at_m),
        number(attempt.seconds, 1.0, 1),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_has_a_field_per_heading_and_what_is_not_known_is_empty() {
        let mut view = View::default();
        assert_eq!((csv_of(Pane::Joints, &view), has_table(Pane::Joints, &view)), (None, false));
        let touch = TouchState {
            number: 7,
            target: plumbline_model::Pixel::new(960.0, 700.0),
            target_place: plumbline_model::Point::new(0.4, 0.0, 0.05),
            sent: plumbline_model::Point::new(0.4, 0.0, 0.05),
            inside: true,
            set: "a, \"b\"".to_owned(),
            group: "g".to_owned(),
            side: plumbline_model::touch_plan::Side::Above,
            outcome: TouchOutcome::Missed("nothing, felt".to_owned()),
            error_m: None,
            touched: None,
        };
        let touched = TouchState {
            outcome: TouchOutcome::Touched,
            error_m: Some([0.00123, -0.004]),
            touched: Some(plumbline_model::Pixel::new(963.0, 690.25)),
            ..touch.clone()
        };
        let touches =
            plumbline_engine::view::TouchView { touches: [touch, touched].into(), ..Default::default() };
        view.touch = touches.into();
        assert!(has_table(Pane::TouchRun, &view));
        let text = csv_of(Pane::TouchRun, &view).expect("two rows");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], TOUCHES.join(","));
        assert_eq!(lines[1], "7,960.00,700.00,,,,,g,\"a, \"\"b\"\"\",missed,\"nothing, felt\"");
        assert_eq!(lines[2], "7,960.00,700.00,963.00,690.25,1.230,-4.000,g,\"a, \"\"b\"\"\",touched,");
        assert_eq!(lines.len(), 3);
    }
}
