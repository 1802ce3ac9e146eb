//! From a target on the screen to the postures that touch it: above, straight down, and a free way
//! there.
//!
//! The posture at a contact depends on the point alone, not on where the arm comes from: what a
//! posture bends and how its joints err then belongs to the place, and can be learned.

use std::sync::Arc;

use nalgebra::Vector3;
use plumbline_hardware::joints::{FARTHEST_FLOOR_M, FloorGuard};
use plumbline_model::robot::collision::{Allowance, BesideModel, Body, CollisionModel};
use plumbline_model::robot::ik::{Options, Solution, Solver, Target};
use plumbline_model::robot::{Chain, JointIndex, LinkIndex, Posture, Rig};
use plumbline_model::session::Screen;
use plumbline_model::touch_plan::Side;
use plumbline_model::{Pixel, Point, Robot};

use super::no_way::NoWay;
use super::path::{ABOVE_MEASURED_M, Hold, ScreenPlace, TouchPath, Wanted};
use super::ways::{Around, FreeWay, Lowering};

/// The heading over a place of the table is found at this height above the table, m: about that of a
/// fingertip on the glass.
const HEADING_ABOVE_M: f64 = 0.02;
/// The arm is held over the middle as it is held this high above the table there, m.
const MIDDLE_ABOVE_M: f64 = 0.04;
/// Postures while lowering are this far apart, m.
const STEP_M: f64 = 0.002;
/// Lowering goes on to this far below the glass or the point that is sent, m, if the floor lets it.
const BELOW_M: f64 = 0.012;
/// From a side the tip comes slanted, this far aside per meter of height: 20 mm on the last 40.
const SLANT: f64 = 0.5;
/// The finger's shape may enter the screen by this much: it is softer and thinner than drawn, m.
const TOUCH_DEPTH_M: f64 = 0.015;
/// Lowering keeps this far from the floor, m: encoders and ticks round.
const FLOOR_MARGIN_M: f64 = 0.0005;
/// Less room below the point that is sent would let the tip end in the air, m.
const LEAST_BELOW_M: f64 = 0.003;
/// Cosine of the finger's inclination: farther inclined it touches with its side.
const LEAST_UPRIGHT: f64 = 0.85;
/// Neighboring postures of a lowering that differ by more belong to different ways to hold the
/// arm, rad.
const JUMP_RAD: f64 = 0.06;
/// So many steps before the point say in which direction joints come to it.
const LAST_STEPS: usize = 3;
/// Joints that turn by less over the last steps count as standing, rad.
const STANDING_RAD: f64 = 1e-5;
/// A point that is sent farther from its place than this is no correction of an arm any more, m.
const FARTHEST_BESIDE_M: f64 = 0.06;

/// Heading of the tip and where its z axis should point, while it comes down.
#[derive(Clone, Copy)]
struct Held {
    heading_rad: f64,
    hold: Hold,
}

/// Plans touches of one tip. Made once per place of the screen, used for many targets.
#[derive(Clone, Debug)]
pub struct Planner {
    pub(super) rig: Arc<Rig>,
    /// The tip waits this high above the glass where the arm gets so high, m.
    pub(super) above_m: f64,
    pub(super) solver: Solver,
    chain: Chain,
    model: Arc<CollisionModel>,
    floor: Arc<FloorGuard>,
    /// Joints of the arm and its hand: nothing else moves.
    pub(super) joints: Vec<JointIndex>,
    pub(super) hand: Vec<JointIndex>,
    /// The arm ready to touch, everything else at home.
    ready: Posture,
    /// The arm above the middle of the screen: solutions near it are taken.
    pub(super) middle: Posture,
}

impl Planner {
    /// For a tip of a rig, whose touchscreen lies where it is taken to lie; `place` says whether that
    /// was measured.
    ///
    /// # Errors
    /// When the tip is no tip of an arm, or cannot point at the screen.
    pub fn new(rig: &Arc<Rig>, tip: &str, place: ScreenPlace) -> Result<Self, NoWay> {
        let arm = rig.arms.iter().find(|arm| arm.tips.iter().any(|known| known.link == tip));
        let arm = arm.ok_or_else(|| NoWay::NoTip { tip: tip.to_owned() })?;
        // An arm may have a pose of its own.
        let own = rig.pose(&format!("touch-ready-{}", arm.name));
        let pose = own.or_else(|| rig.pose("touch-ready")).ok_or(NoWay::NoReadyPose)?;
        let solver = Solver::of_rig(rig, tip)?;
        let chain = rig.chain(tip)?;
        let model = Arc::new(CollisionModel::of_rig(rig));
        let floor = Arc::new(FloorGuard::new(rig));
        let joints = [arm.joints.clone(), arm.hand.clone()].concat();
        let home = rig.home();
        let ready = home.with(&joints, &pose.applied_to(&home).of(&joints));
        let mut planner = Self {
            rig: rig.clone(),
            above_m: place.above_m(),
            solver,
            chain,
            model,
            floor,
            joints,
            hand: arm.hand.clone(),
            middle: ready.clone(),
            ready,
        };
        let screen = &rig.touchscreen;
        let over_screen = raised(screen.point_at(screen.middle()), MIDDLE_ABOVE_M);
        // Where the screen was measured to lie must not change how the arm is held.
        let solution = planner
            .upright(planner.over_patch(), screen.middle())
            .or_else(|_| planner.upright(over_screen, screen.middle()))?;
        planner.middle = planner.ready.with(planner.solver.joints(), &solution.joints);
        Ok(planner)
    }

    /// The robot it plans for.
    pub fn rig(&self) -> &Arc<Rig> {
        &self.rig
    }

    /// Its tip and the joints between it and the base.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// The arm ready to touch, everything else as in `from`.
    pub fn ready(&self, from: &Posture) -> Posture {
        from.with(&self.joints, &self.ready.of(&self.joints))
    }

    /// The touch of a target, by an arm that stands at `from`. What must not meet is looked at where the tip
    /// will be, not where it is sent.
    ///
    /// # Errors
    /// A sentence that says why it cannot be touched.
    pub fn plan(&self, wanted: &Wanted, from: &Posture) -> Result<TouchPath, NoWay> {
        let Wanted { target, place, sent, hold, .. } = *wanted;
        let points = [place.coords, sent.coords].into_iter().flat_map(|at| [at.x, at.y, at.z]);
        if !([target.u_px, target.v_px].into_iter().chain(points).all(f64::is_finite) && from.is_finite()) {
            return Err(NoWay::NotANumber);
        }
        let around = self.around(wanted)?;
        let (contact, held) = self.contact(sent, target, hold, from)?;
        let upright = self.inclination(&contact);
        if !hold.is_usual() && upright < LEAST_UPRIGHT {
            return Err(NoWay::Inclined { target, inclined_rad: upright.clamp(-1.0, 1.0).acos() });
        }
        let heading_rad = held.heading_rad;
        let down = self.lowering(wanted, &contact, held, &around)?;
        let FreeWay { lowering, approach, turns_rad } = self.highest_free(target, from, down, &around)?;
        let tips: Vec<Point<Robot>> = lowering.iter().map(|posture| self.tip(posture)).collect();
        Ok(TouchPath {
            target,
            sent,
            beside_m: wanted.beside_m(),
            deeper_m: wanted.deeper_m,
            direction: self.direction(&lowering, &tips, sent),
            drop_m: tips[0].distance_m(&sent),
            approach,
            lower: lowering,
            lower_tip: tips,
            contact,
            heading_rad,
            upright,
            turns_rad,
        })
    }

    /// What may be met, for an arm that ends beside the points that it is sent to.
    fn around(&self, wanted: &Wanted) -> Result<Around, NoWay> {
        let (beside_m, deeper_m) = (wanted.beside_m(), wanted.deeper_m);
        if !is_believed(&beside_m, deeper_m) {
            return Err(NoWay::TooFarBeside { target: wanted.target, by_m: beside_m.norm().max(deeper_m) });
        }
        let bodies = BesideModel::new(self.model.clone(), &self.rig, self.solver.joints(), beside_m);
        let allowances = touch_allowances(&self.model, &self.floor, &self.chain, (&self.middle, deeper_m));
        Ok(Around { bodies, allowances, up_m: beside_m.z })
    }

    /// What may be met by an arm that touches nothing.
    pub(super) fn nothing_met(&self, beside_m: Vector3<f64>) -> Around {
        let bodies = BesideModel::new(self.model.clone(), &self.rig, self.solver.joints(), beside_m);
        Around { bodies, allowances: vec![], up_m: beside_m.z }
    }

    /// Above the middle of the patch of the table that is worked on.
    fn over_patch(&self) -> Point<Robot> {
        let middle = |range: [f64; 2]| 0.5 * (range[0] + range[1]);
        let patch = &self.rig.work_patch;
        let z_m = self.rig.table.height_m + MIDDLE_ABOVE_M;
        Point::new(middle(patch.x_range_m), middle(patch.y_range_m), z_m)
    }

    /// The arm with its tip at a point, and the heading of its tip. What the arm errs by depends on
    /// how it is held, so each place of the table is always touched with the same heading, whatever
    /// its height, the place of the screen, and what was touched before.
    fn contact(
        &self,
        sent: Point<Robot>,
        target: Pixel<Screen>,
        hold: Hold,
        from: &Posture,
    ) -> Result<(Posture, Held), NoWay> {
        let over = Point::new(sent.coords.x, sent.coords.y, self.rig.table.height_m + HEADING_ABOVE_M);
        let usual = self.posture(from, &self.upright(over, target)?);
        let heading_rad = self.heading_rad(&usual) + hold.turn_rad;
        let at = Target::PositionYaw { point: sent, yaw_rad: heading_rad };
        let options = Options { other_starts: 0, tool_z: hold.tool_z(), ..Options::default() };
        let answer = self.solver.solve_from(&at, &usual, &options)?;
        if !answer.is_reached() {
            return Err(NoWay::OutOfReach { target });
        }
        Ok((self.posture(from, answer.best()), Held { heading_rad, hold }))
    }

    /// Cosine of the finger's inclination, 1 straight down.
    fn inclination(&self, posture: &Posture) -> f64 {
        (self.chain.robot_from_tip_in(posture).isometry.rotation * Vector3::z()).z
    }

    /// The arm with its tip at a point, the finger as upright as it can be, always from the same
    /// start.
    fn upright(&self, point: Point<Robot>, target: Pixel<Screen>) -> Result<Solution, NoWay> {
        let start = self.middle.of(self.solver.joints());
        let answer = self.solver.solve(&Target::Position(point), &start, &Options::upright())?;
        let best = *answer.best();
        if !answer.is_reached() {
            return Err(NoWay::OutOfReachBy { target, by_m: best.position_error_m });
        }
        let tip = self.chain.robot_from_tip(&best.joints);
        let upright = (tip.isometry.rotation * Vector3::z()).z;
        if upright < LEAST_UPRIGHT {
            return Err(NoWay::Inclined { target, inclined_rad: upright.clamp(-1.0, 1.0).acos() });
        }
        Ok(best)
    }

    /// A solution as a posture of the whole robot, the fingers pointing.
    fn posture(&self, from: &Posture, solution: &Solution) -> Posture {
        self.ready(from).with(self.solver.joints(), &solution.joints)
    }

    fn heading_rad(&self, posture: &Posture) -> f64 {
        let x_axis = self.chain.robot_from_tip_in(posture).isometry.rotation * Vector3::x();
        x_axis.y.atan2(x_axis.x)
    }

    pub(super) fn tip(&self, posture: &Posture) -> Point<Robot> {
        Point::from(nalgebra::Point3::from(self.chain.robot_from_tip_in(posture).translation_m()))
    }

    /// The angles (rad) that the chain's joints are commanded with the tip at a point that is sent, and
    /// the signs of their last motion when it comes there from a side.
    ///
    /// # Errors
    /// A sentence that says why the point cannot be sent.
    pub fn commanded(
        &self,
        target: Pixel<Screen>,
        sent: Point<Robot>,
        side: Side,
        hold: Hold,
        from: &Posture,
    ) -> Result<(Vec<f64>, Vec<f64>), NoWay> {
        let (contact, held) = self.contact(sent, target, hold, from)?;
        let at = |step: usize| on_the_way(sent, side, held.heading_rad, step as f64 * STEP_M);
        let above = self.follow(&contact, LAST_STEPS, held.hold, at);
        let before = above.last().unwrap_or(&contact);
        let sign = |joint: &JointIndex| f64::from(sign(contact[*joint] - before[*joint]));
        let joints = self.chain.joints();
        Ok((contact.of(joints), joints.iter().map(sign).collect()))
    }

    /// Postures from above to the lowest, on one line through the point.
    fn lowering(
        &self,
        wanted: &Wanted,
        contact: &Posture,
        held: Held,
        around: &Around,
    ) -> Result<Lowering, NoWay> {
        let Wanted { target, sent, side, deeper_m, .. } = *wanted;
        let glass_m = self.rig.touchscreen.point_at(target).coords.z + around.up_m;
        let upper_m = sent.coords.z.max(glass_m) - sent.coords.z;
        let (top_m, least_m) = (upper_m + self.above_m, upper_m + ABOVE_MEASURED_M);
        let bottom_m = sent.coords.z - sent.coords.z.min(glass_m) + BELOW_M + deeper_m;
        let at = |height_m: f64| on_the_way(sent, side, held.heading_rad, height_m);
        let steps = |length_m: f64| (length_m / STEP_M).ceil() as usize;
        let up = self.follow(contact, steps(top_m), held.hold, |step| at(top_m.min(step as f64 * STEP_M)));
        let least = steps(least_m);
        if up.len() < least {
            return Err(NoWay::TooLow { target, high_m: up.len() as f64 * STEP_M });
        }
        let down =
            self.follow(contact, steps(bottom_m), held.hold, |step| at(-bottom_m.min(step as f64 * STEP_M)));
        let (allowed_m, down_m) = (self.rig.gate.floor_m + FLOOR_MARGIN_M, around.up_m - deeper_m);
        let above_floor = |posture: &&Posture| {
            let lowest = self.floor.lowest_shifted(posture, down_m);
            lowest.is_none_or(|(_, height_m)| height_m >= allowed_m)
        };
        let down: Vec<Posture> = down.iter().take_while(above_floor).cloned().collect();
        let below_m = down.last().map_or(0.0, |lowest| sent.coords.z - self.tip(lowest).coords.z);
        if below_m < LEAST_BELOW_M {
            let above_floor_m = sent.coords.z - around.up_m - self.rig.gate.floor_m;
            return Err(NoWay::TooHigh { target, above_floor_m });
        }
        let dispensable = up.len() - least;
        let postures = up.into_iter().rev().chain([contact.clone()]).chain(down).collect();
        Ok(Lowering { postures, dispensable })
    }

    /// Postures of neighboring targets, each from the one before, as long as they are reached
    /// without holding the arm in another way.
    fn follow(
        &self,
        start: &Posture,
        steps: usize,
        hold: Hold,
        target: impl Fn(usize) -> Target,
    ) -> Vec<Posture> {
        let options = Options { other_starts: 0, tool_z: hold.tool_z(), ..Options::default() };
        let mut found: Vec<Posture> = vec![];
        for step in 1..=steps {
            let before = found.last().unwrap_or(start);
            let Ok(answer) = self.solver.solve_from(&target(step), before, &options) else { break };
            let next = before.with(self.solver.joints(), &answer.best().joints);
            if !answer.is_reached() || next.distance_rad(before) > JUMP_RAD {
                break;
            }
            found.push(next);
        }
        found
    }

    /// Signs of the joints' last motion before the point.
    fn direction(&self, lowering: &[Posture], tips: &[Point<Robot>], sent: Point<Robot>) -> Vec<i8> {
        let at = tips.iter().position(|tip| tip.distance_m(&sent) < 0.5 * STEP_M).unwrap_or(tips.len() - 1);
        let before = &lowering[at.saturating_sub(LAST_STEPS)];
        self.chain.joints().iter().map(|joint| sign(lowering[at][*joint] - before[*joint])).collect()
    }
}

/// Whether an arm may err so that it is sent this much beside the place where it ends, and be higher than anybody knows
/// by as much as it goes deeper, m.
pub fn is_believed(beside_m: &Vector3<f64>, deeper_m: f64) -> bool {
    beside_m.norm() <= FARTHEST_BESIDE_M
        && beside_m.z.abs() <= FARTHEST_FLOOR_M
        && deeper_m >= 0.0
        && (beside_m.z - deeper_m).abs() <= FARTHEST_FLOOR_M
}

/// What may meet while the screen is touched: the part of the hand that hangs lowest in a posture, a
/// finger, may enter the screen, and the table on which it lies, a little; and all of the hand as much as it goes
/// deeper (m) where nothing is met.
pub fn touch_allowances(
    model: &CollisionModel,
    floor: &FloorGuard,
    chain: &Chain,
    (posture, deeper_m): (&Posture, f64),
) -> Vec<Allowance> {
    let hand = chain.joints().last().map(|joint| model.links_moved_by(*joint)).unwrap_or_default();
    let links: Vec<LinkIndex> =
        floor.heights(posture, &hand).first().map(|(link, _)| *link).into_iter().collect();
    let to = |body| Allowance { links: links.clone(), body, depth_m: TOUCH_DEPTH_M + deeper_m };
    let mut allowances = vec![to(Body::Touchscreen), to(Body::Table)];
    if deeper_m > 0.0 {
        let deep = |body| Allowance { links: hand.clone(), body, depth_m: deeper_m };
        allowances.extend([Body::Touchscreen, Body::Table, Body::Floor].map(deep));
    }
    allowances
}

/// Sign of a joint's motion.
fn sign(turn_rad: f64) -> i8 {
    if turn_rad.abs() < STANDING_RAD { 0 } else { turn_rad.signum() as i8 }
}

/// The tip on its line to the point that is sent, so high above it.
fn on_the_way(sent: Point<Robot>, side: Side, heading_rad: f64, height_m: f64) -> Target {
    // How far the line leads aside per meter of height.
    let slant = match side {
        Side::Above => 0.0,
        Side::Left => SLANT,
        Side::Right => -SLANT,
    };
    let place = sent.coords + Vector3::new(0.0, slant * height_m, height_m);
    Target::PositionYaw { point: Point::from(place), yaw_rad: heading_rad }
}

fn raised(point: Point<Robot>, by_m: f64) -> Point<Robot> {
    Point::from(point.coords + Vector3::z() * by_m)
}
