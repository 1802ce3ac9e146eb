//! What is chosen on the timeline.

use crate::panels::rest::Rest;

/// How the timeline is looked at.
#[derive(Default)]
pub struct TimelinePanels {
    /// Numbers of the entries that are compared, at most two; the one chosen first stands first.
    pub chosen: Vec<u64>,
    /// A change puts a row on top, and every other one below: what was pressed is not what lies there then.
    pub rest: Rest<u64>,
}

impl TimelinePanels {
    /// Chooses an entry, or lets it go; a third one takes the place of the first.
    pub fn toggle(&mut self, number: u64) {
        if let Some(at) = self.chosen.iter().position(|chosen| *chosen == number) {
            self.chosen.remove(at);
            return;
        }
        if self.chosen.len() == 2 {
            self.chosen.remove(0);
        }
        self.chosen.push(number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_most_two_are_compared_and_a_second_click_lets_go() {
        let mut panels = TimelinePanels::default();
        for number in [1, 2, 3] {
            panels.toggle(number);
        }
        assert_eq!(panels.chosen, [2, 3]);
        panels.toggle(2);
        assert_eq!(panels.chosen, [3]);
    }
}
