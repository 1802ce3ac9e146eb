//! How the search for effects stands, for who waits for it.

use std::sync::Arc;

use plumbline_gap::finding::NextExperiment;

use super::view::{AddedEffect, ShownFinding};
use super::workflow::GapWorkflow;
use crate::ground::text::sentence;

impl GapWorkflow {
    /// The finding that is shown, with what was made of it, and whether something of it could be added and was
    /// not; `None`: nothing was looked for, or what was found does not tell about now.
    pub fn found(&self) -> Option<(&Arc<ShownFinding>, bool)> {
        let shown = self.seen.shown.as_ref().filter(|_| self.stale().is_none())?;
        Some((shown, !shown.addable().is_empty() || self.seen.sizes_arm))
    }

    /// What the finding that is shown suggests to be measured next, whether it tells about now or not.
    pub fn suggested(&self) -> Option<&NextExperiment> {
        self.seen.shown.as_ref()?.finding.next.as_ref()
    }

    /// Findings that are kept, newest first.
    pub fn entries(&self) -> Arc<[super::view::FindingEntry]> {
        self.seen.entries.clone()
    }

    /// Titles of the named effects in the model in use.
    pub fn effects_in_use(&self) -> Vec<String> {
        let named = self.seen.model.effects.iter().filter(|effect| effect.is_named);
        named.map(|effect| effect.title.clone()).collect()
    }

    /// Their names, in the order of the alphabet.
    pub fn names_in_use(&self) -> Vec<String> {
        let named = self.seen.model.effects.iter().filter(|effect| effect.is_named);
        let mut names: Vec<String> = named.map(|effect| effect.name.clone()).collect();
        names.sort();
        names
    }

    /// The same for who reads them one by one: see [`told_by_kind`].
    pub fn effects_told(&self) -> Vec<String> {
        told_by_kind(&self.seen.model.effects)
    }
}

/// The named effects in force: of each small one, how far it moves things; what has one name for every joint stands once,
/// as where it was added: "Servo droop (6 joint by joint)".
fn told_by_kind(effects: &[AddedEffect]) -> Vec<String> {
    let named: Vec<&AddedEffect> = effects.iter().filter(|effect| effect.counts()).collect();
    let first_of_its_kind = |i: &usize| named[..*i].iter().all(|before| before.kind() != named[*i].kind());
    let of_kind = |i: usize| {
        let alike = named.iter().filter(|effect| effect.kind() == named[i].kind()).count();
        let what = named[i].title.rsplit(": ").next().unwrap_or_default();
        match alike {
            1 => named[i].told(),
            several => format!("{} ({several} joint by joint)", sentence(what).trim_end_matches('.')),
        }
    };
    (0..named.len()).filter(first_of_its_kind).map(of_kind).collect()
}

impl AddedEffect {
    /// Whether it counts as an effect of the model in use: it was named, and is in force.
    pub fn counts(&self) -> bool {
        self.is_named && !self.is_left_out
    }

    /// What it is, wherever it is: what has the same kind has one name.
    pub fn kind(&self) -> &str {
        self.name.split('@').next().unwrap_or_default()
    }

    /// Its title, and how far it moves things where that is little: "Fingertip: pad gives way (small: 0.12 mm at the
    /// fingertip)".
    pub fn told(&self) -> String {
        match self.moved_m.filter(|_| self.is_small()) {
            Some(moved_m) => {
                let at = if self.is_of_eyes { "where the eyes see things" } else { "at the fingertip" };
                format!("{} (small: {:.2} mm {at})", self.title, 1e3 * moved_m)
            }
            None => self.title.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn effect(name: &str, title: &str) -> AddedEffect {
        AddedEffect {
            name: name.to_owned(),
            is_named: true,
            title: title.to_owned(),
            parameters: vec![],
            is_of_eyes: false,
            is_left_out: false,
            moved_m: None,
        }
    }

    #[test]
    fn what_has_one_name_for_every_joint_stands_once() {
        let mut effects = vec![
            effect("joint-zero@r_elbow_y", "Right elbow: zero off"),
            effect("screen-bow@screen", "Screen: glass bows"),
            effect("joint-zero@r_wrist_z", "Right wrist turn: zero off"),
        ];
        assert_eq!(told_by_kind(&effects), ["Zero off (2 joint by joint)", "Screen: glass bows"]);
        effects[2].is_left_out = true;
        assert_eq!(told_by_kind(&effects), ["Right elbow: zero off", "Screen: glass bows"]);
    }

    #[test]
    fn a_small_effect_says_how_little_it_moves() {
        let rolls = |moved_m, is_of_eyes| AddedEffect {
            is_of_eyes,
            moved_m,
            ..effect("finger-roll@tip", "Fingertip: it rolls")
        };
        assert_eq!(
            rolls(Some(1.2e-4), false).told(),
            "Fingertip: it rolls (small: 0.12 mm at the fingertip)"
        );
        assert!(rolls(Some(1.2e-4), true).told().ends_with("(small: 0.12 mm where the eyes see things)"));
        for moved_m in [None, Some(2e-3)] {
            assert_eq!(rolls(moved_m, false).told(), "Fingertip: it rolls");
        }
    }
}
