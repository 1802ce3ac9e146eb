//! What the panels ask for during a frame. Panels change nothing themselves: all of it is
//! carried out after the frame, in one place.

use plumbline_engine::{
    Command, ExportFormat, Exported, GraspCommand, JogRates, ProbePoint, Products, TouchCommand,
    TrialsCommand,
};
use plumbline_widgets::texture::Picture;

use super::{Action, GraspAction, Pane, Table, TouchAction};

/// Collected while a frame is drawn.
#[derive(Default)]
pub struct Outbox {
    /// For the engine.
    pub commands: Vec<Command>,
    /// For the window.
    pub actions: Vec<Action>,
    /// Live products that somebody looks at in this frame.
    pub wanted: Products,
    /// The point under the mouse, if it is over an image that can be measured.
    pub probe: Option<ProbePoint>,
    /// How a tip is to be jogged, as long as the keys for it are held.
    pub jog: Option<JogRates>,
    /// What is to be taken out of a tile.
    pub taken: Option<(Pane, Taken)>,
}

/// What of a tile is taken, and where it goes; saving asks where to.
pub enum Taken {
    /// Its picture in its own pixels, to the clipboard.
    CopyPicture(Picture),
    /// Its picture in its own pixels, to a file.
    SavePicture(Picture),
    /// The tile as it stands, to the clipboard.
    CopyImage,
    /// The tile as it stands, to a file.
    SaveImage,
    /// Its rows as CSV, to the clipboard.
    CopyTable(Table),
    /// Its rows as CSV, to a file.
    SaveTable(Table),
    /// The tile as it stands and its rows below, as PDF, to a file.
    SavePage(Table),
}

impl Outbox {
    /// Hands a command to the engine.
    pub fn send(&mut self, command: impl Into<Command>) {
        self.commands.push(command.into());
    }

    /// Asks the window for something.
    pub fn act(&mut self, action: Action) {
        self.actions.push(action);
    }

    /// Forgets all that was asked for but what makes an arm hold.
    pub fn keep_what_halts(&mut self) {
        self.commands.retain(|command| {
            matches!(
                command,
                Command::Touch(TouchCommand::Pause)
                    | Command::Grasp(GraspCommand::Pause | GraspCommand::End)
                    | Command::Trials(TrialsCommand::Pause)
            )
        });
        self.actions.retain(|action| {
            matches!(
                action,
                Action::Stop
                    | Action::CancelJob
                    | Action::Grasp(GraspAction::Pause | GraspAction::End)
                    | Action::Touch(TouchAction::Pause)
            )
        });
        self.jog = None;
        self.taken = None;
    }

    /// Asks for a calibration to be written.
    pub fn export(&mut self, what: Exported, format: ExportFormat) {
        self.act(Action::Export(what, format));
    }

    /// Says that a live product is looked at.
    pub fn want(&mut self, products: Products) {
        self.wanted.rectified |= products.rectified;
        self.wanted.disparity |= products.disparity;
        self.wanted.corners |= products.corners;
        self.wanted.detections |= products.detections;
    }
}
