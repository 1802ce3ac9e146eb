//! Whether something is held: the fingers say, and the eyes.

use plumbline_model::detection::PixelBox;
use plumbline_model::{Point, Robot};

use super::{Chosen, End, Running};
use crate::record::{Failure, Outcome, Step};
use crate::see::Seen;

/// A thing that is seen this near to where it stood, and no higher than this over it, was left, m.
const LEFT_M: f64 = 0.10;
/// What is not held well has fallen after this time, s.
const FALLEN_S: f64 = 1.5;
/// Another thing that nothing has met is seen again this near to where it stood, m.
const STANDS_M: f64 = 0.03;
/// Boxes that overlap by more than this (intersection over union) are of the same thing at the same place.
const SAME_IOU: f32 = 0.3;
/// Where the hand holds something, only boxes of both eyes that overlap by more than this are of a thing that
/// was left: a hand covers parts of what it holds, and what is left of it is seen elsewhere.
const UNTOUCHED_IOU: f32 = 0.6;
/// What is seen higher than before by more than this is not where it was, m.
const HIGHER_M: f64 = 0.04;

impl Running<'_> {
    pub(super) fn check(&mut self, chosen: &Chosen) -> Result<Outcome, End> {
        self.body.wait(FALLEN_S)?;
        self.keep(Step::Check)?;
        let holds = self.hand_holds()?;
        let sight = self.body.look()?;
        let grasper = &mut *self.grasper;
        let seen = grasper.looker.look(&sight, &grasper.knowledge)?;
        self.watch.saw(Step::Check, &sight, &seen);
        let object = &self.order.object;
        let is_of_class = |thing: &&Seen| thing.class.eq_ignore_ascii_case(object);
        let index = self.record.chosen;
        let before = index.and_then(|index| self.record.seen.get(index));
        let others = self.record.seen.iter().enumerate().filter(|(other, _)| Some(*other) != index);
        let others: Vec<&Seen> = others.map(|(_, other)| other).filter(is_of_class).collect();
        let left = seen
            .iter()
            .filter(is_of_class)
            .filter(|thing| !holds || is_untouched(thing, before))
            .any(|thing| is_where_it_was(thing, before, &chosen.point, &others));
        (self.record.seen_after_at_s, self.record.seen_after) = (Some(sight.at_s), seen);
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
                why: format!("something else is in the hand: the {object} is where it was"),
            },
        })
    }

    /// Whether something is between fingers and thumb. How far the fingers (the thumb is none) are kept
    /// from closing around nothing, the mean, goes into the record.
    fn hand_holds(&mut self) -> Result<bool, End> {
        let grip = self.grasper.planner(self.order.method).grip();
        let servos = self.body.servos()?;
        let open_rad = grip.open_rad(&servos);
        self.record.fingers_open_rad = Some(open_rad.iter().sum::<f64>() / open_rad.len().max(1) as f64);
        Ok(grip.holds(&servos))
    }
}

/// Whether both eyes see it in the boxes in which the chosen one was before.
fn is_untouched(thing: &Seen, before: Option<&Seen>) -> bool {
    before.is_some_and(|before| {
        let boxes = before.boxes_px.iter().zip(&thing.boxes_px);
        boxes.map(both_known).all(|boxes| boxes.is_some_and(|(a, b)| a.iou(&b) > UNTOUCHED_IOU))
    })
}

/// Whether a thing is where the chosen one was, and not another one that stood beside it.
fn is_where_it_was(thing: &Seen, before: Option<&Seen>, chosen: &Point<Robot>, others: &[&Seen]) -> bool {
    let flat_m = |a: &Point<Robot>, b: &Point<Robot>| (a.coords - b.coords).xy().norm();
    if let Ok(place) = &thing.place {
        let here = place.point();
        let is_low = (here.coords.z - chosen.coords.z).abs() < 0.3 * LEFT_M;
        let off_m = flat_m(&here, chosen);
        let is_another = others.iter().filter_map(|other| other.place.as_ref().ok()).any(|other| {
            let other_m = flat_m(&here, &other.point());
            other_m < off_m && other_m < STANDS_M
        });
        if is_another {
            return false;
        }
        if is_low && off_m < LEFT_M {
            return true;
        }
        if here.coords.z - chosen.coords.z > HIGHER_M {
            return false;
        }
    }
    let overlap = |other: &Seen| overlap(&other.boxes_px, &thing.boxes_px);
    let of_chosen = before.map_or(0.0, overlap);
    of_chosen > SAME_IOU && others.iter().all(|other| overlap(other) <= of_chosen)
}

/// How far a box of one eye is where it was (intersection over union, the larger one): what was lifted is seen higher by more than its size.
fn overlap(before: &[Option<[f32; 4]>; 2], now: &[Option<[f32; 4]>; 2]) -> f32 {
    let both = before.iter().zip(now).filter_map(both_known);
    both.map(|(before, now)| before.iou(&now)).fold(0.0, f32::max)
}

/// The boxes of one eye before and now, where there are both.
fn both_known((before, now): (&Option<[f32; 4]>, &Option<[f32; 4]>)) -> Option<(PixelBox, PixelBox)> {
    let area = |[x0, y0, x1, y1]: [f32; 4]| PixelBox { x0_px: x0, y0_px: y0, x1_px: x1, y1_px: y1 };
    Some((area((*before)?), area((*now)?)))
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;
    use crate::see::SeenPlace;

    fn tomato(point_m: [f64; 3], left_px: f32) -> Seen {
        let area = Some([left_px, 100.0, left_px + 60.0, 160.0]);
        let (covariance_m2, by_mount_m2) = (Matrix3::identity() * 1e-6, Matrix3::zeros());
        let place = Ok(SeenPlace { point_m, covariance_m2, by_mount_m2 });
        Seen { class: "Tomato".to_owned(), confidence: 0.9, boxes_px: [area, area], place }
    }

    #[test]
    fn another_one_that_stood_beside_it_is_not_taken_for_the_one_that_was_lifted() {
        let (first, second) = (tomato([0.3, -0.1, 0.08], 200.0), tomato([0.3, -0.02, 0.08], 280.0));
        let chosen = Point::new(0.3, -0.1, 0.08);
        let is_left = |thing: &Seen, others: &[&Seen]| is_where_it_was(thing, Some(&first), &chosen, others);
        // The second one stands 8 cm beside: alone it could be the first, pushed aside.
        let seen_again = tomato([0.302, -0.022, 0.081], 278.0);
        assert!(is_left(&seen_again, &[]));
        assert!(!is_left(&seen_again, &[&second]));
        // The first one, left where it was or pushed a little, is found beside the second.
        assert!(is_left(&tomato([0.301, -0.099, 0.08], 201.0), &[&second]));
        assert!(is_left(&tomato([0.3, -0.13, 0.08], 170.0), &[&second]));
        // In the hand it is high and elsewhere in the images, or high and not.
        assert!(!is_left(&tomato([0.3, -0.1, 0.18], 290.0), &[]));
        assert!(!is_left(&tomato([0.3, -0.1, 0.18], 210.0), &[]));
    }

    #[test]
    fn of_a_thing_in_the_hand_a_piece_seen_beside_does_not_count_as_left() {
        let before = tomato([0.197, -0.004, 0.083], 328.0);
        let piece = Some([336.0, 92.0, 354.0, 112.0]);
        let seen = Seen { boxes_px: [piece, piece], ..tomato([0.227, -0.011, 0.07], 336.0) };
        assert!(!is_untouched(&seen, Some(&before)));
        assert!(is_untouched(&tomato([0.198, -0.004, 0.083], 329.0), Some(&before)));
    }
}
