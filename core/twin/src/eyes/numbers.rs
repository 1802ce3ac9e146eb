//! Frame, eyes and sensor as the vec4 that the shaders read.

use nalgebra::Isometry3;
use plumbline_model::{Eye, Fisheye};

use super::gpu::{FRAME_VEC4, SENSOR_VEC4};
use super::pack::rows;
use super::sensor::{SHELL_STEPS, Sensor, theta_d};
use super::shadow::{self, Shadow};
use crate::scene::Scenery;

/// The numbers of `Frame` in the shaders.
pub(super) fn frame_numbers(
    lenses: &[Fisheye; 2],
    poses: &[Isometry3<f64>; 2],
    scenery: &Scenery,
    shadow: &Shadow,
    sensor: &Sensor,
    size: (u32, u32),
) -> Vec<[f32; 4]> {
    let mut out = Vec::with_capacity(FRAME_VEC4);
    for (lens, pose) in lenses.iter().zip(poses) {
        out.extend(rows(pose));
        out.push([lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px].map(|n| n as f32));
        out.push(lens.k.map(|n| n as f32));
        let widest = (f64::from(sensor.image_circle_rad) + 0.1).min(lens.limit_rad());
        out.push([lens.skew_px, widest, theta_d(lens, widest), 1.0 / lens.fx_px].map(|n| n as f32));
    }
    out.extend(shadow.light_from_robot);
    let l = &shadow.to_lamp;
    out.push([l.x as f32, l.y as f32, l.z as f32, scenery.light.lamp.max(0.0)]);
    let ambient = scenery.light.ambient.max(0.0);
    out.push([ambient, shadow.texel_m, shadow::SIDE as f32, 0.3 * ambient]);
    out.push([size.0 as f32, size.1 as f32, 0.0, 0.0]);
    let [red, green, blue] = sensor.white_balance.map(|factor| factor * sensor.exposure);
    out.push([red, green, blue, 0.0]);
    out
}

/// The numbers of `Sensor` in the shader, and the taps of the blur.
pub(super) fn sensor_numbers(
    lenses: &[Fisheye; 2],
    sensor: &Sensor,
    size: (u32, u32),
    seed: u64,
) -> (Vec<[f32; 4]>, usize) {
    let mut out = Vec::with_capacity(SENSOR_VEC4);
    for (lens, eye) in lenses.iter().zip(Eye::BOTH) {
        out.push([lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px].map(|n| n as f32));
        let edge = theta_d(lens, f64::from(sensor.image_circle_rad));
        // The rim is a little soft even in focus.
        let soft = f64::from(1.2 + sensor.blur_px) / lens.fx_px;
        out.push([lens.skew_px, edge, soft, eye.index() as f64].map(|n| n as f32));
        let shell = sensor.shell_edges(eye, lens);
        out.extend(
            (0..SHELL_STEPS / 4)
                .map(|i| [shell[4 * i], shell[4 * i + 1], shell[4 * i + 2], shell[4 * i + 3]]),
        );
    }
    let [r, g, b] = sensor.white_balance.map(|factor| factor * sensor.exposure);
    out.push([r, g, b, sensor.falloff]);
    let shell = sensor.shell.unwrap_or_default();
    out.push([shell.light[0], shell.light[1], shell.light[2], shell.softness_rad]);
    let mut weights = sensor.blur_weights();
    out.push([sensor.full_well_electrons, sensor.read_noise_electrons, 0.0, 0.0]);
    let taps = weights.len() - 1;
    weights.resize(8, 0.0);
    out.extend(weights.chunks(4).map(|w| [w[0], w[1], w[2], w[3]]));
    // Two halves of 16 bits stay exact as floats.
    let mixed = seed ^ (seed >> 32);
    out.push([size.0 as f32, size.1 as f32, (mixed & 0xffff) as f32, (mixed >> 16 & 0xffff) as f32]);
    (out, taps)
}
