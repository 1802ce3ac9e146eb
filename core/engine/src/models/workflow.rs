//! What is trained, proposed, in use.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use plumbline_correction::{Comparison, CorrectionModel, LossPoint, Method, TouchData};
use plumbline_model::robot::Rig;

use super::command::ModelsCommand;
use super::error::ModelError;
use super::learn::Trained;
use super::losses::Losses;
use super::screen::Corners;
use super::store::{History, Store};
use super::tables::TablesEditor;
use super::view::{ModelMap, TouchSession};
use super::work::{Context, ModelsResult, ModelsWork, Restored, screen_of};
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::ground::sessions::is_for_training;
use crate::ground::{Moment, Nothing, Workflow};
use crate::models::view::ModelsView;
use crate::robot::view::RobotView;

/// What the workflow can see of the rest.
pub struct ModelsAround {
    /// The robot as its description has it, the screen where it was measured to lie.
    pub rig: Arc<Rig>,
    /// The robot now.
    pub robot: Arc<RobotView>,
    /// The session that was touched last; offered first.
    pub newest_session: Option<PathBuf>,
}

/// A model that waits to be accepted.
#[derive(Clone, Debug)]
pub(super) struct Proposal {
    pub model: Arc<CorrectionModel>,
    pub map: Arc<ModelMap>,
    /// Where the screen was taken to lie when it was made.
    pub screen_m: Corners,
}

/// Training that is under way; it changes nothing before it is done.
#[derive(Clone, Debug)]
pub(super) struct Training {
    id: JobId,
    session: PathBuf,
    losses: Losses,
    screen_m: Corners,
}

/// The model in use.
#[derive(Clone, Debug)]
pub(super) struct InUse {
    pub model: Arc<CorrectionModel>,
    pub map: Arc<ModelMap>,
}

/// The whole workflow, of one world.
#[derive(Clone, Debug)]
pub struct ModelsWorkflow {
    folder: PathBuf,
    store: Store,
    pub(super) sessions: Vec<TouchSession>,
    pub(super) session: Option<PathBuf>,
    pub(super) data: Option<Result<Arc<TouchData>, Arc<ModelError>>>,
    /// Of the last training that was not cancelled.
    losses: Losses,
    pub(super) training: Option<Training>,
    /// Work that changes what is in use.
    pub(super) changing: Option<JobId>,
    pub(super) proposals: BTreeMap<Method, Proposal>,
    pub(super) comparison: Option<Arc<Comparison>>,
    pub(super) shown: Option<Method>,
    pub(super) in_use: Option<InUse>,
    /// `None`: the list on disk cannot be used, so nothing is written over it.
    pub(super) history: Option<History>,
    pub(super) tables: TablesEditor,
}

impl ModelsWorkflow {
    /// The model in use.
    pub fn in_use(&self) -> Option<&Arc<CorrectionModel>> {
        self.in_use.as_ref().map(|in_use| &in_use.model)
    }

    /// The name of the model in use on its shelf, and the model; `None`: not read yet, or it cannot be.
    pub fn accepted(&self) -> Option<(Option<String>, Option<&Arc<CorrectionModel>>)> {
        let history = self.history.as_ref()?;
        Some((history.in_use().map(|kept| kept.file.clone()), self.in_use()))
    }

    /// Mean error in the plane without a model at the touches that the one in use was judged on, m.
    pub fn mean_before_m(&self) -> Option<f64> {
        self.in_use.as_ref()?.map.without_m
    }

    /// Proposals, then the one in use.
    pub fn usable(&self) -> Vec<Arc<CorrectionModel>> {
        self.proposals.values().map(|proposal| &proposal.model).chain(self.in_use()).cloned().collect()
    }

    /// Loss curves, as they grow or as they were.
    pub(super) fn loss_points(&self) -> Arc<[LossPoint]> {
        self.training.as_ref().map_or(&self.losses, |training| &training.losses).points()
    }

    /// The proposal of this kind, else the one in use.
    fn model(&self, method: Method) -> Option<Arc<CorrectionModel>> {
        self.usable().into_iter().find(|model| model.method() == method)
    }

    /// A run of touches is finished: it is learned from next, and is in the list.
    pub fn touched(&mut self, session: &Path, around: &ModelsAround, context: &mut Context<'_>) {
        context.start(ModelsWork::List { folder: self.folder.join("sessions") });
        if is_for_training(session) {
            self.choose(session.to_owned(), around, context);
        }
    }

    fn choose(&mut self, session: PathBuf, around: &ModelsAround, context: &mut Context<'_>) {
        self.session = Some(session.clone());
        self.data = None;
        context.start(ModelsWork::Read { session, rig: around.rig.clone() });
    }

    fn train(
        &mut self,
        methods: Vec<Method>,
        (seed, published_recipe): (u64, bool),
        around: &ModelsAround,
        context: &mut Context<'_>,
    ) {
        if self.training.is_some() {
            return context.refuse("Models are being trained already. Wait for them, or cancel that first.");
        }
        if methods.is_empty() {
            return context.refuse("Choose at least one of M1, M2 and M3 to train.");
        }
        let newest = around.newest_session.as_deref().filter(|newest| is_for_training(newest));
        let session = self.session.clone().or_else(|| newest.map(Path::to_owned));
        let Some(session) = session else {
            return context
                .refuse("Choose a session with touches first, or touch the screen: step 3, Touch.");
        };
        let losses = Losses::default();
        let work = ModelsWork::Train {
            session: session.clone(),
            rig: around.rig.clone(),
            methods,
            seed,
            published_recipe,
            losses: losses.clone(),
        };
        let id = context.start(work);
        self.training = Some(Training { id, session, losses, screen_m: screen_of(&around.rig) });
    }

    fn accept(&mut self, method: Method, context: &mut Context<'_>) {
        match self.proposals.get(&method) {
            Some(proposal) => {
                let model = Some((proposal.model.clone(), proposal.screen_m));
                self.change(model, context);
            }
            None => context.refuse(no_model(method)),
        }
    }

    /// Makes a model, or none, the one in use.
    fn change(&mut self, model: Option<(Arc<CorrectionModel>, Corners)>, context: &mut Context<'_>) {
        if let Some(history) = self.history_for_change(context) {
            let work =
                ModelsWork::Accept { store: self.store.clone(), history, model, accepted: context.time.day };
            self.changing = Some(context.start(work));
        }
    }

    fn undo(&mut self, around: &ModelsAround, context: &mut Context<'_>) {
        let Some(history) = self.history_for_change(context) else { return };
        if history.entries.len() < 2 {
            return context.refuse("Nothing was in use before this.");
        }
        let work = ModelsWork::Undo { store: self.store.clone(), history, rig: around.rig.clone() };
        self.changing = Some(context.start(work));
    }

    fn history_for_change(&self, context: &mut Context<'_>) -> Option<History> {
        if self.changing.is_some() {
            context.refuse("The model in use is being changed already. Try again in a moment.");
            return None;
        }
        if self.history.is_none() {
            context.refuse(
                "The list of accepted models could not be read, so nothing is written over it. See the log, then start the program again.",
            );
        }
        self.history.clone()
    }

    fn trained(&mut self, trained: Trained, training: Training) {
        let Training { session, losses, screen_m, .. } = training;
        (self.session, self.losses) = (Some(session), losses);
        self.data = Some(Ok(trained.data));
        self.comparison = Some(trained.comparison);
        for model in trained.models {
            let method = model.method();
            if let Some(map) = trained.maps.get(&method).cloned() {
                self.shown = Some(method);
                self.proposals.insert(method, Proposal { model, map, screen_m });
            }
        }
    }

    fn restored(&mut self, restored: Restored, around: &ModelsAround, context: &mut Context<'_>) {
        for problem in &restored.problems {
            context.notices.add(NoticeLevel::Warning, &**problem);
        }
        self.history = restored.history;
        self.in_use = restored.model.map(|(model, map)| InUse { model, map });
        self.tables.restored(restored.tables, restored.figures);
        self.listed(restored.sessions, around, context);
    }

    /// The first session that can be used is chosen, so that there is something to train on.
    fn listed(&mut self, sessions: Vec<TouchSession>, around: &ModelsAround, context: &mut Context<'_>) {
        self.sessions = sessions;
        let usable = self.sessions.iter().filter(|session| session.problem.is_none());
        let first = usable.map(|session| session.folder.as_path()).find(|folder| is_for_training(folder));
        let first = around.newest_session.as_deref().filter(|newest| is_for_training(newest)).or(first);
        if let (None, Some(session)) = (&self.session, first.map(Path::to_owned)) {
            self.choose(session, around, context);
        }
    }

    /// What is taken out of use, and not replaced, can be used again.
    fn offer_again(&mut self, history: &History, none: bool) {
        let Some(before) = &self.history else { return };
        let is_undone = history.entries.len() < before.entries.len();
        let (Some(kept), Some(in_use)) = (before.in_use(), &self.in_use) else { return };
        let method = in_use.model.method();
        if (is_undone || none) && !self.proposals.contains_key(&method) {
            let map = Arc::new(ModelMap { proposed: true, ..(*in_use.map).clone() });
            let proposal = Proposal { model: in_use.model.clone(), map, screen_m: kept.screen_m };
            self.proposals.insert(method, proposal);
        }
    }

    fn use_model(
        &mut self,
        history: History,
        model: Option<Arc<CorrectionModel>>,
        map: Option<Arc<ModelMap>>,
    ) {
        self.offer_again(&history, model.is_none());
        self.history = Some(history);
        let accepted = model.as_ref().and_then(|model| {
            let proposed = self.proposals.get(&model.method())?;
            Arc::ptr_eq(&proposed.model, model).then(|| model.method())
        });
        let proposal = accepted.and_then(|method| self.proposals.remove(&method));
        // One that was offered again is no proposal beside itself, read anew from its file.
        if let Some(model) = &model {
            self.proposals.retain(|_, offered| offered.model.provenance() != model.provenance());
        }
        let own = proposal.map(|proposal| {
            let mut map = (*proposal.map).clone();
            map.proposed = false;
            Arc::new(map)
        });
        self.in_use = model.zip(map.or(own)).map(|(model, map)| InUse { model, map });
        self.shown = self.in_use().map(|model| model.method()).or(self.shown);
    }
}

impl Workflow for ModelsWorkflow {
    type Command = ModelsCommand;
    type Work = ModelsWork;
    type Control = Nothing;
    type Around = ModelsAround;
    type View = ModelsView;

    /// Nothing trained. Sessions are looked for in `folder/sessions`, models and tables are kept in
    /// `folder/models` and `folder/tables`.
    fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            store: Store::new(folder.join("models")),
            sessions: Vec::new(),
            session: None,
            data: None,
            losses: Losses::default(),
            training: None,
            changing: None,
            proposals: BTreeMap::new(),
            comparison: None,
            shown: None,
            in_use: None,
            history: None,
            tables: TablesEditor::new(folder.join("tables")),
        }
    }

    fn view(&mut self, around: &ModelsAround, _: &Moment) -> Arc<ModelsView> {
        Arc::new(self.shown(around))
    }

    fn restore(&mut self, around: &ModelsAround, context: &mut Context<'_>) {
        context.start(ModelsWork::Restore { folder: self.folder.clone(), rig: around.rig.clone() });
    }

    fn apply(&mut self, command: ModelsCommand, around: &ModelsAround, context: &mut Context<'_>) {
        match command {
            ModelsCommand::ListSessions => {
                context.start(ModelsWork::List { folder: self.folder.join("sessions") });
            }
            ModelsCommand::ChooseSession { session } => self.choose(session, around, context),
            ModelsCommand::Train { methods, seed, published_recipe } => {
                self.train(methods, (seed, published_recipe), around, context);
            }
            ModelsCommand::Show(method) => self.shown = Some(method),
            ModelsCommand::Accept(method) => self.accept(method, context),
            ModelsCommand::Discard => self.proposals.clear(),
            ModelsCommand::Undo => self.undo(around, context),
            ModelsCommand::UseNone if self.in_use.is_none() => {
                context.refuse("No model is in use: targets are sent as they are.");
            }
            ModelsCommand::UseNone => self.change(None, context),
            ModelsCommand::Import { file } => {
                context.start(ModelsWork::Import { file, rig: around.rig.clone() });
            }
            ModelsCommand::Export { method, onnx, file } => match self.model(method) {
                Some(model) => {
                    context.start(ModelsWork::Export { model, onnx, file });
                }
                None => context.refuse(no_model(method)),
            },
            ModelsCommand::Tables(command) => {
                self.tables.apply(command, &around.rig, around.robot.measured.as_ref(), context);
            }
        }
    }

    fn work_done(
        &mut self,
        id: JobId,
        result: ModelsResult,
        around: &ModelsAround,
        context: &mut Context<'_>,
    ) {
        let training = self.training.take_if(|training| training.id == id);
        self.changing.take_if(|changing| *changing == id);
        match result {
            ModelsResult::Restored(restored) => self.restored(*restored, around, context),
            ModelsResult::Listed(sessions) => self.listed(sessions, around, context),
            ModelsResult::Read { session, data } => {
                if self.session.as_ref() == Some(&session) {
                    self.data = Some(data);
                }
            }
            ModelsResult::Trained(trained) => {
                if let Some(training) = training {
                    self.trained(*trained, training);
                }
            }
            ModelsResult::InUse { history, model, map } => self.use_model(history, model, map),
            ModelsResult::Imported { model, map } => {
                self.shown = Some(model.method());
                let screen_m = screen_of(&around.rig);
                self.proposals.insert(model.method(), Proposal { model, map, screen_m });
            }
            ModelsResult::Exported(_) => {}
            ModelsResult::Tables(result) => self.tables.work_done(id, result, &around.rig, context),
        }
    }

    fn work_ended(&mut self, id: JobId, _: Option<&str>, _: &ModelsAround, _: &mut Context<'_>) {
        self.training.take_if(|training| training.id == id);
        self.changing.take_if(|changing| *changing == id);
        self.tables.work_ended(id);
    }
}

fn no_model(method: Method) -> String {
    format!("There is no {} yet. Train or import one first.", method.name())
}
