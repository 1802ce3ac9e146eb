//! From observations to a problem with a starting point, with a reason for every pair left out.

use nalgebra::Isometry3;
use plumbline_model::{Chessboard, Eye, JobContext, ModelKind, PairObservation, RejectedPair};

use super::initial::{calibrate_one_eye, pose_of_view};
use super::problem::{Corner, Free, Problem, State, View};
use super::report::distinct_poses;
use super::stereo_start::{Agreement, SeenByBoth, Turned, agree, find_mirrored_eye, seen_by_both};
use super::{FEWEST_PAIRS, FEWEST_POSES, ROBUST_PX, SolveError};

/// Where the joint solution starts.
pub(super) struct Start {
    pub problem: Problem,
    pub state: State,
    pub rejected: Vec<RejectedPair>,
}

/// A pair with enough corners in both eyes.
struct Pair {
    name: String,
    corners: [Vec<Corner>; 2],
}

/// Fewest corners of a view that are worth having.
const FEWEST_CORNERS: usize = 6;

pub(super) fn find(
    board: &Chessboard,
    observations: &[PairObservation],
    sizes_px: [(u32, u32); 2],
    kind: ModelKind,
    dropped: &[String],
    context: &dyn JobContext,
) -> Result<Start, SolveError> {
    let mut rejected = Vec::new();
    let pairs = usable_pairs(board, observations, dropped, &mut rejected)?;
    if pairs.len() < FEWEST_PAIRS {
        return Err(SolveError::TooFewPairs { found: pairs.len() });
    }
    let mut eyes = Vec::new();
    for eye in Eye::BOTH {
        context.checkpoint()?;
        context.report(0.1 * eye.index() as f64, &format!("{eye} eye by itself"));
        let views: Vec<Vec<Corner>> = pairs.iter().map(|p| p.corners[eye.index()].clone()).collect();
        let start =
            calibrate_one_eye(kind, sizes_px[eye.index()], &views).ok_or(SolveError::EyeFailed(eye))?;
        let poses: Vec<Isometry3<f64>> = start.poses.iter().flatten().copied().collect();
        let distinct = distinct_poses(&poses);
        if distinct < FEWEST_POSES {
            return Err(SolveError::AllViewsAlike { distinct });
        }
        eyes.push(start);
    }
    context.checkpoint()?;

    // Views whose pose cannot be had from one of the eyes are put aside with a reason.
    let mut kept = Vec::new();
    let mut seen: Vec<SeenByBoth> = Vec::new();
    for (i, pair) in pairs.into_iter().enumerate() {
        match (eyes[0].poses[i], eyes[1].poses[i]) {
            (Some(left), Some(right)) => {
                seen.push(seen_by_both(board, left, right));
                kept.push(pair);
            }
            _ => rejected.push(RejectedPair {
                name: pair.name,
                reason:
                    "its corners do not determine where the board was: show the board larger or less oblique"
                        .into(),
            }),
        }
    }
    let agreement = check_agreement(kind, board, sizes_px, &kept, &seen)?;
    let models = [eyes[0].model, eyes[1].model];
    Ok(assemble(board, kind, models, kept, &seen, &agreement, rejected))
}

/// Pairs that both eyes saw, the others with the reason why not.
fn usable_pairs(
    board: &Chessboard,
    observations: &[PairObservation],
    dropped: &[String],
    rejected: &mut Vec<RejectedPair>,
) -> Result<Vec<Pair>, SolveError> {
    let mut pairs = Vec::new();
    for observation in observations {
        let mut reject = |reason: &str| {
            rejected.push(RejectedPair { name: observation.name.clone(), reason: reason.to_owned() });
        };
        if dropped.contains(&observation.name) {
            reject("dropped by the operator");
            continue;
        }
        let left = corners_of(board, observation, Eye::Left)?;
        let right = corners_of(board, observation, Eye::Right)?;
        match (left.len() >= FEWEST_CORNERS, right.len() >= FEWEST_CORNERS) {
            (true, true) => pairs.push(Pair { name: observation.name.clone(), corners: [left, right] }),
            (true, false) => reject("the right eye does not see the whole board"),
            (false, true) => reject("the left eye does not see the whole board"),
            (false, false) => reject("neither eye sees the whole board"),
        }
    }
    Ok(pairs)
}

/// Measured corners of one eye as residuals' raw material.
pub(super) fn corners_of(
    board: &Chessboard,
    observation: &PairObservation,
    eye: Eye,
) -> Result<Vec<Corner>, SolveError> {
    let Some(corners) = observation.corners(eye) else { return Ok(Vec::new()) };
    if corners.len() != board.corner_count() {
        return Err(SolveError::WrongCornerCount {
            name: observation.name.clone(),
            eye,
            found: corners.len(),
            expected: board.corner_count(),
        });
    }
    let measured = corners.iter().enumerate().filter_map(|(index, pixel)| Some((index, (*pixel)?)));
    Ok(measured
        .map(|(index, pixel)| Corner {
            eye,
            index,
            point_in_board: board.corner(index).coords.coords,
            measured_px: pixel.vector(),
            left_out: false,
        })
        .collect())
}

/// The relative pose, or which mistake explains that there is none.
fn check_agreement(
    kind: ModelKind,
    board: &Chessboard,
    sizes_px: [(u32, u32); 2],
    pairs: &[Pair],
    seen: &[SeenByBoth],
) -> Result<Agreement, SolveError> {
    let agreement = agree(seen).ok_or(SolveError::TooFewPairs { found: seen.len() })?;
    let agreeing = agreement.pairs.iter().flatten().count();
    if agreeing < FEWEST_PAIRS || agreeing * 2 < seen.len() {
        let corners: Vec<[Vec<Corner>; 2]> = pairs.iter().map(|p| p.corners.clone()).collect();
        return Err(match find_mirrored_eye(kind, board, sizes_px, &corners) {
            Some(eye) => SolveError::Mirrored(eye),
            None => SolveError::EyesDisagree { agreeing, pairs: seen.len() },
        });
    }
    // The right eye sits to the right: points move left when seen from it.
    if agreement.right_from_left.translation.vector.x > 0.0 {
        return Err(SolveError::EyesSwapped);
    }
    Ok(agreement)
}

fn assemble(
    board: &Chessboard,
    kind: ModelKind,
    models: [plumbline_model::CameraModel; 2],
    pairs: Vec<Pair>,
    seen: &[SeenByBoth],
    agreement: &Agreement,
    mut rejected: Vec<RejectedPair>,
) -> Start {
    let mut views = Vec::new();
    let mut left_from_board = Vec::new();
    for ((pair, seen), agrees) in pairs.into_iter().zip(seen).zip(&agreement.pairs) {
        let [mut corners, mut right] = pair.corners;
        match agrees {
            Some(Turned::No) => {}
            Some(Turned::Yes) => turn_corners(board, &mut right),
            None => {
                rejected.push(RejectedPair {
                    name: pair.name,
                    reason: "the two eyes saw the board in different places: were both images taken at the same moment?".into(),
                });
                continue;
            }
        }
        corners.extend(right);
        let pose = pose_of_view(
            &models[0],
            &corners.iter().filter(|c| c.eye == Eye::Left).copied().collect::<Vec<_>>(),
        );
        left_from_board.push(pose.unwrap_or(seen.left_from_board));
        views.push(View { name: pair.name, corners });
    }
    Start {
        problem: Problem {
            kind,
            views,
            free: Free { intrinsics: [true, true], right_from_left: true },
            robust_px: Some(ROBUST_PX),
        },
        state: State { models, right_from_left: agreement.right_from_left, left_from_board },
        rejected,
    }
}

/// Counts the corners from the other end of the board.
fn turn_corners(board: &Chessboard, corners: &mut [Corner]) {
    for corner in corners {
        corner.index = board.corner_count() - 1 - corner.index;
        corner.point_in_board = board.corner(corner.index).coords.coords;
    }
}
