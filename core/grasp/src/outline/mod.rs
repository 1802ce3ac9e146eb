//! Where a thing on the table stands, by the boxes in which both eyes see it.
//!
//! A box is drawn around an outline, and the middle of an outline is not where the middle of the thing is
//! seen: near the border of an image by a pixel or two, and a mushroom's is that of its cap, high over the
//! table. So the outline is what is compared: that around the ellipsoids of which the thing consists,
//! standing on the table. How high it stands there is known, which tells more of its distance than two eyes
//! so near to each other. Toys of a class differ in size, and the size of the boxes says by how much.

use nalgebra::{Matrix2, Matrix4, Vector2, Vector4};
use plumbline_effects::RobotModel;
use plumbline_effects::robot_model::SeenUnder;
use plumbline_model::Eye;
use plumbline_model::robot::Posture;

use crate::things::Thing;

mod extents;

/// Standard deviation of the middle of a box along rows and along columns, px. On forty photographs of the real eyes that
/// no detector learned from, 120 boxes against those drawn by hand: 0.47 and 0.53, and 0.2 too low.
pub(crate) const BOX_SIGMA_PX: f64 = 0.6;
/// Standard deviation of the size of a box along rows and along columns, px: 1.2 and 1.0 on the same photographs.
pub(crate) const SIZE_SIGMA_PX: f64 = 1.2;
/// How much wider than an outline boxes are drawn on every side, px, alike in both eyes: standard deviation, 0.3 on
/// the same photographs. Whoever drew them may have drawn all of them too wide or too narrow.
pub(crate) const MARGIN_SIGMA_PX: f64 = 0.5;
/// How much things of a class differ in size, share: standard deviation.
pub(crate) const SCALE_SIGMA: f64 = 0.12;
/// Smaller or larger than known by more it is another thing, share.
const SCALES: std::ops::RangeInclusive<f64> = 0.5..=2.0;
/// Standard deviation of the height at which a thing on the table is, m: the table may be tilted, the thing
/// may lean.
pub const HEIGHT_SIGMA_M: f64 = 0.002;
/// A box that ends so near to the border of its image is cut off, px.
const BORDER_PX: f64 = 1.5;
/// Shapes are simpler than things: what the size of an outline is off by beside that of its box, share.
const SHAPE_SIGMA: f64 = 0.03;
/// Boxes whose sizes are this much less likely than those of a thing of the size that was found (χ² of four numbers, one in
/// three hundred) are of another thing, or of a part of it: what is hidden in part is too narrow or too low for its size.
const MOST_UNLIKELY: f64 = 16.0;
/// Things of a class that differ from what is known by more, share, are other things, or parts of them.
const OTHER_SCALE: f64 = 2.0 * SCALE_SIGMA;
/// For differences, m.
const STEP_M: f64 = 0.001;
/// See [`STEP_M`].
const STEP_SCALE: f64 = 0.02;
/// See [`STEP_M`], px.
const STEP_PX: f64 = 0.5;
/// It is found when it moves by less, m, or never.
const STILL_M: f64 = 1e-5;
const TURNS: usize = 12;

/// A place on the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnTable {
    /// x and y of its middle, robot frame, m.
    pub xy_m: Vector2<f64>,
    /// Covariance by boxes, size and height, m².
    pub covariance_m2: Matrix2<f64>,
    /// How far it moves where what it stands on is higher by [`HEIGHT_SIGMA_M`], m.
    pub by_height_m: Vector2<f64>,
    /// How large it is, as a share of the size that is known of its class.
    pub scale: f64,
    /// Standard deviation of `scale`.
    pub scale_sigma: f64,
    /// How much wider than its outline the boxes seem to be drawn on every side, px.
    pub margin_px: f64,
    /// How far it moves where `scale` is larger by `scale_sigma`, m.
    pub by_scale_m: Vector2<f64>,
}

/// What is looked for: where a thing stands, how large it is and how the boxes are drawn.
#[derive(Clone, Copy, Debug)]
struct State {
    xy_m: Vector2<f64>,
    scale: f64,
    margin_px: f64,
}

/// Least squares: normal equations and right side, weighted, in x and y (m), scale and margin (px).
type Normal = (Matrix4<f64>, Vector4<f64>);

/// A number that was seen less the predicted one, px, and its standard deviation, px.
type Residual = (f64, f64);

impl State {
    const fn at(xy_m: Vector2<f64>) -> Self {
        Self { xy_m, scale: 1.0, margin_px: 0.0 }
    }

    /// Moved in one of its numbers.
    fn stepped(mut self, index: usize, by: f64) -> Self {
        match index {
            0 | 1 => self.xy_m[index] += by,
            2 => self.scale += by,
            _ => self.margin_px += by,
        }
        self
    }
}

/// Boxes of a thing in both eyes, and the head as it was.
#[derive(Clone, Copy, Debug)]
pub struct Boxes<'a> {
    /// x0, y0, x1, y1 in the left and in the right eye, raw px, counted from the corner of a pixel.
    pub boxes_px: &'a [Option<[f32; 4]>; 2],
    /// All joints by their encoders.
    pub posture: &'a Posture,
    /// What effects on the eyes depend on besides.
    pub under: SeenUnder,
}

impl Boxes<'_> {
    /// Where the thing stands, from a place nearby (x and y, m). `None`: no eye sees it, or there is no such
    /// place.
    pub fn on_table(&self, model: &RobotModel, thing: &Thing, near_m: Vector2<f64>) -> Option<OnTable> {
        let mut state = State::at(near_m);
        for _ in 0..TURNS {
            let (normal, right) = self.normal(model, thing, &state)?;
            let step = normal.try_inverse()? * right;
            for (index, by) in step.iter().enumerate() {
                state = state.stepped(index, *by);
            }
            if !SCALES.contains(&state.scale) {
                return None;
            }
            if step.xy().norm() < STILL_M {
                return self.found(model, thing, &state, &normal);
            }
        }
        None
    }

    /// The same, but `None` where the boxes do not fit what was found: they are of another thing, or of a part of it.
    pub fn whole_on_table(&self, model: &RobotModel, thing: &Thing, near_m: Vector2<f64>) -> Option<OnTable> {
        self.on_table(model, thing, near_m).filter(|found| self.fit(model, thing, found))
    }

    fn found(
        &self,
        model: &RobotModel,
        thing: &Thing,
        state: &State,
        normal: &Matrix4<f64>,
    ) -> Option<OnTable> {
        let inverse = normal.try_inverse()?;
        // What a wrong height does.
        let low = self.residuals(model, thing, state, 0.0)?;
        let high = self.residuals(model, thing, state, STEP_M)?;
        let slopes = self.slopes(model, thing, state)?;
        let by_height: Vector4<f64> = (low.iter().zip(&high).zip(&slopes))
            .map(|(((low, sigma), (high, _)), slope)| slope * ((high - low) / STEP_M / sigma.powi(2)))
            .sum();
        let by_height_m = (inverse * by_height * HEIGHT_SIGMA_M).xy();
        let covariance_m2 = inverse.fixed_view::<2, 2>(0, 0) + by_height_m * by_height_m.transpose();
        let scale_sigma = inverse[(2, 2)].max(0.0).sqrt();
        let by_scale_m = Vector2::new(inverse[(0, 2)], inverse[(1, 2)]) / scale_sigma;
        let State { xy_m, scale, margin_px } = *state;
        Some(OnTable { xy_m, covariance_m2, by_height_m, scale, scale_sigma, margin_px, by_scale_m })
    }

    fn normal(&self, model: &RobotModel, thing: &Thing, state: &State) -> Option<Normal> {
        let residuals = self.residuals(model, thing, state, 0.0)?;
        let slopes = self.slopes(model, thing, state)?;
        let prior = Vector4::new(0.0, 0.0, SCALE_SIGMA.powi(-2), MARGIN_SIGMA_PX.powi(-2));
        let mut normal = Matrix4::from_diagonal(&prior);
        let mut right = prior.component_mul(&Vector4::new(0.0, 0.0, 1.0 - state.scale, -state.margin_px));
        for ((residual, sigma), slope) in residuals.iter().zip(&slopes) {
            let weight = sigma.powi(-2);
            normal += slope * slope.transpose() * weight;
            right += slope * (residual * weight);
        }
        Some((normal, right))
    }

    /// How each predicted number changes with x and y (px/m), scale (px) and margin.
    fn slopes(&self, model: &RobotModel, thing: &Thing, state: &State) -> Option<Vec<Vector4<f64>>> {
        let mut slopes = vec![Vector4::zeros(); self.residuals(model, thing, state, 0.0)?.len()];
        for (index, step) in [STEP_M, STEP_M, STEP_SCALE, STEP_PX].into_iter().enumerate() {
            let at = |by: f64| self.residuals(model, thing, &state.stepped(index, by), 0.0);
            for (slope, ((low, _), (high, _))) in slopes.iter_mut().zip(at(-step)?.into_iter().zip(at(step)?))
            {
                slope[index] = (low - high) / (2.0 * step);
            }
        }
        Some(slopes)
    }

    /// Whether the boxes are as large as the outline of the thing standing there, and none of them ends at the border
    /// of its image: the middle of what is cut off or hidden in part is not that of the thing.
    fn fit(&self, model: &RobotModel, thing: &Thing, found: &OnTable) -> bool {
        let state = State { scale: found.scale, ..State::at(found.xy_m) };
        let Some(extents) = self.extents(model, thing, &state, 0.0) else { return false };
        let mut is_whole = true;
        let mut unlikely = 0.0;
        for eye in Eye::BOTH {
            let (Some(seen_px), Some((low, high))) = (self.boxes_px[eye.index()], extents[eye.index()])
            else {
                continue;
            };
            let (width_px, height_px) = model.rig().eyes.cameras.camera(eye).size_px();
            for (k, size_px) in [width_px, height_px].into_iter().enumerate() {
                let [from_px, to_px] = [seen_px[k], seen_px[k + 2]].map(f64::from);
                let (is, should) = (to_px - from_px, high[k] - low[k] + 2.0 * found.margin_px);
                is_whole &= from_px > BORDER_PX && to_px < f64::from(size_px) - BORDER_PX;
                unlikely += (is - should).powi(2) / (SIZE_SIGMA_PX.powi(2) + (SHAPE_SIGMA * should).powi(2));
            }
        }
        is_whole && unlikely < MOST_UNLIKELY && (found.scale - 1.0).abs() < OTHER_SCALE
    }

    /// Middles of the boxes and their sizes less those of the outlines of a thing that stands there.
    fn residuals(
        &self,
        model: &RobotModel,
        thing: &Thing,
        state: &State,
        higher_m: f64,
    ) -> Option<Vec<Residual>> {
        let extents = self.extents(model, thing, state, higher_m)?;
        let mut residuals = vec![];
        for eye in Eye::BOTH {
            let (Some(seen_px), Some((low, high))) = (self.boxes_px[eye.index()], extents[eye.index()])
            else {
                continue;
            };
            for k in 0..2 {
                // Edges of boxes count from the corner of a pixel.
                let [from, to] = [seen_px[k], seen_px[k + 2]].map(|at| f64::from(at) - 0.5);
                residuals.push((0.5 * (from + to) - 0.5 * (low[k] + high[k]), BOX_SIGMA_PX));
                let size_px = high[k] - low[k] + 2.0 * state.margin_px;
                residuals.push((to - from - size_px, SIZE_SIGMA_PX));
            }
        }
        (!residuals.is_empty()).then_some(residuals)
    }
}

#[cfg(test)]
pub(crate) mod tests;
