//! What was seen, what was solved, what is in use.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use plumbline_model::robot::{Posture, Rig};
use plumbline_model::{Chessboard, PairObservation, StereoCalibration, counted};
use plumbline_vision::mount::{
    HeadView, MountCalibration, MountError, PlannedTarget, Target, place_of_board, plan_head_views,
};

use super::command::MountCommand;
use super::tour::{Tour, Wish};
use super::work::{Context, MountResult, MountWork};
use crate::eyes::Look;
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::ground::shelf::{InUse, Shelf};
use crate::ground::text::sentence;
use crate::ground::warming::Warmth;
use crate::ground::{Moment, Workflow};
use crate::mount::view::MountView;
use crate::rig_models::{mount_in, mounts_in};
use crate::robot::RobotControl;
use crate::robot::view::RobotView;

/// Why something is not done, and what to do.
#[derive(Debug, thiserror::Error)]
pub(super) enum Refusal {
    /// Step 1 comes first.
    #[error("The eyes are not calibrated yet. Do step 1, Eyes, first.")]
    NotCalibrated,
    /// Nobody knows where the head looks.
    #[error("The head's angles are not known. Connect to the robot or the twin first.")]
    HeadUnknown,
    /// Nothing to take.
    #[error("Neither eye sees the board.")]
    NoBoard,
    /// Nothing to plan for.
    #[error("Neither eye sees the board. Lay it flat on the table where both eyes see all of it.")]
    NoBoardToPlan,
    /// Nothing to bring back.
    #[error("No view was deleted since a mount was accepted.")]
    NothingDeleted,
    /// Views of two boards do not go together.
    #[error("Another board was used for the views so far. Remove them first.")]
    OtherBoard,
    /// The computation itself.
    #[error("{}", sentence(&.0.to_string()))]
    Mount(#[from] MountError),
}

/// Head poses that are planned. More tell no more: on the twin the mount from 8 is as good as that from 14.
const POSES: usize = 8;

/// What the workflow can see of the rest.
pub struct MountAround {
    /// The robot as its description has it.
    pub rig: Arc<Rig>,
    /// The robot now.
    pub robot: Arc<RobotView>,
    /// The calibration of the eyes; `None` before one was accepted.
    pub calibration: Option<Arc<StereoCalibration>>,
    /// Whether it has been read which calibration of the eyes was accepted.
    pub is_eyes_known: bool,
    /// The board in use.
    pub board: Chessboard,
    /// Whether eyes are open.
    pub has_eyes: bool,
    /// Time since they were switched on, s; `None`: nobody knows.
    pub eyes_on_s: Option<f64>,
}

/// The whole workflow, of one world.
#[derive(Clone, Debug)]
pub struct MountWorkflow {
    kept: InUse,
    shelf: Shelf,
    pub(super) views: Vec<HeadView>,
    /// What was deleted since a mount was accepted, the newest last: it can be brought back.
    pub(super) deleted: Vec<Deleted>,
    /// For how long the eyes had been on when they were taken, by name, min; those of which it is known.
    taken_min: BTreeMap<String, f64>,
    pub(super) board: Option<Chessboard>,
    /// All poses of the plan, also those that were seen: without their views they are to be seen again.
    pub(super) planned: Vec<(f64, f64)>,
    /// So many of them, from the first, were seen by tours before the present one.
    pub(super) seen: usize,
    pub(super) tour: Option<Tour>,
    pub(super) proposal: Option<Arc<MountCalibration>>,
    pub(super) in_use: Option<Arc<MountCalibration>>,
    /// Whether what was accepted before has been read.
    is_known: bool,
    pub(super) solving: Option<JobId>,
    last_look: Option<Look>,
    counted: usize,
    /// What the operator asked for and needs an image that was taken after that.
    pub(super) waiting: Option<(Waiting, Instant)>,
}

/// Views that were deleted at once.
#[derive(Clone, Debug)]
pub(super) struct Deleted {
    views: Vec<HeadView>,
    pub(super) board: Option<Chessboard>,
    /// So many planned poses had been seen.
    seen: usize,
}

/// What is done with the next image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Waiting {
    /// Planning head poses.
    Plan,
    /// A view.
    Capture,
}

impl MountWorkflow {
    /// The mount in use; `None`: nominal.
    pub fn in_use(&self) -> Option<&Arc<MountCalibration>> {
        self.in_use.as_ref()
    }

    /// The mount in use; `None`: not read yet. Inside `None`: the nominal one is.
    pub fn accepted(&self) -> Option<Option<&Arc<MountCalibration>>> {
        self.is_known.then_some(self.in_use.as_ref())
    }

    /// Why the mount in use does not fit to the eyes any more, and what to do.
    pub fn stale(&self, eyes: Option<&StereoCalibration>, is_eyes_known: bool) -> Option<&'static str> {
        let mount = self.in_use.as_deref()?;
        why_stale(eyes.map(|eyes| mount.made_with(&eyes.cameras)), is_eyes_known)
    }

    /// Views that are collected.
    pub fn view_count(&self) -> usize {
        self.views.len()
    }

    /// Whether the board has to be looked for.
    pub fn wants_corners(&self) -> bool {
        self.tour.is_some() || self.waiting.is_some()
    }

    fn wait_for_image(&mut self, what: Waiting, around: &MountAround, context: &mut Context<'_>) {
        match ready(around) {
            Ok(_) if !around.has_eyes => context.refuse("No eyes are open. Choose a source of images first."),
            Ok(_) => self.waiting = Some((what, context.time.instant)),
            Err(reason) => context.refuse(reason),
        }
    }

    fn plan(&self, around: &MountAround) -> Result<Vec<(f64, f64)>, Refusal> {
        let (calibration, posture) = ready(around)?;
        let cameras = calibration.cameras;
        let view = self.last_look.as_ref().and_then(|look| head_view(look, "now".to_owned(), &posture));
        let view = view.ok_or(Refusal::NoBoardToPlan)?;
        let robot_from_board = place_of_board(&around.rig, &cameras, &view, &around.board)?;
        let target = PlannedTarget::board(&around.board, &robot_from_board);
        Ok(plan_head_views(&around.rig, &cameras, &posture, &target, POSES)?)
    }

    fn solve(&mut self, around: &MountAround, context: &mut Context<'_>) {
        if self.solving.is_some() {
            return context.refuse("The mount is being solved already.");
        }
        let eyes = match ready(around) {
            Ok((eyes, _)) => eyes,
            Err(reason) => return context.refuse(reason),
        };
        let board = self.board.unwrap_or(around.board);
        let work = MountWork::Solve {
            rig: around.rig.clone(),
            eyes,
            views: self.views.clone(),
            minutes_since_on: self.minutes_of_views(),
            target: Target::UnknownBoard(board),
        };
        self.solving = Some(context.start(work));
    }

    /// The chessboard search has looked at an image.
    pub fn look(&mut self, look: Look, around: &MountAround, context: &mut Context<'_>) {
        let captured_at = look.frame.stamp.captured_at;
        if self.tour.as_ref().is_some_and(|tour| tour.accepts(captured_at)) {
            if let Err(reason) = self.take(&look, around) {
                context.notices.add(NoticeLevel::Info, format!("One head pose was passed over: {reason}"));
            }
            if let Some(tour) = &mut self.tour {
                tour.advance();
            }
        }
        let waiting = self.waiting.take_if(|(_, since)| captured_at > *since);
        if let Some((Waiting::Capture, _)) = waiting
            && let Err(reason) = self.take(&look, around)
        {
            context.refuse(reason);
        }
        self.last_look = Some(look);
        if let Some((Waiting::Plan, _)) = waiting {
            match self.plan(around) {
                Ok(planned) => self.use_plan(planned, context),
                Err(reason) => context.refuse(reason),
            }
        }
        self.step(around, context);
    }

    /// The robot has something new.
    pub fn step(&mut self, around: &MountAround, context: &mut Context<'_>) {
        let Some(tour) = &mut self.tour else { return };
        match tour.step(&around.robot, &around.rig, context.time.instant) {
            Wish::Nothing => {}
            Wish::Turn(pan_rad, tilt_rad) => {
                context.control(RobotControl::TurnHead { pan_rad, tilt_rad });
            }
            Wish::Wait(why) => context.notices.add(NoticeLevel::Warning, why),
            Wish::TurnOn(pan_rad, tilt_rad) => {
                let text = "The joints are heard again: the head turns on by itself.";
                context.notices.add(NoticeLevel::Info, text);
                context.control(RobotControl::TurnHead { pan_rad, tilt_rad });
            }
            Wish::Finished => {
                (self.tour, self.planned, self.seen) = (None, Vec::new(), 0);
                let text =
                    format!("The head was in all planned poses: {}.", counted(self.views.len(), "view"));
                context.notices.add(NoticeLevel::Success, text);
            }
            Wish::GiveUp(reason) => {
                self.end_tour();
                context.refuse(reason);
            }
        }
    }

    /// The tour ends; what it has not been to stays planned, so that the next one goes on there.
    fn end_tour(&mut self) {
        self.seen = self.seen_so_far();
        self.tour = None;
    }

    /// A tour of what was planned before is over: its rest is none of the new plan's.
    pub(super) fn use_plan(&mut self, planned: Vec<(f64, f64)>, context: &mut Context<'_>) {
        if self.tour.take().is_some() {
            let text = "The head's tour ended, because poses were planned anew.";
            context.notices.add(NoticeLevel::Info, text);
        }
        (self.planned, self.seen) = (planned, 0);
        self.deleted.iter_mut().for_each(|deleted| deleted.seen = 0);
    }

    /// For how long the eyes had been on when the views were taken, min, in the mean of those of which it is known.
    pub(super) fn minutes_of_views(&self) -> Option<f64> {
        let known = |view: &HeadView| self.taken_min.get(&view.name).copied();
        let known: Vec<f64> = self.views.iter().filter_map(known).collect();
        (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
    }

    /// Whether a view was taken while the eyes were colder than they were for another one: they turn in their mounts while
    /// they warm up, so that both do not go together.
    pub(super) fn is_colder(&self, view: &str) -> bool {
        let taken_min = |view: &str| self.taken_min.get(view).copied();
        let warmest_min = self.views.iter().filter_map(|view| taken_min(&view.name)).reduce(f64::max);
        let both_min = taken_min(view).zip(warmest_min);
        both_min.is_some_and(|(min, warmest)| matches!(Warmth::of(min, warmest), Warmth::Colder { .. }))
    }

    fn delete(&mut self, is_deleted: impl Fn(&HeadView) -> bool) {
        let views: Vec<HeadView> = self.views.extract_if(.., |view| is_deleted(view)).collect();
        // Of no views nothing is proposed.
        self.proposal.take_if(|_| self.views.is_empty());
        if !views.is_empty() {
            self.deleted.push(Deleted { views, board: self.board, seen: self.seen_so_far() });
        }
    }

    /// Brings back what was deleted last. A proposal that went with it is solved anew.
    fn undo(&mut self) -> Result<(), Refusal> {
        let last = self.deleted.last().ok_or(Refusal::NothingDeleted)?;
        if last.board != self.board && !self.views.is_empty() {
            return Err(Refusal::OtherBoard);
        }
        let Deleted { views, board, seen } = self.deleted.pop().ok_or(Refusal::NothingDeleted)?;
        (self.board, self.seen) = (board, self.seen.max(seen));
        self.views.extend(views);
        // In the order in which they were taken: the number is the end of the name.
        self.views.sort_by(|a, b| (a.name.len(), &a.name).cmp(&(b.name.len(), &b.name)));
        Ok(())
    }

    fn take(&mut self, look: &Look, around: &MountAround) -> Result<(), Refusal> {
        let (_, posture) = ready(around)?;
        if self.board.is_some_and(|board| board != look.board) && !self.views.is_empty() {
            return Err(Refusal::OtherBoard);
        }
        let name = format!("view {:02}", self.counted + 1);
        let view = head_view(look, name.clone(), &posture).ok_or(Refusal::NoBoard)?;
        self.board = Some(look.board);
        if let Some(on_s) = around.eyes_on_s {
            self.taken_min.insert(name, on_s / 60.0);
        }
        self.counted += 1;
        self.views.push(view);
        Ok(())
    }
}

impl Workflow for MountWorkflow {
    type Command = MountCommand;
    type Work = MountWork;
    type Control = RobotControl;
    type Around = MountAround;
    type View = MountView;

    /// Nothing seen. The mount in use is kept in a file of `folder`.
    fn new(folder: &Path) -> Self {
        Self {
            kept: mount_in(folder),
            shelf: mounts_in(folder),
            is_known: false,
            views: Vec::new(),
            deleted: Vec::new(),
            taken_min: BTreeMap::new(),
            board: None,
            planned: Vec::new(),
            seen: 0,
            tour: None,
            proposal: None,
            in_use: None,
            solving: None,
            last_look: None,
            counted: 0,
            waiting: None,
        }
    }

    fn view(&mut self, around: &MountAround, _: &Moment) -> Arc<MountView> {
        Arc::new(self.shown(around))
    }

    fn restore(&mut self, around: &MountAround, context: &mut Context<'_>) {
        let (kept, shelf) = (self.kept.clone(), self.shelf.clone());
        context.start(MountWork::Restore { kept, shelf, rig: around.rig.clone() });
    }

    fn apply(&mut self, command: MountCommand, around: &MountAround, context: &mut Context<'_>) {
        match command {
            MountCommand::Plan => self.wait_for_image(Waiting::Plan, around, context),
            MountCommand::Tour => {
                if self.still_to_be_seen().is_empty() {
                    return context.refuse("No head poses are planned yet. Plan them first.");
                }
                self.end_tour();
                self.tour = Some(Tour::new(self.still_to_be_seen()));
                self.step(around, context);
            }
            MountCommand::Capture => self.wait_for_image(Waiting::Capture, around, context),
            MountCommand::Delete { view } => self.delete(|known| known.name == view),
            MountCommand::DeleteColder => {
                let colder = |view: &&HeadView| self.is_colder(&view.name);
                let colder: BTreeSet<String> =
                    self.views.iter().filter(colder).map(|view| view.name.clone()).collect();
                self.delete(|known| colder.contains(&known.name));
            }
            MountCommand::DeleteAll => {
                self.delete(|_| true);
                // Without its view no pose was seen.
                (self.tour, self.seen) = (None, 0);
            }
            MountCommand::Undo => {
                if let Err(reason) = self.undo() {
                    context.refuse(reason);
                }
            }
            MountCommand::Solve => self.solve(around, context),
            MountCommand::Accept => match self.proposal.clone() {
                Some(_) if self.proposal_stale().is_some() => {
                    context.refuse(self.proposal_stale().unwrap_or_default());
                }
                Some(mount) => {
                    // From here on the mount itself is what is taken back.
                    self.deleted.clear();
                    let (kept, shelf) = (self.kept.clone(), self.shelf.clone());
                    context.start(MountWork::Save { kept, shelf, mount });
                }
                None => context.refuse("Nothing waits to be accepted. Solve first."),
            },
            MountCommand::Discard => self.proposal = None,
            MountCommand::UseEarlier { id } => {
                self.deleted.clear();
                let (kept, shelf) = (self.kept.clone(), self.shelf.clone());
                context.start(MountWork::UseEarlier { id, shelf, kept, rig: around.rig.clone() });
            }
            MountCommand::UseNominal => {
                self.deleted.clear();
                context.start(MountWork::Forget { kept: self.kept.clone() });
            }
        }
    }

    fn work_done(&mut self, id: JobId, result: MountResult, _: &MountAround, _: &mut Context<'_>) {
        self.solving.take_if(|solving| *solving == id);
        self.is_known |= !matches!(result, MountResult::Solved(_));
        match result {
            // Of no views nothing is proposed: all may have been deleted meanwhile.
            MountResult::Solved(mount) => self.proposal = Some(mount).filter(|_| !self.views.is_empty()),
            MountResult::Saved(mount) => {
                self.proposal = self.proposal.take().filter(|proposal| !Arc::ptr_eq(proposal, &mount));
                self.in_use = Some(mount);
            }
            MountResult::Restored(mount) => self.in_use = mount,
            MountResult::Forgotten => self.in_use = None,
        }
    }

    fn work_ended(&mut self, id: JobId, _: Option<&str>, _: &MountAround, _: &mut Context<'_>) {
        self.solving.take_if(|solving| *solving == id);
    }
}

/// Why a mount does not fit, `fits`: whether it was solved with the eyes in use; `None`: none are in use.
fn why_stale(fits: Option<bool>, is_eyes_known: bool) -> Option<&'static str> {
    match fits {
        Some(true) => None,
        Some(false) => Some("The eyes were calibrated anew since the mount was solved. Solve it again."),
        // Before they are read nobody knows.
        None => is_eyes_known.then_some(
            "The eyes that the mount was solved with are not in use any more. Bring them back on the timeline, or calibrate them and then the mount again.",
        ),
    }
}

/// The eyes' calibration and the present posture, or why there is none.
fn ready(around: &MountAround) -> Result<(Arc<StereoCalibration>, Posture), Refusal> {
    let calibration = around.calibration.clone().ok_or(Refusal::NotCalibrated)?;
    let head = around.robot.rig.as_ref().map(|rig| [rig.eyes.pan, rig.eyes.tilt]);
    let posture = head.and_then(|head| around.robot.known(&head).cloned());
    let posture = posture.ok_or(Refusal::HeadUnknown)?;
    Ok((calibration, posture))
}

fn head_view(look: &Look, name: String, posture: &Posture) -> Option<HeadView> {
    if look.left.is_none() && look.right.is_none() {
        return None;
    }
    let sighting = PairObservation { name, left: look.left.clone(), right: look.right.clone() };
    Some(HeadView::new(sighting, posture.clone()))
}

#[cfg(test)]
mod stale_tests {
    use super::why_stale;

    #[test]
    fn a_mount_goes_with_the_eyes_it_was_solved_with_and_with_no_others() {
        assert_eq!(why_stale(Some(true), true), None);
        assert!(why_stale(Some(false), true).is_some_and(|why| why.contains("calibrated anew")));
        assert!(why_stale(None, true).is_some_and(|why| why.contains("not in use any more")));
        assert_eq!(why_stale(None, false), None, "they are not read yet");
    }
}
