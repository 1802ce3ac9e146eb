//! Where the eyes see the touchscreen: the outline of its frame, fitted to the edges in both images. It
//! is what the arm's frame and the eyes' frame have in common.
//!
//! The head never stands quite where its encoders say. Seen from several head poses, a tenth of a degree of
//! that would pass for a screen that is smaller and nearer; so where each pose really was is an unknown, too.

use image::GrayImage;
use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix6, Point3, Translation3, UnitQuaternion, Vector2, Vector3,
};
use plumbline_fit::pose;
use plumbline_grasp::Body;
use plumbline_model::robot::{Rig, ScreenFrame};
use plumbline_model::session::Touchscreen;
use plumbline_model::{Eye, JobContext};
use serde::{Deserialize, Serialize};

use crate::HandEyeError;
use crate::edges::{STEP_PX, profile};
use crate::picture::{Picture, from_head_poses};

/// Turns of the head from home from which it is looked at, rad.
const LOOKS_RAD: [f64; 3] = [0.0, 0.2, -0.2];
/// Places along each edge.
const SAMPLES: usize = 48;
/// Edges are looked for this far from where they should be, in the first round and in the others, px.
const WINDOW_PX: [f64; 2] = [10.0, 5.0];
/// The outline is looked for from so far beside where the screen was placed, and where the rig has it, too, along its
/// width and its height, m: an arm that errs places it by centimeters beside, and other edges lie near.
const BESIDE_M: [f64; 3] = [0.0, -0.03, 0.03];
/// Outlines whose middles are farther apart are different ones, m.
const APART_M: f64 = 0.008;
/// Or those that are turned by more, rad.
const APART_RAD: f64 = 0.05;
/// An outline somewhere else that as many edges fit, nearly, leaves open which of them is the screen's: from this share
/// on.
const RIVAL: f64 = 0.85;
/// What is farther from both the placed and the described screen is something else, m and rad.
const FARTHEST: [f64; 2] = [0.06, 0.14];
/// The edge is where it gets brighter than this share of the way from frame to table.
const SHARE: f64 = 0.4;
/// Scale of the robust loss, px: the table is speckled.
const ROBUST_PX: f64 = 0.7;
const ROUNDS: usize = 10;
/// Fewer edges that were found tell nothing.
const FEWEST: usize = 120;
/// Nor do fewer than this share of those that the images should show: of an outline that is half covered the rest is
/// drawn to whatever covers it, by millimeters and degrees.
const LEAST_SHARE: f64 = 0.75;
/// Neighboring samples see the same speckle: so many of them count as one.
const ALIKE: f64 = 4.0;
/// Pose (turn, then shift) and the width's scale less 1; two angles of every head pose come after them.
const OF_SCREEN: usize = 7;
/// The width's scale among them.
const SCALE: usize = 6;
/// The width is that of the data sheet to within this share.
const SCALE_SD: f64 = 0.02;
/// What the outline cannot know better than this: the frame's width, the picture of an edge; m and rad.
const LEAST_SD: [f64; 2] = [0.001, 0.0025];

/// The screen as the eyes see it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeenScreen {
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

/// What the edges are compared with.
struct Scene<'a> {
    rig: &'a Rig,
    frame: &'a ScreenFrame,
    screen: &'a Touchscreen,
}

/// What is looked for.
#[derive(Clone)]
struct Guess {
    robot_from_screen: Isometry3<f64>,
    /// Of the width, as a share of the data sheet's.
    scale: f64,
    /// Turn and tilt of the head beyond its encoders, per head pose, rad.
    heads: Vec<[f64; 2]>,
}

impl Guess {
    fn unknowns(&self) -> usize {
        OF_SCREEN + 2 * self.heads.len()
    }

    /// One of the unknowns changed: turns and shifts are about the middle, robot axes.
    fn changed(&self, unknown: usize, by: f64) -> Self {
        let mut new = self.clone();
        let at = &mut new.robot_from_screen;
        match unknown {
            0..3 => at.rotation = UnitQuaternion::from_scaled_axis(Vector3::ith(unknown, by)) * at.rotation,
            3..6 => at.translation.vector += Vector3::ith(unknown - 3, by),
            SCALE => new.scale += by,
            _ => {
                let of_heads = unknown - OF_SCREEN;
                new.heads[of_heads / 2][of_heads % 2] += by;
            }
        }
        new
    }
}

/// Looks at the screen from some head poses and fits its outline. `rig` has its eyes where they sit, and
/// `rest_sd_rad` says how well its head comes to rest (turn, nod); `start` is about where the screen lies.
/// `None` when the rig does not describe its frame, its edges are not seen or too few of them, or they fit in two places
/// about as well. Only the head moves.
///
/// # Errors
/// When the robot does not carry it out, or it is cancelled.
pub fn see(
    body: &mut dyn Body,
    rig: &Rig,
    rest_sd_rad: [f64; 2],
    start: &Touchscreen,
    looks: &mut dyn FnMut(usize),
    context: &dyn JobContext,
) -> Result<Option<SeenScreen>, HandEyeError> {
    see_beside(body, rig, rest_sd_rad, (start, &BESIDE_M), looks, context)
}

/// The same, looked for this far beside `start`.
pub(crate) fn see_beside(
    body: &mut dyn Body,
    rig: &Rig,
    rest_sd_rad: [f64; 2],
    (start, beside_m): (&Touchscreen, &[f64]),
    looks: &mut dyn FnMut(usize),
    context: &dyn JobContext,
) -> Result<Option<SeenScreen>, HandEyeError> {
    let Some(frame) = &rig.outlines.screen_frame else { return Ok(None) };
    let home = rig.home();
    let poses = LOOKS_RAD.map(|turn_rad| [home[rig.eyes.pan] + turn_rad, home[rig.eyes.tilt]]);
    let pictures = from_head_poses(body, &poses, looks, context)?;
    Ok(fit(&Scene { rig, frame, screen: start }, rest_sd_rad, beside_m, &pictures))
}

impl SeenScreen {
    /// Head poses from which it is looked at.
    pub const LOOKS: usize = LOOKS_RAD.len();

    /// Where it is, and how well that is known.
    pub fn by_eyes(&self) -> plumbline_fit::SeenScreen {
        let Self { robot_from_screen, covariance, .. } = self;
        plumbline_fit::SeenScreen { robot_from_screen: *robot_from_screen, covariance: *covariance }
    }
}

/// Points on the three edges that are looked at and a direction out of the frame, screen axes from the
/// middle of the image, m.
/// Nobody looks at the far one: the table ends there.
fn outline(scene: &Scene<'_>, scale: f64) -> Vec<(Vector3<f64>, Vector3<f64>)> {
    let (screen, frame) = (scene.screen, scene.frame);
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

/// Fits all unknowns to the edges, from every start: the one in which most edges lie where they should is taken,
/// unless nearly as many do in another one. The head comes to rest to within `rest_sd_rad` (turn, tilt) of where its
/// encoders have it.
fn fit(
    scene: &Scene<'_>,
    rest_sd_rad: [f64; 2],
    beside_m: &[f64],
    pictures: &[Picture],
) -> Option<SeenScreen> {
    let starts = starts(scene, beside_m).into_iter();
    let mut fits: Vec<(SeenScreen, f64)> =
        starts.filter_map(|start| fit_from(scene, start, rest_sd_rad, pictures)).collect();
    fits.retain(|(seen, _)| is_plausible(scene, seen));
    fits.sort_by(|a, b| b.1.total_cmp(&a.1));
    let (best, fitting) = fits.first()?;
    let middle = |seen: &SeenScreen| seen.robot_from_screen.translation.vector;
    let turned_rad =
        |seen: &SeenScreen| seen.robot_from_screen.rotation.angle_to(&best.robot_from_screen.rotation);
    let elsewhere = fits
        .iter()
        .find(|(other, _)| (middle(other) - middle(best)).norm() > APART_M || turned_rad(other) > APART_RAD);
    let rival = elsewhere.filter(|(_, others)| *others > RIVAL * fitting);
    rival.is_none().then(|| best.clone())
}

/// Whether it lies about where the screen was placed, or is described to lie.
fn is_plausible(scene: &Scene<'_>, seen: &SeenScreen) -> bool {
    [scene.screen, &scene.rig.touchscreen].into_iter().any(|screen| {
        let at = pose(screen);
        let off_m = (at.translation.vector - seen.robot_from_screen.translation.vector).norm();
        off_m <= FARTHEST[0] && at.rotation.angle_to(&seen.robot_from_screen.rotation) <= FARTHEST[1]
    })
}

/// Where the outline is looked for.
fn starts(scene: &Scene<'_>, beside_m: &[f64]) -> Vec<Isometry3<f64>> {
    let mut starts = vec![];
    for screen in [scene.screen, &scene.rig.touchscreen] {
        for u_m in beside_m {
            starts.extend(beside_m.iter().map(|v_m| pose(screen) * Translation3::new(*u_m, *v_m, 0.0)));
        }
    }
    starts
}

/// The same from one start, and how many edges lie where they should.
fn fit_from(
    scene: &Scene<'_>,
    start: Isometry3<f64>,
    rest_sd_rad: [f64; 2],
    pictures: &[Picture],
) -> Option<(SeenScreen, f64)> {
    let heads = pictures.iter().map(|picture| picture.head + 1).max()?;
    let mut guess = Guess { robot_from_screen: start, scale: 1.0, heads: vec![[0.0; 2]; heads] };
    let mut last = None;
    for round in 0..ROUNDS {
        let window_px = WINDOW_PX[usize::from(round > 2)];
        let mut sums = Sums::new(guess.unknowns());
        for picture in pictures {
            sums.add(scene, picture, &guess, window_px);
        }
        let least = LEAST_SHARE * sums.looked_for as f64;
        if sums.edges < FEWEST || round + 1 == ROUNDS && (sums.edges as f64) < least {
            return None;
        }
        // The edges say themselves how good they are: what is known before is in units of that.
        let rms_px = sums.rms_px();
        let edge_sd_px = rms_px * ALIKE.sqrt();
        sums.expect(SCALE, guess.scale - 1.0, SCALE_SD / edge_sd_px);
        for (k, angle_rad) in guess.heads.iter().flatten().enumerate() {
            sums.expect(OF_SCREEN + k, *angle_rad, rest_sd_rad[k % 2] / edge_sd_px);
        }
        let factor = sums.normal.cholesky()?;
        let change = factor.solve(&sums.right);
        guess = (0..guess.unknowns()).fold(guess, |guess, i| guess.changed(i, change[i]));
        last = Some((factor.inverse() * edge_sd_px.powi(2), rms_px, sums.edges, sums.weights));
    }
    let (covariance, rms_px, edges, fitting) = last?;
    // Turn then shift here, shift then turn there.
    let mut own = Matrix6::from_fn(|r, c| covariance[((r + 3) % 6, (c + 3) % 6)]);
    for k in 0..6 {
        own[(k, k)] += LEAST_SD[k / 3].powi(2);
    }
    Some((SeenScreen { robot_from_screen: guess.robot_from_screen, covariance: own, rms_px, edges }, fitting))
}

/// The normal equations of the unknowns.
struct Sums {
    normal: DMatrix<f64>,
    right: DVector<f64>,
    squares_px2: f64,
    weights: f64,
    edges: usize,
    /// Edges that the images should show.
    looked_for: usize,
}

impl Sums {
    fn new(unknowns: usize) -> Self {
        let (normal, right) = (DMatrix::zeros(unknowns, unknowns), DVector::zeros(unknowns));
        Self { normal, right, squares_px2: 0.0, weights: 0.0, edges: 0, looked_for: 0 }
    }

    /// The edges of one image.
    fn add(&mut self, scene: &Scene<'_>, picture: &Picture, guess: &Guess, window_px: f64) {
        const STEP: f64 = 1e-4;
        let count = guess.unknowns();
        let moved: Vec<Guess> = (0..count).map(|i| guess.changed(i, STEP)).collect();
        let lines: Vec<_> = moved.iter().map(|moved| outline(scene, moved.scale)).collect();
        let eyes: Vec<_> = moved.iter().map(|moved| left_from_robot(scene, picture, moved)).collect();
        let left = left_from_robot(scene, picture, guess);
        for (k, (point, out)) in outline(scene, guess.scale).into_iter().enumerate() {
            let Some((pixel, toward)) =
                on_image(scene, picture.eye, &(left * guess.robot_from_screen), &point, &out)
            else {
                continue;
            };
            self.looked_for += usize::from(is_inside(&picture.image, &pixel, window_px));
            let Some(off_px) = edge(&picture.image, &pixel, &toward, window_px) else { continue };
            let slope = DVector::from_fn(count, |i, _| {
                let left_from_screen = eyes[i] * moved[i].robot_from_screen;
                on_image(scene, picture.eye, &left_from_screen, &lines[i][k].0, &out)
                    .map_or(0.0, |(there, _)| (there - pixel).dot(&toward) / STEP)
            });
            let weight = 1.0 / (1.0 + (off_px / ROBUST_PX).powi(2));
            self.normal += &slope * slope.transpose() * weight;
            self.right += slope * (off_px * weight);
            self.squares_px2 += weight * off_px * off_px;
            self.weights += weight;
            self.edges += 1;
        }
    }

    /// An unknown that stands at `value` is 0 to within `sd`.
    fn expect(&mut self, unknown: usize, value: f64, sd: f64) {
        self.normal[(unknown, unknown)] += sd.powi(-2);
        self.right[unknown] -= value * sd.powi(-2);
    }

    fn rms_px(&self) -> f64 {
        (self.squares_px2 / self.weights.max(1e-9)).sqrt()
    }
}

/// Where the left eye is, the head where it is taken to be.
fn left_from_robot(scene: &Scene<'_>, picture: &Picture, guess: &Guess) -> Isometry3<f64> {
    let head = [scene.rig.eyes.pan, scene.rig.eyes.tilt];
    let [turn_rad, tilt_rad] = guess.heads[picture.head];
    let stands = [picture.posture[head[0]] + turn_rad, picture.posture[head[1]] + tilt_rad];
    scene.rig.robot_from_left(&picture.posture.with(&head, &stands)).isometry.inverse()
}

/// Whether an image holds a pixel with all that is looked at around it.
fn is_inside(image: &GrayImage, pixel: &Vector2<f64>, margin_px: f64) -> bool {
    let (width, height) = (f64::from(image.width()), f64::from(image.height()));
    let within = |at_px: f64, size_px: f64| at_px > margin_px && at_px < size_px - margin_px;
    within(pixel.x, width) && within(pixel.y, height)
}

/// Where a point of the outline is seen, and the direction across its edge out of the frame (unit), px.
fn on_image(
    scene: &Scene<'_>,
    eye: Eye,
    left_from_screen: &Isometry3<f64>,
    point: &Vector3<f64>,
    out: &Vector3<f64>,
) -> Option<(Vector2<f64>, Vector2<f64>)> {
    let cameras = &scene.rig.eyes.cameras;
    let seen = |point: Vector3<f64>| -> Option<Vector2<f64>> {
        let in_left = left_from_screen * Point3::from(point);
        let in_eye = match eye {
            Eye::Left => in_left,
            Eye::Right => cameras.right_from_left.isometry * in_left,
        };
        Some(cameras.camera(eye).project(&in_eye.coords).ok()?.vector())
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
