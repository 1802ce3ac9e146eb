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
mod matching;
mod options;
mod pairing;
mod patch;
mod place;
mod rates;
#[cfg(test)]
mod tests;
mod types;
mod uncertainty;
mod votes;

use image::RgbImage;
use plumbline_model::{Detection, Eye, Pixel, Raw, StereoCalibration};

pub use options::{Body, PlaceOptions};
pub use rates::{ClassRates, Rates};
pub use types::{
    Disagreement, Estimate, LeakWarning, NoPlace, ObjectPlace, Place, RangeFrom, Seen, Unpaired,
};
pub use votes::{MOST_CELLS, Votes};

use matching::Matcher;
use pairing::{Candidate, Matched, Pairing};
use place::Rig;

/// Finds the places of objects, frame by frame. Takes no memory after the first frames.
#[derive(Debug)]
pub struct PlaceFinder {
    rig: Result<Rig, NoPlace>,
    options: PlaceOptions,
    pairing: Pairing,
    matcher: Matcher,
}

impl PlaceFinder {
    /// For one calibration; without one, boxes are listed but neither paired nor placed.
    pub fn new(calibration: Option<&StereoCalibration>, options: PlaceOptions) -> Self {
        let (pairing, matcher) = (Pairing::default(), Matcher::default());
        Self { rig: Rig::new(calibration), options, pairing, matcher }
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
            let shapes = [&l.shape, &r.shape];
            let surer = if r.detection.confidence > l.detection.confidence { r } else { l };
            let body = self.options.body(surer.detection.class);
            let place = rig.place(&mut self.matcher, [left.0, right.0], shapes, body, &self.options);
            out.push(paired(l, r, matched, place.ok_or(NoPlace::DoNotMeet)));
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
