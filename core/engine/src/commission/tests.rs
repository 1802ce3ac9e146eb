//! The workflow driven by what its neighbors know, its file written and read on the spot.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use plumbline_model::Unattended;
use plumbline_model::touch_plan::Purpose;

use super::command::CommissionCommand;
use super::kept::FILE;
use super::view::{CommissionDone, CommissionFigure, CommissionState, CommissionStep, CommissionView};
use super::work::Context;
use super::{CommissionAround, CommissionWorkflow, Found, InUse};
use crate::Skipped;
use crate::ground::jobs::JobError;
use crate::ground::jobs::list::JobList;
use crate::ground::notice::Notices;
use crate::ground::{Asked, LongWork as _, Moment, Time, Workflow as _};
use crate::touch::RunStanding;

struct Lab {
    folder: tempfile::TempDir,
    room: CommissionWorkflow,
    around: CommissionAround,
    notices: Notices,
    jobs: JobList,
    time: Time,
}

impl Lab {
    fn new() -> Self {
        Self::on(tempfile::tempdir().expect("a temporary folder"), Time::now())
    }

    /// The program started on what is kept in a folder.
    fn on(folder: tempfile::TempDir, time: Time) -> Self {
        let room = CommissionWorkflow::new(folder.path());
        let mut lab = Self {
            room,
            folder,
            around: CommissionAround::default(),
            notices: Notices::default(),
            jobs: JobList::default(),
            time,
        };
        lab.with(|room, around, context| room.restore(around, context));
        lab
    }

    /// The program ends, and is started again so much later.
    fn again(self, later: Duration) -> Self {
        let around = self.around.clone();
        let mut lab = Self::on(self.folder, self.time.after(later));
        lab.around = around;
        lab
    }

    fn with(&mut self, act: impl FnOnce(&mut CommissionWorkflow, &CommissionAround, &mut Context<'_>)) {
        let mut asked = vec![];
        let Self { room, around, notices, jobs, time, .. } = self;
        act(room, around, &mut Context::new(notices, jobs, *time, &mut asked));
        while !asked.is_empty() {
            for one in std::mem::take(&mut asked) {
                let Asked::Start(id, work) = one else { panic!("commissioning only reads and writes") };
                let outcome = work.run(&Unattended);
                let mut context = Context::new(notices, jobs, *time, &mut asked);
                match outcome {
                    Ok(result) => room.work_done(id, result, around, &mut context),
                    Err(JobError::Failed(why)) => room.work_ended(id, Some(&why), around, &mut context),
                    Err(JobError::Cancelled(_)) => room.work_ended(id, None, around, &mut context),
                }
            }
        }
    }

    fn tell(&mut self, command: CommissionCommand) -> Arc<CommissionView> {
        self.with(|room, around, context| room.apply(command, around, context));
        self.view()
    }

    /// So much time passes, and the robot has something new.
    fn after_s(&mut self, seconds: u64) -> Arc<CommissionView> {
        self.time = self.time.after(Duration::from_secs(seconds));
        self.with(|room, around, context| room.look(around, context));
        self.view()
    }

    fn view(&mut self) -> Arc<CommissionView> {
        let moment = Moment { now: self.time.instant, skipped: Skipped::default() };
        self.room.view(&self.around, &moment)
    }

    fn made(&self, figure: CommissionFigure) -> CommissionDone {
        CommissionDone { at: Some(self.time.day), figure }
    }

    fn calibrated(&mut self) {
        self.around.eyes = Some(self.made(CommissionFigure::Pixels(0.1)));
        self.around.mount = Some(self.made(CommissionFigure::Pixels(0.2)));
        self.around.screen =
            Some(self.made(CommissionFigure::Placed { rms_m: 1e-3, touches: 8, is_doubtful: false }));
    }

    fn run(&self, name: &str, purpose: Purpose, contacts: usize, is_finished: bool) -> RunStanding {
        RunStanding {
            session: PathBuf::from(name),
            started: self.time.day,
            purpose,
            is_finished,
            touched: contacts,
            contacts,
            mean_m: Some(2e-3),
        }
    }

    fn found(&self, session: &str, is_open: bool) -> Found {
        let done = self.made(CommissionFigure::Effects(vec!["joint zero of the elbow".to_owned()]));
        Found { sessions: vec![PathBuf::from(session)], is_open, done }
    }
}

const SEEN: CommissionFigure = CommissionFigure::Seen { before_m: 0.012, after_m: 0.002 };
const START: CommissionCommand = CommissionCommand::Start { anew: false };

#[test]
fn steps_come_in_their_order_and_the_last_makes_it_done() {
    let mut lab = Lab::new();
    assert!(lab.view().is_untouched() && !lab.view().is_on);
    let view = lab.tell(START);
    assert!(view.is_on && !view.is_untouched());
    assert_eq!(view.now(), Some(CommissionStep::Eyes));
    assert_eq!(view.steps[7].state, CommissionState::Waits(CommissionStep::Eyes));

    lab.calibrated();
    assert_eq!(lab.after_s(1).now(), Some(CommissionStep::Touches));
    lab.around.run = Some(lab.run("touches", Purpose::Train, 3, false));
    assert_eq!(lab.after_s(1).now(), Some(CommissionStep::Touches), "a run under way is not done");
    lab.around.run = Some(lab.run("touches", Purpose::Train, 24, true));
    assert_eq!(lab.after_s(1).now(), Some(CommissionStep::Effects));
    lab.around.found = Some(lab.found("earlier touches", false));
    assert_eq!(lab.after_s(1).now(), Some(CommissionStep::Effects), "these touches were not looked at");
    lab.around.found = Some(lab.found("touches", true));
    assert_eq!(lab.after_s(1).now(), Some(CommissionStep::Effects), "what was found is not added");
    lab.around.found = Some(lab.found("touches", false));
    assert_eq!(lab.after_s(1).now(), Some(CommissionStep::Hands));
    lab.around.hands = Some(lab.made(SEEN));
    assert_eq!(lab.after_s(1).now(), Some(CommissionStep::Check));
    lab.around.run = Some(lab.run("check", Purpose::Check, 20, true));
    let view = lab.after_s(1);
    assert_eq!(view.now(), Some(CommissionStep::Grasp));
    let missed = CommissionFigure::Missed { mean_m: Some(2e-3), touches: 20 };
    assert_eq!(view.of(CommissionStep::Check).map(|done| &done.figure), Some(&missed));
    lab.around.held = Some(lab.made(CommissionFigure::Held("Tomato".to_owned())));
    let view = lab.after_s(1);
    assert!(view.is_done() && view.now().is_none());
    assert_eq!(view.spent.touches, 21, "of 24 touches 3 were there when they were seen first");
}

#[test]
fn time_touches_and_views_are_counted_while_the_program_is_open() {
    let mut lab = Lab::new();
    lab.around.views = 5;
    lab.after_s(100);
    assert_eq!(lab.view().spent, super::view::CommissionSpent::default(), "nothing was begun");
    lab.tell(START);
    lab.around.views = 12;
    lab.around.run = Some(lab.run("touches", Purpose::Train, 0, false));
    lab.after_s(60);
    lab.around.run = Some(lab.run("touches", Purpose::Train, 4, false));
    let view = lab.after_s(65);
    assert_eq!((view.spent.time.as_secs(), view.spent.touches, view.spent.views), (125, 4, 7));

    let mut lab = lab.again(Duration::from_secs(86_400));
    let view = lab.view();
    assert!(view.is_on && view.began.is_some());
    lab.around.views = 0;
    lab.after_s(1);
    lab.around.views = 2;
    lab.around.run = Some(lab.run("touches", Purpose::Train, 10, false));
    let view = lab.after_s(9);
    assert_eq!((view.spent.touches, view.spent.views), (10, 9), "no touch is counted twice");
    assert!((125..=135).contains(&view.spent.time.as_secs()), "the night is not counted: {view:?}");

    let view = lab.tell(CommissionCommand::Leave);
    let spent = view.spent;
    assert!(!view.is_on);
    assert_eq!(lab.after_s(1000).spent, spent, "nobody is led, so nothing is counted");
    assert!(lab.tell(START).is_on);
    assert_eq!(lab.view().began, view.began, "it goes on");
}

#[test]
fn done_anew_counts_from_now_on() {
    let mut lab = Lab::new();
    lab.calibrated();
    lab.around.run = Some(lab.run("touches", Purpose::Train, 24, true));
    lab.around.found = Some(lab.found("touches", false));
    lab.around.hands = Some(lab.made(SEEN));
    lab.around.held = Some(lab.made(CommissionFigure::Held("Tomato".to_owned())));
    assert!(!lab.view().is_untouched(), "what was done without being led is done");
    lab.time = lab.time.after(Duration::from_secs(3600));
    assert_eq!(lab.tell(START).now(), Some(CommissionStep::Check));
    lab.time = lab.time.after(Duration::from_secs(3600));
    let view = lab.tell(CommissionCommand::Start { anew: true });
    assert_eq!(view.now(), Some(CommissionStep::Eyes));
    assert!(view.steps.iter().all(|step| step.done().is_none()), "{view:?}");
    lab.calibrated();
    assert_eq!(lab.after_s(1).now(), Some(CommissionStep::Touches));
}

#[test]
fn what_is_looked_for_later_takes_nothing_back_but_what_changes_in_the_model_does() {
    let mut lab = Lab::new();
    lab.tell(START);
    lab.calibrated();
    lab.around.run = Some(lab.run("touches", Purpose::Train, 24, true));
    lab.after_s(1);
    let zero = InUse { names: vec!["joint-zero@elbow".to_owned()], told: vec!["Elbow: zero".to_owned()] };
    lab.around.effects = zero.clone();
    lab.around.found = Some(lab.found("touches", false));
    lab.around.hands = Some(lab.made(SEEN));
    lab.after_s(1);
    lab.around.run = Some(lab.run("check", Purpose::Check, 20, true));
    assert_eq!(lab.after_s(1).now(), Some(CommissionStep::Grasp));

    lab.around.found = Some(lab.found("touches", false));
    assert_eq!(lab.after_s(5).now(), Some(CommissionStep::Grasp), "the same was found once more");
    lab.around.found = Some(lab.found("touches", true));
    assert_eq!(lab.after_s(5).now(), Some(CommissionStep::Grasp), "what was found is not in use");
    lab.around.found = None;
    assert_eq!(lab.after_s(5).now(), Some(CommissionStep::Grasp), "newer touches made the finding old");

    lab.around.effects = InUse::default();
    assert_eq!(lab.after_s(5).now(), Some(CommissionStep::Effects), "it was taken back");
    lab.around.effects = zero;
    let view = lab.after_s(5);
    assert_eq!(view.now(), Some(CommissionStep::Grasp), "and put in use again");
    let effects = CommissionFigure::Effects(vec!["Elbow: zero".to_owned()]);
    assert_eq!(view.of(CommissionStep::Effects).map(|done| &done.figure), Some(&effects));

    lab.around.effects.names.push("backlash@elbow".to_owned());
    lab.around.found = Some(lab.found("check", false));
    assert_eq!(lab.after_s(5).now(), Some(CommissionStep::Check), "another model was not checked");
    let mut lab = lab.again(Duration::from_secs(60));
    lab.around.found = None;
    assert_eq!(lab.after_s(1).now(), Some(CommissionStep::Check), "the same after a restart");

    // Also once all was done, and however long ago it was found.
    lab.around.run = Some(lab.run("another check", Purpose::Check, 20, true));
    lab.after_s(1);
    lab.around.held = Some(lab.made(CommissionFigure::Held("Tomato".to_owned())));
    assert!(lab.after_s(5).is_done());
    lab.around.found = Some(Found { is_open: false, ..lab.found("check", false) });
    lab.time = lab.time.after(Duration::from_secs(60));
    lab.around.effects.names.push("stick@elbow".to_owned());
    assert_eq!(lab.after_s(1).now(), Some(CommissionStep::Check), "added long after it was found");
}

#[test]
fn a_file_of_an_earlier_version_goes_by_the_finding_that_is_shown() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let text = r#"{"format":1,"began":"2026-05-01T10:00:00Z","is_anew":false,"is_on":false,"spent_s":3.0,"touches":24,"views":0,"counted":{},"touched":{"session":"touches","touched":24,"mean_m":0.005,"at":"2026-05-01T10:20:00Z"},"checked":null}"#;
    std::fs::write(folder.path().join(FILE), text).expect("written");
    let mut lab = Lab::on(folder, Time::now());
    lab.calibrated();
    lab.around.hands = Some(lab.made(SEEN));
    assert_eq!(lab.view().now(), Some(CommissionStep::Effects));
    lab.around.found = Some(lab.found("touches", false));
    assert_eq!(lab.view().now(), Some(CommissionStep::Check));
}

#[test]
fn a_check_before_the_search_for_effects_says_nothing() {
    let mut lab = Lab::new();
    lab.tell(START);
    lab.calibrated();
    lab.around.run = Some(lab.run("touches", Purpose::Train, 24, true));
    lab.after_s(1);
    lab.around.run = Some(lab.run("check", Purpose::Check, 20, true));
    lab.after_s(1);
    lab.time = lab.time.after(Duration::from_secs(5));
    lab.around.found = Some(lab.found("touches", false));
    lab.around.hands = Some(lab.made(SEEN));
    assert_eq!(lab.after_s(1).now(), Some(CommissionStep::Check));
}

#[test]
fn a_check_before_the_look_at_the_hands_says_nothing() {
    let mut lab = Lab::new();
    lab.tell(START);
    lab.calibrated();
    lab.around.run = Some(lab.run("touches", Purpose::Train, 24, true));
    lab.after_s(1);
    lab.around.found = Some(lab.found("touches", false));
    lab.around.hands = Some(lab.made(SEEN));
    lab.after_s(1);
    lab.time = lab.time.after(Duration::from_secs(5));
    lab.around.run = Some(lab.run("check", Purpose::Check, 20, true));
    assert_eq!(lab.after_s(1).now(), Some(CommissionStep::Grasp));
    // Looked at anew, the model is another.
    lab.time = lab.time.after(Duration::from_secs(5));
    lab.around.hands = Some(lab.made(SEEN));
    assert_eq!(lab.after_s(1).now(), Some(CommissionStep::Check));
    lab.around.hands = None;
    assert_eq!(lab.after_s(1).now(), Some(CommissionStep::Hands));
}

#[test]
fn a_check_of_another_place_of_the_screen_says_nothing() {
    let mut lab = Lab::new();
    lab.tell(START);
    lab.calibrated();
    lab.around.run = Some(lab.run("touches", Purpose::Train, 24, true));
    lab.after_s(1);
    lab.around.found = Some(lab.found("touches", false));
    lab.around.hands = Some(lab.made(SEEN));
    lab.after_s(1);
    lab.time = lab.time.after(Duration::from_secs(5));
    lab.around.run = Some(lab.run("check", Purpose::Check, 20, true));
    assert_eq!(lab.after_s(1).now(), Some(CommissionStep::Grasp));
    let screen = lab.around.screen.take();
    let view = lab.after_s(1);
    assert!(view.now() == Some(CommissionStep::Screen) && view.of(CommissionStep::Check).is_none());
    lab.around.screen = screen;
    assert_eq!(lab.after_s(1).now(), Some(CommissionStep::Grasp), "what is used again was checked");
}

#[test]
fn a_file_that_is_something_else_is_said_and_not_written_over() {
    for (text, words) in [
        ("{", "does not say how far"),
        (r#"{"format":7}"#, "does not say how far"),
        (
            r#"{"format":1,"began":"2026-05-01T10:00:00Z","is_anew":false,"is_on":true,"spent_s":-3.0,"touches":0,"views":0,"counted":{},"touched":null,"checked":null}"#,
            "-3 s",
        ),
    ] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join(FILE), text).expect("written");
        let said = super::kept::Kept::read(&folder.path().join(FILE)).expect_err(text).to_string();
        assert!(said.contains(words) && said.contains("move it away"), "{said}");
        let mut lab = Lab::on(folder, Time::now());
        assert!(!lab.view().is_known);
        assert!(!lab.tell(START).is_on, "nothing is begun over it");
        assert_eq!(read(lab.folder.path()), text);
    }
}

fn read(folder: &Path) -> String {
    std::fs::read_to_string(folder.join(FILE)).expect("it is there")
}
