//! Moves that would open a hand which holds something.

use std::borrow::Cow;

use plumbline_engine::View;
use plumbline_model::robot::{Arm, JointIndex, Posture};

type Refusal = Option<Cow<'static, str>>;

/// Fingers that open by more than this let go of what they hold, rad; by less they may have closed on since.
const LETS_GO_RAD: f64 = 0.25;

/// Why a move is not made that would open a hand that holds something, or may.
pub(crate) fn would_drop(view: &View, end: &Posture) -> Refusal {
    let (rig, measured) = (view.robot.rig.as_ref()?, view.robot.measured.as_ref()?);
    let held = view.grasp.held.as_ref();
    let hand = held.map(|held| held.hand).or(view.grasp.may_hold)?;
    let holding = |arm: &&Arm| hand.name() == arm.name;
    let lets_go = |arm: &&Arm| {
        let opens_rad = |joint: &JointIndex| measured[*joint].abs() - end[*joint].abs();
        arm.hand.iter().any(|joint| opens_rad(joint) > LETS_GO_RAD)
    };
    let same = end.len() == measured.len();
    let arm = rig.arms.iter().filter(|_| same).filter(holding).find(lets_go)?;
    let what = match held {
        Some(held) => format!("holds the {}", held.object.to_lowercase()),
        None => "may hold something".to_owned(),
    };
    Some(
        format!(
            "it would open the {} hand, which {what}: put that down first, or use Arm home, on the screen Grasp",
            arm.name
        )
        .into(),
    )
}

#[cfg(test)]
mod tests {
    use std::sync::Arc as Shared;

    use plumbline_engine::view::{GraspHand, GraspView, InHand, RobotView};
    use plumbline_model::robot::Rig;

    use super::*;

    #[test]
    fn a_hand_that_holds_is_not_opened_by_a_pose() {
        let rig = Shared::new(Rig::built_in("nico").expect("comes with the program"));
        let [right, left] = ["right", "left"].map(|name| rig.arm(name).expect("of this robot"));
        let (shoulder, finger) = (right.joints[0], right.hand[2]);
        let closed = rig.home().with(&right.hand, &vec![-1.0; right.hand.len()]);
        let over = |held: bool, may_hold: Option<GraspHand>| {
            let held = held.then(|| InHand { object: "Tomato".to_owned(), hand: GraspHand::Right });
            let grasp = GraspView { held, may_hold, ..GraspView::default() };
            let robot =
                RobotView { rig: Some(rig.clone()), measured: Some(closed.clone()), ..RobotView::default() };
            View { grasp: Shared::new(grasp), robot: Shared::new(robot), ..View::default() }
        };
        let opened = closed.with(&[finger], &[0.0]);
        let why = would_drop(&over(true, None), &opened).expect("refused");
        assert!(why.contains("would open the right hand, which holds the tomato"), "{why}");
        let why = would_drop(&over(false, Some(GraspHand::Right)), &opened).expect("refused");
        assert!(why.contains("may hold something"), "{why}");
        // The fingers as they are, the other hand, or an empty one.
        assert!(would_drop(&over(true, None), &closed.with(&[shoulder], &[0.5])).is_none());
        assert!(would_drop(&over(true, None), &closed.with(&[left.hand[2]], &[-1.0])).is_none());
        assert!(would_drop(&over(false, Some(GraspHand::Left)), &opened).is_none(), "the other one");
        assert!(would_drop(&over(false, None), &opened).is_none());
    }
}
