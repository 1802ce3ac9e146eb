//! The hand itself: open, closed, turned to the eyes.

use std::f64::consts::PI;

use plumbline_model::robot::{JointIndex, Posture};

use super::GraspPlanner;
use crate::body::is_thumb;
use crate::held::{self, Grip};

impl GraspPlanner {
    /// The hand open, the rest as in `from`.
    pub fn open(&self, from: &Posture) -> Posture {
        from.with(self.arm.hand(), &vec![0.0; self.arm.hand().len()])
    }

    /// Joints of the thumb.
    pub fn thumb(&self) -> Vec<JointIndex> {
        self.arm.hand().iter().filter(|joint| self.is_thumb(**joint)).copied().collect()
    }

    /// The hand closed, the rest as in `from`.
    pub fn closed(&self, from: &Posture) -> Posture {
        let angles: Vec<f64> = self.arm.hand().iter().map(|joint| self.closed_rad(*joint)).collect();
        from.with(self.arm.hand(), &angles)
    }

    /// The thumb closed, the rest as in `from`.
    pub fn thumb_closed(&self, from: &Posture) -> Posture {
        let thumb = self.thumb();
        let angles: Vec<f64> = thumb.iter().map(|joint| self.closed_rad(*joint)).collect();
        from.with(&thumb, &angles)
    }

    /// The palm turned to the eyes as published: the wrist bends by 45° where the arm is stretched and
    /// turns by 60° where it is bent, as far as its limits let it; the thumb out of the way.
    pub fn palm_to_eyes(&self, above: &Posture) -> Posture {
        let rig = self.arm.rig();
        let joints = self.arm.joints();
        let [.., elbow, turn, bend] = *joints else { return above.clone() };
        let stretched = ((above[elbow].to_degrees() - 60.0) / 100.0).clamp(0.0, 1.0);
        let within = |joint: JointIndex, angle_rad: f64| {
            let limits = rig.limits(joint);
            angle_rad.clamp(limits.lower_rad, limits.upper_rad)
        };
        let bent = within(bend, above[bend] - 0.25 * PI * stretched);
        let turned = within(turn, above[turn] + PI / 3.0 * (1.0 - stretched));
        above.with(&[turn, bend], &[turned, bent])
    }

    /// Its joints, to tell whether something is in it.
    pub fn grip(&self) -> Grip {
        Grip::of_joints(self.arm.rig(), self.arm.hand())
    }

    fn is_thumb(&self, joint: JointIndex) -> bool {
        is_thumb(self.arm.rig(), joint)
    }

    fn closed_rad(&self, joint: JointIndex) -> f64 {
        held::closed_rad(self.arm.rig(), joint)
    }
}
