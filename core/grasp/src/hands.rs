//! Which hand grasps.

use serde::{Deserialize, Serialize};

/// A hand, named as the rig names its arm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Hand {
    /// The right one, with which the published methods grasp.
    #[default]
    Right,
    /// The left one.
    Left,
}

impl Hand {
    /// Both, the right one first.
    pub const BOTH: [Self; 2] = [Self::Right, Self::Left];

    /// Name of its arm in the rig.
    pub fn name(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Left => "left",
        }
    }

    /// The hand of an arm by the arm's name in the rig.
    pub fn of_arm(name: &str) -> Option<Self> {
        Self::BOTH.into_iter().find(|hand| hand.name() == name)
    }

    /// The tip of its index finger, with which it touches.
    pub fn index_tip(self) -> &'static str {
        match self {
            Self::Right => "right_index_tip",
            Self::Left => "left_index_tip",
        }
    }

    /// The middle of its palm.
    pub fn palm(self) -> &'static str {
        match self {
            Self::Right => "right_palm_center",
            Self::Left => "left_palm_center",
        }
    }
}

/// With which hand is to be grasped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum HandChoice {
    /// With the one whose plan is best. The published methods grasp with the right one.
    #[default]
    Auto,
    /// With the right one.
    Right,
    /// With the left one.
    Left,
}

impl HandChoice {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Auto, Self::Right, Self::Left];

    /// Short name, lower case.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Right => "right",
            Self::Left => "left",
        }
    }

    /// The choice of a short name, whatever the case of its letters.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|choice| choice.name().eq_ignore_ascii_case(name.trim()))
    }

    /// The hand that was asked for; `None`: any.
    pub fn asked(self) -> Option<Hand> {
        match self {
            Self::Auto => None,
            Self::Right => Some(Hand::Right),
            Self::Left => Some(Hand::Left),
        }
    }
}

impl From<Hand> for HandChoice {
    fn from(hand: Hand) -> Self {
        match hand {
            Hand::Right => Self::Right,
            Hand::Left => Self::Left,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_found_by_their_names() {
        for choice in HandChoice::ALL {
            assert_eq!(HandChoice::from_name(&choice.name().to_uppercase()), Some(choice));
        }
        assert_eq!(HandChoice::from_name("middle"), None);
    }
}
