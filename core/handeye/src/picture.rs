//! What the eyes saw from head poses.

use image::{GrayImage, imageops};
use plumbline_grasp::{Body, Halt, Sight};
use plumbline_model::robot::Posture;
use plumbline_model::{Eye, JobContext};

use crate::HandEyeError;

/// Peak speed of the head, rad/s.
const SPEED_RAD_S: f64 = 0.6;
/// The eyes settle, s.
const STILL_S: f64 = 0.3;

/// An image of one eye, and where the head stood by its encoders.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Gray levels, raw.
    pub image: GrayImage,
    /// Of which eye.
    pub eye: Eye,
    /// All joints by their encoders.
    pub posture: Posture,
    /// Number of the head pose, from 0.
    pub head: usize,
}

/// Both images of a pair.
pub(crate) fn grays(sight: &Sight) -> [(GrayImage, Eye); 2] {
    [(imageops::grayscale(&*sight.left), Eye::Left), (imageops::grayscale(&*sight.right), Eye::Right)]
}

/// A pair when everything stands still.
pub(crate) fn still(body: &mut dyn Body) -> Result<Sight, Halt> {
    body.wait(STILL_S)?;
    body.look()
}

/// Turns the head to poses (turn and nod, rad) one after the other and looks from each; back home at the end.
/// Only the head moves. `look` is told of each before it is gone to.
pub(crate) fn from_head_poses(
    body: &mut dyn Body,
    poses_rad: &[[f64; 2]],
    looks: &mut dyn FnMut(usize),
    context: &dyn JobContext,
) -> Result<Vec<Picture>, HandEyeError> {
    let rig = body.rig().clone();
    let (home, head) = (rig.home(), [rig.eyes.pan, rig.eyes.tilt]);
    let mut pictures = vec![];
    for (number, angles_rad) in poses_rad.iter().enumerate() {
        context.checkpoint()?;
        looks(number);
        turn(body, &head, angles_rad)?;
        let sight = still(body)?;
        for (image, eye) in grays(&sight) {
            pictures.push(Picture { image, eye, posture: sight.posture.clone(), head: number });
        }
    }
    turn(body, &head, &head.map(|joint| home[joint]))?;
    Ok(pictures)
}

fn turn(
    body: &mut dyn Body,
    head: &[plumbline_model::robot::JointIndex; 2],
    angles_rad: &[f64; 2],
) -> Result<(), Halt> {
    let there = body.commanded()?.with(head, angles_rad);
    body.follow(&[there], SPEED_RAD_S)
}
