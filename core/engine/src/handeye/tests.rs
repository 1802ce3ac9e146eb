//! What is kept of a look, and what is put in use.

use std::sync::Arc;
use std::time::Instant;

use plumbline_effects::RigModel;
use plumbline_effects::rig_model::{Addition, ModelEffect, numbers_of_eyes};
use plumbline_grasp::Hand;
use plumbline_handeye::hands::Miss;
use plumbline_handeye::{Figures, Outcome, SENTENCE, Tie, Tied};
use plumbline_model::robot::Rig;

use super::kept::{FILE, Kept};
use super::view::HandEyeView;
use super::work::{Context, HandEyeResult};
use super::*;
use crate::grasp::GraspAround;
use crate::grasp::view::{GateState, GraspHand, HandWaits, InHand, Need};
use crate::ground::jobs::JobId;
use crate::ground::jobs::list::JobList;
use crate::ground::notice::Notices;
use crate::ground::stage::Skipped;
use crate::ground::step::StepState;
use crate::ground::time::Time;
use crate::ground::{Moment, Workflow as _};
use command::HandEyeCommand;

fn rig() -> Arc<Rig> {
    Arc::new(Rig::built_in("nico").expect("comes with the program"))
}

/// The zero of an elbow, as a look sizes it.
fn model(rig: &Rig, before: &RigModel, value: f64) -> RigModel {
    with(rig, before, ("joint-zero", "r_elbow_y"), value)
}

/// An effect of one number, as a look with the eyes of this robot sizes it.
fn with(rig: &Rig, before: &RigModel, (id, site): (&str, &str), value: f64) -> RigModel {
    let effect = ModelEffect {
        id: id.to_owned(),
        site: site.to_owned(),
        title: String::new(),
        tip: Some("right_index_tip".to_owned()),
        shape: None,
        reference_s: 0.0,
        values: vec![value],
        covariance: vec![1e-6],
        probability: Some(0.9),
        parameters: vec![],
    };
    let mut model = before.clone();
    let addition = Addition {
        effects: vec![effect],
        screens: vec![],
        externals: vec![],
        eyes: numbers_of_eyes(rig),
        together: vec![],
        replaces: true,
        at: jiff::Timestamp::UNIX_EPOCH,
        sentence: SENTENCE.to_owned(),
        sessions: vec!["touches".to_owned()],
        version: String::new(),
        gap: None,
    };
    model.add(rig, addition).expect("it fits");
    model
}

fn tied(model: RigModel) -> Tied {
    let miss = |off_m: f64| Miss { at_m: [0.3, 0.0], off_m: Some([off_m, 0.0]) };
    let figures = Figures {
        looked: 12,
        found: 12,
        before_m: Some(0.012),
        after_m: Some(0.0015),
        before: vec![miss(0.012)],
        after: vec![miss(0.0015)],
    };
    let other = Some((Hand::Left, Outcome::Stays("it was not found".to_owned())));
    Tied { tie: Tie::default(), model, touched: (Hand::Right, figures), other }
}

#[test]
fn what_was_accepted_is_read_again_and_holds_for_the_model_that_it_gave_alone() {
    let rig = rig();
    let nominal = RigModel::nominal(&rig);
    let tied = tied(model(&rig, &nominal, 0.02));
    let kept = Kept::of(&tied, jiff::Timestamp::UNIX_EPOCH);
    let folder = tempfile::tempdir().expect("a folder for the test");
    let file = folder.path().join(FILE);
    assert_eq!(Kept::read(&file).expect("nothing is no error"), None);
    kept.write(&file).expect("written");
    assert_eq!(Kept::read(&file).expect("read").as_ref(), Some(&kept));
    let summary = kept.summary();
    assert_eq!(summary.error_m(), Some([0.012, 0.0015]));
    assert_eq!(summary.hands[1].1, Outcome::Stays("it was not found".to_owned()));
    assert!(kept.is_in(&tied.model));
    assert!(!kept.is_in(&nominal) && !kept.is_in(&model(&rig, &nominal, 0.021)));
    // Written and read as the model in use is.
    crate::rig_models::save(folder.path(), &tied.model, &rig).expect("written");
    assert!(kept.is_in(&crate::rig_models::load(folder.path(), &rig).expect("read")));
}

#[test]
fn a_file_that_is_something_else_is_said() {
    let folder = tempfile::tempdir().expect("a folder for the test");
    let file = folder.path().join(FILE);
    for text in [
        "{",
        "[]",
        r#"{"format":9,"at":"2026-05-01T10:00:00Z","tie":{"body":null,"screen":null,"table":null},"hands":[],"gave":[]}"#,
    ] {
        std::fs::write(&file, text).expect("written");
        let said = Kept::read(&file).expect_err("no look").to_string();
        assert!(said.contains("does not say how arms and eyes were tied"), "{said}");
    }
}

/// A robot of which nothing is calibrated.
fn around(rig: &Arc<Rig>, added: &Arc<RigModel>) -> HandEyeAround {
    let grasp = GraspAround::bare(rig);
    HandEyeAround {
        grasp,
        added: Some(added.clone()),
        is_changing: false,
        touches: None,
        sessions: "lab/sessions".into(),
        held: None,
        waits: None,
        twin: None,
    }
}

/// The workflow, and what it told.
struct Desk {
    room: HandEyeWorkflow,
    around: HandEyeAround,
    notices: Notices,
    jobs: JobList,
}

impl Desk {
    fn new(rig: &Arc<Rig>, added: &Arc<RigModel>, folder: &std::path::Path) -> Self {
        let room = HandEyeWorkflow::new(folder);
        Self { room, around: around(rig, added), notices: Notices::default(), jobs: JobList::default() }
    }

    fn with(&mut self, act: impl FnOnce(&mut HandEyeWorkflow, &HandEyeAround, &mut Context<'_>)) {
        let mut asked = vec![];
        let mut context = Context::new(&mut self.notices, &mut self.jobs, Time::now(), &mut asked);
        act(&mut self.room, &self.around, &mut context);
    }

    fn tell(&mut self, command: HandEyeCommand) -> String {
        self.with(|room, around, context| room.apply(command, around, context));
        let notices = self.notices.view();
        notices.last().map_or_else(String::new, |notice| notice.text.clone())
    }

    fn view(&mut self) -> Arc<HandEyeView> {
        let moment = Moment { now: Instant::now(), skipped: Skipped::default() };
        self.room.view(&self.around, &moment)
    }
}

#[test]
fn what_lacks_is_said_before_anything_moves_and_nothing_is_accepted_that_was_not_looked_at() {
    let (rig, folder) = (rig(), tempfile::tempdir().expect("a folder for the test"));
    let nominal = Arc::new(RigModel::nominal(&rig));
    let mut desk = Desk::new(&rig, &nominal, folder.path());
    let view = desk.view();
    assert!(view.trouble().is_some_and(|why| why.contains("No robot is connected")), "{:?}", view.gates);
    let shut = |of: Need| view.gates.iter().any(|gate| gate.of == of && gate.state == GateState::Shut);
    assert!(shut(Need::Places) && shut(Need::Touches), "{:?}", view.gates);
    assert!(desk.tell(HandEyeCommand::Look).contains("No robot is connected"));
    assert!(desk.tell(HandEyeCommand::Accept).contains("nothing to accept"));
    desk.around.is_changing = true;
    assert!(desk.tell(HandEyeCommand::Accept).contains("is being changed just now"));
    assert!(desk.tell(HandEyeCommand::End).contains("Nothing is under way"));
    assert!(!desk.view().is_looking && desk.room.take_accepted().is_none());
}

/// Each hand is opened to be looked at.
#[test]
fn what_is_in_a_hand_has_to_leave_it_first() {
    let (rig, folder) = (rig(), tempfile::tempdir().expect("a folder for the test"));
    let mut desk = Desk::new(&rig, &Arc::new(RigModel::nominal(&rig)), folder.path());
    let of_hand = |desk: &mut Desk| desk.view().gates.iter().find(|gate| gate.of == Need::Hand).cloned();
    assert_eq!(of_hand(&mut desk), None);
    desk.around.held = Some(InHand { object: "Tomato".to_owned(), hand: GraspHand::Right });
    let said = of_hand(&mut desk).expect("it is looked at");
    assert!(said.state == GateState::Shut && said.text.contains("tomato is in the right hand"), "{said:?}");
    desk.around.held = None;
    for (waits, is_shut) in
        [(HandWaits::Around, true), (HandWaits::Carries, true), (HandWaits::InView, false)]
    {
        desk.around.waits = Some(waits);
        assert_eq!(
            of_hand(&mut desk).is_some_and(|gate| gate.state == GateState::Shut),
            is_shut,
            "{waits:?}"
        );
    }
}

#[test]
fn which_touches_lack_is_said_with_the_folder_and_a_model_that_was_not_read_is_no_lack_of_touches() {
    let (rig, folder) = (rig(), tempfile::tempdir().expect("a folder for the test"));
    let mut desk = Desk::new(&rig, &Arc::new(RigModel::nominal(&rig)), folder.path());
    let of_touches = |desk: &mut Desk| {
        let gates = desk.view().gates.clone();
        gates.iter().find(|gate| gate.of == Need::Touches).cloned().expect("it is looked at")
    };
    let said = of_touches(&mut desk);
    assert!(said.state == GateState::Shut && said.text.contains("found in lab/sessions:"), "{}", said.text);
    desk.around.touches = Some("lab/sessions/touches".into());
    assert_eq!(of_touches(&mut desk).state, GateState::Open);
    desk.around.added = None;
    let said = of_touches(&mut desk);
    assert!(said.state == GateState::Shut && !said.text.contains("touches"), "{}", said.text);
    assert!(said.text.contains("The model in use is not read yet"), "{}", said.text);
}

#[test]
fn a_model_learned_anew_makes_a_look_stale() {
    let (rig, folder) = (rig(), tempfile::tempdir().expect("a folder for the test"));
    let nominal = Arc::new(RigModel::nominal(&rig));
    let mut desk = Desk::new(&rig, &nominal, folder.path());
    assert_eq!(desk.view().step, StepState::NotDone);
    let looked = model(&rig, &nominal, 0.02);
    let kept = Box::new(Kept::of(&tied(looked.clone()), jiff::Timestamp::UNIX_EPOCH));
    let id = JobId(7);
    desk.with(|room, around, context| {
        room.work_done(id, HandEyeResult::Restored(Some(kept)), around, context);
    });
    let view = desk.view();
    assert!(view.in_use.is_none() && view.stale.is_some(), "{view:?}");
    desk.around.added = Some(Arc::new(looked));
    let view = desk.view();
    assert!(view.in_use.is_some() && view.stale.is_none() && view.step == StepState::Done, "{view:?}");
}

#[test]
fn a_look_with_eyes_that_are_not_in_use_any_more_is_stale_until_they_are_back() {
    let (rig, folder) = (rig(), tempfile::tempdir().expect("a folder for the test"));
    let nominal = Arc::new(RigModel::nominal(&rig));
    let mut desk = Desk::new(&rig, &nominal, folder.path());
    let looked = with(&rig, &nominal, ("eye-yaw", "right"), 0.004);
    let kept = Box::new(Kept::of(&tied(looked.clone()), jiff::Timestamp::UNIX_EPOCH));
    desk.with(|room, around, context| {
        room.work_done(JobId(7), HandEyeResult::Restored(Some(kept)), around, context);
    });
    desk.around.added = Some(Arc::new(looked));
    assert_eq!(desk.view().step, StepState::Done);
    let mut mounted = (*rig).clone();
    mounted.eyes.head_from_left.isometry.translation.vector.x += 0.002;
    let own = std::mem::replace(
        &mut desk.around.grasp.model,
        Arc::new(plumbline_effects::RobotModel::nominal(Arc::new(mounted))),
    );
    assert!(desk.view().stale.as_ref().is_some_and(|why| why.contains("another calibration or mount")));
    desk.around.grasp.model = own;
    assert_eq!(desk.view().step, StepState::Done);
}
