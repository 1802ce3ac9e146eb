//! The hands of a robot, and which of them grasps.

use nalgebra::Vector3;
use plumbline_effects::RobotModel;
use plumbline_model::robot::Posture;

use super::align::HandFinder;
use super::{Chosen, End, Grasper, Running};
use crate::arm::{NoArm, PalmArm};
use crate::hands::Hand;
use crate::knowledge::Knowledge;
use crate::method::Method;
use crate::plan::{Beside, GraspPlan, GraspPlanner, Headed, NoPlan};

/// A palm that is more level than another one's by this (cosine) closes better around things, whatever else.
const LEVELER: f64 = 0.02;
/// A hand whose place over the table is stated less well by a millimeter counts as if it turned so much
/// more, rad.
const PER_SIGMA_RAD_M: f64 = 100.0;
/// A hand that came up empty counts as if it turned so much more, rad.
const CAME_UP_EMPTY_RAD: f64 = 0.4;
/// A palm that is level where it closes and tilts as it is lifted counts as if it turned so much more for each
/// cosine of its inclination, rad: out of a tilted hand things creep.
const PER_TILT_RAD: f64 = 40.0;
/// The usual hand is used unless the other one turns less by this, rad: changing hands is no end in itself.
const USUAL_RAD: f64 = 0.4;

/// A hand, and what plans for it and finds it.
pub(super) struct OneArm {
    pub hand: Hand,
    /// The arm as described.
    pub described: GraspPlanner,
    /// The arm with its effects.
    pub known: GraspPlanner,
    pub finder: Option<Box<dyn HandFinder>>,
}

impl OneArm {
    pub fn new(knowledge: &Knowledge, hand: Hand) -> Result<Self, NoArm> {
        let nominal = RobotModel::nominal(knowledge.described.clone());
        let described = GraspPlanner::new(PalmArm::new(&nominal, hand.name())?);
        let known = GraspPlanner::new(PalmArm::new(&knowledge.model, hand.name())?);
        Ok(Self { hand, described, known, finder: None })
    }

    pub fn planner(&self, method: Method) -> &GraspPlanner {
        if method.knows_effects() { &self.known } else { &self.described }
    }
}

impl Grasper {
    /// The hand in use: the one that grasped last, or is about to.
    pub fn hand(&self) -> Hand {
        self.arm.hand
    }

    /// All hands that there are.
    pub fn hands(&self) -> impl Iterator<Item = Hand> {
        std::iter::once(self.arm.hand).chain(self.others.iter().map(|arm| arm.hand))
    }

    /// From now on these things are left as they are by our method; the published ones know of none.
    pub(super) fn leave(&mut self, beside: &[Beside]) {
        for arm in std::iter::once(&mut self.arm).chain(&mut self.others) {
            arm.known.leave(beside.to_vec());
        }
    }

    /// Takes a hand in use.
    ///
    /// # Errors
    /// When the robot has no such hand.
    pub fn take(&mut self, hand: Hand) -> Result<(), NoArm> {
        if self.arm.hand == hand {
            return Ok(());
        }
        let rig = &self.knowledge.described.name;
        let no_arm = || NoArm::NoArm { rig: rig.clone(), arm: hand.name().to_owned() };
        let other = self.others.iter_mut().find(|arm| arm.hand == hand).ok_or_else(no_arm)?;
        std::mem::swap(&mut self.arm, other);
        Ok(())
    }
}

/// A plan of one hand, and what it costs.
struct Offer {
    hand: Hand,
    plan: GraspPlan,
    cost_rad: f64,
}

impl Running<'_> {
    /// The hands that may grasp and are fit to move; the first reason where none is.
    pub(super) fn fit_hands(&mut self) -> Result<Vec<Hand>, End> {
        let asked = self.order.method.hands(self.order.hand)?;
        let turning = self.turning()?;
        let mut fit = vec![];
        let mut why = None;
        for hand in asked {
            let is_fit = self.take(*hand).and_then(|()| self.ready(&turning));
            match is_fit {
                Ok(()) => fit.push(*hand),
                Err(unfit) => why = why.or(Some(unfit)),
            }
        }
        match why {
            Some(why) if fit.is_empty() => Err(why),
            _ => Ok(fit),
        }
    }

    /// The best plan of some hands, whose hand is then in use; the first reason where there is none.
    pub(super) fn best_plan(
        &mut self,
        hands: &[Hand],
        chosen: &Chosen,
        headed: Option<&Headed>,
        from: &Posture,
    ) -> Result<GraspPlan, End> {
        let mut best: Option<Offer> = None;
        let mut why = None;
        for hand in hands {
            self.take(*hand)?;
            match self.offer(chosen, headed, from) {
                Ok(offer) => {
                    if best.as_ref().is_none_or(|best| is_better(&offer, best)) {
                        best = Some(offer);
                    }
                }
                Err(barred) => why = why.or(Some(barred)),
            }
        }
        let Some(Offer { hand, plan, .. }) = best else {
            return Err(why.unwrap_or(NoPlan::OutOfReach { xy_m: chosen.standing.xy_m }).into());
        };
        self.take(hand)?;
        self.record.hand = hand;
        Ok(plan)
    }

    /// What the hand in use would do. Where the other arm is in its way, that goes home first.
    fn offer(&self, chosen: &Chosen, headed: Option<&Headed>, from: &Posture) -> Result<Offer, NoPlan> {
        let grasper = &*self.grasper;
        let method = self.order.method;
        let planner = grasper.planner(method);
        let plan_from = |from: &Posture| match headed {
            Some(headed) => planner.plan_headed(&chosen.standing, headed, from),
            None => planner.plan(&chosen.standing, &Vector3::zeros(), from),
        };
        let plan = match plan_from(from) {
            Err(NoPlan::NotFree(why)) => {
                let parked = grasper
                    .others
                    .iter()
                    .find_map(|other| other.planner(method).parked(from).ok().flatten())
                    .ok_or(NoPlan::NotFree(why))?;
                let plan = plan_from(parked.last().unwrap_or(from))?;
                GraspPlan { approach: [parked, plan.approach].concat(), ..plan }
            }
            planned => planned?,
        };
        let hand = grasper.hand();
        let closing = plan.closing().ok_or(NoPlan::OutOfReach { xy_m: chosen.standing.xy_m })?;
        let covariance_m2 = planner.arm().covariance_m2(closing);
        let sigma_m = covariance_m2.fixed_view::<2, 2>(0, 0).trace().max(0.0).sqrt();
        let empty = self.record.earlier.iter().filter(|earlier| earlier.hand == hand).count() as f64;
        let lifted = grasper.lift(method, &planner.closed(closing), plan.heading_rad);
        // What does not come up at all is no better than what tilts.
        let tilt = lifted.last().map_or(1.0, |top| (plan.level - planner.arm().level(top)).max(0.0));
        let cost_rad =
            plan.effort_rad + PER_SIGMA_RAD_M * sigma_m + CAME_UP_EMPTY_RAD * empty + PER_TILT_RAD * tilt;
        Ok(Offer { hand, plan, cost_rad })
    }

    pub(super) fn take(&mut self, hand: Hand) -> Result<(), End> {
        self.grasper.take(hand).map_err(|no_arm| End::Refused(no_arm.to_string()))
    }
}

/// Whether another hand's plan is better than that of the hand that is used rather.
fn is_better(other: &Offer, usual: &Offer) -> bool {
    let leveler = other.plan.capped_level() - usual.plan.capped_level();
    if leveler.abs() > LEVELER {
        return leveler > 0.0;
    }
    other.cost_rad + USUAL_RAD < usual.cost_rad
}
