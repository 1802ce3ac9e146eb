//! The joints of a robot, moved only within its limits.
//!
//! [`ArmDriver`] is the only way to move anything: it owns the bus, and the bus's writing side is
//! private to this crate. Each cycle reads the stop, reads every servo, moves the goals by a step
//! that all limits allow, and sends those that changed in one packet.
//!
//! - A goal is never sent farther ahead of the present angle than the rig's step limit: whatever
//!   becomes of the program, the arm stands within one step of where it was.
//! - A servo is written to only while it is known: who it is, that it holds, and where it is, all read
//!   in the same cycle. One that was silent, lost its power or its torque is limp until the operator
//!   takes hold of it; what stands is told nothing.
//! - Where a joint is not known, nothing of its chain moves ([`Chains`]).
//! - [`StopSwitch`] passes every queue and interrupts every wait; it latches.
//! - [`Heartbeat`] and the deadline of a [`Setpoint`] make the arm hold when nobody is there.
//! - A [`Refusal`] says which joint, which limit and by how much; nothing is clamped in silence.
//!   Where a joint stays behind, the whole move waits for it.
//! - What a [`Grip`] holds is pressed with a limited force, and goals of its fingers go on with them, within
//!   the same step. A hand that gets warm of it presses less.
//! - Holding means that what moved is told to stay at its present angle, above which its goal lies as far as
//!   the joint hung below it at rest nearby (a few degrees at most); what stood keeps its goal.

mod chains;
mod command;
mod controller;
mod driver;
mod droop;
mod easing;
mod exchange;
mod goals;
mod grip;
mod guard;
mod limiter;
mod motion;
mod options;
mod problem;
mod progress;
mod rate;
mod reading;
mod refusal;
mod report;
mod requests;
mod ring;
mod servo_unit;
mod slot;
mod stop;
mod torque;
mod touch;
mod trajectory;
mod watch;

#[cfg(test)]
mod tests;

pub use chains::Chains;
pub use command::{Motion, Move, MoveId, MoveOutcome, Pace, Setpoint, SetpointKind};
pub use driver::{ArmDriver, expected_servos};
pub use grip::{Grip, GripFinger};
pub use guard::{FARTHEST_FLOOR_M, FloorGuard, FloorShift, Guard};
pub use options::{ArmOptions, OnState};
pub use reading::{BusStatistics, JointReading, JointState};
pub use refusal::{HoldReason, Refusal, Unheard};
pub use stop::{Heartbeat, StopSwitch};
pub use touch::{ScreenGone, Touch, TouchSource};
