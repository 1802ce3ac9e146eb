//! The lamps of the top line share the room that there is: where it is short, those that are well lose
//! their values, then their names, and the worst one keeps its words.

use egui::{Popup, PopupCloseBehavior, Ui};
use plumbline_widgets::lamp::{Health, Lamp, LampWords};
use plumbline_widgets::theme::space;

use super::PlumblineWindow;
use crate::operator::{Action, Outbox, Screen};

/// What a click on a lamp does.
pub(super) enum Then {
    /// Nothing.
    Nothing,
    /// Goes there.
    Go(Screen),
    /// Opens what is behind it, this wide in points.
    Open(f32, fn(&PlumblineWindow, &mut Ui, &mut Outbox)),
}

/// A lamp before it is known how much room it gets.
pub(super) struct TopLamp {
    pub name: &'static str,
    pub value: String,
    pub health: Health,
    /// Why it is not good, and what to do.
    pub reason: Option<String>,
    pub then: Then,
}

impl TopLamp {
    fn lamp(&self) -> Lamp<'_> {
        Lamp::new(self.name, &self.value, self.health).reason(self.reason.as_deref())
    }

    fn show(&self, words: LampWords, window: &PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
        let response = self.lamp().words(words).show(ui);
        match self.then {
            Then::Nothing => {}
            Then::Go(screen) => {
                if response.clicked() {
                    outbox.act(Action::Go(screen));
                }
            }
            Then::Open(width, details) => {
                Popup::menu(&response)
                    .width(width)
                    .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
                    .show(|ui| details(window, ui, outbox));
            }
        }
    }
}

/// Draws them in order in the room that is left on this line.
pub(super) fn show(lamps: &[TopLamp], window: &PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
    ui.spacing_mut().item_spacing.x = space::XS;
    let width = |lamp: &TopLamp, words| lamp.lamp().words(words).width(ui) + space::XS;
    let widths: Vec<[f32; 3]> = lamps.iter().map(|lamp| STAGES.map(|words| width(lamp, words))).collect();
    let urgency: Vec<u8> = lamps.iter().map(|lamp| urgency(lamp.health)).collect();
    let words = fitting(&widths, &urgency, ui.available_width());
    for (lamp, words) in lamps.iter().zip(words) {
        lamp.show(words, window, ui, outbox);
    }
}

/// The greater, the longer it keeps its words.
fn urgency(health: Health) -> u8 {
    match health {
        Health::Danger => 4,
        Health::Failed => 3,
        Health::Warning => 2,
        Health::Working(_) => 1,
        Health::Good | Health::Off => 0,
    }
}

/// From the least to all of a lamp.
const STAGES: [LampWords; 3] = [LampWords::Sign, LampWords::Name, LampWords::All];

/// How much of each lamp is drawn so that all fit into `room`, of their widths at each of [`STAGES`]: values go first,
/// then names; of the least urgent first, of these of the last. One that is most urgent keeps all its words.
fn fitting(widths: &[[f32; 3]], urgency: &[u8], room: f32) -> Vec<LampWords> {
    let mut stages = vec![2; widths.len()];
    let mut order: Vec<usize> = (0..widths.len()).rev().collect();
    order.sort_by_key(|i| urgency[*i]);
    // The first of the most urgent ones stands last in that order.
    order.pop();
    let sum = |stages: &[usize]| stages.iter().zip(widths).map(|(stage, widths)| widths[*stage]).sum::<f32>();
    for stage in [1, 0] {
        for &i in &order {
            if sum(&stages) > room {
                stages[i] = stage;
            }
        }
    }
    // What a long one that gave way left is room for shorter ones before it: names first.
    for stage in [1, 2] {
        for &i in order.iter().rev() {
            let before = stages[i];
            if before + 1 == stage {
                stages[i] = stage;
                if sum(&stages) > room {
                    stages[i] = before;
                }
            }
        }
    }
    stages.into_iter().map(|stage| STAGES[stage]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use LampWords::{All, Name, Sign};

    /// Lamps of these widths; a name takes half, a sign 20.
    fn of(whole: &[f32], urgency: &[u8], room: f32) -> Vec<LampWords> {
        let widths: Vec<[f32; 3]> = whole.iter().map(|whole| [20.0, whole / 2.0, *whole]).collect();
        fitting(&widths, urgency, room)
    }

    #[test]
    fn what_fits_keeps_its_words() {
        assert_eq!(of(&[80.0, 90.0], &[0, 0], 170.0), [All, All]);
        assert!(of(&[], &[], 0.0).is_empty());
    }

    #[test]
    fn the_least_urgent_give_way_first_their_values_before_their_names() {
        let whole = [100.0, 100.0, 100.0, 100.0];
        // Room for all but one: the last of those that are well gives way.
        assert_eq!(of(&whole, &[0, 2, 0, 3], 350.0), [All, All, Name, All]);
        assert_eq!(of(&whole, &[0, 2, 0, 3], 300.0), [Name, All, Name, All]);
        assert_eq!(of(&whole, &[0, 2, 0, 3], 250.0), [Name, Name, Name, All]);
        assert_eq!(of(&whole, &[0, 2, 0, 3], 190.0), [Sign, Name, Sign, All]);
        assert_eq!(of(&whole, &[0, 2, 0, 3], 170.0), [Sign, Sign, Sign, All]);
    }

    #[test]
    fn what_a_long_one_leaves_is_used_by_a_short_one() {
        // The long one has no name of its own length here: what it leaves is room for the words of the other.
        let widths = [[20.0, 90.0, 90.0], [20.0, 30.0, 40.0], [20.0, 200.0, 200.0], [20.0, 30.0, 30.0]];
        assert_eq!(fitting(&widths, &[0, 0, 0, 3], 200.0), [All, All, Sign, All]);
    }

    #[test]
    fn the_worst_keeps_its_words_whatever_the_room() {
        assert_eq!(of(&[100.0, 100.0], &[3, 0], 10.0), [All, Sign]);
        assert_eq!(of(&[100.0, 100.0], &[2, 2], 10.0), [All, Sign]);
    }
}
