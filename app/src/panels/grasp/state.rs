//! How grasping is looked at.

/// How grasping is looked at: kept from frame to frame, never saved.
#[derive(Clone, Debug)]
pub struct GraspPanels {
    /// Where along the planned motion the ghost stands, 0–1.
    pub along: f64,
    /// The attempt that the inspector speaks of, by name; `None`: the newest.
    pub chosen: Option<String>,
}

impl Default for GraspPanels {
    /// The ghost stands at the end of the way.
    fn default() -> Self {
        Self { along: 0.7, chosen: None }
    }
}
