//! Opening the servo bus of the robot or of the twin: to its callers both are the same.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_hardware::dynamixel::{
    BusCounts, BusError, BusScan, BusTiming, FaultKind, latency_hint, list_ports, open_port,
};
use plumbline_hardware::joints::{ArmDriver, ArmOptions, Grip, JointState, Move, MoveId, Refusal, Setpoint};
use plumbline_model::robot::{JointIndex, Posture, Rig};

use super::Switches;
use super::arm::{Arm, Census};
use super::path::Paths;
use super::view::PortView;
use crate::ground::text::sentence;

/// An open arm.
pub type Connected = Box<dyn Arm>;

/// The arm at a port and what was said when it was opened.
struct DrivenArm {
    driver: ArmDriver,
    census: Census,
}

/// Opens the bus at a port and reads all joints. Nothing moves and torque stays as it is.
///
/// The twin's servos are threads of this machine, which a busy processor delays as no wire would:
/// they are waited for longer.
pub fn open(
    path: &Path,
    twin: bool,
    rig: &Arc<Rig>,
    paths: &Paths,
    switches: &Switches,
) -> Result<Connected, BusError> {
    let path = path.to_string_lossy();
    let port = open_port(&path, rig.bus.baud)?;
    let options = ArmOptions {
        stop: switches.stop.clone(),
        heartbeat: Some(switches.heartbeat.clone()),
        guards: vec![Arc::new(paths.clone())],
        floor: paths.floor(),
        ..if twin { patient() } else { ArmOptions::default() }
    };
    let driver = ArmDriver::connect(port, rig.clone(), options)?;
    let census = census(driver.scan(), latency_hint(&path));
    Ok(Box::new(DrivenArm { driver, census }))
}

fn patient() -> ArmOptions {
    ArmOptions {
        timing: BusTiming { answer_margin: Duration::from_millis(40), ..BusTiming::default() },
        cycle_deadline: Duration::from_millis(60),
        write_window: Duration::from_millis(60),
        missed_cycles: 25,
        ..ArmOptions::default()
    }
}

fn census(scan: &BusScan, latency: Option<String>) -> Census {
    let model = |found: &plumbline_hardware::dynamixel::FoundServo| {
        found.model().map_or_else(|| format!("{found}"), str::to_owned)
    };
    Census {
        missing: scan.missing.iter().map(|servo| servo.id).collect(),
        unexpected: scan.unexpected.iter().map(|found| (found.id, model(found))).collect(),
        warnings: scan.problems().iter().chain(&latency).map(|problem| sentence(problem)).collect(),
    }
}

impl Arm for DrivenArm {
    fn state(&self) -> Option<Arc<JointState>> {
        Some(self.driver.state())
    }

    fn at(&self, when: Instant) -> (Option<Posture>, Option<Posture>) {
        (self.driver.commanded_at(when), self.driver.posture_at(when))
    }

    fn begin(&self, motion: Move) -> Result<MoveId, Refusal> {
        // Said before it is queued: which joint, which limit.
        self.driver.check(&motion)?;
        // A setpoint that has not expired would take the place of the move.
        self.driver.end_following();
        self.driver.start_move(motion)
    }

    fn follow(&self, setpoint: Setpoint) -> Result<(), Refusal> {
        self.driver.follow(setpoint);
        Ok(())
    }

    fn grip(&self, grip: Grip) -> Result<(), Refusal> {
        // A setpoint that has not expired would take the fingers back.
        self.driver.end_following();
        self.driver.grip(grip)
    }

    fn hold(&self) -> Result<(), Refusal> {
        self.driver.end_following();
        self.driver.hold()
    }

    fn torque(&self, joints: &[JointIndex], on: bool) -> Result<(), Refusal> {
        if on { self.driver.engage(joints) } else { self.driver.relax(joints) }
    }

    fn shorten_answers(&self) -> Result<(), Refusal> {
        self.driver.shorten_answers()
    }

    fn census(&self) -> Census {
        self.census.clone()
    }
}

/// Serial ports of this machine.
pub fn ports() -> Result<Arc<[PortView]>, BusError> {
    let ports = list_ports()?;
    Ok(ports.into_iter().map(|port| PortView { what: port.description, path: port.path }).collect())
}

/// What went wrong on the bus, for people, with how often.
pub fn faults(counts: &BusCounts) -> Vec<(String, u64)> {
    let kind = |kind: FaultKind| (kind.to_string(), counts.faults.of(kind));
    FaultKind::ALL.into_iter().map(kind).filter(|(_, count)| *count > 0).collect()
}

/// Answers that were asked for once more.
pub fn retries(counts: &BusCounts) -> u64 {
    counts.retries
}
