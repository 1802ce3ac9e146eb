//! What the arm tells about itself.

use std::sync::Arc;
use std::time::Instant;

use plumbline_model::duration;
use plumbline_model::image_pair::Stamp;

use super::command::Motion;
use super::controller::{Controller, Mode};
use super::problem;
use super::reading::{BusStatistics, JointState};
use super::refusal::Unheard;
use super::torque::slow_answers;

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
            reading.let_go = slot.let_go || slot.holds_unasked();
            if let Some(temperature_c) = reading.temperature_c.filter(|t| *t >= gate.warm_c) {
                let grips = self.grips.iter().any(|grip| grip.joint == reading.joint);
                let warm = if grips { problem::warm_of_holding } else { problem::warm };
                warnings.push(warm(&slot.unit.servo.title, temperature_c, gate));
            }
            reading
        });
        let joints: Arc<[_]> = joints.collect();
        let slots = &self.exchange.slots;
        let all_silent = !slots.is_empty() && slots.iter().all(|slot| !slot.in_use());
        if all_silent {
            let late = slots.iter().any(|slot| slot.unheard() == Unheard::TooBusy);
            warnings.insert(0, if late { problem::ALL_LATE } else { problem::ALL_SILENT }.to_owned());
        }
        let strays_per_s = self.rate.strays_per_s();
        if strays_per_s > problem::FLOOD_BYTES_PER_S {
            warnings.push(problem::flood(strays_per_s));
        }
        let slow = slow_answers(slots);
        if let Some((count, longest)) = slow {
            warnings.push(problem::slow(count, longest.as_secs_f64()));
        }
        let limp = joints.iter().all(|reading| reading.torque_on != Some(true));
        let motion = match &self.mode {
            Mode::Hold(_) if all_silent && self.gone.is_none() => Motion::Unknown,
            Mode::Hold(_) if limp && self.gone.is_none() => Motion::Limp,
            Mode::Hold(_) if self.is_closing() && self.gone.is_none() => Motion::Following,
            Mode::Hold(reason) => Motion::Holding(reason.clone()),
            Mode::Move { id, line, fraction, .. } => {
                let remaining =
                    duration::seconds((1.0 - fraction).max(0.0) * line.duration_s).unwrap_or_default();
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
            unknown: self.unknown().into(),
            late: self.late().into(),
            slow_answers: slow.map(|(count, _)| count).unwrap_or(0),
            commanded: self.commanded.clone(),
            at_rest: self.at_rest().into(),
            bus: BusStatistics {
                cycles: self.seq,
                complete_cycles: self.complete,
                complete_per_s: self.rate.per_s(now),
                last_cycle: self.rate.last_cycle,
                last_wire_s: self.rate.last_cycle.seconds(
                    timing.baud,
                    slow.map_or(self.options.return_delay, |(_, longest)| longest).as_secs_f64(),
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
