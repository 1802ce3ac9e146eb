//! One eye's images around the hand.

use image::RgbImage;
use nalgebra::{Isometry3, Matrix3, Vector3};
use plumbline_model::frame::{Robot, Tip};
use plumbline_model::{Camera, Eye, Pose};

use super::evidence::{Colors, Evidence};
use super::search::Moves;
use super::shape::{EyesAt, InView, Part, Solid};
use super::view::{Region, rays};
use super::{HandNotSeen, HandOptions, Pair};

/// The region goes this far beyond the hand and the farthest shift, px.
const MARGIN_PX: f64 = 12.0;

/// Where images are cut.
#[derive(Clone, Copy)]
pub(super) struct Around<'a> {
    pub solids: &'a [Solid],
    pub place: Pose<Robot, Tip>,
    /// How far it may be off.
    pub covariance_m2: Matrix3<f64>,
}

impl<'a> Pair<'a> {
    pub(super) fn of(&self, eye: Eye) -> &'a RgbImage {
        match eye {
            Eye::Left => self.left,
            Eye::Right => self.right,
        }
    }
}

#[derive(Clone, Copy)]
pub(super) struct Images<'a> {
    pub now: &'a RgbImage,
    pub before: Option<&'a RgbImage>,
}

/// One eye's images with what is known of them.
pub(super) struct Sight<'a> {
    pub eye: Eye,
    pub images: Images<'a>,
    pub camera: &'a Camera,
    pub camera_from_robot: Isometry3<f64>,
    pub evidence: Evidence,
    pub rays: Vec<Option<Vector3<f64>>>,
    pub moves: Moves,
    pub reach_px: f64,
}

impl<'a> Sight<'a> {
    /// `None` when too little of the hand lies on this eye's image.
    pub fn new(
        eye: Eye,
        images: Images<'a>,
        eyes: &'a EyesAt,
        around: &Around<'_>,
        options: &HandOptions,
    ) -> Result<Option<Self>, HandNotSeen> {
        let camera = eyes.camera(eye);
        let fits = |image: &RgbImage| image.dimensions() == camera.size_px();
        if !fits(images.now) || !images.before.is_none_or(fits) {
            return Err(HandNotSeen::OtherSize);
        }
        let camera_from_robot = eyes.camera_from_robot(eye);
        let Some(moves) = Moves::at(camera, &camera_from_robot, &around.place) else {
            return Ok(None);
        };
        let reach_px = moves.reach_px(&around.covariance_m2);
        let hand = InView::new(around.solids, &camera_from_robot, &around.place);
        let in_camera = hand.camera_from_tip.translation.vector;
        let off_axis_rad = in_camera.xy().norm().atan2(in_camera.z);
        let cut = Region::around(&hand, camera, MARGIN_PX + reach_px);
        let seen = |share: f64| share >= options.least_in_view && off_axis_rad <= options.most_off_axis_rad;
        let Some((region, _)) = cut.filter(|(_, share)| seen(*share)) else {
            return Ok(None);
        };
        let evidence = Evidence::new(region, images.now, images.before);
        let rays = rays(&region, camera);
        Ok(Some(Self { eye, images, camera, camera_from_robot, evidence, rays, moves, reach_px }))
    }

    pub fn in_view(&self, solids: &[Solid], robot_from_tip: &Pose<Robot, Tip>) -> InView {
        InView::new(solids, &self.camera_from_robot, robot_from_tip)
    }

    /// Evidence with colors learned where the labels say. At first the hand may lie beside its labels:
    /// then only what has changed is learned from.
    pub fn ratios(&self, labels: &[Option<Part>], first: bool) -> Option<Vec<f32>> {
        let region = &self.evidence.region;
        let is_hand = |i: usize| matches!(labels[i], Some(Part::Palm | Part::Digit));
        let changed = |i: usize| self.evidence.has_changed(i) != Some(false);
        let width = region.width;
        let deep = |i: usize| {
            is_hand(i)
                && [1, width].iter().all(|step| {
                    i >= *step && is_hand(i - step) && i + step < labels.len() && is_hand(i + step)
                })
        };
        let hand = if first {
            self.evidence.colors(|i| is_hand(i) && changed(i)).or_else(|| self.evidence.colors(is_hand))?
        } else {
            self.evidence.colors(deep)?
        };
        let forearm = self.evidence.colors(|i| labels[i] == Some(Part::Forearm) && (!first || changed(i)));
        let around: Option<Colors> =
            if self.evidence.knows_before() { None } else { self.evidence.colors(|i| labels[i].is_none()) };
        Some(self.evidence.ratios(&hand, forearm.as_ref(), around.as_ref(), labels))
    }
}
