//! From boxes in both eyes to things with a place.
//!
//! Boxes of both eyes are paired along the epipolar geometry of the raw fisheye images. The range of a
//! pair comes from the object's own pixels, matched inside both boxes only, together with the
//! middles of the boxes; what lies behind the object does not vote. Every box without a partner and
//! every object without a place carries the reason.
//!
//! Assumes boxes around the visible part of one object each, and images of one moment. Broken by
//! objects that are partly hidden in one eye only: their boxes have different middles; the
//! disagreement with the matched pixels is then flagged.

mod assignment;
mod boxes;
mod curve;
mod options;
mod pairing;
#[cfg(test)]
mod tests;
mod types;
mod uncertainty;
mod votes;

use image::RgbImage;
use plumbline_model::{Detection, Eye, ParameterCovariance, Pixel, Raw, StereoCalibration};

use crate::locate::epipolar::{EpipolarGeometry, EpipolarRay};

pub use options::PlaceOptions;
pub use types::{
    Disagreement, Estimate, LeakWarning, NoPlace, ObjectPlace, Place, RangeFrom, Seen, Unpaired,
};
pub use votes::{MOST_CELLS, Votes};

use pairing::{Candidate, Matched, Pairing, px_rad};
use uncertainty::{Sigmas, add_along, by_calibration, triangulate};

/// Finds the places of objects, frame by frame. Takes no memory after the first frames.
#[derive(Debug)]
pub struct PlaceFinder {
    rig: Result<Rig, NoPlace>,
    options: PlaceOptions,
    pairing: Pairing,
}

/// What is known of the eyes.
#[derive(Debug)]
struct Rig {
    geometry: EpipolarGeometry,
    covariance: Option<ParameterCovariance>,
}

/// Depth of a body relative to the half of its smaller visible side, as the mean over toys, fruit
/// and hands, and its standard deviation: from the middle of what is seen to the middle of the body.
const HALF_DEPTH: [f64; 2] = [0.75, 0.3];

impl PlaceFinder {
    /// For one calibration; without one, boxes are listed but neither paired nor placed.
    pub fn new(calibration: Option<&StereoCalibration>, options: PlaceOptions) -> Self {
        let rig = calibration.ok_or(NoPlace::NoCalibration).and_then(|calibration| {
            let geometry = EpipolarGeometry::new(&calibration.cameras).ok_or(NoPlace::NoBaseline)?;
            Ok(Rig { geometry, covariance: calibration.covariance.clone() })
        });
        Self { rig, options, pairing: Pairing::default() }
    }

    /// The settings.
    pub fn options(&self) -> &PlaceOptions {
        &self.options
    }

    /// Pairs the boxes of a pair of raw images and finds the places: pairs first, in the order of
    /// the left list, then what only one eye has found. `out` is cleared first.
    pub fn find(
        &mut self,
        left: (&RgbImage, &[Detection]),
        right: (&RgbImage, &[Detection]),
        out: &mut Vec<ObjectPlace>,
    ) {
        out.clear();
        let rig = match usable(&self.rig, [left.0, right.0]) {
            Ok(rig) => rig,
            Err(reason) => {
                unplaced([left.1, right.1], reason, out);
                return;
            }
        };
        self.pairing.pair(&rig.geometry, &self.options, [left.1, right.1]);
        let [lefts, rights] = &self.pairing.candidates;
        for matched in &self.pairing.pairs {
            let (l, r) = (&lefts[matched.left], &rights[matched.right]);
            out.push(paired(l, r, matched, rig.place(l, r).ok_or(NoPlace::DoNotMeet)));
        }
        for &(eye, index, why) in &self.pairing.alone {
            let detection = if eye == Eye::Left { left.1[index] } else { right.1[index] };
            out.push(single(eye, index, &detection, why, NoPlace::OneEye(eye)));
        }
    }

    /// The epipolar curve of a raw pixel of the eye `from` in the other eye's raw image, between the
    /// nearest and the farthest range of objects; as a polyline, nearest first. `curve` is cleared
    /// first and stays empty where there is none.
    pub fn epipolar_curve(&self, from: Eye, pixel: Pixel<Raw>, curve: &mut Vec<Pixel<Raw>>) {
        curve.clear();
        let Ok(rig) = &self.rig else { return };
        let Ok(ray) = rig.geometry.ray(from, pixel) else { return };
        curve::walk(&rig.geometry, from, &ray, self.options.range_m, |pixel| curve.push(pixel));
    }
}

/// Places of one pair of images; [`PlaceFinder`] is for streams.
pub fn places(
    calibration: &StereoCalibration,
    left: (&RgbImage, &[Detection]),
    right: (&RgbImage, &[Detection]),
    options: &PlaceOptions,
) -> Vec<ObjectPlace> {
    let mut out = Vec::new();
    PlaceFinder::new(Some(calibration), options.clone()).find(left, right, &mut out);
    out
}

fn usable<'a>(rig: &'a Result<Rig, NoPlace>, images: [&RgbImage; 2]) -> Result<&'a Rig, NoPlace> {
    let rig = rig.as_ref().map_err(|reason| *reason)?;
    let fits = |eye: Eye| images[eye.index()].dimensions() == rig.geometry.cameras.camera(eye).size_px();
    if Eye::BOTH.into_iter().all(fits) { Ok(rig) } else { Err(NoPlace::OtherSize) }
}

/// Lists all boxes, each by itself.
fn unplaced(boxes: [&[Detection]; 2], reason: NoPlace, out: &mut Vec<ObjectPlace>) {
    for (eye, boxes) in Eye::BOTH.into_iter().zip(boxes) {
        for (index, detection) in boxes.iter().enumerate() {
            out.push(single(eye, index, detection, Unpaired::NoCalibration, reason));
        }
    }
}

fn single(eye: Eye, index: usize, detection: &Detection, why: Unpaired, reason: NoPlace) -> ObjectPlace {
    ObjectPlace {
        class: detection.class,
        confidence: detection.confidence,
        seen: Seen::One { eye, index, why },
        place: Err(reason),
    }
}

fn paired(l: &Candidate, r: &Candidate, matched: &Matched, place: Result<Place, NoPlace>) -> ObjectPlace {
    let (a, b) = (&l.detection, &r.detection);
    let surer = if b.confidence > a.confidence { b } else { a };
    ObjectPlace {
        class: surer.class,
        confidence: surer.confidence,
        seen: Seen::Both {
            left: l.index,
            right: r.index,
            epipolar_px: matched.epipolar_px,
            eyes_disagree: (a.class != b.class).then_some([a.class, b.class]),
        },
        place,
    }
}

impl Rig {
    fn place(&self, left: &Candidate, right: &Candidate) -> Option<Place> {
        let (l, r) = (&left.shape, &right.shape);
        let px_rad = px_rad(&self.geometry, Eye::Left);
        let [l_sigma, r_sigma] = [l.middle_sigma_px(), r.middle_sigma_px()];
        // Both eyes measure the plane.
        let weight = r_sigma[1].powi(2) / (l_sigma[1].powi(2) + r_sigma[1].powi(2));
        let plane_rad = weight * l.middle.plane_rad + (1.0 - weight) * r.middle.plane_rad;
        let ray = EpipolarRay { plane_rad, ..l.middle };
        let sigmas = Sigmas {
            plane_rad: weight.sqrt() * l_sigma[1] * px_rad / ray.along_rad.cos(),
            along_rad: l_sigma[0] * px_rad,
            disparity_rad: l_sigma[0].hypot(r_sigma[0]) * px_rad,
        };
        let disparity_rad = l.middle.along_rad - r.middle.along_rad;
        let mut middle = triangulate(&self.geometry, &ray, disparity_rad, &sigmas)?;
        if let Some(parameters) = &self.covariance {
            middle.covariance_m2 +=
                by_calibration(&self.geometry.cameras, parameters, &middle.point.coords.coords)?;
        }
        let range_m = middle.point.range_m();
        let size_m = [l.width_rad() * range_m, l.height_rad() * range_m];
        let smaller_m = 0.5 * size_m[0].min(size_m[1]);
        let [half_depth_m, half_depth_sigma_m] = HALF_DEPTH.map(|share| share * smaller_m);
        let forward = middle.point.direction()?.vector();
        let mut surface = Estimate {
            point: (middle.point.coords - forward * half_depth_m).into(),
            covariance_m2: middle.covariance_m2,
        };
        add_along(&mut surface.covariance_m2, &forward, half_depth_sigma_m);
        Some(Place {
            middle,
            surface,
            half_depth_m,
            half_depth_sigma_m,
            size_m,
            from: RangeFrom::BoxesAlone,
            votes: Votes::none(l.area),
            disagreement: None,
            leak: None,
        })
    }
}
