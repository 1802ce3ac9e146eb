//! Plans: those that cannot be made, the one that is given up, the other finger, and targets that are corrected.

use std::fs;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use plumbline_correction::{Method, TouchData, TrainOptions, train};
use plumbline_model::touch_plan::{Finger, PlanOptions, Purpose, TouchArea};
use plumbline_model::{Cancelled, JobContext, Session, Unattended};

use super::folder;
use crate::ground::jobs::JobError;
use crate::motion::ScreenPlace;
use crate::robot::RobotControl;
use crate::touch::command::{Correction, TouchCommand};
use crate::touch::plan::{Corrector, PlanRequest, TIP, make};
use crate::touch::testing::{Desk, area, grid, only_session, rig};
use crate::touch::view::TouchPhase;
use crate::twin::command::TwinCommand;

#[test]
fn a_plan_that_cannot_be_made_is_told_and_so_are_targets_out_of_reach() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.apply(TouchCommand::Plan(PlanOptions { patterns: vec![], ..grid(1, 1) }));
    assert!(desk.said().contains("no pattern") || desk.said().contains("No pattern"), "{}", desk.said());
    assert_eq!(desk.view().phase, TouchPhase::Idle);
    desk.apply(TouchCommand::Start);
    assert!(desk.said().contains("Plan touches first"));
    let mut far = area();
    (far.u_px, far.v_px) = ([20.0, 60.0], [20.0, 60.0]);
    let options = PlanOptions { area: far, purpose: Purpose::Train, ..grid(2, 2) };
    desk.apply(TouchCommand::Plan(options));
    let view = desk.view();
    let plan = view.plan.expect("a plan");
    assert_eq!((plan.reachable, view.counts.unreachable), (0, view.counts.planned));
    assert!(!plan.refusals.is_empty() && plan.score.is_none());
    desk.apply(TouchCommand::Start);
    assert!(desk.said().contains("reaches none"), "{}", desk.said());
}

/// Asks to stop at the n-th checkpoint.
struct StopsAt(AtomicUsize);

impl JobContext for StopsAt {
    fn checkpoint(&self) -> Result<(), Cancelled> {
        match self.0.fetch_sub(1, Ordering::Relaxed) {
            1 => Err(Cancelled),
            _ => Ok(()),
        }
    }
    fn report(&self, _fraction: f64, _doing: &str) {}
}

#[test]
fn planning_stops_when_asked_to() {
    let request = PlanRequest {
        rig: rig(),
        place: ScreenPlace::Nominal,
        options: grid(2, 2),
        corrector: Corrector::None,
    };
    let cancelled = make(&request, &StopsAt(3.into()));
    assert!(matches!(cancelled, Err(JobError::Cancelled(_))));
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.held = Some("Plan touches");
    desk.apply(TouchCommand::Plan(grid(2, 2)));
    assert_eq!(desk.view().phase, TouchPhase::Planning);
    desk.cancel();
    assert_eq!(desk.view().phase, TouchPhase::Idle);
    // A plan in place of one that is being made: only the newer one counts, without a word.
    desk.apply(TouchCommand::Plan(grid(2, 2)));
    desk.apply(TouchCommand::Plan(grid(3, 2)));
    desk.release();
    assert_eq!((desk.view().phase, desk.view().counts.planned), (TouchPhase::Planned, 10));
    assert!(desk.said().is_empty(), "{}", desk.said());
}

#[test]
fn the_left_finger_touches_what_it_reaches_and_its_session_says_so() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    let [Some(right), Some(left)] = desk.view().reach else { panic!("both fingers reach a part") };
    assert!(left.u_px[0] < right.u_px[0] || left.u_px[1] < right.u_px[1], "{left:?} {right:?}");
    let inner = |range: [f64; 2]| [0.8 * range[0] + 0.2 * range[1], 0.2 * range[0] + 0.8 * range[1]];
    let area = TouchArea { u_px: inner(left.u_px), v_px: inner(left.v_px) };
    let options = PlanOptions { finger: Finger::Left, area, ..PlanOptions::quick(area) };
    desk.start(options.clone());
    assert!(desk.view().plan.is_some_and(|plan| plan.reachable > 12), "{:?}", desk.view().plan);
    desk.touch_all();
    assert_eq!(desk.view().phase, TouchPhase::Finished);
    assert!(desk.view().placement_proposal.is_none(), "the right finger places the screen");
    let session = Session::read(&only_session(folder.path())).expect("readable");
    let chain = session.manifest.chain.clone().expect("a chain");
    assert_eq!(chain.tip, "left_index_tip");
    assert!(chain.joints.iter().all(|joint| joint.starts_with("l_")), "{:?}", chain.joints);

    // What was learned of the right arm says nothing of the left one.
    let data = TouchData::of_session(&session, &rig().chain(&chain.tip).expect("the tip")).expect("touches");
    let model = train(&data, Method::M1, &TrainOptions::default(), &Unattended, &mut |_| {});
    desk.models = vec![Arc::new(model.expect("trained"))];
    desk.controls.clear();
    desk.apply(TouchCommand::Close);
    desk.step();
    desk.wait(Duration::from_secs(2));
    let ends = |control: &RobotControl| matches!(control, RobotControl::Twin(TwinCommand::EndTouch));
    assert!(desk.controls.iter().any(ends), "toys that made room come back: {:?}", desk.controls);
    desk.apply(TouchCommand::CorrectWith(Some(Method::M1.into())));
    desk.apply(TouchCommand::Plan(options));
    assert!(desk.said().contains("right index finger"), "{}", desk.said());
    assert!(desk.view().plan.is_none());
}

#[test]
fn a_check_with_a_model_lands_nearer() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.apply(TouchCommand::CorrectWith(Some(Method::M1.into())));
    assert!(desk.said().contains("no model M1"), "{}", desk.said());
    desk.start(grid(3, 3));
    desk.touch_all();
    let before = desk.view().figures.expect("touches");
    let session = Session::read(&only_session(folder.path())).expect("readable");
    let data = TouchData::of_session(&session, &rig().chain(TIP).expect("the tip"));
    let data = data.expect("can be learned from");
    let model = train(&data, Method::M1, &TrainOptions::default(), &Unattended, &mut |_| {});
    desk.models = vec![Arc::new(model.expect("trained"))];
    desk.apply(TouchCommand::Close);
    desk.apply(TouchCommand::CorrectWith(Some(Method::M1.into())));
    desk.start(PlanOptions { seed: 3, ..PlanOptions::check_reach(area(), 6, 3) });
    desk.touch_all();
    let view = desk.view();
    assert_eq!((view.phase, view.correct_with), (TouchPhase::Finished, Some(Method::M1.into())));
    assert!(view.touches.iter().all(|touch| touch.sent.distance_m(&touch.target_place) > 1e-3));
    let after = view.figures.expect("touches");
    assert!(after.mean_m < 0.3 * before.mean_m, "{} {}", after.mean_m, before.mean_m);
    assert!(view.session.expect("a session").to_string_lossy().ends_with("_check"));
    assert!(view.placement_proposal.is_some(), "that of the run before is still there");
}

#[test]
fn what_corrects_targets_is_the_same_after_a_restart() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.apply(TouchCommand::CorrectWith(Some(Correction::Effects)));
    drop(desk);
    let mut desk = Desk::new(folder.path());
    assert_eq!(desk.view().correct_with, Some(Correction::Effects));
    // Where all were taken back meanwhile there is nothing to correct with, and targets are planned all the same.
    desk.start(grid(2, 1));
    let view = desk.view();
    assert!(
        view.correct_with.is_none() && view.plan.is_some_and(|plan| plan.reachable > 0),
        "{}",
        desk.said()
    );
    desk.touch_all();
    desk.apply(TouchCommand::Close);
    desk.apply(TouchCommand::CorrectWith(None));
    drop(desk);
    let mut desk = Desk::new(folder.path());
    assert_eq!((desk.view().correct_with, desk.said().as_str()), (None, ""));

    fs::write(folder.path().join("touch_correction.json"), "{\"correct_with\": \"m9\"}").expect("written");
    let mut desk = Desk::new(folder.path());
    assert!(desk.said().contains("choose it anew in Touch"), "{}", desk.said());
    assert_eq!(desk.view().correct_with, None);
}
