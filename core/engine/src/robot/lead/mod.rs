//! Somebody leads the arm, order by order (a grasp): the robot's thread carries out one at a time and
//! answers. What moves goes through [`super::arm::Arm`] and with it through all limits.

mod closing;
mod course;
mod follow;
mod late;
#[cfg(test)]
mod late_tests;
#[cfg(test)]
pub(crate) mod made_up;
mod wire;

pub use wire::{GivenUp, LeadAnswer, LeadOrder, Leader, Led, Reins};

use std::sync::Arc;
use std::time::Instant;

use crossbeam_channel::TryRecvError;
use plumbline_hardware::joints::{ArmOptions, HoldReason, JointState, Motion, Refusal};

use self::closing::Closing;
use self::follow::Following;
use super::command::RobotCommand;
use super::control::RobotControl;
use super::unable::Unable;
use super::worker::Worker;
use crate::ground::notice::NoticeLevel;

/// Whoever leads the arm just now, if anybody does, and what is being done for him.
#[derive(Default)]
pub struct Leading {
    led: Option<Led>,
    doing: Option<Doing>,
    /// Why nothing is done for him any more.
    over: Option<GivenUp>,
}

enum Doing {
    Following(Following),
    Closing(Closing),
}

/// What a look at an order leads to; `Err`: it ends, and why.
type Stepped = Result<bool, GivenUp>;

impl Leading {
    /// What is being done, for people; `None` when nobody leads.
    pub fn title(&self) -> Option<String> {
        self.led.as_ref().map(|led| led.title.clone())
    }

    /// The same while the arm may move by it.
    pub fn moving_title(&self) -> Option<String> {
        self.led.as_ref().filter(|led| led.moves).map(|led| led.title.clone())
    }

    /// Whether what is done for him pauses and the arm stands meanwhile.
    pub fn rests(&self, motion: &Motion) -> bool {
        let pauses = self.led.as_ref().is_some_and(|led| led.moves && led.reins.is_tight());
        pauses && matches!(motion, Motion::Holding(_))
    }

    /// Whether a command would get in the way.
    pub fn forbids(&self, control: &RobotControl) -> bool {
        use RobotCommand::{Jog, Preview, RunPreview, Scan};
        let moves = match control {
            RobotControl::Robot(command) => matches!(command, Preview(_) | RunPreview | Jog(_) | Scan),
            // Orders of a run of touches are answered to the run.
            RobotControl::TurnHead { .. } | RobotControl::Lead(_) => true,
            _ => false,
        };
        moves && self.led.is_some()
    }

    /// Why it was forbidden.
    pub fn busy(&self) -> Unable {
        Unable::Led(self.title().unwrap_or_default())
    }
}

impl Worker {
    /// Whether orders come that must not wait.
    pub fn is_led(&self) -> bool {
        self.leading.led.is_some()
    }

    pub(super) fn begin_lead(&mut self, led: Led) -> Result<(), Unable> {
        let may = self.may_lead();
        if let Err(why) = &may {
            led.tell(LeadAnswer::GivenUp(GivenUp::Refused(why.to_string())));
            return may;
        }
        (self.preview, self.refusal) = (None, None);
        self.leading = Leading { led: Some(led), doing: None, over: None };
        Ok(())
    }

    fn may_lead(&self) -> Result<(), Unable> {
        self.arm()?;
        if self.touching.is_busy() {
            return Err(self.touching.busy());
        }
        if self.switches.stop.is_pressed() {
            return Err(Refusal::Stopped.into());
        }
        if self.jog.is_some() || self.running.is_some() {
            return Err(Unable::Led("something else moves it".to_owned()));
        }
        Ok(())
    }

    /// Takes orders and goes on with the one that is carried out.
    pub(super) fn step_lead(&mut self, now: Instant) {
        let Some(led) = self.leading.led.clone() else { return };
        if let Some(state) = self.arm().ok().and_then(|arm| arm.state()) {
            led.note(&state);
        }
        loop {
            match led.orders.try_recv() {
                Ok(order) => self.take_order(&led, order),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return self.leader_is_gone(),
            }
        }
        // Before it is asked whether it ended: who ends what pauses lets it loose afterwards.
        let pauses = led.reins.is_tight();
        if led.reins.is_ended() {
            // The arm waits for nobody to notice. Whoever leads gives the order up by himself and gets his
            // answer then: another one now would be taken for that of his next order.
            self.break_off();
            return;
        }
        let Some(doing) = self.leading.doing.take() else { return };
        let state = match self.state_that_may_move() {
            Ok(state) => state,
            Err(why) => return self.give_up(why),
        };
        let (doing, stepped) = match doing {
            Doing::Following(mut following) => {
                let stepped = following.step(self, &state, pauses, now);
                if let Some(news) = following.take_news() {
                    self.note(NoticeLevel::Info, news);
                }
                (Doing::Following(following), stepped)
            }
            Doing::Closing(mut closing) => {
                let stepped = closing.step(self, &state, pauses, now);
                (Doing::Closing(closing), stepped)
            }
        };
        led.wait(matches!(&doing, Doing::Following(following) if following.is_waiting()));
        match stepped {
            Ok(false) => self.leading.doing = Some(doing),
            Ok(true) => led.tell(LeadAnswer::Done),
            Err(why) => {
                self.leading.doing = Some(doing);
                self.give_up(why);
            }
        }
    }

    fn take_order(&mut self, led: &Led, order: LeadOrder) {
        if let Some(why) = self.leading.over.clone().filter(|_| order != LeadOrder::Hold) {
            return led.tell(LeadAnswer::GivenUp(why));
        }
        match order {
            LeadOrder::Follow { way, speed_rad_s } => {
                self.leading.doing = Some(Doing::Following(Following::new(way, speed_rad_s)));
            }
            LeadOrder::Close { goals } => {
                self.leading.doing = Some(Doing::Closing(Closing::new(goals)));
            }
            LeadOrder::MayTouch(allowances) => {
                self.paths.allow(allowances);
                led.tell(LeadAnswer::Done);
            }
            LeadOrder::Hold => {
                self.break_off();
                led.tell(LeadAnswer::Done);
            }
            LeadOrder::State => {
                let answer = self.state_for_lead().map_or_else(LeadAnswer::GivenUp, LeadAnswer::State);
                led.tell(answer);
            }
            LeadOrder::At(when) => {
                let measured = self.arm().map(|arm| arm.at(when).1);
                let lost = |why: Unable| LeadAnswer::GivenUp(GivenUp::Lost(why.to_string()));
                led.tell(measured.map_or_else(lost, LeadAnswer::At));
            }
        }
    }

    /// The newest state, unless there is no arm any more.
    fn state_for_lead(&self) -> Result<Arc<JointState>, GivenUp> {
        let arm = self.arm().map_err(|why| GivenUp::Lost(why.to_string()))?;
        let state = arm.state().ok_or_else(|| GivenUp::Lost("no joint was read yet".to_owned()))?;
        match &state.gone {
            Some(reason) => Err(GivenUp::Lost(reason.clone())),
            None => Ok(state),
        }
    }

    /// The same, unless nothing may move.
    fn state_that_may_move(&self) -> Result<Arc<JointState>, GivenUp> {
        let state = self.state_for_lead()?;
        let is_stopped = self.switches.stop.is_pressed() || state.stopped;
        if is_stopped { Err(GivenUp::Stopped) } else { Ok(state) }
    }

    /// What is done ends where it is: the arm holds, and fingers that close stand. Whether anything was.
    fn break_off(&mut self) -> bool {
        if let Some(led) = &self.leading.led {
            led.wait(false);
        }
        let Some(doing) = self.leading.doing.take() else { return false };
        let state = self.state_that_may_move();
        if let (Doing::Closing(closing), Ok(state)) = (&doing, &state) {
            let _ = closing.stand(self, state);
        }
        let _ = self.arm().map(|arm| arm.hold());
        true
    }

    /// The order under way ends; the arm holds where it is.
    fn give_up(&mut self, why: GivenUp) {
        if !self.break_off() {
            let _ = self.arm().map(|arm| arm.hold());
        }
        if let Some(led) = &self.leading.led {
            led.tell(LeadAnswer::GivenUp(why));
        }
    }

    /// Nobody leads any more: by himself, or because he failed.
    fn leader_is_gone(&mut self) {
        self.break_off();
        self.leading.led = None;
        self.paths.allow(vec![]);
    }

    /// The operator takes the arm in hand: whoever moves it ends, also between two orders, so that nothing goes on by
    /// itself with joints that were limp meanwhile.
    pub(super) fn end_lead(&mut self, why: &str) {
        if self.leading.led.as_ref().is_none_or(|led| !led.moves) {
            return;
        }
        let why = GivenUp::Lost(why.to_owned());
        self.leading.over = Some(why.clone());
        if self.leading.doing.is_some() {
            self.give_up(why);
        }
    }

    /// Whether the window gives no sign of life, so that the arm would hold.
    fn is_alone(&self) -> bool {
        self.switches.heartbeat.age() > ArmOptions::default().heartbeat_timeout
    }

    /// Ends it from outside: there is no arm any more.
    pub(super) fn interrupt_lead(&mut self, reason: &str) {
        if self.leading.doing.is_some() {
            self.give_up(GivenUp::Lost(reason.to_owned()));
        }
        self.leader_is_gone();
    }
}

impl From<Refusal> for GivenUp {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Stopped => Self::Stopped,
            Refusal::Gone(_) | Refusal::Unknown { .. } | Refusal::UnknownInChain { .. } => {
                Self::Lost(refusal.to_string())
            }
            other => Self::Refused(other.to_string()),
        }
    }
}

impl From<HoldReason> for GivenUp {
    fn from(reason: HoldReason) -> Self {
        match reason {
            HoldReason::Stop => Self::Stopped,
            HoldReason::Refused(refusal) => refusal.into(),
            HoldReason::Gone(_) | HoldReason::NoAnswer { .. } | HoldReason::TorqueLost { .. } => {
                Self::Lost(reason.to_string())
            }
            other => Self::Refused(other.to_string()),
        }
    }
}

impl From<Unable> for GivenUp {
    fn from(why: Unable) -> Self {
        match why {
            Unable::Arm(refusal) => refusal.into(),
            Unable::NotConnected => Self::Lost(why.to_string()),
            other => Self::Refused(other.to_string()),
        }
    }
}
