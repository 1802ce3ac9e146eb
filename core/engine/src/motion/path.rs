//! From a target on the screen to the postures that touch it: above, straight down, and a free way
//! there.
//!
//! The posture at a contact depends on the point alone, not on where the arm comes from: what a
//! posture bends and how its joints err then belongs to the place, and can be learned.

use std::sync::Arc;
use std::time::Duration;

use super::no_way::{Barred, NoWay};
use nalgebra::Vector3;
use plumbline_hardware::joints::FloorGuard;
use plumbline_model::robot::collision::{Allowance, Body, CollisionModel, PathCheck, PostureCheck};
use plumbline_model::robot::ik::{Options, Solution, Solver, Target};
use plumbline_model::robot::{Chain, JointIndex, LinkIndex, Posture, Rig};
use plumbline_model::session::Screen;
use plumbline_model::touch_plan::Side;
use plumbline_model::{Direction, Pixel, Point, Robot};
use serde::{Deserialize, Serialize};

/// The heading over a place of the table is found at this height above the table, m: about that of a
/// fingertip on the glass.
const HEADING_ABOVE_M: f64 = 0.02;
/// The arm is held over the middle as it is held this high above the table there, m.
const MIDDLE_ABOVE_M: f64 = 0.04;
/// The tip waits this high above the glass, or above the point that is sent where that is higher, m;
/// it always gets at least as high.
const ABOVE_MEASURED_M: f64 = 0.04;
/// So high while the screen was not measured: the real finger may meet it up to 40 mm above its
/// nominal place, m.
const ABOVE_NOMINAL_M: f64 = 0.06;
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
/// On the way from target to target the tip comes lower than where it waits by no more than this, m.
const DIP_M: f64 = 0.02;
/// A way that is not free goes over a place this much higher, m.
const RAISE_M: f64 = 0.06;
/// Fingers that are farther from the pointing pose are brought there first, rad.
const POINTING_RAD: f64 = 0.05;
/// Places looked at along a way.
const SAMPLES: usize = 16;
/// So many steps before the point say in which direction joints come to it.
const LAST_STEPS: usize = 3;
/// Joints that turn by less over the last steps count as standing, rad.
const STANDING_RAD: f64 = 1e-5;

/// Where the screen is taken to lie, which decides how far the finger stays away from the glass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScreenPlace {
    /// Where the rig's description has it: real touches may come much earlier.
    Nominal,
    /// Where touches have shown that it lies.
    Measured,
}

impl ScreenPlace {
    /// The tip waits this high above the glass where the arm gets so high, m.
    pub fn above_m(self) -> f64 {
        match self {
            Self::Nominal => ABOVE_NOMINAL_M,
            Self::Measured => ABOVE_MEASURED_M,
        }
    }
}

/// How a touch is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchPace {
    /// Peak joint speed on the way, rad/s.
    pub speed_rad_s: f64,
    /// Speed of the tip while lowering, m/s.
    pub lower_speed_m_s: f64,
    /// Time after the contact until the encoders are read once more.
    pub dwell: Duration,
    /// A contact farther from the target is somebody else's, m.
    pub plausible_m: f64,
}

impl Default for TouchPace {
    fn default() -> Self {
        Self {
            speed_rad_s: 0.6,
            lower_speed_m_s: 0.02,
            dwell: Duration::from_secs(1),
            // The published robot missed by up to 29 mm before any correction was learned.
            plausible_m: 0.06,
        }
    }
}

impl TouchPace {
    /// At a share of the usual speeds.
    pub fn at(self, share: f64) -> Self {
        Self { speed_rad_s: self.speed_rad_s * share, lower_speed_m_s: self.lower_speed_m_s * share, ..self }
    }
}

/// How the hand is held at a touch, other than as its place has it: what other postures at the same place
/// show of the arm's errors the usual one does not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Hold {
    /// Turned about the vertical by this much, rad.
    pub turn_rad: f64,
    /// The top of the finger leaned toward the robot's x and y by about this much, rad.
    pub lean_rad: [f64; 2],
}

impl Hold {
    /// Whether it is held as the place has it.
    pub fn is_usual(&self) -> bool {
        *self == Self::default()
    }

    /// Where the tip's z axis should point.
    fn tool_z(self) -> Option<Direction<Robot>> {
        Direction::new(Vector3::new(self.lean_rad[0], self.lean_rad[1], 1.0))
    }
}

/// Heading of the tip and where its z axis should point, while it comes down.
#[derive(Clone, Copy)]
struct Held {
    heading_rad: f64,
    hold: Hold,
}

/// Postures of one touch.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchPath {
    /// Pixel to be touched.
    pub target: Pixel<Screen>,
    /// The point that is sent.
    pub sent: Point<Robot>,
    /// On the way to the posture above the target, that one last.
    pub approach: Vec<Posture>,
    /// While lowering, [`STEP_M`] apart, from above to the lowest.
    pub lower: Vec<Posture>,
    /// Place of the tip, by the model, in each posture of `lower`.
    pub lower_tip: Vec<Point<Robot>>,
    /// With the tip at the point that is sent.
    pub contact: Posture,
    /// Sign of each chain joint's motion as the tip comes to the point: −1, 0 or 1.
    pub direction: Vec<i8>,
    /// Azimuth of the tip's x axis, rad.
    pub heading_rad: f64,
    /// Cosine of the finger's inclination at the point, 1 straight down.
    pub upright: f64,
    /// Way of the tip from above to the point, m.
    pub drop_m: f64,
    /// Largest turn of a joint in each leg of the approach, rad.
    turns_rad: Vec<f64>,
}

impl TouchPath {
    /// The posture above the target.
    pub fn above(&self) -> &Posture {
        &self.lower[0]
    }

    /// How long it takes, estimated; the contact at the point that is sent.
    pub fn duration(&self, pace: &TouchPace) -> Duration {
        // Each leg comes to rest, and the encoders have to stand still above the target.
        let legs_s: f64 = self.turns_rad.iter().map(|turn| 1.875 * turn / pace.speed_rad_s + 0.15).sum();
        let settle_s = 0.3;
        let lower_s = self.drop_m / pace.lower_speed_m_s + 0.2;
        let up_s = self.contact.distance_rad(self.above()) * 1.875 / pace.speed_rad_s + 0.2;
        Duration::try_from_secs_f64(legs_s + settle_s + lower_s + pace.dwell.as_secs_f64() + up_s)
            .unwrap_or_default()
    }
}

/// A way down.
struct Lowering {
    /// From above to the lowest, [`STEP_M`] apart.
    postures: Vec<Posture>,
    /// So many of the first ones are higher than the tip has to wait.
    dispensable: usize,
}

/// A way to above a target and down that nothing is in.
struct FreeWay {
    lowering: Vec<Posture>,
    approach: Vec<Posture>,
    turns_rad: Vec<f64>,
}

/// Plans touches of one tip. Made once per place of the screen, used for many targets.
#[derive(Clone, Debug)]
pub struct Planner {
    rig: Arc<Rig>,
    /// The tip waits this high above the glass where the arm gets so high, m.
    above_m: f64,
    solver: Solver,
    chain: Chain,
    model: Arc<CollisionModel>,
    floor: Arc<FloorGuard>,
    /// Joints of the arm and its hand: nothing else moves.
    joints: Vec<JointIndex>,
    hand: Vec<JointIndex>,
    /// The arm ready to touch, everything else at home.
    ready: Posture,
    /// The arm above the middle of the screen: solutions near it are taken.
    middle: Posture,
    allowances: Vec<Allowance>,
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
            allowances: vec![],
        };
        let screen = &rig.touchscreen;
        let over_screen = raised(screen.point_at(screen.middle()), MIDDLE_ABOVE_M);
        // Where the screen was measured to lie must not change how the arm is held.
        let solution = planner
            .upright(planner.over_patch(), screen.middle())
            .or_else(|_| planner.upright(over_screen, screen.middle()))?;
        planner.middle = planner.ready.with(planner.solver.joints(), &solution.joints);
        planner.allowances =
            touch_allowances(&planner.model, &planner.floor, &planner.chain, &planner.middle);
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

    /// The touch of a target: the tip is sent to `sent`, from a side, by an arm that stands at `from`.
    ///
    /// # Errors
    /// A sentence that says why it cannot be touched.
    pub fn plan(
        &self,
        target: Pixel<Screen>,
        sent: Point<Robot>,
        side: Side,
        from: &Posture,
    ) -> Result<TouchPath, NoWay> {
        self.plan_held(target, sent, side, Hold::default(), from)
    }

    /// As [`Self::plan`], the hand held in another way than the place has it.
    ///
    /// # Errors
    /// A sentence that says why it cannot be touched so.
    pub fn plan_held(
        &self,
        target: Pixel<Screen>,
        sent: Point<Robot>,
        side: Side,
        hold: Hold,
        from: &Posture,
    ) -> Result<TouchPath, NoWay> {
        let numbers = [target.u_px, target.v_px, sent.coords.x, sent.coords.y, sent.coords.z];
        if !(numbers.iter().all(|number| number.is_finite()) && from.is_finite()) {
            return Err(NoWay::NotANumber);
        }
        let (contact, held) = self.contact(sent, target, hold, from)?;
        let upright = self.inclination(&contact);
        if !hold.is_usual() && upright < LEAST_UPRIGHT {
            return Err(NoWay::Inclined { target, inclined_rad: upright.clamp(-1.0, 1.0).acos() });
        }
        let heading_rad = held.heading_rad;
        let down = self.lowering(target, sent, side, &contact, held)?;
        let FreeWay { lowering, approach, turns_rad } = self.highest_free(target, from, down)?;
        let tips: Vec<Point<Robot>> = lowering.iter().map(|posture| self.tip(posture)).collect();
        Ok(TouchPath {
            target,
            sent,
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

    fn tip(&self, posture: &Posture) -> Point<Robot> {
        Point::from(nalgebra::Point3::from(self.chain.robot_from_tip_in(posture).translation_m()))
    }

    /// The way down from as high as it is free, and a free way to there.
    fn highest_free(&self, target: Pixel<Screen>, from: &Posture, down: Lowering) -> Result<FreeWay, NoWay> {
        let Lowering { postures, dispensable } = down;
        let mut refused = Err(NoWay::NotANumber);
        let mut tried = None;
        for skip in [0, dispensable / 2, dispensable] {
            if tried.replace(skip) == Some(skip) {
                continue;
            }
            let lowering = &postures[skip..];
            let free = self
                .check_lowering(target, lowering)
                .and_then(|()| self.approach(target, from, &lowering[0]));
            match free {
                Ok((approach, turns_rad)) => {
                    return Ok(FreeWay { lowering: lowering.to_vec(), approach, turns_rad });
                }
                Err(why) => refused = Err(why),
            }
        }
        refused
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
        target: Pixel<Screen>,
        sent: Point<Robot>,
        side: Side,
        contact: &Posture,
        held: Held,
    ) -> Result<Lowering, NoWay> {
        let glass_m = self.rig.touchscreen.point_at(target).coords.z;
        let upper_m = sent.coords.z.max(glass_m) - sent.coords.z;
        let (top_m, least_m) = (upper_m + self.above_m, upper_m + ABOVE_MEASURED_M);
        let bottom_m = sent.coords.z - sent.coords.z.min(glass_m) + BELOW_M;
        let at = |height_m: f64| on_the_way(sent, side, held.heading_rad, height_m);
        let steps = |length_m: f64| (length_m / STEP_M).ceil() as usize;
        let up = self.follow(contact, steps(top_m), held.hold, |step| at(top_m.min(step as f64 * STEP_M)));
        let least = steps(least_m);
        if up.len() < least {
            return Err(NoWay::TooLow { target, high_m: up.len() as f64 * STEP_M });
        }
        let down =
            self.follow(contact, steps(bottom_m), held.hold, |step| at(-bottom_m.min(step as f64 * STEP_M)));
        let allowed_m = self.rig.gate.floor_m + FLOOR_MARGIN_M;
        let above_floor =
            |posture: &&Posture| self.floor.lowest(posture).is_none_or(|(_, height_m)| height_m >= allowed_m);
        let down: Vec<Posture> = down.iter().take_while(above_floor).cloned().collect();
        let below_m = down.last().map_or(0.0, |lowest| sent.coords.z - self.tip(lowest).coords.z);
        if below_m < LEAST_BELOW_M {
            let above_floor_m = sent.coords.z - self.rig.gate.floor_m;
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

    /// Nothing but the finger touches, and nothing but the screen.
    fn check_lowering(&self, target: Pixel<Screen>, lowering: &[Posture]) -> Result<(), NoWay> {
        for posture in lowering.iter().rev().step_by(3).chain([&lowering[0]]) {
            let found = self.model.check_posture(posture, &self.allowances)?;
            if let PostureCheck::Collides { contact, .. } = found {
                return Err(NoWay::Meets { target, a: contact.a_name, b: contact.b_name });
            }
        }
        Ok(())
    }

    /// A free way to the posture above the target, and the largest turn of each of its legs.
    fn approach(
        &self,
        target: Pixel<Screen>,
        from: &Posture,
        above: &Posture,
    ) -> Result<(Vec<Posture>, Vec<f64>), NoWay> {
        let mut barred = None;
        for way in self.ways(from, above) {
            let mut legs = vec![];
            let mut before = from;
            for next in &way {
                legs.push(before.distance_rad(next));
                match self.leg(before, next) {
                    Ok(()) => before = next,
                    Err(reason) => {
                        barred.get_or_insert(reason);
                        legs.clear();
                        break;
                    }
                }
            }
            if !legs.is_empty() {
                return Ok((way, legs));
            }
        }
        Err(NoWay::NotFree { target, leg: barred.unwrap_or(Barred::NoWay) })
    }

    /// Ways to try, the shortest first.
    fn ways(&self, from: &Posture, above: &Posture) -> Vec<Vec<Posture>> {
        let ready = self.ready(from);
        let points = self.hand.iter().all(|joint| (from[*joint] - ready[*joint]).abs() < POINTING_RAD);
        let mut ways = vec![];
        if points {
            ways.push(vec![above.clone()]);
            let (start, end) = (self.tip(from).coords, self.tip(above).coords);
            for (fraction, raise_m) in [(0.5, RAISE_M), (0.0, RAISE_M), (1.0, RAISE_M), (0.5, 2.0 * RAISE_M)]
            {
                let mut via = start + (end - start) * fraction;
                via.z = start.z.max(end.z) + raise_m;
                let (near, target) = (from.toward(above, fraction), Target::Position(Point::from(via)));
                let options = Options { other_starts: 0, ..Options::default() };
                if let Ok(answer) = self.solver.solve_from(&target, &near, &options)
                    && answer.is_reached()
                {
                    ways.push(vec![near.with(self.solver.joints(), &answer.best().joints), above.clone()]);
                }
            }
        }
        // The rest of the way the middle of the screen is above everything.
        let middle = above.with(self.solver.joints(), &self.middle.of(self.solver.joints()));
        let high = ready.toward(&middle, 0.5);
        ways.push(vec![ready.clone(), above.clone()]);
        ways.push(vec![ready.clone(), high.clone(), above.clone()]);
        ways.push(vec![ready, high, middle, above.clone()]);
        ways
    }

    fn leg(&self, from: &Posture, to: &Posture) -> Result<(), Barred> {
        let glass_m = self.rig.touchscreen.corners().iter().map(|corner| corner.coords.z).fold(0.0, f64::max);
        let lower_end_m = self.tip(from).coords.z.min(self.tip(to).coords.z);
        // Where the arm does not get as high as it should wait, it keeps what it can.
        let clearance_m = (lower_end_m - glass_m).clamp(ABOVE_MEASURED_M, self.above_m) - DIP_M;
        let least_m = (glass_m + clearance_m).min(lower_end_m - 1e-4);
        for sample in 1..SAMPLES {
            let height_m = self.tip(&from.toward(to, sample as f64 / SAMPLES as f64)).coords.z;
            if height_m < least_m {
                return Err(Barred::NearGlass);
            }
        }
        match self.model.check_path(from, to, &[]) {
            Ok(PathCheck::Clear { .. }) => Ok(()),
            Ok(PathCheck::Collides { contact, .. }) => {
                Err(Barred::Meets { a: contact.a_name, b: contact.b_name })
            }
            Ok(PathCheck::BeyondLimit { name, why, .. }) => Err(Barred::TooFar { joint: name, why }),
            Err(error) => Err(error.into()),
        }
    }

    /// Signs of the joints' last motion before the point.
    fn direction(&self, lowering: &[Posture], tips: &[Point<Robot>], sent: Point<Robot>) -> Vec<i8> {
        let at = tips.iter().position(|tip| tip.distance_m(&sent) < 0.5 * STEP_M).unwrap_or(tips.len() - 1);
        let before = &lowering[at.saturating_sub(LAST_STEPS)];
        self.chain.joints().iter().map(|joint| sign(lowering[at][*joint] - before[*joint])).collect()
    }
}

/// What may meet while the screen is touched: the part of the hand that hangs lowest in a posture, a
/// finger, may enter the screen, and the table on which it lies, a little.
pub fn touch_allowances(
    model: &CollisionModel,
    floor: &FloorGuard,
    chain: &Chain,
    posture: &Posture,
) -> Vec<Allowance> {
    let hand = chain.joints().last().map(|joint| model.links_moved_by(*joint)).unwrap_or_default();
    let links: Vec<LinkIndex> =
        floor.heights(posture, &hand).first().map(|(link, _)| *link).into_iter().collect();
    let to = |body| Allowance { links: links.clone(), body, depth_m: TOUCH_DEPTH_M };
    vec![to(Body::Touchscreen), to(Body::Table)]
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
