//! A piece of an eye's image resampled so that epipolar planes are rows.

use image::RgbImage;
use plumbline_model::Eye;

use crate::locate::epipolar::{EpipolarGeometry, EpipolarRay};

/// A lattice of rays: columns along, rows across epipolar planes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    /// Ray of the first cell.
    pub first: EpipolarRay,
    /// Along angle from column to column, rad.
    pub along_step_rad: f64,
    /// Plane angle from row to row, rad.
    pub plane_step_rad: f64,
    pub columns: usize,
    pub rows: usize,
}

impl Grid {
    pub fn ray(&self, column: f64, row: f64) -> EpipolarRay {
        EpipolarRay {
            plane_rad: self.first.plane_rad + row * self.plane_step_rad,
            along_rad: self.first.along_rad + column * self.along_step_rad,
        }
    }

    pub fn len(&self) -> usize {
        self.columns * self.rows
    }
}

/// Colors on a lattice.
#[derive(Debug, Default)]
pub(super) struct Patch {
    /// Red, green, blue, row by row; 0 where the eye does not see.
    pub channels: [Vec<u8>; 3],
    /// 255 where the eye sees, else 0.
    pub seen: Vec<u8>,
    /// Raw pixel of each cell (from the center of the first pixel); not finite where there is none.
    pub raw_px: Vec<[f32; 2]>,
    /// Raw pixels at the nodes of a coarse lattice.
    nodes_px: Vec<[f32; 2]>,
}

/// Cells between two nodes that are projected exactly; between them the raw pixel is interpolated,
/// which is off by some hundredths of a pixel.
const NODE_STEP: usize = 6;

impl Patch {
    /// Takes the colors of the cells out of a raw image.
    pub fn sample(&mut self, geometry: &EpipolarGeometry, eye: Eye, image: &RgbImage, grid: &Grid) {
        self.place(geometry, eye, grid);
        for channel in &mut self.channels {
            channel.clear();
            channel.resize(grid.len(), 0);
        }
        self.seen.clear();
        self.seen.resize(grid.len(), 0);
        let (width, height) = (image.width() as usize, image.height() as usize);
        let data = image.as_raw().as_slice();
        let [red, green, blue] = &mut self.channels;
        for (i, [u, v]) in self.raw_px.iter().enumerate() {
            let inside = *u >= 0.0 && *v >= 0.0 && *u < (width - 1) as f32 && *v < (height - 1) as f32;
            if !inside || width < 2 || height < 2 {
                continue;
            }
            let (x, y) = (*u as usize, *v as usize);
            // Fractions in 1/64: whole numbers are quicker and exact enough for 8 bits.
            let (fx, fy) = (((u - x as f32) * 64.0) as u32, ((v - y as f32) * 64.0) as u32);
            let top = 3 * (y * width + x);
            let below = top + 3 * width;
            let (Some(top), Some(below)) = (data.get(top..top + 6), data.get(below..below + 6)) else {
                continue;
            };
            // Far below the largest number, so nothing wraps.
            let mix = |c: usize| {
                let one = |row: &[u8]| {
                    (u32::from(row[c]).wrapping_mul(64 - fx))
                        .wrapping_add(u32::from(row[c + 3]).wrapping_mul(fx))
                };
                let sum = one(top).wrapping_mul(64 - fy).wrapping_add(one(below).wrapping_mul(fy));
                (sum.wrapping_add(2048) >> 12) as u8
            };
            (red[i], green[i], blue[i], self.seen[i]) = (mix(0), mix(1), mix(2), u8::MAX);
        }
    }

    /// Raw pixels of all cells.
    fn place(&mut self, geometry: &EpipolarGeometry, eye: Eye, grid: &Grid) {
        let node_columns = grid.columns.div_ceil(NODE_STEP) + 1;
        let node_rows = grid.rows.div_ceil(NODE_STEP) + 1;
        self.nodes_px.clear();
        for row in 0..node_rows {
            for column in 0..node_columns {
                let ray = grid.ray((column * NODE_STEP) as f64, (row * NODE_STEP) as f64);
                let pixel = geometry.pixel(eye, &ray).map(|p| [p.u_px as f32, p.v_px as f32]);
                self.nodes_px.push(pixel.unwrap_or([f32::NAN; 2]));
            }
        }
        self.raw_px.clear();
        for row in 0..grid.rows {
            let fy = (row % NODE_STEP) as f32 / NODE_STEP as f32;
            let nodes = &self.nodes_px[row / NODE_STEP * node_columns..];
            let between =
                |a: [f32; 2], b: [f32; 2], f: f32| [a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1])];
            let node = |k: usize| between(nodes[k], nodes[k + node_columns], fy);
            let mut left = node(0);
            for k in 0..node_columns - 1 {
                let right = node(k + 1);
                for i in 0..NODE_STEP.min(grid.columns - k * NODE_STEP) {
                    self.raw_px.push(between(left, right, i as f32 / NODE_STEP as f32));
                }
                left = right;
            }
        }
    }

    /// Brings the colors to those of another patch: each channel times the ratio of the two means.
    pub fn scale(&mut self, gains: [f32; 3]) {
        for (channel, gain) in self.channels.iter_mut().zip(gains) {
            let gain = (gain * 256.0) as u32;
            for value in channel {
                *value = ((u32::from(*value) * gain) >> 8).min(255) as u8;
            }
        }
    }
}
