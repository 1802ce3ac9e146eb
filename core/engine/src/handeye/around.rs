//! What tying the arms to the eyes can see of the rest.

use std::path::PathBuf;
use std::sync::Arc;

use plumbline_effects::RigModel;

use crate::grasp::GraspAround;
use crate::grasp::view::{HandWaits, InHand};
use crate::twin::view::TwinView;

/// What the workflow can see of the rest.
pub struct HandEyeAround {
    /// What a grasp sees: the robot, its eyes, what was calibrated.
    pub grasp: GraspAround,
    /// The model in use; `None`: it was not read yet, or cannot be used.
    pub added: Option<Arc<RigModel>>,
    /// Whether that model is being changed.
    pub is_changing: bool,
    /// The session of touches that the model was learned from; `None`: there is none.
    pub touches: Option<PathBuf>,
    /// Where sessions of this lab are looked for.
    pub sessions: PathBuf,
    /// What is in a hand, which would be opened.
    pub held: Option<InHand>,
    /// How the hand was left that moved last, where that matters.
    pub waits: Option<HandWaits>,
    /// The twin, where its arm is connected.
    pub twin: Option<Arc<TwinView>>,
}
