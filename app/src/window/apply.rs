//! Carrying out what was asked for during a frame.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

use plumbline_engine::view::{JobState, SourceStatus};
use plumbline_engine::{
    BoxEdit, Command, Destination, DetectCommand, DetectorChoice, EyesCommand, FileLength, GapCommand,
    JobCommand, LabelsCommand, LiveCommand, ModelsCommand, MountCommand, NoticeCommand, NoticeLevel,
    ProbePoint, RobotCommand, ScoresCommand, SourceCommand, TablesCommand, TouchCommand, TwinCommand,
    WatchCommand,
};
use plumbline_model::Eye;
use plumbline_model::robot::JointIndex;
use plumbline_widgets::Seen;

use super::PlumblineWindow;
use super::arrangement::default_arrangement;
use super::ask::Ask;
use super::dialogs::{Answer, Question};
use super::frame_time::{FrameTimes, resident_mb};
use super::jogging::RENEW;
use super::saving::save_picture;
use super::script_step::ScriptStep;
use super::settings::ThemeChoice;
use super::sheet::Asked;
use crate::operator::guidance::guidance;
use crate::operator::{
    Action, DetectAction, GapAction, LabelsAction, ModelsAction, Outbox, Pane, Preset, RobotAction,
    ScoresAction, Screen, TouchAction, gap_plan,
};

/// A message of the window itself.
pub(super) fn warning(text: impl Into<String>) -> Command {
    NoticeCommand::Add { level: NoticeLevel::Warning, text: text.into() }.into()
}

impl PlumblineWindow {
    pub(super) fn carry_out(&mut self, ctx: &egui::Context, outbox: Outbox) {
        if self.wanted != Some(outbox.wanted) {
            self.wanted = Some(outbox.wanted);
            self.backend.send(LiveCommand::Want(outbox.wanted).into());
        }
        self.panels.objects.end_frame(&self.view);
        self.panels.probe.follow(outbox.probe, &mut |command| self.backend.send(command.into()));
        for command in outbox.commands {
            self.send(command);
        }
        let backend = &self.backend;
        self.jogging.follow(outbox.jog, Instant::now(), &mut |command| backend.send(command.into()));
        if self.jogging.active() {
            ctx.request_repaint_after(RENEW);
        }
        for action in outbox.actions {
            self.act(ctx, action);
        }
        if let Some(picture) = outbox.copy {
            ctx.copy_image(picture.image().as_ref().clone());
            self.notices.say("The picture is on the clipboard.");
        }
        if let Some(picture) = outbox.save {
            self.pending_picture = Some(Arc::clone(picture.image()));
            self.ask_for(ctx, Question::SaveView);
        }
    }

    /// Hands a command over; one that begins a motion keeps the window drawing.
    pub(super) fn send(&mut self, command: Command) {
        if matches!(
            command,
            Command::Robot(RobotCommand::RunPreview)
                | Command::Mount(MountCommand::Tour)
                | Command::Touch(TouchCommand::Start | TouchCommand::Resume)
        ) {
            self.motion_asked = Some(Instant::now());
        }
        self.backend.send(command);
    }

    pub(super) fn act(&mut self, ctx: &egui::Context, action: Action) {
        if let Some(why) = action.refusal(&self.view) {
            self.notices.say(&format!("{}: {why}.", action.label().trim_end_matches('…')));
            return;
        }
        if let Some(command) = self.command_of(action) {
            // Showing the board is for capturing pairs of it.
            let collecting = self.settings.screen == Screen::Collect && !self.view.eyes.auto_capture;
            if action == Action::Robot(RobotAction::TourBoard) && collecting {
                self.send(EyesCommand::AutoCapture(true).into());
            }
            self.send(command);
            return;
        }
        match action {
            Action::Stop => self.stop(),
            Action::Touch(TouchAction::ToggleWindow) => {
                self.panels.touch.window_open = !self.panels.touch.window_open;
            }
            Action::Next => {
                if let Some(next) = guidance(&self.view, self.settings.screen).next {
                    self.act(ctx, next.action);
                }
            }
            Action::Robot(RobotAction::Connect) => {
                self.backend.send(RobotCommand::ListPorts.into());
                self.ask = Some(Ask::Connect(Default::default()));
            }
            Action::Robot(RobotAction::TorqueOff) => self.ask = Some(Ask::LetGo),
            Action::Robot(RobotAction::ShortenAnswers) => self.ask = Some(Ask::ShortenAnswers),
            Action::Robot(RobotAction::SavePose) => self.ask = Some(Ask::SavePose { title: String::new() }),
            Action::OpenFolder => self.ask_for(ctx, Question::Folder),
            Action::OpenTwoFolders => self.ask_for(ctx, Question::TwoFolders),
            Action::OpenVideos => self.ask_for(ctx, Question::TwoVideos),
            Action::OpenPath => self.ask = Some(Ask::paths(Question::Folder)),
            Action::OpenCameras => {
                self.backend.send(SourceCommand::ListCameras.into());
                self.ask = Some(Ask::Cameras { left: 0, right: 1 });
            }
            Action::DeleteAll => self.ask = Some(Ask::DeleteAll { count: self.view.eyes.collected.len() }),
            Action::Import => self.ask_for(ctx, Question::Import),
            Action::Export(what, format) => self.ask_for(ctx, Question::Export(what, format)),
            Action::SaveWindow => self.ask_for(ctx, Question::SaveWindow),
            Action::Detect(DetectAction::ToggleBoxes) => {
                self.panels.objects.shown = !self.panels.objects.shown;
            }
            Action::Detect(DetectAction::ChooseFile) => self.ask_for(ctx, Question::Detector),
            Action::Models(action) => self.act_on_models(ctx, action),
            Action::Gap(action) => self.act_on_gap(ctx, action),
            Action::Labels(action) => self.act_on_labels(ctx, action),
            Action::Scores(ScoresAction::AddModels) => self.ask_for(ctx, Question::ScoreModels),
            Action::Scores(ScoresAction::ChooseSet) => self.ask_for(ctx, Question::ScoreSet),
            Action::Scores(ScoresAction::ExportCsv) => self.ask_for(ctx, Question::ScoresCsv),
            Action::Go(screen) => self.settings.screen = screen,
            Action::Palette => self.palette.toggle(),
            Action::ToggleInspector => self.settings.inspector_open = !self.settings.inspector_open,
            Action::ToggleLog => self.settings.log_open = !self.settings.log_open,
            Action::ToggleNotices => self.notices.toggle_history(),
            Action::ToggleTheme => self.toggle_theme(ctx),
            Action::ResetArrangement => self.reset_arrangement(self.settings.screen),
            Action::ResetAllArrangements => Screen::ALL.into_iter().for_each(|s| self.reset_arrangement(s)),
            Action::ToggleFrameTimes => self.frame_times_open = !self.frame_times_open,
            Action::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
            _ => {}
        }
    }

    /// The actions on models that ask for a file, or go somewhere else.
    fn act_on_models(&mut self, ctx: &egui::Context, action: ModelsAction) {
        match action {
            ModelsAction::OpenSession => self.ask_for(ctx, Question::TouchSession),
            ModelsAction::Import => self.ask_for(ctx, Question::ImportModel),
            ModelsAction::Export { method, onnx } => self.ask_for(ctx, Question::ExportModel(method, onnx)),
            ModelsAction::ImportTable(table) => self.ask_for(ctx, Question::ImportTable(table)),
            ModelsAction::ExportTable(table) => self.ask_for(ctx, Question::ExportTable(table)),
            ModelsAction::Check => {
                let method = self.view.models.in_use.as_ref().map(|model| model.method());
                self.settings.screen = Screen::Touch;
                self.send(TouchCommand::CorrectWith(method.map(Into::into)).into());
                if let Some(plan) = TouchAction::Plan(Preset::Check).command(&self.view) {
                    self.send(plan);
                }
            }
            _ => {}
        }
    }

    /// The actions on the gap that ask for a file, or go somewhere else.
    fn act_on_gap(&mut self, ctx: &egui::Context, action: GapAction) {
        match action {
            GapAction::OpenSession => self.ask_for(ctx, Question::GapSession),
            GapAction::ReportHtml => self.ask_for(ctx, Question::GapReport { pdf: false }),
            GapAction::ReportPdf => self.ask_for(ctx, Question::GapReport { pdf: true }),
            GapAction::NextExperiment => {
                if let Some(plan) = gap_plan(&self.view) {
                    self.settings.screen = Screen::Touch;
                    self.send(plan);
                }
            }
            _ => {}
        }
    }

    /// The actions on data sets that ask for a folder, or need the box that is chosen.
    fn act_on_labels(&mut self, ctx: &egui::Context, action: LabelsAction) {
        match action {
            LabelsAction::Open => self.ask_for(ctx, Question::LabelSet),
            LabelsAction::Create => self.ask = Some(Ask::new_label_set()),
            LabelsAction::Export => self.ask_for(ctx, Question::ExportLabels),
            LabelsAction::Import => self.ask_for(ctx, Question::ImportLabels),
            LabelsAction::DeleteBox => {
                if let Some(command) = self.panels.labels.delete_chosen(&self.view) {
                    self.send(command);
                }
            }
            LabelsAction::Class(class) => {
                if let Some(command) = self.panels.labels.choose_class(&self.view, class) {
                    self.send(command);
                }
            }
            _ => {}
        }
    }

    /// The actions that are nothing but a command to the engine.
    fn command_of(&self, action: Action) -> Option<Command> {
        let replay = self.view.source.replay;
        Some(match action {
            Action::CloseSource => SourceCommand::Close.into(),
            Action::RetrySource => SourceCommand::Retry.into(),
            Action::PlayPause if replay?.playing => SourceCommand::Pause.into(),
            Action::PlayPause => SourceCommand::Play.into(),
            Action::StepForward => SourceCommand::Step(1).into(),
            Action::StepBack => SourceCommand::Step(-1).into(),
            Action::ToggleLoop => SourceCommand::Loop(!replay?.looping).into(),
            Action::RecognizeBoard => EyesCommand::RecognizeBoard.into(),
            Action::UseSeenBoard => {
                let eyes = &self.view.eyes;
                let seen = eyes.board_seen.as_ref()?.inner_corners?;
                let (columns, rows) = (seen.columns + 1, seen.rows + 1);
                EyesCommand::ChooseBoard { columns, rows, square_m: eyes.board.square_m }.into()
            }
            Action::Capture => EyesCommand::Capture.into(),
            Action::ToggleAutoCapture => EyesCommand::AutoCapture(!self.view.eyes.auto_capture).into(),
            Action::CollectRecording => EyesCommand::CollectRecording.into(),
            Action::DeleteLast => EyesCommand::DeleteLast.into(),
            Action::Undo => EyesCommand::Undo.into(),
            Action::Solve => EyesCommand::Solve.into(),
            Action::Accept => EyesCommand::Accept.into(),
            Action::Discard => EyesCommand::Discard.into(),
            Action::Robot(action) => return action.command(&self.view),
            Action::Mount(action) => action.command(),
            Action::Touch(action) => return action.command(&self.view),
            Action::Models(action) => return action.command(&self.view),
            Action::Gap(action) => return action.command(&self.view),
            Action::Grasp(action) => return action.command(&self.view),
            Action::Labels(action) => return action.command(&self.view),
            Action::Scores(action) => return action.command(&self.view),
            Action::Detect(action) => return action.command(),
            Action::StartAgain(thread) => WatchCommand::StartAgain(thread).into(),
            Action::CancelJob => JobCommand::Cancel(self.view.running_job()?.id).into(),
            _ => return None,
        })
    }

    /// The arm first; then jobs, replay, automatic capture and the tour of the board.
    pub(super) fn stop(&mut self) {
        self.backend.stop();
        self.stopped_at = Some(Instant::now());
        for job in self.view.jobs.iter().filter(|job| job.state.is_running()) {
            self.backend.send(JobCommand::Cancel(job.id).into());
        }
        if self.view.twin.running {
            self.backend.send(TwinCommand::TourBoard(false).into());
        }
        if self.view.eyes.auto_capture {
            self.backend.send(EyesCommand::AutoCapture(false).into());
        }
        if self.view.source.replay.is_some_and(|replay| replay.playing) {
            self.backend.send(SourceCommand::Pause.into());
        }
    }

    fn toggle_theme(&mut self, ctx: &egui::Context) {
        let dark = ctx.theme() == egui::Theme::Dark;
        self.settings.theme = if dark { ThemeChoice::Light } else { ThemeChoice::Dark };
        ctx.set_theme(self.settings.theme.preference());
    }

    fn reset_arrangement(&mut self, screen: Screen) {
        self.settings.arrangements.insert(screen, default_arrangement(screen));
    }

    fn ask_for(&mut self, ctx: &egui::Context, question: Question) {
        if let Some(answer) = self.dialogs.ask(question) {
            self.take_answer(ctx, answer);
        }
    }

    pub(super) fn take_answer(&mut self, ctx: &egui::Context, answer: Answer) {
        match answer {
            Answer::Cancelled => {}
            Answer::NoDialog(question) => self.ask = Some(Ask::paths(question)),
            Answer::Paths(question, mut paths) => match (question, paths.len()) {
                (_, 0) => {}
                (Question::Folder, _) => self.backend.send(SourceCommand::OpenPaths(paths).into()),
                (Question::TwoFolders | Question::TwoVideos, 2) => {
                    self.backend.send(SourceCommand::OpenPaths(paths).into());
                }
                (Question::TwoFolders | Question::TwoVideos, _) => {}
                (Question::Import, _) => {
                    let import = EyesCommand::Import { files: paths, length: FileLength::AsPrescribed };
                    self.backend.send(import.into());
                }
                (Question::Export(what, format), _) => {
                    self.backend.send(EyesCommand::Export { what, format, file: paths.remove(0) }.into());
                }
                (Question::Detector, _) => {
                    self.send(DetectCommand::Use(DetectorChoice::File(paths.remove(0))).into());
                }
                (Question::TouchSession, _) => {
                    self.send(ModelsCommand::ChooseSession { session: paths.remove(0) }.into());
                }
                (Question::GapSession, _) => {
                    self.send(GapCommand::Choose { sessions: vec![paths.remove(0)] }.into());
                }
                (Question::GapReport { pdf }, _) => {
                    self.send(GapCommand::Report { file: paths.remove(0), pdf }.into());
                }
                (Question::LabelSet, _) => {
                    self.settings.screen = Screen::Images;
                    self.send(LabelsCommand::Open { path: paths.remove(0) }.into());
                }
                (Question::ExportLabels, _) => {
                    let folder = paths.remove(0);
                    self.send(LabelsCommand::Export { folder, train_percent: 80, seed: 1 }.into());
                }
                (Question::ImportLabels, _) => {
                    self.send(LabelsCommand::Import { path: paths.remove(0) }.into());
                }
                (Question::ScoreModels, _) => self.send(ScoresCommand::AddModels { files: paths }.into()),
                (Question::ScoreSet, _) => {
                    self.send(ScoresCommand::ChooseSet { path: paths.remove(0) }.into());
                }
                (Question::ScoresCsv, _) => {
                    self.send(ScoresCommand::ExportCsv { file: paths.remove(0) }.into());
                }
                (Question::ImportModel, _) => {
                    self.send(ModelsCommand::Import { file: paths.remove(0) }.into());
                }
                (Question::ExportModel(method, onnx), _) => {
                    self.send(ModelsCommand::Export { method, onnx, file: paths.remove(0) }.into());
                }
                (Question::ImportTable(table), _) => {
                    let import = TablesCommand::Import { table, file: paths.remove(0) };
                    self.send(ModelsCommand::Tables(import).into());
                }
                (Question::ExportTable(table), _) => {
                    let export = TablesCommand::Export { table, file: paths.remove(0) };
                    self.send(ModelsCommand::Tables(export).into());
                }
                (Question::SaveWindow, _) => self.save_window(ctx, paths.remove(0)),
                (Question::SaveView, _) => {
                    if let Some(picture) = self.pending_picture.take() {
                        save_picture(ctx, &picture, paths.remove(0), |_| {});
                    }
                }
            },
        }
    }

    pub(super) fn show_ask(&mut self, ctx: &egui::Context, escape_pressed: bool, outbox: &mut Outbox) {
        let Some(ask) = &mut self.ask else { return };
        match ask.show(ctx, &self.view, escape_pressed) {
            Asked::Open => {}
            Asked::Closed => self.ask = None,
            Asked::Command(command) => {
                self.ask = None;
                outbox.send(command);
            }
            Asked::CommandKeepOpen(command) => outbox.send(command),
            Asked::Answer(answer) => {
                self.ask = None;
                self.take_answer(ctx, answer);
            }
        }
    }

    pub(super) fn do_script_step(&mut self, ctx: &egui::Context, step: ScriptStep) {
        match step {
            ScriptStep::Act(action) => self.act(ctx, action),
            ScriptStep::Pair(index) => {
                self.panels.chosen_pair = self.view.eyes.collected.get(index).map(|pair| pair.name.clone());
            }
            ScriptStep::Probe([u_px, v_px]) => {
                self.panels.probe.pinned = Some(ProbePoint::Raw { eye: Eye::Left, u_px, v_px });
            }
            ScriptStep::Object(name) => self.panels.objects.choose_class(&self.view, &name),
            ScriptStep::DrawBox(class, area) => {
                if let Some(shown) = &self.view.labels.shown {
                    let (image, edit) = (shown.name.clone(), BoxEdit::Add { class, area });
                    self.send(LabelsCommand::Edit { image, edit }.into());
                }
            }
            ScriptStep::ChooseBox(index) => self.panels.labels.canvas.chosen = Some(index),
            ScriptStep::Show(pane) => self.show_pane(self.settings.screen, pane),
            ScriptStep::Errors(errors) => {
                (self.panels.models.errors, self.panels.gap.errors) = (errors, errors)
            }
            ScriptStep::Measure => {
                self.frame_times = FrameTimes::default();
                self.resident_before_mb = resident_mb();
            }
            ScriptStep::Send(command) => self.send(command),
            ScriptStep::PreviewJoint(name, degrees) => {
                if let Some(joint) = self.joint_called(&name) {
                    let to = Destination::Joint { joint, angle_rad: degrees.to_radians() };
                    self.send(RobotCommand::Preview(to).into());
                }
            }
            ScriptStep::Joint(name) => self.panels.robot.chosen_joint = self.joint_called(&name),
            ScriptStep::Wait(_) => {}
            ScriptStep::Picture(file) => {
                self.script.waiting_for_picture.store(true, Ordering::Relaxed);
                let waiting = Arc::clone(&self.script.waiting_for_picture);
                let again = ctx.clone();
                ctx.request_screenshot(move |picture| {
                    save_picture(&again, &picture, file, move |_| waiting.store(false, Ordering::Relaxed));
                });
            }
            ScriptStep::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
        }
    }

    fn joint_called(&self, name: &str) -> Option<JointIndex> {
        let found = self.view.robot.rig.as_ref()?.description.find_joint(name);
        found.inspect_err(|error| log::warn!("{error}")).ok()
    }

    fn save_window(&self, ctx: &egui::Context, file: PathBuf) {
        let again = ctx.clone();
        ctx.request_screenshot(move |picture| save_picture(&again, &picture, file, |_| {}));
    }

    /// Opens the screen where the work goes on: judging once there is something to judge.
    pub(super) fn follow_the_work(&mut self) {
        let eyes = &self.view.eyes;
        let now = Seen::of_any(eyes.proposal.as_ref().map(|proposal| &proposal.calibration));
        if now.is_some() && now != self.panels.proposal_seen && self.settings.screen == Screen::Collect {
            self.settings.screen = Screen::Judge;
        }
        self.panels.proposal_seen = now;
        if let (Some(spec), SourceStatus::Running) = (&self.view.source.spec, &self.view.source.status)
            && self.settings.recent_sources.front() != Some(spec)
        {
            self.settings.remember_source(spec);
        }
        self.follow_the_models();
        self.follow_the_gap();
        self.follow_the_labels();
        self.dismiss_ended_jobs();
    }

    /// Training is watched; once there are proposals, they are compared.
    fn follow_the_models(&mut self) {
        let models = &self.view.models;
        let trained_before = std::mem::replace(&mut self.panels.models.training_seen, models.training);
        let pane = match (trained_before, models.training) {
            (false, true) => Pane::ModelTraining,
            (true, false) if !models.proposals.is_empty() => Pane::ModelComparison,
            _ => return,
        };
        self.show_pane(Screen::Models, pane);
    }

    /// What was found is named, and judged on held-out rows.
    fn follow_the_gap(&mut self) {
        let gap = &self.view.gap;
        let searched_before = std::mem::replace(&mut self.panels.gap.searching_seen, gap.searching.is_some());
        if searched_before && gap.searching.is_none() && gap.failed.is_none() && gap.shown.is_some() {
            self.show_pane(Screen::Gap, Pane::GapNames);
            self.show_pane(Screen::Gap, Pane::GapShown);
        }
    }

    /// What an import would do is seen before it can be accepted.
    fn follow_the_labels(&mut self) {
        let waits = self.view.labels.import.is_some();
        let pane = match (std::mem::replace(&mut self.panels.labels.import_seen, waits), waits) {
            (false, true) => Pane::LabelChecks,
            (true, false) => Pane::LabelList,
            _ => return,
        };
        self.show_pane(Screen::Images, pane);
    }

    /// Brings a pane to the front of its tabs.
    fn show_pane(&mut self, screen: Screen, pane: Pane) {
        let tree = self.settings.arrangement(screen);
        tree.make_active(|_, tile| matches!(tile, egui_tiles::Tile::Pane(shown) if *shown == pane));
    }

    /// What has ended well is in the messages; only trouble stays in the bottom line.
    fn dismiss_ended_jobs(&mut self) {
        self.dismissed.retain(|id| self.view.jobs.iter().any(|job| job.id == *id));
        for job in self.view.jobs.iter() {
            let ended_well = matches!(job.state, JobState::Done { .. } | JobState::Cancelled);
            if ended_well && !self.dismissed.contains(&job.id) {
                self.dismissed.push(job.id);
                self.backend.send(JobCommand::Dismiss(job.id).into());
            }
        }
    }
}
