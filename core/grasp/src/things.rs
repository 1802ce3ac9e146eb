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
}

/// The things of the published data set, measured on the toys of the twin: a plush tomato and plastic
/// fruit of about that size.
const THINGS: [Thing; 6] = [
    Thing { class: "Tomato", height_m: 0.054, width_m: 0.062, can_be_held: true },
    Thing { class: "Mushroom", height_m: 0.040, width_m: 0.044, can_be_held: true },
    Thing { class: "Onion", height_m: 0.040, width_m: 0.040, can_be_held: true },
    Thing { class: "Orange", height_m: 0.036, width_m: 0.036, can_be_held: true },
    Thing { class: "Duck", height_m: 0.038, width_m: 0.046, can_be_held: false },
    Thing { class: "Banana", height_m: 0.030, width_m: 0.080, can_be_held: false },
];

impl Thing {
    /// The thing of a class, whatever the case of its letters.
    pub fn of_class(class: &str) -> Option<Self> {
        THINGS.into_iter().find(|thing| thing.class.eq_ignore_ascii_case(class))
    }

    /// All that can be held.
    pub fn held() -> impl Iterator<Item = Self> {
        THINGS.into_iter().filter(|thing| thing.can_be_held)
    }
}
