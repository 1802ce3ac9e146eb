//! What stands beside the thing that is grasped, and is left as it is.

use nalgebra::Vector3;
use plumbline_model::robot::Posture;

use super::GraspPlanner;

/// The hand keeps so far from it, m: places of both are known to millimeters, and nothing is a ball.
const AWAY_M: f64 = 0.010;

/// Something that is not grasped, as a ball around its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beside {
    /// Robot frame, m.
    pub middle_m: Vector3<f64>,
    /// m.
    pub radius_m: f64,
}

impl GraspPlanner {
    /// From now on plans come down beside these where they can.
    pub fn leave(&mut self, others: Vec<Beside>) {
        self.others = others;
    }

    /// Whether the arm would touch one of them on the way down.
    pub(super) fn meets_others(&self, down: &[Posture]) -> bool {
        let mut each = down.iter().flat_map(|posture| self.others.iter().map(move |other| (posture, other)));
        each.any(|(posture, other)| self.arm.distance_m(posture, &other.middle_m) < other.radius_m + AWAY_M)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_4;
    use std::sync::Arc;

    use plumbline_effects::RobotModel;
    use plumbline_model::robot::Rig;

    use super::super::Standing;
    use super::*;
    use crate::arm::PalmArm;

    #[test]
    fn a_hand_comes_down_beside_what_stands_near_and_where_it_cannot_takes_its_usual_way() {
        let rig = Arc::new(Rig::built_in("nico").expect("valid"));
        let arm = PalmArm::new(&RobotModel::nominal(rig.clone()), "right").expect("an arm");
        let mut planner = GraspPlanner::new(arm);
        let standing =
            Standing { xy_m: [0.3, -0.1], support_m: rig.table.height_m, height_m: 0.054, lower_m: 0.0 };
        let plan =
            |planner: &GraspPlanner| planner.plan(&standing, &Vector3::zeros(), &rig.home()).expect("a plan");
        let usual = plan(&planner);
        let ball = |angle_rad: f64, apart_m: f64| {
            let beside = Vector3::new(apart_m * angle_rad.cos(), apart_m * angle_rad.sin(), 0.0);
            let middle_m = Vector3::new(0.3, -0.1, standing.middle_m()) + beside;
            Beside { middle_m, radius_m: 0.03 }
        };
        let mut turned = 0;
        for side in 0..8 {
            planner.leave(vec![ball(f64::from(side) * FRAC_PI_4, 0.12)]);
            let plan = plan(&planner);
            assert!(!planner.meets_others(&plan.down), "{side}");
            turned += usize::from((plan.heading_rad - usual.heading_rad).abs() > 1e-9);
        }
        // Of eight sides some are where the hand or the arm would be.
        assert!((1..8).contains(&turned), "{turned}");
        planner.leave((0..8).map(|side| ball(f64::from(side) * FRAC_PI_4, 0.05)).collect());
        assert_eq!(plan(&planner), usual);
        planner.leave(vec![]);
        assert_eq!(plan(&planner), usual);
    }
}
