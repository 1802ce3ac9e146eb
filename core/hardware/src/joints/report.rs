//! What the arm tells about itself.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_model::image_pair::Stamp;

use super::command::Motion;
use super::controller::{Controller, Mode};
use super::problem;
use super::reading::{BusStatistics, JointState};

impl Controller {
    /// What is known now.
    pub fn state(&self) -> JointState {
        let now = Instant::now();
        let gate = &self.limiter.rig.gate;
        let mut warnings = vec![];
        let joints = self.exchange.slots.iter().map(|slot| {
            let mut reading = slot.reading.clone();
            reading.age = reading.read_at.map(|at| now.duration_since(at));
            reading.problem = problem::of(slot, gate);
            if let Some(temperature_c) = reading.temperature_c.filter(|t| *t >= gate.warm_c) {
                warnings.push(problem::warm(&slot.unit.servo.title, temperature_c, gate));
            }
            reading
        });
        let joints: Arc<[_]> = joints.collect();
        let limp = joints.iter().all(|reading| reading.torque_on != Some(true));
        let motion = match &self.mode {
            Mode::Hold(_) if limp && self.gone.is_none() => Motion::Limp,
            Mode::Hold(reason) => Motion::Holding(reason.clone()),
            Mode::Move { id, line, fraction, .. } => {
                let remaining = Duration::from_secs_f64((1.0 - fraction).max(0.0) * line.duration_s);
                Motion::Moving { id: *id, fraction: *fraction, remaining }
            }
            Mode::Follow { .. } => Motion::Following,
        };
        let timing = self.exchange.bus.timing();
        JointState {
            stamp: Stamp { seq: self.seq, captured_at: now },
            joints,
            motion,
            stopped: self.options.stop.is_pressed(),
            measured: self.measured(),
            commanded: self.commanded.clone(),
            bus: BusStatistics {
                cycles: self.seq,
                complete_cycles: self.complete,
                complete_per_s: self.rate.per_s(now),
                last_cycle: self.rate.last_cycle,
                last_wire_s: self.rate.last_cycle.seconds(
                    timing.baud,
                    self.options.return_delay.unwrap_or(Duration::from_micros(500)).as_secs_f64(),
                    0.0,
                ),
                counts: self.exchange.bus.counts().clone(),
            },
            outcomes: self.outcomes.iter().cloned().collect(),
            refusal: self.refusal.clone(),
            warnings: warnings.into(),
            gone: self.gone.clone(),
            scan: self.scan.clone(),
        }
    }
}
