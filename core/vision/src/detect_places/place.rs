//! The place of a pair of boxes: range by the object's own pixels and by the middles of the boxes,
//! each with its uncertainty, compared and then taken together.

use image::RgbImage;
use plumbline_model::{Eye, ParameterCovariance, StereoCalibration};

use crate::locate::epipolar::{EpipolarGeometry, EpipolarRay};

use super::boxes::EpipolarBox;
use super::matching::{Matcher, Matching};
use super::options::{Body, PlaceOptions};
use super::pairing::px_rad;
use super::types::{Disagreement, Estimate, LeakWarning, NoPlace, Place, RangeFrom};
use super::uncertainty::{Sigmas, add_along, by_calibration, triangulate};
use super::votes::Votes;

/// What is known of the eyes.
#[derive(Debug)]
pub(super) struct Rig {
    pub geometry: EpipolarGeometry,
    covariance: Option<ParameterCovariance>,
    /// How well a place of these images can be matched at best, raw px: lens blur and color mosaic move
    /// every feature a little. The calibration has measured it by its corners.
    image_sigma_px: f64,
}

/// Used for a calibration that does not say how well it fits, raw px.
const UNKNOWN_IMAGE_SIGMA_PX: f64 = 0.05;
/// How far edges of boxes are off before both eyes' boxes are compared, as a share of
/// [`PlaceOptions::edge_sigma_px`], and as how many measured edges that counts. Renderings show 0.2 of it,
/// photographs of the real eyes 0.4 (boxes drawn by hand) to 1 (boxes of a detector).
const ASSUMED_SHARE: f64 = 0.7;
const ASSUMED_EDGES: f64 = 2.0;
/// Something long may lie along the ray as well as across it: standard deviation of how deep it is, as a
/// share of half of what its box is longer than broad.
const LONG_SIGMA: f64 = 0.2;
/// What moves edges of boxes (blur, eyes that are not read at the same moment, lenses that are not quite
/// as calibrated) moves what is matched, too: by this share of it.
const MATCH_SHARE: f64 = 0.3;
/// Contradictions below this are chance, standard deviations.
const DISAGREE_SIGMAS: f64 = 3.0;
/// How far from where the boxes put it the surface is looked for: this many standard deviations…
const REACH_SIGMAS: f64 = 3.0;
/// …and at least so far, px.
const LEAST_REACH_PX: f64 = 2.0;

impl Rig {
    pub fn new(calibration: Option<&StereoCalibration>) -> Result<Self, NoPlace> {
        let calibration = calibration.ok_or(NoPlace::NoCalibration)?;
        let geometry = EpipolarGeometry::new(&calibration.cameras).ok_or(NoPlace::NoBaseline)?;
        let image_sigma_px = calibration.summary.as_ref().map_or(UNKNOWN_IMAGE_SIGMA_PX, |s| s.rms_stereo_px);
        Ok(Self { geometry, covariance: calibration.covariance.clone(), image_sigma_px })
    }

    /// Where the object of two boxes is.
    pub fn place(
        &self,
        matcher: &mut Matcher,
        images: [&RgbImage; 2],
        [left, right]: [&EpipolarBox; 2],
        body: Body,
        options: &PlaceOptions,
    ) -> Option<Place> {
        let view = View::new(&self.geometry, left, right, body);
        let box_rad = left.middle.along_rad - right.middle.along_rad;
        let by_boxes = self.geometry.point(&view.ray, box_rad)?;
        let half_depth =
            HalfDepth::new(&self.geometry, &view, by_boxes.range_m(), [left, right], box_rad, body);

        let reach_rad = REACH_SIGMAS * view.disparity_sigma_rad.hypot(half_depth.sigma_rad)
            + LEAST_REACH_PX * view.px_rad;
        let surface_rad = box_rad + half_depth.rad;
        let matching =
            matcher.find(&self.geometry, images, left, surface_rad, [reach_rad, half_depth.spread_rad]);
        let matched = matching.as_ref().map(|matching| self.by_votes(&view, matching, &half_depth));
        let fused = Fused::new(&view, box_rad, matched);

        let middle = self.estimate(&view, fused.middle_rad, fused.sigma_rad)?;
        let surface = match &matching {
            Some(matching) => {
                let sigma_rad = self.surface_sigma_rad(&view, matching);
                self.estimate(&view, matching.disparity_rad, sigma_rad * fused.inflation)?
            }
            None => self.before(&middle, &half_depth)?,
        };
        let range_m = |disparity_rad: f64| self.geometry.point(&view.ray, disparity_rad).map(|p| p.range_m());
        let disagreement = fused.disagreement_sigmas.and_then(|sigmas| {
            let by_m = range_m(matched?.middle_rad)? - range_m(box_rad)?;
            Some(Disagreement { by_m, sigmas })
        });
        let leak =
            matching.as_ref().and_then(|matching| self.leak(matcher, &view, matching, &half_depth, options));
        let range = middle.point.range_m();
        Some(Place {
            half_depth_m: range - surface.point.range_m(),
            half_depth_sigma_m: half_depth.sigma_m,
            middle,
            surface,
            size_m: [left.width_rad() * range, left.height_rad() * range],
            from: if matching.is_some() { RangeFrom::OwnPixelsAndBoxes } else { RangeFrom::BoxesAlone },
            votes: matching.map_or_else(|| Votes::none(left.area), |matching| matching.votes),
            disagreement,
            leak,
        })
    }

    /// The middle by the surface that most pixels voted for.
    fn by_votes(&self, view: &View, matching: &Matching, half_depth: &HalfDepth) -> Matched {
        let sigma_rad = self.surface_sigma_rad(view, matching).hypot(half_depth.sigma_rad);
        Matched { middle_rad: matching.disparity_rad - half_depth.rad, sigma_rad }
    }

    /// How well the disparity of the matched surface is known, rad.
    fn surface_sigma_rad(&self, view: &View, matching: &Matching) -> f64 {
        let images_px = self.image_sigma_px.hypot(MATCH_SHARE * view.edge_sigma_px);
        matching.sigma_rad.hypot(images_px * view.px_rad)
    }

    fn estimate(&self, view: &View, disparity_rad: f64, disparity_sigma_rad: f64) -> Option<Estimate> {
        let sigmas = Sigmas {
            plane_rad: view.plane_sigma_rad,
            along_rad: view.along_sigma_rad,
            disparity_rad: disparity_sigma_rad,
        };
        let mut estimate = triangulate(&self.geometry, &view.ray, disparity_rad, &sigmas)?;
        if let Some(parameters) = &self.covariance {
            let point = &estimate.point.coords.coords;
            estimate.covariance_m2 += by_calibration(&self.geometry.cameras, parameters, point)?;
        }
        Some(estimate)
    }

    /// The surface where only the middle is known.
    fn before(&self, middle: &Estimate, half_depth: &HalfDepth) -> Option<Estimate> {
        let forward = middle.point.direction()?.vector();
        let mut covariance_m2 = middle.covariance_m2;
        add_along(&mut covariance_m2, &forward, half_depth.sigma_m);
        Some(Estimate { point: (middle.point.coords - forward * half_depth.m).into(), covariance_m2 })
    }

    /// Whether a place taken from all pixels of the box would have been spoiled.
    fn leak(
        &self,
        matcher: &mut Matcher,
        view: &View,
        matching: &Matching,
        half_depth: &HalfDepth,
        options: &PlaceOptions,
    ) -> Option<LeakWarning> {
        let range_m = |disparity_rad: f64| self.geometry.point(&view.ray, disparity_rad).map(|p| p.range_m());
        let surface_m = range_m(matching.disparity_rad)?;
        // A body has extent of its own; what is further than that from its surface is something else.
        let apart_m = options.leak_depth_m.max(half_depth.longer_m);
        let at = |range_m: f64| self.geometry.disparity_rad(&view.ray, range_m * view.ray.along_rad.cos());
        let nearest_m = (surface_m - apart_m).max(0.3 * surface_m);
        let behind = matcher.behind(at(nearest_m), at(surface_m + apart_m))?;
        // Beyond infinity by a little: as far as objects go.
        let farthest_m = options.range_m[1];
        let off = |rad: f64| range_m(rad).map_or(farthest_m, |m| m.min(farthest_m)) - surface_m;
        let warning = LeakWarning {
            behind_m: off(behind.disparity_rad),
            share: behind.share,
            median_off_m: off(behind.median_rad),
            middle_off_m: behind.middle_rad.map(off),
        };
        // Only errors toward the strangers are theirs; others are those of a single pixel.
        let toward = warning.behind_m.signum();
        let worst_m =
            (toward * warning.median_off_m).max(warning.middle_off_m.map_or(0.0, |off| toward * off));
        let is_large =
            warning.share >= options.leak_share || worst_m >= options.leak_error_m.max(half_depth.m);
        (is_large && warning.behind_m.abs() >= options.leak_depth_m).then_some(warning)
    }
}

/// The disparity of the body's middle by matched pixels, and its standard deviation, rad.
#[derive(Clone, Copy)]
struct Matched {
    middle_rad: f64,
    sigma_rad: f64,
}

/// The ray of the object's middle and how well it is known.
struct View {
    ray: EpipolarRay,
    px_rad: f64,
    /// Of the edges of the boxes, as far as both eyes tell, raw px.
    edge_sigma_px: f64,
    plane_sigma_rad: f64,
    along_sigma_rad: f64,
    /// Of the disparity between the middles of the boxes.
    disparity_sigma_rad: f64,
}

impl View {
    fn new(geometry: &EpipolarGeometry, left: &EpipolarBox, right: &EpipolarBox, body: Body) -> Self {
        let px_rad = px_rad(geometry, Eye::Left);
        let share = edges_share(left, right, px_rad);
        let [l, r] = [left, right].map(|shape| shape.middle_sigma_px().map(|sigma_px| sigma_px * share));
        let edge_sigma_px =
            share * left.edge_sigma_px.into_iter().chain(right.edge_sigma_px).fold(f64::INFINITY, f64::min);
        // Both eyes measure the plane.
        let weight = r[1].powi(2) / (l[1].powi(2) + r[1].powi(2));
        let plane_rad = weight * left.middle.plane_rad + (1.0 - weight) * right.middle.plane_rad;
        let ray = EpipolarRay { plane_rad, ..left.middle };
        Self {
            ray,
            px_rad,
            edge_sigma_px,
            plane_sigma_rad: (weight.sqrt() * l[1] * px_rad).hypot(body.middle_sigma * left.height_rad())
                / ray.along_rad.cos(),
            along_sigma_rad: (l[0] * px_rad).hypot(body.middle_sigma * left.width_rad()),
            disparity_sigma_rad: l[0].hypot(r[0]) * px_rad,
        }
    }
}

/// How far edges of boxes are off, as a share of the standard deviations of their edges: both eyes' boxes
/// have top and bottom in the same epipolar planes.
fn edges_share(left: &EpipolarBox, right: &EpipolarBox, px_rad: f64) -> f64 {
    let [l, r] = [left.edge_sigma_px, right.edge_sigma_px];
    let across = left.middle.along_rad.cos() / px_rad;
    let top = (right.planes_rad[0] - left.planes_rad[0]) * across / l[1].hypot(r[1]);
    let bottom = (right.planes_rad[1] - left.planes_rad[1]) * across / l[3].hypot(r[3]);
    let found = [top, bottom];
    let squares: f64 = found.iter().map(|off| off * off).sum();
    ((ASSUMED_EDGES * ASSUMED_SHARE.powi(2) + squares) / (ASSUMED_EDGES + found.len() as f64)).sqrt()
}

/// From the matched surface to the middle of the body.
struct HalfDepth {
    m: f64,
    sigma_m: f64,
    /// The same as disparity at the object's range, rad.
    rad: f64,
    sigma_rad: f64,
    /// Longer side of the box, m.
    longer_m: f64,
    /// How much nearer or farther than its middle an end of something long may be, as disparity, rad.
    spread_rad: f64,
}

impl HalfDepth {
    fn new(
        geometry: &EpipolarGeometry,
        view: &View,
        range_m: f64,
        boxes: [&EpipolarBox; 2],
        disparity_rad: f64,
        body: Body,
    ) -> Self {
        let sides = || boxes.iter().flat_map(|shape| [shape.width_rad(), shape.height_rad()]);
        let shorter_m = sides().fold(f64::INFINITY, f64::min) * range_m;
        let longer_m = sides().fold(0.0, f64::max) * range_m;
        let m = body.depth[0] * 0.5 * shorter_m;
        // Something long may lie along the ray as well as across it.
        let sigma_m = body.depth[1] * 0.5 * shorter_m + LONG_SIGMA * 0.5 * (longer_m - shorter_m);
        // Not nearer than half way to the eyes, whatever the box claims.
        let nearer_m = (range_m - m).max(0.5 * range_m);
        let nearer_rad = geometry.disparity_rad(&view.ray, nearer_m * view.ray.along_rad.cos());
        let rad = nearer_rad - disparity_rad;
        let rad_per_m = rad / (range_m - nearer_m);
        Self {
            m,
            sigma_m,
            rad,
            sigma_rad: rad_per_m * sigma_m,
            longer_m,
            spread_rad: rad_per_m * 0.5 * (longer_m - shorter_m),
        }
    }
}

/// Both ways to the disparity of the middle, weighted by their variances.
struct Fused {
    middle_rad: f64,
    sigma_rad: f64,
    /// Factor of the standard deviations where the two contradict each other.
    inflation: f64,
    disagreement_sigmas: Option<f64>,
}

impl Fused {
    fn new(view: &View, box_rad: f64, matched: Option<Matched>) -> Self {
        let box_variance = view.disparity_sigma_rad.powi(2);
        let Some(Matched { middle_rad: match_rad, sigma_rad }) = matched else {
            let sigma_rad = view.disparity_sigma_rad;
            return Self { middle_rad: box_rad, sigma_rad, inflation: 1.0, disagreement_sigmas: None };
        };
        let match_variance = sigma_rad.powi(2);
        let total = box_variance + match_variance;
        let sigmas = (match_rad - box_rad).abs() / total.sqrt();
        let disagrees = sigmas > DISAGREE_SIGMAS;
        // Birge's ratio: as much less certain as the two contradict each other.
        let inflation = if disagrees { sigmas } else { 1.0 };
        Self {
            middle_rad: (match_rad * box_variance + box_rad * match_variance) / total,
            sigma_rad: (box_variance * match_variance / total).sqrt() * inflation,
            inflation,
            disagreement_sigmas: disagrees.then_some(sigmas),
        }
    }
}
