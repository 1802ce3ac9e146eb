//! What the window asks the operator for, and what is done with the answer.

use std::path::PathBuf;

use plumbline_engine::{
    Command, DetectCommand, DetectorChoice, DriftCommand, EyesCommand, FileLength, GapCommand, GridCommand,
    GridCorrection, GridSide, LabelsCommand, ModelsCommand, RecordingCommand, ScoresCommand, SourceCommand,
    TablesCommand, TimelineCommand, TrialsCommand,
};

use super::PlumblineWindow;
use super::ask::Ask;
use super::dialogs::{Answer, Question};
use super::saving::save_picture;
use super::sheet::Asked;
use crate::operator::{Outbox, Screen};

impl PlumblineWindow {
    pub(super) fn ask_for(&mut self, ctx: &egui::Context, question: Question) {
        if let Some(answer) = self.dialogs.ask(question) {
            self.take_answer(ctx, answer);
        }
    }

    pub(super) fn take_answer(&mut self, ctx: &egui::Context, answer: Answer) {
        let (question, paths) = match answer {
            Answer::Cancelled => return,
            Answer::NoDialog(question) => return self.ask = Some(Ask::paths(question)),
            Answer::Paths(question, paths) => (question, paths),
        };
        let Some(file) = paths.first().cloned() else { return };
        if question.saves() && !question.is_of_window() {
            self.notices.await_file(file.clone());
        }
        let command: Command = match question {
            Question::TwoFolders | Question::TwoVideos if paths.len() != 2 => return,
            Question::Folder | Question::TwoFolders | Question::TwoVideos => {
                SourceCommand::OpenPaths(paths).into()
            }
            Question::Import => EyesCommand::Import { files: paths, length: FileLength::AsPrescribed }.into(),
            Question::Export(what, format) => EyesCommand::Export { what, format, file }.into(),
            Question::Detector => DetectCommand::Use(DetectorChoice::File(file)).into(),
            Question::TouchSession => ModelsCommand::ChooseSession { session: file }.into(),
            Question::GapSession => GapCommand::Choose { sessions: vec![file] }.into(),
            Question::GridSession => DriftCommand::Grid(GridCommand::Show {
                side: GridSide::Right,
                session: file,
                correction: GridCorrection::Described,
            })
            .into(),
            Question::GapReport { pdf } => GapCommand::Report { file, pdf }.into(),
            Question::LabelSet => {
                self.settings.screen = Screen::Images;
                LabelsCommand::Open { path: file }.into()
            }
            Question::ExportLabels => {
                LabelsCommand::Export { folder: file, train_percent: 80, seed: 1 }.into()
            }
            Question::ImportLabels => LabelsCommand::Import { path: file }.into(),
            Question::ScoreModels => ScoresCommand::AddModels { files: paths }.into(),
            Question::ScoreSet => ScoresCommand::ChooseSet { path: file }.into(),
            Question::Trials(format) => TrialsCommand::Export { file, format }.into(),
            Question::SetupReport(format) => TimelineCommand::Report { file, format }.into(),
            Question::ScoresCsv => ScoresCommand::ExportCsv { file }.into(),
            Question::ImportModel => ModelsCommand::Import { file }.into(),
            Question::ExportModel(method, onnx) => ModelsCommand::Export { method, onnx, file }.into(),
            Question::ImportTable(table) => {
                ModelsCommand::Tables(TablesCommand::Import { table, file }).into()
            }
            Question::ExportTable(table) => {
                ModelsCommand::Tables(TablesCommand::Export { table, file }).into()
            }
            Question::SaveWindow => return self.save_window(ctx, file),
            Question::SaveView | Question::SaveRows | Question::SavePage => {
                return self.taking.save(ctx, file);
            }
        };
        self.send(command);
    }

    pub(super) fn show_ask(&mut self, ctx: &egui::Context, escape_pressed: bool, outbox: &mut Outbox) {
        let Some(ask) = &mut self.ask else { return };
        match ask.show(ctx, &self.view, escape_pressed) {
            Asked::Open => {}
            Asked::Closed => self.ask = None,
            Asked::Command(command) => {
                self.ask = None;
                if let Command::Recording(RecordingCommand::ExportLerobot { folder, .. }) = &command {
                    self.notices.await_file(folder.clone());
                }
                outbox.send(command);
            }
            Asked::HoldAndClose => {
                self.ask = None;
                self.hold_and_close(ctx);
            }
            Asked::Close => {
                self.ask = None;
                self.close(ctx);
            }
            Asked::CommandKeepOpen(command) => outbox.send(command),
            Asked::Answer(answer) => {
                self.ask = None;
                self.take_answer(ctx, answer);
            }
        }
    }

    fn save_window(&self, ctx: &egui::Context, file: PathBuf) {
        let (again, told) = (ctx.clone(), self.taking.teller(file.clone()));
        ctx.request_screenshot(move |picture| save_picture(&again, &picture, file, told));
    }
}
