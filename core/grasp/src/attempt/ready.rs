//! Gates before anything moves.

use plumbline_model::robot::{JointIndex, Posture, Rig};

use super::{End, Running};
use crate::body::ServoState;

/// A joint of an arm that hangs farther from where it was sent is held by something, rad: what gives way under the
/// arm's own weight and what rubs is less than half of it. One that hangs as far behind as the bus lets a move run ahead
/// (`gate.step_rad`, 0.1 rad) could not be moved on anyway.
pub const HANGS_RAD: f64 = 0.09;
/// Fingers press on what they met, and stay behind, rad.
pub const FINGER_HANGS_RAD: f64 = 0.25;
/// Angles are compared with those of so long before, s…
const LOOK_S: f64 = 0.15;
/// …in which a joint that stands does not turn farther than this, rad: ten ticks of its encoder, 0.1 rad/s.
const STANDS_RAD: f64 = 0.015;
/// An arm that turns is waited for as long as so many looks take: 3 s.
const LOOKS: usize = 20;

impl Running<'_> {
    /// Waits for joints to come to rest; those that turn even then.
    pub(super) fn turning(&mut self) -> Result<Vec<JointIndex>, End> {
        let mut before = self.body.servos()?;
        let mut turning = vec![];
        for _ in 0..LOOKS {
            self.body.wait(LOOK_S)?;
            let now = self.body.servos()?;
            turning = turned(&before, &now);
            if turning.is_empty() {
                break;
            }
            before = now;
        }
        Ok(turning)
    }

    /// Refuses when the arm is not fit to move: what turns by itself, is hot, overloaded or not where it was
    /// sent is named, and what to do.
    pub(super) fn ready(&mut self, turning: &[JointIndex]) -> Result<(), End> {
        let rig = self.body.rig().clone();
        let commanded = self.body.commanded()?;
        let servos = self.body.servos()?;
        let arm = self.grasper.planner(self.order.method).arm();
        let of_arm = [arm.joints(), arm.hand()];
        let mut all = servos.iter().filter(|servo| of_arm.iter().any(|part| part.contains(&servo.joint)));
        let why = all.find_map(|servo| {
            let hangs_rad = if arm.hand().contains(&servo.joint) { FINGER_HANGS_RAD } else { HANGS_RAD };
            unfit(&rig, servo, &commanded, hangs_rad, turning)
        });
        why.map_or(Ok(()), |why| Err(End::Refused(why)))
    }
}

/// Joints that stand elsewhere than before.
fn turned(before: &[ServoState], now: &[ServoState]) -> Vec<JointIndex> {
    let pairs = before.iter().zip(now);
    let off = pairs.filter(|(before, now)| (now.angle_rad - before.angle_rad).abs() > STANDS_RAD);
    off.map(|(_, now)| now.joint).collect()
}

/// Why a servo is not fit to move, if so.
fn unfit(
    rig: &Rig,
    servo: &ServoState,
    commanded: &Posture,
    hangs_rad: f64,
    turning: &[JointIndex],
) -> Option<String> {
    let title = rig.servo_of(servo.joint).map_or("A joint", |known| known.title.as_str());
    if let Some(hot_c) = servo.temperature_c.filter(|celsius| *celsius >= rig.gate.hot_c) {
        let warm_c = rig.gate.warm_c;
        return Some(format!("{title} has {hot_c:.0} °C: let it cool down to {warm_c:.0} °C"));
    }
    if servo.load.is_some_and(|load| load.abs() >= rig.gate.load) {
        return Some(format!(
            "{title} pushes against something: move the arm by hand to where nothing is in its way"
        ));
    }
    if turning.contains(&servo.joint) {
        return Some(format!("{title} still turns: let the arm come to rest, then try again"));
    }
    let off_rad = (servo.angle_rad - commanded[servo.joint]).abs();
    (off_rad > hangs_rad).then(|| {
        format!(
            "{title} is {:.0}° from where it was sent: look what holds it there, then choose Home",
            off_rad.to_degrees()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The right elbow of an arm at home, so far (rad) from there.
    fn elbow(rig: &Rig, off_rad: f64) -> ServoState {
        let joint = rig.description.find_joint("r_elbow_y").expect("an elbow");
        let angle_rad = rig.home()[joint] + off_rad;
        ServoState { joint, angle_rad, load: Some(0.1), current_a: None, temperature_c: Some(31.0) }
    }

    fn why(rig: &Rig, servo: &ServoState, turning: &[JointIndex]) -> Option<String> {
        unfit(rig, servo, &rig.home(), HANGS_RAD, turning)
    }

    #[test]
    fn an_arm_that_droops_is_fit_and_one_that_something_holds_is_not() {
        let rig = Rig::built_in("nico").expect("valid");
        // Some degrees of droop, and play of a few more.
        for off_rad in [0.0, 0.06, -0.08] {
            assert_eq!(why(&rig, &elbow(&rig, off_rad), &[]), None, "{off_rad} rad");
        }
        for off_rad in [0.18, -0.18] {
            let why = why(&rig, &elbow(&rig, off_rad), &[]).expect("unfit");
            assert!(why.contains("Right elbow is 10° from where it was sent"), "{why}");
        }
    }

    #[test]
    fn a_joint_that_turns_is_found_by_two_looks_and_named_wherever_it_is() {
        let rig = Rig::built_in("nico").expect("valid");
        let stood = [elbow(&rig, 0.05)];
        // What rubs and an encoder that flickers between ticks do not turn.
        assert!(turned(&stood, &[elbow(&rig, 0.056)]).is_empty());
        // Slowly, and by now where it was sent.
        let passing = elbow(&rig, 0.0);
        let turning = turned(&stood, &[passing]);
        assert_eq!(turning, [passing.joint]);
        let why = why(&rig, &passing, &turning).expect("unfit");
        assert!(why.contains("Right elbow still turns"), "{why}");
    }

    #[test]
    fn what_is_hot_or_pushes_is_said_before_where_it_stands() {
        let rig = Rig::built_in("nico").expect("valid");
        let hot = ServoState { temperature_c: Some(75.0), ..elbow(&rig, 0.3) };
        assert!(why(&rig, &hot, &[]).is_some_and(|why| why.contains("75 °C: let it cool down to 55 °C")));
        let pushes = ServoState { load: Some(-0.9), ..elbow(&rig, 0.3) };
        assert!(why(&rig, &pushes, &[]).is_some_and(|why| why.contains("pushes against something")));
    }
}
