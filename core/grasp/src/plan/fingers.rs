//! The hand itself: open, closed, turned to the eyes.

use std::f64::consts::PI;

use plumbline_model::robot::{JointIndex, Posture};

use super::GraspPlanner;
use crate::body::is_thumb;

/// Fingers and thumb bend this far around nothing, rad.
const CLOSED_RAD: f64 = 1.8;

impl GraspPlanner {
    /// The hand open, the rest as in `from`.
    pub fn open(&self, from: &Posture) -> Posture {
        from.with(self.arm.hand(), &vec![0.0; self.arm.hand().len()])
    }

    /// Joints of the fingers without the thumb.
    pub fn fingers(&self) -> Vec<JointIndex> {
        let is_finger = |joint: &&JointIndex| !self.is_thumb(**joint);
        self.arm.hand().iter().filter(is_finger).copied().collect()
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

    fn is_thumb(&self, joint: JointIndex) -> bool {
        is_thumb(self.arm.rig(), joint)
    }

    /// Bent inward, as far as the fingers of the pose "close-hand" are.
    fn closed_rad(&self, joint: JointIndex) -> f64 {
        if self.arm.rig().description.joint(joint).name.contains("thumb_z") {
            return 0.0;
        }
        let limits = self.arm.rig().limits(joint);
        let inward = if limits.upper_rad > -limits.lower_rad { 1.0 } else { -1.0 };
        inward * CLOSED_RAD
    }
}
