//! A run goes on: it writes, looks for the way to the next target, and ends.

use std::sync::Arc;

use plumbline_model::robot::Rig;

use super::{AtEnd, Now, Phase, Run, Task, UnderWay};
use crate::motion::{NoWay, Planner, TouchPace};
use crate::robot::view::RobotView;
use crate::robot::{RobotControl, TouchOrder};
use crate::touch::depth::Depth;
use crate::touch::plan::Aim;
use crate::touch::work::{Context, RouteRequest, TouchWork};

impl Run {
    /// Does what can be done now: writes, looks for the way to the next target, or ends.
    pub fn go_on(&mut self, now: &Now<'_>, context: &mut Context<'_>) {
        if self.task.is_some() || self.touch.is_some() {
            return;
        }
        if !self.is_on_disk() {
            if !matches!(self.phase, Phase::Stuck(_)) {
                self.write(context);
            }
            return;
        }
        if self.phase != Phase::Working {
            return;
        }
        let is_home = self.only_leaves() && (self.is_away || self.stays);
        if std::mem::take(&mut self.pause) && !is_home {
            self.phase = Phase::Paused(None);
            return;
        }
        let Some(aim) = self.next().cloned() else { return self.put_back(now, context) };
        if let Some(trouble) = &now.trouble {
            self.phase = Phase::Paused(Some(trouble.to_string()));
            return;
        }
        if aim.preparation() != self.progress.prepared || self.is_hearsay {
            return self.prepare(aim.preparation(), Some(aim.touch.number), now, context);
        }
        self.route(aim, now, context);
    }

    fn write(&mut self, context: &mut Context<'_>) {
        let work = TouchWork::Write {
            session: self.session.clone(),
            joints: self.joints.clone(),
            progress: Arc::new(self.progress.clone()),
            revision: self.revision,
        };
        self.task = Some((context.start(work), Task::Write));
    }

    fn route(&mut self, aim: Aim, now: &Now<'_>, context: &mut Context<'_>) {
        let Some(from) = now.robot.measured.clone() else {
            let why = "The joints have not been read yet. Wait a moment, then go on.";
            self.phase = Phase::Paused(Some(why.to_owned()));
            return;
        };
        let screen = now.screen.raised(aim.touch.screen_height_m);
        if self.planner.as_ref().is_some_and(|(of, _)| *of != screen) {
            // What was found of how low it lies is of its place before.
            (self.planner, self.depth) = (None, Depth::default());
        }
        let planner = self.planner.as_ref();
        let rig = match planner {
            Some((_, planner)) => planner.rig().clone(),
            None => Arc::new(Rig { touchscreen: screen, ..(**now.rig).clone() }),
        };
        let request = RouteRequest {
            rig,
            place: now.place,
            planner: planner.map(|(_, planner)| planner.clone()),
            order: next_order(),
            pace: TouchPace::default().at(speed(now.robot)),
            finger: self.plan.options.finger,
            deeper_m: self.depth.deeper_m(aim.touch.number),
            from,
            aim: Box::new(aim),
        };
        let number = request.aim.touch.number;
        self.task = Some((context.start(TouchWork::Route(request)), Task::Route(number)));
    }

    /// What happened is on disk, or why it is not.
    pub fn written(
        &mut self,
        revision: u64,
        problem: Option<String>,
        now: &Now<'_>,
        context: &mut Context<'_>,
    ) {
        self.task = None;
        match problem {
            Some(reason) => {
                let text = format!("{reason} The touches are kept in memory; go on to write them again.");
                self.phase = Phase::Stuck(text);
            }
            None => {
                self.written = revision;
                self.end_on_disk = self.progress.finished && (self.end_on_disk || self.is_on_disk());
                if self.written == self.revision {
                    self.unwritten = None;
                }
            }
        }
        self.go_on(now, context);
    }

    /// The way to a target was found, or why not.
    pub fn routed(
        &mut self,
        number: usize,
        planner: Option<Arc<Planner>>,
        order: Result<Box<TouchOrder>, NoWay>,
        now: &Now<'_>,
        context: &mut Context<'_>,
    ) {
        self.task = None;
        if let Some(planner) = planner {
            self.planner = Some((planner.rig().touchscreen.clone(), planner));
        }
        // Meanwhile it may have been paused, skipped, or something changed that has to be written.
        let wanted = self.phase == Phase::Working
            && !self.pause
            && now.trouble.is_none()
            && self.is_on_disk()
            && self.next().is_some_and(|aim| aim.touch.number == number);
        match order {
            Ok(order) if wanted => {
                let number = Some(number);
                self.touch = Some(UnderWay { order: order.order, number, stage: None, at_end: AtEnd::Keep });
                (self.is_away, self.was_sent, self.beside_m) = (false, true, order.beside_m);
                context.control(RobotControl::Touch(order));
            }
            Err(reason) if wanted => {
                let text = format!("Touch {number} was not begun: {reason} Go on to try again, or skip it.");
                self.phase = Phase::Paused(Some(text));
            }
            Ok(_) | Err(_) => self.go_on(now, context),
        }
    }

    /// Work has ended without a result.
    pub fn task_ended(&mut self) {
        self.phase = match self.task.take() {
            Some((_, Task::Write)) => Phase::Stuck(
                "The touches could not be written. They are kept in memory; go on to write them again."
                    .to_owned(),
            ),
            _ => Phase::Paused(Some("The way of the arm was not looked for to the end.".to_owned())),
        };
    }

    pub(super) fn finish(&mut self, now: &Now<'_>, context: &mut Context<'_>) {
        self.phase = Phase::Finished;
        self.ends = false;
        self.progress.finished = true;
        self.ended = true;
        self.changed();
        self.go_on(now, context);
    }
}

/// Orders count through the program, so that what is said of one is never taken for another's, be it
/// of the robot or of the twin.
pub(super) fn next_order() -> u64 {
    use std::sync::atomic::{AtomicU64, Ordering};
    static ORDERS: AtomicU64 = AtomicU64::new(1);
    ORDERS.fetch_add(1, Ordering::Relaxed)
}

/// Share of the usual speed; a view that says nothing says the usual one.
pub(super) fn speed(robot: &RobotView) -> f64 {
    if robot.speed > 0.0 { robot.speed } else { 1.0 }
}
