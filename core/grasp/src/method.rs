//! The methods: what is sent so that the palm comes to an object.

use nalgebra::{Vector2, Vector3};
use plumbline_correction::CorrectionModel;
use plumbline_model::{Point, Robot};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

use crate::knowledge::Knowledge;
use crate::plan::Headed;
use crate::published::heading_rad;

/// How the hand is brought to an object.
///
/// M1 to M4 as published: J. Gavura, I. Farkaš, "Optimization of sim-to-real transfer in the humanoid
/// robot NICO" (2026). M5 is ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// The robot as described; heights interpolated from where the open hand met the table, nothing
    /// corrected horizontally.
    M1,
    /// A network of touches corrects horizontally; heights are interpolated.
    M2,
    /// A network of touches corrects all three; beside its touches heights are interpolated.
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

/// What a published method needs is not there. Reads as a sentence.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotKnown {
    /// No correction was learned.
    #[error("{} needs a model trained from touches: train one in Models, or choose M5", .0.name().to_uppercase())]
    NotTrained(Method),
    /// The heights that were measured do not say anything there.
    #[error("the heights of the hand say nothing there ({0}): measure them anew, or choose M5")]
    NoHeight(String),
}

/// How a published method brings the palm to a place of the table; `None` for M5, which plans for itself.
///
/// The corrections were learned for the fingertip on the glass and are used for the palm above it, as
/// published: a network says where the robot as described must be sent so that its finger meets the glass at
/// a pixel. Which pixel a place has, the place of the screen says. M1 and M4 correct nothing horizontally: the
/// published simulation was aligned by hand, which is the screen as described.
///
/// Heights are those at which the open hand met the table ([`crate::published::HandHeights`]); M3 takes its
/// network's where that was trained, shifted from fingertip to hand. Where nobody has lowered the hand they are
/// those of the fingertip. The palm's middle is sent over the thing by M1, which knows nothing beside the place;
/// for the others the published software shifts the hand by lengths that were found by grasping (2 cm and 3° of
/// the shoulder for M2 and M3, 1 to 3 cm for M4), in place of which stands what was found for this hand.
///
/// # Errors
/// What is missing.
pub fn published(
    method: Method,
    knowledge: &Knowledge,
    place: &Point<Robot>,
) -> Result<Option<Headed>, NotKnown> {
    let [x_m, y_m] = [place.coords.x, place.coords.y];
    let glass_m = knowledge.glass_m(x_m, y_m);
    let pixel = knowledge.model.touchscreen().pixel_at(Point::new(x_m, y_m, glass_m));
    let corrections = &knowledge.corrections;
    let needs = |model: &Option<Arc<CorrectionModel>>| model.clone().ok_or(NotKnown::NotTrained(method));
    let (sent_m, height_m) = match method {
        Method::M5 => return Ok(None),
        Method::M1 | Method::M4 => {
            let sent = knowledge.described.touchscreen.point_at(pixel).coords.coords.xy();
            (sent, support(method, knowledge, [x_m, y_m], sent)?)
        }
        Method::M2 => {
            let sent = needs(&corrections.m2)?.correct(pixel).target.coords.coords.xy();
            (sent, support(method, knowledge, [x_m, y_m], sent)?)
        }
        Method::M3 => {
            let answer = needs(&corrections.m3)?.correct(pixel);
            let sent = answer.target.coords.coords;
            let height_m = match &corrections.hand {
                Some(hand) if answer.inside => sent.z + hand.over_finger_m() - knowledge.support_m(x_m, y_m),
                Some(_) => support(method, knowledge, [x_m, y_m], sent.xy())?,
                None => sent.z - glass_m,
            };
            (sent.xy(), height_m)
        }
    };
    let shift_m = Vector3::new(sent_m.x - x_m, sent_m.y - y_m, height_m);
    let heading_rad = heading_rad(sent_m.x, sent_m.y);
    Ok(Some(Headed { heading_rad, shift_m, centered: method == Method::M1 }))
}

/// How much higher than it is the robot as described has what a thing stands on, where it is sent to, m.
fn support(
    method: Method,
    knowledge: &Knowledge,
    [x_m, y_m]: [f64; 2],
    sent_m: Vector2<f64>,
) -> Result<f64, NotKnown> {
    if let Some(hand) = &knowledge.corrections.hand {
        let at = hand.at(sent_m.x, sent_m.y).map_err(|error| NotKnown::NoHeight(error.to_string()))?;
        return Ok(at.0 - knowledge.support_m(x_m, y_m));
    }
    let m1 = knowledge.corrections.m1.as_ref().and_then(|model| model.m1());
    let heights = &m1.ok_or(NotKnown::NotTrained(method))?.heights;
    Ok(heights.at(sent_m.x, sent_m.y) - knowledge.glass_m(x_m, y_m))
}
