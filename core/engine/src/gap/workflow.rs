//! What is compared, what was found, which model is in use.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use plumbline_effects::{RigModel, RigModelError};
use plumbline_gap::{Options, Verdict};
use plumbline_model::robot::Rig;
use plumbline_report::ReportContext;

use super::command::{GapCommand, GapModel};
use super::model;
use super::sessions::{is_measured, with_finished};
use super::store::{KeptSession, Named, Store};
use super::view::{FindingEntry, GapModelView, GapSession, ShownFinding};
use super::work::{Context, GapResult, GapWork, Restored};
use crate::gap::view::GapView;
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::ground::sessions::is_for_training;
use crate::ground::{Moment, Nothing, Workflow};

/// What the workflow can see of the rest.
pub struct GapAround {
    /// The robot with what was calibrated.
    pub rig: Arc<Rig>,
    /// The session that was touched last; offered first.
    pub newest_session: Option<PathBuf>,
}

/// The whole workflow, of one world.
#[derive(Clone, Debug)]
pub struct GapWorkflow {
    folder: PathBuf,
    store: Store,
    pub(super) sessions: Vec<GapSession>,
    pub(super) chosen: Vec<PathBuf>,
    pub(super) with: GapModel,
    pub(super) searching: Option<JobId>,
    pub(super) failed: Option<String>,
    pub(super) findings: Vec<Arc<Named>>,
    pub(super) changed: Vec<PathBuf>,
    pub(super) shown: Option<String>,
    pub(super) beside: Option<String>,
    pub(super) left_out: LeftOut,
    /// `None`: not read yet, or the file cannot be used, so nothing is written over it.
    pub(super) model: Option<Arc<RigModel>>,
    /// How far each of its effects moves what it is about.
    pub(super) moved_m: Vec<Option<f64>>,
    changing: Option<JobId>,
    /// Findings whose arm is no better off with small shares of all usual effects.
    pub(super) not_sized: Vec<String>,
    pub(super) seen: Seen,
}

/// What the operator does not want to add.
#[derive(Clone, Debug, Default)]
pub(super) struct LeftOut {
    /// The finding that it is about.
    pub of: Option<String>,
    /// By place in its list of effects.
    pub effects: Vec<usize>,
}

/// Said once, where the operator asked for it.
const NOT_SIZED: &str =
    "Nothing was added: on touches held out the arm errs no less with small shares of all usual effects.";

/// What is shown, made only when it changes.
#[derive(Clone, Debug, Default)]
pub(super) struct Seen {
    pub entries: Arc<[FindingEntry]>,
    pub shown: Option<Arc<ShownFinding>>,
    pub beside: Option<Arc<ShownFinding>>,
    pub model: GapModelView,
    pub sizes_arm: bool,
}

impl GapWorkflow {
    /// The model in use; `None`: not read yet, or it cannot be.
    pub fn model(&self) -> Option<&Arc<RigModel>> {
        self.model.as_ref()
    }

    fn list(&self, context: &mut Context<'_>) {
        let watched: Vec<KeptSession> =
            self.findings.iter().flat_map(|named| named.kept.sessions.clone()).collect();
        let folder = self.folder.join("sessions");
        context.start(GapWork::List { folder, others: self.chosen.clone(), watched });
    }

    pub(super) fn named(&self, id: &str) -> Option<&Arc<Named>> {
        self.findings.iter().find(|named| named.id == id)
    }

    pub(super) fn shown_named(&self) -> Option<&Arc<Named>> {
        self.named(self.shown.as_ref()?)
    }

    fn find(&mut self, seed: u64, around: &GapAround, context: &mut Context<'_>) {
        if self.searching.is_some() {
            return context.refuse("The gap is being looked for already. Wait for it, or cancel that first.");
        }
        if self.chosen.is_empty() {
            return context.refuse("Choose at least one session first, or touch the screen: step 3, Touch.");
        }
        let model = match self.with {
            GapModel::Nominal => Arc::new(RigModel::nominal(&around.rig)),
            GapModel::InUse => match &self.model {
                Some(model) => model.clone(),
                None => {
                    return context.refuse(
                        "The model in use is not read yet: press again in a moment. If it stays so, its file cannot be used: see the log, or compare with the robot's description alone.",
                    );
                }
            },
        };
        self.failed = None;
        let work = GapWork::Find {
            sessions: self.chosen.clone(),
            rig: around.rig.clone(),
            model,
            options: Options { seed, ..Options::default() },
            store: self.store.clone(),
            at: context.time.day,
        };
        self.searching = Some(context.start(work));
    }

    fn add(&mut self, mut effects: Vec<usize>, around: &GapAround, context: &mut Context<'_>) {
        let Some(finding) = self.shown_named().cloned() else {
            return context.refuse("Find what is missing first, then add it.");
        };
        if let Some(why) = self.stale() {
            return context.refuse(why);
        }
        let named = &finding.kept.finding;
        if effects.is_empty() && !self.seen.sizes_arm {
            return context.refuse("Choose what to add first.");
        }
        if !effects.is_empty() && named.verdict == Verdict::NotInLibrary && !named.partial {
            return context
                .refuse("What is missing is not in the library, so there is nothing to add by name.");
        }
        for &i in &effects {
            match named.effects.get(i).map(|effect| &effect.not_addable) {
                Some(None) => {}
                Some(Some(why)) => return context.refuse(why),
                None => return context.refuse("The finding has no such effect."),
            }
        }
        let Some(model) = self.model_for_change(context) else { return };
        let replaces = finding.kept.model_effects.is_empty();
        if replaces && let Some(shown) = &self.seen.shown {
            // What of this finding is in the model stays there.
            let added =
                (0..shown.added.len()).filter(|i| shown.added[*i] && named.effects[*i].not_addable.is_none());
            effects.extend(added);
            effects.sort_unstable();
            effects.dedup();
        }
        let (rig, folder) = (around.rig.clone(), self.folder.clone());
        let work = GapWork::Add { finding, effects, replaces, model, rig, folder, at: context.time.day };
        self.changing = Some(context.start(work));
    }

    fn change(
        &mut self,
        title: &str,
        around: &GapAround,
        context: &mut Context<'_>,
        change: impl FnOnce(&mut RigModel) -> Result<(), RigModelError>,
    ) {
        let Some(model) = self.model_for_change(context) else { return };
        let mut next = (*model).clone();
        if let Err(why) = change(&mut next) {
            return context.refuse(crate::ground::text::sentence(&why.to_string()));
        }
        let work = GapWork::Use {
            folder: self.folder.clone(),
            rig: around.rig.clone(),
            model: Arc::new(next),
            title: title.to_owned(),
        };
        self.changing = Some(context.start(work));
    }

    /// A model that was made of the one in use elsewhere is put in use.
    pub fn put_in_use(&mut self, model: RigModel, around: &GapAround, context: &mut Context<'_>) {
        self.change("Tie the arms to the eyes", around, context, |in_use| {
            *in_use = model;
            Ok(())
        });
        self.look();
    }

    /// Whether the model in use is being changed: it cannot be changed once more before that is done.
    pub fn is_changing(&self) -> bool {
        self.changing.is_some()
    }

    fn model_for_change(&self, context: &mut Context<'_>) -> Option<Arc<RigModel>> {
        if self.changing.is_some() {
            context.refuse("The model in use is being changed already. Try again in a moment.");
            return None;
        }
        if self.model.is_none() {
            context.refuse(
                "The model in use could not be read, so nothing is written over it. See the log, then start the program again.",
            );
        }
        self.model.clone()
    }

    fn report(&self, file: PathBuf, pdf: bool, around: &GapAround, context: &mut Context<'_>) {
        let Some(finding) = self.shown_named().cloned() else {
            return context.refuse("Find what is missing first, then write about it.");
        };
        let history = self.model.as_ref().map(|model| model::report_history(model)).unwrap_or_default();
        let corners = around.rig.touchscreen.corners().map(|corner| [corner.coords.x, corner.coords.y]);
        let page = ReportContext {
            date: context.time.day.to_zoned(jiff::tz::TimeZone::system()).strftime("%-d %B %Y").to_string(),
            model: finding.kept.model.clone(),
            history,
            screen_m: Some(corners),
        };
        context.start(GapWork::Report { finding, context: Box::new(page), file, pdf });
    }

    /// A run of touches is finished: it is compared next, and is in the list.
    pub fn touched(&mut self, session: &Path, context: &mut Context<'_>) {
        if is_measured(session) {
            self.chosen = with_finished(std::mem::take(&mut self.chosen), session);
        }
        self.list(context);
    }

    /// What the eyes watched is explained: compared with the model in use, and nothing else beside it.
    pub fn explain(&mut self, session: &Path, around: &GapAround, context: &mut Context<'_>) {
        self.chosen = vec![session.to_owned()];
        self.with = GapModel::InUse;
        self.list(context);
        self.find(Options::default().seed, around, context);
        self.look();
    }

    /// Why the shown finding does not tell about now any more.
    pub(super) fn stale(&self) -> Option<String> {
        let kept = &self.shown_named()?.kept;
        if let Some(changed) = kept.sessions.iter().find(|session| self.changed.contains(&session.folder)) {
            return Some(format!(
                "{} changed or is gone since this was found. Find what is missing again.",
                crate::ground::sessions::title_of(&changed.folder)
            ));
        }
        None
    }

    /// The same sessions with another model are worth seeing side by side.
    fn is_comparable(&self, id: &str, with: &Named) -> bool {
        self.named(id).is_some_and(|named| {
            named.kept.finding.sessions == with.kept.finding.sessions
                && named.kept.model_effects != with.kept.model_effects
        })
    }

    fn restored(&mut self, restored: Restored, around: &GapAround, context: &mut Context<'_>) {
        for problem in &restored.problems {
            context.notices.add(NoticeLevel::Warning, &**problem);
        }
        self.sessions = restored.sessions;
        self.shown = restored.findings.first().map(|named| named.id.clone());
        self.findings = restored.findings;
        self.changed = restored.changed;
        (self.model, self.moved_m) = (restored.model, restored.moved_m);
        self.choose_first(around);
        self.list_chosen(context);
    }

    /// What is chosen stands in the list, wherever it lies. What was read before it was chosen may come
    /// in later: works run side by side.
    fn list_chosen(&self, context: &mut Context<'_>) {
        if self.chosen.iter().any(|chosen| !self.sessions.iter().any(|s| s.folder == *chosen)) {
            self.list(context);
        }
    }

    /// Something is chosen, so that there is something to compare.
    fn choose_first(&mut self, around: &GapAround) {
        if !self.chosen.is_empty() {
            return;
        }
        let usable = self.sessions.iter().filter(|session| session.problem.is_none());
        let usable = || usable.clone().map(|session| session.folder.as_path());
        let newest = around.newest_session.as_deref();
        let first = newest.filter(|newest| is_for_training(newest));
        let first = first.or_else(|| usable().find(|folder| is_for_training(folder)));
        let first = first.or(newest).or_else(|| usable().next());
        self.chosen = first.map(Path::to_owned).into_iter().collect();
    }
}

impl Workflow for GapWorkflow {
    type Command = GapCommand;
    type Work = GapWork;
    type Control = Nothing;
    type Around = GapAround;
    type View = GapView;

    /// Nothing found. Sessions are looked for in `folder/sessions`, findings are kept in `folder/gap`.
    fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            store: Store::new(folder.join("gap")),
            sessions: Vec::new(),
            chosen: Vec::new(),
            with: GapModel::default(),
            searching: None,
            failed: None,
            findings: Vec::new(),
            changed: Vec::new(),
            shown: None,
            beside: None,
            left_out: LeftOut::default(),
            model: None,
            moved_m: Vec::new(),
            changing: None,
            not_sized: Vec::new(),
            seen: Seen::default(),
        }
    }

    fn view(&mut self, around: &GapAround, _: &Moment) -> Arc<GapView> {
        Arc::new(self.shown(around))
    }

    fn restore(&mut self, around: &GapAround, context: &mut Context<'_>) {
        context.start(GapWork::Restore { folder: self.folder.clone(), rig: around.rig.clone() });
    }

    fn apply(&mut self, command: GapCommand, around: &GapAround, context: &mut Context<'_>) {
        match command {
            GapCommand::ListSessions => self.list(context),
            GapCommand::Choose { sessions } => {
                self.chosen = sessions;
                self.failed = None;
                self.list_chosen(context);
            }
            GapCommand::CompareWith(with) => self.with = with,
            GapCommand::Find { seed } => self.find(seed, around, context),
            GapCommand::Show { id } => {
                if self.named(&id).is_some() {
                    self.beside.take_if(|beside| *beside == id);
                    self.shown = Some(id);
                }
            }
            GapCommand::Beside { id } => {
                self.beside = id.filter(|id| self.named(id).is_some() && self.shown.as_ref() != Some(id));
            }
            GapCommand::Delete { id } => {
                context.start(GapWork::Delete { store: self.store.clone(), id });
            }
            GapCommand::LeaveOut { effect, is_left_out } => {
                self.left_out.effects.retain(|other| *other != effect);
                if is_left_out {
                    self.left_out.effects.push(effect);
                }
            }
            GapCommand::Add { effects } => self.add(effects, around, context),
            GapCommand::Redo => self.change("Put back what was taken back", around, context, RigModel::redo),
            GapCommand::Undo => {
                let at = context.time.day;
                self.change("Go back to the model before", around, context, |model| model.undo(at));
            }
            GapCommand::UseNominal => {
                let at = context.time.day;
                self.change("Take all effects out of the model", around, context, |model| {
                    for effect in model.effects().to_vec() {
                        // An effect that was added twice goes with the first of its parts.
                        let _ = model.remove(&effect.id, &effect.site, at);
                    }
                    Ok(())
                });
            }
            GapCommand::Report { file, pdf } => self.report(file, pdf, around, context),
        }
        self.look();
    }

    fn work_done(&mut self, id: JobId, result: GapResult, around: &GapAround, context: &mut Context<'_>) {
        self.searching.take_if(|searching| *searching == id);
        self.changing.take_if(|changing| *changing == id);
        match result {
            GapResult::Restored(restored) => self.restored(*restored, around, context),
            GapResult::Listed { sessions, changed } => {
                (self.sessions, self.changed) = (sessions, changed);
                self.choose_first(around);
                self.list_chosen(context);
            }
            GapResult::Found(named) => {
                let before = self.shown.replace(named.id.clone());
                self.beside = before.filter(|before| self.is_comparable(before, &named));
                self.findings.insert(0, named);
            }
            GapResult::Deleted(id) => {
                self.findings.retain(|named| named.id != id);
                self.beside.take_if(|beside| *beside == id);
                if self.shown.take_if(|shown| *shown == id).is_some() {
                    self.shown = self.findings.first().map(|named| named.id.clone());
                }
            }
            GapResult::InUse(model, moved_m) => (self.model, self.moved_m) = (Some(model), moved_m),
            GapResult::NotSized(id) => {
                context.notices.add(NoticeLevel::Info, NOT_SIZED);
                self.not_sized.push(id);
            }
            GapResult::Written(_) => {}
        }
        self.look();
    }

    fn work_ended(&mut self, id: JobId, why: Option<&str>, _: &GapAround, _: &mut Context<'_>) {
        if self.searching.take_if(|searching| *searching == id).is_some() {
            self.failed = why.map(str::to_owned);
        }
        self.changing.take_if(|changing| *changing == id);
    }
}
