//! What will be touched on the touchscreen, and in which order.
//!
//! - [`PlanOptions`] say it in the operator's words: area, patterns, sides, heights, weights.
//! - [`TouchPlan::make`] turns them into a list of [`PlannedTouch`]es, the same for the same seed.
//!
//! Every touch belongs to a *set*, which blocks cross-validation (a row of a grid, a line, a
//! quarter of random targets), and to a *group*: touches of one group repeat the same target from
//! the same side under the same conditions, so that their spread is the noise floor.

mod defaults;
mod error;
mod options;
mod order;
mod pattern;
mod random;
mod reach;
#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

use crate::pixel::Pixel;
use crate::session::{Screen, Touchscreen};

pub use error::PlanError;
pub use options::{Finger, Pattern, PlanOptions, Purpose, Sides, TouchArea};

/// More touches than this are a mistake: at 15 s each they take more than 8 hours.
pub const MOST_TOUCHES: usize = 2000;

/// From where the fingertip arrives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// Straight from above.
    Above,
    /// From the robot's left, moving to its right.
    Left,
    /// From the robot's right, moving to its left.
    Right,
}

impl Side {
    /// As it stands in the column `approach` of a session.
    pub fn name(self) -> &'static str {
        match self {
            Self::Above => "above",
            Self::Left => "left",
            Self::Right => "right",
        }
    }
}

/// One touch to come.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlannedTouch {
    /// Its place in the order, from 1.
    pub number: usize,
    /// The pixel to be touched.
    pub target: Pixel<Screen>,
    /// Label that blocks cross-validation.
    pub set: String,
    /// Touches of one group repeat the same target from the same side.
    pub group: String,
    /// From where the fingertip arrives.
    pub side: Side,
    /// Height of the block under the screen, m.
    pub screen_height_m: f64,
    /// Known mass at the palm, kg.
    pub payload_kg: f64,
    /// Its target is sent as the robot is described, whatever corrects others.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub as_described: bool,
}

/// What will be touched, in order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TouchPlan {
    /// What it was made from.
    pub options: PlanOptions,
    /// In the order in which they are made.
    pub touches: Vec<PlannedTouch>,
}

impl TouchPlan {
    /// Makes the plan. What needs the operator's hands (blocks under the screen, weights) changes
    /// as rarely as possible; between two changes the ways are short, and repeats of a target are
    /// spread over the time, so that a slow drift is not taken for a place on the table.
    ///
    /// # Errors
    /// When the options do not describe a plan that can be made: which, and what to do.
    pub fn make(options: &PlanOptions, screen: &Touchscreen) -> Result<Self, PlanError> {
        options.check(screen)?;
        if options.telling().is_some() {
            return Err(PlanError::TellingNeedsArm);
        }
        let targets = pattern::targets(options);
        if options.purpose == Purpose::PlaceScreen && !pattern::span_a_plane(&targets, screen) {
            return Err(PlanError::OnALine);
        }
        let per_block: usize = targets.iter().map(|target| target.times * options.repeats).sum::<usize>()
            * options.sides.all().len();
        let ways = 1 + usize::from(options.beside_described);
        let count = per_block * options.screen_heights_m.len() * options.payloads_kg.len() * ways;
        if count > MOST_TOUCHES {
            return Err(PlanError::TooMany { count, most: MOST_TOUCHES });
        }
        Ok(Self { options: options.clone(), touches: order::touches(options, &targets, screen) })
    }

    /// Numbers (from 1) of touches before which the operator has to change the screen's height or
    /// the weight; the first touch counts if either is not zero.
    pub fn changes(&self) -> Vec<usize> {
        let state = |touch: &PlannedTouch| (touch.screen_height_m, touch.payload_kg);
        let mut before = (0.0, 0.0);
        let mut changes = vec![];
        for touch in &self.touches {
            if state(touch) != before {
                before = state(touch);
                changes.push(touch.number);
            }
        }
        changes
    }
}
