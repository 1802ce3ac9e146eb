//! One scene of a set: room, arms, toys, eyes, light, all thrown by dice.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::{Camera, CameraModel, ClassIndex, Pose};

use super::arms::{self, Bank, Doing};
use super::dice::Dice;
use super::finish::{Finish, Rim};
use super::labels::Thing;
use super::placing::{self, Placed};
use super::room::{self, put};
use crate::eyes::{FaceShell, Sensor, theta_d};
use crate::scene::{Item, Light, Scenery, Snapshot, TrueEyes};
use crate::toys::Toy;

/// Object number of the first palm, those of toys follow after all arms.
const FIRST_OBJECT: u16 = 100;

/// A scene with everything that makes an image pair of it.
pub(super) struct Scene {
    /// Room, clutter, torso.
    items: Vec<Item>,
    /// Items of each arm, with its hand.
    arms: Vec<Vec<Item>>,
    toys: Vec<Placed>,
    /// Where everything is.
    pub snapshot: Snapshot,
    light: Light,
    /// Lens and sensor.
    pub sensor: Sensor,
    /// The camera's processing.
    pub finish: Finish,
    /// Seed of the noise.
    pub noise_seed: u64,
    /// What is labeled.
    pub things: Vec<Thing>,
}

/// Number of the published class of a toy.
pub(super) fn class_of_toy(toy: Toy) -> ClassIndex {
    ClassIndex(match toy {
        Toy::Banana => 0,
        Toy::Duck => 1,
        Toy::Mushroom => 3,
        Toy::Onion => 4,
        Toy::Orange => 5,
        Toy::Tomato => 7,
    })
}

/// Number of the published class of a hand; `None` for an arm that is neither left nor right.
pub(super) fn class_of_hand(arm: &str) -> Option<ClassIndex> {
    match arm {
        "left" => Some(ClassIndex(2)),
        "right" => Some(ClassIndex(6)),
        _ => None,
    }
}

impl Scene {
    /// The scene of one pair of a set.
    pub fn draw(rig: &Rig, bank: &Bank, seed: u64, index: u64) -> Self {
        let mut dice = Dice::of_pair(seed, index);
        let dice = &mut dice;
        let mut posture = look_somewhere(rig, dice);
        let eyes = eyes(rig, &posture, dice);
        let mut shown = vec![false; rig.arms.len()];
        for (arm, shown) in shown.iter_mut().enumerate() {
            if let Some(angles) = choose_posture(rig, bank, arm, &posture, &eyes, dice) {
                posture = posture.with(&rig.arms[arm].joints, &angles);
                *shown = true;
            }
            posture = arms::grip(rig, arm, &posture, dice);
        }
        let mut items = vec![];
        let room = room::furnish(rig, dice, &mut items);
        let _ = arms::draw(rig, &posture, None, dice, &mut items);
        let mut hands = vec![];
        let mut drawn: Vec<Vec<Item>> = vec![vec![]; shown.len()];
        for arm in (0..shown.len()).filter(|arm| shown[*arm]) {
            let palm = Some((arm, FIRST_OBJECT + arm as u16));
            hands.extend(arms::draw(rig, &posture, palm, dice, &mut drawn[arm]));
        }
        let all_arms: Vec<Item> = drawn.iter().flatten().cloned().collect();
        let mut toys: Vec<Placed> = vec![];
        for toy in placing::choose(dice) {
            let look = placing::some_look(dice);
            toys.extend(placing::place(toy, &look, &room, &hands, &all_arms, &toys, dice));
        }
        let mut scene = Self {
            items,
            arms: drawn,
            toys,
            snapshot: Snapshot { time_s: 0.0, robot_from_body: vec![Isometry3::identity()], eyes },
            light: light(dice),
            sensor: sensor(&eyes, dice),
            finish: Finish::default(),
            noise_seed: dice.seed(),
            things: vec![],
        };
        scene.finish = Finish::draw(scene.rims(), dice);
        scene.things = scene.list_things(rig);
        scene
    }

    /// The edges of both images.
    fn rims(&self) -> [Rim; 2] {
        let eyes = &self.snapshot.eyes;
        [&eyes.left, &eyes.right].map(|camera| {
            let middle = camera.model.principal_point();
            let (focal_px, _) = camera.model.focal_px();
            let angle = f64::from(self.sensor.image_circle_rad);
            let radius_px = match &camera.model {
                CameraModel::Fisheye(lens) => focal_px * theta_d(lens, angle),
                CameraModel::Pinhole(_) => focal_px * angle,
            };
            Rim { middle_px: [middle.u_px as f32, middle.v_px as f32], radius_px: radius_px as f32 }
        })
    }

    fn list_things(&self, rig: &Rig) -> Vec<Thing> {
        let mut things = vec![];
        for (arm, items) in self.arms.iter().enumerate() {
            let object = FIRST_OBJECT + arm as u16;
            let palm: Vec<_> = items
                .iter()
                .filter(|item| item.object == object)
                .map(|item| (item.body_from_shape, item.shape.clone()))
                .collect();
            if let Some(class) = class_of_hand(&rig.arms[arm].name).filter(|_| !palm.is_empty()) {
                things.push(Thing { object, class, robot_from_shapes: palm });
            }
        }
        for (i, placed) in self.toys.iter().enumerate() {
            let shapes = placed.parts.iter();
            things.push(Thing {
                object: self.object_of_toy(i),
                class: class_of_toy(placed.toy),
                robot_from_shapes: shapes
                    .map(|part| (placed.robot_from_toy * part.toy_from_shape, part.shape.clone()))
                    .collect(),
            });
        }
        things
    }

    fn object_of_toy(&self, toy: usize) -> u16 {
        FIRST_OBJECT + (self.arms.len() + toy) as u16
    }

    /// What is drawn: all but the things without which it was asked for.
    pub fn scenery(&self, without: &[u16]) -> Scenery {
        let mut items = self.items.clone();
        for (arm, own) in self.arms.iter().enumerate() {
            if !without.contains(&(FIRST_OBJECT + arm as u16)) {
                items.extend(own.iter().cloned());
            }
        }
        for (i, placed) in self.toys.iter().enumerate() {
            let object = self.object_of_toy(i);
            if without.contains(&object) {
                continue;
            }
            for part in &placed.parts {
                let at = placed.robot_from_toy * part.toy_from_shape;
                put(&mut items, object, at, part.shape.clone(), part.material);
            }
        }
        Scenery { revision: 0, items, light: self.light }
    }
}

/// The head looks down at the table, mostly ahead.
pub(super) fn look_somewhere(rig: &Rig, dice: &mut Dice) -> Posture {
    let mut posture = rig.home();
    let pan = if dice.chance(0.6) { dice.normal(8_f64.to_radians()) } else { dice.within(-0.79, 0.79) };
    let tilt = if dice.chance(0.7) { dice.within(18.0, 42.0) } else { dice.within(8.0, 58.0) };
    posture[rig.eyes.pan] = pan;
    posture[rig.eyes.tilt] = -tilt.to_radians();
    posture
}

fn eyes(rig: &Rig, posture: &Posture, dice: &mut Dice) -> TrueEyes {
    let mut jitter = || {
        let turn = UnitQuaternion::from_scaled_axis(dice.place([-0.05; 3], [0.05; 3]));
        let shift = dice.place([-0.008; 3], [0.008; 3]);
        Isometry3::from_parts(Translation3::from(shift), turn)
    };
    let left = rig.robot_from_left(posture).isometry * jitter();
    let own = jitter();
    let own = Isometry3::from_parts(
        Translation3::from(own.translation.vector * 0.2),
        UnitQuaternion::identity().slerp(&own.rotation, 0.2),
    );
    let right = left * rig.eyes.cameras.right_from_left.inverse().isometry * own;
    let wide = dice.within(0.94, 1.10);
    let cameras = &rig.eyes.cameras;
    TrueEyes {
        robot_from_left: Pose::new(left),
        robot_from_right: Pose::new(right),
        left: lens(&cameras.left, wide, dice),
        right: lens(&cameras.right, wide, dice),
    }
}

fn lens(published: &Camera, wide: f64, dice: &mut Dice) -> Camera {
    let mut camera = *published;
    if let CameraModel::Fisheye(lens) = &mut camera.model {
        let factor = wide * (1.0 + dice.normal(0.004));
        lens.fx_px *= factor;
        lens.fy_px *= factor * (1.0 + dice.normal(0.003));
        lens.cx_px += dice.normal(6.0);
        lens.cy_px += dice.normal(6.0);
        for (k, sigma) in lens.k.iter_mut().zip([0.006, 0.003, 0.0008, 0.00008]) {
            *k += dice.normal(sigma);
        }
    }
    camera
}

/// Tries postures until the palm is in sight, mostly.
pub(super) fn choose_posture(
    rig: &Rig,
    bank: &Bank,
    arm: usize,
    posture: &Posture,
    eyes: &TrueEyes,
    dice: &mut Dice,
) -> Option<Vec<f64>> {
    let doing = match dice.within(0.0, 1.0) {
        p if p < 0.40 => Doing::Resting,
        p if p < 0.62 => Doing::Raised,
        p if p < 0.82 => Doing::Working,
        p if p < 0.90 => Doing::Anything,
        _ => return None,
    };
    let palm = crate::hand_look::palms(rig)[arm]?;
    let mut last = None;
    for _ in 0..if dice.chance(0.85) { 40 } else { 1 } {
        let angles = bank.pick(arm, doing, dice)?;
        let place = rig.description.forward(&posture.with(&rig.arms[arm].joints, &angles)).of(palm).isometry;
        let middle = place * nalgebra::Point3::new(0.0, 0.0, -0.034);
        let before_eye = (eyes.robot_from_left.isometry.inverse() * middle).coords;
        let from_eye = (middle.coords - eyes.robot_from_left.isometry.translation.vector).normalize();
        // A palm is best told when it is seen flat; one that is held up shows its edge as often.
        let flat = (place.rotation * Vector3::x()).dot(&from_eye).abs();
        let in_sight = before_eye.z.atan2(before_eye.xy().norm()) > -0.08;
        // Beside the head, or pointing ahead on the table, as they mostly are.
        let usual = match doing {
            Doing::Raised => before_eye.z.atan2(before_eye.xy().norm()) < 0.6,
            Doing::Resting => (place.rotation * -Vector3::z()).x > 0.6,
            Doing::Working | Doing::Anything => true,
        };
        last = Some(angles);
        let flat_enough = doing == Doing::Raised || flat > dice.within(0.0, 0.8);
        if in_sight && flat_enough && (usual || dice.chance(0.25)) {
            break;
        }
    }
    last
}

fn light(dice: &mut Dice) -> Light {
    let toward = Vector3::new(dice.normal(0.5), dice.normal(0.5), -1.0);
    let lamp = dice.within_f32(0.15, 1.0);
    Light { toward, lamp, ambient: (1.15 - lamp + dice.within_f32(-0.2, 0.25)).max(0.12) }
}

fn sensor(eyes: &TrueEyes, dice: &mut Dice) -> Sensor {
    let exposure = if dice.chance(0.8) { dice.within_f32(0.85, 1.5) } else { dice.within_f32(0.4, 2.3) };
    let warm = dice.normal(0.06) as f32;
    let green = dice.normal(0.025) as f32;
    let limit = [&eyes.left, &eyes.right]
        .iter()
        .map(|camera| match &camera.model {
            CameraModel::Fisheye(lens) => lens.limit_rad(),
            _ => std::f64::consts::FRAC_PI_2,
        })
        .fold(2.4, f64::min) as f32;
    let circle = if dice.chance(0.7) { dice.within_f32(1.62, 1.82) } else { dice.within_f32(1.45, 1.75) };
    Sensor {
        exposure,
        white_balance: [1.0 + warm, 1.0 + green, 1.0 - warm].map(|f: f32| f.clamp(0.7, 1.3)),
        full_well_electrons: 10_f32.powf(dice.within_f32(2.9, 4.2)),
        read_noise_electrons: dice.within_f32(0.5, 6.0),
        blur_px: if dice.chance(0.8) { dice.within_f32(0.2, 0.6) } else { dice.within_f32(0.5, 1.1) },
        falloff: dice.within_f32(0.0, 0.4),
        image_circle_rad: circle.min(limit - 0.01),
        shell: dice.chance(0.96).then(|| shell(dice)),
    }
}

/// The face's edge, like the real one but wavy.
fn shell(dice: &mut Dice) -> FaceShell {
    let mut shell = FaceShell::default();
    let size = dice.within_f32(0.84, 1.08);
    let (a, b) = (dice.within_f32(-0.07, 0.07), dice.within_f32(-0.05, 0.05));
    let (p, q) = (dice.within_f32(0.0, 6.3), dice.within_f32(0.0, 6.3));
    let steps = shell.edge_rad.len() as f32;
    for (i, edge) in shell.edge_rad.iter_mut().enumerate() {
        let angle = std::f32::consts::TAU * i as f32 / steps;
        *edge = (*edge * size + a * (angle + p).sin() + b * (3.0 * angle + q).sin()).clamp(0.6, 3.0);
    }
    let bright = dice.within_f32(0.3, 1.6);
    shell.light = shell.light.map(|c| c * bright * dice.within_f32(0.85, 1.15));
    shell.softness_rad = dice.within_f32(0.006, 0.03);
    shell
}
