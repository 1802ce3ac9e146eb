//! Carrying out what was asked for during a frame.

use std::time::Instant;

use plumbline_engine::{
    Command, DriftCommand, EyesCommand, HandEyeCommand, JobCommand, LiveCommand, MountCommand, NoticeCommand,
    NoticeLevel, RecordingCommand, RobotCommand, SourceCommand, TouchCommand, TruthCommand, TwinCommand,
    WatchCommand,
};

use super::PlumblineWindow;
use super::about::About;
use super::arrangement::default_arrangement;
use super::ask::Ask;
use super::dialogs::Question;
use super::jogging::RENEW;
use super::settings::ThemeChoice;
use crate::operator::actions::timeline::newest as newest_undo;
use crate::operator::actions::undo::undo;
use crate::operator::guidance::guidance;
use crate::operator::words::recording_to_export;
use crate::operator::{
    Action, CommissionAction, DetectAction, GapAction, GridAction, LabelsAction, ModelsAction, Outbox,
    Preset, RobotAction, ScoresAction, Screen, TimelineAction, TouchAction, TrialsAction, gap_plan,
    gap_proof,
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
        if let Some((pane, taken)) = outbox.taken {
            self.take_from(ctx, pane, taken);
        }
    }

    /// Hands a command over; one that begins a motion keeps the window drawing.
    pub(super) fn send(&mut self, command: Command) {
        if matches!(
            command,
            Command::Robot(RobotCommand::RunPreview)
                | Command::Mount(MountCommand::Tour)
                | Command::HandEye(HandEyeCommand::Look)
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
            let shows = matches!(
                action,
                Action::Robot(RobotAction::TourBoard | RobotAction::TourFew | RobotAction::TourRest)
            );
            if shows && collecting {
                self.send(EyesCommand::AutoCapture(true).into());
            }
            self.send(command);
            // What is shown is looked at before it is run.
            if action == Action::Robot(RobotAction::ShowHome) {
                self.settings.screen = Screen::Robot;
            }
            return;
        }
        match action {
            Action::Stop => self.stop(),
            Action::Undo => self.undo(),
            Action::Touch(TouchAction::ToggleWindow) => {
                self.panels.touch.window_open = !self.panels.touch.window_open;
            }
            Action::Trials(TrialsAction::Export(format)) => self.ask_for(ctx, Question::Trials(format)),
            Action::Grid(GridAction::Open) => self.ask_for(ctx, Question::GridSession),
            Action::Commission(CommissionAction::StartAnew) => self.ask = Some(Ask::CommissionAnew),
            Action::Commission(action) => self.act_on_commission(ctx, action),
            Action::Next if self.view.commission.is_on && self.commission_rest.is_on(ctx) => {
                self.commission_rest.go_on(ctx);
            }
            Action::Next if self.view.commission.is_on => {
                self.act_on_commission(ctx, CommissionAction::Next);
            }
            Action::Next if self.primary_rest.is_on(ctx) => self.primary_rest.go_on(ctx),
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
            Action::ExportRecording => self.ask = recording_to_export(&self.view).map(Ask::export_lerobot),
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
            Action::Timeline(TimelineAction::TakeBack) => {
                if let Some(undo) = newest_undo(&self.view) {
                    self.send(undo.command);
                }
            }
            Action::Timeline(TimelineAction::Report(format)) => {
                self.ask_for(ctx, Question::SetupReport(format));
            }
            Action::Go(screen) => {
                self.settings.screen = screen;
                self.may_open_commissioning = false;
            }
            Action::Palette => self.palette.toggle(),
            Action::Help => self.manual.toggle(),
            Action::About => self.ask = Some(Ask::About(About::new(ctx, &self.renderer))),
            Action::ToggleInspector => self.settings.inspector_open = !self.settings.inspector_open,
            Action::ToggleLog => self.settings.log_open = !self.settings.log_open,
            Action::ToggleNotices => self.notices.toggle_history(ctx),
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
            GapAction::Prove => {
                if let Some(commands) = gap_proof(&self.view) {
                    self.settings.screen = Screen::Touch;
                    commands.into_iter().for_each(|command| self.send(command));
                }
            }
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
            Action::ToggleRecording if self.view.recording.is_on() => RecordingCommand::Stop.into(),
            Action::ToggleRecording => RecordingCommand::Start.into(),
            Action::WatchDrift if self.view.drift.is_watching => DriftCommand::Stop.into(),
            Action::WatchDrift => DriftCommand::Start.into(),
            Action::ExplainDrift => DriftCommand::Explain.into(),
            Action::ToggleTruth => TruthCommand::Show(!self.view.truth.is_on).into(),
            Action::PlayLastRecording => {
                SourceCommand::OpenPaths(vec![self.view.recording.last.as_ref()?.session.clone()]).into()
            }
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
            Action::Solve => EyesCommand::Solve.into(),
            Action::JudgeHealth => EyesCommand::JudgeHealth.into(),
            Action::Accept => EyesCommand::Accept.into(),
            Action::Discard => EyesCommand::Discard.into(),
            Action::Robot(action) => return action.command(&self.view),
            Action::Mount(action) => action.command(),
            Action::HandEye(action) => action.command(),
            Action::Touch(action) => return action.command(&self.view),
            Action::Models(action) => return action.command(&self.view),
            Action::Gap(action) => return action.command(&self.view),
            Action::Grasp(action) => return action.command(&self.view),
            Action::Trials(action) => return action.command(),
            Action::Grid(action) => return action.command(),
            Action::Labels(action) => return action.command(&self.view),
            Action::Scores(action) => return action.command(&self.view),
            Action::Detect(action) => return action.command(),
            Action::StartAgain(thread) => WatchCommand::StartAgain(thread).into(),
            Action::CancelJob => JobCommand::Cancel(self.view.running_job()?.id).into(),
            _ => return None,
        })
    }

    /// Takes back what was changed last on this screen, or says why there is nothing.
    fn undo(&mut self) {
        match undo(&self.view, self.settings.screen) {
            Ok(undo) => {
                // It may be the point that goes.
                self.panels.models.tables.chosen = None;
                self.send(undo.command);
            }
            Err(why) => self.notices.say(&format!("Undo: {why}.")),
        }
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
}
