//! From a session to an accepted model, and back.

use plumbline_correction::{Touch, TouchData};
use plumbline_model::{Cancelled, ScreenPlacement, place_screen};

use super::*;
use crate::ground::step::StepState;
use crate::ground::{Asked, LongWork, Time, Workflow};
use crate::models::screen::corners;
use crate::models::{ModelsAround, ModelsWorkflow};
use crate::robot::view::RobotView;

#[test]
fn a_session_becomes_models_maps_and_one_in_use() {
    let mut lab = Lab::new();
    let before = lab.view();
    assert_eq!(before.sessions.len(), 1);
    assert_eq!(before.session, Some(lab.session()), "the only one is chosen");
    assert!(matches!(&before.data, Some(Ok(data)) if data.len() == 63));
    assert!(before.step == StepState::NotDone && before.next.contains("63 touches"), "{}", before.next);

    let trained = lab.tell(train(&[Method::M2, Method::M3]));
    let methods: Vec<Method> = trained.proposals.iter().map(|model| model.method()).collect();
    assert_eq!(methods, [Method::M2, Method::M3]);
    let comparison = trained.comparison.as_ref().expect("compared");
    let compared: Vec<Method> = comparison.methods.iter().map(|compared| compared.method).collect();
    assert_eq!(compared, Method::ALL, "all on the same touches");
    let blocks = |i: usize| &comparison.methods[i].held_out.blocks;
    assert!(blocks(0) == blocks(1) && blocks(1) == blocks(2));
    assert!(!trained.losses.is_empty() && trained.losses.len() <= 500);
    let screen = nico().touchscreen;
    let error_m = mean_error_m(&trained.proposals[1], &screen);
    assert!(error_m < 0.001, "{error_m}: the lab shifts by 1 to 2 cm");
    assert_eq!(trained.shown, Some(Method::M3));
    assert!(trained.in_use.is_none() && trained.next.contains("accept"), "{}", trained.next);

    let accepted = lab.tell(ModelsCommand::Accept(Method::M3));
    assert_eq!(accepted.in_use.as_ref().map(|model| model.method()), Some(Method::M3));
    assert_eq!(accepted.step, StepState::Done);
    assert_eq!(accepted.proposals.len(), 1, "the other one still waits");
    assert!(!accepted.map.as_ref().expect("a map").proposed);
    assert!(lab.path("models/in-use.json").is_file());
    let earlier: Vec<_> = accepted.earlier.iter().map(|earlier| earlier.method).collect();
    assert_eq!(earlier, [None], "before it there was no model");
}

#[test]
fn the_map_shows_what_the_model_gains_and_where_it_ends() {
    let mut lab = Lab::new();
    let view = lab.tell(train(&[Method::M3]));
    let map = view.map.clone().expect("a map");
    assert!(map.proposed && map.method == Some(Method::M3));
    assert_eq!(map.touches.len(), 63);
    let mean = |of: fn(&crate::models::view::MapTouch) -> [f64; 3]| {
        map.touches.iter().map(|touch| of(touch)[0].hypot(of(touch)[1])).sum::<f64>() / 63.0
    };
    let (before_m, after_m) = (mean(|touch| touch.before_m), mean(|touch| touch.after_m));
    assert!(before_m > 0.01 && after_m < 0.25 * before_m, "{before_m} {after_m}");
    let [x_m, y_m] = [map.sd.x_m, map.sd.y_m];
    assert!(map.screen_m.iter().all(|[x, y]| x - x_m[0] > 0.07 && y_m[1] - y > 0.07), "8 cm around");
    assert_eq!(map.sd.values_m.len(), map.shift.values_m.len());
    assert!(map.border_m.len() == 1 && map.border_m[0].len() > 3);
    // The corner of the map lies far outside of the touches, its middle among them.
    let values: Vec<f64> = map.sd.values_m.iter().copied().flatten().collect();
    assert_eq!(values.len(), map.sd.values_m.len());
    let middle = values[(values.len() / map.sd.columns / 2) * map.sd.columns + map.sd.columns / 2];
    assert!(values[0] > 3.0 * middle, "{} {middle}", values[0]);
    let (Some(inside_m), Some(outside_m)) = map.mean_shift_m else { panic!("both") };
    assert!((0.005..0.03).contains(&inside_m) && outside_m > 0.0, "{inside_m} {outside_m}");
}

#[test]
fn the_map_has_all_lines_of_the_border_also_those_around_holes() {
    let rig = nico();
    let (screen, session) = (&rig.touchscreen, made_up_session(&rig));
    let chain = rig.chain("right_index_tip").expect("a tip");
    let mut data = TouchData::of_session(&session, &chain).expect("can be learned from");
    // 12 × 12 places, 4 × 4 of them in the middle never touched.
    let touched =
        (0..144).map(|k| (k / 12, k % 12)).filter(|(i, j)| !((4..8).contains(i) && (4..8).contains(j)));
    let template = data.touches[0].clone();
    let touch = |(i, j): (i32, i32)| {
        let pixel = Pixel::new(300.0 + 110.0 * f64::from(i), 40.0 + 90.0 * f64::from(j));
        Touch { pixel, sent: needed(screen, pixel), ..template.clone() }
    };
    data.touches = touched.map(touch).collect();
    let model = plumbline_correction::train(&data, Method::M1, &Default::default(), &Unattended, &mut |_| {});
    let model = model.expect("trained");
    let lines = crate::models::map::model_map(&model, screen, true).border_m;
    assert_eq!(lines.len(), 2, "the outer line and that of the hole");
    let inside = |pixel: Pixel<Screen>| {
        let at = screen.point_at(pixel).coords;
        let crosses = |(a, b): (&[f64; 2], &[f64; 2])| {
            (a[1] > at.y) != (b[1] > at.y) && at.x < a[0] + (b[0] - a[0]) * (at.y - a[1]) / (b[1] - a[1])
        };
        let edges = lines.iter().flat_map(|line| line.iter().zip(line.iter().cycle().skip(1)));
        edges.filter(|edge| crosses(*edge)).count() % 2 == 1
    };
    let places = [(905.0, 535.0, false), (410.0, 130.0, true), (905.0, 940.0, true), (20.0, 20.0, false)];
    for (u_px, v_px, known) in places {
        let pixel = Pixel::new(u_px, v_px);
        assert_eq!((inside(pixel), model.correct(pixel).inside), (known, known), "{pixel:?}");
    }
}

#[test]
fn undo_goes_back_exactly_also_after_a_restart() {
    let mut lab = Lab::new();
    lab.tell(train(&[Method::M1, Method::M3]));
    let m1 = lab.tell(ModelsCommand::Accept(Method::M1)).in_use.clone().expect("in use");
    let m3 = lab.tell(ModelsCommand::Accept(Method::M3)).in_use.clone().expect("in use");
    let mut lab = lab.restarted();
    assert_eq!(lab.view().in_use, Some(m3), "every number of it");
    assert_eq!(lab.view().earlier.len(), 2);
    let kept = std::fs::read(lab.path("models/in-use.json")).expect("a copy for others");
    lab.tell(ModelsCommand::UseNone);
    assert!(lab.view().in_use.is_none() && !lab.path("models/in-use.json").exists());
    lab.tell(ModelsCommand::Undo);
    assert_eq!(std::fs::read(lab.path("models/in-use.json")).expect("back"), kept);
    let mut lab = lab.restarted();
    assert_eq!(lab.tell(ModelsCommand::Undo).in_use, Some(m1));
    assert!(lab.tell(ModelsCommand::Undo).in_use.is_none());
    let mut lab = lab.restarted();
    assert!(lab.view().in_use.is_none() && lab.view().earlier.is_empty());
    lab.tell(ModelsCommand::Undo);
    assert!(lab.said().contains("Nothing was in use before"), "{}", lab.said());
    assert_eq!(files_in(&lab.path("models/history")), 2, "files of models stay");
}

/// Cancels at some checkpoint.
struct CancelAfter(std::sync::atomic::AtomicUsize);

impl JobContext for CancelAfter {
    fn checkpoint(&self) -> Result<(), Cancelled> {
        use std::sync::atomic::Ordering::Relaxed;
        let left = self.0.fetch_update(Relaxed, Relaxed, |left| left.checked_sub(1));
        left.map(|_| ()).map_err(|_| Cancelled)
    }

    fn report(&self, _: f64, _: &str) {}
}

#[test]
fn cancelled_training_leaves_everything_as_it_was() {
    let mut lab = Lab::new();
    let before = lab.tell(train(&[Method::M1]));
    for checkpoints in [0, 1, 3, 20] {
        lab.state.apply(Command::Models(train(&[Method::M2, Method::M3])));
        assert!(lab.view().training && lab.view().step == StepState::Running);
        lab.work(&CancelAfter(checkpoints.into()));
        let after = lab.view();
        assert!(lab.said().contains("cancelled"), "{}", lab.said());
        assert_eq!(after.proposals, before.proposals);
        assert_eq!(after.comparison, before.comparison);
        assert_eq!(after.losses, before.losses);
        assert_eq!((after.shown, &after.step, after.training), (before.shown, &before.step, false));
    }
    assert_eq!(lab.tell(train(&[Method::M3])).proposals.len(), 2, "and training still works");
}

#[test]
fn the_same_seed_gives_the_same_model() {
    let mut lab = Lab::new();
    let parameters = |view: &ModelsView| {
        view.proposals.iter().map(|model| model.correct(Pixel::new(801.0, 407.0))).collect::<Vec<_>>()
    };
    let first = parameters(&lab.tell(train(&[Method::M3])));
    assert_eq!(parameters(&lab.tell(train(&[Method::M3]))), first);
    let other = ModelsCommand::Train { methods: vec![Method::M3], seed: 2, published_recipe: false };
    assert_ne!(parameters(&lab.tell(other)), first);
}

#[test]
fn a_screen_that_was_placed_anew_makes_the_model_stale() {
    let mut lab = Lab::new();
    lab.tell(train(&[Method::M3]));
    lab.tell(ModelsCommand::Accept(Method::M3));
    // The same files seen with the screen elsewhere.
    let mut moved = nico();
    moved.touchscreen = placed(&moved.touchscreen).screen;
    assert!(corners(&moved.touchscreen) != corners(&nico().touchscreen));
    let mut workflow = ModelsWorkflow::new(lab.folder.path());
    let robot = RobotView::default();
    let view_on = |workflow: &ModelsWorkflow, rig: Rig| {
        workflow.shown(&ModelsAround {
            rig: Arc::new(rig),
            robot: Arc::new(robot.clone()),
            newest_session: None,
        })
    };
    restore(&mut workflow, &robot, nico());
    assert_eq!(view_on(&workflow, nico()).step, StepState::Done);
    let StepState::Stale { why } = view_on(&workflow, moved).step else { panic!("stale") };
    assert!(why.contains("5.0 mm") && why.contains("M3") && why.contains("Train again"), "{why}");
}

/// Where the screen was measured to lie is read after the models, when a program starts.
#[test]
fn the_map_of_a_model_is_the_same_after_a_restart_wherever_the_screen_is_taken_to_lie_by_then() {
    let mut lab = Lab::new();
    lab.tell(train(&[Method::M3]));
    let before = lab.tell(ModelsCommand::Accept(Method::M3)).map.clone().expect("a map");
    let mut moved = nico();
    moved.touchscreen = placed(&moved.touchscreen).screen;
    let (mut workflow, robot) = (ModelsWorkflow::new(lab.folder.path()), RobotView::default());
    restore(&mut workflow, &robot, moved.clone());
    let around = ModelsAround { rig: Arc::new(moved), robot: Arc::new(robot.clone()), newest_session: None };
    let after = workflow.shown(&around).map.expect("a map");
    assert_eq!(after.border_m.len(), before.border_m.len());
    for (a, b) in after.screen_m.iter().zip(&before.screen_m) {
        assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-6, "{a:?} {b:?}");
    }
    let (now, then) = (after.mean_shift_m, before.mean_shift_m);
    let apart_m = |a: Option<f64>, b: Option<f64>| (a.expect("inside") - b.expect("inside")).abs();
    assert!(apart_m(now.0, then.0) < 1e-5, "{now:?} {then:?}");
}

/// The screen 5 mm farther away.
fn placed(nominal: &Touchscreen) -> ScreenPlacement {
    let moved = nominal.moved(&nalgebra::Isometry3::translation(0.005, 0.0, 0.0));
    let pixels = [(60.0, 60.0), (1860.0, 60.0), (1860.0, 1020.0), (60.0, 1020.0)];
    let touches =
        pixels.map(|(u_px, v_px)| Pixel::new(u_px, v_px)).map(|pixel| (pixel, moved.point_at(pixel)));
    place_screen(nominal, &touches).expect("placed")
}

/// Hands a workflow what is on disk, without the rest of the state.
fn restore(workflow: &mut ModelsWorkflow, robot: &RobotView, rig: Rig) {
    let rig = Arc::new(rig);
    let (mut notices, mut jobs, mut asked) = Default::default();
    let around = ModelsAround { rig, robot: Arc::new(robot.clone()), newest_session: None };
    let mut context = crate::models::work::Context::new(&mut notices, &mut jobs, Time::now(), &mut asked);
    workflow.restore(&around, &mut context);
    let Some(Asked::Start(id, work)) = asked.pop() else { panic!("it reads what is there") };
    let result = work.run(&Unattended).expect("read");
    let mut context = crate::models::work::Context::new(&mut notices, &mut jobs, Time::now(), &mut asked);
    workflow.work_done(id, result, &around, &mut context);
}
