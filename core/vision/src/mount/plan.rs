//! Head poses from which to look, so that few views tell most about the mount.

use nalgebra::{DMatrix, Isometry3, Point3, Vector3};
use plumbline_model::frame::Board;
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::{Chessboard, Eye, Pixel, Point, Pose, Raw, Robot, StereoCameras};

use super::error::MountError;
use super::inputs::neck;
use super::prepare::FEWEST_OF_UNKNOWN;
use super::problem::{ANYTHING, MOUNT, Neck, Priors, Problem, Seen, State, View};
use super::types::MountOptions;

/// Step of the grid of head poses, rad.
const GRID_RAD: f64 = 0.05;
/// Distance kept from the limits of the head, rad.
const FROM_LIMIT_RAD: f64 = 0.03;
/// Poses nearer to each other than this tell the same, rad.
const APART_RAD: f64 = 0.08;
/// Farther off the optical axis corners are stretched and may be shaded by the face, rad.
const WIDEST_RAD: f64 = 1.05;
/// Distance kept from the border of the image, px: the squares around the outer corners are
/// needed to find them.
const BORDER_PX: f64 = 14.0;
/// Rounds of exchanging poses for better ones.
const EXCHANGES: usize = 3;

/// What the head is to look at.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedTarget {
    /// Where its points are, or are thought to be.
    pub points: Vec<Point<Robot>>,
    /// Whether the solver will know their place.
    pub place_known: bool,
}

impl PlannedTarget {
    /// A board whose place is known well enough to look at it, see [`super::place_of_board`].
    pub fn board(board: &Chessboard, robot_from_board: &Pose<Robot, Board>) -> Self {
        let points = board.corners().into_iter().map(|corner| *robot_from_board * corner).collect();
        Self { points, place_known: false }
    }

    /// Points whose place is known.
    pub fn known(points: Vec<Point<Robot>>) -> Self {
        Self { points, place_known: true }
    }
}

/// A head pose that shows the whole target to both eyes.
struct Candidate {
    pan_tilt_rad: [f64; 2],
    /// What it tells about mount and target.
    information: DMatrix<f64>,
}

/// Head poses (pan, tilt; rad) within the limits that show the whole target to both eyes and
/// together determine the mount best (largest determinant of its information; greedy choice, then
/// exchanges), in an order of short ways from the present posture on. `n` poses, or as many as
/// there are.
///
/// Joints other than the head's stay as in `posture`.
pub fn plan_head_views(
    rig: &Rig,
    cameras: &StereoCameras,
    posture: &Posture,
    target: &PlannedTarget,
    n: usize,
) -> Result<Vec<(f64, f64)>, MountError> {
    let neck = neck(rig)?;
    let problem = planning_problem(rig, cameras, neck, target);
    let candidates = candidates(rig, posture, &problem);
    let needed = if target.place_known { 1 } else { FEWEST_OF_UNKNOWN };
    if candidates.len() < needed {
        return Err(MountError::OutOfView { usable: candidates.len(), needed });
    }
    let chosen = choose(&candidates, n, problem.layout().total);
    let poses = chosen.into_iter().map(|i| candidates[i].pan_tilt_rad).collect();
    Ok(in_short_ways(rig, posture, poses))
}

fn planning_problem(rig: &Rig, cameras: &StereoCameras, neck: Neck, target: &PlannedTarget) -> Problem {
    Problem {
        cameras: *cameras,
        neck,
        points: target.points.iter().map(|point| point.coords.coords).collect(),
        free_target: !target.place_known,
        expected: (rig.eyes.head_from_left.isometry, Isometry3::identity()),
        views: vec![],
        priors: Priors {
            pixel_px: 0.15,
            angle_rad: [MountOptions::default().angle_sd_rad(); 2],
            zero_rad: None,
            target: (ANYTHING, ANYTHING),
            tip_m: None,
        },
        robust_px: None,
        unknown_angles: None,
    }
}

/// Every pose of the grid that shows the target.
fn candidates(rig: &Rig, posture: &Posture, problem: &Problem) -> Vec<Candidate> {
    let mut candidates = vec![];
    let mut posture = posture.clone();
    let tilts = rig.limits(rig.eyes.tilt);
    for tilt_rad in grid(tilts.lower_rad, tilts.upper_rad) {
        posture[rig.eyes.tilt] = tilt_rad;
        let pans = rig.limits_in(rig.eyes.pan, &posture);
        for pan_rad in grid(pans.lower_rad, pans.upper_rad) {
            posture[rig.eyes.pan] = pan_rad;
            if let Some(view) = seen_from(problem, &posture) {
                let information = information(problem, view);
                candidates.push(Candidate { pan_tilt_rad: [pan_rad, tilt_rad], information });
            }
        }
    }
    candidates
}

/// Multiples of the grid's step within limits.
fn grid(lower_rad: f64, upper_rad: f64) -> impl Iterator<Item = f64> {
    let (first, last) = ((lower_rad + FROM_LIMIT_RAD) / GRID_RAD, (upper_rad - FROM_LIMIT_RAD) / GRID_RAD);
    (first.ceil() as i64..=last.floor() as i64).map(|i| i as f64 * GRID_RAD)
}

/// The view that a head pose gives; `None` unless both eyes see the whole target.
fn seen_from(problem: &Problem, posture: &Posture) -> Option<View> {
    let encoder_rad = problem.neck.encoder_rad(posture);
    let head = problem.neck.chain.robot_from_tip(&encoder_rad).isometry;
    let left_from_robot = (head * problem.expected.0).inverse();
    let mut seen = Vec::with_capacity(2 * problem.points.len());
    for eye in Eye::BOTH {
        for (index, point) in problem.points.iter().enumerate() {
            let in_left = left_from_robot * Point3::from(*point);
            let in_eye = match eye {
                Eye::Left => in_left,
                Eye::Right => problem.cameras.right_from_left.isometry * in_left,
            };
            let pixel = visible(&problem.cameras, eye, &in_eye.coords)?;
            seen.push(Seen { eye, index, measured_px: pixel.vector(), left_out: false });
        }
    }
    Some(View { name: String::new(), encoder_rad, seen, tip: Vector3::zeros() })
}

fn visible(cameras: &StereoCameras, eye: Eye, in_eye: &Vector3<f64>) -> Option<Pixel<Raw>> {
    let camera = cameras.camera(eye);
    if in_eye.x.hypot(in_eye.y).atan2(in_eye.z) > WIDEST_RAD {
        return None;
    }
    let pixel = camera.project(in_eye).ok()?;
    let inside = |at: f64, size: u32| at >= BORDER_PX && at <= f64::from(size) - 1.0 - BORDER_PX;
    (inside(pixel.u_px, camera.width_px) && inside(pixel.v_px, camera.height_px)).then_some(pixel)
}

/// Information of one view about mount and target, its own angle errors eliminated.
fn information(problem: &Problem, view: View) -> DMatrix<f64> {
    let problem = Problem { views: vec![view], ..problem.clone() };
    let state = State::new(problem.expected.0, problem.expected.1, 1);
    let (matrix, _) = problem.normal_equations(&state);
    let shared = matrix.nrows() - 2;
    let kept = matrix.view((0, 0), (shared, shared)).into_owned();
    let coupling = matrix.view((0, shared), (shared, 2)).into_owned();
    match matrix.fixed_view::<2, 2>(shared, shared).try_inverse() {
        Some(inverse) => &kept - &coupling * inverse * coupling.transpose(),
        None => kept,
    }
}

/// Logarithm of the determinant of the mount's information, the target eliminated.
fn worth(total: &DMatrix<f64>) -> f64 {
    let log_determinant = |matrix: DMatrix<f64>| {
        let factor = matrix.cholesky();
        factor.map_or(f64::NEG_INFINITY, |f| f.l().diagonal().iter().map(|d| 2.0 * d.ln()).sum::<f64>())
    };
    let rest = total.nrows() - MOUNT;
    let target = total.view((MOUNT, MOUNT), (rest, rest)).into_owned();
    log_determinant(total.clone()) - if rest > 0 { log_determinant(target) } else { 0.0 }
}

fn choose(candidates: &[Candidate], n: usize, size: usize) -> Vec<usize> {
    // A trace of information about everything lets the first choices be compared.
    let mut total = DMatrix::<f64>::identity(size, size);
    let mut chosen: Vec<usize> = vec![];
    let apart = |a: usize, b: usize| {
        let ([p, t], [q, u]) = (candidates[a].pan_tilt_rad, candidates[b].pan_tilt_rad);
        (p - q).hypot(t - u) > APART_RAD
    };
    let best = |total: &DMatrix<f64>, chosen: &[usize]| {
        let free = (0..candidates.len()).filter(|&i| chosen.iter().all(|&c| apart(i, c)));
        free.map(|i| (i, worth(&(total + &candidates[i].information)))).max_by(|a, b| a.1.total_cmp(&b.1))
    };
    while chosen.len() < n {
        let Some((i, _)) = best(&total, &chosen) else { break };
        total += &candidates[i].information;
        chosen.push(i);
    }
    for _ in 0..EXCHANGES {
        for k in 0..chosen.len() {
            let old = chosen.remove(k);
            total -= &candidates[old].information;
            let (new, _) = best(&total, &chosen).unwrap_or((old, 0.0));
            total += &candidates[new].information;
            chosen.insert(k, new);
        }
    }
    chosen
}

/// Standard deviations to be expected of the mount when `target` is seen from these head poses (pan,
/// tilt; rad), with pixels to 0.15 px and no slack: turn about (rad) and place along (m) the head's x, y
/// and z. `None` if they leave a direction open or do not show the whole target.
pub fn expected_sigma(
    rig: &Rig,
    cameras: &StereoCameras,
    posture: &Posture,
    target: &PlannedTarget,
    poses: &[(f64, f64)],
) -> Option<(Vector3<f64>, Vector3<f64>)> {
    let problem = planning_problem(rig, cameras, neck(rig).ok()?, target);
    let size = problem.layout().total;
    let mut total = DMatrix::<f64>::zeros(size, size);
    for (pan_rad, tilt_rad) in poses {
        let posture = posture.with(&[rig.eyes.pan, rig.eyes.tilt], &[*pan_rad, *tilt_rad]);
        total += information(&problem, seen_from(&problem, &posture)?);
    }
    let sigma = total.cholesky()?.inverse().diagonal().map(|variance| variance.max(0.0).sqrt());
    let turn = Vector3::new(sigma[0], sigma[1], sigma[2]);
    let place = Vector3::new(sigma[3], sigma[4], sigma[5]);
    // Nothing but the trace of knowledge that keeps the sum invertible: left open.
    (turn.amax() < 0.5 && place.amax() < 0.5).then_some((turn, place))
}

/// Always the nearest next among those that the head reaches on a straight way within its limits;
/// the nearest of all if there is none.
fn in_short_ways(rig: &Rig, posture: &Posture, mut poses: Vec<[f64; 2]>) -> Vec<(f64, f64)> {
    let joints = [rig.eyes.pan, rig.eyes.tilt];
    let mut here = joints.map(|joint| posture[joint]);
    let mut ordered = Vec::with_capacity(poses.len());
    while !poses.is_empty() {
        let blocked = |pose: &[f64; 2]| !is_free_way(rig, posture, &here, pose);
        let far = |pose: &[f64; 2]| (pose[0] - here[0]).abs().max((pose[1] - here[1]).abs());
        let cost = |pose: &[f64; 2]| far(pose) + if blocked(pose) { 100.0 } else { 0.0 };
        let costs: Vec<f64> = poses.iter().map(cost).collect();
        let next = (0..costs.len()).min_by(|a, b| costs[*a].total_cmp(&costs[*b])).unwrap_or(0);
        here = poses.swap_remove(next);
        ordered.push((here[0], here[1]));
    }
    ordered
}

/// Whether the head stays within its limits when both joints turn evenly from one pose to another.
fn is_free_way(rig: &Rig, posture: &Posture, from: &[f64; 2], to: &[f64; 2]) -> bool {
    const STEPS: u32 = 20;
    let joints = [rig.eyes.pan, rig.eyes.tilt];
    (1..=STEPS).all(|step| {
        let part = f64::from(step) / f64::from(STEPS);
        let angles = [0, 1].map(|k| from[k] + part * (to[k] - from[k]));
        let there = posture.with(&joints, &angles);
        joints.into_iter().zip(angles).all(|(joint, angle)| rig.limits_in(joint, &there).contain(angle))
    })
}
