//! Grasps with a palm that is turned as somebody else says: the published methods interpolate a table of
//! headings instead of choosing one.

use nalgebra::{UnitQuaternion, Vector3};
use plumbline_model::robot::Posture;

use super::{
    ABOVE_M, GraspPlan, GraspPlanner, HEADING_STEP_RAD, LEAST_LEVEL, NoPlan, Standing, WayDown, turn_rad,
};

/// An arm that cannot turn its palm so takes the nearest heading in so many steps to either side.
const ASIDE: i32 = 9;

/// How the palm comes to a thing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Headed {
    /// Azimuth of the fingers, rad.
    pub heading_rad: f64,
    /// Added to every point to which the palm is sent, m.
    pub shift_m: Vector3<f64>,
    /// Whether the middle of the palm, not its grip, is sent over the thing.
    pub centered: bool,
}

impl Headed {
    /// What is added for a heading of a hand, m.
    pub fn shift_m(&self, standing: &Standing, heading_rad: f64, is_left: bool) -> Vector3<f64> {
        let level = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading_rad);
        let beside = Vector3::new(standing.xy_m[0], standing.xy_m[1], 0.0)
            - standing.palm_turned(&level, is_left).coords.coords;
        let beside = if self.centered { Vector3::new(beside.x, beside.y, 0.0) } else { Vector3::zeros() };
        self.shift_m + beside
    }
}

impl GraspPlanner {
    /// The grasp of what stands somewhere with this heading, or the nearest one that the arm reaches.
    ///
    /// # Errors
    /// Why it cannot be made.
    pub fn plan_headed(
        &self,
        standing: &Standing,
        headed: &Headed,
        from: &Posture,
    ) -> Result<GraspPlan, NoPlan> {
        let mut barred = None;
        let aside = (0..=ASIDE).flat_map(|step| [step, -step]).skip(1);
        for heading_rad in aside.map(|step| headed.heading_rad + f64::from(step) * HEADING_STEP_RAD) {
            for above_m in ABOVE_M {
                match self.plan_so(above_m, standing, headed, heading_rad, from) {
                    Ok(Some(plan)) => return Ok(plan),
                    Ok(None) => {}
                    Err(why) => barred = barred.or(Some(why)),
                }
            }
        }
        Err(barred.unwrap_or(NoPlan::OutOfReach { xy_m: standing.xy_m }))
    }

    /// `None`: the hand does not get there.
    fn plan_so(
        &self,
        above_m: f64,
        standing: &Standing,
        headed: &Headed,
        heading_rad: f64,
        from: &Posture,
    ) -> Result<Option<GraspPlan>, NoPlan> {
        let open = self.open(from);
        let shift_m = headed.shift_m(standing, heading_rad, self.arm().is_left());
        let Some(way) = self.way_to(above_m, standing, heading_rad, &shift_m, &open) else { return Ok(None) };
        let WayDown { palm_m, above, down, level } = way;
        if level < LEAST_LEVEL {
            return Ok(None);
        }
        self.room(&above, &down)?;
        let approach = self.free_way(from, &above)?;
        Ok(Some(GraspPlan {
            hand: self.arm().which(),
            standing: *standing,
            heading_rad,
            level,
            palm_m,
            effort_rad: turn_rad(&above, &down),
            approach,
            down,
        }))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_effects::RobotModel;
    use plumbline_model::robot::Rig;

    use super::*;
    use crate::arm::PalmArm;
    use crate::published::heading_rad;

    #[test]
    fn a_palm_comes_with_the_heading_that_was_asked_for_or_the_nearest_that_it_can() {
        let rig = Arc::new(Rig::built_in("nico").expect("valid"));
        let planner =
            GraspPlanner::new(PalmArm::new(&RobotModel::nominal(rig.clone()), "right").expect("an arm"));
        let home = rig.home();
        for [x_m, y_m] in [[0.3, -0.1], [0.4, -0.2], [0.3, 0.2]] {
            let standing =
                Standing { xy_m: [x_m, y_m], support_m: rig.table.height_m, height_m: 0.054, lower_m: 0.0 };
            let heading_rad = heading_rad(x_m, y_m);
            for centered in [false, true] {
                let headed = Headed { heading_rad, shift_m: Vector3::new(0.0, 0.0, 0.01), centered };
                let plan = planner.plan_headed(&standing, &headed, &home).expect("a plan");
                assert!(
                    (plan.heading_rad - heading_rad).abs() < 2.0 * HEADING_STEP_RAD,
                    "{}",
                    plan.heading_rad
                );
                let sent = planner.arm().palm(plan.closing().expect("a way down")).coords.coords;
                let beside = (sent.xy() - Vector3::new(x_m, y_m, 0.0).xy()).norm();
                let off_m = (sent - plan.palm_m - headed.shift_m(&standing, plan.heading_rad, false)).norm();
                assert!(off_m < 1e-3, "{off_m}");
                // The middle of the palm, or where the fingers close around the thing.
                assert!(if centered { beside < 0.003 } else { beside > 0.010 }, "{centered} {beside}");
            }
        }
        let far = Standing { xy_m: [0.9, 0.0], support_m: rig.table.height_m, height_m: 0.054, lower_m: 0.0 };
        let headed = Headed { heading_rad: 0.0, shift_m: Vector3::zeros(), centered: false };
        let refused = planner.plan_headed(&far, &headed, &home).expect_err("out of reach");
        assert_eq!(refused, NoPlan::OutOfReach { xy_m: far.xy_m });
    }
}
