//! Single steps of a hand.

use plumbline_grasp::plan::{GraspPlanner, NoPlan};
use plumbline_grasp::{Body, Halt, NoArm, PalmArm};
use plumbline_model::robot::Posture;
use plumbline_model::{JobContext, Point};

use super::body::{LedBody, Ropes};
use super::command::HandStep;
use super::rests_on::RestsOn;
use crate::ground::jobs::JobError;

/// Through the air with something in the hand, rad/s.
const SPEED_RAD_S: f64 = 0.5;
/// Fingers that open, rad/s.
const OPEN_RAD_S: f64 = 1.2;
/// The palm is this high above the table before it goes anywhere, m.
const CLEAR_M: f64 = 0.15;
/// Where things are handed over: in front of the robot, to the side of the arm, above the table, m.
const GIVE_M: [f64; 3] = [0.34, 0.16, 0.26];
/// Headings in which they are, rad, of a right hand; the first that the arm reaches.
const GIVE_HEADINGS_RAD: [f64; 5] = [0.0, 0.5, 1.0, -0.5, 1.5];
/// A step that is one way.
const WHOLE: [f64; 2] = [0.1, 1.0];
/// Fingers that stand on the table are free so much higher, m.
const FREES_M: f64 = 0.012;
/// What is put down is let go this much above where it was taken, m.
const ABOVE_SUPPORT_M: f64 = 0.002;

/// Why a step was not made. Reads as a sentence.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoStep {
    /// It ended on the way.
    #[error(transparent)]
    Halted(#[from] Halt),
    /// There is no such arm.
    #[error(transparent)]
    Arm(#[from] NoArm),
    /// It would lift.
    #[error("the arm gets no higher here: open the hand, or go home")]
    NoHigher,
    /// It would put down.
    #[error(
        "nothing was grasped since the program began, so it is not known how far down: lower the hand in Robot"
    )]
    NotGrasped,
    /// It would put down.
    #[error("the arm does not get down to the table here: hand it over instead, or take it out of the hand")]
    NoLower,
    /// Something is in the way.
    #[error("no way down is free ({0}): hand it over instead, or take it out of the hand")]
    NoWay(NoPlan),
    /// It would let go.
    #[error("the fingers do not open all the way here ({0}): lift the hand, then open it")]
    Blocked(String),
    /// It would hand over.
    #[error("the arm does not reach where things are handed over")]
    OutOfReach,
}

/// A step to be made.
#[derive(Clone, Debug)]
pub struct HandWork {
    /// Which.
    pub step: HandStep,
    /// What the arm's model rests on.
    pub rests_on: RestsOn,
    /// Which arm.
    pub arm: String,
    /// Orders to the arm, pause and end.
    pub ropes: Ropes,
    /// Where the palm belonged when the hand closed last, robot frame, m.
    pub closed_at_m: Option<[f64; 3]>,
}

impl HandWork {
    /// Makes the step; `Err` inside: why not, the arm holds.
    pub fn carry_out(&self, context: &dyn JobContext) -> Result<Result<(), NoStep>, JobError> {
        let arm = PalmArm::new(&self.rests_on.model, &self.arm).map_err(JobError::told)?;
        let planner = GraspPlanner::new(arm);
        let body = LedBody::new(self.rests_on.model.rig().clone(), self.ropes.clone(), context);
        let body = body.of_arm(&self.arm);
        let mut hand = Hand { planner: &planner, body };
        Ok(match self.step {
            HandStep::Open => hand.open(),
            HandStep::Close => hand.close(),
            HandStep::Lift => hand.lift(),
            HandStep::Place => hand.place(self.closed_at_m),
            HandStep::Give => hand.give(self.arm == "left"),
            HandStep::Home => hand.home(),
        })
    }
}

struct Hand<'a> {
    planner: &'a GraspPlanner,
    body: LedBody<'a>,
}

impl Hand<'_> {
    fn open(&mut self) -> Result<(), NoStep> {
        self.body.begin_leg("opening", WHOLE);
        let from = self.body.commanded()?;
        self.unfold(&self.planner.open(&from))
    }

    /// Fingers go where they are open, or it is said that something keeps them from it.
    fn unfold(&mut self, open: &Posture) -> Result<(), NoStep> {
        self.body.follow(std::slice::from_ref(open), OPEN_RAD_S).map_err(|halt| match halt {
            // What other pose to choose is no advice here.
            Halt::Refused(why) => {
                NoStep::Blocked(why.split(". ").next().unwrap_or_default().trim_end_matches('.').to_owned())
            }
            other => other.into(),
        })
    }

    fn close(&mut self) -> Result<(), NoStep> {
        self.body.begin_leg("closing the thumb", [0.1, 0.4]);
        let from = self.body.commanded()?;
        let closed = self.planner.closed(&from);
        self.body.follow(&[self.planner.thumb_closed(&from)], SPEED_RAD_S)?;
        self.body.begin_leg("closing the fingers", [0.4, 1.0]);
        Ok(self.body.follow(&[closed], SPEED_RAD_S)?)
    }

    fn lift(&mut self) -> Result<(), NoStep> {
        self.body.begin_leg("lifting", WHOLE);
        let from = self.body.commanded()?;
        let way = self.planner.vertical(self.planner.arm().heading_rad(&from), &from, GraspPlanner::LIFT_M);
        if way.is_empty() {
            return Err(NoStep::NoHigher);
        }
        self.body.let_fingers_touch()?;
        Ok(self.body.follow(&way, SPEED_RAD_S)?)
    }

    fn place(&mut self, closed_at_m: Option<[f64; 3]>) -> Result<(), NoStep> {
        self.body.begin_leg("lowering", [0.1, 0.5]);
        let from = self.body.commanded()?;
        let [x_m, y_m, z_m] = closed_at_m.ok_or(NoStep::NotGrasped)?;
        let closes_m = z_m + ABOVE_SUPPORT_M;
        let mut low = from.clone();
        if self.planner.arm().palm(&from).coords.z > closes_m {
            let way = self.planner.put_back(&from, [x_m, y_m, closes_m]).map_err(NoStep::NoWay)?;
            let way = way.ok_or(NoStep::NoLower)?;
            low = way.last().cloned().unwrap_or(from);
            self.body.let_fingers_touch()?;
            self.body.follow(&way, SPEED_RAD_S)?;
        }
        self.body.begin_leg("letting go", [0.5, 0.8]);
        self.body.let_fingers_touch()?;
        let mut open = self.planner.open(&low);
        match self.unfold(&open) {
            // A finger stands on the table: a little higher it is free.
            Err(NoStep::Blocked(_)) => {
                let higher = self.raised(FREES_M)?;
                open = self.planner.open(&higher);
                self.body.let_fingers_touch()?;
                self.unfold(&open)?;
            }
            done => done?,
        }
        self.body.wait(0.3)?;
        self.body.begin_leg("lifting the open hand", [0.8, 1.0]);
        self.body.let_fingers_touch()?;
        let heading_rad = self.planner.arm().heading_rad(&open);
        let up = self.planner.vertical(heading_rad, &open, GraspPlanner::LIFT_M);
        Ok(self.body.follow(&up, SPEED_RAD_S)?)
    }

    /// Straight up by this, fingers as they are.
    fn raised(&mut self, by_m: f64) -> Result<Posture, NoStep> {
        let from = self.body.commanded()?;
        let up = self.planner.vertical(self.planner.arm().heading_rad(&from), &from, by_m);
        self.body.let_fingers_touch()?;
        self.body.follow(&up, SPEED_RAD_S)?;
        Ok(up.last().cloned().unwrap_or(from))
    }

    /// It holds on until somebody has it: the hand opens by a step of its own.
    fn give(&mut self, left: bool) -> Result<(), NoStep> {
        self.clear_the_table()?;
        self.body.begin_leg("holding it out", [0.4, 1.0]);
        let from = self.body.commanded()?;
        let side = if left { 1.0 } else { -1.0 };
        let table_m = self.planner.arm().rig().table.height_m;
        let point = Point::new(GIVE_M[0], side * GIVE_M[1], table_m + GIVE_M[2]);
        let arm = self.planner.arm();
        let mut headings = GIVE_HEADINGS_RAD.iter().map(|heading_rad| -side * heading_rad);
        let there = headings.find_map(|heading_rad| arm.sent_to(point, heading_rad, &from));
        Ok(self.body.follow(&[there.ok_or(NoStep::OutOfReach)?], SPEED_RAD_S)?)
    }

    fn home(&mut self) -> Result<(), NoStep> {
        self.clear_the_table()?;
        self.body.begin_leg("going home", [0.4, 1.0]);
        let from = self.body.commanded()?;
        let arm = self.planner.arm();
        let home = from.with(arm.joints(), &arm.rig().home().of(arm.joints()));
        Ok(self.body.follow(&[home], SPEED_RAD_S)?)
    }

    /// Up from between things, before it goes anywhere.
    fn clear_the_table(&mut self) -> Result<(), NoStep> {
        self.body.begin_leg("lifting", [0.1, 0.4]);
        let from = self.body.commanded()?;
        let height_m = self.planner.arm().palm(&from).coords.z;
        let missing_m = self.planner.arm().rig().table.height_m + CLEAR_M - height_m;
        if missing_m <= 0.0 {
            return Ok(());
        }
        let up = self.planner.vertical(self.planner.arm().heading_rad(&from), &from, missing_m);
        self.body.let_fingers_touch()?;
        Ok(self.body.follow(&up, SPEED_RAD_S)?)
    }
}
