//! What the engine knows of the source.

use std::path::Path;
use std::sync::Arc;

use plumbline_hardware::CameraDevice;

use super::command::{Control, SourceCommand};
use super::view::SourceView;
use super::work::{Context, SourceResult, SourceWork};
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::ground::{Moment, Workflow};

/// Rates at which a recording can be played.
const PAIRS_PER_SECOND: std::ops::RangeInclusive<f64> = 0.01..=1000.0;

/// What the engine knows of the source.
#[derive(Clone, Debug, Default)]
pub struct SourceWorkflow {
    view: Arc<SourceView>,
    cameras: Option<Arc<[CameraDevice]>>,
}

impl SourceWorkflow {
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

impl Workflow for SourceWorkflow {
    type Command = SourceCommand;
    type Work = SourceWork;
    type Control = Control;
    type Around = ();
    type View = SourceView;

    fn new(_: &Path) -> Self {
        Self::default()
    }

    fn view(&mut self, _: &(), _: &Moment) -> Arc<SourceView> {
        self.view.clone()
    }

    fn apply(&mut self, command: SourceCommand, _: &(), context: &mut Context<'_>) {
        if let SourceCommand::ListCameras = command {
            context.start(SourceWork::ListCameras);
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
            context.control(control);
        }
    }

    fn work_done(&mut self, _: JobId, result: SourceResult, _: &(), _: &mut Context<'_>) {
        let SourceResult::Cameras(cameras) = result;
        self.set_cameras(cameras);
    }

    fn work_ended(&mut self, _: JobId, _: Option<&str>, _: &(), _: &mut Context<'_>) {}
}
