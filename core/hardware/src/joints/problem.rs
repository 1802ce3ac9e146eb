//! What is wrong with a servo, in words.

use plumbline_model::robot::Gate;

use super::refusal::Unheard;
use super::slot::Slot;
use super::torque::barred;

/// What is wrong and what to do; the worst first.
pub(super) fn of(slot: &Slot, gate: &Gate) -> Option<String> {
    let id = slot.unit.id();
    if let Some(refusal) = barred(slot) {
        return Some(refusal.to_string());
    }
    if slot.silent {
        return Some(match &slot.complaint {
            None if slot.unheard() == Unheard::TooBusy => format!(
                "servo {id} answers too late and is left out, where its joint is, is not known: {}; it is asked again twice a second",
                Unheard::TooBusy.advice()
            ),
            Some(words) => format!("servo {id} is left out: {words}"),
            None => format!(
                "servo {id} does not answer and is left out, where its joint is, is not known: check its cable and power; it is asked again twice a second"
            ),
        });
    }
    if slot.is_overdue() {
        return Some(match slot.reading.read_at {
            Some(at) => format!(
                "servo {id} was not read for {:.0} s, where its joint is, is not known: this computer or the servo line does not keep up; close other programs",
                at.elapsed().as_secs_f64()
            ),
            None => format!("servo {id} has not been read yet"),
        });
    }
    if slot.torque_lost {
        return Some(format!(
            "servo {id} lost its torque: its power was cut, or it was overloaded or too hot; support the joint, then switch torque on"
        ));
    }
    if slot.let_go {
        return Some(format!(
            "servo {id} did not answer for a while: nothing is sent to it until you switch torque on, which holds it where it is then"
        ));
    }
    if slot.holds_unasked() {
        return Some(format!(
            "servo {id} holds, and nobody has taken hold of it here: nothing is sent to it until you switch torque on, which holds it where it is then"
        ));
    }
    if slot.missed > 2 && slot.answers_late() {
        return Some(format!(
            "servo {id} answered too late in the last {} cycles: {}",
            slot.missed,
            Unheard::TooBusy.advice()
        ));
    }
    if slot.missed > 2 {
        return Some(format!(
            "servo {id} did not answer in the last {} cycles: check its cable",
            slot.missed
        ));
    }
    if slot.has_no_force() {
        return Some(format!(
            "servo {id} shut down after an overload and has no force, though its torque is on: support and lighten the joint, then switch torque on, which gives it force again"
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

/// A servo that gets warm because it presses on what is held.
pub(super) fn warm_of_holding(title: &str, temperature_c: f64, gate: &Gate) -> String {
    format!(
        "{title} is at {temperature_c:.0} °C from pressing, and lets go at {:.0} °C: put down what the hand holds, or open it",
        gate.hot_c
    )
}

/// Nobody answers any more.
pub(super) const ALL_SILENT: &str = "no servo answers: their power seems to be off, or the cable is unplugged. When they are back nothing moves and all are limp until you switch torque on";

/// Everybody answers too late.
pub(super) const ALL_LATE: &str = "all servos answer too late: the computer is too busy to hear them in time; close other programs. When they are heard again nothing moves and all are limp until you switch torque on";

/// Bytes per second that belong to nothing from which on somebody else talks on the line.
pub(super) const FLOOD_BYTES_PER_S: f64 = 2000.0;

/// Somebody else talks.
pub(super) fn flood(bytes_per_s: f64) -> String {
    format!(
        "the servo line carries {:.0} kB a second that no servo should send: unplug whatever else talks on it; nothing is moved on what cannot be read",
        bytes_per_s / 1e3
    )
}

/// Servos that wait before they answer.
pub(super) fn slow(count: usize, longest_s: f64) -> String {
    format!(
        "{count} servos wait up to {:.2} ms before each answer, which makes the bus slow: relax the arm and choose \"Shorten answers\", which writes it to their memory once",
        longest_s * 1e3
    )
}
