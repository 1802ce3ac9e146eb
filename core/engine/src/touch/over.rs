//! Whether a hand is on the screen or near it, so that the screen could not be moved, nor anything be put on it.

use plumbline_model::robot::{Arm, Posture, Rig};
use plumbline_model::session::Touchscreen;
use plumbline_model::{Point, Robot};

use crate::robot::view::RobotView;

/// How far a hand keeps away.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    /// So high above the glass a hand meets nothing, m.
    above_m: f64,
    /// Nor does it so far beside, m.
    beside_m: f64,
}

/// For what stands on the screen, and for a person who reaches there: as high as a toy, as wide as a hand.
pub(super) const TO_REACH: Room = Room { above_m: 0.12, beside_m: 0.10 };
/// For the glass itself: a finger is a little longer than drawn, and a screen is not put down to the millimeter.
const OF_THE_GLASS: Room = Room { above_m: 0.03, beside_m: 0.02 };

/// An arm with a hand where this screen is, or nearly so; `None`: none has, as far as it is known.
pub(super) fn arm_in<'a>(rig: &'a Rig, screen: &Touchscreen, robot: &RobotView) -> Option<&'a Arm> {
    arm_within(rig, screen, robot, OF_THE_GLASS)
}

/// An arm with a hand on this screen or near it, in reach of it; `None`: none has, or it is not known.
pub(super) fn arm_near<'a>(rig: &'a Rig, screen: &Touchscreen, robot: &RobotView) -> Option<&'a Arm> {
    arm_within(rig, screen, robot, TO_REACH)
}

fn arm_within<'a>(rig: &'a Rig, screen: &Touchscreen, robot: &RobotView, room: Room) -> Option<&'a Arm> {
    let is_within = |arm: &&Arm| {
        let posture = robot.known(&arm.joints);
        posture.is_some_and(|posture| !is_away(rig, arm, screen, posture, room))
    };
    rig.arms.iter().find(is_within)
}

/// Whether every tip of an arm is beside the screen, or above it.
pub(super) fn is_away(rig: &Rig, arm: &Arm, screen: &Touchscreen, posture: &Posture, room: Room) -> bool {
    let links = rig.description.forward(posture);
    arm.tips.iter().all(|tip| {
        let Ok(link) = rig.description.find_link(&tip.link) else { return false };
        let at = links.of(link).isometry.translation.vector;
        is_clear(screen, Point::new(at.x, at.y, at.z), room)
    })
}

fn is_clear(screen: &Touchscreen, at: Point<Robot>, room: Room) -> bool {
    let pixel = screen.pixel_at(at);
    let [pitch_u_m, pitch_v_m] = screen.pitch_m();
    let is_over = |at_m: f64, size_m: f64| at_m > -room.beside_m && at_m < size_m + room.beside_m;
    let is_over =
        is_over(pixel.u_px * pitch_u_m, screen.width_m) && is_over(pixel.v_px * pitch_v_m, screen.height_m);
    // A place that is no number is nowhere, and not beside.
    let is_known = at.coords.iter().all(|c| c.is_finite());
    is_known && (!is_over || screen.height_above_m(at) > room.above_m)
}
