//! What may be there beside a named effect and acts in these rows as a part of it does.
//!
//! An image that is shifted along its rows looks like an eye that is turned sideways, and one that is shifted across them
//! like an eye that is pitched. Where it is shifted both ways no turn can take its place, so the shift has its name; but how
//! much of the one way is a turn nothing tells, and that a turn is not there follows from its being rarer to have two things
//! wrong than one, and from nothing that was measured.

use nalgebra::{Cholesky, DMatrix};
use plumbline_effects::Kind;
use plumbline_model::decompose;

use super::field::log_sum;
use super::knowledge::ALIKE;
use super::naming::{Evidence, SAME_CLASS_ODDS, SMALLEST};
use crate::finding::ClassMember;
use crate::statistics::NORMAL_95;

impl Evidence<'_> {
    /// Names that are not in the set, nor among `known` (the class of the block), and that may do as much as gets a name
    /// beside it: rows tell their size without the block by as much better as they do of effects that are alike, and do not
    /// speak against them.
    pub(super) fn beside(
        &self,
        set: &[usize],
        block: usize,
        known: &[usize],
        names: &[f64],
    ) -> Vec<ClassMember> {
        // Joints and links are many, and nearly every two of them share some direction.
        if !self.look.blocks[block].kind.is_some_and(Kind::is_of_eyes) {
            return vec![];
        }
        let base: Vec<usize> = set.iter().copied().filter(|&other| other != block).collect();
        let (blocks, fields) = (&self.look.packed, &self.look.fields);
        let given: Vec<_> = fields.iter().map(|field| field.given(set, blocks)).collect();
        let without = log_sum(given.iter().map(|given| given.log_evidence));
        let is_open = |&&other: &&usize| {
            let own = &blocks[other];
            let is_known = known.contains(&own.name) || own.is_family;
            other < self.look.effects && !is_known && set.iter().all(|&taken| !own.excludes(&blocks[taken]))
        };
        let mut found: Vec<(usize, ClassMember)> = vec![];
        for &other in self.look.allowed.iter().filter(is_open) {
            let with = log_sum(given.iter().map(|given| given.log_evidence + given.adds(&blocks[other])));
            let speaks_against = (with - without) / self.temperature < -SAME_CLASS_ODDS.ln();
            let may_do = self.may_do(set, other);
            let is_alike = may_do * (1.0 - ALIKE * ALIKE).sqrt() > self.may_do(&base, other);
            let is_told = found.iter().any(|(name, _)| *name == blocks[other].name);
            if speaks_against || is_told || !is_alike || may_do < SMALLEST {
                continue;
            }
            let effect = &self.library.effects[other];
            let member = ClassMember {
                id: effect.id().to_owned(),
                site: effect.site.clone(),
                title: effect.title.clone(),
                probability: names[blocks[other].name].min(1.0),
            };
            found.push((blocks[other].name, member));
        }
        found.sort_by(|a, b| b.1.probability.total_cmp(&a.1.probability));
        found.into_iter().map(|(_, member)| member).collect()
    }

    /// How far what a block does beside a set may be off from what it does at its mean (95 %), in floors.
    fn may_do(&self, set: &[usize], block: usize) -> f64 {
        let with: Vec<usize> = set.iter().copied().chain([block]).collect();
        let Some((_, covariance)) = self.values(&with).pop() else { return 0.0 };
        let columns = self.look.blocks[block].columns();
        let (at, len) = (columns.start, columns.len());
        let mut does = self.look.plain.a.view((at, at), (len, len)) / self.look.total;
        for k in 0..len {
            does[(k, k)] += 1e-12;
        }
        let Some(root) = Cholesky::new(does).map(|cholesky| cholesky.l()) else { return 0.0 };
        let spread: DMatrix<f64> = root.transpose() * covariance * root;
        let widest = decompose::symmetric_eigen(spread).map_or(0.0, |eigen| eigen.eigenvalues.max());
        NORMAL_95 / self.look.blocks[block].wider() * widest.max(0.0).sqrt()
    }
}
