//! How far grasping has come, for who waits for the first good grasp.

use super::view::AttemptView;
use super::workflow::GraspWorkflow;

impl GraspWorkflow {
    /// The newest attempt that the operator saw to be good.
    pub fn held_last(&self) -> Option<&AttemptView> {
        self.attempts.iter().find(|attempt| attempt.told == Some(true))
    }
}
