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

/// Rates at which a recording can be played.
const PAIRS_PER_SECOND: std::ops::RangeInclusive<f64> = 0.01..=1000.0;

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
            && !PAIRS_PER_SECOND.contains(&rate)
        {
            let (least, most) = (PAIRS_PER_SECOND.start(), PAIRS_PER_SECOND.end());
            let text = format!("{rate} pairs per second cannot be played: give between {least} and {most}.");
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
