//! What takes time: planning, writing each touch to disk, reading and writing the place of the screen.

use std::path::PathBuf;
use std::sync::Arc;

use jiff::Timestamp;
use nalgebra::Vector3;
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::touch_plan::{Finger, TouchArea};
use plumbline_model::touchscreen::ScreenPlacement;
use plumbline_model::{JobContext, counted};

use super::choice::{self, NoChoice};
use super::command::Correction;
use super::placement::{self, Proposal};
use super::plan::{self, Aim, PlanRequest, RunPlan};
use super::record::{Progress, TouchRecord};
use super::refusal::{NotRestored, RunError, Unplaced};
use super::store::{self, Runs, Stored};
use crate::ground;
use crate::ground::LongWork;
use crate::ground::jobs::JobError;
use crate::ground::shelf::{InUse, Shelf};
use crate::motion::{NoWay, Planner, ScreenPlace, TouchPace};
use crate::rig_models::{made_at, screen_in, screens_in};
use crate::robot::{RobotControl, TouchOrder, WithdrawOrder};

/// Work of this workflow.
#[derive(Clone, Debug)]
pub enum TouchWork {
    /// Reads what was accepted before, and which runs were not finished.
    Restore {
        /// Where the world's files are.
        folder: PathBuf,
        /// The robot that they must be of.
        rig: Arc<Rig>,
    },
    /// Plans touches and looks which can be reached.
    Plan(PlanRequest),
    /// Makes the folder of a new session.
    Begin {
        /// Where sessions are kept.
        sessions: PathBuf,
        /// The robot, its screen where it is taken to lie without a block.
        rig: Arc<Rig>,
        /// What will be done.
        plan: Arc<RunPlan>,
        /// When it was asked for.
        started: Timestamp,
    },
    /// Reads a run that was begun earlier.
    Open {
        /// Its folder.
        session: PathBuf,
        /// The robot that it must be of.
        rig: Arc<Rig>,
    },
    /// Writes what happened in a run.
    Write {
        /// Its folder.
        session: PathBuf,
        /// Joints of its chain.
        joints: Vec<String>,
        /// What happened.
        progress: Arc<Progress>,
        /// Counts changes of it.
        revision: u64,
    },
    /// Looks for the way to the next target.
    Route(RouteRequest),
    /// Looks for the way from the screen to the arm's home.
    Away(AwayRequest),
    /// Measures where the screen lies, from touches.
    Place {
        /// The run that they are of.
        session: PathBuf,
        /// The robot, its screen where it nominally lies.
        rig: Arc<Rig>,
        /// What touched.
        finger: Finger,
        /// Joints of the run's chain.
        joints: Vec<String>,
        /// Touches that count.
        touches: Vec<TouchRecord>,
    },
    /// Makes a measured place of the screen the one in use.
    Accept {
        /// Where it is kept.
        kept: InUse,
        /// Where it stays when another one takes its place.
        shelf: Shelf,
        /// The place.
        placement: Arc<ScreenPlacement>,
    },
    /// Puts a place that was in use earlier in use again.
    UseEarlier {
        /// Its name on the shelf.
        id: String,
        /// The shelf.
        shelf: Shelf,
        /// Where the one in use is kept.
        kept: InUse,
        /// The robot that it must be of.
        rig: Arc<Rig>,
    },
    /// Keeps what targets are corrected with.
    KeepChoice {
        /// Where.
        kept: InUse,
        /// What was chosen.
        correct_with: Option<Correction>,
    },
    /// Removes the file, so that the nominal place is used again.
    Forget {
        /// Which.
        kept: InUse,
    },
}

/// The way to a target.
#[derive(Clone, Debug)]
pub struct RouteRequest {
    /// The robot, its screen where it lies, on its block.
    pub rig: Arc<Rig>,
    /// Whether that place of the screen was measured.
    pub place: ScreenPlace,
    /// Made for that place of the screen before; `None`: to be made.
    pub planner: Option<Arc<Planner>>,
    /// What touches.
    pub finger: Finger,
    /// The target.
    pub aim: Box<Aim>,
    /// How much deeper than usual the finger may go, m.
    pub deeper_m: f64,
    /// Where the arm stands.
    pub from: Posture,
    /// Counts orders.
    pub order: u64,
    /// How fast.
    pub pace: TouchPace,
}

/// The way from the screen.
#[derive(Clone, Debug)]
pub struct AwayRequest {
    /// The robot, its screen where it lies, on its block.
    pub rig: Arc<Rig>,
    /// Whether that place of the screen was measured.
    pub place: ScreenPlace,
    /// What touches.
    pub finger: Finger,
    /// Number of the touch that waits for it; `None`: all are done.
    pub number: Option<usize>,
    /// What the touch before was sent beside its place; robot axes, m.
    pub beside_m: Vector3<f64>,
    /// Where the arm stands.
    pub from: Posture,
    /// Counts orders.
    pub order: u64,
    /// Peak joint speed, rad/s.
    pub speed_rad_s: f64,
}

/// What came out.
#[derive(Clone, Debug)]
pub enum TouchResult {
    /// What was accepted before.
    Restored {
        /// The place of the screen in use, or why it cannot be used; `None`: nominal.
        placement: Option<Result<Arc<ScreenPlacement>, Arc<NotRestored>>>,
        /// Runs of earlier starts.
        runs: Runs,
        /// The part of the screen that the finger reaches.
        reach: [Option<TouchArea>; 2],
        /// What targets were corrected with last, or why that is not known; `None`: never chosen.
        choice: Result<Option<Option<Correction>>, Arc<NoChoice>>,
    },
    /// A plan, of a screen that lies where this rig has it.
    Planned(Arc<RunPlan>, Arc<Rig>),
    /// It was cancelled, mostly because the next plan is wanted already: not worth a message.
    NotPlanned,
    /// A new session.
    Begun {
        /// Its folder.
        session: PathBuf,
        /// The run as it stands there.
        stored: Box<Stored>,
    },
    /// A run of earlier.
    Opened {
        /// Its folder.
        session: PathBuf,
        /// The run.
        stored: Box<Stored>,
    },
    /// What happened is on disk, or why it is not.
    Written {
        /// Up to this change.
        revision: u64,
        /// Why not.
        problem: Option<String>,
    },
    /// The way to a target, or why there is none.
    Routed {
        /// Number of the planned touch.
        number: usize,
        /// For the next target.
        planner: Option<Arc<Planner>>,
        /// The order.
        order: Result<Box<TouchOrder>, NoWay>,
    },
    /// The way from the screen, or why there is none.
    WayHome(Result<Box<WithdrawOrder>, NoWay>),
    /// A measured place of the screen, or why the touches do not tell.
    Placed(Result<Proposal, Arc<Unplaced>>),
    /// It is in use from now on.
    Saved(Arc<ScreenPlacement>),
    /// The nominal place is in use.
    Forgotten,
    /// What was chosen is kept.
    ChoiceKept,
}

/// What the handlers of this room may reach besides their own workflow.
pub type Context<'a> = ground::Context<'a, TouchWork, RobotControl>;

impl LongWork for TouchWork {
    type Result = TouchResult;

    fn title(&self) -> String {
        match self {
            Self::Restore { .. } => "Read the place of the screen".to_owned(),
            Self::Plan(_) => "Plan touches".to_owned(),
            Self::Begin { .. } => "Begin a session".to_owned(),
            Self::Open { .. } => "Open the run".to_owned(),
            Self::Write { .. } => "Write the touches".to_owned(),
            Self::Route(request) => format!("Look for the way to target {}", request.aim.touch.number),
            Self::Away(_) => "Look for the way from the screen".to_owned(),
            Self::Place { touches, .. } => {
                format!("Place the screen from {}", counted(touches.len(), "touch"))
            }
            Self::Accept { .. } => "Use this place of the screen".to_owned(),
            Self::UseEarlier { .. } => "Go back to an earlier place of the screen".to_owned(),
            Self::KeepChoice { .. } => "Keep what targets are corrected with".to_owned(),
            Self::Forget { .. } => "Go back to the described place of the screen".to_owned(),
        }
    }

    fn is_quiet(&self) -> bool {
        matches!(
            self,
            Self::Restore { .. }
                | Self::Plan(_)
                | Self::Begin { .. }
                | Self::Open { .. }
                | Self::Write { .. }
                | Self::Route(_)
                | Self::Away(_)
                | Self::Place { .. }
                | Self::KeepChoice { .. }
        )
    }

    fn run(self, context: &dyn JobContext) -> Result<TouchResult, JobError> {
        match self {
            Self::Restore { folder, rig } => Ok(restore(&folder, &rig)),
            Self::Plan(request) => match plan::make(&request, context) {
                Ok(plan) => Ok(TouchResult::Planned(Arc::new(plan), request.rig)),
                Err(JobError::Cancelled(_)) => Ok(TouchResult::NotPlanned),
                Err(error) => Err(error),
            },
            Self::Begin { sessions, rig, plan, started } => {
                begin(&sessions, &rig, &plan, started).map_err(JobError::failed)
            }
            Self::Open { session, rig } => {
                let stored = open(&session, &rig).map_err(JobError::failed)?;
                Ok(TouchResult::Opened { session, stored: Box::new(stored) })
            }
            Self::Write { session, joints, progress, revision } => {
                let problem = store::write(&session, &joints, &progress).err().map(|error| error.to_string());
                Ok(TouchResult::Written { revision, problem })
            }
            Self::Route(request) => Ok(route(request)),
            Self::Away(request) => Ok(TouchResult::WayHome(away(request))),
            Self::Place { session, rig, finger, joints, touches } => {
                let placed = placement::place(&rig, finger, &joints, &touches);
                let proposal = |placement| Proposal { placement: Arc::new(placement), session };
                Ok(TouchResult::Placed(placed.map(proposal).map_err(Arc::new)))
            }
            Self::Accept { kept, shelf, placement } => {
                keep(&shelf, &placement)?;
                kept.put(JobError::told, |file| placement.write(file).map_err(JobError::told))?;
                Ok(TouchResult::Saved(placement))
            }
            Self::UseEarlier { id, shelf, kept, rig } => {
                let file = shelf.file_inside(&id).filter(|file| file.is_file());
                let file = file.ok_or_else(|| {
                    JobError::failed(
                        "This place of the screen is not kept any more. Touch its corners again.",
                    )
                })?;
                let placement = ScreenPlacement::read(&file, &rig.name).map_err(JobError::told)?;
                kept.put(JobError::told, |file| placement.write(file).map_err(JobError::told))?;
                Ok(TouchResult::Saved(Arc::new(placement)))
            }
            Self::KeepChoice { kept, correct_with } => {
                choice::write(&kept, correct_with).map_err(JobError::told)?;
                Ok(TouchResult::ChoiceKept)
            }
            Self::Forget { kept } => {
                kept.forget().map_err(|error| JobError::not_removed(kept.file(), &error))?;
                Ok(TouchResult::Forgotten)
            }
        }
    }
}

fn restore(folder: &std::path::Path, rig: &Rig) -> TouchResult {
    let kept = screen_in(folder)
        .read(|file| ScreenPlacement::read(file, &rig.name).map_err(NotRestored::from))
        .transpose();
    if let Some(Ok(placement)) = &kept
        && let Err(reason) = keep(&screens_in(folder), placement)
    {
        log::warn!("the place of the screen in use is not kept for later: {reason}");
    }
    let placement = kept.map(|placement| placement.map(Arc::new).map_err(Arc::new));
    // A rig without this finger cannot touch anyway; planning says so.
    let reach = Finger::BOTH.map(|finger| TouchArea::reached_by(rig, finger.tip()).ok().flatten());
    let choice = choice::read(&choice::choice_in(folder)).map_err(Arc::new);
    TouchResult::Restored { placement, runs: store::list(&folder.join("sessions")), reach, choice }
}

/// Writes a place of the screen to its shelf, unless it stands there.
fn keep(shelf: &Shelf, placement: &ScreenPlacement) -> Result<(), JobError> {
    let file = shelf.file(&made_at(placement.at));
    if file.is_file() {
        return Ok(());
    }
    shelf.make_folder().map_err(JobError::failed)?;
    placement.write(&file).map_err(JobError::told)
}

fn begin(
    sessions: &std::path::Path,
    rig: &Rig,
    plan: &Arc<RunPlan>,
    started: Timestamp,
) -> Result<TouchResult, RunError> {
    let chain = rig.chain(plan.options.finger.tip())?;
    let joints = chain.names().to_vec();
    let manifest = store::manifest(&rig.name, &rig.touchscreen, &joints, plan, started);
    let progress = Progress::new(plan.options.purpose, started, plan.reachable());
    let session = store::begin(sessions, &manifest, plan, &progress)?;
    let stored = Stored { plan: (**plan).clone(), progress, screen: rig.touchscreen.clone(), joints };
    Ok(TouchResult::Begun { session, stored: Box::new(stored) })
}

fn open(session: &std::path::Path, rig: &Rig) -> Result<Stored, RunError> {
    let stored = store::read(session)?;
    let chain = rig.chain(stored.plan.options.finger.tip())?;
    if stored.joints != chain.names() {
        return Err(RunError::OtherArm);
    }
    Ok(stored)
}

fn route(request: RouteRequest) -> TouchResult {
    let number = request.aim.touch.number;
    let planner = match &request.planner {
        Some(planner) => planner.clone(),
        None => match Planner::new(&request.rig, request.finger.tip(), request.place) {
            Ok(planner) => Arc::new(planner),
            Err(reason) => return TouchResult::Routed { number, planner: None, order: Err(reason) },
        },
    };
    let RouteRequest { aim, from, order, pace, rig, deeper_m, .. } = request;
    // Where it cannot go so deep, it goes as deep as always.
    let deeper = planner.plan(&aim.wanted().deeper(deeper_m), &from);
    let path = deeper.or_else(|why| match deeper_m > 0.0 {
        true => planner.plan(&aim.wanted(), &from),
        false => Err(why),
    });
    let along = |path| TouchOrder::along(path, planner.chain(), &rig.touchscreen, &pace, number, order);
    let order = path.map(|path| Box::new(along(path)));
    TouchResult::Routed { number, planner: Some(planner), order }
}

fn away(request: AwayRequest) -> Result<Box<WithdrawOrder>, NoWay> {
    let AwayRequest { rig, place, finger, number, beside_m, from, order, speed_rad_s } = request;
    let planner = Planner::new(&rig, finger.tip(), place)?;
    let way = planner.away(&from, beside_m)?;
    let tip = planner.chain().tip().to_owned();
    Ok(Box::new(WithdrawOrder { number, order, tip, way, beside_m, speed_rad_s }))
}

impl TouchResult {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Restored { .. } => "The place of the screen was read.".to_owned(),
            Self::Planned(plan, _) => {
                format!("{} of {} targets can be touched.", plan.reachable(), plan.touches.len())
            }
            Self::NotPlanned => "The plan was cancelled.".to_owned(),
            Self::Begun { .. } => "The session has begun.".to_owned(),
            Self::Opened { .. } => "The run is open.".to_owned(),
            Self::Written { .. } => "The touches are on disk.".to_owned(),
            Self::Routed { .. } => "The way to the next target was looked for.".to_owned(),
            Self::WayHome(_) => "The way from the screen was looked for.".to_owned(),
            Self::Placed(_) => "The place of the screen was measured.".to_owned(),
            Self::Saved(_) => "The measured place of the screen is in use.".to_owned(),
            Self::Forgotten => "The described place of the screen is in use.".to_owned(),
            Self::ChoiceKept => "What corrects targets is kept.".to_owned(),
        }
    }
}
