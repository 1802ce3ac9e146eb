//! What ordinary pairs say of the calibrations, for the window.

use std::sync::Arc;

/// Whether the calibration in use still holds, and whether the proposed one is better, by ordinary pairs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HealthView {
    /// How far it is.
    pub state: HealthState,
    /// What was judged last, also while it is looked at again; `None`: nothing yet, or of other calibrations.
    pub judged: Option<Arc<EyesHealth>>,
    /// The eyes are colder than when the calibration in use was made, and as warm after so many minutes: what it is off by
    /// until then says nothing of it. `None`: they are not, or nobody knows.
    pub colder_wait_min: Option<f64>,
}

impl HealthView {
    /// Whether the proposal was judged and is not better: then it is not offered.
    pub fn is_against_proposal(&self) -> bool {
        let proposed = self.judged.as_ref().and_then(|health| health.proposed);
        matches!(proposed, Some((_, ProposalHealth::Worse | ProposalHealth::Undecided)))
    }
}

/// How far judging is.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum HealthState {
    /// Nobody asked, of the calibrations as they are now.
    #[default]
    NotAsked,
    /// Pairs are gathered.
    Gathering {
        /// So many.
        pairs: usize,
        /// Of so many.
        of: usize,
    },
    /// It is being computed.
    Judging,
    /// Judged.
    Judged(Arc<EyesHealth>),
    /// The pairs say nothing: why, a sentence.
    Failed(String),
}

/// What ordinary pairs say of the calibrations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EyesHealth {
    /// Of the one in use.
    pub in_use: HealthFigures,
    /// Of the proposed one, and whether it is better.
    pub proposed: Option<(HealthFigures, ProposalHealth)>,
    /// Pairs that were looked at.
    pub pairs: usize,
    /// Places that both eyes saw.
    pub places: usize,
}

/// How one calibration does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HealthFigures {
    /// Whether it is still good: nowhere on the table off by more than a grasp bears, as far as can be told.
    pub is_good: bool,
    /// How far off it puts places near, in the middle and far, m.
    pub off_m: [f64; 3],
    /// One standard deviation of each, m.
    pub sigma_m: [f64; 3],
    /// How far the right eye has turned against the left one since, rad.
    pub turn_rad: f64,
    /// How far places leave its epipolar planes, rms, px.
    pub epipolar_px: f64,
}

/// Whether a proposed calibration is better than the one in use, beyond doubt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProposalHealth {
    /// It is.
    Better,
    /// The one in use is.
    Worse,
    /// They cannot be told apart.
    Undecided,
    /// The eyes are another distance apart with it, which ordinary pairs do not show.
    Untold,
    /// They cannot be told apart, but it alone says for how long the cameras had been on: a correction by time needs
    /// that.
    KnowsWhen,
}
