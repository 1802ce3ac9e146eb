//! What the robot tells of the touch that is under way, and what becomes of it.

use plumbline_model::Pixel;
use plumbline_model::session::Screen;

use super::{AtEnd, MISSES, Now, Phase, Run, UnderWay};
use crate::ground::notice::NoticeLevel;
use crate::robot::patience::Look;
use crate::robot::{TouchNews, TouchRun};
use crate::touch::record::{Ended, TouchRecord};
use crate::touch::work::Context;

/// What is said of a finger that ended in the air.
const MET_NOTHING: &str = "The lowest place was reached and the screen felt nothing.";

impl Run {
    /// The robot's thread tells how a touch is doing; gives the contact, if there was one.
    pub fn news(
        &mut self,
        news: TouchNews,
        now: &Now<'_>,
        context: &mut Context<'_>,
    ) -> Option<Pixel<Screen>> {
        let under_way = self.touch.as_mut().filter(|touch| touch.order == news.order)?;
        if let TouchRun::Doing(stage) = news.state {
            under_way.stage = Some(stage);
            return None;
        }
        let UnderWay { number, at_end, .. } = self.touch.take()?;
        let contact = match news.state {
            TouchRun::Away => {
                self.is_away = true;
                if let (AtEnd::Skip, Some(number)) = (at_end, number) {
                    self.end(number, Ended::Skipped);
                }
                None
            }
            state => self.touch_ended(state, number, at_end, context),
        };
        if at_end == AtEnd::Finish {
            self.end_early(now, context);
        }
        self.go_on(now, context);
        contact
    }

    /// A touch, or the way from the screen that a touch waits for, has come to an end.
    fn touch_ended(
        &mut self,
        state: TouchRun,
        number: Option<usize>,
        at_end: AtEnd,
        context: &mut Context<'_>,
    ) -> Option<Pixel<Screen>> {
        if at_end == AtEnd::Skip
            && let Some(number) = number
        {
            self.end(number, Ended::Skipped);
        }
        match (state, number) {
            (TouchRun::Touched(measured), Some(number)) => {
                self.contacts.push(measured.at);
                if at_end != AtEnd::Skip {
                    self.touched(number, &measured);
                }
                return Some(measured.pixel);
            }
            (TouchRun::MetNothing, Some(number)) if at_end == AtEnd::Keep => {
                self.met_nothing(number, context)
            }
            (TouchRun::Missed(why), Some(number)) if at_end == AtEnd::Keep => self.missed(number, why),
            (TouchRun::Unheard(why), _) if at_end == AtEnd::Keep && self.waits_to_be_heard(context) => {
                let with = number.map_or_else(String::new, |number| format!(" with touch {number}"));
                let text =
                    format!("{why} The run goes on by itself{with} as soon as the joints are heard again.");
                self.phase = Phase::Paused(Some(text));
                self.held += 1;
            }
            (TouchRun::Interrupted(_) | TouchRun::Unheard(_), None) if self.only_leaves() => {
                self.stays_there(context);
            }
            (TouchRun::Interrupted(why) | TouchRun::Unheard(why), _) if at_end != AtEnd::Finish => {
                self.interrupted(number, &why);
            }
            _ => {}
        }
        None
    }

    fn touched(&mut self, number: usize, measured: &crate::robot::TouchMeasurement) {
        let record = self.plan.aim(number).and_then(|aim| TouchRecord::new(aim, measured));
        match record {
            Some(record) => {
                self.progress.touched(record);
                self.unwritten = Some(number);
                self.misses = 0;
                self.depth.met(number);
                self.patience.done();
                self.changed();
            }
            None => self.missed(number, "The contact had no place.".to_owned()),
        }
    }

    /// The finger ended above the glass: it is looked for a little lower, or missed.
    fn met_nothing(&mut self, number: usize, context: &mut Context<'_>) {
        match self.depth.met_nothing(number) {
            Some(deeper_m) => {
                let text = format!(
                    "Touch {number} met nothing: the arm may stand higher than its encoders say. The same place is touched again, as much as {:.0} mm deeper; the finger stops at what it meets.",
                    deeper_m * 1e3
                );
                context.notices.add(NoticeLevel::Info, text);
            }
            None => self.missed(
                number,
                format!("{MET_NOTHING} Measure where the screen lies, or look whether it works."),
            ),
        }
    }

    fn missed(&mut self, number: usize, why: String) {
        self.depth.forget();
        self.end(number, Ended::Missed(why));
        self.misses += 1;
        if self.misses >= MISSES && self.phase == Phase::Working {
            self.misses = 0;
            self.phase = Phase::Paused(Some(format!(
                "{MISSES} touches in a row felt nothing. Look whether the finger points down and the touch window answers to a hand; if the finger ends above the glass, measure the place of the screen anew. Then go on, and touch the missed ones again."
            )));
        }
    }

    pub(super) fn end(&mut self, number: usize, how: Ended) {
        self.progress.end(number, how);
        self.changed();
    }

    /// The touch under way cannot go on without the operator.
    fn interrupted(&mut self, number: Option<usize>, why: &str) {
        self.pause = false;
        if self.phase == Phase::Working {
            let again = number
                .map_or_else(String::new, |number| format!(" Touch {number} is made again when you go on."));
            self.phase = Phase::Paused(Some(format!("{why}{again}")));
        }
    }

    fn waits_to_be_heard(&mut self, context: &Context<'_>) -> bool {
        self.phase == Phase::Working && !self.pause && self.patience.begin(context.time.instant)
    }

    /// Looks whether a run that holds because joints were not heard goes on by itself.
    pub fn look_again(&mut self, now: &Now<'_>, context: &mut Context<'_>) {
        let only_leaves = self.only_leaves();
        let Phase::Paused(why) = &mut self.phase else {
            self.patience.end();
            return;
        };
        let trouble = now.trouble.as_ref().map(ToString::to_string);
        match self.patience.look(now.robot, trouble, &self.joints, context.time.instant) {
            Look::Same => {}
            Look::GoesOn => {
                self.phase = Phase::Working;
                let text = "The joints are heard again: the run goes on by itself.";
                context.notices.add(NoticeLevel::Info, text.to_owned());
            }
            Look::GivesUp(_) if only_leaves => {
                self.phase = Phase::Working;
                self.stays_there(context);
            }
            Look::GivesUp(reason) => {
                let before = why.take().unwrap_or_default();
                *why = Some(format!("{before} It did not: {reason} Go on when the way is free."));
            }
        }
    }

    /// The robot is gone: no more is heard of the touch under way.
    pub fn lost(&mut self, why: &str, context: &mut Context<'_>) {
        let Some(touch) = self.touch.take() else { return };
        if touch.number.is_none() && self.only_leaves() && self.phase == Phase::Working {
            return self.stays_there(context);
        }
        if let (AtEnd::Skip, Some(number)) = (touch.at_end, touch.number) {
            self.end(number, Ended::Skipped);
        }
        self.interrupted(touch.number, why);
    }
}
