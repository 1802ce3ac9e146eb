//! A run under way: what is asked of it, what the robot says, its end.

use plumbline_model::session::Touchscreen;
use plumbline_model::touch_plan::{Finger, Purpose};

use super::super::command::TouchCommand;
use super::super::refusal::Refusal;
use super::super::run::{Now, Phase, Run};
use super::super::store::TrainedRun;
use super::super::view::ContactSource;
use super::super::work::{Context, TouchResult, TouchWork};
use super::{TouchAround, TouchWorkflow, source};
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::robot::TouchNews;

impl TouchWorkflow {
    pub(super) fn apply_to_run(
        &mut self,
        command: TouchCommand,
        around: &TouchAround,
        context: &mut Context<'_>,
    ) -> Result<(), Refusal> {
        let screen = self.placed_screen(&around.rig);
        let now = self.now(around, &screen);
        let prepares = matches!(command, TouchCommand::Resume | TouchCommand::Prepared { .. });
        let run = self.run.as_mut().ok_or(Refusal::NoRun)?;
        if matches!(command, TouchCommand::Resume | TouchCommand::Skip | TouchCommand::Finish) {
            run.waits_no_more();
        }
        match command {
            TouchCommand::Pause if run.phase == Phase::Working => run.pause = true,
            TouchCommand::Pause => run.hold_on(),
            TouchCommand::Resume => {
                // Writing to disk needs no arm.
                let needs_arm = !run.progress.finished && !matches!(run.phase, Phase::Stuck(_));
                if let (Some(trouble), true) = (&now.trouble, needs_arm) {
                    return Err(trouble.clone().into());
                }
                if run.phase != Phase::Working || run.pause {
                    run.resume();
                }
            }
            TouchCommand::Skip => run.skip(context)?,
            TouchCommand::Finish => run.finish_now(&now, context),
            TouchCommand::Prepared { screen_height_m, payload_kg } => {
                run.prepared([screen_height_m, payload_kg], &now)?;
            }
            TouchCommand::Redo { number } => redo(run, number)?,
            TouchCommand::Reject { number } if run.progress.reject(number) => run.changed(),
            TouchCommand::Reject { number } => {
                return Err(Refusal::NothingToReject(number));
            }
            TouchCommand::Restore { number } if run.progress.restore(number) => run.changed(),
            TouchCommand::Restore { number } => {
                return Err(Refusal::NothingToRestore(number));
            }
            _ => {}
        }
        if prepares {
            run.tell_twin(&around.robot, context);
            self.owes_room |= source(&around.robot) == ContactSource::Twin;
        }
        run.go_on(&now, context);
        Ok(())
    }

    /// The robot's thread tells how a touch is doing.
    pub fn news(&mut self, news: TouchNews, around: &TouchAround, context: &mut Context<'_>) {
        let screen = self.placed_screen(&around.rig);
        let now = self.now(around, &screen);
        let Some(run) = &mut self.run else { return };
        if let Some(pixel) = run.news(news, &now, context)
            && source(&around.robot) == ContactSource::Twin
        {
            self.show_contact(pixel, true);
            self.show_contact(pixel, false);
        }
        self.refresh(around, context);
    }

    /// The robot has something new, or time has passed.
    pub fn step(&mut self, around: &TouchAround, context: &mut Context<'_>) {
        self.give_room_back(around, context);
        let screen = self.placed_screen(&around.rig);
        let now = self.now(around, &screen);
        let Some(run) = &mut self.run else { return };
        if run.touch.is_some() && !around.robot.connection.is_connected() {
            run.lost(
                "The connection to the robot is gone. Connect again, look that the arm is free, then go on.",
                context,
            );
        }
        let before = (run.phase.clone(), run.task());
        run.look_again(&now, context);
        run.go_on(&now, context);
        if before != (run.phase.clone(), run.task()) {
            self.refresh(around, context);
        }
    }

    pub(super) fn run_work_done(
        &mut self,
        id: JobId,
        result: TouchResult,
        around: &TouchAround,
        context: &mut Context<'_>,
    ) {
        let screen = self.placed_screen(&around.rig);
        let now = self.now(around, &screen);
        let Some(run) = self.run.as_mut().filter(|run| run.waits_for(id)) else { return };
        match result {
            TouchResult::Written { revision, problem } => run.written(revision, problem, &now, context),
            TouchResult::Routed { number, planner, order } => {
                run.routed(number, planner, order, &now, context);
            }
            TouchResult::WayHome(order) => run.way_home(order, &now, context),
            _ => {}
        }
    }

    pub(super) fn go_on(&mut self, around: &TouchAround, context: &mut Context<'_>) {
        let screen = self.placed_screen(&around.rig);
        let now = self.now(around, &screen);
        if let Some(run) = &mut self.run {
            run.go_on(&now, context);
        }
    }

    /// A run has come to its end: its touches tell where the screen lies.
    pub(super) fn ended(&mut self, around: &TouchAround, context: &mut Context<'_>) {
        let Some(run) = &self.run else { return };
        let touches: Vec<_> = run.progress.counted().cloned().collect();
        let text =
            format!("The run is finished: {} of {} targets touched.", touches.len(), run.plan.reachable());
        context.notices.add(NoticeLevel::Success, text);
        let purpose = run.plan.options.purpose;
        let finger = run.plan.options.finger;
        // M1 to M3 are learned with the right finger, and its touches place the screen.
        if purpose == Purpose::Train && finger == Finger::Right && !touches.is_empty() {
            self.runs.trained = Some(TrainedRun {
                session: run.session.clone(),
                screen: run.screen.clone(),
                gave_placement: run.progress.gave_placement,
            });
        }
        // A check is made with a model: what it touches was sent elsewhere on purpose, and says
        // nothing new of the screen.
        let places =
            purpose == Purpose::PlaceScreen || (purpose == Purpose::Train && finger == Finger::Right);
        if places {
            let work = TouchWork::Place {
                session: run.session.clone(),
                rig: around.rig.clone(),
                finger,
                joints: run.joints.clone(),
                touches,
            };
            self.placing = Some(context.start(work));
        }
    }

    pub(super) fn now<'a>(&self, around: &'a TouchAround, screen: &'a Touchscreen) -> Now<'a> {
        Now {
            rig: &around.rig,
            screen,
            place: self.screen_place(),
            robot: &around.robot,
            trouble: self.trouble(around),
        }
    }
}

fn redo(run: &mut Run, number: usize) -> Result<(), Refusal> {
    let aim = run.plan.aim(number).ok_or(Refusal::NoTarget(number))?;
    if let Some(reason) = &aim.refusal {
        return Err(Refusal::CannotBeTouched { number, reason: reason.clone() });
    }
    if run.touch.as_ref().is_some_and(|touch| touch.number == Some(number)) {
        return Err(Refusal::BeingTouched(number));
    }
    run.progress.redo(number);
    run.ends_no_more();
    run.changed();
    if run.phase == Phase::Finished {
        run.phase = Phase::Paused(Some(format!("Target {number} waits to be touched once more.")));
    }
    Ok(())
}
