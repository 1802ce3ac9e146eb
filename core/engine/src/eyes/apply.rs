//! What the operator asks for while calibrating the eyes, one method each.

use std::collections::BTreeSet;

use plumbline_hardware::SourceSpec;
use plumbline_model::{Chessboard, counted};

use super::collection::CollectError;
use super::command::{ExportFormat, Exported};
use super::times::taken;
use super::view::CollectedPair;
use super::work::{
    Accept, Capture, CollectRecording, Context, Export, EyesWork, Open, OpenWhat, Recognize, Solve,
    UseEarlier,
};
use super::workflow::{EyesAround, EyesWorkflow};
use crate::ground::notice::NoticeLevel;

impl EyesWorkflow {
    pub(super) fn choose_board(&mut self, columns: u32, rows: u32, square_m: f64, context: &mut Context<'_>) {
        match Chessboard::from_squares(columns, rows, square_m) {
            Ok(board) => {
                let before = self.collection.pairs().len();
                self.collection.set_board(board);
                self.board_chosen = true;
                self.board_seen = None;
                if self.collection.pairs().len() < before {
                    let pairs = counted(before, "pair");
                    let text = format!("Put aside, of the other board: {pairs}. Undo brings them back.");
                    context.notices.add(NoticeLevel::Info, text);
                }
            }
            Err(error) => context.refuse(crate::ground::text::sentence(&error.to_string())),
        }
    }

    pub(super) fn recognize_board(&mut self, around: &EyesAround, context: &mut Context<'_>) {
        match &around.newest {
            Some(frame) => {
                let work = Recognize { frame: frame.clone(), board: *self.board() };
                context.start(EyesWork::Recognize(work));
            }
            None => context.refuse(NO_IMAGE),
        }
    }

    pub(super) fn capture(&mut self, around: &EyesAround, context: &mut Context<'_>) {
        let Some(frame) = &around.newest else { return context.refuse(NO_IMAGE) };
        if self.busy.capturing.is_some() {
            return;
        }
        if let Some(name) = frame.name.as_ref().filter(|name| self.collection.contains(name)) {
            return context.refuse(CollectError::Twice(name.clone()));
        }
        let name = frame.name.clone().unwrap_or_else(|| self.collection.next_name());
        self.capturing_taken = taken(frame, around);
        let work = Capture { frame: frame.clone(), name, board: *self.board() };
        self.busy.capturing = Some(context.start(EyesWork::Capture(work)));
    }

    pub(super) fn set_auto_capture(&mut self, on: bool, around: &EyesAround, context: &mut Context<'_>) {
        self.auto_capture = on;
        self.capture_ended = None;
        // A picture that stands still is looked at only once: it may be worth capturing now.
        if let Some(look) = self.last_look.take().filter(|_| on) {
            self.look(look, around, context);
        }
    }

    pub(super) fn collect_recording(&mut self, around: &EyesAround, context: &mut Context<'_>) {
        if self.busy.collecting.is_some() {
            return context.refuse("The recording is being searched already. Wait for it or cancel it.");
        }
        let source = match &around.source.spec {
            Some(SourceSpec::Cameras { .. }) => {
                return context.refuse(
                    "Cameras are no recording. Capture single pairs, or switch on capturing by itself.",
                );
            }
            Some(SourceSpec::Twin) => {
                return context.refuse(
                    "The twin's eyes are no recording. Switch on capturing by itself and let the board be shown at all places.",
                );
            }
            Some(recording) => recording.clone(),
            None => {
                return context.refuse("No recording is open. Open a folder of pairs or two videos first.");
            }
        };
        let known: BTreeSet<String> = self.collection.pairs().iter().map(|pair| pair.name.clone()).collect();
        let rough_cameras = self.rough_cameras(self.size_px().unwrap_or((640, 480)));
        let work = CollectRecording { source, board: *self.board(), known, rough_cameras };
        self.busy.collecting = Some(context.start(EyesWork::CollectRecording(work)));
    }

    pub(super) fn edit(
        &mut self,
        context: &mut Context<'_>,
        edit: impl FnOnce(&mut super::collection::Collection) -> Result<(), CollectError>,
    ) {
        if let Err(error) = edit(&mut self.collection) {
            context.refuse(error);
        }
    }

    pub(super) fn solve(&mut self, around: &EyesAround, context: &mut Context<'_>) {
        if self.busy.solving.is_some() {
            return context.refuse("A solution is under way already. Wait for it or cancel it.");
        }
        let Some(sizes_px) = self.collection.sizes_px() else { return context.refuse(CollectError::Empty) };
        let work = Solve {
            board: *self.board(),
            observations: self.collection.observations(),
            sizes_px,
            dropped: self.collection.dropped().iter().cloned().collect(),
            options: self.options.clone(),
            minutes_since_on: self.minutes_of_collected(),
            source: around.source.description.clone(),
            in_use: self.in_use().cloned(),
            workspace: self.workspace,
            revision: self.collection.revision(),
        };
        self.busy.solving = Some(context.start(EyesWork::Solve(work)));
    }

    pub(super) fn accept(&mut self, context: &mut Context<'_>) {
        if self.busy.accepting.is_some() {
            return;
        }
        let Some(proposal) = &self.proposal else {
            return context.refuse(
                "There is nothing to accept. Solve the collected pairs or read a calibration first.",
            );
        };
        let work = Accept {
            calibration: proposal.calibration.clone(),
            uncertainty: proposal.uncertainty.clone(),
            depth_per_px_m: proposal.depth_per_px_m,
            store: self.store.clone(),
            accepted: context.time.day,
        };
        self.busy.accepting = Some(context.start(EyesWork::Accept(work)));
    }

    pub(super) fn use_earlier(&mut self, id: Option<String>, context: &mut Context<'_>) {
        if self.busy.accepting.is_some() {
            return context.refuse("Another calibration is being put in use. Wait for it.");
        }
        let work = UseEarlier { id, store: self.store.clone(), workspace: self.workspace };
        self.busy.accepting = Some(context.start(EyesWork::UseEarlier(work)));
    }

    pub(super) fn open(&mut self, what: OpenWhat, context: &mut Context<'_>) {
        if self.busy.opening.is_some() {
            return context.refuse("Another calibration is being read. Wait for it.");
        }
        let (store, in_use) = (self.store.clone(), self.in_use().cloned());
        let work = Open { what, store, in_use, workspace: self.workspace };
        self.busy.opening = Some(context.start(EyesWork::Open(work)));
    }

    /// Takes the pairs of the proposal, or else of the calibration in use, to solve them again.
    pub(super) fn collect_evidence(&mut self, context: &mut Context<'_>) {
        let calibration = self.proposal.as_ref().map(|p| &p.calibration).or(self.in_use()).cloned();
        let Some(calibration) = calibration else {
            return context.refuse("There is no calibration to take pairs from. Read one first.");
        };
        let Some(evidence) = &calibration.evidence else {
            return context.refuse(
                "This calibration carries no pairs, because it was read from another program's file.",
            );
        };
        let sizes_px = [calibration.cameras.left.size_px(), calibration.cameras.right.size_px()];
        let pairs = evidence.observations.iter().map(|observation| {
            let pair = CollectedPair {
                name: observation.name.clone(),
                left: observation.left.clone(),
                right: observation.right.clone(),
                left_image: None,
                right_image: None,
                place: None,
                taken: None,
            };
            CollectedPair { place: self.place(&pair, sizes_px[0]), ..pair }
        });
        let pairs: Vec<CollectedPair> = pairs.collect();
        let dropped = evidence.dropped_pairs.iter().cloned().collect();
        self.collection.replace(evidence.board, pairs, sizes_px, dropped);
        self.options = evidence.options.clone();
        self.minutes_of_pairs = evidence.minutes_since_on;
        self.board_chosen = true;
    }

    pub(super) fn export(
        &mut self,
        what: Exported,
        format: ExportFormat,
        file: std::path::PathBuf,
        context: &mut Context<'_>,
    ) {
        let calibration = match what {
            Exported::InUse => self.in_use().cloned(),
            Exported::Proposal => self.proposal.as_ref().map(|proposal| proposal.calibration.clone()),
        };
        match calibration {
            Some(calibration) => {
                let work = Export { calibration, format, file };
                context.start(EyesWork::Export(work));
            }
            None => context.refuse("There is no calibration to write. Solve and accept one first."),
        }
    }
}

const NO_IMAGE: &str = "There is no image yet. Open a folder of pairs, two videos or the cameras first.";
