//! A head with two eyes, and where they see a point when things are wrong.

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use plumbline_model::CameraModel;
use plumbline_model::robot::{JointKind, Rig};
use plumbline_model::{Camera, StereoCameras};

use super::secret::{Kind, SHIFT_PER_TURN_M, Secret};
use crate::error::BlindError;
use crate::heat;

/// A neck that stays behind has forgotten nothing of a way as long as this, rad.
const REMEMBERED_RAD: f64 = 0.6;
/// A loose eye wobbles once in so long, s.
const WOBBLE_S: [f64; 2] = [250.0, 700.0];
/// Further off the axis nothing is looked at, rad.
const WIDEST_RAD: f64 = 1.2;

/// A joint of the neck.
#[derive(Clone, Debug)]
struct Hinge {
    name: String,
    place: Isometry3<f64>,
    axis: Vector3<f64>,
}

/// A fisheye: an angle off the axis becomes a length on the sensor by a polynomial of odd powers.
#[derive(Clone, Copy, Debug)]
struct Lens {
    focal_px: [f64; 2],
    middle_px: [f64; 2],
    skew_px: f64,
    powers: [f64; 4],
    size_px: [f64; 2],
}

/// How the head stands at a moment.
#[derive(Clone, Debug)]
pub struct Look {
    /// Angles of the neck as its encoders say, rad.
    pub neck_rad: Vec<f64>,
    /// Those before, rad.
    pub from_rad: Vec<f64>,
    /// Since the eyes were switched on, s.
    pub t_secs: f64,
    /// Number of the set.
    pub set: usize,
}

/// The head of a rig, as described.
#[derive(Clone, Debug)]
pub struct Head {
    neck: Vec<Hinge>,
    head_from_left: Isometry3<f64>,
    left_from_right: Isometry3<f64>,
    lenses: [Lens; 2],
    /// What the robot's own program takes its eyes to be.
    pub cameras: StereoCameras,
    /// Angles of the neck when it rests, rad.
    pub rest_rad: Vec<f64>,
}

impl Head {
    /// Of a rig.
    ///
    /// # Errors
    /// When its lenses are no fisheyes.
    pub fn of_rig(rig: &Rig) -> Result<Self, BlindError> {
        let (mut neck, mut rest_rad) = (vec![], vec![]);
        let (mut link, home) = (rig.eyes.link, rig.home());
        let mut fixed = Isometry3::identity();
        while let Some(joint) = rig.description.joint_above(link) {
            fixed = joint.parent_from_joint * fixed;
            if let JointKind::Revolute { axis, index, .. } = &joint.kind {
                let place = std::mem::replace(&mut fixed, Isometry3::identity());
                neck.push(Hinge { name: joint.name.clone(), place, axis: axis.into_inner() });
                rest_rad.push(home[*index]);
            }
            link = joint.parent;
        }
        neck.reverse();
        rest_rad.reverse();
        let cameras = rig.eyes.cameras;
        Ok(Self {
            neck,
            head_from_left: rig.eyes.head_from_left.isometry,
            left_from_right: cameras.right_from_left.isometry.inverse(),
            lenses: [Lens::of(&cameras.left)?, Lens::of(&cameras.right)?],
            cameras,
            rest_rad,
        })
    }

    /// Names of the joints of the neck.
    pub fn joints(&self) -> Vec<String> {
        self.neck.iter().map(|hinge| hinge.name.clone()).collect()
    }

    /// The left eye as described.
    pub fn robot_from_left(&self, neck_rad: &[f64]) -> Isometry3<f64> {
        let head = self.neck.iter().zip(neck_rad).fold(Isometry3::identity(), |at, (hinge, angle)| {
            at * hinge.place * UnitQuaternion::from_scaled_axis(hinge.axis * *angle)
        });
        head * self.head_from_left
    }

    /// Where the two eyes see a point: u, v of the left and of the right image, px; `None` out of view.
    pub fn sees(&self, secrets: &[Secret], look: &Look, point: &Point3<f64>) -> Option<[f64; 4]> {
        let robot_from_left = self.carried(secrets, look);
        let robot_from_right = robot_from_left * self.right_eye(secrets, look);
        let [mut left, mut right] = self.lenses;
        for secret in secrets {
            match secret.kind {
                Kind::Focal => {
                    left.lengthen(secret.amount);
                    right.lengthen(secret.amount);
                }
                Kind::OneFocal => left.lengthen(secret.amount),
                Kind::Bulge => {
                    left.powers[0] += secret.amount;
                    right.powers[0] += secret.amount;
                }
                Kind::ImageShift => {
                    right.middle_px[0] += secret.part(0);
                    right.middle_px[1] += secret.part(1);
                }
                Kind::ShiftGrows => right.middle_px[0] += secret.amount * heat::after(look.t_secs).1,
                _ => {}
            }
        }
        let seen_left = left.sees(&(robot_from_left.inverse() * point).coords)?;
        let mut seen_right = right.sees(&(robot_from_right.inverse() * point).coords)?;
        for secret in secrets {
            let off = [0, 1].map(|c| (seen_right[c] - right.middle_px[c]) / (0.5 * right.size_px[c]));
            seen_right[0] += match secret.kind {
                Kind::HalfLens => 4.0 * secret.amount * off[0].max(0.0).powi(2),
                Kind::RowOffset => secret.amount * off[1],
                _ => 0.0,
            };
        }
        Some([seen_left[0], seen_left[1], seen_right[0], seen_right[1]])
    }

    /// The left eye, where the neck and the body that carries both eyes bring it.
    fn carried(&self, secrets: &[Secret], look: &Look) -> Isometry3<f64> {
        let mut at = Isometry3::identity();
        for (j, hinge) in self.neck.iter().enumerate() {
            at *= hinge.place;
            let mut angle = look.neck_rad[j];
            for secret in secrets.iter().filter(|secret| secret.which == j) {
                match secret.kind {
                    Kind::HeadZero => angle += secret.amount,
                    Kind::NeckMemory => {
                        let came = (look.neck_rad[j] - look.from_rad[j]) / REMEMBERED_RAD;
                        angle -= secret.amount * came.clamp(-1.0, 1.0);
                    }
                    Kind::HeadSkew => {
                        let any = Vector3::new(secret.shape[0], secret.shape[1], secret.shape[2]);
                        let across = (any - hinge.axis * any.dot(&hinge.axis)).normalize();
                        at *= UnitQuaternion::from_scaled_axis(across * secret.amount);
                    }
                    _ => {}
                }
            }
            at *= UnitQuaternion::from_scaled_axis(hinge.axis * angle);
        }
        at *= self.head_from_left;
        for secret in secrets {
            let turn = Vector3::new(secret.part(0), secret.part(1), secret.part(2));
            match secret.kind {
                Kind::Mount => {
                    let shift =
                        Vector3::new(secret.part(3), secret.part(4), secret.part(5)) * SHIFT_PER_TURN_M;
                    at *= Translation3::from(shift);
                    at *= UnitQuaternion::from_scaled_axis(turn);
                }
                Kind::MountGrows => {
                    at *= UnitQuaternion::from_scaled_axis(turn * heat::after(look.t_secs).1);
                }
                _ => {}
            }
        }
        at
    }

    /// The right eye beside the left one.
    fn right_eye(&self, secrets: &[Secret], look: &Look) -> Isometry3<f64> {
        let mut at = self.left_from_right;
        let warm = heat::after(look.t_secs).1;
        let mut turn = Vector3::zeros();
        for secret in secrets {
            turn += match secret.kind {
                Kind::EyeYaw => Vector3::y() * secret.amount,
                Kind::YawGrows => Vector3::y() * (secret.amount * warm),
                Kind::EyeRoll => Vector3::new(secret.part(1), 0.0, secret.part(0)),
                Kind::RollGrows => Vector3::new(secret.part(1), 0.0, secret.part(0)) * warm,
                Kind::Knock if secret.which == look.set => {
                    Vector3::new(secret.part(0), secret.part(1), secret.part(2))
                }
                Kind::Wobble => {
                    let [short_s, long_s] = WOBBLE_S;
                    let period_s = short_s + (long_s - short_s) * secret.shape[1].abs();
                    let phase = std::f64::consts::TAU * (look.t_secs / period_s + secret.shape[0]);
                    Vector3::y() * (secret.amount * phase.sin())
                }
                _ => Vector3::zeros(),
            };
            if secret.kind == Kind::Baseline {
                at.translation.vector *= 1.0 + secret.amount;
            }
        }
        at * UnitQuaternion::from_scaled_axis(turn)
    }
}

impl Lens {
    fn of(camera: &Camera) -> Result<Self, BlindError> {
        let CameraModel::Fisheye(lens) = camera.model else { return Err(BlindError::Lens) };
        Ok(Self {
            focal_px: [lens.fx_px, lens.fy_px],
            middle_px: [lens.cx_px, lens.cy_px],
            skew_px: lens.skew_px,
            powers: lens.k,
            size_px: [f64::from(camera.width_px), f64::from(camera.height_px)],
        })
    }

    fn lengthen(&mut self, share: f64) {
        self.focal_px = self.focal_px.map(|focal| focal * (1.0 + share));
        self.skew_px *= 1.0 + share;
    }

    /// The image of a point in the lens's frame, px; `None` beside the image.
    fn sees(&self, point: &Vector3<f64>) -> Option<[f64; 2]> {
        let off_rad = point.xy().norm().atan2(point.z);
        if off_rad > WIDEST_RAD {
            return None;
        }
        // A sum of odd powers of the angle, along the direction in which the point lies.
        let mut length = off_rad;
        for (k, power) in self.powers.iter().enumerate() {
            length += power * off_rad.powi(2 * k as i32 + 3);
        }
        let toward = point.xy().try_normalize(1e-12).unwrap_or_default() * length;
        let u_px = self.middle_px[0] + self.focal_px[0] * toward.x + self.skew_px * toward.y;
        let v_px = self.middle_px[1] + self.focal_px[1] * toward.y;
        let is_inside = (0.0..self.size_px[0]).contains(&u_px) && (0.0..self.size_px[1]).contains(&v_px);
        is_inside.then_some([u_px, v_px])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plumbline_model::Point;
    use plumbline_model::robot::default_rig;

    fn look(head: &Head) -> Look {
        Look { neck_rad: head.rest_rad.clone(), from_rad: head.rest_rad.clone(), t_secs: 100.0, set: 0 }
    }

    #[test]
    fn without_secrets_eyes_see_what_the_robots_own_cameras_do() {
        let rig = default_rig();
        let head = Head::of_rig(&rig).expect("fisheyes");
        let cameras = &rig.eyes.cameras;
        for (x, y) in [(0.3, -0.2), (0.45, 0.1), (0.6, 0.3)] {
            let seen = head.sees(&[], &look(&head), &Point3::new(x, y, 0.06)).expect("in view");
            let in_left = rig.robot_from_left(&rig.home()).inverse() * Point::new(x, y, 0.06);
            let left = cameras.left.project(&in_left.coords.coords).expect("in view");
            let in_right = cameras.right_from_left * in_left;
            let right = cameras.right.project(&in_right.coords.coords).expect("in view");
            for (own, theirs) in seen.iter().zip([left.u_px, left.v_px, right.u_px, right.v_px]) {
                assert!((own - theirs).abs() < 1e-9, "{own} {theirs}");
            }
        }
    }

    #[test]
    fn an_eye_that_is_turned_to_the_right_sees_things_further_left() {
        let head = Head::of_rig(&default_rig()).expect("fisheyes");
        let point = Point3::new(0.45, 0.0, 0.06);
        let turned = Secret { kind: Kind::EyeYaw, which: 0, amount: 0.01, shape: [0.0; 6] };
        let [_, _, before, _] = head.sees(&[], &look(&head), &point).expect("in view");
        let [_, _, after, _] = head.sees(&[turned], &look(&head), &point).expect("in view");
        assert!((after - before + 1.5).abs() < 0.3, "{before} {after}");
    }
}
