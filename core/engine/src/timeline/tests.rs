//! The line driven by what it is handed, its file written and read on the spot.

use std::path::Path;
use std::sync::Arc;

use plumbline_model::Unattended;

use super::command::{TimelineCommand, TimelineFormat};
use super::kept::FILE;
use super::view::{EntryKind, Figure, Subject, TimelineView};
use super::work::Context;
use super::{Finding, Measured, Standing, StepBack, TimelineAround, TimelineWorkflow};
use crate::Skipped;
use crate::ground::jobs::list::JobList;
use crate::ground::jobs::{JobError, JobId};
use crate::ground::notice::Notices;
use crate::ground::{Asked, LongWork as _, Moment, Time, Workflow as _};

struct Lab {
    room: TimelineWorkflow,
    around: TimelineAround,
    notices: Notices,
    jobs: JobList,
    time: Time,
}

impl Lab {
    fn on(folder: &Path, around: TimelineAround) -> Self {
        let room = TimelineWorkflow::new(folder);
        let mut lab =
            Self { room, around, notices: Notices::default(), jobs: JobList::default(), time: Time::now() };
        lab.with(|room, around, context| room.restore(around, context));
        lab
    }

    fn with(&mut self, act: impl FnOnce(&mut TimelineWorkflow, &TimelineAround, &mut Context<'_>)) {
        let mut asked = vec![];
        let Self { room, around, notices, jobs, time } = self;
        act(room, around, &mut Context::new(notices, jobs, *time, &mut asked));
        while !asked.is_empty() {
            for one in std::mem::take(&mut asked) {
                let Asked::Start(id, work) = one else { panic!("it only reads and writes") };
                let outcome = work.run(&Unattended);
                let mut context = Context::new(notices, jobs, *time, &mut asked);
                match outcome {
                    Ok(result) => room.work_done(id, result, around, &mut context),
                    Err(JobError::Failed(why)) => {
                        context.refuse(&why);
                        room.work_ended(id, Some(&why), around, &mut context);
                    }
                    Err(JobError::Cancelled(_)) => room.work_ended(id, None, around, &mut context),
                }
            }
        }
    }

    /// So it is now.
    fn now(&mut self, in_use: Vec<Standing>) -> Arc<TimelineView> {
        self.around.in_use = in_use;
        self.with(|room, around, context| room.look(around, context));
        self.view()
    }

    fn view(&mut self) -> Arc<TimelineView> {
        let moment = Moment { now: self.time.instant, skipped: Skipped::default() };
        self.room.view(&self.around, &moment)
    }

    fn said(&mut self) -> String {
        self.notices.view().last().map(|notice| notice.text.clone()).unwrap_or_default()
    }
}

fn eyes(id: Option<&str>, error_px: Option<f64>) -> Standing {
    Standing {
        subject: Subject::Eyes,
        id: id.map(str::to_owned),
        title: format!("calibration {id:?}"),
        before: None,
        after: error_px.map(Figure::Pixels),
        basis: String::new(),
        accepted: None,
    }
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

#[test]
fn each_change_is_an_entry_with_the_error_before_and_after() {
    let folder = folder();
    let mut lab = Lab::on(folder.path(), TimelineAround::default());
    assert!(lab.view().is_known && lab.view().entries.is_empty());
    assert!(lab.now(vec![eyes(None, None)]).entries.is_empty(), "nothing is in use, as in the beginning");
    lab.now(vec![eyes(Some("a"), Some(0.2))]);
    lab.now(vec![eyes(Some("a"), Some(0.2))]);
    let view = lab.now(vec![eyes(Some("b"), Some(0.08))]);
    assert_eq!(view.entries.len(), 2, "what stays the same is no entry");
    let [first, second] = &view.entries[..] else { unreachable!("two") };
    assert_eq!(
        (first.kind, first.before, first.after),
        (EntryKind::PutInUse, None, Some(Figure::Pixels(0.2)))
    );
    assert_eq!((second.before, second.after), (Some(Figure::Pixels(0.2)), Some(Figure::Pixels(0.08))));
    assert_eq!((second.id_before.as_deref(), second.id_after.as_deref()), (Some("a"), Some("b")));
    assert!(view.is_newest(second) && !view.is_newest(first));

    let view = lab.now(vec![eyes(Some("a"), Some(0.2))]);
    let back = view.entries.last().expect("an entry");
    assert_eq!((back.kind, back.before, back.after), (EntryKind::TakenBack, second.after, first.after));
    let view = lab.now(vec![eyes(None, None)]);
    assert_eq!(view.entries.last().map(|entry| entry.kind), Some(EntryKind::TakenBack));
    assert_eq!(view.in_use.len(), 1);
}

#[test]
fn a_step_back_by_undo_is_told_from_what_was_used_again_on_purpose() {
    let folder = folder();
    let mut lab = Lab::on(folder.path(), TimelineAround::default());
    // As the state does: the step is handed to its workflow, whose work takes it.
    let back = |lab: &mut Lab, to: &str, work: u64| {
        let undo = TimelineCommand::TakeBack { subject: Subject::Eyes, to: Some(to.to_owned()) };
        lab.with(|room, around, context| room.apply(undo, around, context));
        let steps = lab.room.take_steps();
        assert_eq!(steps, [StepBack { subject: Subject::Eyes, to: Some(to.to_owned()) }]);
        steps.into_iter().for_each(|step| lab.room.stepping_back(step, JobId(work)));
    };
    let is_undo = |lab: &mut Lab, id: &str| {
        lab.now(vec![eyes(Some(id), None)]).entries.last().expect("an entry").by_undo
    };
    assert!(!is_undo(&mut lab, "a") && !is_undo(&mut lab, "b"));
    assert!(!is_undo(&mut lab, "a"), "used again");
    assert!(!is_undo(&mut lab, "b"));
    back(&mut lab, "a", 101);
    assert!(is_undo(&mut lab, "a"));
    assert!(!is_undo(&mut lab, "b"), "asked for once, it is once");
    back(&mut lab, "a", 102);
    assert!(!is_undo(&mut lab, "c"), "something else came in between");
    assert!(!is_undo(&mut lab, "a"), "so that it is over");
    back(&mut lab, "c", 103);
    lab.room.stepped_back(JobId(103));
    assert!(!is_undo(&mut lab, "c"), "its work came to nothing, and then it was used again");
    let kept = Lab::on(folder.path(), TimelineAround::default()).view();
    assert_eq!(kept.entries.iter().filter(|entry| entry.by_undo).count(), 1, "it is kept");
}

#[test]
fn what_another_program_changed_meanwhile_is_told_as_that() {
    let folder = folder();
    let mut lab = Lab::on(folder.path(), TimelineAround::default());
    lab.now(vec![eyes(Some("a"), Some(0.2))]);
    let mut again = Lab::on(folder.path(), TimelineAround::default());
    assert_eq!(again.view().entries, lab.view().entries, "it was kept");
    // The eyes are read later than the timeline: until then nothing is known of them.
    assert_eq!(again.now(vec![]).entries.len(), 1);
    let view = again.now(vec![eyes(Some("c"), Some(0.1))]);
    let entry = view.entries.last().expect("an entry");
    assert!(entry.outside && entry.kind == EntryKind::PutInUse && entry.number == 2);
    let view = again.now(vec![eyes(Some("d"), Some(0.1))]);
    assert!(!view.entries.last().expect("an entry").outside);
}

#[test]
fn what_is_in_use_when_the_line_begins_stands_at_its_beginning() {
    let folder = folder();
    let accepted = "2026-09-14T10:00:00Z".parse().expect("a time");
    let mut lab = Lab::on(folder.path(), TimelineAround::default());
    let view = lab.now(vec![Standing { accepted: Some(accepted), ..eyes(Some("a"), Some(0.2)) }]);
    assert_eq!((view.entries[0].kind, view.entries[0].at), (EntryKind::Found, accepted));
    assert!(!view.entries[0].outside);
    assert_eq!(view.in_use[0].since, Some(accepted));
}

#[test]
fn what_is_learned_later_stands_where_its_time_is_and_is_read_again() {
    let folder = folder();
    let at = |time: &str| Some(time.parse().expect("a time"));
    let mount =
        |time: &str| Standing { subject: Subject::Mount, accepted: at(time), ..eyes(Some("m"), Some(0.1)) };
    let mut lab = Lab::on(folder.path(), TimelineAround::default());
    lab.now(vec![mount("2026-09-14T11:00:00Z")]);
    // The calibration of the eyes is read later than that of the mount, and was made before.
    let eyes_in_use = Standing { accepted: at("2026-09-14T10:00:00Z"), ..eyes(Some("a"), Some(0.2)) };
    let view = lab.now(vec![mount("2026-09-14T11:00:00Z"), eyes_in_use.clone()]);
    let order =
        |view: &TimelineView| -> Vec<_> { view.entries.iter().map(|e| (e.subject, e.number)).collect() };
    assert_eq!(order(&view), [(Subject::Eyes, 2), (Subject::Mount, 1)]);
    // What comes into use now stands at the end, with a number of its own.
    let view = lab.now(vec![mount("2026-09-14T11:00:00Z"), eyes(Some("b"), Some(0.1))]);
    let after = [(Subject::Eyes, 2), (Subject::Mount, 1), (Subject::Eyes, 3)];
    assert_eq!(order(&view), after);
    let mut again = Lab::on(folder.path(), TimelineAround::default());
    assert_eq!(order(&again.view()), after, "as it was kept");
}

#[test]
fn findings_and_checks_stand_there_once() {
    let folder = folder();
    let finding = |id: &str, made: &str| Finding {
        id: id.to_owned(),
        made: made.parse().expect("a time"),
        title: "found: joint zero of the elbow".to_owned(),
        before: Figure::Meters(6.7e-3),
        after: Figure::Meters(3.6e-3),
    };
    let measured = |subject, title: &str, after_m: f64| Measured {
        subject,
        id: "2026-09-14T12-00-00_touches".to_owned(),
        at: None,
        title: title.to_owned(),
        before: Some(Figure::Meters(5.88e-3)),
        after: Figure::Meters(after_m),
        basis: "mean distance from the target".to_owned(),
    };
    let check = |after_m| measured(Subject::Check, "1 touch at new targets", after_m);
    let mut lab = Lab::on(folder.path(), TimelineAround::default());
    lab.around.findings =
        vec![finding("late", "2026-09-14T11:00:00Z"), finding("early", "2026-09-14T10:00:00Z")];
    lab.around.measured = vec![check(0.93e-3)];
    lab.now(vec![]);
    lab.around.measured = vec![check(0.91e-3)];
    let view = lab.now(vec![]);
    let ids: Vec<_> = view.entries.iter().filter_map(|entry| entry.id_after.as_deref()).collect();
    assert_eq!(ids, ["early", "late", "2026-09-14T12-00-00_touches"]);
    let checked = &view.entries[2];
    let both = (checked.before, checked.after);
    assert_eq!(both, (Some(Figure::Meters(5.88e-3)), Some(Figure::Meters(0.91e-3))), "brought up to date");

    // What a finding suggested stays that when the finding is shown no more.
    lab.around.measured = vec![measured(Subject::Experiment, "suggested and made: a weight", 4.0e-3)];
    lab.now(vec![]);
    lab.around.measured = vec![measured(Subject::Touches, "12 touches to learn from", 4.1e-3)];
    let view = lab.now(vec![]);
    let suggested = view.entries.last().expect("an entry");
    assert_eq!((view.entries.len(), suggested.subject), (4, Subject::Experiment));
    assert_eq!(
        (&*suggested.title, suggested.after),
        ("suggested and made: a weight", Some(Figure::Meters(4.1e-3)))
    );
    // An evaluation is told as the model in use then had it.
    for after_m in [2.0e-3, 3.0e-3] {
        lab.around.measured = vec![measured(Subject::Places, "tomato at 36 of 36 places", after_m)];
        lab.now(vec![]);
    }
    let view = lab.view();
    assert_eq!((view.entries.len(), view.entries[4].after), (5, Some(Figure::Meters(2.0e-3))));
}

#[test]
fn what_cannot_be_read_is_not_written_over() {
    let folder = folder();
    let file = folder.path().join(FILE);
    for (text, why) in [
        ("{}", "is no timeline of results"),
        (r#"{"format":9,"entries":[]}"#, "format 9"),
        (
            r#"{"format":1,"entries":[{"number":1,"at":"2026-09-14T11:00:00Z","subject":"eyes","kind":"measured","title":"","after":{"meters":-1.0}}]}"#,
            "an error of -1 is none",
        ),
    ] {
        std::fs::write(&file, text).expect("written");
        let mut lab = Lab::on(folder.path(), TimelineAround::default());
        assert!(lab.said().contains(why), "{}", lab.said());
        let view = lab.now(vec![eyes(Some("a"), None)]);
        assert!(!view.is_known && view.entries.is_empty());
        assert_eq!(std::fs::read_to_string(&file).expect("there"), text);
        let report =
            TimelineCommand::Report { file: folder.path().join("r.csv"), format: TimelineFormat::Csv };
        lab.with(|room, around, context| room.apply(report, around, context));
        assert!(lab.said().contains("not read yet"), "{}", lab.said());
    }
}

#[test]
fn the_whole_setup_is_written_as_table_and_as_page() {
    let folder = folder();
    let mut lab =
        Lab::on(folder.path(), TimelineAround { rig: "nico".to_owned(), ..TimelineAround::default() });
    lab.now(vec![eyes(Some("a, \"the first\""), Some(0.2))]);
    lab.now(vec![eyes(Some("b"), Some(0.08))]);
    let off = "The calibration of the eyes does not hold any more.".to_owned();
    lab.around.against =
        vec![(Subject::Eyes, off.clone()), (Subject::Mount, "Nothing is in use.".to_owned())];
    let mut written = |name: &str, format: TimelineFormat| {
        let file = folder.path().join(name);
        let command = TimelineCommand::Report { file: file.clone(), format };
        lab.with(|room, around, context| room.apply(command, around, context));
        std::fs::read(file).expect("written")
    };
    let table = written("setup.csv", TimelineFormat::Csv);
    let mut rows = csv::Reader::from_reader(&table[..]);
    let rows: Vec<csv::StringRecord> = rows.records().map(|row| row.expect("a row")).collect();
    assert_eq!(rows.len(), 2);
    assert_eq!((&rows[1][5], &rows[1][6], &rows[1][7]), ("0.200000000", "0.080000000", "px"));
    assert_eq!(&rows[0][10], "a, \"the first\"");
    let page = String::from_utf8(written("setup.html", TimelineFormat::Html)).expect("text");
    assert!(page.contains("Setup of nico") && page.contains("0.080 px") && page.contains("0.200 px"));
    assert!(page.contains(&off) && !page.contains("Nothing is in use."), "beside what is in use only");
    assert!(written("setup.pdf", TimelineFormat::Pdf).starts_with(b"%PDF"));
}
