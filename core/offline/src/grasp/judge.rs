//! Judges attempts: the only part that reads what is really so.

use nalgebra::Vector3;
use plumbline_engine::trials::Judged;
use plumbline_grasp::{Failure, Hand, Record};
use plumbline_model::robot::Rig;
use plumbline_twin::{Lockstep, Toy};

/// A thing that is this much higher than before is lifted, m.
const LIFTED_M: f64 = 0.04;
/// A place that was seen farther off than this was wrong, m.
const PLACE_WRONG_M: f64 = 0.015;
/// A hand that was seen farther off than this was wrong, m.
const HAND_WRONG_M: f64 = 0.015;

/// Where palms are, m.
type Palms = Vec<(Hand, Vector3<f64>)>;

/// Watches one attempt from outside.
#[derive(Debug)]
pub(super) struct Judge {
    toy: Toy,
    /// Where it stood at first, and when it was looked for last.
    began_m: Vector3<f64>,
    object_m: Vector3<f64>,
    palms: Vec<(Hand, usize)>,
    /// Palms when the hand was looked at last, and before it closed.
    aligned_m: Palms,
    closing_m: Palms,
}

impl Judge {
    pub fn new(twin: &mut Lockstep, toy: Toy, rig: &Rig) -> Self {
        let palm = |hand: Hand| Some((hand, rig.description.find_link(hand.palm()).ok()?.0));
        let palms = Hand::BOTH.into_iter().filter_map(palm).collect();
        let began_m = place(twin, toy);
        Self { toy, began_m, object_m: began_m, palms, aligned_m: vec![], closing_m: vec![] }
    }

    fn palms_m(&self, twin: &mut Lockstep) -> Palms {
        let places = twin.truth_for_judging().robot_from_link;
        let at =
            |(hand, link): &(Hand, usize)| Some((*hand, places.get(*link)?.as_ref()?.translation.vector));
        self.palms.iter().filter_map(at).collect()
    }

    /// The object was looked for just now.
    pub fn looked(&mut self, twin: &mut Lockstep) {
        self.object_m = place(twin, self.toy);
    }

    /// The hand was looked at just now.
    pub fn aligned(&mut self, twin: &mut Lockstep) {
        self.aligned_m = self.palms_m(twin);
    }

    /// The hand is about to close.
    pub fn closing(&mut self, twin: &mut Lockstep) {
        self.closing_m = self.palms_m(twin);
    }

    /// As it is now.
    pub fn judge(&self, twin: &mut Lockstep, record: &Record) -> Judged {
        let after = place(twin, self.toy);
        let of_hand = |palms: &Palms| palms.iter().find(|(hand, _)| *hand == record.hand).map(|(_, at)| *at);
        let (aligned_m, closing_m) = (of_hand(&self.aligned_m), of_hand(&self.closing_m));
        let lifted = after.z - self.began_m.z > LIFTED_M;
        let flat = |a: Vector3<f64>, b: Vector3<f64>| (a - b).xy().norm();
        let seen = record.chosen.and_then(|index| record.seen.get(index)?.place.as_ref().ok());
        let wanted = record.wanted_m.map(Vector3::from);
        let standing = record.standing_m.map(|[x, y]| Vector3::new(x, y, 0.0));
        let seen_m = standing.or_else(|| seen.map(|place| place.point().coords.coords));
        let hand_m = record.iterations.iter().rev().find_map(|look| look.hand_m).map(Vector3::from);
        // How high a palm belongs over the middle of a thing does not depend on where it stands.
        let over_m = record.over_middle_m.unwrap_or_default();
        let truly_wanted = wanted.zip(standing).map(|(wanted, standing)| {
            let beside = wanted - standing;
            Vector3::new(beside.x, beside.y, over_m) + self.object_m
        });
        let camera_error_m = seen_m.map(|seen| flat(seen, self.object_m));
        // Hand and object are seen by the same eyes: what matters is how they are seen to each other.
        let eyes_off = seen_m.map(|seen| seen - self.object_m).unwrap_or_default();
        let hand_error_m = hand_m.zip(aligned_m).map(|(seen, truly)| flat(seen - eyes_off, truly));
        let refused = matches!(record.outcome, Some(plumbline_grasp::Outcome::Refused { .. }));
        let failure = (!lifted && !refused).then(|| match &record.outcome {
            Some(plumbline_grasp::Outcome::Failed { failure: Failure::NotSeen, .. }) => Failure::NotSeen,
            Some(plumbline_grasp::Outcome::Failed { failure: Failure::Halted, .. }) => Failure::Halted,
            Some(plumbline_grasp::Outcome::Failed { failure: Failure::EyesLost, .. }) => Failure::EyesLost,
            Some(plumbline_grasp::Outcome::Failed { failure: Failure::HandWrong, .. }) => Failure::HandWrong,
            _ if record.slipped_after_s.is_some() => Failure::Slipped,
            _ if camera_error_m.is_some_and(|error_m| error_m > PLACE_WRONG_M) => Failure::PlaceWrong,
            _ if hand_error_m.is_some_and(|error_m| error_m > HAND_WRONG_M) => Failure::HandWrong,
            _ if flat(after, self.object_m) > LIFTED_M || after.z > self.object_m.z + 0.01 => {
                Failure::Slipped
            }
            _ => Failure::ReachWrong,
        });
        Judged {
            lifted,
            at_first: lifted && record.earlier.is_empty(),
            camera_error_m,
            reach_error_m: wanted.zip(closing_m).map(|(wanted, palm)| flat(wanted, palm)),
            alignment_m: truly_wanted.zip(closing_m).map(|(wanted, palm)| flat(wanted, palm)),
            palm_off_m: truly_wanted.zip(closing_m).map(|(wanted, palm)| (palm - wanted).into()),
            hand_error_m,
            failure,
            refused,
        }
    }
}

fn place(twin: &mut Lockstep, toy: Toy) -> Vector3<f64> {
    let toys = twin.truth_for_judging().toys;
    let found = toys.into_iter().find(|(other, _)| *other == toy).and_then(|(_, place)| place);
    found.map_or(Vector3::repeat(f64::NAN), |place| place.translation.vector)
}
