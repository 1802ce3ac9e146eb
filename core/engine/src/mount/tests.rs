//! The tour of the head as the workflow drives it.

use std::sync::Arc;
use std::time::Duration;

use image::{GrayImage, RgbImage};
use plumbline_model::robot::Rig;
use plumbline_model::{Chessboard, Pixel, Stamp, StereoCalibration, StereoFrame, default_board};

use super::command::MountCommand;
use super::work::Context;
use super::{MountAround, MountWorkflow};
use crate::eyes::Look;
use crate::ground::context::Asked;
use crate::ground::jobs::list::JobList;
use crate::ground::notice::Notices;
use crate::ground::stage::Skipped;
use crate::ground::time::Time;
use crate::ground::{Moment, Workflow as _};
use crate::mount::view::{MountTour, MountView};
use crate::robot::RobotControl;
use crate::robot::view::{Connection, MotionState, RobotView};

const POSES: [(f64, f64); 3] = [(0.2, -0.5), (-0.2, -0.4), (0.0, -0.6)];

/// A workflow whose poses are planned, and a head that turns where it is told to at once.
struct Bench {
    room: MountWorkflow,
    around: MountAround,
    notices: Notices,
    jobs: JobList,
    time: Time,
    told: Vec<(f64, f64)>,
    _folder: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let rig = Arc::new(Rig::built_in("nico").expect("comes with the program"));
        let robot = RobotView {
            rig: Some(rig.clone()),
            connection: Connection::Connected { to: "it".to_owned(), twin: true },
            measured: Some(rig.home()),
            motion: MotionState::Holding { why: None },
            ..RobotView::default()
        };
        let around = MountAround {
            calibration: Some(Arc::new(StereoCalibration::bare(rig.eyes.cameras))),
            is_eyes_known: true,
            rig,
            robot: Arc::new(robot),
            board: default_board(),
            has_eyes: true,
            eyes_on_s: None,
        };
        let mut room = MountWorkflow::new(folder.path());
        room.planned = POSES.to_vec();
        Self {
            room,
            around,
            notices: Notices::default(),
            jobs: JobList::default(),
            time: Time::now(),
            told: vec![],
            _folder: folder,
        }
    }

    fn with(&mut self, act: impl FnOnce(&mut MountWorkflow, &MountAround, &mut Context<'_>)) {
        let mut asked = vec![];
        let Self { room, around, notices, jobs, time, told, .. } = self;
        act(room, around, &mut Context::new(notices, jobs, *time, &mut asked));
        for one in asked {
            if let Asked::Control(RobotControl::TurnHead { pan_rad, tilt_rad }) = one {
                told.push((pan_rad, tilt_rad));
            }
        }
    }

    fn tour(&mut self) {
        self.with(|room, around, context| room.apply(MountCommand::Tour, around, context));
    }

    /// The head stands where it was told to turn, and the board is seen from there once it has settled.
    fn arrives(&mut self) {
        let (pan_rad, tilt_rad) = *self.told.last().expect("it was told to turn");
        let eyes = &self.around.rig.eyes;
        let there = self.around.rig.home().with(&[eyes.pan, eyes.tilt], &[pan_rad, tilt_rad]);
        self.change(|robot| robot.measured = Some(there));
        let told = self.told.len();
        self.look();
        assert_eq!(self.told.len(), told, "what it saw may still have swung");
        self.time = self.time.after(Duration::from_secs(1));
        self.look();
    }

    /// The board was looked for in an image that was captured now, and both eyes see it.
    fn look(&mut self) {
        let image = Arc::new(RgbImage::new(8, 8));
        let frame = StereoFrame {
            stamp: Stamp { seq: 1, captured_at: self.time.instant },
            left: image.clone(),
            right: image,
            time_difference_s: None,
            name: None,
            beside: Default::default(),
        };
        let corners = Some(vec![Some(Pixel::new(4.0, 4.0)); 40]);
        let gray = Arc::new(GrayImage::new(8, 8));
        let look = Look {
            frame,
            board: self.around.board,
            left: corners.clone(),
            right: corners,
            gray: [gray.clone(), gray],
            edge_width_px: None,
            other_board: None,
        };
        self.with(|room, around, context| room.look(look, around, context));
    }

    fn change(&mut self, how: impl FnOnce(&mut RobotView)) {
        let mut robot = (*self.around.robot).clone();
        how(&mut robot);
        self.around.robot = Arc::new(robot);
        self.step();
    }

    fn step(&mut self) {
        self.with(|room, around, context| room.step(around, context));
    }

    fn view(&mut self) -> Arc<MountView> {
        let moment = Moment { now: self.time.instant, skipped: Skipped::default() };
        self.room.view(&self.around, &moment)
    }
}

#[test]
fn after_stop_the_rest_stays_planned_and_the_next_tour_goes_on_there() {
    let mut bench = Bench::new();
    bench.tour();
    assert_eq!(bench.told, [POSES[0]]);
    assert_eq!(bench.view().tour, Some(MountTour { pose: 1, of: 3, waits: false }));
    bench.arrives();
    assert_eq!(bench.told, POSES[..2]);
    assert_eq!(bench.view().tour, Some(MountTour { pose: 2, of: 3, waits: false }));
    bench.change(|robot| robot.stopped = true);
    let view = bench.view();
    assert_eq!((view.tour, &*view.planned), (None, &POSES[1..]), "the first one was seen");
    bench.change(|robot| robot.stopped = false);
    bench.tour();
    assert_eq!(bench.told, [POSES[0], POSES[1], POSES[1]], "the one that was under way, not the first one");
    bench.arrives();
    bench.arrives();
    let view = bench.view();
    assert_eq!((view.tour, view.planned.len(), view.views.len()), (None, 0, 3), "all were seen");
}

#[test]
fn without_its_views_every_pose_is_to_be_seen_again_also_after_stop() {
    let mut bench = Bench::new();
    bench.tour();
    bench.arrives();
    bench.change(|robot| robot.stopped = true);
    let view = bench.view();
    assert_eq!((view.views.len(), view.planned.len()), (1, 2));
    bench.with(|room, around, context| room.apply(MountCommand::DeleteAll, around, context));
    let view = bench.view();
    assert_eq!((view.views.len(), &*view.planned), (0, &POSES[..]));
    bench.change(|robot| robot.stopped = false);
    bench.tour();
    assert_eq!(bench.told.last(), Some(&POSES[0]), "not the rest only");
    (0..3).for_each(|_| bench.arrives());
    let view = bench.view();
    assert_eq!((view.tour, view.views.len()), (None, 3));
}

#[test]
fn deleted_views_come_back_in_their_order_until_a_mount_is_accepted() {
    let mut bench = Bench::new();
    bench.tour();
    (0..3).for_each(|_| bench.arrives());
    let names =
        |bench: &mut Bench| bench.view().views.iter().map(|view| view.name.clone()).collect::<Vec<_>>();
    let all = names(&mut bench);
    assert!(!bench.view().can_undo);
    bench.with(|room, around, context| {
        room.apply(MountCommand::Delete { view: "view 01".to_owned() }, around, context);
    });
    assert_eq!(names(&mut bench), all[1..]);
    bench.with(|room, around, context| room.apply(MountCommand::DeleteAll, around, context));
    assert!(bench.view().views.is_empty());
    bench.with(|room, around, context| room.apply(MountCommand::Undo, around, context));
    assert_eq!(names(&mut bench), all[1..]);
    bench.with(|room, around, context| room.apply(MountCommand::Undo, around, context));
    assert_eq!((names(&mut bench), bench.view().can_undo), (all, false));
    // Of views of one board and of another no mount is solved.
    bench.with(|room, around, context| {
        room.apply(MountCommand::Delete { view: "view 01".to_owned() }, around, context);
        room.board = room.board.map(|board| Chessboard { square_m: 2.0 * board.square_m, ..board });
        room.apply(MountCommand::Undo, around, context);
    });
    assert_eq!(names(&mut bench).len(), 2);
    assert!(bench.view().can_undo, "and none is lost by trying");
}

#[test]
fn views_keep_for_how_long_the_eyes_had_been_on() {
    let mut bench = Bench::new();
    bench.tour();
    for on_s in [None, Some(600.0), Some(660.0)] {
        bench.around.eyes_on_s = on_s;
        bench.arrives();
    }
    assert_eq!(bench.room.minutes_of_views(), Some(10.5), "in the mean of those of which it is known");
    let last = bench.view().views.last().expect("three").name.clone();
    bench.with(|room, around, context| room.apply(MountCommand::Delete { view: last }, around, context));
    assert_eq!(bench.room.minutes_of_views(), Some(10.0), "of those that are left");
    bench.with(|room, around, context| room.apply(MountCommand::DeleteAll, around, context));
    assert_eq!(bench.room.minutes_of_views(), None);
}

#[test]
fn views_of_colder_eyes_are_told_from_the_others_and_go_at_once() {
    let mut bench = Bench::new();
    bench.tour();
    for on_s in [None, Some(120.0), Some(900.0)] {
        bench.around.eyes_on_s = on_s;
        bench.arrives();
    }
    let colder = |bench: &mut Bench| {
        bench.view().views.iter().map(|view| (view.name.clone(), view.is_colder)).collect::<Vec<_>>()
    };
    let told = colder(&mut bench);
    assert_eq!(told.iter().map(|(_, is_colder)| *is_colder).collect::<Vec<_>>(), [false, true, false]);
    bench.with(|room, around, context| room.apply(MountCommand::DeleteColder, around, context));
    assert_eq!(colder(&mut bench), [told[0].clone(), told[2].clone()], "of which nobody knows stays");
    bench.with(|room, around, context| room.apply(MountCommand::Undo, around, context));
    assert_eq!(colder(&mut bench), told);
}

#[test]
fn poses_that_are_planned_during_a_tour_take_the_place_of_its_rest() {
    const NEW: [(f64, f64); 2] = [(0.1, -0.5), (-0.1, -0.5)];
    let mut bench = Bench::new();
    bench.tour();
    bench.arrives();
    bench.with(|room, _, context| room.use_plan(NEW.to_vec(), context));
    let view = bench.view();
    assert_eq!((view.tour, &*view.planned), (None, &NEW[..]));
    bench.tour();
    assert_eq!(bench.told.last(), Some(&NEW[0]));
    assert_eq!(bench.view().tour, Some(MountTour { pose: 1, of: 2, waits: false }));
}

#[test]
fn a_head_that_was_not_heard_is_said_and_turns_on_by_itself() {
    let mut bench = Bench::new();
    bench.tour();
    bench.change(|robot| {
        robot.refusal = Some("The servo of Head turn was not heard in time.".to_owned());
        (robot.is_unheard, robot.refused) = (true, 1);
    });
    let view = bench.view();
    assert!(view.tour.is_some_and(|tour| tour.waits) && view.next.contains("by itself"), "{}", view.next);
    let said = bench.notices.view();
    assert!(said.iter().any(|notice| notice.text.contains("not heard in time")), "{said:?}");
    assert_eq!(bench.told, [POSES[0]], "nothing moves meanwhile");
}
