//! An evaluation whose disk is full: nothing of it is lost, nobody is told without end. And one whose eyes are lost.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_effects::RobotModel;
use plumbline_model::robot::default_rig;
use plumbline_model::{ClassNames, Point, Session, Stamp};

use super::command::{DriftCommand, GridCommand};
use super::grid::LOOKS;
use super::view::{GridDoing, GridRunView};
use super::work::DriftWork;
use super::{DriftAround, DriftWorkflow};
use crate::detect::view::{AllBecause, DetectionTiming, DetectionsView, LookedAt};
use crate::ground::jobs::JobId;
use crate::ground::jobs::list::JobList;
use crate::ground::notice::Notices;
use crate::ground::stage::Skipped;
use crate::ground::{Asked, Context, LongWork as _, Moment, Time, Workflow as _, World};
use crate::robot::RobotControl;
use crate::robot::view::{Connection, MotionState, RobotView};
use crate::twin::command::TwinCommand;
use crate::twin::view::{ToyView, TwinView};

struct Desk {
    room: DriftWorkflow,
    around: DriftAround,
    notices: Notices,
    jobs: JobList,
    time: Time,
    /// How often it was tried to write the evaluation.
    tries: usize,
    /// What the twin was asked for.
    asked_twin: Vec<TwinCommand>,
}

impl Desk {
    fn new(folder: &Path) -> Self {
        let connection = Connection::Connected { to: "a robot".to_owned(), twin: false };
        let around = DriftAround {
            is_live: true,
            is_recorded: false,
            recorded_head_rad: None,
            opened: 1,
            model: Arc::new(RobotModel::nominal(default_rig())),
            own_eyes: true,
            robot: Arc::new(RobotView { connection, ..RobotView::default() }),
            eyes_on_s: Some(60.0),
            clock_settings: 0,
            is_calibrated: false,
            is_mounted: false,
            clock_pace: 1.0,
            world: Some(World::Robot),
            twin: None,
            found: None,
            board: None,
        };
        Self {
            room: DriftWorkflow::new(folder),
            around,
            notices: Notices::default(),
            jobs: JobList::default(),
            time: Time::now(),
            tries: 0,
            asked_twin: vec![],
        }
    }

    /// Does something, and all the work that it asks for.
    fn with(
        &mut self,
        act: impl FnOnce(&mut DriftWorkflow, &DriftAround, &mut super::workflow::Context<'_>),
    ) {
        let mut asked = Vec::new();
        let Self { room, around, notices, jobs, time, .. } = self;
        act(room, around, &mut Context::new(notices, jobs, *time, &mut asked));
        for asked in asked {
            match asked {
                Asked::Start(id, work) => self.run(id, work),
                Asked::Control(RobotControl::Twin(command)) => self.asked_twin.push(command),
                _ => {}
            }
        }
    }

    fn run(&mut self, id: JobId, work: DriftWork) {
        self.tries += usize::from(matches!(work, DriftWork::KeepGrid { .. }));
        match work.run(&plumbline_model::Unattended) {
            Ok(result) => self.with(|room, around, context| room.work_done(id, result, around, context)),
            Err(error) => self
                .with(|room, around, context| room.work_ended(id, Some(&error.to_string()), around, context)),
        }
    }

    fn ask(&mut self, command: GridCommand) {
        self.with(|room, around, context| room.apply(DriftCommand::Grid(command), around, context));
    }

    /// Pairs come for so long, twenty a second.
    fn passes(&mut self, time: Duration) {
        let image = Arc::new(image::RgbImage::new(4, 4));
        for _ in 0..time.as_millis() / 50 {
            self.time = self.time.after(Duration::from_millis(50));
            let frame = plumbline_model::StereoFrame {
                stamp: plumbline_model::Stamp { seq: 1, captured_at: self.time.instant },
                left: image.clone(),
                right: image.clone(),
                time_difference_s: None,
                name: None,
                beside: Default::default(),
            };
            self.with(|room, around, context| room.saw(&frame, around, context));
        }
    }

    fn run_view(&mut self) -> GridRunView {
        let moment = Moment { now: self.time.instant, skipped: Skipped::default() };
        self.room.view(&self.around, &moment).grid.run.clone().expect("begun")
    }
}

/// A detector that has looked at the newest pair and found nothing.
fn found_nothing(captured_at: Instant) -> Arc<DetectionsView> {
    Arc::new(DetectionsView {
        stamp: Stamp { seq: 1, captured_at },
        names: ClassNames::default(),
        objects: Vec::new(),
        no_places_because: None,
        looked_at: LookedAt::All(AllBecause::Unknown),
        timing: DetectionTiming::default(),
        left_out: 0,
    })
}

#[test]
fn eyes_that_were_lost_on_the_way_or_had_to_wait_have_not_missed_the_thing() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut desk = Desk::new(folder.path());
    let robot = |motion| {
        let connection = Connection::Connected { to: "a robot".to_owned(), twin: false };
        let measured = Some(default_rig().home());
        Arc::new(RobotView { connection, measured, motion, ..RobotView::default() })
    };
    desk.around.robot = robot(MotionState::Holding { why: None });
    desk.ask(GridCommand::Begin { object: "Tomato".to_owned() });
    desk.ask(GridCommand::Placed);
    let looked = |desk: &mut Desk, seconds: u64| {
        for _ in 0..20 * seconds {
            desk.around.found = Some(found_nothing(desk.time.instant));
            desk.passes(Duration::from_millis(50));
        }
        desk.run_view().doing
    };
    let looks = GridDoing::Looks { looks: 0, of: LOOKS };
    assert_eq!(looked(&mut desk, 5), looks);
    // A plug is pulled for half a minute.
    desk.time = desk.time.after(Duration::from_secs(30));
    assert_eq!(looked(&mut desk, 2), looks, "it goes on where it was");
    // The arm moves meanwhile, and hides what lies there.
    desk.around.robot =
        robot(MotionState::Moving { what: "home".to_owned(), fraction: None, remaining: None });
    assert_eq!(looked(&mut desk, 20), looks);
    desk.around.robot = robot(MotionState::Holding { why: None });
    assert_eq!(looked(&mut desk, 1), looks);
    assert_eq!(looked(&mut desk, 4), GridDoing::NotSeen, "after eight seconds of looking it says so");
}

#[test]
fn a_full_disk_loses_nothing_of_an_evaluation_and_is_told_now_and_then() {
    let folder = tempfile::tempdir().expect("a folder");
    // A file lies where the folder of sessions would be, as good as a full disk.
    let sessions = World::Robot.folder(folder.path()).join("sessions");
    std::fs::create_dir_all(sessions.parent().expect("in a folder")).expect("made");
    std::fs::write(&sessions, "").expect("written");
    let mut desk = Desk::new(folder.path());
    desk.ask(GridCommand::Begin { object: "Tomato".to_owned() });
    desk.ask(GridCommand::LeaveOut);
    assert!(desk.run_view().unkept.is_some_and(|why| why.contains("sessions")), "it says where");
    assert_eq!((desk.tries, desk.run_view().session), (1, None));
    desk.passes(Duration::from_secs(40));
    assert!((2..=3).contains(&desk.tries), "{} tries in 40 s", desk.tries);
    let tries = desk.tries;
    desk.ask(GridCommand::LeaveOut);
    assert_eq!(desk.tries, tries + 1, "with the next place it is tried at once");
    desk.ask(GridCommand::End);
    desk.ask(GridCommand::Begin { object: "Tomato".to_owned() });
    let told = desk.notices.view().last().map(|notice| notice.text.clone()).expect("told");
    assert!(told.contains("not on disk yet"), "the next one would forget it: {told}");
    // Somebody makes room.
    std::fs::remove_file(&sessions).expect("removed");
    desk.passes(Duration::from_secs(20));
    let view = desk.run_view();
    assert_eq!(view.unkept, None);
    let session = Session::read(&view.session.expect("on disk")).expect("a session");
    assert_eq!(session.localizations.expect("a table").row_count(), 2, "both places");
    let tries = desk.tries;
    desk.passes(Duration::from_secs(40));
    assert_eq!(desk.tries, tries, "what is on disk is not written again");
}

#[test]
fn toys_that_made_room_for_an_evaluation_stand_where_they_stood_when_it_ends() {
    let folder = tempfile::tempdir().expect("a folder");
    let toy = |name: &str, place: Option<[f64; 2]>| ToyView {
        name: name.to_owned(),
        place: place.map(|[x_m, y_m]| Point::new(x_m, y_m, 0.03)),
        radius_m: 0.03,
        rgb: [200, 30, 30],
    };
    let toys = vec![toy("Tomato", Some([0.3, 0.1])), toy("Onion", Some([0.4, -0.1])), toy("Can", None)];
    let mut desk = Desk::new(folder.path());
    desk.around.twin = Some(Arc::new(TwinView { running: true, toys, ..TwinView::default() }));
    desk.ask(GridCommand::Begin { object: "Tomato".to_owned() });
    let removed = |toy: &str| TwinCommand::RemoveToy { toy: toy.to_owned() };
    assert!(desk.asked_twin.contains(&removed("Onion")) && !desk.asked_twin.contains(&removed("Can")));
    desk.asked_twin.clear();
    desk.ask(GridCommand::End);
    let placed = |toy: &str, x_m, y_m| TwinCommand::PlaceToy { toy: toy.to_owned(), x_m, y_m };
    assert_eq!(
        desk.asked_twin,
        [removed("tomato"), placed("tomato", 0.3, 0.1), placed("onion", 0.4, -0.1)],
        "the thing, too; what was put away before stays that"
    );
}
