//! From views as they were taken to a problem that can be solved, with every refusal in words.

use nalgebra::{Isometry3, Point3, Vector3};
use plumbline_model::robot::{Chain, Rig};
use plumbline_model::{Eye, RejectedPair, StereoCameras};

use super::error::MountError;
use super::inputs::{check_cameras, check_options, check_view, neck, seen_of, target_points};
use super::problem::{ANYTHING, Priors, Problem, State, View};
use super::start;
use super::types::{HeadView, MountOptions, Target};

/// Fewest views of a board at an unknown place.
pub(super) const FEWEST_OF_UNKNOWN: usize = 4;
/// Points of an eye from which the pose of a board is taken.
const FEWEST_CORNERS: usize = 8;
/// First guess of a pixel's standard deviation, px; the residuals replace it.
const PIXEL_PX: f64 = 0.15;
/// Numbers in options below this are taken for exact (m or rad).
const EXACT: f64 = 1e-7;

/// A problem and where it starts.
pub(super) struct Prepared {
    pub problem: Problem,
    pub state: State,
    /// Per view, the target by this view alone, where it could be had.
    pub own_fit: Vec<Option<OwnFit>>,
    pub rejected: Vec<RejectedPair>,
}

/// The target as one view alone sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct OwnFit {
    pub left_from_target: Isometry3<f64>,
    /// Rms residual per point.
    pub rms_px: f64,
}

/// Reads views into a problem.
pub(super) fn prepare(
    rig: &Rig,
    cameras: &StereoCameras,
    views: &[HeadView],
    target: &Target,
    options: &MountOptions,
) -> Result<Prepared, MountError> {
    check_options(options)?;
    check_cameras(cameras)?;
    let neck = neck(rig)?;
    let (points, target_pose) = target_points(target)?;
    let tip = match target {
        Target::Fingertip { tip } => Some(
            rig.chain(tip)
                .map_err(|error| MountError::Rig { rig: rig.name.clone(), what: error.to_string() })?,
        ),
        _ => None,
    };
    let mut rejected = vec![];
    let mut usable = vec![];
    for view in views {
        check_view(rig, view, points.len())?;
        let seen = seen_of(view);
        let needed = if matches!(target, Target::UnknownBoard(_)) { FEWEST_CORNERS } else { 1 };
        let most = Eye::BOTH.map(|eye| seen.iter().filter(|s| s.eye == eye).count()).into_iter().max();
        if most.unwrap_or(0) < needed {
            let reason = if seen.is_empty() {
                "neither eye sees the target"
            } else {
                "too little of the board is seen"
            };
            rejected.push(RejectedPair { name: view.name.clone(), reason: reason.to_owned() });
            continue;
        }
        let tip = tip.as_ref().map_or_else(Vector3::zeros, |tip| tip_place(tip, view));
        usable.push(View {
            name: view.name.clone(),
            encoder_rad: neck.encoder_rad(&view.posture),
            seen,
            tip,
        });
    }
    if usable.is_empty() {
        return Err(MountError::NotSeen { views: views.len() });
    }
    let exact = options.known_place_sd_m < EXACT && options.known_turn_sd_rad < EXACT;
    let known = (options.known_turn_sd_rad.max(EXACT), options.known_place_sd_m.max(EXACT));
    let (free_target, target_sd) = match target {
        Target::UnknownBoard(_) => (true, (ANYTHING, ANYTHING)),
        Target::KnownPoints(_) => (!exact, known),
        Target::Fingertip { .. } => (false, known),
    };
    let nominal = rig.eyes.head_from_left.isometry;
    let problem = Problem {
        cameras: *cameras,
        neck,
        points,
        free_target,
        expected: (nominal, target_pose),
        priors: Priors {
            pixel_px: PIXEL_PX,
            angle_rad: [options.angle_sd_rad(); 2],
            zero_rad: options.head_zero_sd_rad,
            target: target_sd,
            tip_m: tip.is_some().then_some(options.tip_sd_m),
        },
        views: usable,
        robust_px: Some(options.robust_px),
        unknown_angles: None,
    };
    match target {
        Target::UnknownBoard(_) => start_from_board(problem, rejected, views.len()),
        _ => Ok(start_from_known(problem, rejected)),
    }
}

fn tip_place(tip: &Chain, view: &HeadView) -> Vector3<f64> {
    tip.robot_from_tip_in(&view.posture).translation_m()
}

/// The start with a board at an unknown place: closed forms and the nominal mount compete.
fn start_from_board(
    mut problem: Problem,
    mut rejected: Vec<RejectedPair>,
    offered: usize,
) -> Result<Prepared, MountError> {
    let fits: Vec<_> = problem
        .views
        .iter()
        .map(|view| start::left_from_target(&problem.cameras, &problem.points, &view.seen))
        .collect();
    let typical_px =
        crate::calibrate::median(fits.iter().flatten().map(|(_, rms)| *rms).collect()).unwrap_or(0.0);
    let limit_px = (4.0 * typical_px).max(1.0);
    let mut kept = vec![];
    let mut left_from_target = vec![];
    let mut rms = vec![];
    for (view, fit) in std::mem::take(&mut problem.views).into_iter().zip(fits) {
        match fit {
            Some((pose, rms_px)) if rms_px <= limit_px => {
                kept.push(view);
                left_from_target.push(pose);
                rms.push(rms_px);
            }
            Some((_, rms_px)) => rejected.push(RejectedPair {
                name: view.name,
                reason: format!(
                    "its corners miss those of a flat board by {rms_px:.1} px where other views have {typical_px:.2} px: the images of the two eyes are not of the same moment, or a part of the board was mistaken"
                ),
            }),
            None => rejected.push(RejectedPair {
                name: view.name,
                reason: "its corners do not show where the board is".to_owned(),
            }),
        }
    }
    problem.views = kept;
    if problem.views.len() < FEWEST_OF_UNKNOWN {
        let rejected = sentences(&rejected);
        return Err(match problem.views.len() {
            0 => MountError::NotSeen { views: offered },
            found => MountError::TooFewViews { found, needed: FEWEST_OF_UNKNOWN, rejected },
        });
    }
    let heads: Vec<Isometry3<f64>> = problem.views.iter().map(|v| head_of(&problem, v)).collect();
    same_end_first(&mut problem, &heads, &mut left_from_target);

    let count = problem.views.len();
    let pick =
        |from: &[Isometry3<f64>], subset: &[usize]| subset.iter().map(|&i| from[i]).collect::<Vec<_>>();
    let closed = start::subsets(count)
        .into_iter()
        .filter_map(|subset| start::hand_eye(&pick(&heads, &subset), &pick(&left_from_target, &subset)));
    let center = Point3::from(problem.points.iter().sum::<Vector3<f64>>() / problem.points.len() as f64);
    let best = std::iter::once(problem.expected.0)
        .chain(closed)
        .filter_map(|mount| {
            let (place, cost) = start::shared_place(&mount, &heads, &left_from_target, &center)?;
            Some((mount, place, cost))
        })
        .min_by(|a, b| a.2.total_cmp(&b.2));
    let Some((mount, place, _)) = best else { return Err(MountError::Undetermined) };
    problem.expected.1 = place;
    Ok(Prepared {
        state: State::new(mount, place, count),
        own_fit: left_from_target
            .into_iter()
            .zip(rms)
            .map(|(left_from_target, rms_px)| Some(OwnFit { left_from_target, rms_px }))
            .collect(),
        problem,
        rejected,
    })
}

fn head_of(problem: &Problem, view: &View) -> Isometry3<f64> {
    problem.neck.chain.robot_from_tip(&view.encoder_rad).isometry
}

/// Boards that look the same upside down may be counted from the other end in some views: counts
/// them all from the end of the first.
fn same_end_first(problem: &mut Problem, heads: &[Isometry3<f64>], left_from_target: &mut [Isometry3<f64>]) {
    let last = problem.points.len() - 1;
    let end = problem.points[last];
    let turned = Isometry3::from_parts(
        end.into(),
        nalgebra::UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI),
    );
    let nominal = problem.expected.0;
    let mut first: Option<Isometry3<f64>> = None;
    for ((head, view), board) in heads.iter().zip(&mut problem.views).zip(left_from_target) {
        let here = head * nominal * *board;
        let there = here * turned;
        let first = *first.get_or_insert(here);
        if first.rotation.angle_to(&there.rotation) + 1.0 < first.rotation.angle_to(&here.rotation) {
            *board *= turned;
            for seen in &mut view.seen {
                seen.index = last - seen.index;
            }
        }
    }
}

/// The start with points whose places are known: triangulated ones give the mount directly.
fn start_from_known(problem: Problem, rejected: Vec<RejectedPair>) -> Prepared {
    let mut pairs = vec![];
    for view in &problem.views {
        let head_from_robot = head_of(&problem, view).inverse();
        for left in view.seen.iter().filter(|s| s.eye == Eye::Left) {
            let right = view.seen.iter().find(|s| s.eye == Eye::Right && s.index == left.index);
            let meeting = right.and_then(|right| {
                problem.cameras.triangulate(left.measured_px.into(), right.measured_px.into())
            });
            let Some(in_left) = meeting else { continue };
            let in_robot = match problem.priors.tip_m {
                Some(_) => Point3::from(view.tip),
                None => problem.expected.1 * Point3::from(problem.points[left.index]),
            };
            pairs.push((in_left.coords, (head_from_robot * in_robot).coords));
        }
    }
    let poses_show = problem.priors.tip_m.is_none() && is_flat(&problem.points);
    let own_fit = problem
        .views
        .iter()
        .map(|view| {
            let fit = start::left_from_target(&problem.cameras, &problem.points, &view.seen);
            let fit = fit.filter(|_| poses_show && view.seen.len() >= FEWEST_CORNERS);
            fit.map(|(left_from_target, rms_px)| OwnFit { left_from_target, rms_px })
        })
        .collect();
    let count = problem.views.len();
    let starts = [Some(problem.expected.0), start::absolute(&pairs)];
    let states = starts.into_iter().flatten().map(|mount| State::new(mount, problem.expected.1, count));
    let costed = states.map(|state| (problem.cost(&state), state));
    let state = costed
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map_or_else(|| State::new(problem.expected.0, problem.expected.1, count), |(_, state)| state);
    Prepared { state, own_fit, problem, rejected }
}

/// Whether points lie in the plane z = 0, as poses from rays assume.
fn is_flat(points: &[Vector3<f64>]) -> bool {
    points.iter().all(|p| p.z.abs() < 1e-6)
}

pub(super) fn sentences(rejected: &[RejectedPair]) -> Vec<String> {
    rejected.iter().map(|r| format!("view \"{}\": {}", r.name, r.reason)).collect()
}
