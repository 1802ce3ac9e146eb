//! The lamps of the top line share the room that there is: where it is short, those that are well become
//! dots, and the worst one keeps its words.

use egui::{Popup, PopupCloseBehavior, Ui};
use plumbline_widgets::lamp::{Health, Lamp};
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

    fn show(&self, folded: bool, window: &PlumblineWindow, ui: &mut Ui, outbox: &mut Outbox) {
        let response = self.lamp().folded(folded).show(ui);
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
    let whole: Vec<f32> = lamps.iter().map(|lamp| lamp.lamp().width(ui) + space::XS).collect();
    let dot = lamps.first().map_or(0.0, |lamp| lamp.lamp().folded(true).width(ui) + space::XS);
    let urgency: Vec<u8> = lamps.iter().map(|lamp| urgency(lamp.health)).collect();
    let folded = folded(&whole, dot, &urgency, ui.available_width());
    for (lamp, folded) in lamps.iter().zip(folded) {
        lamp.show(folded, window, ui, outbox);
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

/// Which lamps become dots so that all fit into `room`: the least urgent first, of these the last; one that
/// is most urgent never does.
fn folded(whole: &[f32], dot: f32, urgency: &[u8], room: f32) -> Vec<bool> {
    let mut folded = vec![false; whole.len()];
    let mut order: Vec<usize> = (0..whole.len()).rev().collect();
    order.sort_by_key(|i| urgency[*i]);
    // The first of the most urgent ones stands last in that order.
    order.pop();
    let mut width: f32 = whole.iter().sum();
    for &i in &order {
        if width <= room {
            break;
        }
        folded[i] = true;
        width -= whole[i] - dot;
    }
    // What a long one that gave way left is room for shorter ones before it.
    for i in order.into_iter().rev() {
        let more = whole[i] - dot;
        if folded[i] && width + more <= room {
            folded[i] = false;
            width += more;
        }
    }
    folded
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_fits_keeps_its_words() {
        assert_eq!(folded(&[80.0, 90.0], 20.0, &[0, 0], 170.0), [false, false]);
        assert!(folded(&[], 20.0, &[], 0.0).is_empty());
    }

    #[test]
    fn the_least_urgent_become_dots_first() {
        let whole = [100.0, 100.0, 100.0, 100.0];
        // Room for all but one: the last of those that are well gives way.
        assert_eq!(folded(&whole, 20.0, &[0, 2, 0, 3], 330.0), [false, false, true, false]);
        assert_eq!(folded(&whole, 20.0, &[0, 2, 0, 3], 250.0), [true, false, true, false]);
        assert_eq!(folded(&whole, 20.0, &[0, 2, 0, 3], 170.0), [true, true, true, false]);
    }

    #[test]
    fn what_a_long_one_leaves_is_used_by_a_short_one() {
        // Only both together have not enough room.
        assert_eq!(
            folded(&[90.0, 40.0, 200.0, 30.0], 20.0, &[0, 0, 0, 3], 200.0),
            [false, false, true, false]
        );
        assert_eq!(folded(&[200.0, 40.0, 30.0], 20.0, &[0, 0, 3], 100.0), [true, false, false]);
    }

    #[test]
    fn the_worst_keeps_its_words_whatever_the_room() {
        assert_eq!(folded(&[100.0, 100.0], 20.0, &[3, 0], 10.0), [false, true]);
        assert_eq!(folded(&[100.0, 100.0], 20.0, &[2, 2], 10.0), [false, true]);
    }
}
