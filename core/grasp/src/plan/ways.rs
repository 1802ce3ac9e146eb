//! Free ways to above an object.

use plumbline_model::robot::Posture;
use plumbline_model::robot::collision::{Allowance, Body, PathCheck};

use super::{GraspPlanner, NoPlan};

/// Places looked at along a way.
const SAMPLES: usize = 16;
/// On its way the palm keeps this high above the table, m, or as high as its lower end.
const CLEARANCE_M: f64 = 0.11;
/// An arm no farther from its home than this is there, rad.
const AT_HOME_RAD: f64 = 0.05;

impl GraspPlanner {
    /// A free way from a posture to another: straight, else over the posture in which the arm is at home,
    /// the hand opened on the way.
    ///
    /// # Errors
    /// What is in the way.
    pub fn free_way(&self, from: &Posture, above: &Posture) -> Result<Vec<Posture>, NoPlan> {
        let mut barred = None;
        for way in self.ways(from, above) {
            match self.is_free(from, &way)? {
                None => return Ok(way),
                Some(why) => barred = barred.or(Some(why)),
            }
        }
        Err(NoPlan::NotFree(barred.unwrap_or_else(|| "there is none".to_owned())))
    }

    /// A free way on which the arm goes home out of another one's way, fingers as they are; `None`: it is at
    /// home.
    ///
    /// # Errors
    /// What is in the way.
    pub fn parked(&self, from: &Posture) -> Result<Option<Vec<Posture>>, NoPlan> {
        let arm = self.arm();
        let home = from.with(arm.joints(), &arm.rig().home().of(arm.joints()));
        if home.distance_rad(from) < AT_HOME_RAD {
            return Ok(None);
        }
        let mut up = self.vertical(arm.heading_rad(from), from, CLEARANCE_M);
        up.push(home.clone());
        let mut barred = None;
        for way in [vec![home], up] {
            match self.is_free(from, &way)? {
                None => return Ok(Some(way)),
                Some(why) => barred = barred.or(Some(why)),
            }
        }
        Err(NoPlan::NotFree(barred.unwrap_or_else(|| "there is none".to_owned())))
    }

    /// The smallest distance (m) of any two bodies on the way down.
    pub(super) fn room(&self, above: &Posture, down: &[Posture]) -> Result<f64, NoPlan> {
        let mut before = above;
        let mut room_m = f64::INFINITY;
        for next in down {
            match self.bodies.check_path(before, next, &[])? {
                PathCheck::Clear { smallest_m, .. } => room_m = room_m.min(smallest_m),
                PathCheck::Collides { contact, .. } => {
                    let (a, b) = (contact.a_name, contact.b_name);
                    return Err(NoPlan::NotFree(format!("going down the {a} would meet the {b}")));
                }
                PathCheck::BeyondLimit { name, why, .. } => {
                    return Err(NoPlan::NotFree(format!("going down {name} would turn too far: {why}")));
                }
            }
            before = next;
        }
        Ok(room_m)
    }

    /// What stops the arm on a way down onto the table, the hand and what it holds left out; `None`: nothing.
    pub(super) fn stops_arm(&self, way: &[Posture]) -> Result<Option<String>, NoPlan> {
        let (_, hand) = &self.at_a_larger_table;
        let may =
            [Body::Table, Body::Touchscreen, Body::Floor].map(|body| Allowance { body, ..hand.clone() });
        for pair in way.windows(2) {
            match self.bodies.check_path(&pair[0], &pair[1], &may)? {
                PathCheck::Clear { .. } => {}
                PathCheck::Collides { contact, .. } => {
                    return Ok(Some(format!("the {} would meet the {}", contact.a_name, contact.b_name)));
                }
                PathCheck::BeyondLimit { name, why, .. } => {
                    return Ok(Some(format!("{name} would turn too far: {why}")));
                }
            }
        }
        Ok(None)
    }

    /// Whether the arm behind its hand comes so near to the table on the way down that it may meet it.
    pub(super) fn may_meet_table(&self, above: &Posture, down: &[Posture]) -> Result<bool, NoPlan> {
        let (bodies, hand) = &self.at_a_larger_table;
        let mut before = above;
        for next in down {
            let check = bodies.check_path(before, next, std::slice::from_ref(hand))?;
            if matches!(check, PathCheck::Collides { .. }) {
                return Ok(true);
            }
            before = next;
        }
        Ok(false)
    }

    fn ways(&self, from: &Posture, above: &Posture) -> Vec<Vec<Posture>> {
        let arm = self.arm();
        let home = self.open(above).with(arm.joints(), &arm.rig().home().of(arm.joints()));
        let between = home.toward(above, 0.5);
        let open = self.open(from);
        vec![
            vec![above.clone()],
            vec![home.clone(), above.clone()],
            vec![open.clone(), home.clone(), above.clone()],
            vec![open, home, between, above.clone()],
        ]
    }

    /// What is in the way; `None`: nothing.
    pub(super) fn is_free(&self, from: &Posture, way: &[Posture]) -> Result<Option<String>, NoPlan> {
        let mut before = from;
        for next in way {
            if self.dips(before, next) {
                return Ok(Some("the hand would sweep over the table".to_owned()));
            }
            match self.bodies.check_path(before, next, &[])? {
                PathCheck::Clear { .. } => before = next,
                PathCheck::Collides { contact, .. } => {
                    return Ok(Some(format!("the {} would meet the {}", contact.a_name, contact.b_name)));
                }
                PathCheck::BeyondLimit { name, why, .. } => {
                    return Ok(Some(format!("{name} would turn too far: {why}")));
                }
            }
        }
        Ok(None)
    }

    /// Whether the palm comes lower than it should between two postures.
    fn dips(&self, from: &Posture, to: &Posture) -> bool {
        let height_m = |posture: &Posture| self.arm().palm(posture).coords.z;
        let least_m = self.arm().rig().table.height_m + CLEARANCE_M;
        let least_m = least_m.min(height_m(from)).min(height_m(to)) - 1e-3;
        (1..SAMPLES).any(|i| height_m(&from.toward(to, i as f64 / SAMPLES as f64)) < least_m)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use nalgebra::Vector3;
    use plumbline_effects::RobotModel;
    use plumbline_model::robot::Rig;

    use super::super::Standing;
    use super::*;
    use crate::arm::PalmArm;

    fn planner(rig: &Arc<Rig>) -> GraspPlanner {
        GraspPlanner::new(PalmArm::new(&RobotModel::nominal(rig.clone()), "right").expect("an arm"))
    }

    #[test]
    fn a_forearm_keeps_away_from_a_table_that_may_stand_nearer_and_higher() {
        let rig = Arc::new(Rig::built_in("nico").expect("valid"));
        let mut other = (*rig).clone();
        // So near and high that the forearm is in it, wherever the hand is.
        other.table.height_m += 0.1;
        other.table.x_range_m[0] -= 0.3;
        let (here, there) = (planner(&rig), planner(&Arc::new(other)));
        for xy_m in [[0.2, -0.2], [0.3, -0.2], [0.3, -0.1]] {
            let standing = Standing { xy_m, support_m: rig.table.height_m, height_m: 0.054, lower_m: 0.0 };
            let plan = here.plan(&standing, &Vector3::zeros(), &rig.home()).expect("a plan");
            let above = plan.above().expect("a way");
            assert!(!here.may_meet_table(above, &plan.down).expect("postures"), "{xy_m:?}");
            assert!(there.may_meet_table(above, &plan.down).expect("postures"), "{xy_m:?}");
        }
    }

    /// Low over a place from which a hand has no room to sag on its way to another one.
    fn low_over(planner: &GraspPlanner, xy_m: [f64; 2]) -> Posture {
        const STEPS_DOWN: usize = 4;
        let rig = planner.arm().rig();
        let standing = Standing { xy_m, support_m: rig.table.height_m, height_m: 0.054, lower_m: 0.0 };
        let plan = planner.plan(&standing, &Vector3::zeros(), &rig.home()).expect("a plan");
        plan.down.get(STEPS_DOWN - 1).or(plan.closing()).cloned().expect("a way down")
    }

    #[test]
    fn where_the_straight_way_would_sweep_over_the_table_the_arm_goes_over_its_home() {
        let rig = Arc::new(Rig::built_in("nico").expect("valid"));
        let planner = planner(&rig);
        let arm = planner.arm().joints().to_vec();
        let places = [[0.2, -0.1], [0.3, -0.1], [0.3, -0.2], [0.4, -0.2], [0.4, 0.0], [0.3, 0.1]];
        let low = places.map(|xy_m| low_over(&planner, xy_m));
        let (mut straight, mut over_home) = (0, 0);
        for (from, to) in low.iter().flat_map(|from| low.iter().map(move |to| (from, to))) {
            let barred = planner.is_free(from, std::slice::from_ref(to)).expect("postures");
            let Ok(way) = planner.free_way(from, to) else { continue };
            assert_eq!(way.last(), Some(to));
            let free = planner.is_free(from, &way);
            assert_eq!(free, Ok(None), "what is given out is free");
            let is_home = |posture: &Posture| posture.of(&arm) == rig.home().of(&arm);
            if barred.is_none() {
                assert_eq!(way.len(), 1, "no detour where none is needed");
                straight += 1;
            } else {
                assert!(way.iter().any(is_home), "{barred:?}: {way:?}");
                over_home += usize::from(barred.is_some_and(|why| why.contains("sweep over the table")));
            }
        }
        assert!(straight > 0 && over_home > 0, "{straight} straight, {over_home} over home");
    }
}
