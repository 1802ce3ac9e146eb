//! What can be wrong with the eyes, and with what they make of an image.

use super::super::effect::{LEFT, RIGHT};
use super::{Act, Effect, Entry, EyeSite, Parameter, Shape, Site, TILT, parameter, vector};

/// Eyes that warm up turn; they do not wander through the head.
const TURN: [Parameter; 3] =
    [parameter("rot_x_rad", TILT), parameter("rot_y_rad", TILT), parameter("rot_z_rad", TILT)];
/// What rolls and nods as it warms up goes as far as what turns sideways does.
const ROLL_AND_NOD: [Parameter; 2] = [parameter("roll_rad", 0.01), parameter("pitch_rad", 0.01)];
/// What grows is told along the rows alone: across them it would stand for any turn of both eyes.
const SHIFT_ALONG: [Parameter; 1] = [parameter("du_px", 1.5)];

pub(super) static CAMERA_MOUNT: Entry = Entry {
    about: "eyes sit elsewhere in the head than in the model",
    meaning: "The eyes sit elsewhere on the head than in the model.",
    remedy: "Check the screws of the eyes; let the cameras warm up; calibrate the mount again.",
    parameters: &[
        parameter("x_m", 0.02),
        parameter("y_m", 0.02),
        parameter("z_m", 0.02),
        parameter("rot_x_rad", TILT),
        parameter("rot_y_rad", TILT),
        parameter("rot_z_rad", TILT),
    ],
    sliding: &[],
    site: Site::OfEyes(EyeSite::Both),
    shape: Shape::Growth(&TURN),
    shown: |rows| rows.eyes,
    act: Act::Eyes(|effect, situation, values, deviation| {
        if effect.shape.is_some() {
            deviation.mount_rad += vector(values) * effect.part(situation.t_secs);
        } else {
            deviation.mount_m += vector(values);
            deviation.mount_rad += vector(&values[3..]);
        }
    }),
    reported: Effect::plain,
    is: &[],
};

pub(super) static HEAD_JOINT: Entry = Entry {
    about: "zero position of the neck off",
    meaning: "The head stands elsewhere than its encoders say.",
    remedy: "Look at targets from one side; check the zeros of the head.",
    parameters: &[parameter("offset_rad", TILT)],
    sliding: &[],
    site: Site::OfEyes(EyeSite::Neck),
    shape: Shape::None,
    shown: |rows| rows.eyes,
    act: Act::Eyes(|effect, _, values, deviation| {
        if let Some(angle) = effect.joint.and_then(|j| deviation.neck_rad.get_mut(j)) {
            *angle += values[0];
        }
    }),
    reported: Effect::plain,
    is: &[],
};

pub(super) static EYE_YAW: Entry = Entry {
    about: "right eye turned sideways against the left one",
    meaning: "The eyes turn against each other, which falsifies depth.",
    remedy: "Let the cameras warm up; check their mounts; calibrate warm.",
    parameters: &[parameter("yaw_rad", 0.01)],
    sliding: &[],
    site: Site::OfEyes(EyeSite::Right),
    shape: Shape::Growth(&[parameter("amplitude_rad", 0.01)]),
    shown: |rows| rows.eyes,
    act: Act::Eyes(|effect, situation, values, deviation| {
        deviation.right_rad.y += values[0] * effect.part(situation.t_secs);
    }),
    reported: Effect::plain,
    is: &[],
};

pub(super) static IMAGE_SHIFT: Entry = Entry {
    about: "image shifted",
    meaning: "The image of one eye is shifted on its sensor.",
    remedy: "Check that the lens is screwed tight; calibrate warm.",
    parameters: &[parameter("du_px", 1.5), parameter("dv_px", 1.5)],
    sliding: &[],
    site: Site::OfEyes(EyeSite::One),
    shape: Shape::Growth(&SHIFT_ALONG),
    shown: |rows| rows.eyes,
    act: Act::Eyes(|effect, situation, values, deviation| {
        let part = effect.part(situation.t_secs);
        let is_left = effect.site == LEFT;
        let shift_px = if is_left { &mut deviation.left_shift_px } else { &mut deviation.right_shift_px };
        shift_px[0] += values[0] * part;
        shift_px[1] += values.get(1).copied().unwrap_or(0.0) * part;
    }),
    reported: Effect::plain,
    is: &[],
};

pub(super) static FOCAL_OR_BASELINE: Entry = Entry {
    about: "focal length or distance of the eyes wrong",
    meaning: "All distances come out too long or too short by the same share.",
    remedy: "Calibrate again with a board whose squares were measured.",
    parameters: &[parameter("scale", 0.05)],
    sliding: &[],
    site: Site::OfEyes(EyeSite::Both),
    shape: Shape::OneOf(&["focal length", "distance of the eyes"]),
    shown: |rows| rows.eyes,
    act: Act::Eyes(|effect, _, values, deviation| match effect.shape {
        None => deviation.focal_scale += values[0],
        Some(_) => deviation.baseline_scale += values[0],
    }),
    reported: Effect::one_of,
    is: &[],
};

pub(super) static EYE_ROLL: Entry = Entry {
    about: "right eye rolled or pitched against the left one",
    meaning: "One eye is rolled or pitched against the other.",
    remedy: "Check the mounts of the eyes; let the cameras warm up; calibrate the stereo pair again.",
    parameters: &[parameter("roll_rad", 0.01), parameter("pitch_rad", 0.01)],
    sliding: &[],
    site: Site::OfEyes(EyeSite::Right),
    shape: Shape::Growth(&ROLL_AND_NOD),
    shown: |rows| rows.eyes,
    act: Act::Eyes(|effect, situation, values, deviation| {
        let part = effect.part(situation.t_secs);
        deviation.right_rad.z += values[0] * part;
        deviation.right_rad.x += values[1] * part;
    }),
    reported: Effect::plain,
    is: &[],
};

pub(super) static EYE_KNOCK: Entry = Entry {
    about: "right eye stood otherwise against the left one",
    meaning: "One eye turned against the other between the sets of a measurement.",
    remedy: "Let the cameras warm up, check their mounts, and measure that set again.",
    parameters: &[parameter("pitch_rad", 0.01), parameter("yaw_rad", 0.01), parameter("roll_rad", 0.01)],
    sliding: &[],
    site: Site::OfEyes(EyeSite::Set),
    shape: Shape::None,
    shown: |rows| !rows.eye_sets.is_empty(),
    act: Act::Eyes(|effect, situation, values, deviation| {
        if situation.set.as_deref() == Some(effect.site.as_str()) {
            deviation.right_rad += vector(values);
        }
    }),
    reported: Effect::plain,
    is: &[],
};

pub(super) static LENS_DISTORTION: Entry = Entry {
    about: "lens distortion left over",
    meaning: "Some lens distortion is left, growing towards the border of the image.",
    remedy: "Calibrate with the board out to the corners of the image.",
    parameters: &[parameter("k_px", 8.0)],
    sliding: &[],
    site: Site::OfEyes(EyeSite::BothOrOne),
    shape: Shape::None,
    shown: |rows| rows.eyes,
    act: Act::Eyes(|effect, _, values, deviation| {
        let [left, right] = &mut deviation.distortion_px;
        *left += if effect.site == RIGHT { 0.0 } else { values[0] };
        *right += if effect.site == LEFT { 0.0 } else { values[0] };
    }),
    reported: Effect::plain,
    is: &[],
};

pub(super) static DISPARITY_STEPS: Entry = Entry {
    about: "disparity comes in steps",
    meaning: "Depth comes in steps of the matcher.",
    remedy: "Use the sub-pixel matcher, or a finer rectified image.",
    parameters: &[parameter("step_px", 0.03)],
    sliding: &[],
    site: Site::OfEyes(EyeSite::Both),
    shape: Shape::None,
    shown: |_| false,
    // Steps are a sawtooth in depth, which no tangent shows.
    act: Act::Unseen,
    reported: Effect::plain,
    is: &[],
};

pub(super) static BACKGROUND_BLEED: Entry = Entry {
    about: "depth of the background leaks in",
    meaning: "The matcher mixes the background into the depth of small things.",
    remedy: "Put a card behind the hand, or use a smaller matching window.",
    parameters: &[parameter("weight", 0.5)],
    sliding: &[],
    site: Site::OfEyes(EyeSite::Both),
    shape: Shape::None,
    shown: |rows| rows.background,
    act: Act::Eyes(|_, situation, values, deviation| {
        if situation.background_m.is_some() {
            deviation.background_share += values[0];
        }
    }),
    reported: Effect::plain,
    is: &[],
};

pub(super) static FOREGROUND_FATTENING: Entry = Entry {
    about: "what is near seems wider than it is",
    meaning: "Things look wider by half a matching window.",
    remedy: "Use a smaller window, or measure in the middle of things.",
    parameters: &[parameter("shift_px", 1.5)],
    sliding: &[],
    site: Site::OfEyes(EyeSite::Both),
    shape: Shape::None,
    shown: |rows| rows.background,
    act: Act::Eyes(|_, situation, values, deviation| {
        // Only as far as there is a step in depth behind the edge.
        let range_m = situation.in_left_m.coords.norm();
        let step = situation.background_m.map_or(0.0, |behind_m| 1.0 - range_m / behind_m.max(range_m));
        deviation.box_px[0] += values[0] * step;
    }),
    reported: Effect::plain,
    is: &[],
};

pub(super) static SEEN_SURFACE: Entry = Entry {
    about: "eyes see the surface, not the middle",
    meaning: "The eyes see the surface, the model means the center.",
    remedy: "Enter the radius of the thing, or mark a point on it.",
    parameters: &[parameter("radius_m", 0.02)],
    sliding: &[],
    site: Site::OfEyes(EyeSite::Both),
    shape: Shape::None,
    shown: |rows| rows.eyes,
    act: Act::Eyes(|_, _, values, deviation| deviation.nearer_m += values[0]),
    reported: Effect::plain,
    is: &[],
};

pub(super) static BOX_BIAS: Entry = Entry {
    about: "detected box sits beside the object",
    meaning: "The detector's box is not centered on what it detects.",
    remedy: "Label again, or use a printed marker.",
    parameters: &[parameter("du_px", 4.0), parameter("dv_px", 4.0)],
    sliding: &[],
    site: Site::OfEyes(EyeSite::Both),
    shape: Shape::None,
    shown: |rows| rows.eyes,
    act: Act::Eyes(|_, _, values, deviation| {
        deviation.box_px[0] += values[0];
        deviation.box_px[1] += values[1];
    }),
    reported: Effect::plain,
    is: &[],
};

pub(super) static EYE_LATENCY: Entry = Entry {
    about: "eyes do not look at the same moment",
    meaning: "The two images, or image and angles, are not of the same moment.",
    remedy: "Hold still while measuring, or trigger both eyes together.",
    parameters: &[parameter("latency_s", 0.025)],
    sliding: &[],
    site: Site::OfEyes(EyeSite::Both),
    shape: Shape::None,
    shown: |_| false,
    // Latency needs motion, which no column holds.
    act: Act::Unseen,
    reported: Effect::plain,
    is: &[],
};
