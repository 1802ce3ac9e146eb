//! Whether something is held: the fingers say, and the eyes.

use super::{Chosen, End, Running};
use crate::record::{Failure, Outcome, Step};

/// Fingers that are kept open by more than this hold something, rad.
const HELD_RAD: f64 = 0.10;
/// A thing that is seen this near to where it stood, and no higher than this over it, was left, m.
const LEFT_M: f64 = 0.06;

impl Running<'_> {
    pub(super) fn check(&mut self, chosen: &Chosen) -> Result<Outcome, End> {
        self.body.wait(super::STILL_S)?;
        self.keep(Step::Check)?;
        let open_rad = self.fingers_open_rad()?;
        self.record.fingers_open_rad = Some(open_rad);
        let sight = self.body.look()?;
        let grasper = &mut *self.grasper;
        let seen = grasper.looker.look(&sight, &grasper.knowledge)?;
        self.watch.saw(Step::Check, &sight, &seen);
        let object = &self.order.object;
        let left = seen.iter().filter(|thing| thing.class.eq_ignore_ascii_case(object)).any(|thing| {
            thing.place.as_ref().is_ok_and(|place| {
                let off = place.point().coords - chosen.point.coords;
                off.xy().norm() < LEFT_M && off.z.abs() < 0.5 * LEFT_M
            })
        });
        self.record.seen_after = seen;
        let object = object.to_lowercase();
        Ok(match (open_rad > HELD_RAD, left) {
            (true, false) => Outcome::Success,
            (false, true) => Outcome::Failed {
                failure: Failure::ReachWrong,
                why: format!("the hand closed beside the {object}, which is where it was"),
            },
            (false, false) => Outcome::Failed {
                failure: Failure::Slipped,
                why: format!("the hand is empty and the {object} is not where it was"),
            },
            (true, true) => Outcome::Failed {
                failure: Failure::Slipped,
                why: format!("something keeps the fingers open, but the {object} is where it was"),
            },
        })
    }

    /// How far the fingers (without the thumb) are kept from where they were sent, the mean, rad.
    fn fingers_open_rad(&mut self) -> Result<f64, End> {
        let commanded = self.body.commanded()?;
        let planner = self.grasper.planner(self.order.method);
        let fingers = planner.fingers();
        let servos = self.body.servos()?;
        let open: Vec<f64> = servos
            .iter()
            .filter(|servo| fingers.contains(&servo.joint))
            .map(|servo| (servo.angle_rad - commanded[servo.joint]).abs())
            .collect();
        Ok(open.iter().sum::<f64>() / open.len().max(1) as f64)
    }
}
