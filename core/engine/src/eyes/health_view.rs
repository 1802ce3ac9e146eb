//! What ordinary pairs say of the calibrations, for the window.

use std::sync::Arc;
use std::time::Duration;

use jiff::Timestamp;
use plumbline_effects::RobotModel;
use plumbline_vision::health::BEARABLE_M;

use crate::ground::warming::is_cold;

/// What was judged longer ago says nothing of now. Looks that are taken by themselves come sooner, also where they are
/// spaced so that they take little of a processor.
const OLD: Duration = Duration::from_secs(1800);

/// Whether the calibration in use still holds, and whether the proposed one is better, by ordinary pairs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HealthView {
    /// How far it is.
    pub state: HealthState,
    /// What was judged last, also while it is looked at again; `None`: nothing yet, or of other calibrations.
    pub judged: Option<Arc<EyesHealth>>,
    /// When that was, and what has come since.
    pub when: Option<JudgedWhen>,
    /// The eyes are colder than when the calibration in use was made, and as warm after so many minutes: what it is off by
    /// until then says nothing of it. `None`: they are not, or nobody knows.
    pub colder_wait_min: Option<f64>,
    /// The eyes still turn while they warm up, and are warm after so many minutes. `None`: they are, or nobody knows.
    pub cold_for_min: Option<f64>,
    /// Why the calibration in use does not hold any more; `None`: nobody has seen that.
    pub does_not_hold: Option<String>,
}

impl HealthView {
    /// Whether the proposal was judged and was not better: then it is not offered, as long as that stands.
    pub fn is_against_proposal(&self) -> bool {
        let proposed = self.judged.as_ref().and_then(|health| health.proposed);
        matches!(proposed, Some((_, ProposalHealth::Worse | ProposalHealth::Undecided)))
    }
}

/// When a calibration was judged, and what has come since.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgedWhen {
    /// By the clock of this computer.
    pub at: Timestamp,
    /// For how long the eyes had been on by then, min; `None`: nobody knows.
    pub eyes_on_min: Option<f64>,
    /// How far places have moved since near, in the middle and far, m, by watching drift; `None`: that says nothing.
    pub moved_m: Option<[f64; 3]>,
    /// Whether the eyes were colder then than when the calibration in use was made; `None`: nobody knows how warm they
    /// were one of both times.
    pub colder: Option<bool>,
    /// Whether they are as warm by now, or much warmer than then: what was seen then is not what they see.
    pub warmed_since: bool,
}

impl JudgedWhen {
    /// Whether the eyes had been on for too short a time to be warm; `None`: nobody knows.
    pub fn is_cold(&self) -> Option<bool> {
        self.colder.or_else(|| Some(is_cold(self.eyes_on_min?)))
    }

    /// How far places have moved since where that is most, where it is farther than a grasp bears, m: then nothing that
    /// was judged holds any more.
    pub fn moved_too_far_m(&self) -> Option<f64> {
        let worst_m = self.moved_m?.into_iter().fold(0.0, f64::max);
        (worst_m > BEARABLE_M).then_some(worst_m)
    }

    /// How long ago it was. A clock that was set back makes nothing younger than new.
    pub fn age(&self, now: Timestamp) -> Duration {
        Duration::try_from(now.duration_since(self.at)).unwrap_or_default()
    }

    /// Whether nothing that was judged stands any more, neither of the calibration in use nor of a proposal.
    pub fn is_outdated(&self, now: Timestamp) -> bool {
        self.warmed_since || self.moved_too_far_m().is_some() || self.age(now) > OLD
    }
}

/// How far places come out from where they came out first, as far as watching drift can tell.
#[derive(Clone, Debug)]
pub struct Drifted {
    /// Counts watches: each begins with nothing moved.
    pub watch: u64,
    /// What it tells.
    pub told: DriftTold,
}

/// What watching drift tells of how far places have moved.
#[derive(Clone, Debug)]
pub enum DriftTold {
    /// Nothing was seen yet: nothing has moved.
    Nothing,
    /// What was seen is being told with another model: until that has ended nobody knows.
    Anew,
    /// This far.
    Off {
        /// With which model it is told.
        model: Arc<RobotModel>,
        /// Along and across the line of sight near, in the middle and far, m.
        off_m: [[f64; 2]; 3],
    },
}

impl Drifted {
    /// How far places have moved since then (near, in the middle, far), m; where it was not watched then, since watching
    /// began. `None`: nothing was seen since, or nobody knows how far they had moved by then: it was being told anew, or
    /// told with another model.
    pub(super) fn since(&self, then: Option<&Self>) -> Option<[f64; 3]> {
        let DriftTold::Off { model, off_m } = &self.told else { return None };
        let all_m = || Some(off_m.map(|[along_m, across_m]| along_m.hypot(across_m)));
        let Some(then) = then.filter(|then| then.watch == self.watch) else { return all_m() };
        match &then.told {
            DriftTold::Nothing => all_m(),
            DriftTold::Anew => None,
            DriftTold::Off { model: before, off_m: then_m } => Arc::ptr_eq(model, before).then(|| {
                [0, 1, 2].map(|row| {
                    let [along_m, across_m] = [0, 1].map(|axis| off_m[row][axis] - then_m[row][axis]);
                    along_m.hypot(across_m)
                })
            }),
        }
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
