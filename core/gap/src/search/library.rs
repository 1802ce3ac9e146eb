//! Candidates and free-form rivals as blocks of columns.

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
    /// Whether every encoder was logged early by it: one joint early beside all of them is no other thing.
    pub is_of_all: bool,
    /// Whether it turns the right eye sideways or shifts its image in the course of time: such act alike, and two
    /// of them would cancel each other.
    pub grows_sideways: bool,
    /// Number of its name. Two blocks of one name (shapes of one effect) are never in together.
    pub name: usize,
    /// How much it is trusted beforehand, log of the odds.
    pub log_prior: f64,
}

impl Block {
    /// Whether it cannot be there together with another one: two shapes of one name, or a family with one of
    /// its members.
    pub fn excludes(&self, other: &Self) -> bool {
        let of_one_kind = self.kind.is_some() && self.kind == other.kind;
        self.name == other.name
            || self.grows_sideways && other.grows_sideways
            || of_one_kind && (self.is_family != other.is_family || self.is_of_all != other.is_of_all)
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
        Self::with(Effect::candidates(measurements).into_iter().filter(|effect| !ruled_out(effect)).collect())
    }

    /// Of these effects.
    pub fn with(effects: Vec<Effect>) -> Self {
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
            let is_sideways = matches!(effect.kind, Kind::EyeYaw | Kind::ImageShift);
            let grows_sideways = effect.growth().is_some() && is_sideways;
            let is_of_all = effect.kind == Kind::EarlyLog && effect.site.is_empty();
            let log_prior = 0.0;
            blocks.push(Block { start, len, kind, is_family, is_of_all, grows_sideways, name, log_prior });
            start += len;
        }
        let mut shapes = vec![0_usize; names.len()];
        blocks.iter().for_each(|block| shapes[block.name] += 1);
        // One expected effect in all; an effect with many shapes is not more probable for it.
        let odds = 1.0 / (names.len() as f64).max(2.0);
        for (block, effect) in blocks.iter_mut().zip(&effects) {
            let alone = effect.kind == Kind::EarlyLog && !effect.site.is_empty();
            let many = match (effect.is_of_every_site(), alone) {
                (true, _) => EVERY_SITE,
                (_, true) => ONE_LOGGED_EARLY,
                (false, false) => 1.0,
            };
            block.log_prior = (many * odds / shapes[block.name] as f64).ln();
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
        let library = Library::with([of(Kind::JointZero), of(Kind::AxisSkew)].concat());
        let place = |kind: Kind, family: bool| {
            let wanted = |effect: &Effect| effect.kind == kind && effect.is_of_every_site() == family;
            &library.blocks[library.effects.iter().position(wanted).expect("in the library")]
        };
        let (zeros, zero) = (place(Kind::JointZero, true), place(Kind::JointZero, false));
        assert!(zeros.excludes(zero) && zero.excludes(zeros));
        assert!(!zeros.excludes(place(Kind::AxisSkew, false)) && !zero.excludes(place(Kind::AxisSkew, true)));
    }
}
