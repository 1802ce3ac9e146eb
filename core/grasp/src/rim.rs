//! Where a thing on the table stands, by its outline in the images of both eyes.
//!
//! Boxes tell where it is to about a pixel. Its outline itself is seen better: along short lines across it
//! the colors change from the thing's to those of what is behind, and where they do so is found to a
//! fraction of a pixel, as it is for the hand ([`crate::hand`]): what both have in common (the lenses, how
//! the eyes sit) does not part them then. The outline is that of an ellipsoid which stands on the table, of
//! the thing's size but for a factor that is found, too.
//!
//! How sure the place is comes from how far parts of the outline contradict each other (clustered as by
//! Liang and Zeger 1986): shadow, gloss and what is no ellipsoid move a whole part of it.

use nalgebra::{Matrix2, Matrix3, Point3, RowVector3, Vector2, Vector3};
use plumbline_effects::robot_model::SeenUnder;
use plumbline_model::{Eye, Pixel, Point, Raw};

use crate::body::Sight;
use crate::hand::from_colors;
use crate::knowledge::Knowledge;
use crate::outline::{HEIGHT_SIGMA_M, OnTable, POINTS, outline};
use crate::things::Thing;

/// Standard deviation of a thing's size, as a share of it: one tomato is not like the other.
const SIZE_SIGMA: f64 = 0.05;
/// Differences beyond this are of something else, px.
const ROBUST_PX: f64 = 0.5;
/// A line is not known better than this, px.
const LINE_SIGMA_PX: f64 = 0.15;
const ROUNDS: usize = 8;
/// It is found when it moves by less, m.
const STILL_M: f64 = 2e-5;
/// For differences, m and shares.
const STEP: f64 = 1e-3;
/// Neighboring lines share what misleads them: so many of them are a part of the outline.
const PART: usize = 6;
/// At least this share of all lines must have been found, 0–1.
const LEAST_FOUND: f64 = 0.4;
/// Farther from where the boxes have it than so many standard deviations it is something else.
const MOST_SIGMAS: f64 = 4.0;
/// Lines reach so far, px: they must lie on the image.
const REACH_PX: f64 = 5.0;

/// x, y (m) and the logarithm of the size.
type Unknowns = Vector3<f64>;

/// A thing on the table in both images.
#[derive(Clone, Copy, Debug)]
pub struct Rim<'a> {
    /// The images, and the head as it was.
    pub sight: &'a Sight,
    /// What is known of the eyes and of the table.
    pub knowledge: &'a Knowledge,
    /// What it is.
    pub thing: &'a Thing,
}

/// A line across the outline.
struct Line {
    part: usize,
    /// Found minus predicted, outward, px.
    off_px: f64,
    weight: f64,
    slope: RowVector3<f64>,
}

impl Rim<'_> {
    /// Where it stands, from where boxes have it. `None`: too little of its outline is seen, it does not
    /// settle, or boxes and outline contradict each other.
    pub fn on_table(&self, boxes: &OnTable) -> Option<OnTable> {
        let mut at = Unknowns::new(boxes.xy_m.x, boxes.xy_m.y, 0.0);
        for _ in 0..ROUNDS {
            let lines = self.lines(&at)?;
            let (normal, right) = equations(&lines, &at);
            let step = normal.cholesky()?.solve(&right);
            at += step;
            if step.xy().norm() < STILL_M {
                return self.found(&at, boxes);
            }
        }
        None
    }

    fn found(&self, at: &Unknowns, boxes: &OnTable) -> Option<OnTable> {
        let lines = self.lines(at)?;
        let inverse = equations(&lines, at).0.cholesky()?.inverse();
        let mut covariance = sandwich(&lines, &inverse);
        // What a wrong height does.
        let higher = self.outlines(at, STEP)?;
        let flat = self.outlines(at, 0.0)?;
        let mut by_height = Vector3::zeros();
        for line in &lines {
            let (eye, i) = (line.part / POINTS, line.part % POINTS);
            let (low, normal) = flat[eye][i]?;
            let (high, _) = higher[eye][i]?;
            by_height -= line.slope.transpose() * (line.weight * (high - low).dot(&normal) / STEP);
        }
        let shift = inverse * by_height * HEIGHT_SIGMA_M;
        covariance += shift * shift.transpose();
        let covariance_m2: Matrix2<f64> = covariance.fixed_view::<2, 2>(0, 0).into_owned();
        let off = at.xy() - boxes.xy_m;
        let both = covariance_m2 + boxes.covariance_m2;
        let sigmas = off.dot(&(both.try_inverse()? * off)).max(0.0).sqrt();
        (sigmas <= MOST_SIGMAS).then_some(OnTable { xy_m: at.xy(), covariance_m2 })
    }

    /// All lines that were found.
    fn lines(&self, at: &Unknowns) -> Option<Vec<Line>> {
        let flat = self.outlines(at, 0.0)?;
        let moved: Vec<_> =
            (0..3).map(|k| self.outlines(&(at + Unknowns::ith(k, STEP)), 0.0)).collect::<Option<Vec<_>>>()?;
        let (mut lines, mut asked) = (vec![], 0);
        for (e, image) in [&self.sight.left, &self.sight.right].into_iter().enumerate() {
            let inside = Vector2::new(f64::from(image.width()), f64::from(image.height())).add_scalar(-1.0);
            for i in 0..POINTS {
                asked += 1;
                let Some((pixel, normal)) = flat[e][i] else { continue };
                let ends = [pixel + normal * REACH_PX, pixel - normal * REACH_PX];
                if !ends.iter().all(|p| p.x >= 0.0 && p.y >= 0.0 && p.x <= inside.x && p.y <= inside.y) {
                    continue;
                }
                let Some(crossing) = from_colors(image, None, &pixel, &normal) else { continue };
                let mut slope = RowVector3::zeros();
                for k in 0..3 {
                    let (there, _) = moved[k][e][i]?;
                    slope[k] = (there - pixel).dot(&normal) / STEP;
                }
                let variance = 1.0 / crossing.information + LINE_SIGMA_PX.powi(2);
                let robust = 1.0 / (1.0 + (crossing.shift_px / ROBUST_PX).powi(2));
                lines.push(Line {
                    part: e * POINTS + i,
                    off_px: crossing.shift_px,
                    weight: robust / variance,
                    slope,
                });
            }
        }
        (lines.len() as f64 >= LEAST_FOUND * f64::from(asked)).then_some(lines)
    }

    /// Points of the outline in both images with their normals, outward; px.
    fn outlines(
        &self,
        at: &Unknowns,
        higher_m: f64,
    ) -> Option<[Vec<Option<(Vector2<f64>, Vector2<f64>)>>; 2]> {
        let Self { sight, knowledge, thing } = *self;
        let size = at.z.exp();
        let thing = Thing { width_m: thing.width_m * size, height_m: thing.height_m * size, ..*thing };
        let z_m = knowledge.support_m(at.x, at.y) + 0.5 * thing.height_m + higher_m;
        let middle = Point3::new(at.x, at.y, z_m);
        let robot_from_left = knowledge.robot_from_left(&sight.posture).isometry;
        let right_from_left = knowledge.calibration.cameras.right_from_left.isometry;
        let mut both = [vec![], vec![]];
        for eye in Eye::BOTH {
            let eye_at = match eye {
                Eye::Left => robot_from_left * Point3::origin(),
                Eye::Right => robot_from_left * right_from_left.inverse() * Point3::origin(),
            };
            let seen = |point: &Point3<f64>| {
                let point = Point::new(point.x, point.y, point.z);
                let (left, right) = knowledge.model.project(&point, &sight.posture, &SeenUnder::default())?;
                let Pixel::<Raw> { u_px, v_px, .. } = if eye == Eye::Left { left } else { right };
                Some(Vector2::new(u_px, v_px))
            };
            let inner = seen(&middle)?;
            let pixels: Vec<_> = outline(&middle, &thing, &eye_at)?.iter().map(seen).collect();
            let count = pixels.len();
            both[eye.index()] = (0..count)
                .map(|i| {
                    let along = pixels[(i + 1) % count]? - pixels[(i + count - 1) % count]?;
                    let normal = Vector2::new(along.y, -along.x).try_normalize(1e-6)?;
                    let pixel = pixels[i]?;
                    Some((pixel, normal * (pixel - inner).dot(&normal).signum()))
                })
                .collect();
        }
        Some(both)
    }
}

/// Normal equations, weighted.
fn equations(lines: &[Line], at: &Unknowns) -> (Matrix3<f64>, Vector3<f64>) {
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for line in lines {
        normal += line.slope.transpose() * line.slope * line.weight;
        right += line.slope.transpose() * (line.weight * line.off_px);
    }
    normal[(2, 2)] += SIZE_SIGMA.powi(-2);
    right[2] -= at.z * SIZE_SIGMA.powi(-2);
    (normal, right)
}

/// Covariance by what parts of the outline say by themselves.
fn sandwich(lines: &[Line], inverse: &Matrix3<f64>) -> Matrix3<f64> {
    let mut scores = [Vector3::zeros(); 2 * POINTS / PART];
    for line in lines {
        scores[line.part / PART] += line.slope.transpose() * (line.weight * line.off_px);
    }
    let count = scores.iter().filter(|score| **score != Vector3::zeros()).count() as f64;
    let sum: Matrix3<f64> = scores.iter().map(|score| score * score.transpose()).sum();
    // Two eyes, three unknowns: what is spent on them is not left to contradict.
    inverse * sum * inverse * (count / (count - 3.0).max(1.0))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use image::{Rgb, RgbImage};
    use plumbline_effects::RobotModel;
    use plumbline_model::StereoCalibration;
    use plumbline_model::robot::Rig;

    use super::*;
    use crate::knowledge::Corrections;

    fn knowledge() -> Knowledge {
        let rig = Arc::new(Rig::built_in("nico").expect("valid"));
        Knowledge {
            model: RobotModel::nominal(rig.clone()),
            described: rig.clone(),
            calibration: Arc::new(StereoCalibration::bare(rig.eyes.cameras)),
            corrections: Corrections::default(),
        }
    }

    /// A red body of this size on a gray table, each pixel as much as the body covers it.
    fn sight(knowledge: &Knowledge, thing: &Thing, xy_m: Vector2<f64>, size: f64) -> Sight {
        let posture = knowledge.described.home();
        let gray = |eye: Eye| {
            let (width, height) = knowledge.calibration.cameras.camera(eye).size_px();
            RgbImage::from_pixel(width, height, Rgb([110, 105, 100]))
        };
        let mut images = Eye::BOTH.map(gray);
        let blank = Sight {
            left: Arc::new(images[0].clone()),
            right: Arc::new(images[1].clone()),
            posture,
            at_s: 0.0,
            seq: 0,
            eyes_on_s: None,
        };
        let rim = Rim { sight: &blank, knowledge, thing };
        let seen = rim.outlines(&Unknowns::new(xy_m.x, xy_m.y, size.ln()), 0.0).expect("seen");
        for (image, outline) in images.iter_mut().zip(&seen) {
            let corners: Vec<_> = outline.iter().flatten().copied().collect();
            let middle = corners.iter().map(|(pixel, _)| pixel).sum::<Vector2<f64>>() / corners.len() as f64;
            for (u, v, color) in image.enumerate_pixels_mut() {
                let at = Vector2::new(f64::from(u), f64::from(v));
                if (at - middle).norm() > 40.0 {
                    continue;
                }
                // How far outside of the nearest side of the outline, px.
                let outside = corners.iter().map(|(pixel, normal)| (at - pixel).dot(normal));
                let covered = (0.5 - outside.fold(f64::NEG_INFINITY, f64::max) / 1.6).clamp(0.0, 1.0);
                let mix = |a: f64, b: f64| (a * covered + b * (1.0 - covered)).round() as u8;
                *color = Rgb([mix(190.0, 110.0), mix(30.0, 105.0), mix(25.0, 100.0)]);
            }
        }
        let [left, right] = images.map(Arc::new);
        Sight { left, right, ..blank }
    }

    fn boxes(xy_m: Vector2<f64>) -> OnTable {
        OnTable { xy_m, covariance_m2: Matrix2::identity() * 9e-6 }
    }

    #[test]
    fn a_body_is_found_to_half_a_millimeter_from_boxes_that_are_off_by_three_whatever_its_size() {
        let knowledge = knowledge();
        let tomato = Thing::of_class("Tomato").expect("known");
        for at_m in [[0.3, -0.2], [0.3, 0.1], [0.4, 0.0]] {
            for size in [1.0, 0.95] {
                let truly = Vector2::from(at_m);
                let sight = sight(&knowledge, &tomato, truly, size);
                let rim = Rim { sight: &sight, knowledge: &knowledge, thing: &tomato };
                let found = rim.on_table(&boxes(truly + Vector2::new(0.002, -0.002))).expect("found");
                let off_m = (found.xy_m - truly).norm();
                let sigma_m = found.covariance_m2.trace().sqrt();
                assert!(off_m < 0.0008, "{at_m:?}, {size}: {:.2} mm", off_m * 1e3);
                // Most of it is the height at which it may stand.
                assert!((0.0005..0.004).contains(&sigma_m), "{at_m:?}, {size}: {sigma_m}");
            }
        }
    }

    #[test]
    fn nothing_is_found_where_nothing_stands() {
        let knowledge = knowledge();
        let tomato = Thing::of_class("Tomato").expect("known");
        let truly = Vector2::new(0.3, -0.1);
        let sight = sight(&knowledge, &tomato, truly, 1.0);
        let rim = Rim { sight: &sight, knowledge: &knowledge, thing: &tomato };
        assert_eq!(rim.on_table(&boxes(Vector2::new(0.3, 0.2))), None);
    }
}
