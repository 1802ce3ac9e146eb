//! Away from the screen: one posture after the other, and no touch.

use plumbline_hardware::joints::MoveId;
use plumbline_model::robot::{JointIndex, Rig};

use super::hand::Hand;
use super::run::{go, has_arrived, joints_of, state_that_may_move};
use crate::robot::touch_order::WithdrawOrder;
use crate::robot::unable::Interrupted;

/// An arm on its way from the screen.
pub struct Withdrawing {
    order: WithdrawOrder,
    /// All joints that may move.
    joints: Vec<JointIndex>,
    next: usize,
    moving: Option<MoveId>,
    /// Refusals up to this number are older.
    refusals: u64,
}

impl Withdrawing {
    pub fn new(rig: &Rig, order: WithdrawOrder, refusals: u64) -> Result<Self, Interrupted> {
        let joints = joints_of(rig, &order.tip).ok_or_else(|| Interrupted::NoArm(order.tip.clone()))?;
        Ok(Self { order, joints, next: 0, moving: None, refusals })
    }

    pub fn order(&self) -> &WithdrawOrder {
        &self.order
    }

    /// For people.
    pub fn title(&self) -> String {
        "away from the screen".to_owned()
    }

    /// Goes on; `true`: it stands at the end of its way.
    pub fn step(&mut self, hand: &dyn Hand) -> Result<bool, Interrupted> {
        let state = state_that_may_move(hand, self.refusals, &self.joints)?;
        if let Some(id) = self.moving {
            if !has_arrived(&state, id)? {
                return Ok(false);
            }
            (self.next, self.moving) = (self.next + 1, None);
        }
        while let Some(posture) = self.order.way.get(self.next) {
            if let Some(id) = go(hand, &state, posture, &self.joints, self.order.speed_rad_s)? {
                self.moving = Some(id);
                return Ok(false);
            }
            self.next += 1;
        }
        Ok(true)
    }
}
