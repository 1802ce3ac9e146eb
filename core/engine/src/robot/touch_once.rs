//! The worker touches the screen once: what it asks of itself before, and what it does when the touch
//! goes on, ends or is interrupted.

use std::sync::Arc;
use std::time::Instant;

use plumbline_hardware::joints::{FloorGuard, JointState, Touch, TouchSource};
use plumbline_model::robot::{Posture, Rig};

use super::arm::Arm;
use super::path::Paths;
use super::touch_order::{TouchNews, TouchOrder, TouchRun, TouchStage, WithdrawOrder};
use super::touching::{Hand, Run, Step, Withdrawing};
use super::unable::{Interrupted, Unable};
use super::view::Connection;
use super::worker::Worker;
use crate::ground::notice::NoticeLevel;
use crate::motion::{is_believed, touch_allowances};

impl Worker {
    /// How touches are doing, since the last call.
    pub fn take_touch_news(&mut self) -> Vec<TouchNews> {
        std::mem::take(&mut self.touching.news)
    }

    /// Whether a finger is on its way to the glass or on it: it has to be looked after often.
    pub fn is_lowering(&self) -> bool {
        let stage = self.touching.run.as_ref().map(Run::stage);
        matches!(stage, Some(TouchStage::Lowering | TouchStage::Dwelling))
    }

    pub(super) fn begin_touch(&mut self, order: TouchOrder, now: Instant) {
        let of_twin = matches!(self.connection, Connection::Connected { twin: true, .. });
        let glass = self.desk.touchscreen().filter(|_| of_twin);
        if glass.is_some() && self.touching.run.is_none() {
            self.desk.free_screen(&self.rig);
        }
        let source: Box<dyn TouchSource> = match glass {
            Some(glass) => Box::new(glass),
            None => Box::new(self.touching.window.clone()),
        };
        self.begin_touch_with(order, source, now);
    }

    pub(super) fn begin_touch_with(&mut self, order: TouchOrder, source: Box<dyn TouchSource>, now: Instant) {
        let told = (order.order, Some(order.number));
        if let Err(reason) = self.may_touch(&order) {
            return self.touching.tell(told, not_begun(&reason));
        }
        match Run::new(&self.rig, order.clone(), source, self.refusals(), now) {
            Ok(run) => {
                (self.preview, self.refusal) = (None, None);
                let chain = self.rig.chain(&order.tip).map_or(vec![], |chain| chain.joints().to_vec());
                self.paths.sent_beside(&chain, order.beside_m);
                self.touching.tell(told, TouchRun::Doing(run.stage()));
                self.touching.run = Some(run);
                self.step_touch(now);
            }
            Err(reason) => self.touching.tell(told, not_begun(&reason)),
        }
    }

    pub(super) fn begin_withdrawing(&mut self, order: WithdrawOrder) {
        let told = (order.order, order.number);
        let (beside_m, tip) = (order.beside_m, order.tip.clone());
        let begun =
            self.may_withdraw(&order).and_then(|()| Withdrawing::new(&self.rig, order, self.refusals()));
        match begun {
            Ok(withdrawing) => {
                (self.preview, self.refusal) = (None, None);
                let chain = self.rig.chain(&tip).map_or(vec![], |chain| chain.joints().to_vec());
                self.paths.sent_beside(&chain, beside_m);
                self.touching.tell(told, TouchRun::Doing(TouchStage::Withdrawing));
                self.touching.withdrawing = Some(withdrawing);
                self.step_withdrawing();
            }
            Err(reason) => self.touching.tell(told, not_begun(&reason)),
        }
    }

    fn may_withdraw(&self, order: &WithdrawOrder) -> Result<(), Interrupted> {
        self.is_free_to_move()?;
        let paced = order.speed_rad_s > 0.0 && order.speed_rad_s.is_finite();
        if !(paced && order.way.iter().all(|posture| self.fits(posture)) && is_believed(&order.beside_m, 0.0))
        {
            return Err(Interrupted::NoWay);
        }
        Ok(())
    }

    fn step_withdrawing(&mut self) {
        let Some(mut withdrawing) = self.touching.withdrawing.take() else { return };
        let step = withdrawing.step(self);
        self.withdrew(withdrawing, step);
    }

    fn withdrew(&mut self, withdrawing: Withdrawing, step: Result<bool, Interrupted>) {
        let told = (withdrawing.order().order, withdrawing.order().number);
        match step {
            Ok(false) => self.touching.withdrawing = Some(withdrawing),
            Ok(true) => {
                self.paths.as_described();
                self.touching.tell(told, TouchRun::Away);
            }
            Err(reason) => {
                let what = format!("The way away from the screen was interrupted. {reason}");
                self.broken_off(told, &what, &reason);
            }
        }
    }

    /// Refusals up to this number are older than what begins now.
    fn refusals(&self) -> u64 {
        self.state().and_then(|state| state.refusal.as_ref().map(|(number, _)| *number)).unwrap_or_default()
    }

    fn fits(&self, posture: &Posture) -> bool {
        posture.len() == self.rig.description.movable_count() && posture.is_finite()
    }

    fn is_free_to_move(&self) -> Result<(), Interrupted> {
        if self.touching.is_busy() {
            return Err(self.touching.busy().into());
        }
        if self.is_led() {
            return Err(self.leading.busy().into());
        }
        self.arm()?;
        if self.switches.stop.is_pressed() {
            return Err(Interrupted::StopIsPressed);
        }
        if self.jog.is_some() || self.running.is_some() {
            return Err(Interrupted::Moves);
        }
        if self.present().is_none() {
            return Err(Interrupted::NotRead);
        }
        Ok(())
    }

    fn may_touch(&self, order: &TouchOrder) -> Result<(), Interrupted> {
        self.is_free_to_move()?;
        let whole = order.lower.len() >= 2
            && order.lower.len() == order.lower_tip.len()
            && order.approach.iter().chain(&order.lower).all(|posture| self.fits(posture));
        let positive = |value: f64| value > 0.0 && value.is_finite();
        let known = is_believed(&order.beside_m, order.deeper_m);
        let paced = positive(order.lower_speed_m_s) && positive(order.speed_rad_s);
        if !(whole && paced && known && positive(order.plausible_px)) {
            return Err(Interrupted::NoWay);
        }
        Ok(())
    }

    /// Up again, if the finger is down; the touch then counts as missed.
    pub(super) fn abandon_touch(&mut self) {
        if let Some(withdrawing) = self.touching.withdrawing.take() {
            let _ = self.arm().map(|arm| arm.hold());
            self.paths.as_described();
            let told = (withdrawing.order().order, withdrawing.order().number);
            let why = "The arm was stopped on its way from the screen.".to_owned();
            self.touching.tell(told, TouchRun::Missed(why));
        }
        let Some(mut run) = self.touching.run.take() else { return };
        let step = run.abandon(self);
        self.went(run, step);
    }

    pub(super) fn felt_by_window(&mut self, contact: Touch) {
        self.touching.window.felt(contact);
    }

    pub(super) fn step_touch(&mut self, now: Instant) {
        self.step_withdrawing();
        let Some(mut run) = self.touching.run.take() else { return };
        let step = run.step(self, now);
        self.went(run, step);
    }

    /// Ends a touch from outside: it cannot go on.
    pub(super) fn interrupt_touch(&mut self, reason: &str) {
        let told = Interrupted::Told(reason.to_owned());
        if let Some(run) = self.touching.run.take() {
            self.went(run, Err(told));
        } else if let Some(withdrawing) = self.touching.withdrawing.take() {
            self.withdrew(withdrawing, Err(told));
        }
    }

    fn went(&mut self, run: Run, step: Result<Step, Interrupted>) {
        let told = (run.order().order, Some(run.order().number));
        match step {
            Ok(Step::Same) => self.touching.run = Some(run),
            Ok(Step::Next) => {
                self.touching.tell(told, TouchRun::Doing(run.stage()));
                self.touching.run = Some(run);
            }
            Ok(Step::End(end)) => {
                self.paths.as_described();
                self.touching.tell(told, end);
            }
            Err(reason) => {
                let (number, stage) = (run.order().number, run.stage().name());
                let what = format!("Touch {number} was interrupted ({stage}). {reason}");
                self.broken_off(told, &what, &reason);
            }
        }
    }

    /// The arm holds where it is, and the run is told why.
    fn broken_off(&mut self, told: (u64, Option<usize>), what: &str, reason: &Interrupted) {
        // Goals below the glass become where the finger is: the next move starts outside.
        let _ = self.arm().map(|arm| arm.hold());
        self.paths.as_described();
        let end = match reason.is_unheard() {
            true => TouchRun::Unheard(format!("{what} The arm was held where it was.")),
            false => TouchRun::Interrupted(format!("{what} When the way of the arm is free, go on.")),
        };
        self.touching.tell(told, end);
    }
}

fn not_begun(reason: &Interrupted) -> TouchRun {
    match reason.is_unheard() {
        true => TouchRun::Unheard(reason.to_string()),
        false => TouchRun::Interrupted(reason.to_string()),
    }
}

impl Hand for Worker {
    fn rig(&self) -> &Arc<Rig> {
        &self.rig
    }

    fn arm(&self) -> Result<&dyn Arm, Unable> {
        Self::arm(self)
    }

    fn state(&self) -> Option<Arc<JointState>> {
        self.arm.as_ref().and_then(|arm| arm.state())
    }

    fn is_stopped(&self) -> bool {
        self.switches.stop.is_pressed()
    }

    fn connected_at(&self) -> Option<Instant> {
        self.connected_at
    }

    fn paths(&self) -> &Paths {
        &self.paths
    }

    fn allow_touch(&self, order: &TouchOrder) {
        let Ok(chain) = self.rig.chain(&order.tip) else { return };
        let floor = FloorGuard::new(&self.rig);
        let posture = (&order.lower[0], order.deeper_m);
        let allowances = touch_allowances(&self.paths.model(), &floor, &chain, posture);
        self.paths.lower(allowances, order.deeper_m);
    }

    fn warn(&mut self, text: String) {
        self.note(NoticeLevel::Warning, text);
    }
}
