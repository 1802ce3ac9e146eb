//! What a search for the gap found: plain data, saved as JSON, drawn by panels and reports.

use nalgebra::Isometry3;
use plumbline_effects::measurements::{LeftOut, Unit, What};
use serde::{Deserialize, Serialize};

pub use crate::floor_source::FloorSource;

/// Version of the format of a saved finding. Format 1 had millimeters where this one has meters.
pub const FORMAT: u32 = 2;

/// The answer in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Model and measurement agree within the noise.
    NoGap,
    /// Every effect that was found has one name.
    Named,
    /// An effect was found, but the data cannot tell which of some names it has.
    Class,
    /// There is a gap that no effect of the library explains, see [`Finding::partial`].
    NotInLibrary,
}

/// A misfit so many times what an instrument leaves may be a gap, however it goes with what was logged.
pub(crate) const OPEN_SIGMAS: f64 = 1.0;

impl Finding {
    /// Effects that can be added to a model, by place: those with a name, and those that close a part of
    /// the gap.
    pub fn addable(&self) -> Vec<usize> {
        let allowed = match self.verdict {
            Verdict::Named | Verdict::Class => true,
            Verdict::NotInLibrary => self.partial,
            Verdict::NoGap => false,
        };
        let addable = |i: &usize| allowed && self.effects[*i].not_addable.is_none();
        (0..self.effects.len()).filter(addable).collect()
    }

    /// Whether model and measurement agree. Where nothing told the noise, a gap without a name is no agreement.
    pub fn is_all_clear(&self) -> bool {
        let is_known = self.comparison.is_noise_known() && !self.comparison.is_beyond_instrument();
        self.verdict == Verdict::NoGap && is_known
    }

    /// Whether the question was answered: with a name, or with an agreement within a noise that is known.
    pub fn is_answered(&self) -> bool {
        matches!(self.verdict, Verdict::Named | Verdict::Class) || self.is_all_clear()
    }

    /// How much of the gap closes on rows that were not used; `None` too where nothing tells the noise: what the best
    /// model leaves was taken for it, and against that every model that is found closes all.
    pub fn told_closure(&self) -> Option<f64> {
        self.shown.closure.filter(|_| self.comparison.is_noise_known())
    }
}

/// All that a search found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// Version of the format.
    pub format: u32,
    /// Name of the robot.
    pub rig: String,
    /// Sessions, in their order.
    pub sessions: Vec<String>,
    /// Version of the program.
    pub version: String,
    /// What the search was started with.
    pub seed: u64,
    /// The answer in a word.
    pub verdict: Verdict,
    /// The answer in a sentence or two, for people.
    pub sentence: String,
    /// How far measurement and model lie apart, before anything was added.
    pub comparison: Comparison,
    /// Effects that were found, the largest first. Empty without a gap. With
    /// [`Verdict::NotInLibrary`]: what the rest looks partly like.
    pub effects: Vec<NamedEffect>,
    /// Every candidate with what the data say about it, the most probable first.
    pub candidates: Vec<Candidate>,
    /// The gap before and after on rows that were not used.
    pub shown: Shown,
    /// With [`Verdict::NotInLibrary`]: what was found does not explain the gap, but closes a part of it on
    /// rows that were not used, and can be added as that.
    #[serde(default)]
    pub partial: bool,
    /// Probability that everything is a little off at once, where that is more probable than any few effects: those
    /// found stand for it, and are as sure as they stand out of all the others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub many: Option<f64>,
    /// What stays unexplained.
    pub unexplained: Unexplained,
    /// What of the effects these rows do not tell.
    #[serde(default)]
    pub undetermined: Vec<Undetermined>,
    /// What to measure next; `None` when nothing is left to tell apart.
    pub next: Option<NextExperiment>,
    /// Per session: where its frame lies (screen, external device), fitted with the effects, as
    /// [`plumbline_effects::Assumed::placements`].
    pub placements: Vec<Isometry3<f64>>,
    /// Per session: where the marker sits at the tip, as [`plumbline_effects::Assumed::mounts`]; empty
    /// where every one sits where the description has it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mounts: Vec<Isometry3<f64>>,
    /// Rows that could not be used.
    pub left_out: Vec<LeftOut>,
    /// What is odd about the data, in words: a wrong unit, a constant joint, outliers.
    pub warnings: Vec<String>,
    /// Time that the search took, s.
    pub seconds: f64,
}

/// How far measurement and model lie apart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Rows compared.
    pub rows: usize,
    /// Rows that are no outliers.
    pub rows_kept: usize,
    /// Distinct poses, sides, heights, weights.
    pub cells: usize,
    /// Per kind of measurement.
    pub kinds: Vec<KindComparison>,
    /// Whether the noise floor comes from repeats; else it is approximate.
    pub floor_from_repeats: bool,
    /// Where the noise floor comes from.
    #[serde(default)]
    pub floor_source: FloorSource,
    /// Probability of a lack of fit this large by noise alone, once frames are placed.
    pub p_value: f64,
    /// Residual beyond the floor, in units of the floor.
    pub size_sigmas: f64,
    /// Whether there is a gap: both significant and large enough to matter.
    pub is_gap: bool,
    /// Per row kept or not: place on the table and residual, for maps.
    pub residuals: Vec<Residual>,
}

impl Comparison {
    /// Where the noise floor comes from; files that do not say so say whether it was repeats.
    pub fn floor_from(&self) -> FloorSource {
        if self.floor_from_repeats { FloorSource::Repeats } else { self.floor_source }
    }

    /// Whether the misfit lies so far beyond what an instrument says of itself that the arm itself may scatter so far, or a
    /// gap has no name.
    pub fn is_beyond_instrument(&self) -> bool {
        self.floor_from() == FloorSource::Instrument && self.size_sigmas > OPEN_SIGMAS
    }

    /// Whether anything but the best model tells the noise.
    pub fn is_noise_known(&self) -> bool {
        self.floor_from() != FloorSource::Fitted
    }
}

/// One kind of measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KindComparison {
    /// Which.
    pub what: What,
    /// Per natural coordinate.
    pub coordinates: Vec<CoordinateComparison>,
}

/// One natural coordinate of a kind of measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoordinateComparison {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: Unit,
    /// Root mean square of measured less predicted, frames placed.
    pub rms: f64,
    /// Standard deviation of one measurement about the mean of its repeats.
    pub floor: f64,
    /// Share of the whole squared residual, in units of the floor, 0–1.
    pub share: f64,
}

/// What is left of one row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Residual {
    /// Session, by place in [`Finding::sessions`].
    pub session: usize,
    /// What it measured.
    pub what: What,
    /// Row of its table, from 0.
    pub row: usize,
    /// Block of cross-validation.
    pub set: String,
    /// Where on the table it was measured: robot frame, m.
    pub at_m: [f64; 3],
    /// Measured less predicted without any effect, as a displacement in the robot frame, m: the
    /// frame placed on the other blocks only.
    pub before_m: [f64; 3],
    /// The same with the effects found on the other blocks.
    pub after_m: [f64; 3],
    /// Covariates that can be plotted against it: by place in [`Shown::covariates`].
    pub covariates: Vec<Option<f64>>,
    /// Whether the row was taken as an outlier and not used.
    pub outlier: bool,
}

/// An effect that was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NamedEffect {
    /// Its name on the command line.
    pub id: String,
    /// Where it sits; may be empty.
    pub site: String,
    /// What it is and where, for people.
    pub title: String,
    /// Probability that this name is right.
    pub probability: f64,
    /// Probability that one of its class is right.
    pub class_probability: f64,
    /// Parameters as the command line names them.
    pub parameters: Vec<FoundParameter>,
    /// What of it is no matter of degree: an order, a moment, a time constant; see
    /// [`plumbline_effects::Effect::shape`].
    #[serde(default)]
    pub shape: Option<f64>,
    /// Time since the eyes were switched on at which the calibration that it was found beside holds, s; see
    /// [`plumbline_effects::Effect::reference_s`].
    #[serde(default)]
    pub reference_s: f64,
    /// Parameters as the model takes them, one per [`plumbline_effects::Effect::parameters`].
    pub values: Vec<f64>,
    /// Their covariance, row by row.
    pub covariance: Vec<f64>,
    /// Root mean square of what it does to the rows, in units of the floor.
    pub size_sigmas: f64,
    /// The same in meters on the table; in px where [`Shown::unit`] is [`ShownUnit::Pixel`].
    #[serde(alias = "size_mm")]
    pub size_m: f64,
    /// Every name that the data cannot tell from this one, as `id@site`, itself first.
    pub class: Vec<ClassMember>,
    /// Names that act in these rows as a part of this effect does: they may be there beside it, with as much less of it.
    /// `probability` is that of each being there.
    #[serde(default)]
    pub beside: Vec<ClassMember>,
    /// What experiment would tell them apart; `None` where the class has one member.
    pub split_by: Option<String>,
    /// The best name outside of the class, and how much less probable it is (log₁₀ of the odds
    /// against it, positive).
    pub runner_up: Option<(String, f64)>,
    /// Why it cannot be added although it was found, if so (its fit sits at a bound, say).
    pub not_addable: Option<String>,
}

/// Parameters that the rows do not tell apart, or do not show at all. Their values stay near what is
/// expected beforehand, and their intervals are as wide as that.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Undetermined {
    /// `id@site.parameter` of each. Of several only some combination is told.
    pub parameters: Vec<String>,
    /// In words, with what would tell.
    pub words: String,
}

/// A name that the data cannot rule out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClassMember {
    /// Effect.
    pub id: String,
    /// Where.
    pub site: String,
    /// For people.
    pub title: String,
    /// Its share of the class's probability.
    pub probability: f64,
}

/// A parameter with its 95 % interval.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FoundParameter {
    /// Name with the unit, as on the command line.
    pub name: String,
    /// Value.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// A joint that the parameter speaks of (`from_joint`), where it does.
    pub text: Option<String>,
}

impl FoundParameter {
    /// Whether its interval excludes zero, or it is no number, or one of which zero is no absence.
    pub fn is_told(&self) -> bool {
        self.text.is_some() || self.name.ends_with("phase_rad") || self.low * self.high > 0.0
    }
}

/// What the data say about a candidate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Candidate {
    /// Effect.
    pub id: String,
    /// Where.
    pub site: String,
    /// For people.
    pub title: String,
    /// Probability that it is there.
    pub probability: f64,
    /// How far the residual, all else absent, points its way, in standard deviations.
    pub score_sigmas: f64,
    /// What the data can say about it.
    pub knowledge: Knowledge,
}

/// What the data can say about a candidate.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "is", content = "with")]
pub enum Knowledge {
    /// It would do nothing to these rows.
    Dead,
    /// It would do less than the noise.
    Flat,
    /// It is seen only together with others (`id@site`): they can trade against each other.
    TradeOff(Vec<String>),
    /// Its size is hardly better known after than before.
    NotPinned,
    /// Its fit sits at the end of what is plausible.
    AtBound,
    /// Its size is known.
    Known,
}

/// The gap before and after, each row judged by a model that was found without its block.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shown {
    /// How the blocks were made, in words ("5 folds, whole sets").
    pub blocks: String,
    /// Number of rows judged.
    pub rows: usize,
    /// Unit of the numbers below.
    pub unit: ShownUnit,
    /// Mean error without any effect (frame placed).
    pub before: f64,
    /// Mean error with the effects found.
    pub after: f64,
    /// Mean error that noise alone would leave.
    pub floor: f64,
    /// (before − after) / (before − floor); `None` where there is nothing to close.
    pub closure: Option<f64>,
    /// Its 95 % interval over blocks.
    pub closure_range: Option<[f64; 2]>,
    /// Mean error of the worst tenth of rows, before and after.
    pub worst_tenth: [f64; 2],
    /// Share of held-out coordinates within the predicted 95 % interval.
    pub inside_95: f64,
    /// The same on a condition (weight, height, side) that was held out as a whole, where there is
    /// one: its name, before, after, floor.
    pub unseen: Option<Unseen>,
    /// The same with what may be added alone; `None` where that is all that was found, or nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<Part>,
    /// Names and units of [`Residual::covariates`].
    pub covariates: Vec<(String, String)>,
    /// Which of them gave the effects away, by place, the strongest first.
    pub telling: Vec<usize>,
}

/// Unit of held-out errors: meters, or image pixels where only pixels were measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShownUnit {
    /// Error in the plane of screen or table for touches and places, in space for poses.
    #[serde(alias = "millimeter")]
    Meter,
    /// Of image points.
    Pixel,
}

/// What rows that were not used show with those effects alone that may be added.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Mean error with them, in the unit of [`Shown`].
    pub after: f64,
    /// As [`Shown::closure`].
    pub closure: Option<f64>,
    /// As [`Shown::closure_range`].
    pub closure_range: Option<[f64; 2]>,
    /// Mean error with them on the condition of [`Shown::unseen`].
    pub unseen_after: Option<f64>,
}

/// A condition that was held out as a whole.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unseen {
    /// What it is, in words ("with a weight of 250 g").
    pub what: String,
    /// Rows.
    pub rows: usize,
    /// Mean error before.
    pub before: f64,
    /// Mean error after.
    pub after: f64,
    /// Mean error that noise alone would leave.
    pub floor: f64,
}

/// What stays unexplained.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unexplained {
    /// Probability of what is left by noise (and small dirt) alone.
    pub p_value: f64,
    /// Probability that something is at work that is not in the library.
    pub probability: f64,
    /// What the rest depends on, the strongest first; empty when nothing was found.
    pub depends_on: Vec<Dependence>,
    /// How much of the gap is left, 0–1.
    pub share: f64,
}

/// A covariate that the rest depends on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Dependence {
    /// The covariate, for people ("angle of the elbow").
    pub on: String,
    /// What depends on it ("turn of the elbow", "along u").
    pub of: String,
    /// Share of what is left that it explains, 0–1.
    pub share: f64,
    /// A simple formula for it, in words, where one was found.
    pub formula: Option<String>,
}

/// What to measure next.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NextExperiment {
    /// In words ("repeat ten poses with a 250 g payload").
    pub what: String,
    /// Why, in words: which names it tells apart, or what it pins down.
    pub why: String,
    /// Which of the menu.
    pub kind: Experiment,
    /// Number of measurements.
    pub count: usize,
    /// Time that it takes, minutes.
    pub minutes: f64,
    /// How likely the most probable names are the right ones after it.
    pub expected_probability: f64,
    /// The others of the menu, the best first: what, expected probability, minutes.
    pub others: Vec<(String, f64, f64)>,
}

/// Experiments that an operator can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Experiment {
    /// Touches approached from the other side.
    OtherSide,
    /// A known weight at the palm.
    Weight,
    /// The screen on a block.
    RaisedScreen,
    /// The same places with another posture of the elbow.
    OtherPosture,
    /// Slower moves.
    Slower,
    /// Cold and warm.
    ColdAndWarm,
    /// The same commands again, for the noise floor.
    Repeats,
    /// More of the same, spread wider.
    MorePlaces,
    /// A card behind the hand.
    CardBehind,
    /// Places at another distance from the eyes.
    OtherDistance,
    /// The same places with the head turned.
    HeadTurned,
    /// Log encoders again a second after contact.
    LogLater,
}
