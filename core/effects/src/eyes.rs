//! The eyes on their neck, and what they see and estimate when something deviates.

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use plumbline_model::robot::{CalibratedAt, DescriptionError, Rig};
use plumbline_model::stereo::StereoCameras;
use plumbline_model::{CameraModel, Pixel, Raw};

use crate::arm::Arm;
use crate::observation::Observation;

/// Nearer to the axis than this (rad) an angle, its sine and its tangent are the same.
const NEAR_AXIS: f64 = 1e-8;

/// The eyes of a robot, nominal.
#[derive(Clone, Debug)]
pub struct Eyes {
    /// The joints from the torso to the head.
    pub neck: Arm,
    /// Place of the left eye in the head.
    pub head_from_left: Isometry3<f64>,
    /// Lenses and how the eyes sit to each other.
    pub cameras: StereoCameras,
    /// How warm they were when they were calibrated.
    pub calibrated_at: CalibratedAt,
}

/// What is different from the nominal eyes. All zero is the nominal eyes exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct EyesDeviation {
    /// Added to each joint of the neck, rad.
    pub neck_rad: Vec<f64>,
    /// Turns both eyes together: rotation vector, axes of the left camera, rad.
    pub mount_rad: Vector3<f64>,
    /// Shifts both eyes together, axes of the left camera, m.
    pub mount_m: Vector3<f64>,
    /// Turns the right eye: rotation vector, its own axes, rad. Positive about y (down) looks
    /// further to the right.
    pub right_rad: Vector3<f64>,
    /// Shifts the image of the left eye, px.
    pub left_shift_px: [f64; 2],
    /// Shifts the image of the right eye, px.
    pub right_shift_px: [f64; 2],
    /// Both focal lengths are longer by this share.
    pub focal_scale: f64,
    /// The eyes stand further apart by this share.
    pub baseline_scale: f64,
    /// Radial distortion left over of the left and of the right eye, the first power of the lens: shift of a point away from
    /// the middle of the image by this times the cube of how far off the axis it is, as a share of what that is at half the
    /// image's width, px.
    pub distortion_px: [f64; 2],
    /// What is matched is not the place itself: shift in the images of both eyes, px.
    pub box_px: [f64; 2],
    /// Shift of the match in the right image along u only (disparity), px.
    pub disparity_px: f64,
    /// The place that is seen lies nearer to the eyes by this, along the ray, m.
    pub nearer_m: f64,
    /// How much the depth is that of the background: 0 not, 1 wholly.
    pub background_share: f64,
}

impl EyesDeviation {
    /// The nominal eyes on a neck with this many joints.
    pub fn none(neck: usize) -> Self {
        Self {
            neck_rad: vec![0.0; neck],
            mount_rad: Vector3::zeros(),
            mount_m: Vector3::zeros(),
            right_rad: Vector3::zeros(),
            left_shift_px: [0.0; 2],
            right_shift_px: [0.0; 2],
            focal_scale: 0.0,
            baseline_scale: 0.0,
            distortion_px: [0.0; 2],
            box_px: [0.0; 2],
            disparity_px: 0.0,
            nearer_m: 0.0,
            background_share: 0.0,
        }
    }
}

impl EyesDeviation {
    /// All parts in a fixed order, each with a step that is small for it.
    pub(crate) fn parts(&self) -> Vec<(f64, f64)> {
        let neck = self.neck_rad.iter().map(|angle| (*angle, 1e-4));
        let fixed = [
            (self.mount_rad.x, 1e-4),
            (self.mount_rad.y, 1e-4),
            (self.mount_rad.z, 1e-4),
            (self.mount_m.x, 1e-4),
            (self.mount_m.y, 1e-4),
            (self.mount_m.z, 1e-4),
            (self.right_rad.x, 1e-4),
            (self.right_rad.y, 1e-4),
            (self.right_rad.z, 1e-4),
            (self.left_shift_px[0], 1e-2),
            (self.left_shift_px[1], 1e-2),
            (self.right_shift_px[0], 1e-2),
            (self.right_shift_px[1], 1e-2),
            (self.focal_scale, 1e-4),
            (self.baseline_scale, 1e-4),
            (self.distortion_px[0], 1e-2),
            (self.distortion_px[1], 1e-2),
            (self.box_px[0], 1e-2),
            (self.box_px[1], 1e-2),
            (self.disparity_px, 1e-2),
            (self.nearer_m, 1e-4),
            (self.background_share, 1e-3),
        ];
        neck.chain(fixed).collect()
    }

    /// The same to be changed.
    pub(crate) fn parts_mut(&mut self) -> Vec<&mut f64> {
        let [left_u, left_v] = &mut self.left_shift_px;
        let [right_u, right_v] = &mut self.right_shift_px;
        let [bulge_left, bulge_right] = &mut self.distortion_px;
        let [box_u, box_v] = &mut self.box_px;
        let turns = self.mount_rad.iter_mut().chain(&mut self.mount_m).chain(&mut self.right_rad);
        let rest = [
            left_u,
            left_v,
            right_u,
            right_v,
            &mut self.focal_scale,
            &mut self.baseline_scale,
            bulge_left,
            bulge_right,
            box_u,
            box_v,
            &mut self.disparity_px,
            &mut self.nearer_m,
            &mut self.background_share,
        ];
        self.neck_rad.iter_mut().chain(turns).chain(rest).collect()
    }
}

/// What effects on the eyes depend on, in one row.
#[derive(Clone, Debug)]
pub struct EyeSituation {
    /// Angles of the neck, rad.
    pub neck_rad: Vec<f64>,
    /// The known place, robot frame, m.
    pub truth_m: Point3<f64>,
    /// The same in the nominal left camera, m.
    pub in_left_m: Point3<f64>,
    /// Time since the eyes were switched on, s.
    pub t_secs: Option<f64>,
    /// Distance of what lies behind, m.
    pub background_m: Option<f64>,
    /// Label of the set that it was measured in.
    pub set: Option<String>,
    /// Gravity about each joint of the neck, N m.
    pub neck_torques_nm: Vec<f64>,
}

impl Eyes {
    /// The eyes of a rig.
    ///
    /// # Errors
    /// When the description has no chain to them.
    pub fn of_rig(rig: &Rig) -> Result<Self, DescriptionError> {
        let link = &rig.description.links()[rig.eyes.link.0].name;
        Ok(Self {
            neck: Arm::of_rig(rig, link)?,
            head_from_left: rig.eyes.head_from_left.isometry,
            cameras: rig.eyes.cameras,
            calibrated_at: rig.eyes.calibrated_at,
        })
    }

    /// Place of the left eye, nominal unless something deviates.
    pub fn robot_from_left(&self, neck_rad: &[f64], deviation: &EyesDeviation) -> Isometry3<f64> {
        let angles: Vec<f64> = neck_rad.iter().zip(&deviation.neck_rad).map(|(a, b)| a + b).collect();
        let mount = Isometry3::from_parts(
            Translation3::from(deviation.mount_m),
            UnitQuaternion::from_scaled_axis(deviation.mount_rad),
        );
        self.neck.frames(&angles).robot_from_tip * self.head_from_left * mount
    }

    /// What effects depend on when the eyes look at a known place.
    pub fn situation(&self, row: &Observation, truth_m: Point3<f64>) -> EyeSituation {
        let nominal = EyesDeviation::none(self.neck.len());
        let frames = self.neck.frames(&row.neck_rad);
        let moments = self.neck.gravity_moments_nm(&frames, 0.0);
        EyeSituation {
            neck_rad: row.neck_rad.clone(),
            truth_m,
            in_left_m: self.robot_from_left(&row.neck_rad, &nominal).inverse() * truth_m,
            t_secs: row.t_secs,
            background_m: row.background_m,
            set: row.set.clone(),
            neck_torques_nm: moments.iter().zip(&frames.axes).map(|(m, axis)| m.dot(axis)).collect(),
        }
    }

    /// Where both eyes see a known place: u, v left, u, v right, raw px. `None` outside of their
    /// view.
    pub fn image_points(&self, situation: &EyeSituation, deviation: &EyesDeviation) -> Option<Vec<f64>> {
        let mut in_left = self.robot_from_left(&situation.neck_rad, deviation).inverse() * situation.truth_m;
        let range_m = in_left.coords.norm();
        // Depth that leaks in from behind is a mixture of disparities, that is of inverse depths.
        if let Some(background_m) = situation.background_m.filter(|m| *m > 0.0) {
            let mixed = (1.0 - deviation.background_share) / range_m
                + deviation.background_share / background_m.max(range_m);
            in_left.coords *= 1.0 / mixed / range_m;
        }
        in_left.coords *= 1.0 - deviation.nearer_m / range_m;
        let turned = UnitQuaternion::from_scaled_axis(deviation.right_rad);
        let mut in_right = self.cameras.right_from_left.isometry * in_left;
        in_right += self.cameras.right_from_left.isometry.translation.vector * deviation.baseline_scale;
        let in_right = turned.inverse() * in_right;
        let left = self.cameras.left.project(&in_left.coords).ok()?;
        let right = self.cameras.right.project(&in_right.coords).ok()?;
        let [bulge_left, bulge_right] = deviation.distortion_px;
        let left = Imaged { bulge_px: bulge_left, shift_px: deviation.left_shift_px }.of(
            left,
            &in_left.coords,
            &self.cameras.left,
            deviation,
        );
        let own = [deviation.right_shift_px[0] - deviation.disparity_px, deviation.right_shift_px[1]];
        let right = Imaged { bulge_px: bulge_right, shift_px: own }.of(
            right,
            &in_right.coords,
            &self.cameras.right,
            deviation,
        );
        Some(vec![left.u_px, left.v_px, right.u_px, right.v_px])
    }

    /// What stereo with the nominal eyes makes of that, in their natural coordinates: see [`Self::natural`].
    pub fn estimate(
        &self,
        row: &Observation,
        situation: &EyeSituation,
        deviation: &EyesDeviation,
    ) -> Option<Vec<f64>> {
        debug_assert_eq!(row.neck_rad.len(), situation.neck_rad.len(), "the same neck");
        let seen = self.image_points(situation, deviation)?;
        let in_left = self.cameras.triangulate(Pixel::new(seen[0], seen[1]), Pixel::new(seen[2], seen[3]))?;
        Some(self.natural(&in_left.coords).to_vec())
    }

    /// Bearing right and down of a point in the left camera, and the angle between the rays of both eyes to it, rad.
    ///
    /// The bearing is how far off the axis the ray is, split by the direction in which it lies: a fisheye makes lengths
    /// on its sensor of that, so a pixel is nearly the same step in each of the three wherever one looks. A tangent grows
    /// by five times as much at 65° off the axis as in the middle.
    pub fn natural(&self, in_left: &Point3<f64>) -> [f64; 3] {
        natural(&in_left.coords, &right_in_left_m(&self.cameras))
    }

    /// The other way: the point in the left camera, m. `None` where the rays do not meet.
    pub fn place(&self, natural: &[f64]) -> Option<Point3<f64>> {
        place(*natural.first_chunk::<3>()?, &right_in_left_m(&self.cameras)).map(Point3::from)
    }
}

/// The right eye as the left one has it, m.
pub(crate) fn right_in_left_m(cameras: &StereoCameras) -> Vector3<f64> {
    cameras.right_from_left.isometry.inverse().translation.vector
}

/// See [`Eyes::natural`]: of a ray in the left camera and the right eye there, m.
pub(crate) fn natural(ray: &Vector3<f64>, to_right: &Vector3<f64>) -> [f64; 3] {
    let across = ray.xy().norm();
    let per_length = if across > NEAR_AXIS * ray.norm() { across.atan2(ray.z) / across } else { 1.0 / ray.z };
    // Of the triangle of both eyes and the point: the cross product is the same with either ray.
    let between = ray.cross(to_right).norm().atan2(ray.dot(&(ray - to_right)));
    [per_length * ray.x, per_length * ray.y, between]
}

/// The other way, m. `None` where the rays do not meet.
pub(crate) fn place([right, down, between]: [f64; 3], to_right: &Vector3<f64>) -> Option<Vector3<f64>> {
    let off_axis = right.hypot(down);
    let across = if off_axis > NEAR_AXIS { off_axis.sin() / off_axis } else { 1.0 };
    let ray = Vector3::new(across * right, across * down, off_axis.cos());
    let at_left = ray.cross(to_right).norm().atan2(ray.dot(to_right));
    // Law of sines.
    let range_m = to_right.norm() * (at_left + between).sin() / between.sin();
    let meet = between > 0.0 && at_left + between < std::f64::consts::PI && off_axis < std::f64::consts::PI;
    (meet && range_m.is_finite()).then(|| ray * range_m)
}

/// How far off the axis a ray is, as the lens bends it (angle of a fisheye, tangent of a pinhole), as a share of what it
/// is at half of the image's width beside the middle.
fn share_of_border(ray: &Vector3<f64>, camera: &plumbline_model::Camera) -> f64 {
    let half_width = 0.5 * f64::from(camera.width_px);
    let across = ray.xy().norm();
    match &camera.model {
        CameraModel::Fisheye(lens) => across.atan2(ray.z) * lens.fx_px / half_width,
        CameraModel::Pinhole(lens) => across / ray.z * lens.fx_px / half_width,
    }
}

/// What is off about the image of one eye alone, px.
struct Imaged {
    bulge_px: f64,
    shift_px: [f64; 2],
}

impl Imaged {
    /// A pixel as the deviating camera shows it.
    fn of(
        &self,
        pixel: Pixel<Raw>,
        ray: &Vector3<f64>,
        camera: &plumbline_model::Camera,
        deviation: &EyesDeviation,
    ) -> Pixel<Raw> {
        let middle = camera.model.principal_point();
        let off = (pixel.vector() - middle.vector()) * (1.0 + deviation.focal_scale);
        let outward = off.try_normalize(1e-12).unwrap_or_default();
        let stretched = off + outward * (self.bulge_px * share_of_border(ray, camera).powi(3));
        let [u_px, v_px] = self.shift_px;
        Pixel::new(
            middle.u_px + stretched.x + deviation.box_px[0] + u_px,
            middle.v_px + stretched.y + deviation.box_px[1] + v_px,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn eyes() -> Eyes {
        Eyes::of_rig(&Rig::built_in("nico").expect("comes along")).expect("eyes")
    }

    /// A point so far off the axis (rad), this way round it, at a distance of 0.5 m.
    fn point(off_axis_rad: f64, way_rad: f64) -> Point3<f64> {
        let across = off_axis_rad.sin();
        Point3::new(across * way_rad.cos(), across * way_rad.sin(), off_axis_rad.cos()) * 0.5
    }

    #[test]
    fn a_place_comes_back_from_its_natural_coordinates_also_on_the_axis_and_beside_the_image() {
        let eyes = eyes();
        for off_axis_rad in [0.0, 1e-9, 1e-3, 0.3, 0.9, 1.3, 1.7] {
            for way in 0..8 {
                let at = point(off_axis_rad, f64::from(way));
                let back = eyes.place(&eyes.natural(&at)).expect("a place");
                assert!((back - at).norm() < 1e-9, "{off_axis_rad} {way}: {at} {back}");
            }
        }
    }

    #[test]
    fn rays_that_do_not_meet_are_no_place() {
        let eyes = eyes();
        for between in [0.0, -0.01, std::f64::consts::PI, f64::NAN] {
            assert_eq!(eyes.place(&[0.1, 0.2, between]), None);
        }
        assert_eq!(eyes.place(&[0.1, 0.2]), None);
    }

    #[test]
    fn a_pixel_is_nearly_the_same_step_in_the_middle_and_far_off_the_axis() {
        let eyes = eyes();
        let row = Observation {
            neck_rad: vec![0.0; eyes.neck.len()],
            ..Observation::imagined(crate::measurements::What::Place)
        };
        let robot_from_left = eyes.robot_from_left(&row.neck_rad, &EyesDeviation::none(eyes.neck.len()));
        let step = |off_axis_rad: f64| -> f64 {
            let situation = eyes.situation(&row, robot_from_left * point(off_axis_rad, 0.4));
            let none = EyesDeviation::none(eyes.neck.len());
            let still = eyes.estimate(&row, &situation, &none).expect("in view");
            // Both images shifted by a pixel along their rows, and the right one alone.
            let both = EyesDeviation { box_px: [1.0, 0.0], ..none.clone() };
            let right = EyesDeviation { disparity_px: 1.0, ..none };
            let both = eyes.estimate(&row, &situation, &both).expect("in view")[0] - still[0];
            let right = eyes.estimate(&row, &situation, &right).expect("in view")[2] - still[2];
            both.abs().max(right.abs())
        };
        let middle_rad = step(0.0);
        for off_axis_rad in [0.4, 0.8, 1.1] {
            let ratio = step(off_axis_rad) / middle_rad;
            assert!((0.6..1.6).contains(&ratio), "{off_axis_rad}: {ratio}");
        }
    }
}
