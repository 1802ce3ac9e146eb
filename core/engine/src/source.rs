//! Where the images come from: opening, losing and finding again, and playing recordings.

mod player;
mod thread;

pub use player::{Control, Note, Opener, Player};
pub use thread::{SourceThread, Wires};

use std::sync::Arc;

use plumbline_hardware::CameraDevice;

use crate::command::SourceCommand;
use crate::context::Context;
use crate::notice::NoticeLevel;
use crate::view::SourceView;
use crate::work::Work;

/// What the engine knows of the source.
#[derive(Clone, Debug, Default)]
pub struct SourceState {
    view: Arc<SourceView>,
    cameras: Option<Arc<[CameraDevice]>>,
}

impl SourceState {
    /// Applies a command. Most are the source thread's business.
    pub fn apply(&mut self, command: SourceCommand, context: &mut Context<'_>) {
        if let SourceCommand::ListCameras = command {
            context.start(Work::ListCameras);
            return;
        }
        if let SourceCommand::PairsPerSecond(rate) = command
            && !(rate.is_finite() && rate > 0.0)
        {
            let text = format!("{rate} pairs per second is no rate; give a positive number.");
            context.notices.add(NoticeLevel::Error, text);
            return;
        }
        if let Some(control) = Control::from_command(command) {
            context.control_source(control);
        }
    }

    /// Takes over what the source thread says of itself.
    pub fn update(&mut self, view: SourceView) {
        self.view = Arc::new(SourceView { cameras: self.cameras.clone(), ..view });
    }

    /// Takes over which cameras this machine has.
    pub fn set_cameras(&mut self, cameras: Vec<CameraDevice>) {
        let cameras: Arc<[CameraDevice]> = cameras.into();
        self.cameras = Some(cameras.clone());
        self.view = Arc::new(SourceView { cameras: Some(cameras), ..(*self.view).clone() });
    }

    /// What the window shows.
    pub fn view(&self) -> &Arc<SourceView> {
        &self.view
    }
}
