//! Which joints move with which: where one of a chain is not known, the rest of it must stay.

use plumbline_model::robot::{Description, JointIndex, JointKind, LinkIndex, Rig};

use super::refusal::{Refusal, Unheard};

/// For each joint the joints on the same way from the base to a fingertip.
#[derive(Clone, Debug)]
pub struct Chains(Vec<Vec<bool>>);

impl Chains {
    /// Of a robot.
    pub fn of(description: &Description) -> Self {
        let n = description.movable_count();
        let mut together = vec![vec![false; n]; n];
        for link in 0..description.links().len() {
            let way = way_to(description, LinkIndex(link));
            for a in &way {
                for b in &way {
                    together[a.0][b.0] = true;
                }
            }
        }
        Self(together)
    }

    /// Whether two joints are on one way from the base outward.
    pub fn are_together(&self, a: JointIndex, b: JointIndex) -> bool {
        self.0.get(a.0).and_then(|row| row.get(b.0)).copied().unwrap_or(false)
    }

    /// Whether `joints` may move while it is not known where `unknown` are, `late` among them because
    /// their servos answer too late.
    ///
    /// # Errors
    /// Which joint has to stay, and for which.
    pub fn check(
        &self,
        rig: &Rig,
        joints: &[JointIndex],
        unknown: &[JointIndex],
        late: &[JointIndex],
    ) -> Result<(), Refusal> {
        let why = |joint: JointIndex| match late.contains(&joint) {
            true => Unheard::TooBusy,
            false => Unheard::Silent,
        };
        let name = |joint: JointIndex| match rig.servo_of(joint) {
            Some(servo) => servo.title.clone(),
            None => format!("joint number {}", joint.0),
        };
        for joint in joints {
            if unknown.contains(joint) {
                return Err(Refusal::Unknown { joint: *joint, name: name(*joint), why: why(*joint) });
            }
        }
        for joint in joints {
            if let Some(other) = unknown.iter().find(|other| self.are_together(*joint, **other)) {
                return Err(Refusal::UnknownInChain {
                    joint: *joint,
                    name: name(*joint),
                    unknown: *other,
                    unknown_name: name(*other),
                    why: why(*other),
                });
            }
        }
        Ok(())
    }
}

/// Joints between the base and a link; one that follows another by a tendon counts as that one.
fn way_to(description: &Description, mut link: LinkIndex) -> Vec<JointIndex> {
    let mut way = vec![];
    while let Some(joint) = description.joint_above(link) {
        match &joint.kind {
            JointKind::Fixed => {}
            JointKind::Revolute { index, .. } => way.push(*index),
            JointKind::Coupled { mimic, .. } => way.push(mimic.source),
        }
        link = joint.parent;
    }
    way
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arm_is_one_chain_and_the_head_another() {
        let rig = Rig::built_in("nico").expect("comes with the program");
        let chains = Chains::of(&rig.description);
        let joint = |name| rig.description.find_joint(name).expect("a joint");
        for (a, b, together) in [
            ("r_shoulder_z", "r_elbow_y", true),
            ("r_elbow_y", "r_shoulder_z", true),
            ("r_indexfinger_x", "r_shoulder_y", true),
            ("r_indexfinger_x", "r_thumb_x", false),
            ("head_z", "head_y", true),
            ("head_z", "r_elbow_y", false),
            ("l_elbow_y", "r_elbow_y", false),
        ] {
            assert_eq!(chains.are_together(joint(a), joint(b)), together, "{a} and {b}");
        }
        let refused =
            chains.check(&rig, &[joint("r_elbow_y")], &[joint("r_shoulder_y")], &[]).expect_err("one chain");
        assert!(refused.to_string().contains("not known where Right shoulder swing is"), "{refused}");
        assert!(chains.check(&rig, &[joint("l_elbow_y")], &[joint("r_shoulder_y")], &[]).is_ok());
    }
}
