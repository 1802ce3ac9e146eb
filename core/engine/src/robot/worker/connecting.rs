//! Connecting and letting go: the twin, a port, who is on the bus.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use super::{News, Worker};
use crate::robot::command::RobotCommand;
use crate::robot::connect::{self, Connected};
use crate::robot::control::RobotControl;
use crate::robot::unable::Unable;
use crate::robot::view::{Connection, RobotView};

impl Worker {
    /// What to show while a command that takes long is carried out.
    pub fn announce(&self, control: &RobotControl) -> Option<News> {
        let (to, doing) = match control {
            RobotControl::Robot(RobotCommand::ConnectTwin { scenario }) => {
                (twin_called(scenario), "starting the simulation")
            }
            RobotControl::Robot(RobotCommand::ConnectPort { path }) => {
                (path.display().to_string(), "asking the bus who is there")
            }
            RobotControl::Robot(RobotCommand::Scan) => {
                let (Connection::Connected { to, .. } | Connection::Lost { to, .. }) = &self.connection
                else {
                    return None;
                };
                (to.clone(), "asking the bus who is there")
            }
            _ => return None,
        };
        let told = self.told.clone()?;
        let connection = Connection::Connecting { to, doing: doing.to_owned() };
        let robot = Arc::new(RobotView { connection, ..(*told.robot).clone() });
        Some(News { robot, ..told })
    }

    pub(super) fn connect_twin(&mut self, scenario: &str) -> Result<(), Unable> {
        self.disconnect();
        let to = twin_called(scenario);
        let port = self.desk.start(scenario, &self.rig).map_err(Unable::from).and_then(|port| {
            self.twins_started += 1;
            Ok(connect::open(&port, true, &self.rig, &self.paths, &self.switches)?)
        });
        self.connected(to, true, port)
    }

    pub(super) fn connect_port(&mut self, path: PathBuf) -> Result<(), Unable> {
        self.disconnect();
        let to = path.display().to_string();
        let arm = connect::open(&path, false, &self.rig, &self.paths, &self.switches);
        self.connected(to, false, arm.map_err(Unable::from))
    }

    pub(super) fn connected(
        &mut self,
        to: String,
        twin: bool,
        arm: Result<Connected, Unable>,
    ) -> Result<(), Unable> {
        self.reached_twin = twin;
        match arm {
            Ok(arm) => {
                self.arm = Some(arm);
                self.connected_at = Some(Instant::now());
                self.connection = Connection::Connected { to, twin };
                Ok(())
            }
            Err(reason) => {
                self.connection = Connection::Lost { to, reason: reason.to_string() };
                Err(reason)
            }
        }
    }

    pub(super) fn disconnect(&mut self) {
        self.interrupt_touch("the robot was disconnected: connect it again");
        self.interrupt_lead("the robot was disconnected: connect it again");
        if let Some(arm) = self.arm.take() {
            // If it cannot be told to hold it is gone already.
            let _ = arm.hold();
        }
        self.connection = Connection::None;
        (self.preview, self.running, self.jog) = (None, None, None);
        self.trail.clear();
        self.histories.clear();
        self.seen_refusal = 0;
    }

    pub(super) fn scan(&mut self) -> Result<(), Unable> {
        // Who is there is asked when the bus is opened: it is closed and opened again.
        let (Connection::Connected { to, .. } | Connection::Lost { to, .. }) = self.connection.clone() else {
            return Err(Unable::NothingToScan);
        };
        if !self.reached_twin {
            return self.connect_port(to.into());
        }
        // A twin goes on while nobody is connected to it, and everything on its table stays where it is.
        let port = self.desk.port().ok_or(Unable::TwinEnded)?;
        self.disconnect();
        let arm = connect::open(&port, true, &self.rig, &self.paths, &self.switches);
        self.connected(to, true, arm.map_err(Unable::from))
    }
}

/// How the twin of a scenario is called.
fn twin_called(scenario: &str) -> String {
    format!("twin \"{}\"", crate::twin::short_name(scenario))
}
