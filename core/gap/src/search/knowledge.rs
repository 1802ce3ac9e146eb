//! What the data can say about every candidate.

use nalgebra::Cholesky;
use plumbline_model::decompose;

use super::library::Library;
use super::look::Look;
use super::naming::Named;
use crate::finding::{Candidate, Knowledge};

/// A usual size that does less than this (floors, and standard deviations in all) does nothing.
const DEAD_SIZE: f64 = 0.01;
const DEAD_SIGMAS: f64 = 0.5;
/// A usual size that stands out of the noise by less than this is flat.
const FLAT_SIGMAS: f64 = 2.0;
/// Two candidates trade against each other from this cosine on.
pub(super) const ALIKE: f64 = 0.95;
/// Less of the doubt is gone than this: not pinned.
const DOUBT_LEFT: f64 = 0.5;
/// At most so many partners are listed.
const MOST_PARTNERS: usize = 5;

/// All names, the most probable first.
pub(super) fn candidates(library: &Library, look: &Look, named: &Named) -> Vec<Candidate> {
    let firsts: Vec<usize> = (0..library.names.len())
        .filter_map(|name| (0..library.blocks.len()).find(|&block| look.blocks[block].name == name))
        .collect();
    let mut all: Vec<Candidate> = firsts
        .iter()
        .map(|&block| {
            let effect = &library.effects[block];
            let name = look.blocks[block].name;
            Candidate {
                id: effect.id().to_owned(),
                site: effect.site.clone(),
                title: effect.title.clone(),
                probability: named.names[name].min(1.0),
                score_sigmas: score(look, block),
                knowledge: knowledge(library, look, named, &firsts, block),
            }
        })
        .collect();
    all.sort_by(|a, b| {
        b.probability.total_cmp(&a.probability).then(b.score_sigmas.total_cmp(&a.score_sigmas))
    });
    all
}

/// How far the residual points its way, everything else absent, in standard deviations.
fn score(look: &Look, block: usize) -> f64 {
    let own = &look.blocks[block];
    let mut a = look.plain.a.view((own.start, own.start), (own.len, own.len)).clone_owned();
    let b = look.plain.b.rows(own.start, own.len).clone_owned();
    for k in 0..own.len {
        a[(k, k)] += 1e-6 + 1e-9 * a[(k, k)];
    }
    let square = Cholesky::new(a).map_or(0.0, |a| b.dot(&a.solve(&b)));
    square.max(0.0).sqrt()
}

fn size(look: &Look, block: usize) -> f64 {
    look.blocks[block].columns().map(|c| look.sizes[c] * look.sizes[c]).sum::<f64>().sqrt()
}

fn knowledge(library: &Library, look: &Look, named: &Named, firsts: &[usize], block: usize) -> Knowledge {
    let size_here = size(look, block);
    let sigmas = size_here * look.total.sqrt();
    if size_here < DEAD_SIZE || sigmas < DEAD_SIGMAS {
        return Knowledge::Dead;
    }
    let name = look.blocks[block].name;
    if let Some(place) = named.blocks.iter().position(|&block| look.blocks[block].name == name) {
        return if named.effects[place].not_addable.is_some() {
            Knowledge::AtBound
        } else {
            Knowledge::Known
        };
    }
    if sigmas < FLAT_SIGMAS {
        return Knowledge::Flat;
    }
    let mut partners: Vec<(f64, String)> = firsts
        .iter()
        .filter(|&&other| other != block && size(look, other) * look.total.sqrt() >= FLAT_SIGMAS)
        .map(|&other| (cosine(look, block, other), library.effects[other].name()))
        .filter(|(cosine, _)| *cosine > ALIKE)
        .collect();
    if !partners.is_empty() {
        partners.sort_by(|a, b| b.0.total_cmp(&a.0));
        partners.truncate(MOST_PARTNERS);
        return Knowledge::TradeOff(partners.into_iter().map(|(_, name)| name).collect());
    }
    // A usual size known to half of itself needs to stand out by two standard deviations.
    if 1.0 / (1.0 + sigmas * sigmas).sqrt() > DOUBT_LEFT { Knowledge::NotPinned } else { Knowledge::Known }
}

/// Largest cosine between what two blocks can do, frames projected out.
fn cosine(look: &Look, one: usize, other: usize) -> f64 {
    let (p, q) = (&look.blocks[one], &look.blocks[other]);
    let a = |r: std::ops::Range<usize>, c: std::ops::Range<usize>| {
        look.plain.a.view((r.start, c.start), (r.len(), c.len())).clone_owned()
    };
    let root = |block: &super::library::Block| {
        let mut own = a(block.columns(), block.columns());
        let small = 1e-9 + 1e-6 * own.trace();
        for k in 0..block.len {
            own[(k, k)] += small;
        }
        Cholesky::new(own).map(|cholesky| cholesky.l())
    };
    let (Some(left), Some(right)) = (root(p), root(q)) else { return 0.0 };
    let mixed = a(p.columns(), q.columns());
    let Some(half) = left.solve_lower_triangular(&mixed) else { return 0.0 };
    let Some(whole) = right.solve_lower_triangular(&half.transpose()) else { return 0.0 };
    decompose::singular_values(whole).map_or(0.0, |values| values.max().min(1.0))
}
