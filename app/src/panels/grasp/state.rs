//! How grasping is looked at.

use plumbline_engine::GraspTarget;

use super::experiment::Drafted;

/// How grasping is looked at: kept from frame to frame, never saved.
#[derive(Clone, Debug)]
pub struct GraspPanels {
    /// Where along the planned motion the ghost stands, 0–1.
    pub along: f64,
    /// What would be chosen where the pointer is in the scene.
    pub pointed: Option<GraspTarget>,
    /// The attempt that the inspector speaks of, by name; `None`: the newest.
    pub chosen: Option<String>,
    /// The experiment that is being put together.
    pub experiment: Drafted,
    /// The method on its map, by place.
    pub experiment_method: usize,
}

impl Default for GraspPanels {
    /// The ghost stands at the end of the way.
    fn default() -> Self {
        Self { along: 0.7, pointed: None, chosen: None, experiment: Drafted::default(), experiment_method: 0 }
    }
}
