//! Where the screen lies, from touches of a run.

use std::path::PathBuf;
use std::sync::Arc;

use plumbline_model::robot::Rig;
use plumbline_model::session::Screen;
use plumbline_model::touch_plan::Finger;
use plumbline_model::touchscreen::{ScreenPlacement, place_screen};
use plumbline_model::{Pixel, Point, Robot};

use super::record::TouchRecord;
use super::refusal::Unplaced;

/// A measured place of the screen and the run that it was found from.
#[derive(Clone, Debug)]
pub struct Proposal {
    /// The place.
    pub placement: Arc<ScreenPlacement>,
    /// Folder of the run.
    pub session: PathBuf,
}

/// Places the screen; `rig` has it where it nominally lies.
///
/// # Errors
/// A sentence: why the touches do not tell.
pub fn place(
    rig: &Rig,
    finger: Finger,
    joints: &[String],
    touches: &[TouchRecord],
) -> Result<ScreenPlacement, Unplaced> {
    let chain = rig.chain(finger.tip())?;
    let order: Option<Vec<usize>> =
        chain.names().iter().map(|name| joints.iter().position(|joint| joint == name)).collect();
    let order = order.ok_or(Unplaced::OtherArm)?;
    let fingertip = |touch: &TouchRecord| -> Option<(Pixel<Screen>, Point<Robot>)> {
        let of = |angles: &[Option<f64>]| -> Option<Vec<f64>> {
            order.iter().map(|place| angles.get(*place).copied().flatten()).collect()
        };
        // Encoders say where the joints were; what was commanded differs from that by what the
        // servos gave way, by several millimeters at the tip.
        let angles_rad = of(&touch.encoder_rad).or_else(|| of(&touch.commanded_rad))?;
        let tip = chain.robot_from_tip(&angles_rad).translation_m();
        Some((touch.touched, Point::new(tip.x, tip.y, tip.z)))
    };
    // On a block the screen lies elsewhere; a weight bends the arm.
    let as_it_lies = |touch: &&TouchRecord| touch.screen_height_m == 0.0 && touch.payload_kg == 0.0;
    // A contact beside the image is a defect of the panel.
    let on_image = |touch: &&TouchRecord| rig.touchscreen.contains(touch.touched);
    let usable = touches.iter().filter(as_it_lies).filter(on_image);
    let fingertips: Vec<_> = usable.filter_map(fingertip).collect();
    Ok(place_screen(&rig.touchscreen, &fingertips)?.of_rig(&rig.name))
}
