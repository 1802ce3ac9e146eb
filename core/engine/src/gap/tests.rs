//! The workflow driven by commands, its work done on the spot.

use std::path::PathBuf;
use std::sync::Arc;

use plumbline_model::Unattended;
use plumbline_report::sample;

use super::command::GapCommand;
use super::sessions::with_finished;
use super::store::{KeptFinding, KeptSession, Store};
use super::view::GapView;
use crate::Skipped;
use crate::command::Command;
use crate::ground::jobs::{JobError, Outcome};
use crate::ground::step::StepState;
use crate::models::tests::{made_up_session, nico};
use crate::state::{Action, State};

/// The engine's state on a folder of its own, with one session of touches.
struct Lab {
    folder: tempfile::TempDir,
    state: State,
}

impl Lab {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("temporary folder");
        made_up_session(&nico()).write(&Self::session_in(folder.path())).expect("written");
        Self::on(folder)
    }

    fn session_in(folder: &std::path::Path) -> PathBuf {
        folder.join("sessions/2026-05-01T10-00-00_touch")
    }

    fn on(folder: tempfile::TempDir) -> Self {
        let state = State::new(folder.path());
        let mut lab = Self { folder, state };
        lab.work();
        lab
    }

    /// A finding that names two effects, made of the session as it is now.
    fn with_finding(self) -> Self {
        let session = Self::session_in(self.folder.path());
        let tables = super::sessions::stamps(&session);
        let mut finding = sample::named();
        finding.rig = nico().name;
        finding.sessions = vec!["2026-05-01T10-00-00_touch".to_owned()];
        finding.placements.truncate(1);
        let kept = KeptSession { folder: session, tables };
        let kept =
            KeptFinding::new(finding, vec![kept], ("nominal".to_owned(), vec![]), jiff::Timestamp::now());
        Store::new(self.folder.path().join("gap")).keep(kept).expect("kept");
        Self::on(self.folder)
    }

    fn tell(&mut self, command: GapCommand) -> Arc<GapView> {
        self.state.apply(Command::Gap(command));
        self.work();
        self.view()
    }

    fn work(&mut self) {
        loop {
            let actions = self.state.take_actions();
            if !self.run(actions) {
                return;
            }
        }
    }

    /// Whether there was work among them.
    fn run(&mut self, actions: Vec<Action>) -> bool {
        let mut any = false;
        for action in actions {
            let Action::Start(id, work) = action else { continue };
            any = true;
            let outcome = match work.run(&Unattended) {
                Ok(result) => Outcome::Done(result),
                Err(JobError::Cancelled(_)) => Outcome::Cancelled,
                Err(JobError::Failed(why)) => Outcome::Failed(why),
            };
            self.state.work_ended(id, outcome, std::time::Duration::ZERO);
        }
        any
    }

    fn view(&mut self) -> Arc<GapView> {
        self.state.view(Skipped::default(), 0, std::time::Instant::now()).gap
    }

    fn last_notice(&mut self) -> String {
        let view = self.state.view(Skipped::default(), 0, std::time::Instant::now());
        view.notices.last().map(|notice| notice.text.clone()).unwrap_or_default()
    }
}

#[test]
fn the_newest_session_is_chosen_and_the_model_is_nominal() {
    let mut lab = Lab::new();
    let view = lab.view();
    assert_eq!(view.chosen[..], [Lab::session_in(lab.folder.path())]);
    assert_eq!(view.sessions[0].touches, 63);
    assert_eq!((view.step.clone(), view.model.name.as_str()), (StepState::NotDone, "nominal"));
}

/// What is touched to check is compared beside what was learned from, and corners are not compared at all.
#[test]
fn a_check_is_compared_beside_the_touches_that_were_learned_from() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let touch = Lab::session_in(folder.path());
    let at = folder.path().to_owned();
    let of = |kind: &str| at.join(format!("sessions/2026-05-02T10-00-00_{kind}"));
    for session in [&touch, &of("check"), &of("corners")] {
        made_up_session(&nico()).write(session).expect("written");
    }
    let mut lab = Lab::on(folder);
    let chosen = vec![touch.clone()];
    assert_eq!(lab.view().chosen.to_vec(), chosen, "not the newest one, which only checked");
    assert_eq!(with_finished(chosen.clone(), &of("corners")), chosen);
    let both = with_finished(chosen.clone(), &of("check"));
    assert_eq!(both, [touch.clone(), of("check")]);
    assert_eq!(with_finished(both.clone(), &of("check")), both, "not twice");
    assert_eq!(with_finished(both, &touch), chosen, "what is learned from begins anew");
    assert_eq!(with_finished(vec![], &of("check")), [of("check")]);
    let elsewhere = vec![PathBuf::from("other/sessions/2026-05-01T10-00-00_touch")];
    assert_eq!(with_finished(elsewhere.clone(), &of("check")), elsewhere, "that may be another robot");
}

#[test]
fn what_was_found_is_there_after_a_restart_and_is_added_and_taken_back() {
    let mut lab = Lab::new().with_finding();
    let view = lab.view();
    assert_eq!(
        (view.findings.len(), view.step.clone()),
        (1, StepState::NotDone),
        "what was found is not added"
    );
    assert_eq!(view.addable(), [0, 1]);
    let view = lab.tell(GapCommand::Add { effects: vec![0] });
    assert_eq!(view.model.name, "nominal + 1 effect", "{}", lab.last_notice());
    assert_eq!(view.addable(), [1], "what is in the model is not added twice");
    let mut lab = Lab::on(lab.folder);
    assert_eq!(lab.view().model.effects.len(), 1, "the model is in use after a restart");
    let view = lab.tell(GapCommand::Undo);
    assert!(view.model.effects.is_empty() && !view.model.can_undo);
    assert!(!view.model.history.is_empty(), "that it was there is not forgotten");
}

#[test]
fn what_is_left_out_stays_so_until_another_finding_is_shown() {
    let mut lab = Lab::new().with_finding();
    let view = lab.tell(GapCommand::LeaveOut { effect: 0, is_left_out: true });
    assert_eq!((view.addable(), view.wanted()), (vec![0, 1], vec![1]));
    let view = lab.tell(GapCommand::LeaveOut { effect: 0, is_left_out: false });
    assert_eq!(view.wanted(), [0, 1]);
    lab.tell(GapCommand::LeaveOut { effect: 1, is_left_out: true });
    let id = view.findings[0].id.clone();
    assert_eq!(lab.tell(GapCommand::Show { id: id.clone() }).wanted(), [0], "it is the same finding");
    let view = lab.tell(GapCommand::Delete { id });
    assert!(view.shown.is_none() && view.wanted().is_empty());
}

/// A folder with what a lab keeps of one finding.
fn copy_of(lab: &Lab) -> tempfile::TempDir {
    let copied = tempfile::tempdir().expect("temporary folder");
    let name = Lab::session_in(std::path::Path::new("")).file_name().expect("a name").to_owned();
    for (from, to) in [
        (lab.folder.path().join("sessions").join(&name), copied.path().join("sessions").join(&name)),
        (lab.folder.path().join("gap"), copied.path().join("gap")),
    ] {
        std::fs::create_dir_all(&to).expect("made");
        for file in std::fs::read_dir(&from).expect("read").flatten().filter(|file| file.path().is_file()) {
            std::fs::copy(file.path(), to.join(file.file_name())).expect("copied");
        }
    }
    copied
}

#[test]
fn a_lab_that_was_moved_or_copied_finds_its_own_sessions() {
    let lab = Lab::new().with_finding();
    let copied = copy_of(&lab);
    let session = Lab::session_in(copied.path());
    let mut there = Lab::on(copied);
    let shown = there.view().shown.clone().expect("it was found");
    assert_eq!((shown.folders.clone(), there.view().stale.clone()), (vec![session.clone()], None));
    // The first lab may be gone.
    drop(lab);
    let copied = there.folder;
    assert_eq!(Lab::on(copied).view().shown.clone().expect("found").folders, [session]);
}

#[test]
fn a_copied_lab_keeps_to_its_own_session_when_measuring_goes_on_in_the_first_one() {
    let lab = Lab::new().with_finding();
    let copied = copy_of(&lab);
    let session = Lab::session_in(copied.path());
    change_a_digit(&Lab::session_in(lab.folder.path()));
    let mut there = Lab::on(copied);
    let view = there.view();
    assert_eq!(view.shown.clone().expect("it was found").folders, [session]);
    assert_eq!(view.stale, None, "what was compared is here as it was");
}

/// One digit of a table is another one: it is as long as it was.
fn change_a_digit(session: &std::path::Path) {
    let file = session.join("touches.csv");
    let text = std::fs::read_to_string(&file).expect("read");
    let at = text.rfind(|digit: char| digit.is_ascii_digit()).expect("numbers");
    let other = if &text[at..=at] == "7" { "3" } else { "7" };
    std::fs::write(&file, format!("{}{other}{}", &text[..at], &text[at + 1..])).expect("written");
}

#[test]
fn a_session_of_the_same_name_and_length_in_another_lab_is_another_one() {
    let lab = Lab::new().with_finding();
    let noted = Lab::session_in(lab.folder.path());
    let copied = copy_of(&lab);
    change_a_digit(&Lab::session_in(copied.path()));
    let mut there = Lab::on(copied);
    let shown = there.view().shown.clone().expect("it was found");
    assert_eq!(shown.folders, [noted], "what was compared is there still");
    // Once it is gone, the one that is here is not what was compared.
    drop(lab);
    let mut there = Lab::on(there.folder);
    let view = there.view();
    assert_eq!(view.shown.clone().expect("found").folders, [Lab::session_in(there.folder.path())]);
    assert!(matches!(view.step, StepState::Stale { .. }), "{:?}", view.step);
}

#[test]
fn a_table_that_was_written_again_and_holds_the_same_has_not_changed() {
    let lab = Lab::new().with_finding();
    let session = Lab::session_in(lab.folder.path());
    let then = super::sessions::stamps(&session);
    let table = session.join("touches.csv");
    let later = std::time::SystemTime::now() + std::time::Duration::from_secs(90);
    std::fs::File::options()
        .append(true)
        .open(&table)
        .and_then(|file| file.set_modified(later))
        .expect("set");
    assert!(super::sessions::are_as(&super::sessions::stamps(&session), &then));
    change_a_digit(&session);
    assert!(!super::sessions::are_as(&super::sessions::stamps(&session), &then));
}

#[test]
fn a_finding_is_stale_when_its_session_changed() {
    let mut lab = Lab::new().with_finding();
    let touches = Lab::session_in(lab.folder.path()).join("touches.csv");
    let text = std::fs::read_to_string(&touches).expect("read");
    let shorter = text.lines().take(30).collect::<Vec<_>>().join("\n");
    std::fs::write(&touches, shorter + "\n").expect("written");
    let view = lab.tell(GapCommand::ListSessions);
    assert!(matches!(view.step, StepState::Stale { .. }));
    assert!(view.addable().is_empty());
    lab.tell(GapCommand::Add { effects: vec![0] });
    assert!(lab.last_notice().contains("changed or is gone"), "{}", lab.last_notice());
    assert!(lab.view().model.effects.is_empty());
}

#[test]
fn what_cannot_be_done_is_refused_in_words() {
    let mut lab = Lab::new();
    lab.tell(GapCommand::Add { effects: vec![0] });
    assert!(lab.last_notice().contains("Find what is missing first"));
    lab.tell(GapCommand::Undo);
    assert!(!lab.last_notice().is_empty());
    lab.tell(GapCommand::Choose { sessions: vec![] });
    lab.tell(GapCommand::Find { seed: 1 });
    assert!(lab.last_notice().contains("Choose at least one session"));
    let gone = lab.folder.path().join("gone");
    let view = lab.tell(GapCommand::Choose { sessions: vec![gone] });
    assert!(view.sessions.iter().any(|session| session.problem.is_some()));
    let view = lab.tell(GapCommand::Find { seed: 1 });
    assert!(view.failed.is_some() && view.searching.is_none());
}

#[test]
fn a_report_is_written_and_a_finding_is_deleted() {
    let mut lab = Lab::new().with_finding();
    for (name, pdf) in [("gap.html", false), ("gap.pdf", true)] {
        let file = lab.folder.path().join(name);
        lab.tell(GapCommand::Report { file: file.clone(), pdf });
        let page = std::fs::read(&file).expect("a page");
        assert_eq!(page.starts_with(b"%PDF"), pdf);
    }
    let id = lab.view().findings[0].id.clone();
    let view = lab.tell(GapCommand::Delete { id });
    assert!(view.findings.is_empty() && view.shown.is_none());
    assert_eq!(Lab::on(lab.folder).view().findings.len(), 0);
}

#[test]
fn a_session_chosen_while_the_start_still_reads_stands_in_the_list() {
    let mut lab = Lab::new();
    let elsewhere = lab.folder.path().join("a session from another lab");
    made_up_session(&nico()).write(&elsewhere).expect("written");
    lab.state = State::new(lab.folder.path());
    let start = lab.state.take_actions();
    lab.state.apply(Command::Gap(GapCommand::Choose { sessions: vec![elsewhere.clone()] }));
    lab.work();
    // What the start reads did not know of the session, and ends last.
    lab.run(start);
    lab.work();
    let view = lab.view();
    assert_eq!(view.chosen[..], *std::slice::from_ref(&elsewhere));
    assert!(view.sessions.iter().any(|listed| listed.folder == elsewhere), "{:?}", view.sessions);
    assert_eq!(view.sessions.len(), 2, "the program's own session is listed, too");
}

#[test]
fn an_arm_that_small_shares_do_not_help_keeps_its_model_and_is_not_offered_them_again() {
    let lab = Lab::new();
    let mut finding = sample::named();
    finding.effects.clear();
    finding.rig = nico().name;
    finding.sessions = vec!["2026-05-01T10-00-00_touch".to_owned()];
    finding.placements.truncate(1);
    let session = Lab::session_in(lab.folder.path());
    let kept = KeptSession { tables: super::sessions::stamps(&session), folder: session };
    let kept = KeptFinding::new(finding, vec![kept], ("nominal".to_owned(), vec![]), jiff::Timestamp::now());
    Store::new(lab.folder.path().join("gap")).keep(kept).expect("kept");
    let mut lab = Lab::on(lab.folder);
    let view = lab.view();
    assert!(view.addable().is_empty() && view.sizes_arm);
    // Touches at one posture tell nothing of an arm: the screen's place takes all of it.
    let view = lab.tell(GapCommand::Add { effects: vec![] });
    assert!(view.model.effects.is_empty(), "{}", view.model.name);
    assert!(lab.last_notice().contains("Nothing was added"), "{}", lab.last_notice());
    assert!(!view.sizes_arm);
}
