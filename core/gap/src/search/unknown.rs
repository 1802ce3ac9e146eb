//! Whether something is at work that no name stands for.

use plumbline_effects::Kind;

use super::explore::Model;
use super::naming::Evidence;
use super::variants::UNKNOWN_CELL;
use crate::beforehand::MASS_SD;
use crate::compare::f_tail;
use crate::finding::FloorSource;

/// A rival counts as something unknown when it does this to the rows, and this share of all.
const RIVAL_SIZE: f64 = 0.4;
const RIVAL_SHARE: f64 = 0.15;
/// One that does so many times what formulas may leave is none of their error.
const RIVAL_FAR: f64 = 2.0;
/// Where the noise is whatever the best model leaves, nothing says that the library leaves more than noise. There a rival
/// counts when it closes this share of the gap (squares) that the library's best set leaves open, or as much as counts
/// elsewhere against what it leaves itself.
const RIVAL_CLOSES: f64 = 0.2;
/// And only where the library leaves more than noise and dirt would, with this probability.
pub(crate) const RIVAL_P: f64 = 0.02;
/// Lack of fit that vetoes names: probability by chance, and how much larger than noise the rest is.
pub(crate) const VETO_P: f64 = 1e-4;
const VETO_SIZE: f64 = 0.45;
/// Formulas are right to this share of what they explain: what is left below it is theirs, as for rivals.
const FORMULA_SHARE: f64 = RIVAL_SHARE;
/// Optics hold closer: what the right names of one or two effects of the eyes left was at most 0.06 of gaps of six floors and
/// more in 45 development cases of the blind test, where six of 41 gaps that no name stands for left 0.09 to 0.15.
const OPTICS_SHARE: f64 = 0.07;
/// A drag is right to this share of itself: no log holds the speeds of joints, and a finger bounces. Of how far a finger slid in
/// the physics of the blind test, without noise and against where it touched first, its best formula left 0.31 to 0.47 (three
/// servos, 20 to 80 ms); with a servo's friction up to 0.56. Stick-slip that was taken for a drag left 0.75 and more.
const DRAG_SHARE: f64 = 0.6;
/// What a load does is right to this share of itself: nobody weighed the links, and a torque is that of the description's masses.
const LOAD_SHARE: f64 = 1.5 * MASS_SD;
/// A log that is early is right to this share of itself: joints slow down on their way. Of such logs that physics left 0.04 to
/// 0.18.
const EARLY_SHARE: f64 = 0.2;
/// Cells off by this, dirt, are no lack of fit.
const TOLERATED_CELL: f64 = 0.2;

impl Evidence<'_> {
    /// How probable it is that something is at work that no name stands for, and that what the library's best set leaves
    /// is noise and dirt alone.
    pub(super) fn unknown(&self) -> (f64, f64) {
        let models = &self.explored.models;
        let top: Vec<usize> = models.first().map_or(vec![], |model| self.of_library(model));
        // What stays unexplained is what the library's best set leaves.
        let of_library = models.iter().find(|model| model.set.iter().all(|&block| block < self.look.effects));
        let (p_value, left) = self.lack_of_fit(of_library.map_or(&top, |model| &model.set));
        let best = self.alone.and_then(|alone| alone.models.first()).or(of_library);
        let of_formulas = self.left_by_formulas(best);
        let large = of_formulas.max(RIVAL_SIZE);
        // Few parameters that close as much as many speak for themselves where no set without them is left in the window, unless
        // every joint is off by itself anyway.
        let has_family = best.is_some_and(|best| self.has_family(best));
        let is_needed = of_library.is_none() && !has_family;
        let counts = |model: &&Model| match self.floor.source {
            FloorSource::Fitted => is_needed && self.has_rival(model) || self.closes_more(model, best),
            // Where formulas err by no more than this, a rival that does little more only follows their error.
            _ => {
                let does = self.rival_does(model);
                p_value < RIVAL_P && does > large && (left > of_formulas || does > RIVAL_FAR * large)
            }
        };
        let rival: f64 = models.iter().filter(counts).map(|model| model.probability).sum();
        let softens: f64 = models
            .iter()
            .filter(|model| self.softens_instead(model, best))
            .map(|model| model.probability)
            .sum();
        let vetoed = p_value < VETO_P && left > of_formulas.max(VETO_SIZE);
        // Cells are tried at a few sizes; what the best set leaves says how far they are off.
        let white = if left > of_formulas { self.white(of_formulas) } else { 0.0 };
        let unknown = rival.max(softens).max(if vetoed { 0.95 } else { 0.0 }).max(white).min(1.0);
        (unknown, p_value)
    }

    /// Probability by noise alone of what frames leave.
    pub(super) fn p_bare(&self) -> f64 {
        let free = self.look.total - self.look.within.1 - self.look.gauge as f64;
        if free < 1.0 {
            return 1.0;
        }
        f_tail((self.look.plain.square - self.look.within.0) / free, free, self.floor_freedom())
    }

    fn floor_freedom(&self) -> f64 {
        let kinds = self.floor.kinds.iter();
        kinds.map(|kind| kind.degrees_of_freedom * kind.sd.len() as f64).sum::<f64>().max(4.0)
    }

    fn has_family(&self, model: &Model) -> bool {
        model.set.iter().any(|&block| self.look.blocks[block].is_family)
    }

    fn has_rival(&self, model: &Model) -> bool {
        model.set.iter().any(|&block| block >= self.look.effects)
    }

    /// What formulas may leave of what they explain, in floors: a share of the gap, and more of a drag and of an early log.
    fn left_by_formulas(&self, set: Option<&Model>) -> f64 {
        let of_its_own = |model: &Model| {
            let set = self.of_library(model);
            let share = |&block: &usize| match self.look.blocks[block].kind {
                Some(Kind::TouchDrag) => DRAG_SHARE,
                Some(Kind::EarlyLog) => EARLY_SHARE,
                Some(kind) if kind.is_of_load() => LOAD_SHARE,
                _ => 0.0,
            };
            let values = self.values(&set);
            let left = set.iter().zip(&values).map(|(block, (own, _))| (share(block), *block, own));
            // Of two that make up for each other only what is left of both goes by their formulas.
            let beside =
                |block: usize| set.iter().copied().filter(|&other| other != block).collect::<Vec<_>>();
            left.filter(|(share, ..)| *share > 0.0)
                .map(|(share, block, own)| share * self.look.does_beyond(block, own, &beside(block)))
                .fold(0.0, f64::max)
        };
        let by_eyes = self.floor.kinds.iter().all(|kind| !kind.what.is_placed());
        let share = if by_eyes { OPTICS_SHARE } else { FORMULA_SHARE };
        (share * self.look.gap()).max(set.map_or(0.0, of_its_own))
    }

    /// Whether a set has a joint that gives way the more the warmer it is, where the library's best set has both a joint that
    /// gives way and its zero that wanders with the heat: one thing in the place of two.
    fn softens_instead(&self, model: &Model, of_library: Option<&Model>) -> bool {
        let rivals = model.set.iter().filter_map(|block| block.checked_sub(self.look.effects));
        let Some(site) = rivals.filter_map(|rival| self.look.rivals[rival].softens.as_deref()).next() else {
            return false;
        };
        let has = |model: &Model, kind: Kind| {
            let is = |&block: &usize| {
                let effect = &self.library.effects[block];
                effect.kind == kind && effect.site == site
            };
            self.of_library(model).iter().any(is)
        };
        let both = |model: &Model| has(model, Kind::JointSag) && has(model, Kind::ServoWarmUp);
        of_library.is_some_and(both) && !both(model)
    }

    /// What a rival in the set does to the rows that nothing of the library beside it can, in floors; zero without one.
    fn rival_does(&self, model: &Model) -> f64 {
        let Some(place) = model.set.iter().position(|&block| block >= self.look.effects) else { return 0.0 };
        let (rival, others) = (model.set[place], self.of_library(model));
        self.values(&model.set).get(place).map_or(0.0, |(own, _)| self.look.does_beyond(rival, own, &others))
    }

    /// Whether a set with a rival closes enough of the gap that the library's best set leaves open: both against what
    /// the rival leaves, which is the nearest to the noise that there is.
    fn closes_more(&self, model: &Model, of_library: Option<&Model>) -> bool {
        let Some((field, library)) = self.look.fields.get(self.look.likely(self.explored)).zip(of_library)
        else {
            return false;
        };
        // Where every joint is off by itself, one more that is off is no other thing: it is a class already.
        if self.has_family(library) || !self.has_rival(model) {
            return false;
        }
        let left = |set: &[usize]| field.given(set, &self.look.packed).square_left() - self.look.within.0;
        let (bare, with) = (left(&[]), left(&model.set));
        let closes = left(&library.set) - with;
        let share = closes / (bare - with).max(f64::MIN_POSITIVE);
        share > RIVAL_CLOSES || share > RIVAL_SHARE.powi(2) && closes > RIVAL_SIZE.powi(2) * with
    }

    /// Probability that every cell is off by an own large amount, and by more than formulas may leave (floors).
    fn white(&self, of_formulas: f64) -> f64 {
        let fields = self.look.fields.iter().zip(&self.explored.variants);
        let is_large = |cell: f64| cell >= UNKNOWN_CELL && cell > of_formulas;
        fields.filter(|(field, _)| is_large(field.variant.cell)).map(|(_, share)| share).sum()
    }

    /// Lack of fit of a set: probability by noise and dirt alone, and what is left beyond noise, in
    /// floors.
    fn lack_of_fit(&self, set: &[usize]) -> (f64, f64) {
        let tolerated = |cell: f64| (cell - TOLERATED_CELL).abs();
        let field = self.look.fields.iter().min_by(|a, b| {
            let key = |field: &super::field::Field| {
                let variant = field.variant;
                tolerated(variant.cell) + (variant.noise - 1.0).abs() + (variant.size - 3.0).abs()
                    - variant.dirt
            };
            key(a).total_cmp(&key(b))
        });
        let Some(field) = field else { return (1.0, 0.0) };
        let columns: usize = set.iter().map(|&block| self.look.blocks[block].len).sum();
        let left = field.given(set, &self.look.packed).square_left() - self.look.within.0;
        let free = self.look.total - self.look.within.1 - self.look.gauge as f64 - columns as f64;
        if free < 1.0 {
            return (1.0, 0.0);
        }
        let ratio = left / free;
        let repeats = self.look.total / (self.look.total - self.look.within.1);
        (f_tail(ratio, free, self.floor_freedom()), ((ratio - 1.0).max(0.0) / repeats).sqrt())
    }
}
