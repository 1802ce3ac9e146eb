//! An attempt, or only its plan, carried out on the thread of a job.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use jiff::Timestamp;
use plumbline_grasp::attempt::{AIR_RAD_S, DOWN_RAD_S, LIFT_RAD_S};
use plumbline_grasp::plan::GraspPlan;
use plumbline_grasp::see::Seen;
use plumbline_grasp::things::Thing;
use plumbline_grasp::{Body, Failure, Grasper, Halt, HandChoice, Method, Order, Outcome, Record};
use plumbline_model::JobContext;
use plumbline_model::files::FileError;
use plumbline_model::robot::{Posture, Rig};
use plumbline_vision::detect::DetectError;

use super::body::{LedBody, Ropes};
use super::command::GraspTarget;
use super::keeping::{Keeping, KeepingError};
use super::progress::{Progress, Watcher};
use super::rests_on::RestsOn;
use super::stepwise::StopAfterEach;
use super::view::{AttemptView, PlannedGrasp};
use crate::ground::jobs::JobError;
use crate::robot::duration;

/// Thumb and fingers close one after the other, each in about this time, s.
const CLOSING_S: f64 = 2.6;
/// Joints that turn by less are not named, rad.
const NAMED_RAD: f64 = 0.02;

/// What an attempt is made of.
#[derive(Clone, Debug)]
pub struct Attempt {
    /// What it rests on.
    pub rests_on: RestsOn,
    /// With which hand.
    pub hand: HandChoice,
    /// How.
    pub method: Method,
    /// What.
    pub target: GraspTarget,
    /// Orders to the arm, pairs of the eyes, pause and end.
    pub ropes: Ropes,
    /// Where attempts are kept.
    pub grasps: PathBuf,
    /// When it was asked for.
    pub at: Timestamp,
    /// For the window.
    pub progress: Progress,
    /// Whether it holds after each step.
    pub stops: StopAfterEach,
}

/// What came of looking and planning.
#[derive(Clone, Debug)]
pub struct Proposed {
    /// The plan, or why there is none.
    pub plan: Result<Arc<PlannedGrasp>, NoPlan>,
    /// What was seen.
    pub seen: Vec<Seen>,
    /// What was chosen of it.
    pub chosen: Option<usize>,
}

/// What came of an attempt.
#[derive(Clone, Debug)]
pub struct CarriedOut {
    /// As it is kept.
    pub attempt: AttemptView,
    /// Why the end of the joint tracks of one that held is not kept.
    pub not_kept: Option<String>,
}

/// Why nothing is ordered. Reads as a sentence.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoOrder {
    /// The eyes give no pair.
    #[error(transparent)]
    Halted(#[from] Halt),
    /// Nobody can say what is there.
    #[error(transparent)]
    Detector(#[from] DetectError),
    /// Nothing that fits into the hand.
    #[error("nothing is seen that can be held ({}): put it where both eyes see it", .can_be_held.join(", "))]
    NothingToHold {
        /// What could be.
        can_be_held: Vec<String>,
    },
}

/// Why there is no plan. Reads as a sentence.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoPlan {
    /// Nothing to grasp.
    #[error(transparent)]
    Order(#[from] NoOrder),
    /// Nobody knows where the arm is.
    #[error(transparent)]
    Halted(#[from] Halt),
    /// What the record of looking and planning says.
    #[error("{0}")]
    Told(String),
    /// The record says nothing.
    #[error("there is no plan")]
    Nothing,
}

impl Attempt {
    /// Looks and plans. Nothing moves.
    pub fn propose(&self, context: &dyn JobContext) -> Result<Proposed, JobError> {
        context.report(0.0, "getting ready");
        let mut grasper = self.rests_on.grasper(self.method)?;
        let mut body = self.body(context);
        context.report(0.3, "looking");
        let order = match self.order(&mut grasper, &mut body) {
            Ok(order) => order,
            Err(why) => return Ok(Proposed { plan: Err(why.into()), seen: vec![], chosen: None }),
        };
        let mut watcher = Watcher::new(
            self.progress.clone(),
            None,
            context,
            self.ropes.reins.clone(),
            grasper.knowledge().clone(),
        );
        let (plan, record) = grasper.propose(&mut body, &order, self.at, &mut watcher);
        let plan = match (plan, body.commanded()) {
            (Some(plan), Ok(from)) => Ok(Arc::new(self.shown(&grasper, &from, &plan, &record))),
            (Some(_), Err(halt)) => Err(halt.into()),
            (None, _) => Err(why_of(&record)),
        };
        self.progress.ended(&record);
        Ok(Proposed { plan, seen: record.seen, chosen: record.chosen })
    }

    /// Grasps once. Whatever happens, the record says it.
    pub fn carry_out(&self, context: &dyn JobContext) -> Result<CarriedOut, JobError> {
        let keeping = Keeping::begin(&self.grasps, self.method, self.at).map_err(JobError::told)?;
        self.progress.change(|run| run.name = keeping.name());
        context.report(0.0, "getting ready");
        let mut grasper = self.rests_on.grasper(self.method)?;
        let mut body = self.body(context);
        let tracks = body.keep_tracks(keeping.tracks(body.rig()).map_err(JobError::told)?);
        let ropes = &self.ropes;
        let kept = Some(keeping.clone());
        let mut watcher = Watcher::new(
            self.progress.clone(),
            kept,
            context,
            ropes.reins.clone(),
            grasper.knowledge().clone(),
        );
        watcher.stops = self.stops.clone();
        watcher.tracks = Some(tracks.clone());
        let mut record = match self.order(&mut grasper, &mut body) {
            Ok(order) => {
                self.progress.change(|run| run.object.clone_from(&order.object));
                grasper.attempt(&mut body, &order, self.at, &mut watcher)
            }
            Err(why) => {
                let object = self.target.class.as_deref().unwrap_or("thing");
                let mut record = Record::new(self.method, object, self.at, String::new());
                record.outcome = Some(Outcome::Refused { why: why.to_string() });
                record
            }
        };
        let not_kept = conclude(&mut record, watcher.problem, tracks.end());
        self.progress.ended(&record);
        keeping.record(&record).map_err(JobError::told)?;
        Ok(CarriedOut { attempt: keeping.view(&record), not_kept })
    }

    fn body<'a>(&self, context: &'a dyn JobContext) -> LedBody<'a> {
        LedBody::new(self.rests_on.model.rig().clone(), self.ropes.clone(), context)
    }

    /// What is grasped: as the operator chose, else what can be held and is seen best.
    fn order(&self, grasper: &mut Grasper, body: &mut LedBody<'_>) -> Result<Order, NoOrder> {
        let (method, hand) = (self.method, self.hand);
        let order = |object: String| Order { method, hand, object, near_m: self.target.near_m };
        if let Some(class) = &self.target.class {
            return Ok(order(class.clone()));
        }
        let sight = body.look()?;
        let seen = grasper.see(&sight)?;
        let can_be_held =
            |thing: &&Seen| Thing::of_class(&thing.class).is_some_and(|known| known.can_be_held);
        let best = seen.iter().filter(can_be_held).find(|thing| thing.place.is_ok());
        best.map(|thing| order(thing.class.clone())).ok_or_else(|| {
            let can_be_held = Thing::held().map(|thing| thing.class.to_lowercase()).collect();
            NoOrder::NothingToHold { can_be_held }
        })
    }

    fn shown(&self, grasper: &Grasper, from: &Posture, plan: &GraspPlan, record: &Record) -> PlannedGrasp {
        let planner = grasper.planner(self.method);
        let closed = plan.closing().map(|open| planner.closed(open)).unwrap_or_else(|| from.clone());
        let lift = grasper.lift(self.method, &closed, plan.heading_rad);
        let mut postures = vec![from.clone()];
        postures.extend(plan.approach.iter().chain(&plan.down).cloned());
        postures.push(closed);
        postures.extend(lift.iter().cloned());
        let palm = |posture: &Posture| planner.arm().palm(posture).coords.coords.into();
        let place = record.chosen.and_then(|index| record.seen.get(index)?.place.as_ref().ok());
        PlannedGrasp {
            method: self.method,
            hand: plan.hand,
            model: record.model.clone(),
            object: record.object.clone(),
            at_m: plan.standing.xy_m,
            sigma_m: place.map(plumbline_grasp::see::SeenPlace::sigma_on_table_m),
            heading_rad: plan.heading_rad,
            level: plan.level,
            palm_way_m: postures.iter().map(palm).collect(),
            turns: turns(self.rests_on.model.rig(), &postures).into(),
            duration: whole(from, plan, &lift),
            postures: postures.into(),
        }
    }
}

/// What could not be kept ended the attempt; of one that holds all the same the rest of its tracks alone is missing,
/// and why is returned.
fn conclude(
    record: &mut Record,
    problem: Option<KeepingError>,
    of_tracks: Option<FileError>,
) -> Option<String> {
    if problem.is_none() && record.is_success() {
        return of_tracks.map(|problem| problem.to_string());
    }
    let problem = problem.or(of_tracks.map(KeepingError::from))?;
    let why = format!("it could not be kept: {problem}");
    record.outcome = Some(Outcome::Failed { failure: Failure::Halted, why });
    None
}

/// Why there is no plan.
fn why_of(record: &Record) -> NoPlan {
    match &record.outcome {
        Some(Outcome::Failed { why, .. } | Outcome::Refused { why }) => NoPlan::Told(why.clone()),
        Some(Outcome::Success) | None => NoPlan::Nothing,
    }
}

/// How far joints turn in all, most first.
fn turns(rig: &Rig, postures: &[Posture]) -> Vec<(String, f64)> {
    let turn = |joint| postures.windows(2).map(|pair| (pair[1][joint] - pair[0][joint]).abs()).sum::<f64>();
    let mut turns: Vec<(String, f64)> =
        rig.servos.iter().map(|servo| (servo.title.clone(), turn(servo.joint))).collect();
    turns.retain(|(_, turn_rad)| *turn_rad > NAMED_RAD);
    turns.sort_by(|a, b| b.1.total_cmp(&a.1));
    turns
}

/// How long all of it takes, without looking.
fn whole(from: &Posture, plan: &GraspPlan, lift: &[Posture]) -> Duration {
    let along = |start: &Posture, way: &[Posture], speed_rad_s: f64| -> Duration {
        let starts = std::iter::once(start).chain(way);
        starts.zip(way).map(|(from, to)| duration(from.distance_rad(to), speed_rad_s)).sum()
    };
    let above = plan.above().unwrap_or(from);
    let closing = plan.closing().unwrap_or(above);
    along(from, &plan.approach, AIR_RAD_S)
        + along(above, &plan.down, DOWN_RAD_S)
        + Duration::from_secs_f64(2.0 * CLOSING_S)
        + along(&lift.first().cloned().unwrap_or_else(|| closing.clone()), lift, LIFT_RAD_S)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As where a disk is full.
    fn unwritable() -> FileError {
        let folder = tempfile::tempdir().expect("a temporary folder");
        plumbline_model::files::write(folder.path(), "a folder is no file").expect_err("it is a folder")
    }

    fn concluded(
        outcome: Outcome,
        problem: Option<KeepingError>,
        of_tracks: Option<FileError>,
    ) -> (Option<Outcome>, Option<String>) {
        let mut record = Record::new(Method::M5, "Tomato", Timestamp::UNIX_EPOCH, String::new());
        record.outcome = Some(outcome);
        let not_kept = conclude(&mut record, problem, of_tracks);
        (record.outcome, not_kept)
    }

    #[test]
    fn what_is_held_stays_held_where_the_end_of_its_tracks_alone_is_not_kept() {
        assert_eq!(concluded(Outcome::Success, None, None), (Some(Outcome::Success), None));
        let problem = unwritable();
        let said = problem.to_string();
        assert_eq!(concluded(Outcome::Success, None, Some(problem)), (Some(Outcome::Success), Some(said)));
    }

    #[test]
    fn what_could_not_be_kept_on_the_way_is_why_it_ended() {
        let ended = Outcome::Failed { failure: Failure::Halted, why: "it was ended".to_owned() };
        for (outcome, problem, of_tracks) in [
            (Outcome::Success, Some(unwritable().into()), None),
            (Outcome::Success, Some(unwritable().into()), Some(unwritable())),
            (ended, None, Some(unwritable())),
        ] {
            let (outcome, not_kept) = concluded(outcome, problem, of_tracks);
            let Some(Outcome::Failed { failure: Failure::Halted, why }) = outcome else {
                panic!("{outcome:?}")
            };
            assert!(why.contains("could not be kept") && not_kept.is_none(), "{why}");
        }
    }
}
