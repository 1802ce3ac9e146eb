//! What a touch needs of whoever holds the arm.

use std::sync::Arc;
use std::time::Instant;

use plumbline_hardware::joints::JointState;
use plumbline_model::robot::Rig;

use crate::robot::arm::Arm;
use crate::robot::path::Paths;
use crate::robot::touch_order::TouchOrder;
use crate::robot::unable::Unable;

/// Whoever holds the arm.
pub trait Hand {
    /// The robot.
    fn rig(&self) -> &Arc<Rig>;

    /// The arm, if there is one.
    fn arm(&self) -> Result<&dyn Arm, Unable>;

    /// The newest state of the arm.
    fn state(&self) -> Option<Arc<JointState>>;

    /// Whether STOP is pressed.
    fn is_stopped(&self) -> bool;

    /// Since when the arm is connected.
    fn connected_at(&self) -> Option<Instant>;

    /// Which ways are free.
    fn paths(&self) -> &Paths;

    /// From now on the finger may meet the glass.
    fn allow_touch(&self, order: &TouchOrder);

    /// Tells the operator.
    fn warn(&mut self, text: String);
}
