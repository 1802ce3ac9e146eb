//! The three methods, and what each of them answers.

use plumbline_model::{Point, Robot};
use serde::{Deserialize, Serialize};

/// A kind of correction model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// The placement of the screen, and measured heights, interpolated piecewise linearly.
    M1,
    /// An MLP for x and y, the height of M1.
    M2,
    /// An MLP for x, y and z.
    M3,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::M1, Self::M2, Self::M3];

    /// As it is called: "M1".
    pub fn name(self) -> &'static str {
        match self {
            Self::M1 => "M1",
            Self::M2 => "M2",
            Self::M3 => "M3",
        }
    }

    /// What it is, in a few words for people.
    pub fn about(self) -> &'static str {
        match self {
            Self::M1 => "screen placement and measured height",
            Self::M2 => "network for x and y, measured height",
            Self::M3 => "network for x, y and z",
        }
    }
}

/// What a model answers for a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction {
    /// Where the simulated robot has to be sent.
    pub target: Point<Robot>,
    /// Whether the pixel lies inside the border of the data that the model was trained on.
    pub inside: bool,
    /// Standard deviation of the correction along x, y and z, m: of the model and of a touch
    /// together. The true correction lies within 1.96 of them in 95 of 100 cases, per axis;
    /// larger outside the border, never smaller.
    pub sd_m: [f64; 3],
}
