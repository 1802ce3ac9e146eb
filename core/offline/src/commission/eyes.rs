//! Step eyes: a person holds the board to the eyes, then lays it down and the head looks at it from
//! all sides; all pairs together calibrate the eyes, those from the table also their mount.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use plumbline_engine::eyes::work::{Keep, gray};
use plumbline_model::files::{self, Size};
use plumbline_model::robot::Posture;
use plumbline_model::{
    Board, CalibrationOptions, Chessboard, Eye, JobContext, PairObservation, Pose, Robot as RobotFrame,
    Stamp, StereoCameras, StereoFrame,
};
use plumbline_twin::{default_board, few_board_presets};
use plumbline_vision::calibrate::solve;
use plumbline_vision::chessboard::find_in_pair;
use plumbline_vision::mount::{HeadView, PlannedTarget, plan_head_views};

use super::error::CommissionError;
use super::lab::{EYES_SESSION, Lab};
use super::robot::Robot;
use super::steps::Step;

/// Head poses from which the lying board is looked at.
const TOUR: usize = 8;
/// Their names begin so.
const ON_TABLE: &str = "table ";
/// Lenses move as they warm up: the eyes are calibrated when they have been on for so long, s. Twenty
/// minutes are three time constants of a housing that takes up heat in seven.
const WARM_S: f64 = 20.0 * 60.0;
/// Middle of the lying board, robot frame, m. It lies on a book: its height is not measured.
const LIES_AT_M: [f64; 3] = [0.36, 0.0, 0.10];
/// Postures of the views from the table, beside the session.
const POSTURES: &str = "postures.json";

/// Looks at the board, solves, and puts the calibration in use.
pub(super) fn run(lab: &Lab, robot: &mut Robot, context: &dyn JobContext) -> Result<Step, CommissionError> {
    let mut step = Step::new("eyes", "lengths on boards that were not solved with, rms");
    let wait_s = WARM_S - robot.on_s();
    if wait_s > 0.0 {
        step.notes.push(format!("Waited {:.1} min until the eyes were warm.", wait_s / 60.0));
        robot.pass(wait_s);
    }
    let board = default_board();
    let mut album = Album { lab, board, seen: vec![], postures: BTreeMap::new(), sizes_px: [(0, 0); 2] };
    let held = few_board_presets(&lab.rig);
    for (k, place) in held.iter().enumerate() {
        context.checkpoint()?;
        context.report(0.5 * k as f64 / held.len() as f64, "looking at the board in a person's hands");
        robot.hold_board(Some(*place));
        album.take(robot, format!("held {:02}", k + 1))?;
    }
    let lying = lying_board(&board, LIES_AT_M);
    robot.hold_board(Some(lying));
    let target = PlannedTarget::board(&board, &lying);
    let cameras = &lab.rig.eyes.cameras;
    let poses = plan_head_views(&lab.rig, cameras, &lab.rig.home(), &target, TOUR)?;
    for (k, (pan_rad, tilt_rad)) in poses.iter().enumerate() {
        context.checkpoint()?;
        context.report(0.5 + 0.2 * k as f64 / TOUR as f64, "looking at the board on the table");
        let head = [lab.rig.eyes.pan, lab.rig.eyes.tilt];
        robot.go(&lab.rig.home().with(&head, &[*pan_rad, *tilt_rad]));
        album.take(robot, format!("{ON_TABLE}{:02}", k + 1))?;
    }
    robot.go(&lab.rig.home());
    robot.hold_board(None);
    album.keep_postures()?;
    step.board_views = album.seen.len();
    step.notes.extend(album.missed());

    context.report(0.7, "solving the eyes");
    let options = CalibrationOptions::default();
    let all = &album.seen;
    // What an unseen pair would show: every third pair is held back once.
    let (used, back): (Vec<_>, Vec<_>) = all.iter().cloned().enumerate().partition(|(i, _)| i % 3 != 2);
    let plain = |pairs: Vec<(usize, PairObservation)>| -> Vec<PairObservation> {
        pairs.into_iter().map(|(_, pair)| pair).collect()
    };
    let (used, back) = (plain(used), plain(back));
    let without_folds = CalibrationOptions { cross_validation_folds: 0, ..options.clone() };
    let tried = solve(&board, &used, album.sizes_px, &without_folds, &[], context)?;
    step.before_mm = length_error_mm(cameras, &board, &back);
    step.after_mm = length_error_mm(&tried.cameras, &board, &back);
    let mut calibration = solve(&board, all, album.sizes_px, &options, &[], context)?;
    if let Some(evidence) = &mut calibration.evidence {
        evidence.minutes_since_on = Some(robot.on_s() / 60.0);
        evidence.source = "commissioning".to_owned();
    }
    if let Some(summary) = &calibration.summary {
        step.notes.push(format!("{} pairs, {:.3} px.", calibration.per_pair.len(), summary.rms_stereo_px));
    }
    lab.eyes_store().accept(&calibration, jiff::Timestamp::now()).map_err(CommissionError::room)?;
    Ok(step)
}

/// The views of the lying board that the calibration in use was made from.
pub(super) fn table_views(lab: &Lab) -> Result<Vec<HeadView>, CommissionError> {
    let file = postures_file(lab);
    let text = files::read_text(&file, Size::SHORT)?;
    let postures: BTreeMap<String, Vec<f64>> = serde_json::from_str(&text)
        .map_err(|error| CommissionError::Steps { file, reason: error.to_string() })?;
    let gone =
        || CommissionError::Gone { what: "what the eyes' calibration was made from", folder: lab.world() };
    let evidence = lab.calibration()?.evidence.ok_or_else(gone)?;
    let view = |pair: PairObservation| {
        let posture = Posture::new(postures.get(&pair.name)?.clone());
        (pair.name.starts_with(ON_TABLE)).then(|| HeadView::new(pair, posture))
    };
    Ok(evidence.observations.into_iter().filter_map(view).collect())
}

/// Pairs as they are taken.
struct Album<'a> {
    lab: &'a Lab,
    board: Chessboard,
    seen: Vec<PairObservation>,
    postures: BTreeMap<String, Vec<f64>>,
    sizes_px: [(u32, u32); 2],
}

impl Album<'_> {
    /// Looks, keeps the pair in the session, and finds the board in it.
    fn take(&mut self, robot: &mut Robot, name: String) -> Result<(), CommissionError> {
        let sight = robot.look()?;
        self.sizes_px = [sight.left.dimensions(), sight.right.dimensions()];
        let found = find_in_pair(&name, &gray(&sight.left), &gray(&sight.right), &self.board);
        self.postures.insert(name.clone(), sight.posture.angles_rad().to_vec());
        let stamp = Stamp { seq: self.seen.len() as u64, captured_at: Instant::now() };
        let frame = StereoFrame {
            stamp,
            left: sight.left,
            right: sight.right,
            time_difference_s: None,
            name: None,
            beside: Default::default(),
        };
        let folder = self.lab.sessions().join(EYES_SESSION);
        Keep { frame, name, folder, started: jiff::Timestamp::now() }.run()?;
        self.seen.push(found.observation);
        Ok(())
    }

    fn keep_postures(&self) -> Result<(), CommissionError> {
        let file = postures_file(self.lab);
        let text = serde_json::to_string(&self.postures)
            .map_err(|error| CommissionError::Steps { file: file.clone(), reason: error.to_string() })?;
        Ok(files::write(&file, text)?)
    }

    /// In which views an eye did not see the board.
    fn missed(&self) -> Option<String> {
        let half = |pair: &&PairObservation| pair.left.is_none() || pair.right.is_none();
        let names: Vec<&str> = self.seen.iter().filter(half).map(|pair| pair.name.as_str()).collect();
        (!names.is_empty()).then(|| format!("Not seen by both eyes: {}.", names.join(", ")))
    }
}

fn postures_file(lab: &Lab) -> PathBuf {
    lab.sessions().join(EYES_SESSION).join(POSTURES)
}

/// The board face up, its columns to the robot's right, its middle at a place of the robot's frame, m.
pub(super) fn lying_board(board: &Chessboard, at_m: [f64; 3]) -> Pose<RobotFrame, Board> {
    // x along the columns to the right, y along the rows toward the robot, z down into the board.
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -std::f64::consts::FRAC_PI_2)
        * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    let middle = 0.5
        * board.square_m
        * Vector3::new(f64::from(board.inner_columns - 1), f64::from(board.inner_rows - 1), 0.0);
    let at = Vector3::from(at_m) - turn * middle;
    Pose::new(Isometry3::from_parts(Translation3::from(at), turn))
}

/// Rms error of lengths between corners of the same board, along its rows and columns and from each
/// corner to the next, by triangulation; mm. `None` where no board was seen by both eyes.
pub(super) fn length_error_mm(
    cameras: &StereoCameras,
    board: &Chessboard,
    pairs: &[PairObservation],
) -> Option<f64> {
    let (columns, rows) = (board.inner_columns as usize, board.inner_rows as usize);
    let (mut squares, mut count) = (0.0, 0.0);
    for pair in pairs {
        let (Some(left), Some(right)) = (pair.corners(Eye::Left), pair.corners(Eye::Right)) else { continue };
        let points: Vec<Option<Vector3<f64>>> = left
            .iter()
            .zip(right)
            .map(|(left, right)| Some(cameras.triangulate((*left)?, (*right)?)?.coords.coords))
            .collect();
        let at = |column: usize, row: usize| points.get(row * columns + column).copied().flatten();
        let ends = (0..rows).map(|row| ((0, row), (columns - 1, row)));
        let ends = ends.chain((0..columns).map(|column| ((column, 0), (column, rows - 1))));
        for (a, b) in ends {
            let (Some(from), Some(to)) = (at(a.0, a.1), at(b.0, b.1)) else { continue };
            let steps = (b.0 - a.0).max(b.1 - a.1) as f64;
            squares += ((to - from).norm() - steps * board.square_m).powi(2);
            count += 1.0;
        }
    }
    (count > 0.0).then(|| 1e3 * f64::sqrt(squares / count))
}
