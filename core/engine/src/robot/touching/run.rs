//! The stages of one touch.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_hardware::joints::{
    HoldReason, JointState, Motion, Move, MoveId, MoveOutcome, Pace, Setpoint, SetpointKind, Touch,
    TouchSource,
};
use plumbline_model::robot::servo::TICK_RAD;
use plumbline_model::robot::{JointIndex, Posture, Rig};
use plumbline_model::{Pixel, Point};

use super::hand::Hand;
use super::lowering::Descent;
use crate::robot::touch_order::{TouchMeasurement, TouchOrder, TouchRun, TouchStage};
use crate::robot::unable::Interrupted;

/// Above the target the encoders have to stand still for this long.
const STILL: Duration = Duration::from_millis(150);
/// A joint that changes by fewer ticks stands still: an encoder may flicker by one.
const STILL_TICKS: f64 = 1.5;
/// They get this long.
const SETTLE: Duration = Duration::from_secs(3);
/// Share of the gate's load at which lowering ends: the gate itself would stop the arm.
const LOAD_SHARE: f64 = 0.9;
/// A finger that stays so far above the lowest place that it was sent to, by its encoders, was stopped, m…
const STAYED_ABOVE_M: f64 = 0.006;
/// …and so was one whose servos got so much more load on the way, a share of their stall torque.
const ROSE: f64 = 0.2;
/// A goal on the way down is followed for this long when nothing newer comes.
const VALID: Duration = Duration::from_millis(300);
/// After the last goal the arm gets this long to reach the lowest place.
const LAST: Duration = Duration::from_millis(800);
/// Angles around a contact have been read after this long.
const READ: Duration = Duration::from_millis(60);
/// What is not known of a contact after this long never will be.
const READ_AT_LAST: Duration = Duration::from_millis(800);
/// Joints nearer to their goal need not move, rad.
const THERE_RAD: f64 = 5e-4;
/// An arm that holds is believed so many cycles after it was told to follow.
const CYCLES: u64 = 4;

/// What a look at a touch leads to; `Err`: it was interrupted, and why.
pub enum Step {
    /// Nothing new.
    Same,
    /// A new stage.
    Next,
    /// It is over.
    End(TouchRun),
}

type Stepped = Result<Step, Interrupted>;

enum Stage {
    Approaching { next: usize, moving: Option<MoveId> },
    Settling { since: Instant, still: Still },
    Lowering(Down),
    Dwelling { down: Down, measured: Box<TouchMeasurement>, since: Instant, read: bool },
    Retreating { moving: Option<MoveId>, end: TouchRun },
}

/// Since when which angles have not changed.
struct Still {
    since: Instant,
    angles_rad: Vec<Option<f64>>,
}

/// On the way down.
#[derive(Clone, Copy)]
struct Down {
    since: Instant,
    /// Number of the bus's cycle in which it began.
    cycle: u64,
    /// Largest load of the chain's joints when it began, a share of the stall torque.
    load: f64,
}

/// A touch that is under way.
pub struct Run {
    order: TouchOrder,
    stage: Stage,
    /// All joints that may move.
    joints: Vec<JointIndex>,
    /// Joints between base and tip.
    chain: Vec<JointIndex>,
    descent: Descent,
    source: Box<dyn TouchSource>,
    /// Refusals up to this number are older than the touch.
    refusals: u64,
}

impl Run {
    pub fn new(
        rig: &Rig,
        order: TouchOrder,
        source: Box<dyn TouchSource>,
        refusals: u64,
        _now: Instant,
    ) -> Result<Self, Interrupted> {
        let unknown = || Interrupted::NoArm(order.tip.clone());
        let joints = joints_of(rig, &order.tip).ok_or_else(unknown)?;
        let chain = rig.chain(&order.tip).map_err(|_| unknown())?.joints().to_vec();
        let descent = Descent::new(&order).ok_or(Interrupted::NotDown)?;
        let stage = Stage::Approaching { next: 0, moving: None };
        Ok(Self { order, stage, joints, chain, descent, source, refusals })
    }

    pub fn order(&self) -> &TouchOrder {
        &self.order
    }

    pub fn stage(&self) -> TouchStage {
        match &self.stage {
            Stage::Approaching { .. } => TouchStage::Approaching,
            Stage::Settling { .. } => TouchStage::Settling,
            Stage::Lowering(_) => TouchStage::Lowering,
            Stage::Dwelling { .. } => TouchStage::Dwelling,
            Stage::Retreating { .. } => TouchStage::Retreating,
        }
    }

    /// For people: "touch 35: lowering".
    pub fn title(&self) -> String {
        format!("touch {}: {}", self.order.number, self.stage().name())
    }

    /// Looks at the arm and the screen, and goes on.
    pub fn step(&mut self, hand: &mut dyn Hand, now: Instant) -> Stepped {
        let state = self.checked_state(hand)?;
        match &mut self.stage {
            Stage::Approaching { .. } => self.approach(hand, &state, now),
            Stage::Settling { .. } => self.settle(hand, &state, now),
            Stage::Lowering(down) => {
                let down = *down;
                self.lower(hand, &state, down, now)
            }
            Stage::Dwelling { .. } => self.dwell(hand, &state, now),
            Stage::Retreating { moving, end } => match *moving {
                Some(id) if !has_arrived(&state, id)? => Ok(Step::Same),
                _ => Ok(Step::End(end.clone())),
            },
        }
    }

    /// The operator does not want it any more.
    pub fn abandon(&mut self, hand: &dyn Hand) -> Stepped {
        let end = TouchRun::Missed("The touch was left out.".to_owned());
        match &self.stage {
            Stage::Approaching { moving, .. } => {
                if moving.is_some() {
                    hand.arm()?.hold()?;
                }
                Ok(Step::End(end))
            }
            Stage::Settling { .. } => Ok(Step::End(end)),
            Stage::Lowering(_) | Stage::Dwelling { .. } => self.retreat(hand, end),
            Stage::Retreating { .. } => Ok(Step::Same),
        }
    }

    /// The newest state, unless it says that the touch cannot go on.
    fn checked_state(&self, hand: &dyn Hand) -> Result<Arc<JointState>, Interrupted> {
        let state = state_that_may_move(hand, self.refusals, &self.chain)?;
        let down = match &self.stage {
            Stage::Lowering(down) | Stage::Dwelling { down, .. } => Some(down),
            _ => None,
        };
        if let (Some(down), Motion::Holding(reason)) = (down, &state.motion)
            && state.stamp.seq > down.cycle + CYCLES
            && !matches!(reason, HoldReason::JogEnded | HoldReason::Asked | HoldReason::Arrived)
        {
            return Err(reason.clone().into());
        }
        Ok(state)
    }

    fn approach(&mut self, hand: &mut dyn Hand, state: &JointState, now: Instant) -> Stepped {
        let Stage::Approaching { next, moving } = &mut self.stage else { return Ok(Step::Same) };
        if let Some(id) = *moving {
            if !has_arrived(state, id)? {
                return Ok(Step::Same);
            }
            (*next, *moving) = (*next + 1, None);
        }
        while let Some(posture) = self.order.approach.get(*next) {
            if let Some(id) = go(hand, state, posture, &self.joints, self.order.speed_rad_s)? {
                *moving = Some(id);
                return Ok(Step::Same);
            }
            *next += 1;
        }
        let still = Still { since: now, angles_rad: self.angles_rad(state) };
        self.stage = Stage::Settling { since: now, still };
        Ok(Step::Next)
    }

    fn settle(&mut self, hand: &mut dyn Hand, state: &JointState, now: Instant) -> Stepped {
        let angles_rad = self.angles_rad(state);
        let ticks_rad: Vec<f64> = self.chain.iter().map(|joint| tick_rad(hand.rig(), *joint)).collect();
        let Stage::Settling { since, still } = &mut self.stage else { return Ok(Step::Same) };
        let (since, waited) = (*since, now.saturating_duration_since(*since));
        let moved = still.angles_rad.iter().zip(&angles_rad).zip(&ticks_rad).any(|((before, now), tick)| {
            match (before, now) {
                (Some(before), Some(now)) => (now - before).abs() > STILL_TICKS * tick,
                (None, None) => false,
                _ => true,
            }
        });
        if moved {
            *still = Still { since: now, angles_rad };
        }
        if now.saturating_duration_since(still.since) < STILL && waited < SETTLE {
            return Ok(Step::Same);
        }
        if waited >= SETTLE {
            hand.warn(format!(
                "Touch {}: the arm did not stand still within {} s above the target; it is lowered all the same. Look whether a servo trembles.",
                self.order.number,
                SETTLE.as_secs()
            ));
        }
        // A palm or a sleeve on the screen would be taken for the finger.
        let early = self.newest()?.filter(|contact| contact.is_down || contact.at >= since);
        if early.is_some() {
            return Ok(Step::End(TouchRun::Missed(
                "Something touched the screen before the finger was lowered. Keep the screen free."
                    .to_owned(),
            )));
        }
        hand.allow_touch(&self.order);
        let down = Down { since: now, cycle: state.stamp.seq, load: self.load(state) };
        self.stage = Stage::Lowering(down);
        self.lower(hand, state, down, now).map(|_| Step::Next)
    }

    fn lower(&mut self, hand: &mut dyn Hand, state: &JointState, down: Down, now: Instant) -> Stepped {
        if let Some(contact) = self.newest()?.filter(|contact| contact.at >= down.since) {
            return self.felt(hand, state, down, contact, now);
        }
        let limit = LOAD_SHARE * hand.rig().gate.load;
        let heavy = state.joints.iter().filter(|reading| self.joints.contains(&reading.joint));
        if let Some((joint, load)) = heavy
            .filter_map(|reading| Some((reading.joint, reading.load?.abs())))
            .find(|(_, load)| *load > limit)
        {
            let name = hand.rig().servo_of(joint).map_or("a joint", |servo| servo.title.as_str());
            let end = TouchRun::Missed(format!(
                "{name} pushed against something with {:.0} % of its strength before the screen felt a touch. Look whether the screen works and what is in the way.",
                load * 100.0
            ));
            return self.retreat(hand, end);
        }
        let lasted = now.saturating_duration_since(down.since);
        let whole = Duration::try_from_secs_f64(self.descent.length_m() / self.order.lower_speed_m_s)
            .unwrap_or(Duration::MAX);
        if lasted >= whole.saturating_add(LAST) {
            let end = match self.pushes(state, down, hand.rig()) {
                Some(why) => TouchRun::Missed(why),
                None => TouchRun::MetNothing,
            };
            return self.retreat(hand, end);
        }
        let posture = self.descent.at(lasted.as_secs_f64() * self.order.lower_speed_m_s);
        self.follow(hand, &posture, VALID)?;
        Ok(Step::Same)
    }

    /// Whether the finger that should be at its lowest place pushes on something that the screen does not feel.
    fn pushes(&self, state: &JointState, down: Down, rig: &Rig) -> Option<String> {
        let chain = rig.chain(&self.order.tip).ok()?;
        let lowest = chain.robot_from_tip_in(self.order.lower.last()?).translation_m();
        let stands = chain.robot_from_tip_in(state.measured.as_ref()?).translation_m();
        let (above_m, rose) = (stands.z - lowest.z, self.load(state) - down.load);
        (above_m > STAYED_ABOVE_M || rose > ROSE).then(|| {
            format!(
                "The finger stayed {:.0} mm above where it was sent, with {:.0} % more load than in the air: it pushes on something that the screen does not feel. Look whether the screen works and what is in the way.",
                above_m.max(0.0) * 1e3,
                rose.max(0.0) * 100.0
            )
        })
    }

    /// Largest load of the chain's joints, a share of the stall torque; 0 where none is known.
    fn load(&self, state: &JointState) -> f64 {
        let of_chain = state.joints.iter().filter(|reading| self.chain.contains(&reading.joint));
        of_chain.filter_map(|reading| reading.load).fold(0.0, |most, load| most.max(load.abs()))
    }

    /// The screen felt something while the finger was lowered.
    fn felt(
        &mut self,
        hand: &mut dyn Hand,
        state: &JointState,
        down: Down,
        contact: Touch,
        now: Instant,
    ) -> Stepped {
        let (u_px, v_px) = (contact.u_px - self.order.target.u_px, contact.v_px - self.order.target.v_px);
        let far_px = u_px.hypot(v_px);
        if far_px.is_nan() || far_px > self.order.plausible_px {
            let end = TouchRun::Missed(format!(
                "Something touched the screen {far_px:.0} px from the target, which cannot be the finger. Keep the screen free, or measure where it lies."
            ));
            return self.retreat(hand, end);
        }
        // The goals stay as they are, so that the arm neither pushes on nor sinks.
        let goals = state.commanded.as_ref().ok_or(Interrupted::NoGoals)?;
        self.follow(hand, goals, self.order.dwell + Duration::from_secs(1))?;
        let of = |value: fn(&plumbline_hardware::joints::JointReading) -> Option<f64>| -> Vec<Option<f64>> {
            self.chain.iter().map(|joint| state.of(*joint).and_then(value)).collect()
        };
        let moved = contact.at.saturating_duration_since(down.since);
        let way_m = moved.as_secs_f64() * self.order.lower_speed_m_s;
        let connected = hand.connected_at().map(|since| contact.at.saturating_duration_since(since));
        let nothing = vec![None; self.chain.len()];
        let measured = TouchMeasurement {
            pixel: Pixel::new(contact.u_px, contact.v_px),
            at: contact.at,
            commanded_rad: nothing.clone(),
            commanded_tip: None,
            encoder_rad: nothing.clone(),
            later_encoder_rad: nothing,
            direction: self.descent.direction(way_m, &self.chain),
            temperature_c: of(|reading| reading.temperature_c),
            load: of(|reading| reading.load),
            move_secs: moved.as_secs_f64(),
            connected_secs: connected.unwrap_or_default().as_secs_f64(),
        };
        self.stage = Stage::Dwelling { down, measured: Box::new(measured), since: now, read: false };
        Ok(Step::Next)
    }

    fn dwell(&mut self, hand: &mut dyn Hand, state: &JointState, now: Instant) -> Stepped {
        let later_rad = self.angles_rad(state);
        let Stage::Dwelling { measured, since, read, .. } = &mut self.stage else { return Ok(Step::Same) };
        let lasted = now.saturating_duration_since(*since);
        if !*read && lasted >= READ {
            let (commanded, encoders) = hand.arm()?.at(measured.at);
            // A servo that answers late is waited for.
            *read = (commanded.is_some() && encoders.is_some()) || lasted >= READ_AT_LAST;
            if *read {
                let angles =
                    |posture: &Posture| self.chain.iter().map(|joint| Some(posture[*joint])).collect();
                let nothing = || vec![None; self.chain.len()];
                measured.commanded_rad = commanded.as_ref().map_or_else(nothing, angles);
                measured.encoder_rad = encoders.as_ref().map_or_else(nothing, angles);
                let tip = |posture| Some(hand.rig().chain(&self.order.tip).ok()?.robot_from_tip_in(posture));
                measured.commanded_tip = commanded
                    .as_ref()
                    .and_then(tip)
                    .map(|tip| Point::from(nalgebra::Point3::from(tip.translation_m())));
            }
        }
        if !*read || lasted < self.order.dwell {
            return Ok(Step::Same);
        }
        measured.later_encoder_rad = later_rad;
        let end = TouchRun::Touched(measured.clone());
        self.retreat(hand, end)
    }

    fn retreat(&mut self, hand: &dyn Hand, end: TouchRun) -> Stepped {
        let state = self.checked_state(hand)?;
        let moving = go(hand, &state, &self.order.lower[0], &self.chain, self.order.speed_rad_s)?;
        self.stage = Stage::Retreating { moving, end };
        Ok(Step::Next)
    }

    fn follow(&self, hand: &dyn Hand, posture: &Posture, valid_for: Duration) -> Result<(), Interrupted> {
        let joints = self.chain.iter().map(|joint| (*joint, posture[*joint])).collect();
        let setpoint = Setpoint { kind: SetpointKind::Position, joints, valid_for };
        Ok(hand.arm()?.follow(setpoint)?)
    }

    fn newest(&mut self) -> Result<Option<Touch>, Interrupted> {
        Ok(self.source.newest()?)
    }

    /// Encoders of the chain.
    fn angles_rad(&self, state: &JointState) -> Vec<Option<f64>> {
        self.chain.iter().map(|joint| state.of(*joint).and_then(|reading| reading.angle_rad)).collect()
    }
}

/// The newest state, unless it says that the arm cannot go on. Refusals up to a number are older than what is done.
pub(super) fn state_that_may_move(
    hand: &dyn Hand,
    refusals: u64,
    chain: &[JointIndex],
) -> Result<Arc<JointState>, Interrupted> {
    let state = hand.state().ok_or(Interrupted::NoAnswer)?;
    if let Some(reason) = &state.gone {
        return Err(Interrupted::Told(reason.clone()));
    }
    if hand.is_stopped() || state.stopped {
        return Err(Interrupted::Stopped);
    }
    if let Some((number, refusal)) = &state.refusal
        && *number > refusals
    {
        return Err(refusal.clone().into());
    }
    let limp = |joint: &&JointIndex| state.of(**joint).is_some_and(|r| r.torque_on == Some(false));
    if let Some(joint) = chain.iter().find(limp) {
        let name = hand.rig().servo_of(*joint).map_or("a joint", |servo| servo.title.as_str());
        return Err(Interrupted::Limp(name.to_owned()));
    }
    Ok(state)
}

/// Begins the move of some joints to a posture; `None` when they are there.
pub(super) fn go(
    hand: &dyn Hand,
    state: &JointState,
    posture: &Posture,
    joints: &[JointIndex],
    speed_rad_s: f64,
) -> Result<Option<MoveId>, Interrupted> {
    let known = state.measured.as_ref().zip(state.commanded.as_ref());
    let (present, commanded) = known.ok_or(Interrupted::Unknown)?;
    let away = |joint: &&JointIndex| (commanded[**joint] - posture[**joint]).abs() > THERE_RAD;
    let goals: Vec<(JointIndex, f64)> =
        joints.iter().filter(away).map(|joint| (*joint, posture[*joint])).collect();
    if goals.is_empty() {
        return Ok(None);
    }
    let end = present.with(joints, &posture.of(joints));
    hand.paths().check(present, &end)?;
    let pace = Pace::PeakSpeed(speed_rad_s.min(hand.rig().gate.speed_rad_s));
    Ok(Some(hand.arm()?.begin(Move { goals, pace })?))
}

/// Whether a move is done; `Err`: it will never be.
pub(super) fn has_arrived(state: &JointState, id: MoveId) -> Result<bool, Interrupted> {
    match state.outcome(id) {
        None => Ok(false),
        Some(MoveOutcome::Arrived { .. }) => Ok(true),
        Some(MoveOutcome::Refused(refusal)) => Err(refusal.clone().into()),
        Some(MoveOutcome::Held(reason)) => Err(reason.clone().into()),
        Some(MoveOutcome::Replaced) => Err(Interrupted::Moved),
    }
}

/// The smallest turn that a joint's encoder tells, rad.
fn tick_rad(rig: &Rig, joint: JointIndex) -> f64 {
    let ratio = rig.servo_of(joint).map_or(1.0, |servo| servo.ratio.abs());
    TICK_RAD / ratio
}

/// Joints of the arm of a tip, its hand included.
pub(super) fn joints_of(rig: &Rig, tip: &str) -> Option<Vec<plumbline_model::robot::JointIndex>> {
    let arm = rig.arms.iter().find(|arm| arm.tips.iter().any(|known| known.link == tip))?;
    Some([arm.joints.clone(), arm.hand.clone()].concat())
}
