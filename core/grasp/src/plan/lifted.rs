//! Up again with what is held.

use nalgebra::Vector3;
use plumbline_model::Point;
use plumbline_model::robot::Posture;

use super::{GraspPlanner, LIFT_M, STEP_M};

/// A palm more level than this (cosine of its inclination) holds what it holds.
const HOLDS_LEVEL: f64 = 0.9985;
/// Less does not count: a degree or two.
const GAIN: f64 = 0.001;
/// What is lifted straight at first, until it is clear of the table, m.
const STRAIGHT_M: f64 = 0.04;
/// So far toward the shoulder a stretched arm may bring what it lifts, m.
const BACK_M: [f64; 5] = [0.03, 0.06, 0.09, 0.12, 0.15];
/// Headings that are tried there beside the one in which it was grasped, rad.
const BESIDE_RAD: [f64; 9] = [0.0, 0.2, -0.2, 0.4, -0.4, 0.6, -0.6, 0.8, -0.8];
/// No joint turns farther than this on the way there, rad.
const FARTHEST_RAD: f64 = 1.2;
/// Places looked at along that way.
const SAMPLES: usize = 16;
/// What is held reaches so far beside the palm, m.
const HELD_M: f64 = 0.045;

impl GraspPlanner {
    /// How high things are usually lifted, m.
    pub const LIFT_M: f64 = LIFT_M;

    /// Up from where the hand closed, fingers as they are: straight; an arm that is stretched out and would
    /// tilt the palm on that way, out of which things creep then, takes what it has lifted a little nearer to its
    /// shoulder, where it can hold the palm level.
    pub fn lift(&self, closed: &Posture, heading_rad: f64, by_m: f64) -> Vec<Posture> {
        let mut straight = self.vertical(heading_rad, closed, by_m);
        let clear = (STRAIGHT_M / STEP_M).round() as usize;
        let Some((low, top)) = straight.get(clear.saturating_sub(1)).zip(straight.last()) else {
            return straight;
        };
        let level = self.arm().level(top);
        if level >= HOLDS_LEVEL.min(self.arm().level(closed)) - GAIN {
            return straight;
        }
        let nearer = self.nearer(low, heading_rad, by_m - STRAIGHT_M, level);
        if let Some(nearer) = nearer.filter(|nearer| self.arm().level(nearer) > level + GAIN) {
            straight.truncate(clear);
            straight.push(nearer);
        }
        straight
    }

    /// Where the palm is level, higher and nearer to the shoulder than where it is held now: as near to there as is
    /// level, else the most level. On the way there it is nowhere less level than `least_level`.
    fn nearer(&self, from: &Posture, heading_rad: f64, by_m: f64, least_level: f64) -> Option<Posture> {
        let arm = self.arm();
        let start = arm.palm(from).coords;
        let toward = arm.shoulder_m(from) - start.coords;
        let toward = Vector3::new(toward.x, toward.y, 0.0).try_normalize(1e-6)?;
        let mut best: Option<(f64, Posture)> = None;
        for back_m in BACK_M {
            let point = Point::from(start + Vector3::z() * by_m + toward * back_m);
            let reached = BESIDE_RAD.iter().filter_map(|beside_rad| {
                let there = arm.sent_to(point, heading_rad + beside_rad, from)?;
                self.is_good_way(from, &there, least_level).then(|| (arm.level(&there), there))
            });
            for (level, there) in reached {
                if level >= HOLDS_LEVEL {
                    return Some(there);
                }
                if best.as_ref().is_none_or(|(most, _)| level > *most) {
                    best = Some((level, there));
                }
            }
        }
        best.map(|(_, there)| there)
    }

    /// Whether what is held can be taken straight from one posture to another: free, also of what stands beside and
    /// of a table that stands a little higher, and nowhere less level.
    fn is_good_way(&self, from: &Posture, there: &Posture, least_level: f64) -> bool {
        if there.distance_rad(from) > FARTHEST_RAD {
            return false;
        }
        let way: Vec<Posture> =
            (1..=SAMPLES).map(|i| from.toward(there, i as f64 / SAMPLES as f64)).collect();
        let beside_m = |posture: &Posture, other: &super::Beside| {
            (self.arm().palm(posture).coords.coords - other.middle_m).xy().norm() - other.radius_m
        };
        way.iter().all(|posture| self.arm().level(posture) >= least_level)
            && !self.meets_others(&way)
            && !way.iter().any(|posture| self.others.iter().any(|other| beside_m(posture, other) < HELD_M))
            && matches!(self.may_meet_table(from, &way), Ok(false))
            && matches!(self.is_free(from, std::slice::from_ref(there)), Ok(None))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_effects::RobotModel;
    use plumbline_model::robot::Rig;

    use super::super::{Beside, Standing};
    use super::*;
    use crate::PLACES_M;
    use crate::arm::PalmArm;

    /// What was carried home goes back, too, with either hand.
    #[test]
    fn what_was_carried_home_goes_back_to_where_it_was() {
        let rig = Arc::new(Rig::built_in("nico").expect("valid"));
        for hand in ["right", "left"] {
            let arm = PalmArm::new(&RobotModel::nominal(rig.clone()), hand).expect("an arm");
            let planner = GraspPlanner::new(arm);
            let (mut planned, mut back_from_home) = (0, 0);
            for [x_m, y_m] in PLACES_M {
                let y_m = if hand == "left" { -y_m } else { y_m };
                let standing = Standing { xy_m: [x_m, y_m], support_m: 0.056, height_m: 0.054, lower_m: 0.0 };
                let Ok(plan) = planner.plan(&standing, &Vector3::zeros(), &rig.home()) else { continue };
                let closed = planner.closed(plan.closing().expect("a way down"));
                let was_m = planner.arm().palm(&closed).coords.coords;
                let joints = planner.arm().joints();
                let home = closed.with(joints, &rig.home().of(joints));
                planned += 1;
                let Ok(Some(back)) = planner.put_back(&home, was_m.into()) else { continue };
                let low_m = planner.arm().palm(back.last().expect("a way")).coords.coords;
                assert!((low_m - was_m).norm() < 5e-3, "{hand} {x_m} {y_m}: put back at {low_m:?}");
                back_from_home += 1;
            }
            // Some places are reached only beside a heading that is not tried from there: what is held is handed over.
            assert!(2 * back_from_home > planned, "{hand}: to {back_from_home} of {planned} places");
        }
    }

    #[test]
    fn what_is_lifted_nearer_passes_beside_what_stands_there_and_goes_back_to_where_it_was() {
        let rig = Arc::new(Rig::built_in("nico").expect("valid"));
        let arm = PalmArm::new(&RobotModel::nominal(rig.clone()), "right").expect("an arm");
        let mut planner = GraspPlanner::new(arm);
        let mut nearer = 0;
        for xy_m in PLACES_M {
            planner.leave(vec![]);
            let standing = Standing { xy_m, support_m: 0.056, height_m: 0.054, lower_m: 0.0 };
            let Ok(plan) = planner.plan(&standing, &Vector3::zeros(), &rig.home()) else { continue };
            let closed = planner.closed(plan.closing().expect("a way down"));
            let way = planner.lift(&closed, plan.heading_rad, LIFT_M);
            let straight = planner.vertical(plan.heading_rad, &closed, LIFT_M);
            if way == straight {
                continue;
            }
            nearer += 1;
            let was_m = planner.arm().palm(&closed).coords.coords;
            let top = way.last().expect("a way");
            let back = planner.put_back(top, was_m.into()).expect("free").expect("it gets down");
            let low_m = planner.arm().palm(back.last().expect("a way")).coords.coords;
            assert!((low_m - was_m).norm() < 5e-3, "{xy_m:?}: put back at {low_m:?}");

            let there_m = planner.arm().palm(top).coords;
            let middle_m = Vector3::new(there_m.x, there_m.y, 0.083);
            planner.leave(vec![Beside { middle_m, radius_m: 0.027 }]);
            let beside = planner.lift(&closed, plan.heading_rad, LIFT_M);
            assert_ne!(beside, way, "{xy_m:?}: what is held would meet what stands there");
            for posture in beside.iter().skip(4) {
                let off_m = (planner.arm().palm(posture).coords.coords - middle_m).xy().norm();
                assert!(beside == straight || off_m > 0.027 + HELD_M, "{xy_m:?}: {off_m}");
            }
        }
        assert!(nearer >= 1, "an arm is stretched out somewhere");
    }
}
