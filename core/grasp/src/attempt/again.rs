//! Again, when the hand came up without the object.

use plumbline_model::robot::Posture;

use super::{AIR_RAD_S, End, Running};
use crate::record::{Earlier, Failure, Outcome, Step};
use crate::see::Seen;

/// Before the arm moves again, who watches has this long to read what will move, and to stop it, s.
const SAID_S: f64 = 2.0;
/// What a hand closed over and did not hold it takes so much lower the next time, m: things are smaller and arms
/// higher than they are taken to be, and a hand that does the same again fails again.
const LOWER_M: f64 = 0.004;

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
        if let Err(held) = self.hold_before(Step::Again) {
            // The try is over and has failed, whatever ends the hold after it.
            return Err(not_again(failure, &why, held));
        }
        let stood = self.record.standing_m.or(self.near_m);
        self.near_m = looked_for_near(&self.record.seen, &self.order.object, stood);
        if failure == Failure::ReachWrong {
            self.lower_m += LOWER_M;
        }
        // Before anything moves: whatever ends it then, the record says how the try before ended.
        let first = Outcome::Failed { failure, why: why.clone() };
        self.record.earlier.push(Earlier {
            hand: self.record.hand,
            outcome: first,
            seconds: self.record.seconds.take(),
            iterations: std::mem::take(&mut self.record.iterations),
            fingers_open_rad: self.record.fingers_open_rad.take(),
        });
        self.record.seen_after.clear();
        self.record.seen_after_at_s = None;
        self.start(Step::Again);
        self.body.wait(SAID_S)?;
        self.follow(Step::Again, std::slice::from_ref(&opened), AIR_RAD_S)?;
        self.follow(Step::Again, &back, AIR_RAD_S)?;
        match self.try_once() {
            // Of whether it can be grasped these say nothing.
            Err(End::Failed(ended @ (Failure::Halted | Failure::EyesLost), why)) => {
                Err(End::Failed(ended, why))
            }
            Err(End::Failed(_, second) | End::Refused(second)) => {
                Err(End::Failed(failure, format!("{why}; it was tried again: {second}")))
            }
            Ok(outcome) => Ok(outcome),
        }
    }
}

/// A try that failed, and after which it was not tried again.
fn not_again(failure: Failure, why: &str, end: End) -> End {
    let (End::Failed(_, ended) | End::Refused(ended)) = end;
    End::Failed(failure, format!("{why}; it was not tried again: {ended}"))
}

/// Near which place the object is looked for again: near where it stood, so that another one of its class is not
/// taken for it. The only one of its class may have rolled away: it is looked for wherever it is.
fn looked_for_near(seen: &[Seen], object: &str, stood_m: Option<[f64; 2]>) -> Option<[f64; 2]> {
    let of_class = seen.iter().filter(|thing| thing.class.eq_ignore_ascii_case(object)).count();
    stood_m.filter(|_| of_class != 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_only_one_of_its_class_is_followed_and_one_of_several_is_not_taken_for_another() {
        let thing = |class: &str| Seen {
            class: class.to_owned(),
            confidence: 0.9,
            boxes_px: [None; 2],
            place: Err("hidden".to_owned()),
        };
        let stood = Some([0.3, 0.2]);
        let alone = [thing("Tomato"), thing("Duck")];
        assert_eq!(looked_for_near(&alone, "tomato", stood), None);
        let two = [thing("Tomato"), thing("Duck"), thing("Tomato")];
        assert_eq!(looked_for_near(&two, "tomato", stood), stood);
        // What was not seen any more at the last look is looked for where it was.
        assert_eq!(looked_for_near(&two[1..2], "tomato", stood), stood);
    }
}
