//! What is wrong with a servo, in words.

use plumbline_model::robot::Gate;

use super::exchange::Slot;

/// What is wrong and what to do; the worst first.
pub(super) fn of(slot: &Slot, gate: &Gate) -> Option<String> {
    let id = slot.unit.id();
    if !slot.in_use() {
        return Some(format!(
            "servo {id} does not answer and is left out: check its cable and power; it is asked again now and then"
        ));
    }
    if slot.torque_lost {
        return Some(format!(
            "servo {id} switched its torque off by itself: let it cool down or lighten its load, then switch torque on"
        ));
    }
    if slot.missed > 2 {
        return Some(format!(
            "servo {id} did not answer in the last {} cycles: check its cable",
            slot.missed
        ));
    }
    if let Some(temperature_c) = slot.reading.temperature_c.filter(|t| *t >= gate.hot_c) {
        return Some(format!(
            "servo {id} is {temperature_c:.0} °C hot, nothing moves from {:.0} °C on: relax the arm and let it cool down",
            gate.hot_c
        ));
    }
    slot.complaint.as_ref().map(|words| format!("servo {id} says: {words}"))
}

/// A servo that gets warm.
pub(super) fn warm(title: &str, temperature_c: f64, gate: &Gate) -> String {
    format!(
        "{title} is at {temperature_c:.0} °C; nothing moves from {:.0} °C on: relax the arm in the next pause",
        gate.hot_c
    )
}
