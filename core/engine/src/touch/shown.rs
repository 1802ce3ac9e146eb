//! What the window shows of the workflow.

use std::sync::Arc;
use std::time::Instant;

use plumbline_model::counted;
use plumbline_model::touch_plan::{Finger, Purpose};

use super::figures::{error_m, figures};
use super::over::arm_near;
use super::plan::Aim;
use super::record::Fate;
use super::run::{Phase, Run, Task, UnderWay};
use super::seen::Seen;
use super::view::{
    ContactSource, TouchCounts, TouchFigures, TouchOutcome, TouchPhase, TouchState, TouchView,
};
use super::workflow::{TouchAround, TouchWorkflow, source};
use crate::ground::step::StepState;
use crate::robot::TouchStage;
use crate::robot::view::MotionState;

fn touch_state(aim: &Aim, run: Option<&Run>) -> TouchState {
    let number = aim.touch.number;
    let record = run.and_then(|run| {
        let newest = run.progress.records.iter().rev().find(|record| record.number == number);
        run.progress.counted_of(number).or(newest)
    });
    TouchState {
        number,
        target: aim.touch.target,
        target_place: aim.place(),
        sent: aim.sent(),
        inside: aim.inside,
        set: aim.touch.set.clone(),
        group: aim.touch.group.clone(),
        side: aim.touch.side,
        outcome: outcome(aim, run),
        error_m: run.and_then(|run| Some(error_m(record?.touched, aim.touch.target, &run.screen))),
        touched: record.map(|record| record.touched),
    }
}

fn outcome(aim: &Aim, run: Option<&Run>) -> TouchOutcome {
    if let Some(reason) = &aim.refusal {
        return TouchOutcome::Unreachable(reason.clone());
    }
    let Some(run) = run else { return TouchOutcome::Waiting };
    let number = aim.touch.number;
    let moving = run.touch.as_ref().is_some_and(|touch| touch.number == Some(number));
    match run.fate(aim) {
        _ if moving => TouchOutcome::UnderWay,
        Fate::Waiting => TouchOutcome::Waiting,
        // Touched means on disk.
        Fate::Touched if run.unwritten == Some(number) => TouchOutcome::UnderWay,
        Fate::Touched => TouchOutcome::Touched,
        Fate::Missed(why) => TouchOutcome::Missed(why),
        Fate::Skipped => TouchOutcome::Skipped,
        Fate::Rejected => TouchOutcome::Rejected,
    }
}

fn counts(touches: &[TouchState]) -> TouchCounts {
    let mut counts = TouchCounts { planned: touches.len(), ..TouchCounts::default() };
    for touch in touches {
        match touch.outcome {
            TouchOutcome::Touched => counts.touched += 1,
            TouchOutcome::Missed(_) => counts.missed += 1,
            TouchOutcome::Skipped => counts.skipped += 1,
            TouchOutcome::Rejected => counts.rejected += 1,
            TouchOutcome::Unreachable(_) => counts.unreachable += 1,
            TouchOutcome::Waiting | TouchOutcome::UnderWay => {}
        }
    }
    counts
}

/// Figures of touches that were sent as the robot is described, or of the others.
fn figures_of(run: &Run, as_described: bool) -> Option<TouchFigures> {
    let is_one = |number: usize| run.plan.aim(number).is_some_and(|aim| aim.touch.as_described);
    figures(run.progress.counted().filter(|touch| is_one(touch.number) == as_described), &run.screen)
}

impl TouchWorkflow {
    /// Lists as they stand now; what has not changed is kept.
    pub(super) fn seen_now(&self) -> Seen {
        let run = self.run.as_ref();
        let planned = self.planned.as_ref().map(|(plan, _)| plan);
        let Some(plan) = run.map(|run| &run.plan).or(planned) else { return Seen::default() };
        let same = self.seen.of.as_ref().is_some_and(|of| Arc::ptr_eq(of, plan));
        let view = self.seen.plan.clone().filter(|_| same).unwrap_or_else(|| Arc::new(plan.view()));
        let touches: Arc<[TouchState]> = plan.touches.iter().map(|aim| touch_state(aim, run)).collect();
        Seen {
            plan: Some(view),
            counts: counts(&touches),
            figures: run.and_then(|run| figures_of(run, false)),
            figures_described: run.and_then(|run| figures_of(run, true)),
            touches,
            of: Some(plan.clone()),
        }
    }

    /// What the window shows.
    pub(super) fn shown(&self, around: &TouchAround, now: Instant) -> TouchView {
        let Seen { plan, touches, counts, figures, figures_described, .. } = self.seen.clone();
        TouchView {
            step: self.step_state(around),
            phase: self.phase(),
            next: self.next(around),
            plan,
            touches,
            counts,
            remaining: self.active_run().and_then(|run| run.remaining(now)),
            held: self.run.as_ref().map_or(0, |run| run.held),
            figures,
            figures_described,
            session: self.run.as_ref().map(|run| run.session.clone()),
            unfinished: self.runs.unfinished.as_slice().into(),
            screen: Some(self.screen().unwrap_or(&around.rig.touchscreen).clone()),
            reach: self.reach,
            placement: self.placement.clone(),
            placement_proposal: self.proposal.as_ref().map(|proposal| proposal.placement.clone()),
            proposal_is_older: self
                .proposal
                .as_ref()
                .is_some_and(|proposal| self.run.as_ref().is_none_or(|run| run.session != proposal.session)),
            correct_with: self.correct_with,
            source: source(&around.robot),
            window: self.window.clone(),
            last_contact: self.last_contact,
            near_screen: self.near_screen(around),
        }
    }

    /// Whose hand stays on the screen or near it while nothing moves it.
    fn near_screen(&self, around: &TouchAround) -> Option<String> {
        let robot = &around.robot;
        let moves = self.is_touching() || matches!(robot.motion, MotionState::Moving { .. });
        if moves || !robot.connection.is_connected() {
            return None;
        }
        arm_near(&around.rig, self.screen().unwrap_or(&around.rig.touchscreen), robot)
            .map(|arm| arm.title.clone())
    }

    fn phase(&self) -> TouchPhase {
        if self.planning.is_some() {
            return TouchPhase::Planning;
        }
        let Some(run) = &self.run else {
            return if self.planned.is_some() { TouchPhase::Planned } else { TouchPhase::Idle };
        };
        match &run.phase {
            Phase::Working => running(run),
            // The arm still moves.
            Phase::Paused(_) if run.touch.is_some() => running(run),
            Phase::Paused(why) => TouchPhase::Paused { why: why.clone() },
            Phase::Stuck(reason) => TouchPhase::Waiting { what: reason.clone(), prepare: None },
            Phase::Preparing(wanted) => {
                TouchPhase::Waiting { what: preparation(run, *wanted), prepare: Some((wanted[0], wanted[1])) }
            }
            // What comes next rests on what is on disk.
            Phase::Finished if !run.is_over() => running(run),
            Phase::Finished => TouchPhase::Finished,
        }
    }

    fn step_state(&self, around: &TouchAround) -> StepState {
        if self.planning.is_some() || self.starting.is_some() || self.active_run().is_some() {
            return StepState::Running;
        }
        let Some(trained) = &self.runs.trained else { return StepState::NotDone };
        let from_itself = self.placement.as_ref().is_some_and(|p| trained.gave_placement == Some(p.at));
        if from_itself || trained.screen == self.placed_screen(&around.rig) {
            StepState::Done
        } else {
            StepState::Stale {
                why: "The screen was placed anew since the touches were made. If it was moved, touch again."
                    .to_owned(),
            }
        }
    }

    /// What to do next, with a warning when the touch window does not fit.
    fn next(&self, around: &TouchAround) -> String {
        let next = self.next_step(around);
        match self.window_warning(around) {
            Some(warning) => format!("{warning} {next}"),
            None => next,
        }
    }

    fn window_warning(&self, around: &TouchAround) -> Option<String> {
        let window = self.window.as_ref()?;
        if source(&around.robot) == ContactSource::Twin {
            return None;
        }
        let screen = self.screen().unwrap_or(&around.rig.touchscreen);
        let (have, want) = ((window.width_px, window.height_px), (screen.width_px, screen.height_px));
        (have != want).then(|| {
            format!(
                "The touch window has {}×{} pixels, the touchscreen of the rig {}×{}: open it full screen on the touch monitor, or correct the rig file.",
                have.0, have.1, want.0, want.1
            )
        })
    }

    fn next_step(&self, around: &TouchAround) -> String {
        if self.planning.is_some() {
            return "The plan is being made. Nothing moves.".to_owned();
        }
        if self.starting.is_some() {
            return "The run is being opened.".to_owned();
        }
        if let Some(run) = &self.run {
            return self.next_of_run(run, around);
        }
        if let Some((plan, _)) = &self.planned {
            return match (plan.reachable(), self.trouble(around)) {
                (0, _) => "The arm reaches none of these targets. Choose another area.".to_owned(),
                (_, Some(trouble)) => trouble.to_string(),
                (count, None) => format!("Touch {}. The arm moves.", counted(count, "target")),
            };
        }
        if self.proposal.is_some() {
            return "Compare the measured place of the screen with the one in use, then accept or discard it."
                .to_owned();
        }
        if let Some(unfinished) = self.runs.unfinished.first() {
            let (touched, planned) = (unfinished.touched, unfinished.planned);
            return format!("Open the unfinished run ({touched} of {planned} touched), or plan a new one.");
        }
        if self.placement.is_none() {
            return "Measure where the screen lies first: plan to touch its corners.".to_owned();
        }
        "Choose area and pattern, then plan the touches.".to_owned()
    }

    fn next_of_run(&self, run: &Run, around: &TouchAround) -> String {
        match &run.phase {
            Phase::Working => match running(run) {
                TouchPhase::Running { doing, .. } => format!("The arm works: {doing}."),
                _ => "The arm works.".to_owned(),
            },
            Phase::Paused(Some(why)) => why.clone(),
            Phase::Paused(None) if run.screen != self.placed_screen(&around.rig) => format!(
                "Still to do: {}. The screen was placed anew since the run was begun: go on only if it was not moved, else finish this run and plan a new one.",
                run.left()
            ),
            Phase::Paused(None) => {
                format!("Still to do: {}. Go on; the arm moves.", counted(run.left(), "touch"))
            }
            Phase::Stuck(reason) => reason.clone(),
            Phase::Preparing(wanted) => preparation(run, *wanted),
            Phase::Finished if self.placing.is_some() => {
                "The place of the screen is being measured from the touches.".to_owned()
            }
            Phase::Finished if self.proposal.is_some() => {
                "Compare the measured place of the screen with the one in use, then accept or discard it."
                    .to_owned()
            }
            Phase::Finished => match run.plan.options.purpose {
                Purpose::Train if run.plan.options.finger == Finger::Left => {
                    "Look for what makes the left arm miss: step Gap.".to_owned()
                }
                Purpose::Train => "Train models from these touches: step Models.".to_owned(),
                Purpose::PlaceScreen => "Plan the touches that models are trained on.".to_owned(),
                Purpose::Check => "Read off how far touches land from their targets.".to_owned(),
            },
        }
    }
}

fn running(run: &Run) -> TouchPhase {
    let (number, doing) = match (&run.touch, run.task()) {
        (Some(touch), _) => (touch.number, stage(touch)),
        (None, Some(Task::Route(number))) => {
            (Some(number), format!("looking for the way to target {number}"))
        }
        (None, Some(Task::Away)) => {
            let number = run.next().map(|aim| aim.touch.number);
            (number, "looking for the way home, away from the screen".to_owned())
        }
        (None, _) => {
            let number = run.unwritten.or_else(|| run.next().map(|aim| aim.touch.number)).unwrap_or(1);
            (Some(number), format!("writing touch {number} to disk"))
        }
    };
    let holds = run.pause && !run.only_leaves() || !matches!(run.phase, Phase::Working | Phase::Finished);
    let doing = if holds { format!("{doing}, then it pauses") } else { doing };
    TouchPhase::Running { number, doing }
}

/// What the arm does, after "The arm is".
fn stage(touch: &UnderWay) -> String {
    let target = touch.number.map_or_else(|| "the screen".to_owned(), |number| format!("target {number}"));
    match touch.stage {
        None | Some(TouchStage::Approaching) => format!("moving above {target}"),
        Some(TouchStage::Settling) => format!("settling above {target}"),
        Some(TouchStage::Lowering) => format!("lowering to {target}"),
        Some(TouchStage::Dwelling) => format!("resting on {target}"),
        Some(TouchStage::Retreating) => format!("going up from {target}"),
        Some(TouchStage::Withdrawing) => "going home, away from the screen".to_owned(),
    }
}

/// What has to be done by hand, and what comes then; a sentence.
fn preparation(run: &Run, [to_m, to_kg]: [f64; 2]) -> String {
    let [height_m, mass_kg] = run.progress.prepared;
    let mut parts = vec![];
    if to_m != height_m {
        parts.push(match to_m {
            0.0 => "put the screen back on the table".to_owned(),
            _ => format!("put the screen on a block of {:.0} mm", to_m * 1e3),
        });
    }
    if to_kg != mass_kg {
        parts.push(match to_kg {
            0.0 => "take the weight off the hand".to_owned(),
            _ => format!("fix a weight of {:.0} g at the palm", to_kg * 1e3),
        });
    }
    if parts.is_empty() {
        parts.push(still(to_m, to_kg));
    }
    let then = if run.next().is_some() { "the arm goes on" } else { "nothing moves any more" };
    crate::ground::text::sentence(&format!("{}, then say that it is done; {then}", parts.join(" and ")))
}

/// What has to be looked at by hand after a while in which nobody was asked.
fn still(height_m: f64, mass_kg: f64) -> String {
    let screen = format!("the screen stands on its block of {:.0} mm", height_m * 1e3);
    let weight = format!("the weight of {:.0} g is at the palm", mass_kg * 1e3);
    let all = match (height_m > 0.0, mass_kg > 0.0) {
        (true, true) => format!("{screen} and {weight}"),
        (false, true) => weight,
        (_, false) => screen,
    };
    format!("see that {all}")
}
