//! What can be wrong with the touchscreen.

use nalgebra::Vector3;

use super::{Act, Effect, Entry, Is, Shape, Site, TILT_AND_SHIFT, parameter, vector};

pub(super) static SCREEN_BUMPED: Entry = Entry {
    about: "screen was pushed at a moment",
    meaning: "Screen or table moved during the measurement.",
    remedy: "Fix the screen; touch three corners at the start of every session.",
    parameters: &[parameter("dx_m", 0.01), parameter("dy_m", 0.01), parameter("yaw_rad", 0.044)],
    sliding: &[],
    site: Site::Screen,
    shape: Shape::Moment,
    shown: |rows| rows.touches && rows.has_moments(),
    act: Act::Arm(|effect, situation, values, deviation| {
        let part = effect.stepped(situation.row.and_then(|row| row.t_secs));
        deviation.screen_m += Vector3::new(values[0], values[1], 0.0) * part;
        deviation.screen_rad += Vector3::z() * (values[2] * part);
    }),
    reported: Effect::plain,
    is: &[],
};

pub(super) static SCREEN_SCALE: Entry = Entry {
    about: "image larger or smaller than it is described",
    meaning: "A pixel of the screen has another size than the rig file says.",
    remedy: "Measure the lit area with a ruler and correct the rig file.",
    parameters: &[parameter("scale_u", 0.075), parameter("scale_v", 0.075)],
    sliding: &[],
    site: Site::Screen,
    shape: Shape::None,
    shown: |rows| rows.touches,
    act: Act::Arm(|_, _, values, deviation| {
        deviation.screen_scale[0] += values[0];
        deviation.screen_scale[1] += values[1];
    }),
    reported: Effect::plain,
    is: &[Is::Planned],
};

pub(super) static SCREEN_TILT: Entry = Entry {
    about: "screen tilted or shifted",
    meaning: "The screen lies tilted or shifted.",
    remedy: "Level the screen, or measure its place again.",
    parameters: TILT_AND_SHIFT,
    sliding: &[],
    site: Site::Screen,
    shape: Shape::None,
    shown: |rows| rows.touches,
    act: Act::Arm(|_, _, values, deviation| {
        // A screen that moves is an arm that moves the other way.
        deviation.base_rad -= vector(values);
        deviation.base_m -= vector(&values[3..]);
    }),
    reported: Effect::plain,
    is: &[Is::Planned],
};

pub(super) static SCREEN_BOW: Entry = Entry {
    about: "glass bowed",
    meaning: "The glass is bowed.",
    remedy: "Lay a straight edge on it; support its middle.",
    parameters: &[parameter("bow_u_per_m", 0.04), parameter("bow_v_per_m", 0.14)],
    sliding: &[],
    site: Site::Screen,
    shape: Shape::None,
    shown: |rows| rows.touches,
    act: Act::Arm(|_, _, values, deviation| {
        deviation.screen_bow_per_m[0] += values[0];
        deviation.screen_bow_per_m[1] += values[1];
    }),
    reported: Effect::plain,
    is: &[Is::Planned],
};

pub(super) static PANEL_EDGE: Entry = Entry {
    about: "touch panel errs near its border",
    meaning: "The touch panel errs near its border.",
    remedy: "Keep 15 mm away from the border.",
    parameters: &[parameter("edge_m", 0.0015)],
    sliding: &[],
    site: Site::Screen,
    shape: Shape::None,
    shown: |rows| rows.touches,
    act: Act::Arm(|_, _, values, deviation| deviation.screen_edge_m += values[0]),
    reported: Effect::plain,
    is: &[],
};
