//! A way that ended merely because this computer was too busy to hear a joint in time: the arm holds until all of its
//! joints have been heard for a while, and goes on from where it stands.
//!
//! Only where nothing else has happened: what does not answer, has lost its torque, is hot or blocked ends it.

use std::time::{Duration, Instant};

use plumbline_hardware::joints::{HoldReason, JointState, MoveOutcome, Refusal, Unheard};
use plumbline_model::robot::JointIndex;

use super::GivenUp;

/// They have to be heard for so long before it goes on.
const HEARD_FOR: Duration = Duration::from_secs(1);
/// For so long they are waited for.
const WAITS_FOR: Duration = Duration::from_secs(20);
/// An angle older than this was not heard.
const FRESH: Duration = Duration::from_millis(250);
/// So often an order goes on after it has waited.
const MOST: usize = 3;

/// Whether a way waits for joints that were late.
#[derive(Default)]
pub(super) struct Late {
    times: usize,
    waits: Option<Waits>,
    /// Who watches has not been told yet that it waits.
    news: Option<String>,
}

struct Waits {
    /// What ends it when they are not heard again.
    why: GivenUp,
    since: Instant,
    heard_since: Option<Instant>,
}

impl Late {
    /// What ended a move is waited out where that may be done; else it ends the order.
    pub fn begin(&mut self, why: GivenUp, is_late: bool, now: Instant) -> Result<(), GivenUp> {
        if !is_late || self.times >= MOST {
            return Err(why);
        }
        self.times += 1;
        self.news = Some(format!("The arm waits and goes on by itself: {why}."));
        self.waits = Some(Waits { why, since: now, heard_since: None });
        Ok(())
    }

    /// Whether it still waits for these joints.
    pub fn waits(
        &mut self,
        state: &JointState,
        joints: &[JointIndex],
        now: Instant,
    ) -> Result<bool, GivenUp> {
        let Some(waits) = &mut self.waits else { return Ok(false) };
        if now.saturating_duration_since(waits.since) > WAITS_FOR {
            return Err(waits.why.clone());
        }
        if !are_heard(state, joints) {
            waits.heard_since = None;
            return Ok(true);
        }
        let heard_since = *waits.heard_since.get_or_insert(now);
        let goes_on = now.saturating_duration_since(heard_since) >= HEARD_FOR;
        if goes_on {
            self.waits = None;
        }
        Ok(!goes_on)
    }

    /// The operator holds it: the time in which they are to be heard does not run.
    pub fn paused(&mut self, now: Instant) {
        if let Some(waits) = &mut self.waits {
            (waits.since, waits.heard_since) = (now, None);
        }
    }

    /// What is to be said of it, once.
    pub fn take_news(&mut self) -> Option<String> {
        self.news.take()
    }
}

/// Whether all joints are known, and those that move were read just now and hold.
fn are_heard(state: &JointState, joints: &[JointIndex]) -> bool {
    let is_heard = |joint: &JointIndex| {
        state.of(*joint).is_some_and(|reading| {
            reading.torque_on == Some(true) && reading.age.is_some_and(|age| age < FRESH)
        })
    };
    state.unknown.is_empty() && joints.iter().all(is_heard)
}

/// Whether a move was ended by nothing but a computer that was too busy.
pub(super) fn ended_late(outcome: &MoveOutcome) -> bool {
    match outcome {
        MoveOutcome::Refused(refusal) | MoveOutcome::Held(HoldReason::Refused(refusal)) => {
            refused_late(refusal)
        }
        MoveOutcome::Held(HoldReason::Slow { .. }) => true,
        MoveOutcome::Held(_) | MoveOutcome::Arrived { .. } | MoveOutcome::Replaced => false,
    }
}

/// The same of a move that did not begin.
pub(super) fn refused_late(refusal: &Refusal) -> bool {
    matches!(
        refusal,
        Refusal::Unknown { why: Unheard::TooBusy, .. }
            | Refusal::UnknownInChain { why: Unheard::TooBusy, .. }
    )
}

#[cfg(test)]
mod tests {
    use plumbline_hardware::joints::JointReading;
    use plumbline_model::Stamp;

    use super::*;

    const ELBOW: JointIndex = JointIndex(3);

    fn why() -> GivenUp {
        GivenUp::Lost("the elbow was not heard".to_owned())
    }

    fn state(age_ms: u64, torque_on: bool, unknown: &[JointIndex]) -> JointState {
        let reading = JointReading {
            angle_rad: Some(0.1),
            torque_on: Some(torque_on),
            age: Some(Duration::from_millis(age_ms)),
            ..JointReading::new(ELBOW, 5)
        };
        let stamp = Stamp { seq: 1, captured_at: Instant::now() };
        JointState { unknown: unknown.into(), ..JointState::new(stamp, [reading]) }
    }

    #[test]
    fn it_goes_on_once_all_were_heard_for_a_while_and_is_told_once() {
        let (mut late, began) = (Late::default(), Instant::now());
        let at = |milliseconds| began + Duration::from_millis(milliseconds);
        assert_eq!(late.waits(&state(10, true, &[]), &[ELBOW], began), Ok(false), "nothing has happened");
        late.begin(why(), true, began).expect("it is waited for");
        let said = late.take_news().expect("it is told");
        assert!(said.contains("goes on by itself: the elbow was not heard."), "{said}");
        assert_eq!(late.take_news(), None);
        for (milliseconds, state, waits) in [
            (100, state(900, true, &[]), true),
            (500, state(10, true, &[]), true),
            // Not known once more: it begins anew.
            (1200, state(10, true, &[ELBOW]), true),
            (1300, state(10, true, &[]), true),
            (2200, state(10, true, &[]), true),
            (2300, state(10, true, &[]), false),
            (2400, state(900, true, &[]), false),
        ] {
            assert_eq!(late.waits(&state, &[ELBOW], at(milliseconds)), Ok(waits), "{milliseconds} ms");
        }
    }

    #[test]
    fn what_is_not_heard_again_or_too_often_ends_it_with_the_first_reason() {
        let (mut late, began) = (Late::default(), Instant::now());
        late.begin(why(), true, began).expect("it is waited for");
        // A joint that has gone limp meanwhile is not moved.
        let limp = state(10, false, &[]);
        assert_eq!(late.waits(&limp, &[ELBOW], began + WAITS_FOR), Ok(true));
        // Held by the operator it waits as long as he does.
        let began = began + WAITS_FOR;
        late.paused(began);
        let later = began + WAITS_FOR + Duration::from_millis(1);
        assert_eq!(late.waits(&limp, &[ELBOW], later - Duration::from_secs(1)), Ok(true));
        assert_eq!(late.waits(&limp, &[ELBOW], later), Err(why()));
        for _ in 1..MOST {
            late.begin(why(), true, later).expect("it is waited for");
        }
        assert_eq!(late.begin(why(), true, later), Err(why()));
        assert_eq!(Late::default().begin(why(), false, later), Err(why()), "it was something else");
    }

    #[test]
    fn only_a_busy_computer_is_waited_out() {
        let unknown = |why| Refusal::Unknown { joint: ELBOW, name: "Elbow".to_owned(), why };
        assert!(ended_late(&MoveOutcome::Held(HoldReason::Refused(unknown(Unheard::TooBusy)))));
        assert!(ended_late(&MoveOutcome::Refused(unknown(Unheard::TooBusy))));
        let (age, since) = (Duration::from_millis(300), Duration::from_secs(1));
        let slow = HoldReason::Slow { joint: ELBOW, name: "Elbow".to_owned(), age, since };
        assert!(ended_late(&MoveOutcome::Held(slow)));
        let silent = HoldReason::NoAnswer { joint: ELBOW, name: "Elbow".to_owned(), servo: 5, cycles: 25 };
        for reason in [silent, HoldReason::Stop, HoldReason::Refused(unknown(Unheard::Silent))] {
            assert!(!ended_late(&MoveOutcome::Held(reason.clone())), "{reason}");
        }
        assert!(!ended_late(&MoveOutcome::Replaced));
    }
}
