//! A move in words.

use plumbline_engine::view::{Preview, RobotView};
use plumbline_widgets::format;

/// "Move there: right elbow to 92°, 1.4 s": what moves, and how long it takes.
pub fn moved_name(preview: &Preview) -> String {
    format!("Move there: {}, {}", preview.title, seconds(preview.duration.as_secs_f64()))
}

/// What the move would do and how near it comes to something.
pub fn move_sentence(preview: &Preview) -> String {
    let turns = preview.largest_turn.as_ref().map_or_else(String::new, |(joint, by_rad)| {
        format!(" {joint} turns most, by {}.", whole_degrees(*by_rad))
    });
    match &preview.path {
        Ok(check) => format!(
            "Shown as a ghost: {}.{turns} It keeps {} between {}.",
            preview.title,
            format::mm(check.smallest_m),
            check.between
        ),
        Err(why) => format!("{} cannot be done: {why}", preview.title),
    }
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
