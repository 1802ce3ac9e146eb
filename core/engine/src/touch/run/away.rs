//! Before somebody reaches for the screen or the hand the arm goes away from the screen: what is put under the screen
//! lifts it, and a finger that hovers over it would be pushed into it. A run that is over leaves no hand over the glass:
//! what is done next needs the place, or hides behind the hand.

use std::sync::Arc;

use plumbline_model::robot::{Arm, Posture, Rig};
use plumbline_model::session::Touchscreen;

use super::going::{next_order, speed};
use super::{AS_IT_LIES, AtEnd, Now, Phase, Run, Task, UnderWay};
use crate::ground::notice::NoticeLevel;
use crate::motion::{NoWay, TouchPace};
use crate::robot::view::MotionState;
use crate::robot::{RobotControl, TouchStage, WithdrawOrder};
use crate::touch::over::{TO_REACH, arm_in, is_away};
use crate::touch::refusal::Refusal;
use crate::touch::work::{AwayRequest, Context, TouchWork};

impl Run {
    /// All is done, or shall be: the screen is put back and the weight taken off before the run is over, for from then
    /// on the screen is taken to lie where it lay.
    pub(super) fn put_back(&mut self, now: &Now<'_>, context: &mut Context<'_>) {
        if self.progress.prepared == AS_IT_LIES {
            return self.leave(now, context);
        }
        if let Some(trouble) = &now.trouble {
            self.phase = Phase::Paused(Some(trouble.to_string()));
            return;
        }
        self.prepare(AS_IT_LIES, None, now, context);
    }

    /// All is done: the arm goes home, as it was said, and the run is over. Where it cannot, the run is over all the same.
    fn leave(&mut self, now: &Now<'_>, context: &mut Context<'_>) {
        let stays = !self.was_sent || self.stays || self.is_away || self.is_clear_of(now.screen, now);
        match now.robot.measured.clone() {
            Some(from) if !stays && now.trouble.is_none() => return self.go_away(None, from, now, context),
            _ if !stays => self.stays_there(context),
            _ => {}
        }
        self.finish(now, context);
    }

    /// No touch is left and everything lies as it lay: only the way home is.
    pub(in crate::touch) fn only_leaves(&self) -> bool {
        self.next().is_none() && self.progress.prepared == AS_IT_LIES
    }

    /// The arm could not go home at the end, which is no reason for the run to wait.
    pub(super) fn stays_there(&mut self, context: &mut Context<'_>) {
        self.stays = true;
        let text = "The run is over, but the arm could not go home and stays near the screen: bring it home (Robot) when its way is free.";
        context.notices.add(NoticeLevel::Warning, text.to_owned());
    }

    /// The run is over, even where the screen still stands on its block or the weight still hangs at the hand.
    pub(super) fn leave_it_so(&mut self, now: &Now<'_>, context: &mut Context<'_>) {
        if let Some(left) = self.left_to_put_back() {
            let text = format!("Before anything moves: {left}. From now on it is taken to be so.");
            context.notices.add(NoticeLevel::Warning, text);
            (self.progress.prepared, self.is_hearsay) = (AS_IT_LIES, false);
            self.tell_twin(now.robot, context);
        }
        self.finish(now, context);
    }

    /// What somebody has to do until everything is as it lay before the run; `None`: it is.
    pub fn left_to_put_back(&self) -> Option<String> {
        let [height_m, mass_kg] = self.progress.prepared;
        let screen = (height_m > 0.0)
            .then(|| format!("put the screen back on the table (it stands {:.0} mm higher)", height_m * 1e3));
        let weight = (mass_kg > 0.0).then(|| format!("take the {:.0} g off the hand", mass_kg * 1e3));
        let left: Vec<String> = screen.into_iter().chain(weight).collect();
        (!left.is_empty()).then(|| left.join(" and "))
    }

    /// The block and the weight that a touch needs (`number`; `None`: all are done) are asked for once the arm is away.
    pub(super) fn prepare(
        &mut self,
        wanted: [f64; 2],
        number: Option<usize>,
        now: &Now<'_>,
        context: &mut Context<'_>,
    ) {
        let highest = now.screen.raised(wanted[0].max(self.progress.prepared[0]));
        if self.is_away || self.is_clear_of(&highest, now) {
            // The arm that touches is away; the other one is nobody's to move but the operator's.
            let other = arm_in(now.rig, &highest, now.robot).filter(|_| !self.is_away);
            self.phase = match other {
                Some(arm) => Phase::Paused(Some(Refusal::HandInScreen(arm.title.clone()).to_string())),
                None => Phase::Preparing(wanted),
            };
            return;
        }
        let Some(from) = now.robot.measured.clone() else {
            let why = "The joints have not been read yet. Wait a moment, then go on.";
            self.phase = Phase::Paused(Some(why.to_owned()));
            return;
        };
        self.go_away(number, from, now, context);
    }

    fn go_away(&mut self, number: Option<usize>, from: Posture, now: &Now<'_>, context: &mut Context<'_>) {
        let screen = now.screen.raised(self.progress.prepared[0]);
        let request = AwayRequest {
            rig: Arc::new(Rig { touchscreen: screen, ..(**now.rig).clone() }),
            place: now.place,
            finger: self.plan.options.finger,
            number,
            beside_m: self.beside_m,
            from,
            order: next_order(),
            speed_rad_s: TouchPace::default().at(speed(now.robot)).speed_rad_s,
        };
        self.task = Some((context.start(TouchWork::Away(request)), Task::Away));
    }

    /// The arm that touches.
    fn arm<'a>(&self, now: &Now<'a>) -> Option<&'a Arm> {
        let tip = self.plan.options.finger.tip();
        now.rig.arms.iter().find(|arm| arm.tips.iter().any(|known| known.link == tip))
    }

    /// Whether it is known where the arm that touches is.
    fn is_known(&self, now: &Now<'_>) -> bool {
        self.arm(now).is_none_or(|arm| now.robot.known(&arm.joints).is_some())
    }

    /// Whether the arm that touches has no tip on this screen or near it.
    fn is_clear_of(&self, screen: &Touchscreen, now: &Now<'_>) -> bool {
        let Some(arm) = self.arm(now) else { return true };
        now.robot.known(&arm.joints).is_some_and(|posture| is_away(now.rig, arm, screen, posture, TO_REACH))
    }

    /// The way from the screen was found, or why not.
    pub fn way_home(
        &mut self,
        order: Result<Box<WithdrawOrder>, NoWay>,
        now: &Now<'_>,
        context: &mut Context<'_>,
    ) {
        self.task = None;
        // Meanwhile it may have been paused, or something changed that has to be written.
        let wanted =
            self.phase == Phase::Working && !self.pause && now.trouble.is_none() && self.is_on_disk();
        match order {
            Ok(order) if wanted => {
                self.touch = Some(UnderWay {
                    order: order.order,
                    number: order.number,
                    stage: Some(TouchStage::Withdrawing),
                    at_end: AtEnd::Keep,
                });
                context.control(RobotControl::Withdraw(order));
            }
            Err(_) if wanted && self.only_leaves() => {
                self.stays_there(context);
                self.go_on(now, context);
            }
            Err(reason) if wanted => {
                let text = format!(
                    "The arm has to go away from the screen before the screen or the hand is reached for. {reason} Bring it home (Robot, in small steps where something is in the way), then go on."
                );
                self.phase = Phase::Paused(Some(text));
            }
            Ok(_) | Err(_) => self.go_on(now, context),
        }
    }

    /// Whether the screen can be taken to stand at a height now.
    ///
    /// # Errors
    /// A sentence, while a hand is over it: it cannot have been put there without meeting the hand.
    pub fn may_be_prepared(&self, [to_m, _]: [f64; 2], now: &Now<'_>) -> Result<(), Refusal> {
        if !to_m.is_finite() || to_m <= self.progress.prepared[0] && !self.is_hearsay {
            return Ok(());
        }
        if matches!(now.robot.motion, MotionState::Moving { .. }) {
            return Err(Refusal::ArmMoves);
        }
        match arm_in(now.rig, &now.screen.raised(to_m), now.robot) {
            _ if now.robot.connection.is_connected() && !self.is_known(now) => Err(Refusal::ArmUnknown),
            Some(arm) => Err(Refusal::HandInScreen(arm.title.clone())),
            None => Ok(()),
        }
    }

    /// The operator ends the run before all is done; asked once more, as it stands.
    pub(super) fn end_early(&mut self, now: &Now<'_>, context: &mut Context<'_>) {
        let is_put_back = self.progress.prepared == AS_IT_LIES;
        if is_put_back || self.next().is_none() || now.trouble.is_some() {
            return self.leave_it_so(now, context);
        }
        (self.ends, self.pause, self.is_away, self.phase) = (true, false, false, Phase::Working);
        self.go_on(now, context);
    }
}
