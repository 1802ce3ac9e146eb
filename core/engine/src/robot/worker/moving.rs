//! Moves: shown first, then run; torque, and poses that are kept.

use plumbline_hardware::joints::{Move, Pace};
use plumbline_model::robot::JointIndex;

use super::{Running, TORQUE_SWITCHED, Worker};
use crate::robot::command::Destination;
use crate::robot::destination::{Circumstances, Resolved, resolve};
use crate::robot::path::duration;
use crate::robot::unable::Unable;
use crate::robot::view::Preview;

impl Worker {
    /// Whether it is known where some joints are, and what moves with them.
    pub(super) fn knows(&self, joints: &[JointIndex]) -> Result<(), Unable> {
        let Some(state) = self.arm.as_ref().and_then(|arm| arm.state()) else { return Ok(()) };
        Ok(self.together.check(&self.rig, joints, &state.unknown, &state.late)?)
    }

    pub(super) fn torque(&mut self, joints: &[JointIndex], on: bool) -> Result<(), Unable> {
        let all: Vec<JointIndex> = self.rig.servos.iter().map(|servo| servo.joint).collect();
        let joints = if joints.is_empty() { &all } else { joints };
        self.end_lead(TORQUE_SWITCHED);
        Ok(self.arm()?.torque(joints, on)?)
    }

    pub(super) fn show(&mut self, destination: &Destination) -> Result<(), Unable> {
        self.preview = None;
        let present = self.present().ok_or(Unable::NotReadToShow)?;
        let poses = self.poses.all(&self.rig);
        let reach = self.reach.as_ref().zip(self.arm_model.as_ref());
        let around = Circumstances { model: &self.model, reach, present: &present, poses: &poses };
        let resolved = resolve(destination, &around)?;
        self.knows(&resolved.joints)?;
        self.preview_of(resolved);
        Ok(())
    }

    pub(super) fn preview_of(&mut self, resolved: Resolved) {
        let Some(present) = self.present() else { return };
        let path = self.paths.check(&present, &resolved.end);
        let turn = |joint: &JointIndex| (*joint, (resolved.end[*joint] - present[*joint]).abs());
        let largest = resolved.joints.iter().map(turn).max_by(|a, b| a.1.total_cmp(&b.1));
        let title = |joint| self.rig.servo_of(joint).map_or_else(String::new, |servo| servo.title.clone());
        let preview = Preview {
            title: resolved.title.clone(),
            end: resolved.end.clone(),
            path,
            duration: duration(largest.map_or(0.0, |(_, turn_rad)| turn_rad), self.peak_speed_rad_s()),
            largest_turn: largest.map(|(joint, turn_rad)| (title(joint), turn_rad)),
            model: self.title.clone(),
            tip_sigma_m: resolved.tip_sigma_m,
        };
        self.preview = Some((resolved, preview));
    }

    pub(super) fn peak_speed_rad_s(&self) -> f64 {
        (self.speed * self.rig.gate.usual_speed_rad_s).min(self.rig.gate.speed_rad_s)
    }

    pub(super) fn run_preview(&mut self) -> Result<(), Unable> {
        let (resolved, _) = self.preview.take().ok_or(Unable::NoPreview)?;
        let present = self.present().ok_or(Unable::NotRead)?;
        self.knows(&resolved.joints)?;
        // The arm may have moved since it was shown.
        self.paths.check(&present, &resolved.end)?;
        self.begin(resolved)
    }

    pub(super) fn turn_head(&mut self, pan_rad: f64, tilt_rad: f64) -> Result<(), Unable> {
        self.refusal = None;
        let present = self.present().ok_or(Unable::NotRead)?;
        let joints = vec![self.rig.eyes.pan, self.rig.eyes.tilt];
        self.knows(&joints)?;
        let end = present.with(&joints, &[pan_rad, tilt_rad]);
        self.paths.check(&present, &end)?;
        self.begin(Resolved::of_joints("the head to its next pose".to_owned(), end, joints))
    }

    pub(super) fn begin(&mut self, resolved: Resolved) -> Result<(), Unable> {
        let goals = resolved.joints.iter().map(|joint| (*joint, resolved.end[*joint])).collect();
        let motion = Move { goals, pace: Pace::PeakSpeed(self.peak_speed_rad_s()) };
        self.jog = None;
        let id = self.arm()?.begin(motion)?;
        self.running = Some(Running { id, title: resolved.title });
        Ok(())
    }

    pub(super) fn save_pose(&mut self, title: &str, joints: &[JointIndex]) -> Result<(), Unable> {
        let present = self.present().ok_or(Unable::NotReadToSave)?;
        let all: Vec<JointIndex> = self.rig.servos.iter().map(|servo| servo.joint).collect();
        let joints = if joints.is_empty() { &all } else { joints };
        self.knows(joints)?;
        let rig = self.rig.clone();
        let clamped = |joint: &JointIndex| {
            // An encoder may read half a tick beyond the limit at which it stands.
            let limits = rig.limits(*joint);
            let angle_rad = present[*joint];
            let near = limits.excess_rad(angle_rad).abs() < 0.02;
            (*joint, if near { angle_rad.clamp(limits.lower_rad, limits.upper_rad) } else { angle_rad })
        };
        Ok(self.poses.save(title, joints.iter().map(clamped).collect(), &rig)?)
    }
}
