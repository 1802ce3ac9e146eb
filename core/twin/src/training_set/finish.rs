//! What the camera's own processing makes of an image: contrast, color, sharpening, fewer colors.

use image::RgbImage;

use super::dice::Dice;

/// The edge of what a lens shows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Rim {
    /// Middle of the image circle.
    pub middle_px: [f32; 2],
    /// Its radius.
    pub radius_px: f32,
}

/// How a camera processes its images.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Finish {
    /// Edges of the left and the right image.
    rims: [Rim; 2],
    /// Breadth of the rim that turns blue, px.
    blue_px: f32,
    /// Exponent of brightness.
    gamma: f32,
    /// Strength of the S-curve, 0–1.
    contrast: f32,
    /// Factor on the distance from gray.
    saturation: f32,
    /// Strength of the unsharp mask.
    sharpen: f32,
    /// Added to all, from 0 to 1: fog, or crushed blacks.
    lift: f32,
    /// Side of the blocks that share a color.
    color_block: u32,
    /// Quality of the JPEG file, 1–100.
    pub quality: u8,
}

impl Finish {
    /// Any camera.
    pub fn draw(rims: [Rim; 2], dice: &mut Dice) -> Self {
        let usual = dice.chance(0.7);
        Self {
            rims,
            blue_px: if dice.chance(0.7) { dice.within_f32(2.0, 26.0) } else { 0.0 },
            gamma: if usual { dice.within_f32(0.85, 1.15) } else { dice.within_f32(0.7, 1.45) },
            contrast: if usual { dice.within_f32(0.2, 0.8) } else { dice.within_f32(0.0, 1.0) },
            saturation: if usual { dice.within_f32(0.9, 1.45) } else { dice.within_f32(0.6, 1.8) },
            sharpen: if dice.chance(0.7) { dice.within_f32(0.3, 1.8) } else { 0.0 },
            lift: dice.within_f32(-0.05, 0.015),
            color_block: *dice.pick(&[1, 1, 2, 2, 4]),
            quality: dice.count(70, 95) as u8,
        }
    }

    /// Processes the image of an eye (0 left, 1 right) in place.
    pub fn apply(&self, image: &mut RgbImage, eye: usize) {
        self.tint_rim(image, self.rims[eye]);
        let (width, height) = image.dimensions();
        let (w, h) = (width as usize, height as usize);
        let curve: Vec<f32> = (0..256).map(|v| self.curve(v as f32 / 255.0)).collect();
        // Brightness and the two differences of color.
        let mut luma = vec![0.0_f32; w * h];
        let mut blue = vec![0.0_f32; w * h];
        let mut red = vec![0.0_f32; w * h];
        for (i, pixel) in image.pixels().enumerate() {
            let [r, g, b] = pixel.0.map(|v| curve[usize::from(v)]);
            let y = 0.299 * r + 0.587 * g + 0.114 * b;
            (luma[i], blue[i], red[i]) = (y, self.saturation * (b - y), self.saturation * (r - y));
        }
        if self.color_block > 1 {
            share(&mut blue, w, h, self.color_block as usize);
            share(&mut red, w, h, self.color_block as usize);
        }
        let soft = (self.sharpen > 0.0).then(|| blurred(&luma, w, h));
        for (i, pixel) in image.pixels_mut().enumerate() {
            let mut y = luma[i];
            if let Some(soft) = &soft {
                y += self.sharpen * (y - soft[i]);
            }
            let (r, b) = (y + red[i], y + blue[i]);
            let g = (y - 0.299 * r - 0.114 * b) / 0.587;
            pixel.0 = [r, g, b].map(|v| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8);
        }
    }

    /// Red and green are lost before blue toward the edge.
    fn tint_rim(&self, image: &mut RgbImage, rim: Rim) {
        if self.blue_px <= 0.0 {
            return;
        }
        for (x, y, pixel) in image.enumerate_pixels_mut() {
            let (dx, dy) = (x as f32 - rim.middle_px[0], y as f32 - rim.middle_px[1]);
            let inward = (rim.radius_px - dx.hypot(dy)) / self.blue_px;
            if inward < 1.0 {
                let inward = inward.max(0.0);
                let [r, g, b] = pixel.0.map(f32::from);
                pixel.0 = [(r * inward) as u8, (g * inward.sqrt()) as u8, b as u8];
            }
        }
    }

    fn curve(&self, v: f32) -> f32 {
        let v = v.powf(self.gamma);
        let s = v * v * (3.0 - 2.0 * v);
        // Black stays black: the rim of the image is.
        v + self.contrast * (s - v) + self.lift * (v * 8.0).min(1.0)
    }
}

/// Weights 1, 2, 1 both ways.
fn blurred(values: &[f32], w: usize, h: usize) -> Vec<f32> {
    let pass = |from: &[f32], step: usize, along: &dyn Fn(usize) -> (bool, bool)| -> Vec<f32> {
        (0..from.len())
            .map(|i| {
                let (first, last) = along(i);
                let before = if first { from[i] } else { from[i - step] };
                let after = if last { from[i] } else { from[i + step] };
                0.25 * before + 0.5 * from[i] + 0.25 * after
            })
            .collect()
    };
    let rows = pass(values, 1, &|i| (i % w == 0, i % w == w - 1));
    pass(&rows, w, &|i| (i / w == 0, i / w == h - 1))
}

/// Blocks get their mean.
fn share(values: &mut [f32], w: usize, h: usize, block: usize) {
    for y in (0..h).step_by(block.div_ceil(2)) {
        for x in (0..w).step_by(block) {
            let rows = y..(y + block.div_ceil(2)).min(h);
            let columns = x..(x + block).min(w);
            let count = (rows.len() * columns.len()) as f32;
            let sum: f32 = rows
                .clone()
                .map(|r| values[r * w + columns.start..r * w + columns.end].iter().sum::<f32>())
                .sum();
            for r in rows {
                values[r * w + columns.start..r * w + columns.end].fill(sum / count);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NEUTRAL: Finish = Finish {
        rims: [Rim { middle_px: [0.0; 2], radius_px: 0.0 }; 2],
        blue_px: 0.0,
        gamma: 1.0,
        contrast: 0.0,
        saturation: 1.0,
        sharpen: 0.0,
        lift: 0.0,
        color_block: 1,
        quality: 90,
    };

    fn edge() -> RgbImage {
        RgbImage::from_fn(
            16,
            8,
            |x, _| if x < 8 { image::Rgb([80, 60, 50]) } else { image::Rgb([160, 170, 180]) },
        )
    }

    #[test]
    fn a_neutral_camera_changes_nothing() {
        let mut image = edge();
        NEUTRAL.apply(&mut image, 0);
        assert_eq!(image, edge());
    }

    #[test]
    fn sharpening_overshoots_at_edges_and_nowhere_else() {
        let mut image = edge();
        Finish { sharpen: 1.0, ..NEUTRAL }.apply(&mut image, 0);
        assert!(image.get_pixel(7, 4)[0] < 80 && image.get_pixel(8, 4)[0] > 160);
        assert_eq!(image.get_pixel(2, 4), edge().get_pixel(2, 4));
    }

    #[test]
    fn black_stays_black() {
        let mut image = RgbImage::new(8, 8);
        Finish { lift: 0.03, contrast: 0.5, gamma: 0.8, ..NEUTRAL }.apply(&mut image, 0);
        assert!(image.iter().all(|v| *v == 0));
    }

    #[test]
    fn a_rim_turns_blue_toward_the_edge_only() {
        let mut image = RgbImage::from_pixel(40, 1, image::Rgb([200, 200, 200]));
        Finish { rims: [Rim { middle_px: [0.0, 0.0], radius_px: 30.0 }; 2], blue_px: 10.0, ..NEUTRAL }
            .apply(&mut image, 0);
        assert_eq!(image.get_pixel(15, 0).0, [200; 3]);
        let [r, g, b] = image.get_pixel(27, 0).0;
        assert!(r < g && g < b);
    }
}
