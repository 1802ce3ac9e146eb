//! What is known of the things that are grasped: how high they are, for a hand that comes from above.

/// A thing by the name of its class in the detector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thing {
    /// Name of the class.
    pub class: &'static str,
    /// Twice the height of its middle over what it stands on, m.
    pub height_m: f64,
    /// How wide it is, m.
    pub width_m: f64,
    /// Whether a hand from above can hold it.
    pub can_be_held: bool,
    /// What is seen of it: its outline is the one around all of these.
    pub rounds: &'static [Round],
}

/// An upright ellipsoid over the middle of what a thing stands on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Round {
    /// How wide it is, m.
    pub width_m: f64,
    /// Heights of its lower and its upper end, m.
    pub from_m: f64,
    /// See `from_m`.
    pub to_m: f64,
}

const fn round(width_m: f64, from_m: f64, to_m: f64) -> Round {
    Round { width_m, from_m, to_m }
}

/// The things of the published data set, measured on the toys of the twin: a plush tomato and plastic
/// fruit of about that size.
const THINGS: [Thing; 6] = [
    thing("Tomato", 0.054, 0.062, true, &[round(0.062, 0.0, 0.054)]),
    // A stem under a wide cap: seen from above, the cap is nearly all of it.
    thing("Mushroom", 0.040, 0.044, true, &[round(0.031, 0.0, 0.033), round(0.048, 0.028, 0.040)]),
    // A bulb with a pointed end.
    thing("Onion", 0.040, 0.040, true, &[round(0.041, 0.0, 0.041), round(0.014, 0.028, 0.052)]),
    thing("Orange", 0.036, 0.036, true, &[round(0.036, 0.0, 0.036)]),
    thing("Duck", 0.038, 0.046, false, &[round(0.046, 0.0, 0.038)]),
    thing("Banana", 0.030, 0.080, false, &[round(0.080, 0.0, 0.030)]),
];

const fn thing(
    class: &'static str,
    height_m: f64,
    width_m: f64,
    can_be_held: bool,
    rounds: &'static [Round],
) -> Thing {
    Thing { class, height_m, width_m, can_be_held, rounds }
}

impl Round {
    /// The same of a thing that is larger by a factor.
    #[must_use]
    pub fn scaled(&self, scale: f64) -> Self {
        round(self.width_m * scale, self.from_m * scale, self.to_m * scale)
    }
}

impl Thing {
    /// The thing of a class, whatever the case of its letters.
    pub fn of_class(class: &str) -> Option<Self> {
        THINGS.into_iter().find(|thing| thing.class.eq_ignore_ascii_case(class))
    }

    /// How far its upper end is over what a hand closes around, m: 0 but of what ends in a point.
    pub fn peak_m(&self) -> f64 {
        let top_m = self.rounds.iter().map(|round| round.to_m).fold(0.0, f64::max);
        (top_m - self.height_m).max(0.0)
    }

    /// All that can be held.
    pub fn held() -> impl Iterator<Item = Self> + Clone {
        THINGS.into_iter().filter(|thing| thing.can_be_held)
    }
}
