//! Whether something is held: the fingers say, and the eyes.

use plumbline_model::detection::PixelBox;

use super::{Chosen, End, Running};
use crate::record::{Failure, Outcome, Step};

/// A finger that is kept open by more than this holds something, rad…
const HELD_RAD: f64 = 0.10;
/// …and one that presses with this share of its torque when it is kept open by this, rad: what is small
/// lets fingers close nearly all the way.
const PRESSES: f64 = 0.2;
const PRESSING_RAD: f64 = 0.015;
/// A thing that is seen this near to where it stood, and no higher than this over it, was left, m.
const LEFT_M: f64 = 0.10;
/// What is not held well has fallen after this time, s.
const FALLEN_S: f64 = 1.5;
/// Boxes that overlap by more than this (intersection over union) are of the same thing at the same place.
const SAME_IOU: f32 = 0.3;

impl Running<'_> {
    pub(super) fn check(&mut self, chosen: &Chosen) -> Result<Outcome, End> {
        self.body.wait(FALLEN_S)?;
        self.keep(Step::Check)?;
        let holds = self.fingers_hold()?;
        let sight = self.body.look()?;
        let grasper = &mut *self.grasper;
        let seen = grasper.looker.look(&sight, &grasper.knowledge)?;
        self.watch.saw(Step::Check, &sight, &seen);
        let object = &self.order.object;
        let before = self.record.chosen.and_then(|index| Some(self.record.seen.get(index)?.boxes_px));
        let left = seen.iter().filter(|thing| thing.class.eq_ignore_ascii_case(object)).any(|thing| {
            let near = thing.place.as_ref().is_ok_and(|place| {
                let off = place.point().coords - chosen.point.coords;
                off.xy().norm() < LEFT_M && off.z.abs() < 0.3 * LEFT_M
            });
            near || before.is_some_and(|before| overlaps(&before, &thing.boxes_px))
        });
        self.record.seen_after = seen;
        let object = object.to_lowercase();
        Ok(match (holds, left) {
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

    /// Whether a finger (the thumb is none) is kept from closing around nothing. A body may let them press
    /// less than it was asked, so it is not what was commanded last that counts. How far they are kept
    /// open, the mean, goes into the record.
    fn fingers_hold(&mut self) -> Result<bool, End> {
        let planner = self.grasper.planner(self.order.method);
        let closed = planner.closed(&self.body.commanded()?);
        let fingers = planner.fingers();
        let servos = self.body.servos()?;
        let open: Vec<(f64, Option<f64>)> = servos
            .iter()
            .filter(|servo| fingers.contains(&servo.joint))
            .map(|servo| ((servo.angle_rad - closed[servo.joint]).abs(), servo.load))
            .collect();
        let sum_rad: f64 = open.iter().map(|(open_rad, _)| open_rad).sum();
        self.record.fingers_open_rad = Some(sum_rad / open.len().max(1) as f64);
        let presses = |load: Option<f64>| load.is_some_and(|load| load.abs() > PRESSES);
        let holds = |(open_rad, load): &(f64, Option<f64>)| {
            *open_rad > HELD_RAD || (*open_rad > PRESSING_RAD && presses(*load))
        };
        Ok(open.iter().any(holds))
    }
}

/// Whether a box of one eye is about where it was: what was lifted is seen higher by more than its size.
fn overlaps(before: &[Option<[f32; 4]>; 2], now: &[Option<[f32; 4]>; 2]) -> bool {
    before.iter().zip(now).filter_map(|(before, now)| Some(((*before)?, (*now)?))).any(|(before, now)| {
        let area = |[x0, y0, x1, y1]: [f32; 4]| PixelBox { x0_px: x0, y0_px: y0, x1_px: x1, y1_px: y1 };
        area(before).iou(&area(now)) > SAME_IOU
    })
}
