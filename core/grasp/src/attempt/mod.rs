//! One grasp, from the look at the table to the check of what is in the hand.

mod again;
mod align;
mod arms;
mod between;
mod check;
mod choose;
mod over;
mod ready;
mod rendered;
mod sure;

use jiff::Timestamp;
use nalgebra::Vector3;
use plumbline_model::robot::Posture;
use plumbline_model::robot::Rig;
use plumbline_vision::detect::DetectError;

use crate::arm::NoArm;
use crate::body::{Body, Halt, Sight};
use crate::hands::{Hand, HandChoice};
use crate::knowledge::Knowledge;
use crate::method::{self, Method, PublishedWithRight};
use crate::plan::{GraspPlan, GraspPlanner, NoPlan};
use crate::record::{Failure, Iteration, Moment, Outcome, Record, Step};
use crate::see::{Looker, Seen};

use arms::OneArm;

pub use align::{FoundHand, HandFinder, HandMissing};
pub use choose::Chosen;
pub use ready::{FINGER_HANGS_RAD, HANGS_RAD};
pub use rendered::{NoHand, RenderedHand};

/// Peak joint speed through the air, rad/s.
pub const AIR_RAD_S: f64 = 0.8;
/// Going down, rad/s.
pub const DOWN_RAD_S: f64 = 0.5;
/// Up with something in the hand, rad/s.
pub const LIFT_RAD_S: f64 = 0.4;
/// Thumb and fingers closing, rad/s.
const CLOSE_RAD_S: f64 = 2.5;
/// So often fingers press anew before the lift: what is soft or rolls gives way at first.
const GRIPS: usize = 2;
/// The eyes settle with the arm, s.
const STILL_S: f64 = 0.3;

/// What is to be grasped, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Order {
    /// How.
    pub method: Method,
    /// With which hand.
    pub hand: HandChoice,
    /// Class of the object.
    pub object: String,
    /// The one nearest to this place of the table, robot frame, m; `None`: the one nearest to the
    /// robot.
    pub near_m: Option<[f64; 2]>,
}

/// Told while it happens.
pub trait Watch {
    /// A step begins.
    fn step(&mut self, step: Step);
    /// What both eyes saw at that step, and what was found.
    fn saw(&mut self, step: Step, sight: &Sight, seen: &[Seen]);
    /// What is about to be sent: it was looked at and nothing has moved yet.
    fn planned(&mut self, plan: &GraspPlan);
    /// The hand was looked at.
    fn aligned(&mut self, iteration: &Iteration);
    /// The try before came up without the object: it will be tried again, with the arm's way back to where it
    /// began. `number` of `tries` counts from 1; `why` the try before failed.
    fn again(&mut self, _number: usize, _tries: usize, _why: &str) {}
    /// All that is known so far, before a step is begun: `record.step` is that step. To be kept before
    /// it goes on. Once more before it holds between two steps: `record.step` is the one that is done then.
    fn about_to(&mut self, _record: &Record) {}
    /// Between two steps, or two looks at the hand: whether to hold until somebody lets it go on. Whoever wants
    /// that has told the body, which holds while it waits.
    fn holds_between(&mut self, _done: Step, _next: Step) -> bool {
        false
    }
}

/// Nobody watches.
impl Watch for () {
    fn step(&mut self, _step: Step) {}
    fn saw(&mut self, _step: Step, _sight: &Sight, _seen: &[Seen]) {}
    fn planned(&mut self, _plan: &GraspPlan) {}
    fn aligned(&mut self, _iteration: &Iteration) {}
}

/// Why an attempt ends before it has lifted.
enum End {
    Refused(String),
    Failed(Failure, String),
}

impl From<End> for Outcome {
    fn from(end: End) -> Self {
        match end {
            End::Refused(why) => Self::Refused { why },
            End::Failed(failure, why) => Self::Failed { failure, why },
        }
    }
}

impl From<Halt> for End {
    fn from(halt: Halt) -> Self {
        match halt {
            Halt::Blind(_) => Self::Failed(Failure::EyesLost, halt.to_string()),
            other => Self::Failed(Failure::Halted, other.to_string()),
        }
    }
}

impl From<NoPlan> for End {
    fn from(no_plan: NoPlan) -> Self {
        Self::Refused(no_plan.to_string())
    }
}

impl From<method::NotKnown> for End {
    fn from(not_known: method::NotKnown) -> Self {
        Self::Refused(not_known.to_string())
    }
}

impl From<PublishedWithRight> for End {
    fn from(why: PublishedWithRight) -> Self {
        Self::Refused(why.to_string())
    }
}

impl From<DetectError> for End {
    fn from(error: DetectError) -> Self {
        Self::Failed(Failure::NotSeen, error.to_string())
    }
}

/// Grasps with the hands of a robot. Made once, used for many attempts.
pub struct Grasper {
    knowledge: Knowledge,
    looker: Looker,
    /// The hand in use.
    arm: OneArm,
    others: Vec<OneArm>,
}

impl Grasper {
    /// For every hand that the robot has; `finder` makes what finds a hand for M5.
    ///
    /// # Errors
    /// When the robot has none.
    pub fn new(
        knowledge: Knowledge,
        looker: Looker,
        finder: &mut dyn FnMut(Hand) -> Option<Box<dyn HandFinder>>,
    ) -> Result<Self, NoArm> {
        let (mut arms, mut why) = (vec![], None);
        for hand in Hand::BOTH {
            match OneArm::new(&knowledge, hand) {
                Ok(arm) => arms.push(OneArm { finder: finder(hand), ..arm }),
                Err(no_arm) => why = why.or(Some(no_arm)),
            }
        }
        if arms.is_empty() {
            let none = || NoArm::NoArm { rig: knowledge.described.name.clone(), arm: "right".to_owned() };
            return Err(why.unwrap_or_else(none));
        }
        let arm = arms.remove(0);
        Ok(Self { knowledge, looker, arm, others: arms })
    }

    /// The robot as it is known.
    pub fn rig(&self) -> &Rig {
        self.knowledge.model.rig()
    }

    /// What it rests on.
    pub fn knowledge(&self) -> &Knowledge {
        &self.knowledge
    }

    /// What plans for a method with the hand in use.
    pub fn planner(&self, method: Method) -> &GraspPlanner {
        self.arm.planner(method)
    }

    /// Up from where the hand closed. The published methods go straight up.
    pub fn lift(&self, method: Method, closed: &Posture, heading_rad: f64) -> Vec<Posture> {
        let planner = self.planner(method);
        if method.knows_effects() {
            planner.lift(closed, heading_rad, GraspPlanner::LIFT_M)
        } else {
            planner.vertical(heading_rad, closed, GraspPlanner::LIFT_M)
        }
    }

    /// Grasps once, beginning now. Whatever happens, the record says it, and the arm holds where it is.
    pub fn attempt(
        &mut self,
        body: &mut dyn Body,
        order: &Order,
        began: Timestamp,
        watch: &mut dyn Watch,
    ) -> Record {
        let mut record = self.record_of(order, began);
        let mut running = Running::new(self, body, order, watch, &mut record);
        record.outcome = Some(match running.run() {
            Ok(outcome) => outcome,
            Err(end) => end.into(),
        });
        record
    }

    /// Looks and plans as an attempt does, and moves nothing: the plan, and what was seen. Where there
    /// is no plan, the outcome of the record says why.
    pub fn propose(
        &mut self,
        body: &mut dyn Body,
        order: &Order,
        began: Timestamp,
        watch: &mut dyn Watch,
    ) -> (Option<GraspPlan>, Record) {
        let mut record = self.record_of(order, began);
        let mut running = Running::new(self, body, order, watch, &mut record);
        match running.prepare() {
            Ok(prepared) => (Some(prepared.plan), record),
            Err(end) => {
                record.outcome = Some(end.into());
                (None, record)
            }
        }
    }

    /// All things in a pair, the surest first.
    ///
    /// # Errors
    /// When the detector fails.
    pub fn see(&mut self, sight: &Sight) -> Result<Vec<Seen>, DetectError> {
        self.looker.look(sight, &self.knowledge)
    }

    fn record_of(&self, order: &Order, began: Timestamp) -> Record {
        let knows_effects = order.method.knows_effects();
        let model = if knows_effects { self.knowledge.model.title() } else { "as described".to_owned() };
        let hand = order.hand.asked().unwrap_or_default();
        Record { hand, ..Record::new(order.method, &order.object, began, model) }
    }
}

/// What is known before anything moves.
struct Prepared {
    before: Sight,
    chosen: Chosen,
    shift_m: Vector3<f64>,
    plan: GraspPlan,
}

/// An attempt that is under way.
struct Running<'a> {
    grasper: &'a mut Grasper,
    body: &'a mut dyn Body,
    order: &'a Order,
    watch: &'a mut dyn Watch,
    record: &'a mut Record,
    began_s: f64,
    /// The one nearest to this place is meant, m.
    near_m: Option<[f64; 2]>,
    /// The palm closes so much lower than it usually does, m.
    lower_m: f64,
}

impl<'a> Running<'a> {
    fn new(
        grasper: &'a mut Grasper,
        body: &'a mut dyn Body,
        order: &'a Order,
        watch: &'a mut dyn Watch,
        record: &'a mut Record,
    ) -> Self {
        let began_s = body.now_s();
        Self { grasper, body, order, watch, record, began_s, near_m: order.near_m, lower_m: 0.0 }
    }
}

impl Running<'_> {
    /// Looks, and plans what would be sent. Nothing moves.
    fn prepare(&mut self) -> Result<Prepared, End> {
        self.begin(Step::Ready)?;
        let hands = self.fit_hands()?;
        self.begin(Step::Look)?;
        let before = self.body.look()?;
        let mut chosen = self.find(&before)?;
        if self.order.method == Method::M5 {
            sure::sure_of_object(&self.order.object, &chosen.covariance_m2)?;
        }
        self.begin(Step::Plan)?;
        let beside = self.beside(&chosen);
        self.grasper.leave(&beside);
        let method = self.order.method;
        let from = self.body.commanded()?;
        let headed = method::published(method, &self.grasper.knowledge, &chosen.point)?;
        let plan = match self.best_plan(&hands, &chosen, headed.as_ref(), &from) {
            Err(_) if self.lower_m > 0.0 => {
                chosen.standing.lower_m -= self.lower_m;
                self.best_plan(&hands, &chosen, headed.as_ref(), &from)?
            }
            plan => plan?,
        };
        let shift_m = headed.map_or_else(Vector3::zeros, |headed| headed.shift_m);
        self.planned(&plan);
        Ok(Prepared { before, chosen, shift_m, plan })
    }

    /// Grasps; what is not in the hand then is tried again by ours: a robot may look again. The record says
    /// what became of the tries before.
    fn run(&mut self) -> Result<Outcome, End> {
        let from = self.body.commanded()?;
        let mut last = self.try_once()?;
        for number in 2..=self.order.method.tries() {
            last = match last {
                Outcome::Failed { failure, why } => self.once_more(&from, number, failure, why)?,
                other => return Ok(other),
            };
        }
        Ok(last)
    }

    fn try_once(&mut self) -> Result<Outcome, End> {
        let Prepared { before, chosen, shift_m, mut plan } = self.prepare()?;
        let method = self.order.method;
        self.begin(Step::Approach)?;
        self.follow(Step::Approach, &plan.approach.clone(), AIR_RAD_S)?;
        if method.aligns() {
            self.begin(Step::Align)?;
            plan = self.align(plan, shift_m, &chosen, &before)?;
        }
        self.begin(Step::Lower)?;
        self.follow(Step::Lower, &plan.down, DOWN_RAD_S)?;
        // An arm that still swings or lags behind its commands would close beside the object.
        self.body.wait(STILL_S)?;
        self.begin(Step::Close)?;
        let closed = self.close(&plan)?;
        self.begin(Step::Lift)?;
        let up = self.grasper.lift(method, &closed, plan.heading_rad);
        self.follow(Step::Lift, &up, LIFT_RAD_S)?;
        self.record.seconds = Some(self.body.now_s() - self.began_s);
        self.body.grip()?;
        self.begin(Step::Check)?;
        self.check(&chosen)
    }

    fn begin(&mut self, step: Step) -> Result<(), End> {
        self.hold_before(step)?;
        self.start(step);
        Ok(())
    }

    fn start(&mut self, step: Step) {
        self.record.step = Some(step);
        self.watch.about_to(self.record);
        self.watch.step(step);
    }

    fn planned(&mut self, plan: &GraspPlan) {
        self.record.wanted_m = Some(plan.palm_m.into());
        self.record.standing_m = Some(plan.standing.xy_m);
        self.record.over_middle_m = Some(plan.palm_m.z - plan.standing.middle_m());
        self.record.heading_rad = Some(plan.heading_rad);
        self.watch.planned(plan);
    }

    fn follow(&mut self, step: Step, way: &[Posture], speed_rad_s: f64) -> Result<(), End> {
        let done = self.body.follow(way, speed_rad_s);
        self.keep(step)?;
        Ok(done?)
    }

    /// Where the arm is now, into the record.
    fn keep(&mut self, after: Step) -> Result<(), End> {
        let servos = self.body.servos()?;
        self.record.moments.push(Moment {
            after,
            at_s: self.body.now_s(),
            commanded_rad: self.body.commanded()?.angles_rad().to_vec(),
            encoder_rad: servos.iter().map(|servo| servo.angle_rad).collect(),
            load: servos.iter().map(|servo| servo.load).collect(),
        });
        Ok(())
    }

    /// The thumb first: the fingers push against it.
    fn close(&mut self, plan: &GraspPlan) -> Result<Posture, End> {
        let open = plan
            .closing()
            .cloned()
            .ok_or_else(|| End::Refused("there is no way down: plan again".to_owned()))?;
        let planner = self.grasper.planner(self.order.method);
        let closed = planner.closed(&open);
        let thumb = planner.thumb_closed(&open);
        self.follow(Step::Close, &[thumb], CLOSE_RAD_S)?;
        self.follow(Step::Close, std::slice::from_ref(&closed), CLOSE_RAD_S)?;
        for _ in 0..GRIPS {
            self.body.wait(STILL_S)?;
            self.body.grip()?;
        }
        Ok(closed)
    }
}
