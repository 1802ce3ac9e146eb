//! The effects that are sized together, and rows of one arm for them.

use plumbline_effects::arm::Arm;
use plumbline_effects::measurements::{Apparatus, Observation, What};
use plumbline_effects::{Effect, Kind, Measurements, Surface};
use plumbline_model::robot::{Arm as RigArm, Rig};

/// Standard deviation of a contact along the glass and of the tip's height there, m.
pub const NOISE_M: [f64; 3] = [0.8e-3, 0.8e-3, 0.6e-3];
/// A person lays the screen where it belongs to within, m and rad.
pub const SCREEN_SD: [f64; 2] = [0.01, 0.02];

/// Effects of usual size at every site of an arm.
pub fn usual(arm: &Arm) -> Vec<Effect> {
    // Encoders are logged: what they see needs no effect.
    Effect::all(arm).into_iter().filter(|effect| !effect.kind.is_seen_by_encoder()).collect()
}

/// Whether an effect moves the palm too, or only the fingertip on its screen.
pub fn moves_palm(effect: &Effect) -> bool {
    !matches!(
        effect.kind,
        Kind::TipOffset
            | Kind::FingerBend
            | Kind::FingerRoll
            | Kind::TouchDrag
            | Kind::ScreenScale
            | Kind::ScreenTilt
            | Kind::ScreenBow
            | Kind::PanelEdge
    )
}

/// Whether it is the zero of the joint that an arm begins with.
pub fn is_first_zero(effect: &Effect, rig: &Rig) -> bool {
    let first =
        |arm: &RigArm| arm.joints.first().is_some_and(|j| rig.description.joint(*j).name == effect.site);
    effect.kind == Kind::JointZero && rig.arms.iter().any(first)
}

/// Rows of one arm, on a screen or before the eyes.
pub fn measurements(rig: &Rig, arm: Arm, surface: Option<Surface>, rows: Vec<Observation>) -> Measurements {
    let apparatus = Apparatus { arm: Some(arm), surface, ..Apparatus::default() };
    Measurements {
        rig: rig.name.clone(),
        apparatuses: vec![apparatus],
        rows,
        left_out: vec![],
        present: vec![],
    }
}

/// A row that was not measured yet, the servos where they were sent. Angles in rad, from which side each
/// joint came as 1 or −1.
pub fn row(what: What, encoder_rad: Vec<f64>, direction: Vec<f64>) -> Observation {
    Observation {
        commanded_rad: Some(encoder_rad.clone()),
        encoder_rad: Some(encoder_rad),
        direction,
        ..Observation::imagined(what)
    }
}
