//! Candidates and free-form rivals as blocks of columns.

use std::collections::{BTreeMap, BTreeSet};

use plumbline_effects::measurements::Measurements;
use plumbline_effects::{Effect, Kind};

use crate::finding::FloorSource;
use crate::floor::Floor;
use crate::options::Options;

/// A block of columns that is in the model or not, as a whole.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// First column.
    pub start: usize,
    /// Number of columns.
    pub len: usize,
    /// Number of its kind; `None` of what is in no library.
    pub kind: Option<Kind>,
    /// Whether it stands for every joint or link at once.
    pub is_family: bool,
    /// Whether every encoder was logged early by it, by one share of what was left to go.
    pub is_of_all: bool,
    /// Whether its value is never negative.
    pub is_one_sided: bool,
    /// What it does alike with others in the course of time.
    pub grows: Option<Grows>,
    /// Number of its name. Two blocks of one name (shapes of one effect) are never in together.
    pub name: usize,
    /// How much it is trusted beforehand, log of the odds.
    pub log_prior: f64,
}

/// What some do alike in the course of time: two of them would cancel each other, so one is there at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Grows {
    /// The right eye turns sideways, or its image shifts.
    Sideways,
    /// The right eye rolls and pitches, or both nod with what carries them, where rows do not tell which.
    Nodding,
}

impl Grows {
    fn of(effect: &Effect, roll_shows: bool) -> Option<Self> {
        effect.growth()?;
        match effect.kind {
            Kind::EyeYaw | Kind::ImageShift => Some(Self::Sideways),
            Kind::EyeRoll | Kind::CameraMount if !roll_shows => Some(Self::Nodding),
            _ => None,
        }
    }
}

impl Block {
    /// Whether it cannot be there together with another one: two shapes of one name, or a family with one of
    /// its members.
    pub fn excludes(&self, other: &Self) -> bool {
        let of_one_kind = self.kind.is_some() && self.kind == other.kind;
        // One eye that is off and the other one as well, each by its own, is neither.
        let is_of_one_eye = of_one_kind && self.kind.is_some_and(Kind::is_of_one_eye);
        self.name == other.name
            || is_of_one_eye
            || self.grows.is_some() && self.grows == other.grows
            || of_one_kind && self.is_family != other.is_family
    }

    /// Its columns.
    pub fn columns(&self) -> std::ops::Range<usize> {
        self.start..self.start + self.len
    }
}

/// How much less probable it is beforehand that every joint is wrong than that one is.
const EVERY_SITE: f64 = 0.05;

/// How much less probable it is beforehand that one joint was logged too early while the others were not: all
/// encoders are read in one pass. What lags behind its command by the same amount in every pose, and the finger
/// does not, is the play of an encoder's drive.
const ONE_LOGGED_EARLY: f64 = 0.002;
/// Play that gravity closes: how probable it is that the load turns over about where the description has it. Its other
/// shapes are for robots whose rows say so.
const LOAD_AS_DESCRIBED: f64 = 0.85;

/// A joint that another one pulls along: how probable it is that this is the one before it, whose cable or gear runs through
/// its own. The others have the rest in common, and the first joint has none but those.
const BY_THE_ONE_BEFORE: f64 = 0.7;

/// How probable it is that what is off about eyes is so all the while, where the rows could show one that grows as they warm up:
/// a grid of a few minutes shows the dozen time constants that are tried for one thing.
const CONSTANT: f64 = 0.7;

/// Beside all of them it is usual: a joint that carries more settles later, so more of its way was left.
const ONE_LATER_THAN_ALL: f64 = 0.3;

/// Shapes (moments in s, torques in N m, orders) closer than this are the same.
const SAME_SHAPE: f64 = 1e-6;

/// How much less probable every further eye is that was knocked while one set was measured, than the first: one accident
/// says nothing of another one. An eye that stood otherwise in several sets follows something else.
const KNOCKED_AGAIN: f64 = 0.02;

/// How much more probable beforehand a set is for what goes together in it, log.
pub(super) fn together(set: &[usize], blocks: &[Block]) -> f64 {
    let count = |kind: Kind| set.iter().filter(|&&block| blocks[block].kind == Some(kind)).count();
    let again = count(Kind::EyeKnock).saturating_sub(1);
    let of_knocks = again as f64 * KNOCKED_AGAIN.ln();
    if !set.iter().any(|&block| blocks[block].is_of_all) {
        return of_knocks;
    }
    let later = count(Kind::EarlyLog) - 1;
    of_knocks + later as f64 * (ONE_LATER_THAN_ALL / ONE_LOGGED_EARLY).ln()
}

/// The candidates of a search.
#[derive(Clone, Debug)]
pub(super) struct Library {
    /// Effects in their shapes.
    pub effects: Vec<Effect>,
    /// One per effect.
    pub blocks: Vec<Block>,
    /// Distinct names.
    pub names: Vec<String>,
    /// Columns in all.
    pub columns: usize,
}

impl Library {
    /// What the rows could show and the lab does not rule out.
    pub fn of(measurements: &Measurements, floor: &Floor, options: &Options) -> Self {
        // A ripple looks like noise: where nothing tells the noise, it would explain anything.
        let noise_is_known = floor.source != FloorSource::Fitted;
        let ruled_out = |effect: &Effect| {
            options.ruled_out.iter().any(|out| *out == effect.id() || *out == effect.name())
                || (effect.kind == Kind::ToothRipple && !noise_is_known)
        };
        let effects =
            Effect::candidates(measurements).into_iter().filter(|effect| !ruled_out(effect)).collect();
        Self::with(effects, measurements.roll_shows())
    }

    /// The same with more shapes of these effects, between their neighbors; what is there keeps its place. `None`
    /// where all of them are there already.
    pub fn finer(&self, measurements: &Measurements, found: &[Effect]) -> Option<Self> {
        let shapes = found.iter().filter(|effect| effect.shape.is_some());
        let refined = shapes.flat_map(|effect| effect.refined(measurements));
        let is_known = |effect: &Effect| {
            let same = |known: &Effect| {
                let apart = known.shape.zip(effect.shape).map_or(0.0, |(one, other)| (one - other).abs());
                known.kind == effect.kind && known.site == effect.site && apart < SAME_SHAPE
            };
            self.effects.iter().any(same)
        };
        let more: Vec<Effect> = refined.filter(|effect| !is_known(effect)).collect();
        (!more.is_empty()).then(|| {
            Self::with(self.effects.iter().cloned().chain(more).collect(), measurements.roll_shows())
        })
    }

    /// Of these effects; `roll_shows`: see [`Measurements::roll_shows`].
    pub fn with(effects: Vec<Effect>, roll_shows: bool) -> Self {
        let mut names: Vec<String> = vec![];
        let mut blocks: Vec<Block> = vec![];
        let mut start = 0;
        for effect in &effects {
            let own = effect.name();
            let name = names.iter().position(|name| *name == own).unwrap_or_else(|| {
                names.push(own);
                names.len() - 1
            });
            let len = effect.parameters().len();
            let (kind, is_family) = (Some(effect.kind), effect.is_of_every_site());
            let is_of_all = effect.kind == Kind::EarlyLog && effect.site.is_empty();
            let is_one_sided = len == 1 && (effect.kind.is_one_sided() || is_of_all);
            blocks.push(Block {
                start,
                len,
                kind,
                is_family,
                is_of_all,
                is_one_sided,
                grows: Grows::of(effect, roll_shows),
                name,
                log_prior: 0.0,
            });
            start += len;
        }
        let mut shapes = vec![0_usize; names.len()];
        let mut growths = vec![0_usize; names.len()];
        for (block, effect) in blocks.iter().zip(&effects) {
            shapes[block.name] += 1;
            growths[block.name] += usize::from(effect.growth().is_some());
        }
        // One expected effect in all; an effect with many shapes is not more probable for it, and all others are not less so
        // for a name that rows do not tell from another one.
        let nodding: BTreeSet<usize> = blocks
            .iter()
            .filter(|block| block.grows == Some(Grows::Nodding))
            .map(|block| block.name)
            .collect();
        // One eye or the other is one thing that can be wrong.
        let mut eyes_of = BTreeMap::<Kind, BTreeSet<usize>>::new();
        for (block, effect) in blocks.iter().zip(&effects).filter(|(_, effect)| effect.kind.is_of_one_eye()) {
            eyes_of.entry(effect.kind).or_default().insert(block.name);
        }
        let same: usize = eyes_of.values().map(|names| names.len() - 1).sum();
        let told = names.len() - nodding.len().saturating_sub(1) - same;
        let odds = 1.0 / (told as f64).max(2.0);
        for (block, effect) in blocks.iter_mut().zip(&effects) {
            let alone = effect.kind == Kind::EarlyLog && !effect.site.is_empty();
            let many = match (effect.is_of_every_site(), alone) {
                (true, _) => EVERY_SITE,
                (_, true) => ONE_LOGGED_EARLY,
                (false, false) => 1.0,
            };
            let one_of = eyes_of.get(&effect.kind).map_or(1, BTreeSet::len) as f64;
            let others = shapes[block.name] - 1;
            let growing = growths[block.name];
            let may_grow = growing > 0 && growing <= others;
            let share = match (effect.kind, effect.shape) {
                (Kind::GravityBacklash, None) if others > 0 => LOAD_AS_DESCRIBED,
                (Kind::GravityBacklash, Some(_)) => (1.0 - LOAD_AS_DESCRIBED) / others.max(1) as f64,
                (Kind::JointCoupling, _) if effect.is_pulled_by_the_one_before() => BY_THE_ONE_BEFORE,
                (Kind::JointCoupling, _) => (1.0 - BY_THE_ONE_BEFORE) / others.max(1) as f64,
                _ if may_grow && effect.growth().is_none() => CONSTANT / (others + 1 - growing) as f64,
                _ if may_grow => (1.0 - CONSTANT) / growing as f64,
                _ => 1.0 / (others + 1) as f64,
            };
            block.log_prior = (many * odds * share / one_of).ln();
        }
        Self { effects, blocks, names, columns: start }
    }
}

#[cfg(test)]
mod tests {
    use plumbline_effects::arm::Arm;
    use plumbline_model::robot::Rig;

    use super::*;

    #[test]
    fn a_family_is_not_there_beside_one_of_its_members() {
        let rig = Rig::built_in("nico").expect("comes along");
        let arm = Arm::of_rig(&rig, "right_index_tip").expect("an arm");
        let of = |kind: Kind| Effect::sites(kind, Some(&arm), None);
        let library = Library::with([of(Kind::JointZero), of(Kind::AxisSkew)].concat(), true);
        let place = |kind: Kind, family: bool| {
            let wanted = |effect: &Effect| effect.kind == kind && effect.is_of_every_site() == family;
            &library.blocks[library.effects.iter().position(wanted).expect("in the library")]
        };
        let (zeros, zero) = (place(Kind::JointZero, true), place(Kind::JointZero, false));
        assert!(zeros.excludes(zero) && zero.excludes(zeros));
        assert!(!zeros.excludes(place(Kind::AxisSkew, false)) && !zero.excludes(place(Kind::AxisSkew, true)));
    }

    #[test]
    fn a_joint_is_pulled_along_by_the_one_before_rather_than_by_any_other() {
        let rig = Rig::built_in("nico").expect("comes along");
        let arm = Arm::of_rig(&rig, "right_index_tip").expect("an arm");
        let with_others = |effect: Effect| {
            let others = (1..arm.len() - 1).map(|other| effect.clone().with_shape(Some(other as f64)));
            std::iter::once(effect.clone()).chain(others).collect::<Vec<_>>()
        };
        let couplings = Effect::sites(Kind::JointCoupling, Some(&arm), None);
        let library = Library::with(couplings.into_iter().flat_map(with_others).collect(), true);
        let of_name = |name: usize| {
            let own = library.blocks.iter().filter(move |block| block.name == name);
            own.map(|block| block.log_prior.exp()).collect::<Vec<_>>()
        };
        let [first, second] = [of_name(0), of_name(1)];
        let odds = second.iter().sum::<f64>();
        assert!((second[0] / odds - BY_THE_ONE_BEFORE).abs() < 1e-9, "{second:?}");
        assert!(first.iter().all(|own| *own < 0.2 * second[0]), "none is before it: {first:?}");
    }

    #[test]
    fn one_eye_or_the_other_is_off_and_no_likelier_for_being_two() {
        let rig = Rig::built_in("nico").expect("comes along");
        let eyes = plumbline_effects::eyes::Eyes::of_rig(&rig).expect("eyes");
        let of = |kind: Kind| Effect::sites(kind, None, Some(&eyes));
        let library = Library::with([of(Kind::ImageShift), of(Kind::EyeYaw)].concat(), true);
        let [right, left, yaw] = &library.blocks[..] else { panic!("two images and one turn") };
        assert!(right.excludes(left) && !right.excludes(yaw));
        let both = (right.log_prior.exp() + left.log_prior.exp()).ln();
        assert!((both - yaw.log_prior).abs() < 1e-9, "{both} {}", yaw.log_prior);
    }

    #[test]
    fn one_eye_that_nods_and_both_are_one_where_rows_do_not_tell_which() {
        let rig = Rig::built_in("nico").expect("comes along");
        let eyes = plumbline_effects::eyes::Eyes::of_rig(&rig).expect("eyes");
        let of = |kind: Kind, grows: bool| {
            let effect = Effect::sites(kind, None, Some(&eyes)).swap_remove(0);
            if grows { effect.with_shape(Some(Effect::late_growth(300.0, 0.0))) } else { effect }
        };
        let all =
            [(Kind::EyeRoll, true), (Kind::CameraMount, true), (Kind::EyeRoll, false), (Kind::EyeYaw, true)];
        let library =
            |roll_shows| Library::with(all.map(|(kind, grows)| of(kind, grows)).to_vec(), roll_shows).blocks;
        let (told, alike) = (library(true), library(false));
        assert!(!told[0].excludes(&told[1]) && alike[0].excludes(&alike[1]) && alike[1].excludes(&alike[0]));
        // What does not grow, and what turns sideways, is another thing.
        assert!(!alike[1].excludes(&alike[2]) && !alike[0].excludes(&alike[3]));
        // An eye that turns is no less probable for it.
        assert!(alike[3].log_prior > told[3].log_prior);
    }

    #[test]
    fn an_eye_that_was_knocked_again_and_again_follows_something_else() {
        let rig = Rig::built_in("nico").expect("comes along");
        let eyes = plumbline_effects::eyes::Eyes::of_rig(&rig).expect("eyes");
        let yaw = Library::with(Effect::sites(Kind::EyeYaw, None, Some(&eyes)), true).blocks.swap_remove(0);
        let of = |name: usize, kind: Kind| Block { name, kind: Some(kind), ..yaw.clone() };
        let blocks = [Kind::EyeYaw, Kind::EyeKnock, Kind::EyeKnock, Kind::EyeKnock];
        let blocks: Vec<Block> = blocks.into_iter().enumerate().map(|(k, kind)| of(k, kind)).collect();
        let log_prior = |set: &[usize]| together(set, &blocks);
        assert!(log_prior(&[1]).abs() < 1e-12 && log_prior(&[0, 1]).abs() < 1e-12);
        assert!((log_prior(&[1, 2]) - KNOCKED_AGAIN.ln()).abs() < 1e-12);
        assert!((log_prior(&[0, 1, 2, 3]) - 2.0 * KNOCKED_AGAIN.ln()).abs() < 1e-12);
    }

    #[test]
    fn one_joint_logged_early_is_rare_alone_and_usual_beside_all() {
        let rig = Rig::built_in("nico").expect("comes along");
        let arm = Arm::of_rig(&rig, "right_index_tip").expect("an arm");
        let library = Library::with(Effect::sites(Kind::EarlyLog, Some(&arm), None), true);
        let place = |of_all: bool| {
            library.blocks.iter().position(|block| block.is_of_all == of_all).expect("in the library")
        };
        let (all, one) = (place(true), place(false));
        assert!(!library.blocks[all].excludes(&library.blocks[one]));
        assert!(library.blocks[all].is_one_sided && !library.blocks[one].is_one_sided);
        assert!(together(&[one], &library.blocks).abs() < 1e-12);
        assert!(together(&[all], &library.blocks).abs() < 1e-12);
        let beside = library.blocks[one].log_prior + together(&[all, one], &library.blocks);
        assert!(beside > library.blocks[one].log_prior + 4.0, "{beside}");
        assert!(beside < library.blocks[all].log_prior);
    }
}
