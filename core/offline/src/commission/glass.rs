//! Where the eyes see the touchscreen: the outline of its frame, fitted to the edges in both images. It
//! is what the arm's frame and the eyes' frame have in common.

use image::GrayImage;
use nalgebra::{DMatrix, DVector, Isometry3, Matrix6, Point3, UnitQuaternion, Vector2, Vector3};
use plumbline_engine::eyes::work::gray;
use plumbline_model::files::{self, Size};
use plumbline_model::robot::{Posture, Rig, ScreenFrame};
use plumbline_model::session::Touchscreen;
use plumbline_model::{Eye, JobContext};
use serde::{Deserialize, Serialize};

use super::edges::{STEP_PX, profile};
use super::error::CommissionError;
use super::lab::Lab;
use super::robot::{Robot, Sight};

/// Turns of the head from home from which it is looked at, rad.
const LOOKS_RAD: [f64; 3] = [0.0, 0.2, -0.2];
/// Places along each edge.
const SAMPLES: usize = 48;
/// Edges are looked for this far from where they should be, in the first round and in the others, px.
const WINDOW_PX: [f64; 2] = [10.0, 5.0];
/// The edge is where it gets brighter than this share of the way from frame to table.
const SHARE: f64 = 0.4;
/// Scale of the robust loss, px: the table is speckled.
const ROBUST_PX: f64 = 0.7;
const ROUNDS: usize = 10;
/// Fewer edges that were found tell nothing.
const FEWEST: usize = 120;
/// Neighboring samples see the same speckle: so many of them count as one.
const ALIKE: f64 = 4.0;
/// Pose (turn, then shift) and the width's scale less 1.
const UNKNOWNS: usize = 7;
/// What the outline cannot know better than this: the frame's width, the picture of an edge; m and rad.
const LEAST_SD: [f64; 2] = [0.001, 0.0025];

/// What was seen, in the lab's folder.
const FILE: &str = "seen-screen.json";

/// The screen as the eyes see it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct SeenScreen {
    /// Middle of its image and its axes (u, v, into the glass) by the eyes, their neck's zeros taken for
    /// right.
    pub robot_from_screen: Isometry3<f64>,
    /// Covariance of shift and turn of its middle, robot axes, m and rad.
    pub covariance: Matrix6<f64>,
    /// Rms of the edges that count, px.
    pub rms_px: f64,
    /// Edges that were found.
    pub edges: usize,
}

/// A picture and where its eyes were.
struct Picture {
    image: GrayImage,
    eye: Eye,
    left_from_robot: Isometry3<f64>,
}

/// Looks at the screen from some head poses and fits its outline. `rig` has its eyes where they sit;
/// `start` is about where the screen lies. `None` when the rig does not describe its frame, or its edges are
/// not seen.
pub(super) fn see(
    lab: &Lab,
    robot: &mut Robot,
    rig: &Rig,
    start: &Touchscreen,
    context: &dyn JobContext,
) -> Result<Option<SeenScreen>, CommissionError> {
    let Some(frame) = &rig.outlines.screen_frame else { return Ok(None) };
    let mut pictures = vec![];
    for turn_rad in LOOKS_RAD {
        context.checkpoint()?;
        let home = lab.rig.home();
        robot.go(&home.with(&[rig.eyes.pan], &[home[rig.eyes.pan] + turn_rad]));
        let Sight { left, right, posture } = robot.look()?;
        let left_from_robot = left_from_robot(rig, &posture);
        pictures.push(Picture { image: gray(&left), eye: Eye::Left, left_from_robot });
        pictures.push(Picture { image: gray(&right), eye: Eye::Right, left_from_robot });
    }
    robot.go(&lab.rig.home());
    Ok(fit(rig, frame, start, &pictures))
}

impl SeenScreen {
    /// Keeps it for the steps that follow.
    pub fn write(&self, lab: &Lab) -> Result<(), CommissionError> {
        let file = lab.folder.join(FILE);
        let text = serde_json::to_string(self)
            .map_err(|error| CommissionError::Steps { file: file.clone(), reason: error.to_string() })?;
        Ok(files::write(&file, text)?)
    }

    /// What was kept; `None` when the screen was not seen.
    pub fn read(lab: &Lab) -> Result<Option<Self>, CommissionError> {
        let file = lab.folder.join(FILE);
        if !files::present(&file)? {
            return Ok(None);
        }
        let text = files::read_text(&file, Size::SHORT)?;
        let seen = serde_json::from_str(&text)
            .map_err(|error| CommissionError::Steps { file, reason: error.to_string() })?;
        Ok(Some(seen))
    }
}

fn left_from_robot(rig: &Rig, posture: &Posture) -> Isometry3<f64> {
    rig.robot_from_left(posture).isometry.inverse()
}

/// Points on the three edges that are looked at and a direction out of the frame, screen axes from the
/// middle of the image, m.
/// Nobody looks at the far one: the table ends there.
fn outline(screen: &Touchscreen, frame: &ScreenFrame, scale: f64) -> Vec<(Vector3<f64>, Vector3<f64>)> {
    let (half_u, half_v) = (0.5 * screen.width_m * scale, 0.5 * screen.height_m);
    let share = |k: usize| 2.0 * (k as f64 + 0.5) / SAMPLES as f64 - 1.0;
    let (side, near, below) = (half_u + frame.side_m, half_v + frame.near_m, frame.below_m);
    let mut points = vec![];
    for k in 0..SAMPLES {
        let along = 0.88 * share(k) * half_v;
        points.push((Vector3::new(-side, along, below), -Vector3::x()));
        points.push((Vector3::new(side, along, below), Vector3::x()));
        points.push((Vector3::new(0.95 * share(k) * half_u, near, below), Vector3::y()));
    }
    points
}

/// Places the outline's axes: u, v, into the glass.
pub(super) fn pose(screen: &Touchscreen) -> Isometry3<f64> {
    let (u, v) = (screen.u_axis.vector(), screen.v_axis.vector());
    let into = -screen.normal().vector();
    let turn = nalgebra::Matrix3::from_columns(&[u, into.cross(&u), into]);
    let rotation = UnitQuaternion::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(turn));
    debug_assert!((into.cross(&u) - v).norm() < 0.05);
    Isometry3::from_parts(screen.point_at(screen.middle()).coords.coords.into(), rotation)
}

fn fit(rig: &Rig, frame: &ScreenFrame, start: &Touchscreen, pictures: &[Picture]) -> Option<SeenScreen> {
    let (mut at, mut scale) = (pose(start), 1.0);
    let mut last = None;
    for round in 0..ROUNDS {
        let window_px = WINDOW_PX[usize::from(round > 2)];
        let (mut normal, mut right) = (DMatrix::<f64>::zeros(UNKNOWNS, UNKNOWNS), DVector::zeros(UNKNOWNS));
        let (mut squares, mut weights, mut edges) = (0.0, 0.0, 0);
        for picture in pictures {
            for (k, (point, out)) in outline(start, frame, scale).into_iter().enumerate() {
                let Some((pixel, toward)) = on_image(rig, picture, &at, &point, &out) else { continue };
                let Some(off_px) = edge(&picture.image, &pixel, &toward, window_px) else { continue };
                let slope = DVector::from_fn(UNKNOWNS, |i, _| {
                    let (moved, wider) = changed(&at, scale, i, 1e-4);
                    let point = outline(start, frame, wider)[k].0;
                    on_image(rig, picture, &moved, &point, &out)
                        .map_or(0.0, |(there, _)| (there - pixel).dot(&toward) / 1e-4)
                });
                let weight = 1.0 / (1.0 + (off_px / ROBUST_PX).powi(2));
                normal += &slope * slope.transpose() * weight;
                right += &slope * (off_px * weight);
                squares += weight * off_px * off_px;
                weights += weight;
                edges += 1;
            }
        }
        if edges < FEWEST {
            return None;
        }
        // The width is that of the data sheet, to a few percent.
        normal[(6, 6)] += (0.02f64).powi(-2);
        right[6] -= (scale - 1.0) * (0.02f64).powi(-2);
        let factor = normal.clone().cholesky()?;
        let change = factor.solve(&right);
        for i in 0..UNKNOWNS {
            (at, scale) = changed(&at, scale, i, change[i]);
        }
        let rms_px = (squares / weights.max(1e-9)).sqrt();
        last = Some((factor.inverse() * (rms_px * rms_px * ALIKE), rms_px, edges));
    }
    let (covariance, rms_px, edges) = last?;
    // Turn then shift here, shift then turn there.
    let mut own = Matrix6::from_fn(|r, c| covariance[((r + 3) % 6, (c + 3) % 6)]);
    for k in 0..6 {
        own[(k, k)] += LEAST_SD[k / 3].powi(2);
    }
    Some(SeenScreen { robot_from_screen: at, covariance: own, rms_px, edges })
}

/// One of the unknowns changed: turns and shifts about the middle, robot axes.
fn changed(at: &Isometry3<f64>, scale: f64, unknown: usize, by: f64) -> (Isometry3<f64>, f64) {
    let mut moved = *at;
    match unknown {
        0..3 => {
            moved.rotation = UnitQuaternion::from_scaled_axis(Vector3::ith(unknown, by)) * at.rotation;
        }
        3..6 => moved.translation.vector += Vector3::ith(unknown - 3, by),
        _ => return (moved, scale + by),
    }
    (moved, scale)
}

/// Where a point of the outline is seen, and the direction across its edge out of the frame (unit), px.
fn on_image(
    rig: &Rig,
    picture: &Picture,
    robot_from_screen: &Isometry3<f64>,
    point: &Vector3<f64>,
    out: &Vector3<f64>,
) -> Option<(Vector2<f64>, Vector2<f64>)> {
    let cameras = &rig.eyes.cameras;
    let seen = |point: Vector3<f64>| -> Option<Vector2<f64>> {
        let in_left = picture.left_from_robot * robot_from_screen * Point3::from(point);
        let in_eye = match picture.eye {
            Eye::Left => in_left,
            Eye::Right => cameras.right_from_left.isometry * in_left,
        };
        Some(cameras.camera(picture.eye).project(&in_eye.coords).ok()?.vector())
    };
    let pixel = seen(*point)?;
    // Across the edge as the image has it, which is not where the direction out is seen.
    let along = seen(point + out.cross(&Vector3::z()) * 0.005)? - pixel;
    let across = Vector2::new(-along.y, along.x).try_normalize(1e-6)?;
    let outward = seen(point + out * 0.005)? - pixel;
    Some((pixel, across * across.dot(&outward).signum()))
}

/// Where the dark frame ends along a line through `pixel` toward the table: distance from `pixel`, px.
fn edge(image: &GrayImage, pixel: &Vector2<f64>, toward: &Vector2<f64>, window_px: f64) -> Option<f64> {
    let profile = profile(image, pixel, toward, window_px, &[-0.8, 0.0, 0.8])?;
    let at = |step: usize| step as f64 * STEP_PX - window_px;
    let (darkest, dark) = profile.iter().copied().enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let bright = profile[darkest..].iter().copied().fold(dark, f64::max);
    if bright - dark < 50.0 {
        return None;
    }
    let level = dark + SHARE * (bright - dark);
    let crossing =
        (darkest..profile.len() - 1).find(|step| profile[*step] < level && profile[step + 1] >= level)?;
    let part = (level - profile[crossing]) / (profile[crossing + 1] - profile[crossing]);
    Some(at(crossing) + part * STEP_PX)
}
