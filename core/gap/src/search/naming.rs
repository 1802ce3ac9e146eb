//! From sets with probabilities to names, classes and a verdict.

use std::collections::HashSet;

use nalgebra::DMatrix;
use plumbline_effects::{Effect, Kind};

use super::explore::{Explored, Model};
use super::field::log_sum;
use super::library::{Block, Library, together};
use super::look::Look;
use super::many::Many;
use super::stated::still_right;
use super::unknown::{RIVAL_P, VETO_P};
use crate::finding::{ClassMember, FoundParameter, NamedEffect, Verdict};
use crate::floor::Floor;

/// Names whose odds against the best one are no worse than this cannot be told from it.
pub(super) const SAME_CLASS_ODDS: f64 = 10.0;
/// Effects of a class are named from this probability of the class on.
const NAMED_FROM: f64 = 0.5;
/// An effect that does less than this to the rows (floors) is dirt and gets no name.
pub(super) const SMALLEST: f64 = 0.5;
/// The largest one, when all else agrees, may be a little smaller; below this it was dirt (of the seven names given in
/// development cases of four generators in which nothing was hidden, five).
const SMALLEST_FIRST: f64 = 0.45;
/// Standard deviations of values are larger by this than the linear model says: what real joints do
/// is not quite what the library says (seen on development cases of the blind test).
pub(super) const WIDER: f64 = 1.5;
/// What lenses do is nearer to what the library says (seen on development cases as well).
const WIDER_OF_EYES: f64 = 1.25;
/// Effects that do more to the rows than this many times the whole gap cancel each other: no name.
const CANCELLING: f64 = 1.5;
/// Of eyes, which turn their own way each: what they do together is less than what each does, and optics hold so exactly
/// that two of them do not make up for what a formula leaves.
const CANCELLING_OF_EYES: f64 = 4.0;
/// So many effects of the eyes that each do more than the whole gap are no coincidence.
const MANY_CANCELLING: usize = 3;
/// An eye that was knocked while so many sets were measured follows something else that changed from set to set.
const MANY_KNOCKS: usize = 4;
/// Beyond this many usual sizes a fit is at its bound.
pub(crate) const BOUND: f64 = 3.0;
/// Why such a fit is not added.
pub(crate) const BEYOND_PLAUSIBLE: &str =
    "its fit lies beyond what is plausible for this effect, so something else is probably at work";
/// One name stands for its class from this probability on.
const ONE_NAME: f64 = 0.8;
/// A gap of this size (floors) that gets no name is unexplained.
const NO_DIRT: f64 = 0.4;
/// Many small things that all get none are not as large as the noise itself.
pub(crate) const MOST_DIRT: f64 = 1.0;

/// Said of a joint beside all of them: its share is less or more than theirs by what is told.
const OTHERWISE_THAN_ALL: &str = ", by another share than the other joints (more, or with a minus less)";

/// How probable play, or sag of all joints, is that may be what the formula of a drag or an early log leaves: it was there
/// in one of fourteen development cases of the blind test (Laplace: 2 of 16).
const PLAY_OR_DRAG: f64 = 0.12;

/// How probable each is of a finger that drags and of angles that all were read early, where a set has both: both go with
/// the way the arm comes, and one makes up for what the other's formula leaves. Both were there in one of thirteen
/// development cases of the blind test, in twelve it was one of them, now the larger, now the smaller (Laplace: 8 of 15).
const DRAG_OR_EARLY: f64 = 0.53;

/// A drag may be angles that were read early where those leave open no more than this of what it explains (squares): nothing
/// logs how much of a lag is friction. Of five such names of single effects in development cases of the blind test two
/// were drags (Laplace).
const EARLY_WITHIN: f64 = 0.1;
const DRAG_FOR_EARLY: f64 = 0.4;

/// What the sets say together.
pub(super) struct Named {
    pub verdict: Verdict,
    pub effects: Vec<NamedEffect>,
    /// Blocks of the effects that are named, in the same order.
    pub blocks: Vec<usize>,
    /// Probability of each name of the library.
    pub names: Vec<f64>,
    /// Probability that something is at work that no name stands for.
    pub unknown: f64,
    /// Of what is left by noise and dirt alone.
    pub p_value: f64,
    /// Probability that everything is a little off at once, where that is more probable than these few.
    pub many: Option<f64>,
}

/// An effect of a set that gets a name.
struct Candidate {
    block: usize,
    effect: NamedEffect,
    /// How probable it is that it is there itself, where it is, and is not left of another one.
    share: f64,
    /// How many things it counts as: one, though it may be another than its name, or its share where that other one has a name too.
    counts: f64,
}

/// What the search has, for naming.
pub(super) struct Evidence<'a> {
    pub library: &'a Library,
    pub look: &'a Look,
    pub explored: &'a Explored,
    /// Sets without rivals, where a rival is in the most probable one.
    pub alone: Option<&'a Explored>,
    /// Everything at once, and how probable that is.
    pub many: Option<(&'a Many, f64)>,
    pub floor: &'a Floor,
    /// Length of a floor on the table, m (px for eye points).
    pub floor_m: f64,
    pub temperature: f64,
}

impl Evidence<'_> {
    /// Names what the sets agree on.
    pub fn name(&self) -> Named {
        let (unknown, p_value) = self.unknown();
        // Whether or not a rival counts as something unknown, it may stand where an effect belongs: what can
        // be said of the library is what it does best without one.
        if let Some(alone) = self.alone {
            return Self { explored: alone, alone: None, ..*self }.named(unknown, p_value);
        }
        self.named(unknown, p_value)
    }

    /// Names what the most probable set has, or, where some of that gets no name although it does much, another set that
    /// has all those names and no such rest.
    fn named(&self, unknown: f64, p_value: f64) -> Named {
        let names = self.of_names();
        let top: Vec<usize> = self.explored.models.first().map_or(vec![], |model| self.of_library(model));
        let (mut found, rest) = self.names_of(&top, &names);
        if rest > 0 {
            found = self.without_rest(&found, &names).unwrap_or(found);
        }
        found.sort_by(|a, b| b.effect.size_sigmas.total_cmp(&a.effect.size_sigmas));
        // What many small things together explain as well as noise is nothing unknown, unless it is more than they are.
        let is_dirt = p_value >= RIVAL_P && self.look.gap() < MOST_DIRT;
        let nameless = found.is_empty() && self.p_bare() < VETO_P && self.look.gap() > NO_DIRT && !is_dirt;
        let unknown = unknown.max(if nameless { 0.6 } else { 0.0 });
        let knocks =
            found.iter().filter(|one| self.look.blocks[one.block].kind == Some(Kind::EyeKnock)).count();
        let is_other = self.cancel_each_other(&top) || knocks >= MANY_KNOCKS;
        let unknown = unknown.max(if is_other { 0.95 } else { 0.0 });
        // One of every joint is more than one thing, and of what is left of each other no more than one is there.
        let families = found.iter().filter(|one| self.look.blocks[one.block].is_family).count();
        let there: f64 = found.iter().map(|one| one.counts).sum();
        let by_names = Many::probability_by_names(there.round() as usize + families);
        let many = self.many.map(|(many, by_evidence)| (many, by_evidence.max(by_names)));
        let is_many = |(_, probability): &(&Many, f64)| *probability > 0.5 && unknown <= 0.5;
        let many = many.filter(is_many).filter(|_| !found.is_empty());
        let verdict = if unknown > 0.5 {
            Verdict::NotInLibrary
        } else if found.is_empty() {
            Verdict::NoGap
        } else if many.is_none() && found.iter().all(|one| self.has_one_name(one)) {
            Verdict::Named
        } else {
            Verdict::Class
        };
        for Candidate { block, effect, share, .. } in &mut found {
            if let Some((many, probability)) = many {
                let stands_out = probability * self.stands_out_of(many, *block);
                let beside = |few: f64| (1.0 - probability) * few + stands_out;
                effect.probability = beside(effect.probability);
                effect.class_probability = beside(effect.class_probability);
                // It is so much less probable among few only.
                effect.runner_up = None;
            }
            // Beside something unknown a name is less sure than it looks, be it probable or not.
            effect.probability *= *share * still_right(unknown);
            effect.class_probability *= still_right(unknown);
        }
        let many = many.map(|(_, probability)| probability);
        let (blocks, effects) = found.into_iter().map(|one| (one.block, one.effect)).unzip();
        Named { verdict, effects, blocks, names, unknown, p_value, many }
    }

    /// The effects of a set that get a name, and how many others do much and get none: nothing tells what they are, or they
    /// cancel each other.
    fn names_of(&self, set: &[usize], names: &[f64]) -> (Vec<Candidate>, usize) {
        let values = self.values(set);
        let (mut found, mut rest) = (vec![], 0);
        let sizes: Vec<f64> =
            set.iter().zip(&values).map(|(&block, (own, _))| self.look.does(block, own)).collect();
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        // Without repeats the floor may be off; what matters is the noise that was found.
        let likely = self.look.fields.get(self.look.likely(self.explored));
        let noise = likely.map_or(1.0, |field| field.variant.noise.min(1.0));
        for (place, &block) in set.iter().enumerate() {
            let (own, covariance) = &values[place];
            let size = sizes[place];
            let least = noise * if size >= largest { SMALLEST_FIRST } else { SMALLEST };
            let of_eyes = self.library.effects[block].kind.is_of_eyes();
            let cancelling = if of_eyes { CANCELLING_OF_EYES } else { CANCELLING };
            if size < least {
                continue;
            }
            // What is there alone cancels nothing.
            if set.len() > 1 && size > cancelling * self.look.gap() + SMALLEST {
                rest += 1;
                continue;
            }
            let mut effect = self.effect(set, block, own, covariance, size, names);
            if effect.class_probability >= NAMED_FROM {
                let beside_all = |&other: &usize| other != block && self.look.blocks[other].is_of_all;
                if effect.id == Kind::EarlyLog.id() && set.iter().any(beside_all) {
                    effect.title.push_str(OTHERWISE_THAN_ALL);
                }
                let left_of = self.may_be_left_of(set, &sizes, place);
                let counts = left_of.map_or(1.0, |(_, share)| share);
                let left_of = left_of.or_else(|| Some((self.early_instead(set, place)?, DRAG_FOR_EARLY)));
                if let Some((whole, share)) = left_of {
                    effect.class = with_whole(effect.class, &self.library.effects[whole], share);
                }
                found.push(Candidate {
                    block,
                    effect,
                    share: left_of.map_or(1.0, |(_, share)| share),
                    counts,
                });
            } else {
                rest += 1;
            }
        }
        (found, rest)
    }

    /// Whether so many effects of the eyes do more than the whole gap each that together they stand for something else: that
    /// two nearly cancel each other is a coincidence, that several do is what a fit makes of what no name stands for.
    fn cancel_each_other(&self, set: &[usize]) -> bool {
        let is_large = |(&block, (own, _)): (&usize, &(Vec<f64>, DMatrix<f64>))| {
            let of_eyes = self.library.effects[block].kind.is_of_eyes();
            of_eyes && self.look.does(block, own) > self.look.gap()
        };
        set.iter().zip(&self.values(set)).filter(|one| is_large(*one)).count() >= MANY_CANCELLING
    }

    /// Names of the most probable set, of those that cannot be told from the first one, that gives all of these names and
    /// leaves no such rest.
    fn without_rest(&self, found: &[Candidate], names: &[f64]) -> Option<Vec<Candidate>> {
        let (first, others) = self.explored.models.split_first()?;
        let name = |one: &Candidate| self.look.blocks[one.block].name;
        // Of the hundreds of time constants that say the same, the most probable one speaks.
        let mut told = HashSet::new();
        let mut is_new = |model: &&Model| {
            let said =
                |block: usize| (self.look.blocks[block].name, self.library.effects[block].growth().is_some());
            let mut own: Vec<(usize, bool)> = self.of_library(model).into_iter().map(said).collect();
            own.sort_unstable();
            told.insert(own)
        };
        let near = others
            .iter()
            .take_while(|model| model.probability * SAME_CLASS_ODDS > first.probability)
            .filter(|model| is_new(model));
        let mut all = near.map(|model| self.names_of(&self.of_library(model), names));
        let has_all =
            |other: &[Candidate]| found.iter().all(|own| other.iter().any(|one| name(one) == name(own)));
        all.find(|(other, rest)| *rest == 0 && other.len() > found.len() && has_all(other))
            .map(|(all, _)| all)
    }

    /// Whether one name stands for its class. Where every joint may be wrong and one of them as well, the most probable is
    /// not one name: which joint it is stays open.
    fn has_one_name(&self, one: &Candidate) -> bool {
        let is_family = self.library.effects[one.block].is_of_every_site();
        stands_for_its_class(&one.effect.class, one.effect.probability * one.share, is_family)
    }

    /// What it may be a part of, where it is play beside a finger that drags, or angles that were read early, and smaller.
    /// How far those go depends on speeds that no log holds, so what a formula leaves of them goes with the direction of
    /// motion as well, and cannot be told from play. Or where all joints give way alike beside angles that were read
    /// early: a servo that gives way under load stays behind its command, which is no way that was left to go.
    /// With how probable it is that it is there itself. Drag and early log of one set stand for each other.
    fn may_be_left_of(&self, set: &[usize], sizes: &[f64], place: usize) -> Option<(usize, f64)> {
        let goes_with_speed =
            |other: &usize| self.goes_with_speed(set[*other]) && sizes[*other] >= sizes[place];
        let effect = &self.library.effects[set[place]];
        if effect.kind == Kind::JointSag && effect.site.is_empty() {
            let early = set.iter().copied().find(|&block| self.look.blocks[block].is_of_all);
            return early.map(|early| (early, PLAY_OR_DRAG));
        }
        let is_drag = |block: usize| self.look.blocks[block].kind == Some(Kind::TouchDrag);
        let is_early = |block: usize| self.look.blocks[block].is_of_all;
        let is_other = |block: &usize| match is_drag(set[place]) {
            true => is_early(*block),
            false => is_early(set[place]) && is_drag(*block),
        };
        if let Some(other) = set.iter().copied().find(is_other) {
            return Some((other, DRAG_OR_EARLY));
        }
        let is_play = effect.kind == Kind::Backlash;
        (0..set.len()).find(|other| is_play && goes_with_speed(other)).map(|other| (set[other], PLAY_OR_DRAG))
    }

    /// Angles that all were read early, where they explain what a drag of the set does nearly as well.
    fn early_instead(&self, set: &[usize], place: usize) -> Option<usize> {
        let is_early = |block: usize| self.look.blocks[block].is_of_all;
        let is_drag = self.look.blocks[set[place]].kind == Some(Kind::TouchDrag);
        if !is_drag || set.iter().any(|&block| is_early(block)) {
            return None;
        }
        let field = self.look.fields.get(self.look.likely(self.explored))?;
        let square = |set: &[usize]| field.given(set, &self.look.packed).square_left();
        let with = |early: usize| {
            let mut with = set.to_vec();
            with[place] = early;
            with
        };
        let was_early = |early: &usize| {
            let values = self.values(&with(*early));
            values.get(place).is_some_and(|(own, _)| own.iter().all(|value| *value > 0.0))
        };
        let known = self.look.allowed.iter().copied().filter(|&block| block < self.look.effects);
        let early = known.filter(|&block| is_early(block)).filter(was_early);
        let (left, early) =
            early.map(|early| (square(&with(early)), early)).min_by(|a, b| a.0.total_cmp(&b.0))?;
        let base: Vec<usize> = set.iter().copied().filter(|&other| other != set[place]).collect();
        let of_drag = square(set);
        (left - of_drag < EARLY_WITHIN * (square(&base) - of_drag)).then_some(early)
    }

    fn goes_with_speed(&self, block: usize) -> bool {
        matches!(self.look.blocks[block].kind, Some(Kind::TouchDrag | Kind::EarlyLog))
    }

    pub(super) fn of_library(&self, model: &Model) -> Vec<usize> {
        model.set.iter().copied().filter(|&block| block < self.look.effects).collect()
    }

    /// Probability of each name.
    fn of_names(&self) -> Vec<f64> {
        let mut names = vec![0.0; self.library.names.len()];
        for model in &self.explored.models {
            for block in self.of_library(model) {
                names[self.look.blocks[block].name] += model.probability;
            }
        }
        names
    }

    /// Values and covariance of each block of a set, in usual sizes.
    pub(super) fn values(&self, set: &[usize]) -> Vec<(Vec<f64>, DMatrix<f64>)> {
        let Some(field) = self.look.fields.get(self.look.likely(self.explored)) else { return vec![] };
        let given = field.given(set, &self.look.packed);
        let ((means, _), covariance) = (given.values(), given.wide());
        let mut at = 0;
        set.iter()
            .map(|&block| {
                let len = self.look.blocks[block].len;
                let own = means.rows(at, len).iter().copied().collect();
                let covariance =
                    covariance.view((at, at), (len, len)) * self.look.blocks[block].wider().powi(2);
                at += len;
                (own, covariance)
            })
            .collect()
    }

    fn effect(
        &self,
        set: &[usize],
        block: usize,
        own: &[f64],
        covariance: &DMatrix<f64>,
        size: f64,
        names: &[f64],
    ) -> NamedEffect {
        let effect = &self.library.effects[block];
        let name = self.look.blocks[block].name;
        let rivals = self.exchanged(set, block);
        let best = rivals.iter().map(|(_, score, _)| *score).fold(f64::NEG_INFINITY, f64::max);
        let own_score = rivals.iter().find(|(other, ..)| *other == name).map_or(best, |(_, score, _)| *score);
        let inside = |score: f64| score > own_score - SAME_CLASS_ODDS.ln();
        let mut members: Vec<(usize, f64, usize)> =
            rivals.iter().copied().filter(|(other, score, _)| *other == name || inside(*score)).collect();
        members.sort_by(|a, b| (b.0 == name).cmp(&(a.0 == name)).then(b.1.total_cmp(&a.1)));
        let total = log_sum(members.iter().map(|(_, score, _)| *score));
        let class: Vec<ClassMember> = members
            .iter()
            .map(|(_, score, block)| {
                let effect = &self.library.effects[*block];
                ClassMember {
                    id: effect.id().to_owned(),
                    site: effect.site.clone(),
                    title: effect.title.clone(),
                    probability: (score - total).exp(),
                }
            })
            .collect();
        let runner_up = rivals
            .iter()
            .filter(|(other, score, _)| *other != name && !inside(*score))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(other, score, _)| {
                (self.library.names[*other].clone(), (own_score - score) / std::f64::consts::LN_10)
            });
        let class_probability: f64 = self
            .explored
            .models
            .iter()
            .filter(|model| {
                let has = |block: &usize| {
                    let own = self.look.blocks[*block].name;
                    members.iter().any(|(name, ..)| *name == own)
                };
                model.set.iter().any(has)
            })
            .map(|model| model.probability)
            .sum();
        let class_names: Vec<usize> = members.iter().map(|(name, ..)| *name).collect();
        let typical: Vec<f64> = effect.parameters().iter().map(|parameter| parameter.typical).collect();
        let values: Vec<f64> = own.iter().zip(&typical).map(|(value, typical)| value * typical).collect();
        let covariance = covariance + self.by_shapes(block, own) + self.by_companions(set, block, own);
        let covariance =
            DMatrix::from_fn(own.len(), own.len(), |r, c| covariance[(r, c)] * typical[r] * typical[c]);
        let not_addable = if own.iter().any(|value| value.abs() > BOUND) {
            Some(BEYOND_PLAUSIBLE)
        } else if effect.is_of_a_set() {
            Some("it was so while that set was measured, which says nothing of any other time")
        } else {
            None
        };
        NamedEffect {
            id: effect.id().to_owned(),
            site: effect.site.clone(),
            title: effect.title.clone(),
            probability: names[name].min(1.0),
            class_probability: class_probability.min(1.0),
            parameters: parameters(effect, &values, &covariance),
            covariance: covariance.transpose().iter().copied().collect(),
            shape: effect.shape,
            reference_s: effect.reference_s,
            values,
            size_sigmas: size,
            size_m: size * self.floor_m,
            class,
            beside: self.beside(set, block, &class_names, names),
            split_by: None,
            runner_up,
            not_addable: not_addable.map(str::to_owned),
        }
    }

    /// Every name in the place of one block of a set: name, log score over its shapes, and its best
    /// shape.
    fn exchanged(&self, set: &[usize], block: usize) -> Vec<(usize, f64, usize)> {
        let base: Vec<usize> = set.iter().copied().filter(|&other| other != block).collect();
        let blocks = &self.look.packed;
        let given: Vec<_> = self.look.fields.iter().map(|field| field.given(&base, blocks)).collect();
        let mut found: Vec<(usize, Vec<(f64, usize)>)> = vec![];
        for &other in self.look.allowed.iter().filter(|&&other| other < self.look.effects) {
            let name = blocks[other].name;
            if base.iter().any(|&taken| blocks[other].excludes(&blocks[taken])) {
                continue;
            }
            let adds = given.iter().map(|given| given.log_evidence + given.adds(&blocks[other]));
            let with: Vec<usize> = base.iter().copied().chain([other]).collect();
            let prior = blocks[other].log_prior + together(&with, blocks);
            let score = prior + log_sum(adds) / self.temperature;
            match found.iter_mut().find(|(known, _)| *known == name) {
                Some((_, shapes)) => shapes.push((score, other)),
                None => found.push((name, vec![(score, other)])),
            }
        }
        found
            .into_iter()
            .filter_map(|(name, shapes)| {
                let best = shapes.iter().max_by(|a, b| a.0.total_cmp(&b.0))?.1;
                Some((name, log_sum(shapes.iter().map(|(score, _)| *score)), best))
            })
            .collect()
    }
}

impl Block {
    /// Standard deviations of its values are larger by this than the linear model says.
    pub(super) fn wider(&self) -> f64 {
        if self.kind.is_some_and(Kind::is_of_eyes) { WIDER_OF_EYES } else { WIDER }
    }
}

/// A class with what its name may be left of: nothing tells these apart, so the name has the share of those that were right.
fn with_whole(mut class: Vec<ClassMember>, whole: &Effect, share: f64) -> Vec<ClassMember> {
    class.retain(|member| (member.id.as_str(), &member.site) != (whole.id(), &whole.site));
    class.iter_mut().for_each(|member| member.probability *= share);
    class.push(ClassMember {
        id: whole.id().to_owned(),
        site: whole.site.clone(),
        title: whole.title.clone(),
        probability: 1.0 - class.iter().map(|member| member.probability).sum::<f64>(),
    });
    class
}

/// Whether a name stands for its class (itself first), its probability, and whether it is of every site.
fn stands_for_its_class(class: &[ClassMember], probability: f64, is_family: bool) -> bool {
    let Some((own, others)) = class.split_first() else { return true };
    let is_open_family = is_family && others.iter().any(|member| member.id == own.id);
    others.is_empty() || probability >= ONE_NAME && !is_open_family
}

/// Parameters as the command line names them.
pub(super) fn parameters(effect: &Effect, values: &[f64], covariance: &DMatrix<f64>) -> Vec<FoundParameter> {
    let reported = effect.report(values, covariance);
    let found = reported.into_iter().map(|one| FoundParameter {
        name: one.name,
        value: one.value,
        low: one.low,
        high: one.high,
        text: one.text,
    });
    found.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn member(id: &str, site: &str) -> ClassMember {
        ClassMember { id: id.to_owned(), site: site.to_owned(), title: String::new(), probability: 0.5 }
    }

    #[test]
    fn a_name_stands_for_its_class_when_it_is_alone_or_probable() {
        let alone = [member("joint-zero", "r_arm_x")];
        assert!(stands_for_its_class(&alone, 0.3, false));
        let two = [member("joint-zero", "r_arm_x"), member("axis-skew", "r_arm_x")];
        assert!(stands_for_its_class(&two, 0.8, false));
        assert!(!stands_for_its_class(&two, 0.79, false));
    }

    #[test]
    fn play_beside_a_drag_is_in_its_class_and_less_probable_than_it() {
        let rig = plumbline_model::robot::Rig::built_in("nico").expect("comes along");
        let arm = plumbline_effects::arm::Arm::of_rig(&rig, "right_index_tip").expect("an arm");
        let drag = Effect::sites(Kind::TouchDrag, Some(&arm), None).swap_remove(0);
        let play = [member("backlash", "r_arm_x"), member("touch-drag", &drag.site)].to_vec();
        let class = with_whole(play, &drag, PLAY_OR_DRAG);
        let told: Vec<&str> = class.iter().map(|member| member.id.as_str()).collect();
        assert_eq!(told, ["backlash", "touch-drag"]);
        assert!(class[0].probability < class[1].probability);
        assert!((class.iter().map(|member| member.probability).sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(!stands_for_its_class(&class, PLAY_OR_DRAG, false));
    }

    #[test]
    fn a_family_with_a_member_in_its_class_is_no_name_however_probable() {
        let open = [member("joint-zero", ""), member("joint-zero", "r_arm_x")];
        assert!(!stands_for_its_class(&open, 1.0, true));
        let closed = [member("joint-zero", ""), member("axis-skew", "r_arm_x")];
        assert!(stands_for_its_class(&closed, 0.9, true));
    }
}
