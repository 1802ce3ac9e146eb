//! How the search for effects stands, for who waits for it.

use std::sync::Arc;

use plumbline_gap::finding::NextExperiment;

use super::view::{AddedEffect, ShownFinding};
use super::workflow::GapWorkflow;

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

    /// The same for who reads them one by one: of each small one, how far it moves things.
    pub fn effects_told(&self) -> Vec<String> {
        let named = self.seen.model.effects.iter().filter(|effect| effect.is_named);
        named.map(AddedEffect::told).collect()
    }
}

impl AddedEffect {
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

    #[test]
    fn a_small_effect_says_how_little_it_moves() {
        let effect = |moved_m, is_of_eyes| AddedEffect {
            name: "finger-roll@tip".to_owned(),
            is_named: true,
            title: "Fingertip: it rolls".to_owned(),
            parameters: vec![],
            is_of_eyes,
            is_left_out: false,
            moved_m,
        };
        assert_eq!(
            effect(Some(1.2e-4), false).told(),
            "Fingertip: it rolls (small: 0.12 mm at the fingertip)"
        );
        assert!(effect(Some(1.2e-4), true).told().ends_with("(small: 0.12 mm where the eyes see things)"));
        for moved_m in [None, Some(2e-3)] {
            assert_eq!(effect(moved_m, false).told(), "Fingertip: it rolls");
        }
    }
}
