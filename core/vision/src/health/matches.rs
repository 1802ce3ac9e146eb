//! Places that both eyes see, wherever they are in the right eye.

use image::GrayImage;
use nalgebra::Vector3;
use opencv::core::{Mat, Point2f, Vector};
use plumbline_model::{Eye, Pixel, Raw, StereoCameras};
use rayon::prelude::*;

use super::align::align;
use super::turn::{fit_turn, turned};
use crate::locate::NoBaseline;
use crate::locate::epipolar::EpipolarGeometry;
use crate::locate::scene::Scene;
use crate::locate::search::{Candidate, candidates};
use crate::{cv_words, mat};

/// Places that are tried in a pair, and least distance between two, px.
const PLACES: i32 = 200;
const APART_PX: f64 = 12.0;
/// Against the strongest corner of the picture (Shi and Tomasi 1994).
const LEAST_CORNER: f64 = 0.01;
/// Places with which the first look is made, and how far up and down it looks, px.
const FIRST_PLACES: usize = 60;
const FIRST_OFFSETS_PX: [f64; 9] = [0.0, -3.0, 3.0, -6.0, 6.0, -9.0, 9.0, -12.0, 12.0];
/// The best candidate must beat the next one by this much, in (1 − correlation).
const AMBIGUITY_RATIO: f64 = 0.75;
/// Looking back must come within this of the start, px.
const CONFIRMED_PX: f64 = 0.5;
/// Across the plane a place is known no worse than this, px.
const WORST_SIGMA_PX: f64 = 0.25;
/// Fewer matches than these say nothing.
pub(super) const LEAST_MATCHES: usize = 60;
/// Eyes that turned this far are looked at again with that turn, px.
const AGAIN_PX: f64 = 1.0;

/// Why ordinary pairs say nothing about a calibration.
#[derive(Debug, thiserror::Error)]
pub enum HealthError {
    /// The eyes are in one place.
    #[error(transparent)]
    NoBaseline(#[from] NoBaseline),
    /// Images of another size.
    #[error(
        "the images are not of the size that the calibration is for ({expected_px:?} px): give images of these eyes"
    )]
    Size {
        /// Width and height.
        expected_px: (u32, u32),
    },
    /// Too little to see.
    #[error(
        "only {found} places could be matched between the eyes in {pairs} pairs, {needed} are needed: is the light on, \
         are both eyes uncovered, and do they look at something with texture?"
    )]
    TooFew {
        /// Matches found.
        found: usize,
        /// Matches needed.
        needed: usize,
        /// Pairs that were looked at.
        pairs: usize,
    },
    /// The machine was too slow for the time that was given.
    #[error(
        "only {found} places could be matched between the eyes in the time that there was, {needed} are needed: close \
         other programs, or wait until this one has less to do, and judge again"
    )]
    OutOfTime {
        /// Matches found.
        found: usize,
        /// Matches needed.
        needed: usize,
    },
    /// The places do not say how the eye has turned.
    #[error(
        "what the eyes see lies too close together to tell how they have turned: look at more of the table, or turn the head"
    )]
    NotDetermined,
    /// OpenCV refused.
    #[error("the images could not be searched for corners: {}", cv_words::words(.0))]
    OpenCv(#[from] opencv::Error),
}

/// A place that both eyes see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// Which pair, from 0.
    pub pair: usize,
    /// In the left image.
    pub left: Pixel<Raw>,
    /// In the right image, measured in both directions.
    pub right: Pixel<Raw>,
    /// Standard deviation across the epipolar plane, px.
    pub sigma_px: f64,
}

/// How many places were tried, and how many matched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MatchCount {
    /// Corners of the left images.
    pub tried: usize,
    /// Seen by both eyes and confirmed.
    pub matched: usize,
}

/// A pair made ready.
struct Ready {
    scene: Scene,
    corners: Vec<Pixel<Raw>>,
}

/// Matches places of ordinary pairs (left, right) without trusting the calibration farther than a dozen
/// pixels across its epipolar planes.
///
/// # Errors
/// When the images are of another size, or too little is matched.
pub fn find_matches(
    cameras: &StereoCameras,
    pairs: &[(GrayImage, GrayImage)],
) -> Result<(Vec<Match>, MatchCount), HealthError> {
    find_matches_until(cameras, pairs, &|| false)
}

/// The same, with an end: once `is_over`, no further place is looked for, and what was found until then counts.
///
/// # Errors
/// When the images are of another size, or too little is matched until then.
pub fn find_matches_until(
    cameras: &StereoCameras,
    pairs: &[(GrayImage, GrayImage)],
    is_over: &(dyn Fn() -> bool + Sync),
) -> Result<(Vec<Match>, MatchCount), HealthError> {
    let ready =
        pairs.iter().map(|(left, right)| make_ready(cameras, left, right)).collect::<Result<Vec<_>, _>>()?;
    let start = first_turn(cameras, &ready, is_over)?;
    let mut seen_by = turned(cameras, &start);
    let mut places = all(&seen_by, &ready, is_over)?;
    // Eyes that turned far are looked at again from where they turned to, each place from where it was found.
    for _ in 0..2 {
        if is_over() {
            break;
        }
        let found: Vec<Match> = places.iter().map(|place| place.found).collect();
        let Ok(turn) = fit_turn(&seen_by, &found) else { break };
        if turn.rotation_rad.norm() * focal_px(cameras) < AGAIN_PX {
            break;
        }
        seen_by = turned(&seen_by, &turn.rotation_rad);
        let geometry = EpipolarGeometry::new(&seen_by).ok_or(NoBaseline)?;
        places = places
            .into_par_iter()
            .filter_map(|place| again(&geometry, &ready[place.found.pair].scene, &place))
            .collect();
    }
    let matches: Vec<Match> = places.into_iter().map(|place| place.found).collect();
    let count =
        MatchCount { tried: ready.iter().map(|pair| pair.corners.len()).sum(), matched: matches.len() };
    if matches.len() < LEAST_MATCHES && is_over() {
        return Err(HealthError::OutOfTime { found: matches.len(), needed: LEAST_MATCHES });
    }
    if matches.len() < LEAST_MATCHES {
        return Err(HealthError::TooFew { found: matches.len(), needed: LEAST_MATCHES, pairs: pairs.len() });
    }
    Ok((matches, count))
}

fn make_ready(cameras: &StereoCameras, left: &GrayImage, right: &GrayImage) -> Result<Ready, HealthError> {
    for (image, eye) in [(left, Eye::Left), (right, Eye::Right)] {
        let expected_px = cameras.camera(eye).size_px();
        if image.dimensions() != expected_px {
            return Err(HealthError::Size { expected_px });
        }
    }
    let mut found: Vector<Point2f> = Vector::new();
    let no_mask = Mat::default();
    opencv::imgproc::good_features_to_track(
        &mat::gray(left)?,
        &mut found,
        PLACES,
        LEAST_CORNER,
        APART_PX,
        &no_mask,
        5,
        false,
        0.04,
    )?;
    let corners = found.iter().map(|at| Pixel::new(f64::from(at.x), f64::from(at.y))).collect();
    Ok(Ready { scene: Scene::new(left, right), corners })
}

fn focal_px(cameras: &StereoCameras) -> f64 {
    let (fx, fy) = cameras.left.model.focal_px();
    0.5 * (fx + fy)
}

/// The turn about the baseline with which most of the strongest corners are matched.
fn first_turn(
    cameras: &StereoCameras,
    ready: &[Ready],
    is_over: &(dyn Fn() -> bool + Sync),
) -> Result<Vector3<f64>, HealthError> {
    let Some(most) = ready.iter().max_by_key(|pair| pair.corners.len()) else { return Ok(Vector3::zeros()) };
    let strongest = &most.corners[..most.corners.len().min(FIRST_PLACES)];
    let mut best = (0, Vector3::zeros());
    for offset_px in FIRST_OFFSETS_PX {
        let turn = Vector3::x() * (offset_px / focal_px(cameras));
        let geometry = EpipolarGeometry::new(&turned(cameras, &turn)).ok_or(NoBaseline)?;
        let matched =
            strongest.par_iter().filter(|corner| one(&geometry, &most.scene, 0, **corner).is_some()).count();
        if matched > best.0 {
            best = (matched, turn);
        }
        // Nothing beats what nearly everything agrees with.
        if 2 * matched > strongest.len() || is_over() {
            break;
        }
    }
    Ok(best.1)
}

/// A match with what its patch looked like.
struct Place {
    found: Match,
    near: Candidate,
}

fn all(
    cameras: &StereoCameras,
    ready: &[Ready],
    is_over: &(dyn Fn() -> bool + Sync),
) -> Result<Vec<Place>, HealthError> {
    let geometry = EpipolarGeometry::new(cameras).ok_or(NoBaseline)?;
    let corners =
        ready.iter().enumerate().flat_map(|(pair, ready)| ready.corners.iter().map(move |at| (pair, *at)));
    let corners: Vec<_> = corners.collect();
    Ok(corners
        .into_par_iter()
        .filter_map(|(pair, at)| if is_over() { None } else { one(&geometry, &ready[pair].scene, pair, at) })
        .collect())
}

/// One place, looked for along its curve.
fn one(geometry: &EpipolarGeometry, scene: &Scene, pair: usize, left: Pixel<Raw>) -> Option<Place> {
    let ray = geometry.ray(Eye::Left, left).ok()?;
    let found = candidates(geometry, scene, Eye::Left, &ray).ok()?;
    let best = found.first()?;
    let wrong = |candidate: &Candidate| 1.0 - f64::from(candidate.correlation);
    if found.get(1).is_some_and(|second| wrong(best) > AMBIGUITY_RATIO * wrong(second)) {
        return None;
    }
    there_and_back(geometry, scene, pair, left, best)
}

/// A place that was found, after the eyes were turned to where they probably are.
fn again(geometry: &EpipolarGeometry, scene: &Scene, place: &Place) -> Option<Place> {
    let left = geometry.ray(Eye::Left, place.found.left).ok()?;
    let right = geometry.ray(Eye::Right, place.found.right).ok()?;
    let near = Candidate { disparity_rad: left.along_rad - right.along_rad, ..place.near };
    there_and_back(geometry, scene, place.found.pair, place.found.left, &near)
}

/// From left to right and back; `None`: not the same place.
fn there_and_back(
    geometry: &EpipolarGeometry,
    scene: &Scene,
    pair: usize,
    left: Pixel<Raw>,
    near: &Candidate,
) -> Option<Place> {
    let ray = geometry.ray(Eye::Left, left).ok()?;
    let there = align(geometry, scene, Eye::Left, &ray, near)?;
    if there.across_sigma_px > WORST_SIGMA_PX {
        return None;
    }
    let disparity_rad = ray.along_rad - there.ray.along_rad;
    let back_from = Candidate { disparity_rad, stretch: 1.0 / near.stretch, shear: -near.shear, ..*near };
    let back = align(geometry, scene, Eye::Right, &there.ray, &back_from)?;
    let returned = geometry.pixel(Eye::Left, &back.ray).ok()?;
    if returned.distance_px(&left) > CONFIRMED_PX {
        return None;
    }
    let right = geometry.pixel(Eye::Right, &there.ray).ok()?;
    let found = Match { pair, left, right, sigma_px: there.across_sigma_px };
    right.is_inside(scene.size_px(Eye::Right)).then_some(Place { found, near: *near })
}
