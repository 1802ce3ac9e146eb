//! The methods: what is sent so that the palm comes to an object.

use nalgebra::Vector3;
use plumbline_correction::CorrectionModel;
use plumbline_model::{Point, Robot};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

use crate::knowledge::Knowledge;

/// How the hand is brought to an object.
///
/// M1 to M4 as published: J. Gavura, I. Farkaš, "Optimization of sim-to-real transfer in the humanoid
/// robot NICO" (2026). M5 is ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// The robot as described; heights interpolated from touches, nothing corrected horizontally.
    M1,
    /// A network of touches corrects horizontally; heights are interpolated.
    M2,
    /// A network of touches corrects all three.
    M3,
    /// The robot as described, then the detected hand is brought to the detected object.
    M4,
    /// The robot with the effects that were named, then the hand, rendered where the model has it and
    /// compared with what both eyes see, is brought to the object.
    M5,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::M1, Self::M2, Self::M3, Self::M4, Self::M5];

    /// Short name, lower case.
    pub fn name(self) -> &'static str {
        match self {
            Self::M1 => "m1",
            Self::M2 => "m2",
            Self::M3 => "m3",
            Self::M4 => "m4",
            Self::M5 => "m5",
        }
    }

    /// The method of a short name, whatever the case of its letters.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name().eq_ignore_ascii_case(name.trim()))
    }

    /// Whether it looks for the hand before it grasps.
    pub fn aligns(self) -> bool {
        matches!(self, Self::M4 | Self::M5)
    }

    /// How often it tries in all when the hand comes up empty. The published ones try once.
    pub fn tries(self) -> usize {
        if self == Self::M5 { 3 } else { 1 }
    }

    /// Whether it uses the effects that were named.
    pub fn knows_effects(self) -> bool {
        self == Self::M5
    }
}

/// A correction that the method needs is not there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{} needs a model trained from touches: train one in Models, or choose M5", .0.name().to_uppercase())]
pub struct NotTrained(pub Method);

/// What is added to a place of the table so that the real hand comes there, m; and whether the method
/// knows that part of the table.
///
/// The corrections were learned for the fingertip on the glass and are used for the palm above it, as
/// published: a model says where the robot as described must be sent so that its finger meets the glass at
/// a pixel. Which pixel a place has, the place of the screen says, to which the published simulation was
/// aligned by hand.
///
/// # Errors
/// When the model was not trained.
pub fn correction(
    method: Method,
    knowledge: &Knowledge,
    place: &Point<Robot>,
) -> Result<(Vector3<f64>, bool), NotTrained> {
    let screen = knowledge.model.touchscreen();
    let [x_m, y_m] = [place.coords.x, place.coords.y];
    let glass_m = knowledge.glass_m(x_m, y_m);
    let needs = |model: &Option<Arc<CorrectionModel>>| model.clone().ok_or(NotTrained(method));
    let height = |x_m: f64, y_m: f64| -> Result<f64, NotTrained> {
        let m1 = needs(&knowledge.corrections.m1)?;
        Ok(m1.m1().ok_or(NotTrained(method))?.heights.at(x_m, y_m) - glass_m)
    };
    let pixel = screen.pixel_at(Point::new(x_m, y_m, glass_m));
    match method {
        Method::M1 | Method::M4 => Ok((Vector3::new(0.0, 0.0, height(x_m, y_m)?), true)),
        Method::M2 => {
            let answer = needs(&knowledge.corrections.m2)?.correct(pixel);
            let sent = answer.target.coords;
            Ok((Vector3::new(sent.x - x_m, sent.y - y_m, height(sent.x, sent.y)?), answer.inside))
        }
        Method::M3 => {
            let answer = needs(&knowledge.corrections.m3)?.correct(pixel);
            let sent = answer.target.coords;
            Ok((Vector3::new(sent.x - x_m, sent.y - y_m, sent.z - glass_m), answer.inside))
        }
        Method::M5 => Ok((Vector3::zeros(), true)),
    }
}
