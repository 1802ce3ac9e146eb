//! What the operator asks of a run.

use super::{AtEnd, Now, Phase, Run};
use crate::robot::RobotControl;
use crate::robot::view::{Connection, RobotView};
use crate::touch::record::Ended;
use crate::touch::refusal::Refusal;
use crate::touch::work::Context;
use crate::twin::command::TwinCommand;

impl Run {
    /// A run that would go on by itself waits for the operator.
    pub fn hold_on(&mut self) {
        if self.patience.end() {
            self.phase = Phase::Paused(None);
        }
    }

    /// The operator decides what becomes of a run that waits for its joints.
    pub fn waits_no_more(&mut self) {
        self.patience.end();
    }

    /// Breaks the touch under way off, which is made again later.
    pub fn break_off(&mut self, why: String, context: &mut Context<'_>) {
        // The way home needs nothing that feels contacts.
        if self.only_leaves() {
            return;
        }
        if let Some(touch) = &mut self.touch {
            touch.at_end = AtEnd::Retry;
            context.control(RobotControl::AbandonTouch);
        }
        if self.phase == Phase::Working {
            self.phase = Phase::Paused(Some(why));
        }
    }

    /// Leaves the touch out that is under way or next.
    ///
    /// # Errors
    /// A sentence, when there is none.
    pub fn skip(&mut self, context: &mut Context<'_>) -> Result<(), Refusal> {
        if let Some(touch) = &mut self.touch {
            if touch.number.is_none() {
                return Err(Refusal::NothingToSkip);
            }
            touch.at_end = AtEnd::Skip;
            context.control(RobotControl::AbandonTouch);
            return Ok(());
        }
        let next = self.next().filter(|_| self.phase != Phase::Finished);
        let number = next.map(|aim| aim.touch.number).ok_or(Refusal::NothingToSkip)?;
        self.end(number, Ended::Skipped);
        // The arm may have been moved while it waited.
        self.is_away = false;
        if let Phase::Preparing(_) = self.phase {
            self.phase = Phase::Working;
        }
        Ok(())
    }

    /// The run goes on to its plan's end, although it was to end early.
    pub fn ends_no_more(&mut self) {
        self.ends = false;
    }

    /// Goes on by itself from now on.
    pub fn resume(&mut self) {
        (self.misses, self.pause, self.is_away, self.stays) = (0, false, false, false);
        self.phase = if self.progress.finished { Phase::Finished } else { Phase::Working };
    }

    /// Ends the run with what there is.
    pub fn finish_now(&mut self, now: &Now<'_>, context: &mut Context<'_>) {
        match &mut self.touch {
            _ if self.progress.finished => {}
            Some(touch) => {
                touch.at_end = AtEnd::Finish;
                context.control(RobotControl::AbandonTouch);
            }
            None => self.end_early(now, context),
        }
    }

    /// The twin has no operator who puts a block under its screen: it does so by itself.
    pub fn tell_twin(&self, robot: &RobotView, context: &mut Context<'_>) {
        if matches!(robot.connection, Connection::Connected { twin: true, .. }) {
            let [screen_height_m, payload_kg] = self.progress.prepared;
            let command = TwinCommand::PrepareTouch { screen_height_m, payload_kg };
            context.control(RobotControl::Twin(command));
        }
    }

    /// The screen stands on a block, the hand carries a weight, as they should or not.
    ///
    /// # Errors
    /// A sentence, when these are no numbers, or a hand is where the screen would be.
    pub fn prepared(&mut self, preparation: [f64; 2], now: &Now<'_>) -> Result<(), Refusal> {
        if preparation.iter().any(|value| !(value.is_finite() && *value >= 0.0)) {
            return Err(Refusal::NotNumbers);
        }
        self.may_be_prepared(preparation, now)?;
        (self.progress.prepared, self.is_hearsay) = (preparation, false);
        // It was said that nothing moves any more, and hands are at the screen.
        self.stays |= self.next().is_none();
        self.changed();
        if let Phase::Preparing(_) = self.phase {
            self.phase = Phase::Working;
        }
        Ok(())
    }
}
