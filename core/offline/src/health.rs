//! `plumbline health`: whether the calibration of the eyes still holds, from ordinary pairs.

use std::path::{Path, PathBuf};
use std::time::Instant;

use image::GrayImage;
use plumbline_engine::ground::text::sentence;
use plumbline_model::session::StereoImagePair;
use plumbline_model::{JobContext, Session, StereoCameras};
use plumbline_recording::{Jpeg, Recording};
use plumbline_vision::calibration_file;
use plumbline_vision::health::{Better, Match, TableRows, Turn, better, find_matches, judge};
use serde::Serialize;

use super::OfflineError;
use super::locate::read_image;
use super::pairs::check_sizes;
use super::session;

/// Pairs that are looked at, spread over the session.
const PAIRS: usize = 8;
/// Whose health.
#[derive(Clone, Debug)]
pub struct HealthArgs {
    /// Session with ordinary pairs under `stereo/`, or in its recording `log.mcap`.
    pub session: PathBuf,
    /// The calibration in use; `None`: the `cameras.yaml` of the session, or the `rig-cameras.yaml` of a
    /// recording.
    pub cameras: Option<PathBuf>,
    /// One that might take its place.
    pub proposed: Option<PathBuf>,
}

/// How the eyes do.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HealthReport {
    /// The calibration in use.
    pub in_use: CalibrationHealth,
    /// The proposed one; null when none was given.
    pub proposed: Option<CalibrationHealth>,
    /// `in_use`, `proposed` or `undecided`: which fits the images better, beyond doubt.
    pub better: &'static str,
    /// How long it took.
    pub seconds: f64,
    /// Pairs that were looked at.
    pub pairs: usize,
    /// Places that both eyes saw.
    pub matches: usize,
    /// One sentence for a person.
    pub sentence: String,
    /// What was noticed about the files.
    pub notes: Vec<String>,
}

/// How one calibration does.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CalibrationHealth {
    /// The file.
    pub file: PathBuf,
    /// Whether it is still good: nowhere on the table off by more than a grasp bears, as far as can be told.
    pub ok: bool,
    /// Error at the near end of the table.
    pub near_mm: f64,
    /// In its middle.
    pub middle_mm: f64,
    /// At its far end.
    pub far_mm: f64,
    /// One standard deviation of the error at the far end.
    pub far_sigma_mm: f64,
    /// How far the right eye has turned against the left one since.
    pub turn_deg: f64,
    /// About which axes: nod, pan, roll of the right eye.
    pub turn_axes_deg: [f64; 3],
    /// One standard deviation of each.
    pub turn_sigma_deg: [f64; 3],
    /// How far places leave the epipolar planes, rms.
    pub epipolar_px: f64,
}

/// Looks at ordinary pairs with one or two calibrations.
pub fn health(args: &HealthArgs, context: &dyn JobContext) -> Result<HealthReport, OfflineError> {
    let began = Instant::now();
    let (session, rig) = session::open(&args.session)?;
    let mut pairs = Pairs::of(&session)?;
    let wanted = spread(pairs.count());
    if wanted.is_empty() {
        return Err(OfflineError::NoPairs(args.session.clone()));
    }
    let in_use = args.cameras.clone().unwrap_or_else(|| of_session(&args.session));
    let cameras = calibration_file::load(std::slice::from_ref(&in_use))?.cameras;
    let proposed = match &args.proposed {
        Some(file) => Some((file.clone(), calibration_file::load(std::slice::from_ref(file))?.cameras)),
        None => None,
    };
    let mut notes = vec![];
    let mut images: Vec<(GrayImage, GrayImage)> = vec![];
    for index in &wanted {
        context.checkpoint()?;
        context.report(0.3 * images.len() as f64 / wanted.len() as f64, "reading images");
        images.push(pairs.read(*index, &mut notes)?);
        let (left, right) = images.last().map_or(((0, 0), (0, 0)), |(l, r)| (l.dimensions(), r.dimensions()));
        for cameras in std::iter::once(&cameras).chain(proposed.iter().map(|(_, cameras)| cameras)) {
            check_sizes(cameras, [left, right])?;
        }
    }
    context.report(0.3, "matching the eyes");
    let (matches, _) = find_matches(&cameras, &images)?;
    context.checkpoint()?;
    context.report(0.9, "judging");
    let table = TableRows::of(&rig, &cameras);
    let (in_use_health, turn) = judged(&in_use, &cameras, &matches, &table)?;
    let mut better_one = "undecided";
    let proposed_health = match &proposed {
        None => None,
        Some((file, other)) => {
            let (judged, other_turn) = judged(file, other, &matches, &table)?;
            better_one = match better((&cameras, &turn), (other, &other_turn), &matches)? {
                Better::InUse => "in_use",
                Better::Proposed => "proposed",
                Better::Undecided => "undecided",
            };
            Some(judged)
        }
    };
    let said = words(&in_use_health, proposed_health.as_ref(), better_one);
    Ok(HealthReport {
        in_use: in_use_health,
        proposed: proposed_health,
        better: better_one,
        seconds: began.elapsed().as_secs_f64(),
        pairs: wanted.len(),
        matches: matches.len(),
        sentence: said,
        notes: notes.iter().map(|note: &String| sentence(note)).collect(),
    })
}

/// The calibration that lies in a session: beside images, else what was in use when it was recorded.
fn of_session(session: &Path) -> PathBuf {
    let [beside_images, recorded] = ["cameras.yaml", "rig-cameras.yaml"].map(|name| session.join(name));
    if !beside_images.is_file() && recorded.is_file() { recorded } else { beside_images }
}

/// Numbers of pairs that are spread evenly over so many.
fn spread(pairs: usize) -> Vec<usize> {
    let count = pairs.min(PAIRS);
    (0..count).map(|k| k * pairs / count).collect()
}

/// Ordinary pairs of a session: images under `stereo/`, else those of its recording.
enum Pairs<'a> {
    Files(&'a [StereoImagePair]),
    Log(PathBuf, Box<Recording>),
}

impl<'a> Pairs<'a> {
    fn of(session: &'a Session) -> Result<Self, OfflineError> {
        Ok(match &session.log {
            Some(log) if session.stereo.pairs.is_empty() => {
                Self::Log(log.clone(), Box::new(Recording::open(log)?))
            }
            _ => Self::Files(&session.stereo.pairs),
        })
    }

    fn count(&self) -> usize {
        match self {
            Self::Files(pairs) => pairs.len(),
            Self::Log(_, recording) => recording.pair_count(),
        }
    }

    fn read(
        &mut self,
        index: usize,
        notes: &mut Vec<String>,
    ) -> Result<(GrayImage, GrayImage), OfflineError> {
        match self {
            Self::Files(pairs) => {
                let mut gray = |file: &Path| -> Result<GrayImage, OfflineError> {
                    Ok(image::imageops::grayscale(&read_image(file, notes)?))
                };
                Ok((gray(&pairs[index].left)?, gray(&pairs[index].right)?))
            }
            Self::Log(log, recording) => {
                let [left, right] = recording.pair(index)?.images;
                let gray = |Jpeg(bytes): &Jpeg| match image::load_from_memory(bytes) {
                    Ok(image) => Ok(image.to_luma8()),
                    Err(error) => Err(OfflineError::RecordedImage {
                        log: log.clone(),
                        pair: index + 1,
                        reason: error.to_string(),
                    }),
                };
                Ok((gray(&left)?, gray(&right)?))
            }
        }
    }
}

/// How a calibration does, and how its right eye has turned.
fn judged(
    file: &Path,
    cameras: &StereoCameras,
    matches: &[Match],
    table: &TableRows,
) -> Result<(CalibrationHealth, Turn), OfflineError> {
    let Some(judged) = judge(cameras, matches, table)? else {
        return Err(OfflineError::TableNotSeen(file.to_path_buf()));
    };
    let turn = judged.turn;
    let [near_mm, middle_mm, far_mm] = judged.costs.map(|cost| cost.error_m * 1e3);
    let degrees = |axis: usize| turn.covariance_rad2[(axis, axis)].max(0.0).sqrt().to_degrees();
    let health = CalibrationHealth {
        file: file.to_path_buf(),
        ok: judged.is_good(),
        near_mm,
        middle_mm,
        far_mm,
        far_sigma_mm: judged.costs[2].sigma_m * 1e3,
        turn_deg: turn.angle_rad().to_degrees(),
        turn_axes_deg: turn.rotation_rad.map(f64::to_degrees).into(),
        turn_sigma_deg: [0, 1, 2].map(degrees),
        epipolar_px: judged.epipolar_px,
    };
    Ok((health, turn))
}

fn words(in_use: &CalibrationHealth, proposed: Option<&CalibrationHealth>, better: &str) -> String {
    let first = if in_use.ok {
        format!(
            "The calibration in use is still good: {:.0} mm off at the far end of the table.",
            in_use.far_mm
        )
    } else {
        format!(
            "The calibration in use is not good any more: the right eye has turned by {:.2}°, places are {:.0} mm off at \
             the near end of the table, {:.0} in its middle, {:.0} at its far end. Calibrate the eyes again.",
            in_use.turn_deg, in_use.near_mm, in_use.middle_mm, in_use.far_mm
        )
    };
    match (proposed, better) {
        (None, _) => first,
        (Some(_), "proposed") => format!("{first} The proposed one fits these images better."),
        (Some(_), "in_use") => format!("{first} The proposed one fits these images worse: do not accept it."),
        (Some(_), _) => format!("{first} The proposed one cannot be told apart from it on these images."),
    }
}
