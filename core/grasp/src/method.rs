//! The methods: what is sent so that the palm comes to an object.

use nalgebra::{Vector2, Vector3};
use plumbline_correction::CorrectionModel;
use plumbline_model::{Point, Robot};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

use crate::hands::{Hand, HandChoice};
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

    /// The hands among which it chooses, the usual one first.
    ///
    /// # Errors
    /// When the published methods are asked for the left hand: what they know was learned with the right one.
    pub fn hands(self, choice: HandChoice) -> Result<&'static [Hand], PublishedWithRight> {
        match (choice, self) {
            (HandChoice::Right, _) | (HandChoice::Auto, Self::M1 | Self::M2 | Self::M3 | Self::M4) => {
                Ok(&[Hand::Right])
            }
            (HandChoice::Left, Self::M5) => Ok(&[Hand::Left]),
            (HandChoice::Auto, Self::M5) => Ok(&Hand::BOTH),
            (HandChoice::Left, _) => Err(PublishedWithRight(self)),
        }
    }

    /// Whether it uses the effects that were named.
    pub fn knows_effects(self) -> bool {
        self == Self::M5
    }
}

/// A published method was asked for the left hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{} knows the right hand only, with which it was learned: choose the right hand, or M5", .0.name().to_uppercase())]
pub struct PublishedWithRight(pub Method);

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
            let over_finger_m = corrections.hand.as_ref().map(|hand| hand.over_finger_m());
            let height_m = match over_finger_m {
                Some(Some(over_m)) if answer.inside => sent.z + over_m - knowledge.support_m(x_m, y_m),
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

#[cfg(test)]
mod tests {
    use plumbline_correction::tables::{HeightPoint, HeightTable};
    use plumbline_effects::RobotModel;
    use plumbline_model::StereoCalibration;
    use plumbline_model::robot::Rig;

    use super::*;
    use crate::knowledge::Corrections;
    use crate::published::HandHeights;

    /// A robot whose screen was found to lie 10 mm farther away than described, and whose hand has the
    /// table 20 mm higher than it is.
    fn knowledge(hand: bool) -> Knowledge {
        let rig = Arc::new(Rig::built_in("nico").expect("valid"));
        let mut found = (*rig).clone();
        found.touchscreen = found.touchscreen.moved(&nalgebra::Isometry3::translation(0.010, 0.0, 0.0));
        let points = (0..45).map(|k| HeightPoint {
            x_m: 0.15 + 0.07 * f64::from(k % 5),
            y_m: -0.42 + 0.09 * f64::from(k / 5),
            height_m: rig.touchscreen.origin.coords.z + 0.020,
        });
        let table = HeightTable::new(points.collect()).expect("a table");
        let hand = hand.then(|| Arc::new(HandHeights::new(&table, []).expect("usable")));
        Knowledge {
            model: RobotModel::nominal(Arc::new(found)),
            described: rig.clone(),
            calibration: Arc::new(StereoCalibration::bare(rig.eyes.cameras)),
            corrections: Corrections { hand, ..Corrections::default() },
        }
    }

    #[test]
    fn m1_sends_the_middle_of_the_palm_by_the_screen_as_described_at_heights_of_the_hand() {
        let knowledge = knowledge(true);
        let place = Point::new(0.35, -0.1, 0.08);
        let headed = published(Method::M1, &knowledge, &place).expect("known").expect("published");
        assert!(headed.centered);
        let off = headed.shift_m - Vector3::new(-0.010, 0.0, 0.020);
        assert!(off.xy().norm() < 1e-6 && off.z.abs() < 5e-4, "{}", headed.shift_m);
        // M4 begins there, too, with the grip over the thing.
        let m4 = published(Method::M4, &knowledge, &place).expect("known").expect("published");
        assert_eq!(m4, Headed { centered: false, ..headed });
    }

    #[test]
    fn what_is_missing_is_named_and_m5_needs_nothing_of_it() {
        let place = Point::new(0.35, -0.1, 0.08);
        for (method, hand) in
            [(Method::M1, false), (Method::M2, true), (Method::M3, true), (Method::M4, false)]
        {
            let missing = published(method, &knowledge(hand), &place).expect_err("nothing was learned");
            assert_eq!(missing, NotKnown::NotTrained(method));
            assert!(missing.to_string().contains("train one in Models"), "{missing}");
        }
        assert_eq!(published(Method::M5, &knowledge(false), &place), Ok(None));
    }

    #[test]
    fn published_methods_grasp_with_the_right_hand_and_ours_with_either() {
        for method in Method::ALL {
            let both = method == Method::M5;
            let auto = method.hands(HandChoice::Auto).expect("there is always the right one");
            assert_eq!(auto.len(), if both { 2 } else { 1 }, "{method:?}");
            assert_eq!(auto[0], Hand::Right);
            assert_eq!(method.hands(HandChoice::Right), Ok(&[Hand::Right][..]));
            match method.hands(HandChoice::Left) {
                Ok(hands) => assert!(both && hands == [Hand::Left]),
                Err(why) => assert!(!both && why.to_string().contains("right hand only"), "{why}"),
            }
        }
    }
}
