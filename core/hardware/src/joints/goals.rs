//! Goals on their way to the servos: the only place that writes them.

use std::time::Duration;

use super::exchange::Exchange;
use super::refusal::Refusal;
use super::slot::Slot;
use crate::dynamixel::BusError;

/// A servo may catch up with its goal at this much more than the largest planned speed.
const CATCH_UP: f64 = 1.25;

/// Rounding to ticks makes a goal no farther than it was meant to be, rad.
const ROUNDING_RAD: f64 = 2e-3;

/// Goals whose registers lie at the same place.
struct GoalPacket {
    address: u16,
    length: u16,
    goals: Vec<(u8, Vec<u8>)>,
}

impl Exchange {
    /// Sends goals (rad of the joint) to servos that may be written to and whose register holds
    /// another: a servo that stands is told nothing, and one whose packet was lost is told again.
    /// One packet for all servos whose goals lie at the same address.
    ///
    /// No goal is written that lies farther than the rig's step from an angle read no longer than
    /// `window` ago.
    pub fn send_goals(
        &mut self,
        window: Duration,
        goal_rad: impl Fn(&Slot) -> f64,
    ) -> Result<Option<Refusal>, BusError> {
        let mut refusal = None;
        let mut packets: Vec<GoalPacket> = vec![];
        let (step_rad, speed_rad_s) = (self.step_rad + ROUNDING_RAD, self.speed_rad_s * CATCH_UP);
        for slot in self.slots.iter_mut().filter(|slot| slot.may_be_written(window)) {
            let goal_rad = goal_rad(slot);
            let (Some(address), Some(angle_rad)) = (slot.unit.goal_address(), slot.reading.angle_rad) else {
                continue;
            };
            let ticks = match slot.unit.goal_ticks(goal_rad) {
                Ok(ticks) => ticks,
                Err(error) => {
                    refusal = Some(error);
                    continue;
                }
            };
            if slot.goal == Some(ticks) && !slot.insist {
                continue;
            }
            // NaN fails the comparison.
            if !((goal_rad - angle_rad).abs() <= step_rad) {
                continue;
            }
            slot.insist = false;
            slot.reading.goal_rad = Some(goal_rad);
            let bytes = slot.unit.goal_bytes(ticks, speed_rad_s);
            let length = bytes.len() as u16;
            match packets.iter_mut().find(|packet| (packet.address, packet.length) == (address, length)) {
                Some(packet) => packet.goals.push((slot.unit.id(), bytes)),
                None => packets.push(GoalPacket { address, length, goals: vec![(slot.unit.id(), bytes)] }),
            }
        }
        for packet in packets {
            self.bus.sync_write(packet.address, packet.length, packet.goals)?;
        }
        Ok(refusal)
    }
}
