//! A move in words.

use plumbline_engine::view::{MotionState, Preview, RobotView};
use plumbline_model::robot::{JointIndex, Rig};
use plumbline_widgets::format;

/// So begins every reason that is nothing but the operator's own STOP.
pub const BY_STOP: &str = "STOP was pressed";

/// "Move there: right elbow to 92°, 1.4 s": what moves, and how long it takes.
pub fn moved_name(preview: &Preview) -> String {
    format!("Move there: {}, {}", preview.title, seconds(preview.duration.as_secs_f64()))
}

/// An arm that errs by centimeters may touch what it passes so close, m.
const CLOSE_M: f64 = 5e-3;

/// Whether the move cannot be done, or passes close by something.
pub fn is_close(preview: &Preview) -> bool {
    preview.path.as_ref().map_or(true, |check| check.smallest_m < CLOSE_M)
}

/// What the move would do and how near it comes to something.
pub fn move_sentence(preview: &Preview) -> String {
    let turns = preview.largest_turn.as_ref().map_or_else(String::new, |(joint, by_rad)| {
        format!(" {}, by {}.", turns_most(joint), whole_degrees(*by_rad))
    });
    match &preview.path {
        Ok(check) => {
            let only = if is_close(preview) { "only " } else { "" };
            let free = format::mm(check.smallest_m);
            format!(
                "Shown as a ghost: {}.{turns} It keeps {only}{free} between {}.",
                preview.title, check.between
            )
        }
        Err(why) => format!("{} cannot be done: {why}", preview.title),
    }
}

/// "Right elbow turns most", "Right other fingers turn most".
pub fn turns_most(joint: &str) -> String {
    let turn = if joint.ends_with("fingers") { "turn" } else { "turns" };
    format!("{joint} {turn} most")
}

/// "1.4 s".
pub fn seconds(time_s: f64) -> String {
    format!("{} s", format::fixed(time_s, 1))
}

/// Degrees as a slider shows them.
pub fn whole_degrees(angle_rad: f64) -> String {
    format!("{}°", format::fixed(angle_rad.to_degrees().abs(), 0))
}

/// The title of the chosen tip, for people.
pub fn tip_title(robot: &RobotView) -> String {
    let arms = robot.rig.iter().flat_map(|rig| &rig.arms);
    let tip = arms.flat_map(|arm| &arm.tips).find(|tip| tip.link == robot.tip);
    tip.map_or_else(|| robot.tip.clone(), |tip| tip.title.clone())
}

/// Head, then each arm with its hand, as people look at a robot: names and joints.
pub fn groups(rig: &Rig) -> Vec<(String, Vec<JointIndex>)> {
    let mut groups = vec![("Head".to_owned(), vec![rig.eyes.pan, rig.eyes.tilt])];
    for arm in &rig.arms {
        groups.push((arm.title.clone(), arm.joints.clone()));
        groups.push((format!("{}, hand", arm.title), arm.hand.clone()));
    }
    groups
}

/// So many that do not answer are named one by one; more have a cause in common.
const FEW: usize = 3;

/// Which servos do not answer and what to look at, said once for all of them; `None`: all answer.
pub fn silent(robot: &RobotView) -> Option<String> {
    let missing = &robot.bus.missing;
    if missing.is_empty() || missing.len() > FEW {
        return silent_together(robot);
    }
    let ids = missing.iter().map(u8::to_string).collect::<Vec<_>>().join(", ");
    let (servos, their) = if missing.len() == 1 { ("servo", "its") } else { ("servos", "their") };
    Some(format!("No answer from {servos} {ids}: look at {their} cable and supply."))
}

/// The same where many are silent at once, as when one plug has come out: everything behind it is.
pub fn silent_together(robot: &RobotView) -> Option<String> {
    let missing = &robot.bus.missing;
    if missing.len() <= FEW {
        return None;
    }
    let count = format::count(missing.len(), "servo");
    let is_silent = |index: &JointIndex| {
        let servo = robot.joints.iter().find(|joint| joint.joint == *index).map(|joint| joint.servo);
        servo.is_some_and(|id| missing.contains(&id))
    };
    let groups = robot.rig.as_ref().map(|rig| groups(rig)).unwrap_or_default();
    let of_groups = groups.iter().filter(|(_, joints)| joints.iter().any(is_silent));
    let (whole, part): (Vec<_>, Vec<_>) = of_groups.partition(|(_, joints)| joints.iter().all(is_silent));
    let names = |groups: &[&(String, Vec<JointIndex>)]| {
        groups.iter().map(|(name, _)| name.to_lowercase()).collect::<Vec<_>>().join("; ")
    };
    let who = match (whole.is_empty(), part.is_empty()) {
        (true, true) => count,
        (false, true) => format!("{count} (all of: {})", names(&whole)),
        (true, false) => format!("{count} (some of: {})", names(&part)),
        (false, false) => format!("{count} (all of: {}; some of: {})", names(&whole), names(&part)),
    };
    Some(format!(
        "No answer from {who}: one plug that is out silences all behind it. Look at the plug of the first of them, and at \
         their supply."
    ))
}

/// Whether no joint holds, so that all of them sink.
pub fn is_limp(robot: &RobotView) -> bool {
    robot.connection.is_connected() && robot.motion == MotionState::Limp
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_engine::view::{BusView, JointView};
    use plumbline_model::robot::default_rig;

    use super::*;

    fn robot(missing: impl Fn(&Rig) -> Vec<JointIndex>) -> RobotView {
        let rig = default_rig();
        let joints: Vec<JointView> =
            rig.servos.iter().map(|servo| JointView::unheard(servo, rig.limits(servo.joint))).collect();
        let gone = missing(&rig);
        let ids = joints.iter().filter(|joint| gone.contains(&joint.joint)).map(|joint| joint.servo);
        let bus = BusView { missing: ids.collect(), ..BusView::default() };
        RobotView { joints: Arc::from(joints), rig: Some(rig), bus, ..RobotView::default() }
    }

    #[test]
    fn one_plug_is_said_once() {
        assert_eq!(silent(&robot(|_| vec![])), None);
        let one = robot(|rig| vec![rig.eyes.pan]);
        assert!(silent(&one).expect("it is silent").starts_with("No answer from servo "));
        assert_eq!(silent_together(&one), None);
        let arm = robot(|rig| rig.arms[0].joints.iter().chain(&rig.arms[0].hand).copied().collect());
        let title = default_rig().arms[0].title.to_lowercase();
        let said = silent(&arm).expect("they are silent");
        assert!(said.contains(&format!("all of: {title}; {title}, hand")), "{said}");
        assert!(said.contains("one plug") && !said.contains("some of"), "{said}");
        let part = robot(|rig| rig.arms[0].joints[1..5].to_vec());
        let said = silent(&part).expect("they are silent");
        assert!(said.contains(&format!("4 servos (some of: {title})")), "{said}");
    }
}
