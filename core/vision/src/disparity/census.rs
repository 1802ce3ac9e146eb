//! Census transform: each pixel becomes the list of which neighbors are darker than it.
//!
//! Two such lists are compared by counting the places where they differ. That does not care
//! about gain and offset, which the two eyes set each for itself.
//!
//! Source: Zabih, Woodfill: Non-parametric local transforms for computing visual
//! correspondence (1994).

use fearless_simd::{Level, dispatch};
use image::GrayImage;
use rayon::prelude::*;

/// Half width and half height of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    pub half_width: usize,
    pub half_height: usize,
}

impl Window {
    /// Number of comparisons: every pixel of the window but the middle one.
    pub fn bits(self) -> usize {
        (2 * self.half_width + 1) * (2 * self.half_height + 1) - 1
    }

    /// Bytes that hold them.
    pub fn planes(self) -> usize {
        self.bits().div_ceil(8)
    }

    fn offsets(self) -> impl Iterator<Item = (usize, usize)> {
        let (columns, rows) = (2 * self.half_width + 1, 2 * self.half_height + 1);
        let middle = (self.half_width, self.half_height);
        (0..rows).flat_map(move |y| (0..columns).map(move |x| (x, y))).filter(move |place| *place != middle)
    }
}

/// Which way the columns run; the right image is kept mirrored so that growing disparity means
/// growing index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Columns {
    Forward,
    Mirrored,
}

/// The transform of an image: `planes` rows of bytes for every row of the image.
#[derive(Default)]
pub(super) struct Census {
    bytes: Vec<u8>,
    planes: usize,
    width: usize,
}

impl Census {
    /// Transforms `image`; pixels past the edge count as the edge's. Reuses the memory.
    pub fn compute(&mut self, image: &GrayImage, window: Window, columns: Columns) {
        let (width, height) = (image.width() as usize, image.height() as usize);
        self.planes = window.planes();
        self.width = width;
        self.bytes.resize(self.planes * width * height, 0);
        let pixels = image.as_raw();
        let level = Level::new();
        self.bytes.par_chunks_mut(self.planes * width).enumerate().for_each(|(y, out)| {
            // Rows of the window, with the edge pixels repeated to both sides.
            let padded: Vec<Vec<u8>> = (0..=2 * window.half_height)
                .map(|i| {
                    let row = (y + i).saturating_sub(window.half_height).min(height - 1);
                    pad(&pixels[row * width..][..width], window.half_width, columns)
                })
                .collect();
            dispatch!(level, _simd => transform_row(&padded, window, columns, out, width));
        });
    }

    /// One byte of the transform along row `y`.
    #[inline(always)]
    pub fn plane(&self, y: usize, plane: usize) -> &[u8] {
        &self.bytes[(y * self.planes + plane) * self.width..][..self.width]
    }

    pub fn planes(&self) -> usize {
        self.planes
    }
}

fn pad(row: &[u8], margin: usize, columns: Columns) -> Vec<u8> {
    let (first, last) = (row[0], row[row.len() - 1]);
    let mut padded = vec![first; margin];
    padded.extend_from_slice(row);
    padded.resize(row.len() + 2 * margin, last);
    if columns == Columns::Mirrored {
        padded.reverse();
    }
    padded
}

#[inline(always)]
fn transform_row(padded: &[Vec<u8>], window: Window, columns: Columns, out: &mut [u8], width: usize) {
    out.fill(0);
    let middle = &padded[window.half_height][window.half_width..][..width];
    for (index, (x, y)) in window.offsets().enumerate() {
        // A mirrored image asks its neighbors in mirrored order, to get the same list.
        let x = if columns == Columns::Mirrored { 2 * window.half_width - x } else { x };
        let plane = &mut out[index / 8 * width..][..width];
        let bit = 1u8 << (index % 8);
        let neighbor = &padded[y][x..][..width];
        for ((byte, neighbor), middle) in plane.iter_mut().zip(neighbor).zip(middle) {
            *byte |= if neighbor < middle { bit } else { 0 };
        }
    }
}
