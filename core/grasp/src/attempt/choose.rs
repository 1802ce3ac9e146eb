//! Which of the things that are seen is meant, and where it stands.

use nalgebra::{Matrix3, Vector3};
use plumbline_model::{Point, Robot};

use super::{End, Running};
use crate::body::Sight;
use crate::knowledge::Knowledge;
use crate::method::Method;
use crate::outline::{Boxes, HEIGHT_SIGMA_M};
use crate::plan::{Beside, Standing};
use crate::record::{Failure, Step};
use crate::see::{Seen, SeenPlace};
use crate::stands;
use crate::things::Thing;

/// Farther from the place that was pointed at it is not what was meant, m.
const NEAR_M: f64 = 0.12;
/// What seems to stand so near to the thing that is grasped is that thing, m.
const SAME_M: f64 = 0.04;
/// Of several of a class those count that are seen at least with this share of the confidence of the surest.
const SURE_SHARE: f32 = 0.5;

/// The thing that is grasped.
#[derive(Clone, Debug, PartialEq)]
pub struct Chosen {
    /// Its middle.
    pub point: Point<Robot>,
    /// Its covariance, m².
    pub covariance_m2: Matrix3<f64>,
    /// Where it stands.
    pub standing: Standing,
}

impl Running<'_> {
    /// Looks for the object that is meant.
    pub(super) fn find(&mut self, sight: &Sight) -> Result<Chosen, End> {
        let grasper = &mut *self.grasper;
        let seen = grasper.looker.look_at_table(sight, &grasper.knowledge)?;
        self.watch.saw(Step::Look, sight, &seen);
        (self.record.seen_at_s, self.record.seen) = (Some(sight.at_s), seen);
        let object = &self.order.object;
        let thing = Thing::of_class(object).ok_or_else(|| End::Refused(unknown_thing(object)))?;
        let knowledge = &grasper.knowledge;
        let stands = |place: &SeenPlace| over_table_m(knowledge, &thing, place).is_none();
        let index = nearest(&self.record.seen, thing.class, self.near_m, stands)?;
        self.record.chosen = Some(index);
        let place = self.record.seen[index]
            .place
            .clone()
            .map_err(|why| End::Failed(Failure::NotSeen, format!("the {object} has no place: {why}")))?;
        let boxes_px = &self.record.seen[index].boxes_px;
        let boxes = Boxes { boxes_px, posture: &sight.posture, under: sight.seen_under() };
        self.standing(&place, &thing, &boxes)
    }

    /// What else stands on the table, as far as it is seen and known; the same thing taken for another one
    /// stands where it stands.
    pub(super) fn beside(&self, chosen: &Chosen) -> Vec<Beside> {
        let knowledge = &self.grasper.knowledge;
        let others = self.record.seen.iter().enumerate().filter(|(i, _)| Some(*i) != self.record.chosen);
        let beside = others.filter_map(|(_, seen)| {
            let (thing, place) = (Thing::of_class(&seen.class)?, seen.place.as_ref().ok()?);
            let stands = over_table_m(knowledge, &thing, place).is_none();
            let [x_m, y_m, _] = place.point_m;
            let [at_x_m, at_y_m] = chosen.standing.xy_m;
            let is_another = (x_m - at_x_m).hypot(y_m - at_y_m) > SAME_M;
            let middle_m = Vector3::new(x_m, y_m, knowledge.support_m(x_m, y_m) + 0.5 * thing.height_m);
            let radius_m = 0.5 * thing.height_m.max(thing.width_m);
            (stands && is_another).then_some(Beside { middle_m, radius_m })
        });
        beside.collect()
    }

    /// Where it stands; ours by its outline in both eyes.
    fn standing(&self, place: &SeenPlace, thing: &Thing, boxes: &Boxes<'_>) -> Result<Chosen, End> {
        let knowledge = &self.grasper.knowledge;
        let (mut point, mut covariance_m2) = (place.point().coords.coords, place.covariance_m2);
        let mut scale = 1.0;
        if let Some(off_m) = over_table_m(knowledge, thing, place) {
            return Err(End::Refused(format!(
                "the {} seems to be {:.0} mm {} the table: put it down, or calibrate the eyes and their mount again",
                thing.class.to_lowercase(),
                off_m.abs() * 1e3,
                if off_m > 0.0 { "over" } else { "under" }
            )));
        }
        if self.order.method == Method::M5
            && let Some(found) = boxes.whole_on_table(&knowledge.model, thing, point.xy())
        {
            let support_m = knowledge.support_m(found.xy_m.x, found.xy_m.y);
            scale = found.scale;
            point = Vector3::new(found.xy_m.x, found.xy_m.y, support_m + 0.5 * thing.height_m * scale);
            // Boxes and height alone. What is not known of the mount of the eyes and of their effects is left
            // out: the hand is then found by the same eyes beside the thing, and what moves both alike does not
            // bring one away from the other, which is all that the sum of both is looked at for (`sure.rs`). Of a
            // hand that is not found this says too little: the arm's word does not move with the eyes.
            covariance_m2 = Matrix3::identity() * HEIGHT_SIGMA_M.powi(2);
            covariance_m2.fixed_view_mut::<2, 2>(0, 0).copy_from(&found.covariance_m2);
        }
        let xy_m = [point.x, point.y];
        let support_m = knowledge.support_m(point.x, point.y);
        // What ends in a point is not pushed against the palm: it would tip over and drag the hand along.
        let lower_m = self.lower_m - thing.peak_m() * scale;
        let standing = Standing { xy_m, support_m, height_m: thing.height_m * scale, lower_m };
        Ok(Chosen { point: Point::new(point.x, point.y, point.z), covariance_m2, standing })
    }
}

/// How far over the table a thing seems to be that does not stand on it, see [`stands::over_table_m`].
fn over_table_m(knowledge: &Knowledge, thing: &Thing, place: &SeenPlace) -> Option<f64> {
    let point_m = place.point().coords.coords;
    stands::over_table_m(&knowledge.model, thing, &point_m, &(place.covariance_m2 - place.by_mount_m2))
}

/// What can be asked for instead of what nobody knows.
fn unknown_thing(object: &str) -> String {
    let known: Vec<String> = Thing::held().map(|thing| thing.class.to_lowercase()).collect();
    format!("nothing is known of a thing called {object}: choose one of {}", known.join(", "))
}

fn one_eye_only(lower: &str, eye: &str) -> String {
    format!(
        "the {lower} is seen by the {eye} eye only: look for what is in front of the other one, a hand of the robot \
         perhaps, or put the {lower} nearer to the middle"
    )
}

/// The thing of that class nearest to a place; where none was pointed at, of those that seem to stand on the
/// table (else of all) the one nearest to the robot.
fn nearest(
    seen: &[Seen],
    class: &str,
    near_m: Option<[f64; 2]>,
    stands: impl Fn(&SeenPlace) -> bool,
) -> Result<usize, End> {
    let not_seen = |why: String| End::Failed(Failure::NotSeen, why);
    let lower = class.to_lowercase();
    let of_class = || seen.iter().enumerate().filter(|(_, thing)| thing.class.eq_ignore_ascii_case(class));
    let placed = of_class().filter_map(|(index, thing)| Some((index, thing.place.as_ref().ok()?)));
    let far_m =
        |place: &SeenPlace, [x_m, y_m]: [f64; 2]| (place.point_m[0] - x_m).hypot(place.point_m[1] - y_m);
    let chosen = match near_m {
        None => {
            // What is seen much worse than another one may be something else.
            let surest = placed.clone().map(|(index, _)| seen[index].confidence).fold(0.0, f32::max);
            placed
                .filter(|(index, _)| seen[*index].confidence >= SURE_SHARE * surest)
                .map(|(index, place)| (index, !stands(place), far_m(place, [0.0; 2])))
                .min_by(|a, b| a.1.cmp(&b.1).then(a.2.total_cmp(&b.2)))
                .map(|(index, ..)| index)
        }
        Some(near_m) => placed
            .map(|(index, place)| (index, far_m(place, near_m)))
            .filter(|(_, far_m)| *far_m < NEAR_M)
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(index, _)| index),
    };
    chosen.ok_or_else(|| match of_class().next() {
        None => not_seen(format!("no {lower} is seen: put it where both eyes see it")),
        Some((_, Seen { place: Err(why), boxes_px, .. })) => not_seen(match boxes_px {
            [Some(_), None] => one_eye_only(&lower, "left"),
            [None, Some(_)] => one_eye_only(&lower, "right"),
            _ => format!("the {lower} has no place: {why}"),
        }),
        Some(_) => not_seen(format!(
            "no {lower} is seen near the place that was chosen: click on it again, or choose its class"
        )),
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_effects::RobotModel;
    use plumbline_model::StereoCalibration;
    use plumbline_model::robot::default_rig;

    use super::*;
    use crate::knowledge::Corrections;

    fn tomato(place: Result<[f64; 3], &str>, boxes_px: [Option<[f32; 4]>; 2]) -> Seen {
        let place = place.map_err(str::to_owned);
        let place = place.map(seen_at);
        Seen { class: "Tomato".to_owned(), confidence: 0.9, boxes_px, place }
    }

    fn seen_at(point_m: [f64; 3]) -> SeenPlace {
        let covariance_m2 = Matrix3::identity() * 1e-6;
        SeenPlace { point_m, covariance_m2, by_mount_m2: Matrix3::zeros() }
    }

    const BOX: Option<[f32; 4]> = Some([10.0, 10.0, 50.0, 50.0]);

    fn why(end: End) -> String {
        match end {
            End::Refused(why) | End::Failed(_, why) => why,
        }
    }

    #[test]
    fn of_two_the_one_that_was_pointed_at_is_taken_and_else_the_nearest_to_the_robot() {
        let mut seen = [tomato(Ok([0.36, 0.0, 0.08]), [BOX; 2]), tomato(Ok([0.3, -0.1, 0.08]), [BOX; 2])];
        let stands = |place: &SeenPlace| place.point_m[2] < 0.1;
        let index = |seen: &[Seen], near_m| nearest(seen, "Tomato", near_m, stands).map_err(why);
        assert_eq!(index(&seen, Some([0.37, 0.01])), Ok(0));
        assert_eq!(index(&seen, Some([0.29, -0.12])), Ok(1));
        assert_eq!(index(&seen, None), Ok(1));
        let nowhere = index(&seen, Some([0.2, 0.3]));
        assert!(nowhere.is_err_and(|why| why.contains("near the place that was chosen")));
        // What is hardly taken for a tomato is none where there is another one.
        seen[1].confidence = 0.3;
        assert_eq!(index(&seen, None), Ok(0));
        // What is in the air counts where nothing stands.
        let mut seen = [tomato(Ok([0.36, 0.0, 0.08]), [BOX; 2]), tomato(Ok([0.3, -0.1, 0.2]), [BOX; 2])];
        assert_eq!(index(&seen, None), Ok(0));
        seen[0].class = "Orange".to_owned();
        assert_eq!(index(&seen, None), Ok(1));
    }

    #[test]
    fn what_is_not_where_it_was_pointed_at_or_is_not_known_is_refused_with_what_to_do() {
        let seen = [tomato(Ok([0.3, -0.1, 0.08]), [Some([0.0; 4]); 2])];
        let why = why(nearest(&seen, "Tomato", Some([0.5, 0.3]), |_| true).expect_err("it stands elsewhere"));
        assert!(why.contains("near the place that was chosen: click on it again"), "{why}");
        let unknown = unknown_thing("anvil");
        assert!(unknown.contains("called anvil: choose one of") && unknown.contains("tomato"), "{unknown}");
    }

    #[test]
    fn what_one_eye_alone_sees_is_refused_with_the_name_of_that_eye() {
        for (boxes_px, words) in [
            ([BOX, None], "by the left eye only: look"),
            ([None, BOX], "by the right eye only: look"),
            ([BOX, BOX], "has no place: hidden"),
        ] {
            let seen = [tomato(Err("hidden"), boxes_px)];
            let why = nearest(&seen, "tomato", None, |_| true).map_err(why).expect_err("it has no place");
            assert!(why.contains(words), "{why}");
        }
    }

    #[test]
    fn a_thing_in_the_air_does_not_stand_on_the_table_however_little_is_known_of_the_mount() {
        let rig = default_rig();
        let knowledge = Knowledge {
            described: rig.clone(),
            model: RobotModel::nominal(rig.clone()),
            calibration: Arc::new(StereoCalibration::bare(rig.eyes.cameras)),
            corrections: Corrections::default(),
        };
        let thing = Thing::of_class("Tomato").expect("known");
        let [x_m, y_m] = [0.4, 0.1];
        let stands_m = knowledge.support_m(x_m, y_m) + 0.5 * thing.height_m;
        let seen = |up_m: f64, sigma_m: f64, by_mount_m: f64| {
            let [all_m2, by_mount_m2] = [sigma_m.powi(2) + by_mount_m.powi(2), by_mount_m.powi(2)];
            let place = SeenPlace {
                covariance_m2: Matrix3::identity() * all_m2,
                by_mount_m2: Matrix3::identity() * by_mount_m2,
                ..seen_at([x_m, y_m, stands_m + up_m])
            };
            over_table_m(&knowledge, &thing, &place)
        };
        for by_mount_m in [0.0, 0.03] {
            assert_eq!(seen(0.02, 2e-3, by_mount_m), None);
            assert!(seen(0.06, 2e-3, by_mount_m).is_some_and(|off_m| (off_m - 0.06).abs() < 1e-9));
            assert_eq!(seen(0.06, 0.02, by_mount_m), None, "what is seen badly may stand there");
        }
    }
}
