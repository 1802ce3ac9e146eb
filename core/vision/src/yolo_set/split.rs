//! Which images a detector learns from, and which judge it: whole scenes, chosen by a seed.

use std::collections::BTreeMap;

use super::scene::seconds_of;
use super::{Split, YoloSet, YoloSetError};

/// How a set is split.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplitOptions {
    /// Part of the images that is kept for validation, 0–1.
    pub val_fraction: f64,
    /// Another seed chooses other scenes.
    pub seed: u64,
    /// Scenes with time stamps this close are one scene: nothing has moved much in between.
    pub join_within_s: f64,
}

impl Default for SplitOptions {
    /// 80:20, scenes within two seconds joined.
    fn default() -> Self {
        Self { val_fraction: 0.2, seed: 1, join_within_s: 2.0 }
    }
}

/// How a set is split.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SplitCounts {
    /// Scenes, after joining.
    pub scenes: usize,
    /// Images in train.
    pub train: usize,
    /// Images in val.
    pub val: usize,
    /// Images in test, which are never chosen here.
    pub test: usize,
}

#[derive(Default)]
struct Group {
    images: Vec<usize>,
    split: Option<Split>,
}

/// Chooses parts for the images without one.
pub(super) fn split(set: &mut YoloSet, options: &SplitOptions) -> Result<SplitCounts, YoloSetError> {
    if !(options.val_fraction > 0.0 && options.val_fraction < 1.0) {
        return Err(YoloSetError::Fraction(options.val_fraction));
    }
    if set.images.is_empty() {
        return Err(YoloSetError::Empty);
    }
    let groups = groups(set, options.join_within_s);
    let chosen = |split: Split| -> usize {
        groups.values().filter(|group| group.split == Some(split)).map(|group| group.images.len()).sum()
    };
    let mut open: Vec<(&String, &Group)> = groups.iter().filter(|(_, group)| group.split.is_none()).collect();
    if open.len() == groups.len() && open.len() == 1 {
        let join_within_s = options.join_within_s;
        return Err(YoloSetError::OneScene { images: set.images.len(), join_within_s });
    }
    // By a hash of the name: a set that has grown keeps most of its order.
    open.sort_by_key(|(scene, _)| (hash(options.seed, scene), *scene));
    let total = set.images.len() - chosen(Split::Test);
    let wanted = options.val_fraction * total as f64;
    let mut val = chosen(Split::Val);
    let (train, only) = (chosen(Split::Train), open.len());
    for (taken, (_, group)) in open.into_iter().enumerate() {
        let with = val + group.images.len();
        // The nearer to the wanted number the better; neither part stays empty.
        let nearer = (with as f64 - wanted).abs() < (val as f64 - wanted).abs() || val == 0;
        let leaves_train = train > 0 || taken + 1 < only;
        let split = if nearer && leaves_train { Split::Val } else { Split::Train };
        if split == Split::Val {
            val = with;
        }
        for &index in &group.images {
            set.images[index].split = Some(split);
        }
    }
    // A scene of which one image has a part already keeps together.
    for group in groups.values().filter(|group| group.split.is_some()) {
        for &index in &group.images {
            set.images[index].split = set.images[index].split.or(group.split);
        }
    }
    let count = |split| set.images.iter().filter(|image| image.split == Some(split)).count();
    let [train, val, test] = Split::ALL.map(count);
    Ok(SplitCounts { scenes: groups.len(), train, val, test })
}

/// Images by scene, scenes close in time joined under the name of the first.
fn groups(set: &YoloSet, join_within_s: f64) -> BTreeMap<String, Group> {
    let mut stamped: Vec<(f64, &str)> = set
        .images
        .iter()
        .filter_map(|image| Some((seconds_of(&image.scene)?, image.scene.as_str())))
        .collect();
    stamped.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(b.1)));
    let mut joined: BTreeMap<&str, &str> = BTreeMap::new();
    for pair in stamped.windows(2) {
        let [(before_s, before), (after_s, after)] = [pair[0], pair[1]];
        if before != after && after_s - before_s <= join_within_s {
            let first = joined.get(before).copied().unwrap_or(before);
            joined.insert(after, first);
        }
    }
    let mut groups: BTreeMap<String, Group> = BTreeMap::new();
    for (index, image) in set.images.iter().enumerate() {
        let scene = joined.get(image.scene.as_str()).copied().unwrap_or(&image.scene);
        let group = groups.entry(scene.to_owned()).or_default();
        group.images.push(index);
        group.split = group.split.or(image.split);
    }
    groups
}

/// The same on every machine and in every version: FNV-1a, then mixed (SplitMix64).
fn hash(seed: u64, text: &str) -> u64 {
    let fold = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    let mut z = text.bytes().fold(0xcbf2_9ce4_8422_2325, fold) ^ seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
