//! Which box of the right eye shows the same object as a box of the left.
//!
//! A pair costs its squared Mahalanobis distance from a perfect one: the middles lie in one
//! epipolar plane, heights and widths agree as angles, and the range is that of a workspace. What is
//! impossible is left out with its reason; among the rest the cheapest one-to-one pairing of all
//! boxes together wins.

use plumbline_model::{Detection, Eye};

use crate::locate::epipolar::EpipolarGeometry;

use super::assignment::Assignment;
use super::boxes::{EpipolarBox, NoBox};
use super::options::PlaceOptions;
use super::types::Unpaired;

/// A box that can be paired.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    /// In the list that was given.
    pub index: usize,
    pub detection: Detection,
    pub shape: EpipolarBox,
}

/// A pair that was found, as positions in the lists of candidates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Matched {
    pub left: usize,
    pub right: usize,
    pub epipolar_px: f64,
}

/// Finds partners; keeps its memory between frames.
#[derive(Debug, Default)]
pub(super) struct Pairing {
    pub candidates: [Vec<Candidate>; 2],
    pub pairs: Vec<Matched>,
    /// Boxes that are left over: eye, index in the list that was given, why.
    pub alone: Vec<(Eye, usize, Unpaired)>,
    partner: Vec<Option<usize>>,
    is_taken: Vec<bool>,
    order: Vec<usize>,
    costs: Vec<f64>,
    assignment: Assignment,
}

/// Farther off than this many standard deviations is another object.
const GATE_SIGMAS: f64 = 4.0;
/// Cost of leaving a box without a partner; the worst pair within all gates costs more.
const ALONE: f64 = 30.0;
/// Extra cost where the eyes name different classes.
const OTHER_CLASS: f64 = 9.0;
/// Epipolar error that comes from the calibration and from eyes read at different moments, px.
const EPIPOLAR_SIGMA_PX: f64 = 0.5;
/// Two views of one object differ in size by about this factor's logarithm: another side of it.
const SIZE_SIGMA: f64 = 0.12;
/// Where objects usually are, m from the baseline, and the spread of that in pixels of disparity: a
/// weak preference that keeps the order of two alike things on one epipolar line.
const USUAL_RANGE_M: f64 = 0.45;
const USUAL_SIGMA_PX: f64 = 20.0;

/// How two boxes fit.
struct Fit {
    cost: f64,
    epipolar_px: f64,
    /// Squared distance from the epipolar line in standard deviations.
    off_line: f64,
    impossible: Option<Unpaired>,
}

impl Pairing {
    /// Pairs the boxes of both eyes.
    pub fn pair(&mut self, geometry: &EpipolarGeometry, options: &PlaceOptions, boxes: [&[Detection]; 2]) {
        self.pairs.clear();
        self.alone.clear();
        for (eye, boxes) in Eye::BOTH.into_iter().zip(boxes) {
            self.collect(geometry, options, eye, boxes);
        }
        let [left, right] = &self.candidates;
        self.costs.clear();
        for l in left {
            self.costs.extend(right.iter().map(|r| {
                let fit = fit(geometry, options, l, r);
                if fit.impossible.is_none() { fit.cost } else { f64::INFINITY }
            }));
        }
        let (costs, columns) = (&self.costs, right.len());
        let cost = |l: usize, r: usize| costs[l * columns + r];
        self.assignment.solve(left.len(), columns, ALONE, cost, &mut self.partner);
        self.is_taken.clear();
        self.is_taken.resize(columns, false);
        for (l, partner) in self.partner.iter().enumerate() {
            if let Some(r) = *partner {
                self.is_taken[r] = true;
                let epipolar_px = fit(geometry, options, &left[l], &right[r]).epipolar_px;
                self.pairs.push(Matched { left: l, right: r, epipolar_px });
            }
        }
        for (l, candidate) in left.iter().enumerate() {
            if self.partner[l].is_none() {
                self.alone.push((
                    Eye::Left,
                    candidate.index,
                    why_alone(geometry, options, Eye::Left, candidate, right),
                ));
            }
        }
        for (r, candidate) in right.iter().enumerate() {
            if !self.is_taken[r] {
                self.alone.push((
                    Eye::Right,
                    candidate.index,
                    why_alone(geometry, options, Eye::Right, candidate, left),
                ));
            }
        }
    }

    /// Turns the boxes of an eye into candidates, the most confident first if there are too many.
    fn collect(
        &mut self,
        geometry: &EpipolarGeometry,
        options: &PlaceOptions,
        eye: Eye,
        boxes: &[Detection],
    ) {
        self.order.clear();
        self.order.extend(0..boxes.len());
        let most = options.most_per_eye;
        if boxes.len() > most {
            let by_confidence = |a: &usize, b: &usize| boxes[*b].confidence.total_cmp(&boxes[*a].confidence);
            self.order.sort_unstable_by(by_confidence);
        }
        let candidates = &mut self.candidates[eye.index()];
        candidates.clear();
        for (rank, &index) in self.order.iter().enumerate() {
            if rank >= most {
                self.alone.push((eye, index, Unpaired::TooMany { most }));
                continue;
            }
            let detection = boxes[index];
            match EpipolarBox::new(geometry, eye, &detection.area, options) {
                Ok(shape) => candidates.push(Candidate { index, detection, shape }),
                Err(NoBox::NotABox) => self.alone.push((eye, index, Unpaired::NotABox)),
                Err(NoBox::OutsideLens) => self.alone.push((eye, index, Unpaired::OutsideLens)),
            }
        }
    }
}

/// Whether the classes allow a pair.
fn classes_allow(options: &PlaceOptions, a: &Detection, b: &Detection) -> bool {
    a.class == b.class || options.look_alike(a.class, b.class)
}

fn fit(geometry: &EpipolarGeometry, options: &PlaceOptions, left: &Candidate, right: &Candidate) -> Fit {
    let px_rad = px_rad(geometry, Eye::Right);
    let (l, r) = (&left.shape, &right.shape);
    let epipolar_px = (r.middle.plane_rad - l.middle.plane_rad) * r.middle.along_rad.cos() / px_rad;
    let [l_sigma, r_sigma] = [l.middle_sigma_px(), r.middle_sigma_px()];
    let line_sigma_px = l_sigma[1].hypot(r_sigma[1]).hypot(EPIPOLAR_SIGMA_PX);
    let off_line = (epipolar_px / line_sigma_px).powi(2);

    // The size of things as angles hardly depends on the eye; the range from each eye does a little.
    let sizes = |l_rad: f64, r_rad: f64, l_px: f64, r_px: f64| {
        let sigma = SIZE_SIGMA.hypot(l_px * px_rad / l_rad).hypot(r_px * px_rad / r_rad);
        let ratio = r_rad / l_rad;
        (ratio, (ratio.ln() / sigma).powi(2))
    };
    // An edge that moves by one pixel changes the size by one, the middle by half.
    let (height_ratio, height) = sizes(l.height_rad(), r.height_rad(), 2.0 * l_sigma[1], 2.0 * r_sigma[1]);
    let (width_ratio, width) = sizes(l.width_rad(), r.width_rad(), 2.0 * l_sigma[0], 2.0 * r_sigma[0]);

    let disparity_rad = l.middle.along_rad - r.middle.along_rad;
    let usual_rad = geometry.disparity_rad(&l.middle, USUAL_RANGE_M);
    let unusual = ((disparity_rad - usual_rad) / (USUAL_SIGMA_PX * px_rad)).powi(2);
    let gate = GATE_SIGMAS.powi(2);
    let range_m = geometry.point(&l.middle, disparity_rad).map(|point| point.range_m());
    let impossible = if !classes_allow(options, &left.detection, &right.detection) {
        Some(Unpaired::NoneOfThatClass)
    } else if !(off_line <= gate) {
        Some(Unpaired::OffEpipolarLine { by_px: epipolar_px.abs() })
    } else if let Some(range_m) = range_m {
        if range_m < options.range_m[0] {
            Some(Unpaired::TooNear { range_m })
        } else if range_m > options.range_m[1] {
            Some(Unpaired::TooFar { range_m })
        } else if !(height <= gate) {
            Some(Unpaired::SizesDiffer { ratio: height_ratio })
        } else if !(width <= gate) {
            Some(Unpaired::SizesDiffer { ratio: width_ratio })
        } else {
            None
        }
    } else {
        Some(Unpaired::BeyondInfinity)
    };
    let mut cost = off_line + height + width + unusual;
    if left.detection.class != right.detection.class {
        cost += OTHER_CLASS;
    }
    Fit { cost, epipolar_px, off_line, impossible }
}

/// Why a box found no partner: what speaks against the candidate nearest to its epipolar line.
fn why_alone(
    geometry: &EpipolarGeometry,
    options: &PlaceOptions,
    eye: Eye,
    alone: &Candidate,
    others: &[Candidate],
) -> Unpaired {
    let mut nearest: Option<(f64, Unpaired)> = None;
    for other in others.iter().filter(|other| classes_allow(options, &alone.detection, &other.detection)) {
        let fit = match eye {
            Eye::Left => fit(geometry, options, alone, other),
            Eye::Right => fit(geometry, options, other, alone),
        };
        let Some(reason) = fit.impossible else { return Unpaired::FitsAnotherBetter };
        let reason = match reason {
            Unpaired::SizesDiffer { ratio } if eye == Eye::Right => {
                Unpaired::SizesDiffer { ratio: 1.0 / ratio }
            }
            reason => reason,
        };
        if nearest.is_none_or(|(off_line, _)| fit.off_line < off_line) {
            nearest = Some((fit.off_line, reason));
        }
    }
    match nearest {
        Some((_, reason)) => reason,
        None if is_seen_by_other(geometry, options, eye, alone) => Unpaired::NoneOfThatClass,
        None => Unpaired::OutsideOtherView,
    }
}

/// Whether the other eye's image shows any part of the epipolar curve of a box's middle.
fn is_seen_by_other(
    geometry: &EpipolarGeometry,
    options: &PlaceOptions,
    eye: Eye,
    alone: &Candidate,
) -> bool {
    let mut is_seen = false;
    super::curve::walk(geometry, eye, &alone.shape.middle, options.range_m, |_| is_seen = true);
    is_seen
}

/// One raw pixel at the center of an eye's image, rad.
pub(super) fn px_rad(geometry: &EpipolarGeometry, eye: Eye) -> f64 {
    let (fx_px, fy_px) = geometry.cameras.camera(eye).model.focal_px();
    2.0 / (fx_px + fy_px)
}
