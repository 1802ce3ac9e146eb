//! TEMPORARY stub until the twin's facade exists.
#![allow(missing_docs, clippy::all)]
use plumbline_model::frame::{Board, Pose, Robot};
use plumbline_model::robot::Rig;
use plumbline_twin::scene::{Scenery, Snapshot};
pub use plumbline_twin::{Scenario, Toy, TwinError};
use std::path::{Path, PathBuf};
use std::sync::Arc;
#[derive(Clone)]
pub struct SceneSource;
impl SceneSource {
    pub fn newest(&self) -> (Arc<Scenery>, Snapshot) {
        unimplemented!()
    }
}
pub struct TwinSettings {
    pub rig: Arc<Rig>,
    pub scenario: Scenario,
    pub seed: u64,
    pub pace: f64,
}
pub struct Twin {
    p: PathBuf,
}
pub struct TwinState {
    pub time_s: f64,
    pub eyes_on_s: f64,
    pub real_time_factor: f64,
    pub toys: Vec<(Toy, Option<nalgebra::Vector3<f64>>)>,
    pub board: Option<Pose<Robot, Board>>,
    pub faults: Vec<Fault>,
}
impl Twin {
    pub fn start(_s: TwinSettings) -> Result<Self, TwinError> {
        unimplemented!()
    }
    pub fn port(&self) -> &Path {
        &self.p
    }
    pub fn scene(&self) -> SceneSource {
        SceneSource
    }
    pub fn send(&self, _c: TwinCommand) {}
    pub fn state(&self) -> TwinState {
        unimplemented!()
    }
}
pub enum TwinCommand {
    PlaceObject { toy: Toy, x_m: f64, y_m: f64 },
    RemoveObject { toy: Toy },
    PlaceBoard { robot_from_board: Pose<Robot, Board> },
    HideBoard,
    AdvanceWarmUp { minutes: f64 },
    CoolEyes,
    Fault { fault: Fault, on: bool },
    Reset,
}
#[derive(Clone, Copy, PartialEq)]
pub enum Fault {
    A,
}
impl Fault {
    pub const ALL: [Self; 1] = [Self::A];
    pub fn from_name(_n: &str) -> Option<Self> {
        None
    }
    pub fn name(self) -> &'static str {
        ""
    }
    pub fn about(self) -> &'static str {
        ""
    }
}
pub fn board_presets(_r: &Rig) -> Vec<Pose<Robot, Board>> {
    vec![]
}
pub fn open_eyes(
    _s: SceneSource,
) -> Result<Box<dyn plumbline_hardware::StereoSource>, plumbline_hardware::SourceError> {
    Err(plumbline_hardware::SourceError::TwinNotRunning)
}
