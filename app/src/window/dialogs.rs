//! Questions for files and folders. The desktop's dialog runs on a thread of its own; where the
//! desktop has none (no portal, no zenity), the path is typed instead.

use std::path::PathBuf;
use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Sender, bounded};
use plumbline_engine::{ExportFormat, Exported, GraspTable, TimelineFormat, TrialsFormat};

use crate::operator::snapshot::models::Method;

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Question {
    /// A folder of pairs.
    Folder,
    /// Two folders, left eye first.
    TwoFolders,
    /// Two video files, left eye first.
    TwoVideos,
    /// Calibration files to read.
    Import,
    /// Where a calibration is written.
    Export(Exported, ExportFormat),
    /// An ONNX file with a detector.
    Detector,
    /// The folder of a session with touches.
    TouchSession,
    /// The folder of a session to compare with the model.
    GapSession,
    /// The folder of a 9 by 4 evaluation.
    GridSession,
    /// Where a page about the gap is written, as PDF or as HTML.
    GapReport {
        /// As PDF.
        pdf: bool,
    },
    /// A correction model to read.
    ImportModel,
    /// Where a correction model is written, as ONNX or as JSON.
    ExportModel(Method, bool),
    /// A table of grasp height or yaw to read.
    ImportTable(GraspTable),
    /// Where a table is written.
    ExportTable(GraspTable),
    /// The folder of a data set to label.
    LabelSet,
    /// Where a data set to train with is written.
    ExportLabels,
    /// The folder of a data set to read into the open one.
    ImportLabels,
    /// Detectors to judge.
    ScoreModels,
    /// The folder of the data set to judge on.
    ScoreSet,
    /// Where the table of scores is written.
    ScoresCsv,
    /// Where an experiment with grasps is written.
    Trials(TrialsFormat),
    /// Where the report of the setup is written.
    SetupReport(TimelineFormat),
    /// Where a picture of the window is saved.
    SaveWindow,
    /// Where a picture of one tile is saved.
    SaveView,
    /// Where the rows of a tile are saved.
    SaveRows,
    /// Where a tile is saved as a page.
    SavePage,
}

/// How a question ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    /// These paths, as many as were asked for.
    Paths(Question, Vec<PathBuf>),
    /// Nothing was chosen.
    Cancelled,
    /// The desktop showed no dialog.
    NoDialog(Question),
}

/// A dialog that closes sooner than this was never shown.
const SHOWN_AT_LEAST: Duration = Duration::from_millis(400);

impl Question {
    /// Title of its dialog.
    pub fn title(self) -> &'static str {
        match self {
            Self::Folder => "Open a folder of pairs",
            Self::TwoFolders => "Open two folders: left eye, right eye",
            Self::TwoVideos => "Open two videos: left eye, right eye",
            Self::Import => "Import a calibration",
            Self::Export(..) => "Export the calibration",
            Self::Detector => "Choose a detector",
            Self::TouchSession => "Open a session with touches",
            Self::GapSession => "Open a session to compare",
            Self::GridSession => "Open an evaluation",
            Self::GapReport { .. } => "Write the report of the gap",
            Self::ImportModel => "Import a correction model",
            Self::ExportModel(..) => "Export the correction model",
            Self::ImportTable(GraspTable::Height) => "Import grasp heights",
            Self::ImportTable(GraspTable::Yaw) => "Import yaw angles",
            Self::ExportTable(GraspTable::Height) => "Export grasp heights",
            Self::ExportTable(GraspTable::Yaw) => "Export yaw angles",
            Self::LabelSet => "Open a data set",
            Self::ExportLabels => "Export the data set into an empty folder",
            Self::ImportLabels => "Import a YOLO data set",
            Self::ScoreModels => "Add a detector to judge",
            Self::ScoreSet => "Choose the data set to judge on",
            Self::ScoresCsv => "Export the scores",
            Self::Trials(_) => "Export the experiment",
            Self::SetupReport(_) => "Write the report of the setup",
            Self::SaveWindow => "Save a picture of the window",
            Self::SaveView => "Save a picture of the tile",
            Self::SaveRows => "Save the rows of the tile as CSV",
            Self::SavePage => "Save the tile as PDF",
        }
    }

    /// Names of the paths that are asked for.
    pub fn fields(self) -> &'static [&'static str] {
        match self {
            Self::TwoFolders => &["Left folder", "Right folder"],
            Self::TwoVideos => &["Left video", "Right video"],
            Self::Import => &["File", "Right eye's file, if there are two"],
            _ if self.picks_folder() => &["Folder"],
            _ => &["File"],
        }
    }

    /// Whether one folder is asked for.
    fn picks_folder(self) -> bool {
        matches!(
            self,
            Self::Folder
                | Self::TouchSession
                | Self::GapSession
                | Self::GridSession
                | Self::LabelSet
                | Self::ExportLabels
                | Self::ImportLabels
                | Self::ScoreSet
        )
    }

    /// How many of the fields have to be filled.
    pub fn required(self) -> usize {
        if self == Self::Import { 1 } else { self.fields().len() }
    }

    /// What the name of a new file starts as.
    pub fn suggested_name(self) -> &'static str {
        match self {
            Self::Export(_, ExportFormat::Plumbline) => "rig-cameras.yaml",
            Self::Export(_, ExportFormat::RosCameraInfo) => "nico_left.yaml",
            Self::Export(_, ExportFormat::OpenCv) => "stereo-opencv.yml",
            Self::Export(_, ExportFormat::Kalibr) => "camchain.yaml",
            Self::Export(_, ExportFormat::MrcalCorners) => "corners.vnl",
            Self::ExportModel(Method::M1, _) => "m1.json",
            Self::ExportModel(Method::M2, false) => "m2.json",
            Self::ExportModel(Method::M3, false) => "m3.json",
            Self::ExportModel(Method::M2, true) => "m2.onnx",
            Self::ExportModel(Method::M3, true) => "m3.onnx",
            Self::ExportTable(GraspTable::Height) => "grasp-height.csv",
            Self::ExportTable(GraspTable::Yaw) => "grasp-yaw.csv",
            Self::GapReport { pdf: false } => "gap.html",
            Self::GapReport { pdf: true } => "gap.pdf",
            Self::ScoresCsv => "scores.csv",
            Self::Trials(TrialsFormat::Csv) => "experiment.csv",
            Self::Trials(TrialsFormat::Html) => "experiment.html",
            Self::Trials(TrialsFormat::Pdf) => "experiment.pdf",
            Self::SetupReport(TimelineFormat::Csv) => "timeline.csv",
            Self::SetupReport(TimelineFormat::Html) => "setup.html",
            Self::SetupReport(TimelineFormat::Pdf) => "setup.pdf",
            Self::SaveWindow => "plumbline.png",
            Self::SaveView => "view.png",
            Self::SaveRows => "rows.csv",
            Self::SavePage => "page.pdf",
            _ => "",
        }
    }

    /// Whether something new is written rather than something read.
    pub fn saves(self) -> bool {
        matches!(
            self,
            Self::Export(..)
                | Self::ExportModel(..)
                | Self::ExportTable(_)
                | Self::ExportLabels
                | Self::GapReport { .. }
                | Self::ScoresCsv
                | Self::Trials(_)
                | Self::SetupReport(_)
                | Self::SaveWindow
                | Self::SaveView
                | Self::SaveRows
                | Self::SavePage
        )
    }

    /// Whether the window writes it, and tells of it, itself.
    pub fn is_of_window(self) -> bool {
        matches!(self, Self::SaveWindow | Self::SaveView | Self::SaveRows | Self::SavePage)
    }

    /// Asks the desktop; blocks, so not for the window's thread.
    fn ask(self) -> Option<Vec<PathBuf>> {
        let dialog = || rfd::FileDialog::new().set_title(self.title());
        let titled = |title: &str| rfd::FileDialog::new().set_title(title);
        let video =
            |title: &str| titled(title).add_filter("Videos", &["mp4", "avi", "mkv", "mov", "webm", "m4v"]);
        match self {
            Self::Detector => dialog().add_filter("ONNX files", &["onnx"]).pick_file().map(|file| vec![file]),
            Self::ImportModel => {
                dialog().add_filter("Models", &["json", "onnx"]).pick_file().map(|file| vec![file])
            }
            Self::ScoreModels => dialog().add_filter("Detectors", &["onnx"]).pick_files(),
            Self::ImportTable(_) => {
                dialog().add_filter("Tables", &["csv"]).pick_file().map(|file| vec![file])
            }
            Self::TwoFolders => {
                let left = titled("Folder of the left eye").pick_folder()?;
                let right = titled("Folder of the right eye").pick_folder()?;
                Some(vec![left, right])
            }
            Self::TwoVideos => {
                let left = video("Video of the left eye").pick_file()?;
                let right = video("Video of the right eye").pick_file()?;
                Some(vec![left, right])
            }
            Self::Import => dialog().add_filter("Calibrations", &["yaml", "yml", "xml"]).pick_files(),
            _ if self.picks_folder() => dialog().pick_folder().map(|folder| vec![folder]),
            // All others that read something stand above.
            _ => dialog().set_file_name(self.suggested_name()).save_file().map(|file| vec![file]),
        }
    }
}

/// At most one question is open at a time.
#[derive(Debug)]
pub struct Dialogs {
    native: bool,
    wake: egui::Context,
    pending: Option<Receiver<Answer>>,
}

impl Dialogs {
    /// `native` false always asks for typed paths (tests, screenshots).
    pub fn new(native: bool, wake: egui::Context) -> Self {
        Self { native, wake, pending: None }
    }

    /// Asks. An answer that comes at once means that there will be no dialog.
    pub fn ask(&mut self, question: Question) -> Option<Answer> {
        if !self.native {
            return Some(Answer::NoDialog(question));
        }
        if self.pending.is_some() {
            return None;
        }
        let (sender, receiver) = bounded(1);
        let wake = self.wake.clone();
        let thread = thread::Builder::new()
            .name("file dialog".to_owned())
            .spawn(move || answer_on_thread(question, &sender, &wake));
        match thread {
            Ok(_detached) => {
                self.pending = Some(receiver);
                None
            }
            Err(error) => {
                log::error!("no thread for the file dialog: {error}");
                Some(Answer::NoDialog(question))
            }
        }
    }

    /// The answer, once it is there.
    pub fn poll(&mut self) -> Option<Answer> {
        let answer = self.pending.as_ref()?.try_recv();
        match answer {
            Ok(answer) => {
                self.pending = None;
                Some(answer)
            }
            Err(crossbeam_channel::TryRecvError::Empty) => None,
            Err(crossbeam_channel::TryRecvError::Disconnected) => {
                self.pending = None;
                Some(Answer::Cancelled)
            }
        }
    }
}

fn answer_on_thread(question: Question, sender: &Sender<Answer>, wake: &egui::Context) {
    let started = Instant::now();
    let answer = match question.ask() {
        Some(paths) => Answer::Paths(question, paths),
        None if started.elapsed() < SHOWN_AT_LEAST => Answer::NoDialog(question),
        None => Answer::Cancelled,
    };
    // The window may be gone by now; then nobody needs the answer.
    let _ = sender.send(answer);
    wake.request_repaint();
}
