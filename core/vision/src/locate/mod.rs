//! Where in space the thing at a pixel of the left eye is.
//!
//! The place is looked for along its epipolar curve on the raw fisheye rays of the right eye,
//! refined to a fraction of a pixel, and looked for again from right to left; only what comes back
//! counts. The uncertainty has two parts: the match (brightness noise against texture) and the
//! calibration (its parameter covariance carried to the point).
//!
//! Assumes a surface that is locally flat and looks the same from both eyes. Broken by gloss,
//! transparent things, repeated texture and edges of near things before far ones; these come out
//! as "not found" with a reason where they can be told.

pub(crate) mod epipolar;
pub(crate) mod refine;
pub(crate) mod scene;
pub(crate) mod search;
#[cfg(test)]
mod tests;

use image::GrayImage;
use nalgebra::{DVector, Matrix3, Vector3};
use plumbline_model::decompose;
use plumbline_model::{
    Camera, CameraModel, Eye, LeftCamera, ParameterCovariance, Pixel, Point, Pose, Raw, StereoCalibration,
    StereoCameras,
};

use epipolar::{EpipolarGeometry, EpipolarRay};
use refine::{Refined, Start, refine};
use scene::Scene;
use search::{Step, candidates, sign};

/// Why a place was not found.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NotLocated {
    /// The pixel is not on the image.
    #[error("the pixel is outside the left image")]
    OutsideImage,
    /// The pixel is outside the lens's image circle.
    #[error("the pixel is outside what the left lens sees")]
    OutsideLens,
    /// Too near the edge of the image to compare its surroundings.
    #[error("the pixel is too near the edge of the image, or its surroundings have no texture")]
    AtTheRim,
    /// Brightness does not change along the epipolar curve.
    #[error(
        "the surroundings are too uniform along the direction of the other eye: choose a place with texture"
    )]
    NoTexture,
    /// The right image does not contain the curve.
    #[error("the right eye does not see that direction")]
    OtherEyeCannotSee,
    /// No place on the curve looks like it.
    #[error("nothing alike is visible to the right eye: it may be hidden there")]
    NothingAlike,
    /// Several places on the curve look like it.
    #[error("several places look alike to the right eye (repeated texture)")]
    Ambiguous,
    /// Looking back from the right eye leads elsewhere.
    #[error(
        "looking back from the right eye leads to another place, {off_px:.1} px away: it is probably hidden from the right eye"
    )]
    NotConfirmed {
        /// Distance from the pixel asked for, px.
        off_px: f64,
    },
    /// The rays do not meet in front of the eyes.
    #[error("the match lies at or beyond infinity: too far for these eyes")]
    TooFar,
}

/// A place found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Located {
    /// Where it is.
    pub point: Point<LeftCamera>,
    /// Standard deviation in the worst direction (nearly along the ray), meters.
    pub sigma_m: f64,
    /// Part of it that comes from the match alone, meters.
    pub match_sigma_m: f64,
    /// Covariance, m².
    pub covariance_m2: Matrix3<f64>,
    /// The same place in the right image.
    pub match_in_right: Pixel<Raw>,
    /// Standard deviation of the match along the epipolar curve, pixels.
    pub match_sigma_px: f64,
    /// Correlation of the two patches, −1..1.
    pub correlation: f64,
}

/// Finds places with one calibration.
#[derive(Clone, Debug)]
pub struct Locator {
    geometry: EpipolarGeometry,
    covariance: Option<ParameterCovariance>,
    /// How well a place of these images can be matched at best, raw pixels.
    image_sigma_px: f64,
}

/// The rig has both eyes in one place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the calibration has no distance between the eyes: calibrate again")]
pub struct NoBaseline;

/// Patch for choosing among candidates, raw pixels to each side.
const CHOOSE_HALF_PX: i32 = 9;
/// Patch for the final position.
const FINAL_HALF_PX: i32 = 6;
/// A match that does not correlate at least this well is none.
const LEAST_CORRELATION: f64 = 0.8;
/// The best candidate must beat the next one by this much, in (1 − correlation).
const AMBIGUITY_RATIO: f64 = 0.65;
/// Looking back must come within this of the start, raw pixels.
const CONFIRMED_PX: f64 = 1.0;
/// Used for a calibration that does not say how well it fits, raw pixels.
const UNKNOWN_IMAGE_SIGMA_PX: f64 = 0.05;
/// A match known no better than this along the curve is no match, raw pixels.
const WORST_SIGMA_PX: f64 = 0.5;

impl Locator {
    /// For this calibration; without a covariance the uncertainty is that of the match alone.
    pub fn new(calibration: &StereoCalibration) -> Result<Self, NoBaseline> {
        let geometry = EpipolarGeometry::new(&calibration.cameras).ok_or(NoBaseline)?;
        // Lens blur, color mosaic and compression move every feature a little, and leave no trace in
        // the residual brightness. The calibration has measured it: its residual per corner is two
        // placements of one axis each, which is what a match consists of.
        let image_sigma_px = calibration.summary.as_ref().map_or(UNKNOWN_IMAGE_SIGMA_PX, |s| s.rms_stereo_px);
        Ok(Self { geometry, covariance: calibration.covariance.clone(), image_sigma_px })
    }

    /// Finds the places at some pixels of the left image, each by itself.
    pub fn locate(
        &self,
        left: &GrayImage,
        right: &GrayImage,
        pixels: &[Pixel<Raw>],
    ) -> Vec<Result<Located, NotLocated>> {
        let scene = Scene::new(left, right);
        pixels.iter().map(|pixel| self.locate_one(&scene, *pixel)).collect()
    }

    fn locate_one(&self, scene: &Scene, pixel: Pixel<Raw>) -> Result<Located, NotLocated> {
        if !pixel.is_inside(scene.size_px(Eye::Left)) {
            return Err(NotLocated::OutsideImage);
        }
        let ray = self.geometry.ray(Eye::Left, pixel).map_err(|_| NotLocated::OutsideLens)?;
        let mut matched = self.best_match(scene, Eye::Left, &ray)?;
        let px_rad = Step::at(&self.geometry, Eye::Left, &ray).along_rad;
        let sigma_px = (matched.sigma_rad / px_rad).hypot(self.image_sigma_px);
        matched.sigma_rad = sigma_px * px_rad;
        if sigma_px > WORST_SIGMA_PX {
            return Err(NotLocated::NoTexture);
        }
        let in_right = EpipolarRay { along_rad: ray.along_rad - matched.disparity_rad, ..ray };
        self.confirm(scene, pixel, &in_right)?;
        self.assemble(&ray, &in_right, &matched, sigma_px)
    }

    /// The candidate whose refined patch fits best, if it is clearly the best.
    fn best_match(&self, scene: &Scene, from: Eye, ray: &EpipolarRay) -> Result<Refined, NotLocated> {
        let candidates = candidates(&self.geometry, scene, from, ray)?;
        let step = Step::at(&self.geometry, from, ray).along_rad;
        let mut refined: Vec<(Refined, f64)> = Vec::new();
        for candidate in &candidates {
            let start = Start {
                disparity_rad: candidate.disparity_rad,
                stretch: candidate.stretch,
                shear: candidate.shear,
            };
            let Some(wide) = refine(&self.geometry, scene, from, ray, start, CHOOSE_HALF_PX) else {
                continue;
            };
            let known = refined.iter().any(|(r, _)| (r.disparity_rad - wide.disparity_rad).abs() < step);
            if !known {
                // What surrounds the place counts as much as the place itself.
                refined.push((wide, 0.5 * (wide.correlation + f64::from(candidate.correlation))));
            }
        }
        refined.sort_by(|a, b| b.1.total_cmp(&a.1));
        let Some((best, score)) = refined.first().copied() else { return Err(NotLocated::NothingAlike) };
        if best.correlation < LEAST_CORRELATION {
            return Err(NotLocated::NothingAlike);
        }
        if refined.get(1).is_some_and(|(_, second)| 1.0 - score > AMBIGUITY_RATIO * (1.0 - second)) {
            return Err(NotLocated::Ambiguous);
        }
        let start = Start { disparity_rad: best.disparity_rad, stretch: best.stretch, shear: best.shear };
        Ok(refine(&self.geometry, scene, from, ray, start, FINAL_HALF_PX).unwrap_or(best))
    }

    /// Looks from right to left and compares with where it started.
    fn confirm(&self, scene: &Scene, pixel: Pixel<Raw>, in_right: &EpipolarRay) -> Result<(), NotLocated> {
        let back = match self.best_match(scene, Eye::Right, in_right) {
            Ok(back) => back,
            Err(NotLocated::Ambiguous) => return Err(NotLocated::Ambiguous),
            Err(_) => return Err(NotLocated::NothingAlike),
        };
        let ray = EpipolarRay {
            along_rad: in_right.along_rad + sign(Eye::Right) * back.disparity_rad,
            ..*in_right
        };
        let returned = self.geometry.pixel(Eye::Left, &ray).map_err(|_| NotLocated::NothingAlike)?;
        let off_px = returned.distance_px(&pixel);
        if off_px > CONFIRMED_PX { Err(NotLocated::NotConfirmed { off_px }) } else { Ok(()) }
    }

    fn assemble(
        &self,
        ray: &EpipolarRay,
        in_right: &EpipolarRay,
        matched: &Refined,
        sigma_px: f64,
    ) -> Result<Located, NotLocated> {
        let geometry = &self.geometry;
        let point = geometry.point(ray, matched.disparity_rad).ok_or(NotLocated::TooFar)?;
        let pixel_in =
            |eye: Eye, ray: &EpipolarRay| geometry.pixel(eye, ray).map_err(|_| NotLocated::OtherEyeCannotSee);
        let (in_left_px, in_right_px) = (pixel_in(Eye::Left, ray)?, pixel_in(Eye::Right, in_right)?);

        let nudge = 0.1 * matched.sigma_rad;
        let moved = geometry.point(ray, matched.disparity_rad + nudge).ok_or(NotLocated::TooFar)?;
        let by_match = (moved.coords - point.coords) * (matched.sigma_rad / nudge);
        let mut covariance_m2 = by_match * by_match.transpose();
        if let Some(parameters) = &self.covariance {
            covariance_m2 += from_calibration(&geometry.cameras, parameters, in_left_px, in_right_px)
                .ok_or(NotLocated::TooFar)?;
        }
        let variances_m2 = decompose::symmetric_eigenvalues(covariance_m2).ok_or(NotLocated::TooFar)?;
        Ok(Located {
            point,
            sigma_m: variances_m2.max().max(0.0).sqrt(),
            match_sigma_m: by_match.norm(),
            covariance_m2,
            match_in_right: in_right_px,
            match_sigma_px: sigma_px,
            correlation: matched.correlation,
        })
    }
}

/// Covariance (m²) of a triangulated point that comes from the calibration's parameters; `None` if
/// the point cannot be triangulated.
pub fn from_calibration(
    cameras: &StereoCameras,
    covariance: &ParameterCovariance,
    left: Pixel<Raw>,
    right: Pixel<Raw>,
) -> Option<Matrix3<f64>> {
    let n = covariance.matrix.nrows();
    let mut jacobian = nalgebra::Matrix3xX::<f64>::zeros(n);
    for i in 0..n {
        let sigma = covariance.matrix[(i, i)].max(0.0).sqrt();
        if sigma == 0.0 {
            continue;
        }
        // Differences over a tenth of a standard deviation: the function is smooth there.
        let h = 0.1 * sigma;
        let point = |delta: f64| {
            let mut change = DVector::zeros(n);
            change[i] = delta;
            changed(cameras, &change).triangulate(left, right)
        };
        let slope: Vector3<f64> = (point(h)?.coords - point(-h)?.coords) / (2.0 * h);
        jacobian.set_column(i, &slope);
    }
    Some(&jacobian * &covariance.matrix * jacobian.transpose())
}

/// The rig with its parameters changed, in the order of [`ParameterCovariance`].
fn changed(cameras: &StereoCameras, change: &DVector<f64>) -> StereoCameras {
    let lens = |camera: &Camera, offset: usize| {
        let mut p = camera.model.parameters();
        for (i, value) in p.iter_mut().enumerate() {
            *value += change[offset + i];
        }
        Camera { model: CameraModel::from_parameters(camera.model.kind(), &p), ..*camera }
    };
    let left_count = cameras.left.model.kind().parameter_count();
    let rig = left_count + cameras.right.model.kind().parameter_count();
    let at = |k: usize| Vector3::new(change[rig + k], change[rig + k + 1], change[rig + k + 2]);
    let mut isometry = cameras.right_from_left.isometry;
    isometry.rotation = nalgebra::UnitQuaternion::from_scaled_axis(at(0)) * isometry.rotation;
    isometry.translation.vector += at(3);
    StereoCameras {
        left: lens(&cameras.left, 0),
        right: lens(&cameras.right, left_count),
        right_from_left: Pose::new(isometry),
    }
}
