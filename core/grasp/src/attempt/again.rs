//! Again, when the hand came up without the object.

use plumbline_model::robot::Posture;

use super::{AIR_RAD_S, End, Running};
use crate::record::{Earlier, Failure, Outcome, Step};

/// Before the arm moves again, who watches has this long to read what will move, and to stop it, s.
const SAID_S: f64 = 2.0;

impl Running<'_> {
    /// Opens the hand, goes back to where the arm was at first, so that the eyes see the table as they did
    /// then, and grasps what is seen there once more. Where that cannot be, the last try counts.
    pub(super) fn once_more(
        &mut self,
        from: &Posture,
        number: usize,
        failure: Failure,
        why: String,
    ) -> Result<Outcome, End> {
        let planner = self.grasper.planner(self.order.method);
        let here = self.body.commanded()?;
        let (opened, start) = (planner.open(&here), planner.open(from));
        let Ok(back) = planner.free_way(&opened, &start) else {
            return Ok(Outcome::Failed { failure, why });
        };
        self.watch.again(number, self.order.method.tries(), &why);
        self.begin(Step::Again);
        self.body.wait(SAID_S)?;
        self.follow(Step::Again, std::slice::from_ref(&opened), AIR_RAD_S)?;
        self.follow(Step::Again, &back, AIR_RAD_S)?;
        self.near_m = self.record.standing_m.or(self.near_m);
        let first = Outcome::Failed { failure, why: why.clone() };
        self.record.earlier.push(Earlier {
            hand: self.record.hand,
            outcome: first,
            seconds: self.record.seconds.take(),
            iterations: std::mem::take(&mut self.record.iterations),
            fingers_open_rad: self.record.fingers_open_rad.take(),
        });
        self.record.seen_after.clear();
        match self.try_once() {
            Err(End::Failed(Failure::Halted, halted)) => Err(End::Failed(Failure::Halted, halted)),
            Err(End::Failed(_, second) | End::Refused(second)) => {
                Err(End::Failed(failure, format!("{why}; it was tried again: {second}")))
            }
            Ok(outcome) => Ok(outcome),
        }
    }
}
