//! Undo: one word, one key and one place for what was changed last on a screen, whichever workflow has to
//! take it back.

use std::borrow::Cow;

use plumbline_engine::view::{Subject, TimelineEntry};
use plumbline_engine::{
    Command, EyesCommand, GapCommand, ModelsCommand, MountCommand, TablesCommand, TimelineCommand,
    TouchCommand, View,
};

use super::{GapAction, LabelsAction, ModelsAction, is_under_way, led_by};
use crate::operator::Screen;
use crate::operator::words::clock;

/// What is taken back.
#[derive(Clone, Debug, PartialEq)]
pub struct Undo {
    /// Of what, in a word or two.
    pub of: &'static str,
    /// What goes, within a sentence.
    pub what: String,
    /// What is in use then, within a sentence; `None`: who takes it back knows.
    pub then: Option<String>,
    /// What is sent.
    pub command: Command,
}

impl Undo {
    /// What it does, two or three sentences; the first begins small.
    pub fn help(&self) -> String {
        let then = self.then.as_ref().map_or_else(String::new, |then| format!(" In use then: {then}."));
        format!("takes back {}.{then} Nothing is deleted that was in use.", self.what)
    }

    /// Of what is only edited, or of whose order its workflow knows.
    fn of_workflow(of: &'static str, what: &str, command: impl Into<Command>) -> Self {
        Self { of, what: what.to_owned(), then: None, command: command.into() }
    }
}

/// Why nothing is.
type NoUndo = Cow<'static, str>;

/// What Undo takes back on a screen: what is edited there, else the result that was put in use there.
///
/// # Errors
/// Why there is nothing, within a sentence.
pub fn undo(view: &View, screen: Screen) -> Result<Undo, NoUndo> {
    match screen {
        Screen::Collect => of_pairs(view),
        // Pairs that were dropped or restored since it was solved are what the hand was at.
        Screen::Judge if view.eyes.can_undo && view.eyes.pairs_changed => of_pairs(view),
        Screen::Images => of_boxes(view),
        Screen::Judge | Screen::Accept => of_result(view, Subject::Eyes),
        Screen::Mount if view.mount.can_undo => {
            Ok(Undo::of_workflow("Views", "the last deletion of views", MountCommand::Undo))
        }
        Screen::Mount => of_result(view, Subject::Mount),
        Screen::Touch => of_result(view, Subject::Screen),
        // What is edited is finer than what is in use, and is what the hand was at.
        Screen::Models if view.models.tables.can_undo => Ok(Undo::of_workflow(
            "Grasp tables",
            "the last change of grasp height and yaw",
            ModelsCommand::Tables(TablesCommand::Undo),
        )),
        Screen::Models => of_result(view, Subject::Correction),
        Screen::Gap | Screen::HandEye | Screen::Drift => of_result(view, Subject::Effects),
        Screen::Commission | Screen::Timeline => of_any(view),
        Screen::Live | Screen::Robot | Screen::Grasp | Screen::Scores => {
            Err("nothing on this screen is put in use: go where the result was made, or to the timeline"
                .into())
        }
    }
}

fn of_pairs(view: &View) -> Result<Undo, NoUndo> {
    if !view.eyes.can_undo {
        return Err("no pair was added or deleted".into());
    }
    Ok(Undo::of_workflow("Pairs", "the last change of the pairs", EyesCommand::Undo))
}

fn of_boxes(view: &View) -> Result<Undo, NoUndo> {
    let action = LabelsAction::Undo;
    match action.refusal(view) {
        Some(why) => Err(why),
        None => {
            let command = action.command(view).ok_or("no image is open")?;
            Ok(Undo::of_workflow("Boxes", "the last change of the boxes", command))
        }
    }
}

/// The newest change of any kind of result.
fn of_any(view: &View) -> Result<Undo, NoUndo> {
    let newest = view.timeline.entries.iter().rev().filter(|entry| view.timeline.is_newest(entry));
    for entry in newest {
        match of_result(view, entry.subject) {
            // What cannot be taken back just now is not passed over for what is older.
            Err(_) if entry.subject != Subject::Screen || !is_under_way(&view.touch.phase) => {}
            result => return result,
        }
    }
    Err("nothing was put in use that could be taken back".into())
}

/// What is in use of a kind of result.
pub fn of_result(view: &View, subject: Subject) -> Result<Undo, NoUndo> {
    // What moves the arm just now has planned with what is in use.
    if let Some(why) = led_by(view) {
        return Err(why.into());
    }
    let in_use = view.timeline.in_use.iter().find(|now| now.subject == subject);
    let what =
        in_use.map_or_else(|| format!("the {}", subject.name().to_lowercase()), |now| now.title.clone());
    let of_workflow = |command| Undo::of_workflow(subject.name(), &what, command);
    match subject {
        Subject::Correction => {
            let command = workflow(ModelsAction::Undo.refusal(view), ModelsCommand::Undo)?;
            let then = view.models.earlier.first().map(|before| match before.method {
                Some(method) => format!("{} of {}", method.name(), clock(before.accepted)),
                None => "no model".to_owned(),
            });
            Ok(Undo { then, ..of_workflow(command) })
        }
        Subject::Effects => workflow(GapAction::Undo.refusal(view), GapCommand::Undo).map(of_workflow),
        // Its touches rest on where the screen was taken to lie.
        Subject::Screen if is_under_way(&view.touch.phase) => {
            Err("a run of touches is under way: finish or close it first".into())
        }
        Subject::Eyes | Subject::Mount | Subject::Screen => {
            if !view.timeline.is_known {
                return Err("the timeline of results is not read yet".into());
            }
            let nothing = "nothing was in use before that is known";
            let to = before(&view.timeline.entries, subject).ok_or(nothing)?;
            let then = title_of(&view.timeline.entries, subject, to);
            let command = TimelineCommand::TakeBack { subject, to: to.cloned() };
            Ok(Undo { then, ..of_workflow(command.into()) })
        }
        Subject::Finding
        | Subject::Check
        | Subject::Touches
        | Subject::Experiment
        | Subject::Health
        | Subject::Places
        | Subject::Grasps
        | Subject::Detectors => Err("it was only measured, so that there is nothing to take back".into()),
    }
}

/// What something that was in use is called; `None`: it was in use before the timeline began.
fn title_of(entries: &[TimelineEntry], subject: Subject, id: Option<&String>) -> Option<String> {
    let is_it = |entry: &&TimelineEntry| entry.subject == subject && entry.id_after.as_ref() == id;
    let title = entries.iter().rev().find(is_it).map(|entry| entry.title.clone());
    let as_described = match subject {
        Subject::Eyes => "no calibration",
        Subject::Screen => "the place as it is described",
        _ => "the mount as it is described",
    };
    title.or_else(|| id.is_none().then(|| as_described.to_owned()))
}

/// These keep the order in which theirs were in use themselves.
fn workflow(refusal: Option<NoUndo>, command: impl Into<Command>) -> Result<Command, NoUndo> {
    refusal.map_or_else(|| Ok(command.into()), Err)
}

/// What puts something of a kind in use by its id, or what is described; `None`: its workflow goes back step by step.
pub fn back_to(subject: Subject, id: Option<&String>) -> Option<Command> {
    Some(match (subject, id.cloned()) {
        (Subject::Eyes, id) => EyesCommand::UseEarlier { id }.into(),
        (Subject::Mount, Some(id)) => MountCommand::UseEarlier { id }.into(),
        (Subject::Mount, None) => MountCommand::UseNominal.into(),
        (Subject::Screen, Some(id)) => TouchCommand::UseEarlierPlacement { id }.into(),
        (Subject::Screen, None) => TouchCommand::UseNominalPlacement.into(),
        _ => return None,
    })
}

/// What was in use before what is in use now: its id, where it was not as described. Undone step by step, as
/// if what was taken back had never been; what was used again on purpose is a step of its own.
fn before(entries: &[TimelineEntry], subject: Subject) -> Option<Option<&String>> {
    let mut steps: Vec<Option<&String>> = Vec::new();
    for entry in entries.iter().filter(|entry| entry.subject == subject) {
        if steps.is_empty() {
            steps.push(entry.id_before.as_ref());
        }
        let now = entry.id_after.as_ref();
        if entry.by_undo && steps.len() > 1 && steps[steps.len() - 2] == now {
            steps.pop();
        } else {
            steps.push(now);
        }
    }
    steps.len().checked_sub(2).map(|at| steps[at])
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_engine::view::{EntryKind, EyesView, InUseNow, TimelineView};

    use super::*;

    /// The ids that were in use one after the other, from nothing on; `true`: by Undo.
    fn entries(ids: &[(Option<&str>, bool)]) -> Vec<TimelineEntry> {
        let mut before = None;
        let entry = |(number, (id, by_undo)): (usize, &(Option<&str>, bool))| {
            let after = id.map(str::to_owned);
            TimelineEntry {
                number: number as u64 + 1,
                at: jiff::Timestamp::UNIX_EPOCH,
                subject: Subject::Mount,
                kind: EntryKind::PutInUse,
                title: format!("mount {id:?}"),
                before: None,
                after: None,
                basis: String::new(),
                id_before: std::mem::replace(&mut before, after.clone()),
                id_after: after,
                outside: false,
                by_undo: *by_undo,
            }
        };
        ids.iter().enumerate().map(entry).collect()
    }

    fn back(ids: &[(Option<&str>, bool)]) -> Option<Option<String>> {
        before(&entries(ids), Subject::Mount).map(Option::<&String>::cloned)
    }

    #[test]
    fn undo_goes_back_step_by_step_until_nothing_was_before() {
        let [a, b, c] = ["a", "b", "c"].map(|id| (Some(id), false));
        let undone = |(id, _): (Option<&'static str>, bool)| (id, true);
        let none = (None, false);
        let id = |(id, _): (Option<&str>, bool)| Some(id.map(str::to_owned));
        assert_eq!(back(&[]), None);
        assert_eq!(back(&[a]), id(none), "as it is described");
        assert_eq!(back(&[a, b, c]), id(b));
        assert_eq!(back(&[a, b, c, undone(b)]), id(a), "what was undone is gone");
        assert_eq!(back(&[a, b, c, undone(b), undone(a)]), id(none));
        assert_eq!(back(&[a, b, c, undone(b), undone(a), undone(none)]), None, "there is nothing left");
    }

    #[test]
    fn what_was_used_again_on_purpose_is_a_step_of_its_own() {
        let [a, b, c] = ["a", "b", "c"].map(|id| (Some(id), false));
        let none = (None, false);
        let id = |(id, _): (Option<&str>, bool)| Some(id.map(str::to_owned));
        assert_eq!(back(&[a, b, c, a]), id(c));
        assert_eq!(back(&[a, b, a]), id(b), "also the one right before");
        assert_eq!(back(&[a, b, a, (Some("b"), true)]), id(a), "and Undo of it goes on from there");
        assert_eq!(back(&[a, b, none]), id(b), "so is going to none at all");
        assert_eq!(back(&[a, none]), id(a));
    }

    fn mounted(ids: &[&str]) -> View {
        let ids: Vec<_> = ids.iter().map(|id| (Some(*id), false)).collect();
        let entries = entries(&ids);
        let now = entries.last().map(|entry| InUseNow {
            subject: Subject::Mount,
            title: entry.title.clone(),
            figure: None,
            since: Some(entry.at),
            entry: Some(entry.number),
            against: String::new(),
        });
        let timeline =
            TimelineView { is_known: true, entries: entries.into(), in_use: now.into_iter().collect() };
        View { timeline: Arc::new(timeline), ..View::default() }
    }

    #[test]
    fn each_screen_takes_back_its_own_and_the_timeline_the_newest() {
        let view = mounted(&["a", "b"]);
        let to = Some("a".to_owned());
        let back: Command = TimelineCommand::TakeBack { subject: Subject::Mount, to }.into();
        for screen in [Screen::Mount, Screen::Timeline, Screen::Commission] {
            let undo = undo(&view, screen).expect("a mount is in use");
            assert_eq!((undo.of, &undo.command), ("Mount", &back), "{screen:?}");
            assert_eq!(
                (&*undo.what, undo.then.as_deref()),
                (r#"mount Some("b")"#, Some(r#"mount Some("a")"#))
            );
        }
        let nominal = undo(&mounted(&["a"]), Screen::Mount).expect("a mount is in use");
        let described = TimelineCommand::TakeBack { subject: Subject::Mount, to: None };
        assert_eq!(nominal.command, described.into());
        assert_eq!(nominal.then.as_deref(), Some("the mount as it is described"));
        for screen in Screen::ALL
            .into_iter()
            .filter(|screen| !matches!(screen, Screen::Mount | Screen::Timeline | Screen::Commission))
        {
            assert!(undo(&view, screen).is_err(), "{screen:?} has nothing of it");
        }
    }

    #[test]
    fn while_a_run_of_touches_needs_the_screen_nothing_older_is_taken_back_instead() {
        let mut view = mounted(&["a", "b"]);
        let timeline = Arc::make_mut(&mut view.timeline);
        let mut screen = timeline.entries[1].clone();
        (screen.subject, screen.number) = (Subject::Screen, 9);
        let now = InUseNow { subject: Subject::Screen, entry: Some(9), ..timeline.in_use[0].clone() };
        timeline.in_use = timeline.in_use.iter().cloned().chain([now]).collect();
        timeline.entries = timeline.entries.iter().cloned().chain([screen]).collect();
        let paused = plumbline_engine::view::TouchPhase::Paused { why: None };
        Arc::make_mut(&mut view.touch).phase = paused;
        let why = undo(&view, Screen::Commission).expect_err("not now");
        assert!(why.contains("a run of touches is under way"), "{why}");
    }

    #[test]
    fn pairs_are_taken_back_where_they_are_collected_and_not_where_they_are_judged() {
        let eyes = Arc::new(EyesView { can_undo: true, ..EyesView::default() });
        let view = View { eyes, ..View::default() };
        assert_eq!(undo(&view, Screen::Collect).map(|undo| undo.command), Ok(EyesCommand::Undo.into()));
        assert!(undo(&view, Screen::Judge).is_err());
        // A pair that was dropped after it was solved comes back where it was dropped.
        let eyes = Arc::new(EyesView { can_undo: true, pairs_changed: true, ..EyesView::default() });
        let view = View { eyes, ..View::default() };
        assert_eq!(undo(&view, Screen::Judge).map(|undo| undo.command), Ok(EyesCommand::Undo.into()));
        let why = undo(&View::default(), Screen::Collect).expect_err("nothing was collected");
        assert_eq!(why, "no pair was added or deleted");
    }
}
