//! From where the scene is looked at.

use egui::{Pos2, Vec2, pos2};
use nalgebra::{Point3, Vector3};

/// Nothing nearer than this is drawn, in meters.
pub(super) const NEAR_M: f64 = 0.02;

const NEAREST_M: f64 = 0.08;
const FARTHEST_M: f64 = 8.0;
/// Seen from slightly below the table at most.
const LOWEST_RAD: f64 = -0.35;

/// Places to look from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewPreset {
    /// The whole scene from the front right: what "Reset view" brings back.
    Home,
    /// From the front, looking at the robot.
    Front,
    /// From the robot's right.
    Side,
    /// From above; forward is up and left is left, as on the table map.
    Top,
    /// From where the robot's eyes are.
    Robot,
}

impl ViewPreset {
    /// Those with a button, and the button's text.
    pub const BUTTONS: [(Self, &'static str); 5] = [
        (Self::Front, "Front"),
        (Self::Side, "Side"),
        (Self::Top, "Top"),
        (Self::Robot, "Robot's view"),
        (Self::Home, "Reset view"),
    ];
}

/// A camera that circles around a point. Kept by the caller between frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneCamera {
    /// The point in the middle of the picture, in the robot's frame, in meters.
    pub target_m: Point3<f64>,
    /// Where it looks, about +z from x (forward), in radians.
    pub heading_rad: f64,
    /// How far it looks down, in radians; π/2 is straight down.
    pub pitch_rad: f64,
    /// From the camera to the target.
    pub distance_m: f64,
    /// Opening angle from top to bottom.
    pub fov_y_rad: f64,
}

impl Default for SceneCamera {
    fn default() -> Self {
        Self::preset(ViewPreset::Home)
    }
}

/// A view that is narrower than this, width by height, shows as much as one of this shape would.
const FITTING_ASPECT: f32 = 1.15;

/// A half line in the robot's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts: the camera.
    pub origin_m: Point3<f64>,
    /// Unit vector.
    pub direction: Vector3<f64>,
}

impl SceneCamera {
    /// One of the usual places, for a robot of NICO's size in front of its table.
    pub fn preset(preset: ViewPreset) -> Self {
        let place = |target: [f64; 3], heading: f64, pitch: f64, distance_m: f64, fov: f64| Self {
            target_m: Point3::from(target),
            heading_rad: heading.to_radians(),
            pitch_rad: pitch.to_radians(),
            distance_m,
            fov_y_rad: fov.to_radians(),
        };
        match preset {
            ViewPreset::Home => place([0.28, 0.0, 0.12], 142.0, 26.0, 2.1, 32.0),
            ViewPreset::Front => place([0.15, 0.0, 0.20], 180.0, 6.0, 1.8, 32.0),
            ViewPreset::Side => place([0.22, 0.0, 0.20], 90.0, 4.0, 1.7, 32.0),
            ViewPreset::Top => place([0.42, 0.0, 0.06], 0.0, 90.0, 2.5, 32.0),
            ViewPreset::Robot => place([0.40, 0.0, 0.06], 0.0, 48.0, 0.47, 80.0),
        }
    }

    /// Turns around the target: `right_rad` moves the camera to the picture's right, `up_rad` up.
    pub fn orbit(&mut self, right_rad: f64, up_rad: f64) {
        self.heading_rad = (self.heading_rad + right_rad).rem_euclid(std::f64::consts::TAU);
        self.pitch_rad = (self.pitch_rad + up_rad).clamp(LOWEST_RAD, std::f64::consts::FRAC_PI_2);
    }

    /// Goes nearer by a factor above 1, away by one below.
    pub fn zoom(&mut self, factor: f64) {
        if factor.is_finite() && factor > 0.0 {
            self.distance_m = (self.distance_m / factor).clamp(NEAREST_M, FARTHEST_M);
        }
    }

    /// Moves the picture by so many points on a view of that size.
    pub fn pan(&mut self, by: Vec2, size: Vec2) {
        let view = self.view(size.max(Vec2::splat(1.0)));
        let m_per_point = self.distance_m / f64::from(view.focal);
        self.target_m += (view.up * f64::from(by.y) - view.right * f64::from(by.x)) * m_per_point;
    }

    /// Whether every number of it is one.
    pub fn is_finite(&self) -> bool {
        let rest = [self.heading_rad, self.pitch_rad, self.distance_m, self.fov_y_rad];
        self.target_m.iter().chain(&rest).all(|c| c.is_finite())
    }

    /// How it maps the robot's frame to a view of that size. A camera that is not finite is
    /// replaced by the one of "Reset view".
    pub fn view(&self, size: Vec2) -> View {
        let camera = if self.is_finite() { *self } else { Self::default() };
        let (sin_h, cos_h) = camera.heading_rad.sin_cos();
        let (sin_p, cos_p) = camera.pitch_rad.sin_cos();
        let forward = Vector3::new(cos_p * cos_h, cos_p * sin_h, -sin_p);
        let right = Vector3::new(sin_h, -cos_h, 0.0);
        let up = right.cross(&forward);
        let fov = camera.fov_y_rad.clamp(0.05, 2.6);
        View {
            eye_m: camera.target_m - forward * camera.distance_m.clamp(NEAREST_M, FARTHEST_M),
            right,
            up,
            forward,
            focal: size.y.min(size.x / FITTING_ASPECT) / 2.0 / (fov / 2.0).tan() as f32,
            center: pos2(size.x / 2.0, size.y / 2.0),
        }
    }
}

/// A camera and the size of the picture: how points get there and back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where the camera is, in the robot's frame.
    pub eye_m: Point3<f64>,
    /// To the right of the picture, unit vector in the robot's frame.
    pub right: Vector3<f64>,
    /// Up in the picture.
    pub up: Vector3<f64>,
    /// Into the picture.
    pub forward: Vector3<f64>,
    /// Focal length in the unit of the picture's size.
    pub focal: f32,
    /// Middle of the picture.
    pub center: Pos2,
}

impl View {
    /// Where a point is in the picture, from its top left, and how far in front of the camera,
    /// in meters. `None` behind the camera.
    pub fn project(&self, at_m: &Point3<f64>) -> Option<(Pos2, f64)> {
        let p = at_m - self.eye_m;
        let depth_m = self.forward.dot(&p);
        if depth_m.is_nan() || depth_m < NEAR_M {
            return None;
        }
        let scale = f64::from(self.focal) / depth_m;
        let right = (self.right.dot(&p) * scale) as f32;
        let up = (self.up.dot(&p) * scale) as f32;
        Some((pos2(self.center.x + right, self.center.y - up), depth_m))
    }

    /// The half line of everything that is seen at a place of the picture.
    pub fn ray(&self, at: Pos2) -> Ray {
        let offset = (at - self.center) / self.focal;
        let direction = self.forward + self.right * f64::from(offset.x) - self.up * f64::from(offset.y);
        Ray { origin_m: self.eye_m, direction: direction.normalize() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::vec2;

    const SIZE: Vec2 = vec2(700.0, 500.0);

    fn at(camera: &SceneCamera, x: f64, y: f64, z: f64) -> Pos2 {
        camera.view(SIZE).project(&Point3::new(x, y, z)).expect("in front of the camera").0
    }

    #[test]
    fn from_above_forward_is_up_and_left_is_left() {
        let camera = SceneCamera::preset(ViewPreset::Top);
        let middle = at(&camera, 0.3, 0.0, 0.05);
        assert!(at(&camera, 0.4, 0.0, 0.05).y < middle.y - 10.0);
        assert!(at(&camera, 0.3, 0.1, 0.05).x < middle.x - 10.0);
    }

    #[test]
    fn presets_look_from_where_they_say() {
        let front = SceneCamera::preset(ViewPreset::Front);
        assert!(front.view(SIZE).eye_m.x > 1.0);
        // The robot's right hand is on the left of the one who faces it.
        assert!(at(&front, 0.2, -0.2, 0.1).x < at(&front, 0.2, 0.2, 0.1).x);
        let side = SceneCamera::preset(ViewPreset::Side);
        assert!(side.view(SIZE).eye_m.y < -1.0);
        assert!(at(&side, 0.5, 0.0, 0.1).x > at(&side, 0.0, 0.0, 0.1).x);
        let robot = SceneCamera::preset(ViewPreset::Robot).view(SIZE).eye_m;
        let eyes = Point3::new(0.08, 0.0, 0.42);
        assert!((robot - eyes).norm() < 0.03, "{robot}");
        for (preset, _) in ViewPreset::BUTTONS {
            let up = at(&SceneCamera::preset(preset), 0.3, 0.0, 0.2);
            assert!(preset == ViewPreset::Top || up.y < at(&SceneCamera::preset(preset), 0.3, 0.0, 0.1).y);
        }
    }

    #[test]
    fn rays_undo_projection() {
        for (preset, _) in ViewPreset::BUTTONS {
            let view = SceneCamera::preset(preset).view(SIZE);
            let point = Point3::new(0.41, -0.13, 0.09);
            let (place, depth_m) = view.project(&point).expect("in front");
            let ray = view.ray(place);
            let back = ray.origin_m + ray.direction * (depth_m / ray.direction.dot(&view.forward));
            assert!((back - point).norm() < 1e-6, "{preset:?}: {back}");
        }
    }

    #[test]
    fn panning_moves_the_target_with_the_pointer() {
        let mut camera = SceneCamera::default();
        let point = camera.target_m;
        let before = at(&camera, point.x, point.y, point.z);
        camera.pan(vec2(40.0, -25.0), SIZE);
        let after = at(&camera, point.x, point.y, point.z);
        assert!((after - before - vec2(40.0, -25.0)).length() < 0.5, "{after:?}");
    }

    #[test]
    fn limits_hold_and_nothing_behind_is_projected() {
        let mut camera = SceneCamera::default();
        camera.orbit(20.0, 20.0);
        assert!(camera.pitch_rad <= std::f64::consts::FRAC_PI_2);
        camera.zoom(1e9);
        assert!(camera.distance_m >= NEAREST_M);
        camera.zoom(f64::NAN);
        assert!(camera.is_finite());
        let view = camera.view(SIZE);
        assert!(view.project(&(view.eye_m - view.forward)).is_none());
        camera.heading_rad = f64::NAN;
        assert_eq!(camera.view(SIZE), SceneCamera::default().view(SIZE));
    }
}
