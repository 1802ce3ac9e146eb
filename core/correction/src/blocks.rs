//! Blocks for cross-validation: touches that are held out together.
//!
//! Touches of one line, one day or one place share what is wrong with them. Holding out single
//! rows would let a model see the neighbors of what it is judged on.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::data::TouchData;

/// By what touches are held out together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BlockBy {
    /// By the session's sets if it has at least three and none of them holds most of the touches,
    /// else by area.
    #[default]
    SetsElseArea,
    /// By area: the touches are halved at the median of their wider extent again and again.
    Area,
}

/// Touches told apart into blocks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Blocks {
    /// Whether they are the session's sets or areas.
    pub by: BlockBy,
    /// Name of each block.
    pub names: Vec<String>,
    /// Block of each touch.
    pub of_touch: Vec<usize>,
}

impl Blocks {
    /// At most `most` blocks of these touches, at least two where there are two touches. Touches
    /// of one group, repeats, are never in different blocks.
    pub fn of(data: &TouchData, by: BlockBy, most: usize) -> Self {
        let most = most.clamp(2, data.len().max(2));
        let sets = Self::by_sets(data, most).filter(|_| by == BlockBy::SetsElseArea);
        let mut blocks = sets.unwrap_or_else(|| Self::by_area(data, most));
        blocks.join_groups(data);
        blocks
    }

    /// Number of blocks.
    pub fn len(&self) -> usize {
        self.names.len()
    }

    /// Whether there is no block.
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// Indices of the touches outside and inside of a block.
    pub fn split(&self, block: usize) -> (Vec<usize>, Vec<usize>) {
        (0..self.of_touch.len()).partition(|touch| self.of_touch[*touch] != block)
    }

    fn by_sets(data: &TouchData, most: usize) -> Option<Self> {
        let mut sets = BTreeMap::<&str, Vec<usize>>::new();
        for (index, touch) in data.touches.iter().enumerate() {
            sets.entry(touch.set.as_deref()?).or_default().push(index);
        }
        // A model without most of the touches says little of the one with all of them.
        let largest = sets.values().map(Vec::len).max().unwrap_or(0);
        if sets.len() < 3 || 2 * largest > data.len() {
            return None;
        }
        // More sets than blocks: the largest first, each to the block that is smallest so far.
        let mut by_size: Vec<(&str, Vec<usize>)> = sets.into_iter().collect();
        by_size.sort_by_key(|(_, touches)| std::cmp::Reverse(touches.len()));
        let mut parts: Vec<(Vec<&str>, Vec<usize>)> = vec![];
        for (name, touches) in by_size {
            if parts.len() < most {
                parts.push((vec![name], touches));
            } else if let Some(smallest) = parts.iter_mut().min_by_key(|(_, touches)| touches.len()) {
                smallest.0.push(name);
                smallest.1.extend(touches);
            }
        }
        let names = parts.iter().map(|(names, _)| names.join(" + ")).collect();
        let parts = parts.into_iter().map(|(_, touches)| touches).collect();
        Some(Self::of_parts(BlockBy::SetsElseArea, names, parts, data.len()))
    }

    fn by_area(data: &TouchData, most: usize) -> Self {
        let mut parts: Vec<Vec<usize>> = vec![(0..data.len()).collect()];
        while parts.len() < most {
            let largest = (0..parts.len()).max_by_key(|part| (parts[*part].len(), std::cmp::Reverse(*part)));
            let Some(largest) = largest.filter(|part| parts[*part].len() >= 2) else { break };
            let half = halved(data, &mut parts[largest]);
            parts.push(half);
        }
        let name = |part: &Vec<usize>| {
            let mean = |of: fn(&crate::data::Touch) -> f64| {
                part.iter().map(|touch| of(&data.touches[*touch])).sum::<f64>() / part.len() as f64
            };
            format!("around ({:.0}, {:.0}) px", mean(|t| t.pixel.u_px), mean(|t| t.pixel.v_px))
        };
        let names = parts.iter().map(name).collect();
        Self::of_parts(BlockBy::Area, names, parts, data.len())
    }

    fn of_parts(by: BlockBy, names: Vec<String>, parts: Vec<Vec<usize>>, touches: usize) -> Self {
        let mut of_touch = vec![0; touches];
        for (block, part) in parts.iter().enumerate() {
            for touch in part {
                of_touch[*touch] = block;
            }
        }
        Self { by, names, of_touch }
    }

    /// A group that was torn apart goes whole to the block of its first touch.
    fn join_groups(&mut self, data: &TouchData) {
        let mut homes = BTreeMap::<&str, usize>::new();
        for (touch, block) in data.touches.iter().zip(&mut self.of_touch) {
            if let Some(group) = &touch.group {
                *block = *homes.entry(group).or_insert(*block);
            }
        }
        let used: Vec<usize> = (0..self.names.len()).filter(|block| self.of_touch.contains(block)).collect();
        self.names = used.iter().map(|block| self.names[*block].clone()).collect();
        for block in &mut self.of_touch {
            *block = used.iter().position(|used| used == block).unwrap_or(0);
        }
    }
}

/// Takes the upper half along the wider extent out of a part.
fn halved(data: &TouchData, part: &mut Vec<usize>) -> Vec<usize> {
    let u = |touch: &usize| data.touches[*touch].pixel.u_px;
    let v = |touch: &usize| data.touches[*touch].pixel.v_px;
    let extent = |of: &dyn Fn(&usize) -> f64| {
        let values = part.iter().map(of);
        values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
    };
    let wide = extent(&u) >= extent(&v);
    // The other coordinate settles ties, so that the order of the rows does not matter.
    part.sort_by(|a, b| {
        let (first, second) = (u(a).total_cmp(&u(b)), v(a).total_cmp(&v(b)));
        if wide { first.then(second) } else { second.then(first) }
    });
    part.split_off(part.len() / 2)
}
