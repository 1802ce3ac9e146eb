//! The experiment's files, and the workflow driven by what the robot does.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use jiff::Timestamp;
use plumbline_grasp::{Method, Outcome, Record};
use plumbline_model::Unattended;
use plumbline_model::robot::Rig;

use super::command::TrialsCommand;
use super::view::{TrialStage, TrialsPhase, TrialsView};
use super::work::Context;
use super::{Attempt, Experiment, FORMAT, GraspNow, Judged, TrialsAround, TrialsWorkflow, store};
use crate::Skipped;
use crate::grasp::command::{GraspCommand, HandStep};
use crate::grasp::view::AttemptView;
use crate::ground::jobs::JobError;
use crate::ground::jobs::list::JobList;
use crate::ground::notice::Notices;
use crate::ground::{Asked, LongWork as _, Moment, Time, Workflow as _};
use crate::robot::RobotControl;
use crate::robot::view::{Connection, RobotView};
use crate::twin::command::TwinCommand;
use crate::twin::view::{ToyView, TwinView};

/// A world in which grasping succeeds when it is told to.
struct Lab {
    folder: tempfile::TempDir,
    room: TrialsWorkflow,
    around: TrialsAround,
    notices: Notices,
    jobs: JobList,
    time: Time,
    controls: Vec<TwinCommand>,
}

fn rig() -> Arc<Rig> {
    Arc::new(Rig::built_in("nico").expect("comes with the program"))
}

impl Lab {
    fn new(is_twin: bool) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let connection = Connection::Connected { to: "it".to_owned(), twin: is_twin };
        let around = TrialsAround {
            rig: rig(),
            robot: Arc::new(RobotView { connection, ..RobotView::default() }),
            twin: Arc::new(TwinView { running: is_twin, scenario: "lab".to_owned(), ..TwinView::default() }),
            is_twin,
            grasp: GraspNow { is_idle: true, newest: None },
            newest_pair: None,
        };
        let room = TrialsWorkflow::new(folder.path());
        let mut lab = Self {
            folder,
            room,
            around,
            notices: Notices::default(),
            jobs: JobList::default(),
            time: Time::now(),
            controls: vec![],
        };
        lab.with(|room, around, context| room.restore(around, context));
        lab.stands_at(0.08);
        lab
    }

    fn with(&mut self, act: impl FnOnce(&mut TrialsWorkflow, &TrialsAround, &mut Context<'_>)) {
        let mut asked = vec![];
        let Self { room, around, notices, jobs, time, controls, .. } = self;
        act(room, around, &mut Context::new(notices, jobs, *time, &mut asked));
        while !asked.is_empty() {
            for one in std::mem::take(&mut asked) {
                match one {
                    Asked::Start(id, work) => {
                        let outcome = work.run(&Unattended);
                        let mut context = Context::new(notices, jobs, *time, &mut asked);
                        match outcome {
                            Ok(result) => room.work_done(id, result, around, &mut context),
                            Err(JobError::Failed(why)) => {
                                room.work_ended(id, Some(&why), around, &mut context)
                            }
                            Err(JobError::Cancelled(_)) => room.work_ended(id, None, around, &mut context),
                        }
                    }
                    Asked::Control(RobotControl::Twin(command)) => controls.push(command),
                    other => panic!("an experiment asks for nothing else: {other:?}"),
                }
            }
        }
    }

    fn tell(&mut self, command: TrialsCommand) -> Arc<TrialsView> {
        self.with(|room, around, context| room.apply(command, around, context));
        self.lay();
        self.view()
    }

    /// The eyes see what there is then.
    fn after_s(&mut self, seconds: f64) -> Arc<TrialsView> {
        self.around.newest_pair = Some(self.time.after(Duration::from_secs_f64(seconds)).instant);
        self.blindly_after_s(seconds)
    }

    fn blindly_after_s(&mut self, seconds: f64) -> Arc<TrialsView> {
        self.time = self.time.after(Duration::from_secs_f64(seconds));
        self.with(|room, around, context| room.step(around, context));
        self.lay();
        self.view()
    }

    /// What was to be laid somewhere lies there.
    fn lay(&mut self) {
        let Some(TwinCommand::PlaceToy { x_m, y_m, .. }) = self.controls.last() else { return };
        let (x_m, y_m) = (*x_m, *y_m);
        for toy in &mut Arc::make_mut(&mut self.around.twin).toys {
            toy.place = toy.place.map(|at| plumbline_model::frame::Point::new(x_m, y_m, at.coords.z));
        }
    }

    fn view(&mut self) -> Arc<TrialsView> {
        let moment = Moment { now: self.time.instant, skipped: Skipped::default() };
        self.room.view(&self.around, &moment)
    }

    /// So high the tomato stands in the scene, m.
    fn stands_at(&mut self, z_m: f64) {
        let tomato = ToyView {
            name: "tomato".to_owned(),
            place: Some(plumbline_model::frame::Point::new(0.3, -0.1, z_m)),
            radius_m: 0.03,
            rgb: [200, 40, 40],
        };
        Arc::make_mut(&mut self.around.twin).toys = vec![tomato];
        self.lay();
    }

    /// An attempt has ended so.
    fn grasped(&mut self, name: &str, outcome: Outcome) {
        let folder = self.folder.path().join("grasps").join(name);
        std::fs::create_dir_all(&folder).expect("made");
        let mut record = Record::new(Method::M5, "Tomato", Timestamp::UNIX_EPOCH, "nominal".to_owned());
        record.outcome = Some(outcome.clone());
        record.seconds = Some(20.0);
        let text = serde_json::to_string(&record).expect("plain data");
        std::fs::write(folder.join("record.json"), text).expect("written");
        self.around.grasp.newest = Some(AttemptView {
            name: name.to_owned(),
            folder,
            began: Timestamp::UNIX_EPOCH,
            method: Method::M5,
            hand: plumbline_grasp::Hand::Right,
            model: "as described".to_owned(),
            object: "Tomato".to_owned(),
            outcome: Some(outcome),
            reached: None,
            told: None,
            slipped_after: None,
            alignment_m: None,
            closed_at_m: None,
            seconds: Some(20.0),
        });
    }

    fn wishes(&mut self) -> Vec<GraspCommand> {
        self.room.take_wishes()
    }
}

fn begin(positions: usize, attempts: usize) -> TrialsCommand {
    let positions_m = [[0.3, -0.1], [0.3, -0.2]][..positions].to_vec();
    TrialsCommand::Begin {
        methods: vec![Method::M5],
        attempts,
        positions_m: Some(positions_m),
        object: "tomato".to_owned(),
        seed: 1,
    }
}

fn stage(view: &TrialsView) -> Option<TrialStage> {
    match view.phase {
        TrialsPhase::Running { doing, .. } => Some(doing),
        _ => None,
    }
}

#[test]
fn on_the_twin_it_goes_through_all_attempts_by_itself() {
    let mut lab = Lab::new(true);
    let view = lab.tell(begin(2, 1));
    assert_eq!(stage(&view), Some(TrialStage::Laying), "{view:?}");
    let Some(TwinCommand::PlaceToy { toy, x_m, y_m }) = lab.controls.last() else {
        panic!("{:?}", lab.controls)
    };
    assert!(toy == "tomato" && (x_m - 0.3).abs() < 0.012 && (y_m + 0.1).abs() < 0.012, "{x_m} {y_m}");
    assert!(lab.wishes().is_empty(), "it comes to rest first");
    assert_eq!(stage(&lab.after_s(2.0)), Some(TrialStage::Grasping));
    let wishes = lab.wishes();
    assert_eq!((&wishes[0], wishes.last()), (&GraspCommand::Method(Method::M5), Some(&GraspCommand::Grasp)));
    assert!(lab.room.is_under_way(), "grasping knows whose attempt it is");
    lab.around.grasp.is_idle = false;
    assert_eq!(stage(&lab.after_s(20.0)), Some(TrialStage::Grasping));
    lab.grasped("first", Outcome::Success);
    let tracks = "t_s,head_z_rad,head_z_commanded_rad,step\n0.000,0.0100,0.0000,lift\n";
    std::fs::write(lab.folder.path().join("grasps/first/tracks.csv"), tracks).expect("written");
    lab.stands_at(0.19);
    lab.around.grasp.is_idle = true;
    assert_eq!(stage(&lab.after_s(0.1)), Some(TrialStage::Judging));
    assert_eq!(stage(&lab.after_s(8.0)), Some(TrialStage::Judging), "it may still slip out");
    let view = lab.after_s(3.0);
    assert_eq!(stage(&view), Some(TrialStage::Clearing));
    let shown = view.shown.clone().expect("one is shown");
    assert_eq!((shown.made, shown.all, shown.page.methods[0].positions[0].successes), (1, 2, 1));
    assert!(shown.folder.join("report.html").exists() && shown.folder.join("attempts.csv").exists());
    let kept = std::fs::read_to_string(shown.folder.join("attempts/00000-m5.tracks.csv"));
    assert_eq!(kept.expect("beside its attempt"), tracks);
    // The hand is emptied, then comes the second place.
    lab.after_s(0.1);
    assert_eq!(lab.wishes(), [GraspCommand::Hand(HandStep::Open)]);
    lab.after_s(3.0);
    assert_eq!(lab.wishes(), [GraspCommand::Hand(HandStep::Home)]);
    assert_eq!(stage(&lab.after_s(3.0)), Some(TrialStage::Laying));
    lab.stands_at(0.08);
    lab.after_s(2.0);
    lab.wishes();
    // It took itself for good; the scene shows that it still stands.
    lab.grasped("second", Outcome::Success);
    lab.after_s(0.1);
    let view = lab.after_s(11.0);
    let shown = view.shown.clone().expect("one is shown");
    assert_eq!((shown.made, shown.page.methods[0].positions[1].successes), (2, 0));
    for _ in 0..3 {
        lab.after_s(3.0);
        lab.wishes();
    }
    assert_eq!(lab.view().phase, TrialsPhase::Idle);
    assert!(!lab.room.is_under_way());
}

#[test]
fn what_was_laid_down_is_grasped_once_the_eyes_have_seen_it_there() {
    let mut lab = Lab::new(true);
    lab.tell(begin(1, 1));
    let rolled_away = |lab: &mut Lab, by_m: f64| {
        let place = Arc::make_mut(&mut lab.around.twin).toys[0].place.as_mut().expect("it is there");
        place.coords.x += by_m;
    };
    // The twin has not laid it down yet, then the eyes have not looked again.
    rolled_away(&mut lab, 0.1);
    lab.around.newest_pair = Some(lab.time.after(Duration::from_secs(2)).instant);
    lab.time = lab.time.after(Duration::from_secs(2));
    lab.with(|room, around, context| room.step(around, context));
    assert_eq!(stage(&lab.view()), Some(TrialStage::Laying));
    rolled_away(&mut lab, -0.1);
    lab.around.newest_pair = Some(lab.time.instant - Duration::from_secs(1));
    assert_eq!(stage(&lab.blindly_after_s(2.0)), Some(TrialStage::Laying));
    assert!(lab.wishes().is_empty());
    assert_eq!(stage(&lab.after_s(0.5)), Some(TrialStage::Grasping));
    assert_eq!(lab.wishes().len(), 4);

    // Eyes that give nothing are not waited for forever: grasping says so.
    let mut lab = Lab::new(true);
    lab.tell(begin(1, 1));
    assert_eq!(stage(&lab.blindly_after_s(9.0)), Some(TrialStage::Laying));
    assert_eq!(stage(&lab.blindly_after_s(3.0)), Some(TrialStage::Grasping));
}

#[test]
fn it_goes_on_after_a_restart_and_what_was_broken_off_is_made_again() {
    let mut lab = Lab::new(true);
    lab.tell(begin(2, 1));
    lab.after_s(2.0);
    lab.wishes();
    let why = "STOP was pressed.".to_owned();
    lab.grasped("halted", Outcome::Failed { failure: plumbline_grasp::Failure::Halted, why });
    lab.after_s(0.1);
    let view = lab.after_s(2.0);
    let TrialsPhase::Paused { why } = &view.phase else { panic!("{view:?}") };
    assert!(why.contains("STOP was pressed") && why.contains("made again"), "{why}");
    let folder = view.shown.clone().expect("one is shown").folder.clone();

    // The program ends and is started again.
    let mut again = TrialsWorkflow::new(lab.folder.path());
    std::mem::swap(&mut lab.room, &mut again);
    lab.with(|room, around, context| room.restore(around, context));
    let view = lab.view();
    assert_eq!((view.earlier.len(), view.earlier[0].made, view.earlier[0].all), (1, 0, 2));
    let view = lab.tell(TrialsCommand::Open { folder });
    assert_eq!(
        (view.phase.clone(), view.shown.is_some()),
        (TrialsPhase::Idle, true),
        "opening moves nothing"
    );
    assert_eq!(stage(&lab.tell(TrialsCommand::GoOn)), Some(TrialStage::Laying));
}

#[test]
fn an_attempt_in_which_the_eyes_were_lost_is_no_failure_of_the_method_and_is_made_again() {
    let mut lab = Lab::new(true);
    lab.tell(begin(2, 1));
    lab.after_s(2.0);
    lab.wishes();
    let why = "the eyes give no pairs: the left camera was unplugged; plug it in again".to_owned();
    lab.grasped("blind", Outcome::Failed { failure: plumbline_grasp::Failure::EyesLost, why });
    lab.after_s(0.1);
    let view = lab.after_s(2.0);
    let TrialsPhase::Paused { why } = &view.phase else { panic!("{view:?}") };
    assert!(why.contains("was unplugged") && why.contains("made again"), "{why}");
    assert_eq!(view.shown.as_ref().expect("one is shown").made, 0, "it does not count");
    assert_eq!(stage(&lab.tell(TrialsCommand::GoOn)), Some(TrialStage::Laying));
}

#[test]
fn on_the_robot_a_person_lays_it_down_and_has_the_last_word() {
    let mut lab = Lab::new(false);
    let view = lab.tell(begin(1, 1));
    let TrialsPhase::Asks { at_m, .. } = view.phase else { panic!("{view:?}") };
    assert_eq!(at_m, [0.3, -0.1], "where it belongs");
    assert!(lab.controls.is_empty());
    lab.after_s(60.0);
    assert!(lab.wishes().is_empty(), "nothing moves before it is laid down");
    lab.tell(TrialsCommand::Placed);
    lab.after_s(2.0);
    assert_eq!(lab.wishes().len(), 4);
    lab.grasped("first", Outcome::Success);
    lab.after_s(0.1);
    let view = lab.after_s(30.0);
    assert!(matches!(view.phase, TrialsPhase::WaitsForWord { .. }), "{view:?}");
    if let Some(newest) = &mut lab.around.grasp.newest {
        newest.told = Some(false);
    }
    let shown = lab.after_s(0.1).shown.clone().expect("one is shown");
    assert_eq!((shown.made, shown.page.methods[0].positions[0].successes), (1, 0));
    assert_eq!(shown.experiment.twin, format!("robot {}", rig().name));
}

#[test]
fn what_cannot_be_begun_is_said() {
    let mut lab = Lab::new(true);
    let said = |lab: &mut Lab, command| {
        let view = lab.tell(command);
        assert!(view.shown.is_none() && view.phase == TrialsPhase::Idle, "{view:?}");
        lab.notices.view().last().expect("it was said").text.clone()
    };
    assert!(said(&mut lab, begin(0, 1)).contains("at most 2000"));
    assert!(said(&mut lab, begin(2, 5000)).contains("at most 2000"));
    assert!(said(&mut lab, TrialsCommand::GoOn).contains("No experiment is shown"));
    assert!(said(&mut lab, TrialsCommand::Placed).contains("does not wait"));
    let folder = PathBuf::from("/nowhere");
    lab.tell(TrialsCommand::Open { folder });
    assert!(lab.view().shown.is_none());
}

#[test]
fn a_scatter_depends_on_seed_and_number_alone() {
    let experiment = |seed| Experiment {
        format: FORMAT,
        twin: "lab".to_owned(),
        methods: vec![Method::M1, Method::M5],
        attempts: 2,
        positions_m: vec![[0.3, 0.0], [0.2, 0.1]],
        hand: plumbline_grasp::HandChoice::Auto,
        object: "Tomato".to_owned(),
        seed,
        lab: None,
    };
    let (first, other) = (experiment(1), experiment(2));
    let trials: Vec<_> = first.trials().collect();
    assert_eq!(trials.len(), 8);
    assert!(trials.iter().enumerate().all(|(i, trial)| trial.number == i));
    assert_eq!(first.placed(&trials[0]), first.placed(&trials[1]), "all methods get the same");
    assert_ne!(first.placed(&trials[0]), first.placed(&trials[2]));
    assert_ne!(first.placed(&trials[0]), other.placed(&trials[0]));
}

#[test]
fn parts_are_put_together_unless_they_disagree() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let experiment = Experiment {
        format: FORMAT,
        twin: "lab".to_owned(),
        methods: vec![Method::M5],
        attempts: 2,
        positions_m: vec![[0.3, 0.0]],
        hand: plumbline_grasp::HandChoice::Auto,
        object: "Tomato".to_owned(),
        seed: 1,
        lab: None,
    };
    let trials: Vec<_> = experiment.trials().collect();
    let attempt = |k: usize, lifted| {
        let record = Record::new(Method::M5, "Tomato", Timestamp::UNIX_EPOCH, "nominal".to_owned());
        let judged = Judged { lifted, ..Judged::default() };
        Attempt { trial: trials[k], placed_m: [0.3, 0.0], record, judged }
    };
    let part = |name: &str, attempts: &[Attempt]| {
        let part = folder.path().join(name);
        store::begin(&part, &experiment).expect("begun");
        attempts.iter().for_each(|attempt| store::keep(&part, attempt).expect("kept"));
        part
    };
    let (a, b) = (part("a", &[attempt(0, true)]), part("b", &[attempt(1, false)]));
    let whole = folder.path().join("whole");
    assert_eq!(store::merge(&[a.clone(), b.clone()], &whole).expect("one experiment"), experiment);
    let summary = store::conclude(&whole, &experiment, &rig()).expect("written");
    assert_eq!((summary.missing, summary.methods["m5"].successes, summary.methods["m5"].attempts), (0, 1, 2));
    let of_lab = |name: &str| {
        let part = folder.path().join(name);
        store::begin(&part, &Experiment { lab: Some(name.to_owned()), ..experiment.clone() }).expect("begun");
        part
    };
    let (one, another) = (of_lab("one lab"), of_lab("another lab"));
    let said = store::merge(&[one.clone(), another], &folder.path().join("mixed")).expect_err("of two labs");
    assert!(said.to_string().contains("experiment"), "{said}");
    // A part that does not tell its lab is taken for one of the same.
    store::merge(&[a.clone(), one], &folder.path().join("old and new")).expect("one experiment");
    let other = part("other", &[attempt(1, true)]);
    let said = store::merge(&[b, other], &folder.path().join("torn")).expect_err("they disagree").to_string();
    assert!(said.contains("says something else"), "{said}");
}

#[test]
fn a_file_of_an_experiment_that_cannot_be_is_refused_with_what_is_wrong() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let sound = Experiment {
        hand: plumbline_grasp::HandChoice::Auto,
        format: FORMAT,
        twin: "lab".to_owned(),
        methods: vec![Method::M5],
        attempts: 2,
        positions_m: vec![[0.3, 0.0]],
        object: "Tomato".to_owned(),
        seed: 1,
        lab: None,
    };
    let write = |experiment: &Experiment| {
        let text = serde_json::to_string(experiment).expect("plain data");
        std::fs::write(folder.path().join("experiment.json"), text).expect("written");
    };
    for (wrong, why) in [
        (Experiment { attempts: usize::MAX, ..sound.clone() }, "more than 20000 attempts"),
        (Experiment { attempts: 65_535, ..sound.clone() }, "more than 20000 attempts"),
        (Experiment { positions_m: vec![[0.3, 4e9]], ..sound.clone() }, "a position at 0.3, 4000000000 m"),
        (Experiment { object: "o".repeat(70_000), ..sound.clone() }, "a name of more than 200 letters"),
    ] {
        write(&wrong);
        let said = store::read_experiment(folder.path()).expect_err("it cannot be").to_string();
        assert!(said.contains(why) && said.contains("delete it"), "{said}");
    }
    // An attempt at a position that the experiment has not.
    write(&sound);
    let attempts = folder.path().join("attempts");
    std::fs::create_dir(&attempts).expect("made");
    let record = Record::new(Method::M5, "Tomato", Timestamp::UNIX_EPOCH, "nominal".to_owned());
    let trial = super::Trial { number: 0, position: 7, attempt: 0, method: Method::M5 };
    let attempt = Attempt { trial, placed_m: [0.3, 0.0], record, judged: Judged::default() };
    std::fs::write(attempts.join("00000-m5.json"), serde_json::to_string(&attempt).expect("plain data"))
        .expect("written");
    let said = store::attempts(folder.path(), &sound).expect_err("it cannot be").to_string();
    assert!(said.contains("position 7"), "{said}");
}
