//! The connected robot, or the twin, as the body of a grasp: it leads the arm order by order and waits
//! for pairs of the source.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_grasp::body::{closes, turning};
use plumbline_grasp::tracks::Tracks;
use plumbline_grasp::{Body, Halt, ServoState, Sight};
use plumbline_hardware::joints::{JointState, Unheard};
use plumbline_model::JobContext;
use plumbline_model::robot::collision::{Allowance, Body as Solid, CollisionModel};
use plumbline_model::robot::{JointIndex, Posture, Rig};

use super::heard::{are_merely_late, are_newer, known, unknown};
use super::leg::Leg;
use super::sights::Sights;
use super::tracks::LedTracks;
use crate::robot::{GivenUp, LeadAnswer, LeadOrder, Leader, Reins};

/// Joints that differ by less are the same, rad.
const SAME_RAD: f64 = 5e-4;
/// An order is asked after this often, so that it can be ended.
const ASKED_EVERY: Duration = Duration::from_millis(50);
/// No order takes longer than this while it neither is paused nor waits for joints that were late.
const LONGEST: Duration = Duration::from_secs(60);
/// A pair comes within this time, or the eyes are taken to be blind: eyes that were started anew, on a machine
/// that does much else, need some seconds.
const PAIR_WITHIN: Duration = Duration::from_secs(20);
/// The angles of a moment have been read after this long.
const READ_WITHIN: Duration = Duration::from_secs(1);
/// Joints that this computer was too busy to hear in time are waited for so long, as on a way …
const HEARD_WITHIN: Duration = Duration::from_secs(20);
/// … and those that do not answer at all no longer than this: they may only seem so for a moment.
const SILENT_FOR: Duration = Duration::from_secs(1);
/// After this long it is looked again whether joints have been read anew: a fraction of a cycle of the bus.
const READ_AGAIN: Duration = Duration::from_millis(5);
/// Fingers around a thing may come so much nearer to what it stands on than their shapes say, m: they
/// are softer and thinner than drawn.
const AROUND_DEPTH_M: f64 = 0.012;

/// What an attempt is led with.
#[derive(Clone, Debug)]
pub struct Ropes {
    /// Orders to the arm.
    pub leader: Leader,
    /// Pairs of the source.
    pub sights: Sights,
    /// Pause and end.
    pub reins: Reins,
    /// Since when the eyes are on; `None`: nobody knows.
    pub eyes_on: Option<EyesOn>,
}

/// For how long the eyes have been on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EyesOn {
    /// s…
    pub for_s: f64,
    /// …at this moment.
    pub at: Instant,
}

impl EyesOn {
    /// At another moment, s.
    pub fn seconds_at(&self, when: Instant) -> f64 {
        let later_s = when.saturating_duration_since(self.at).as_secs_f64();
        self.for_s + later_s - self.at.saturating_duration_since(when).as_secs_f64()
    }
}

/// The robot at the other end of the ropes.
pub struct LedBody<'a> {
    rig: Arc<Rig>,
    ropes: Ropes,
    context: &'a dyn JobContext,
    began: Instant,
    pairs: u64,
    /// Joints of hands, and the links that they move.
    hands: Vec<JointIndex>,
    /// Of each hand: its joints, and what its fingers may meet.
    finger_allowances: Vec<(Vec<JointIndex>, Vec<Allowance>)>,
    /// The hand that acts, by its place there: the one whose fingers were sent somewhere last.
    acting: usize,
    /// Fingers that met something before they were where they were sent, and where that was.
    given_way: Vec<(JointIndex, f64)>,
    /// Whether fingers may meet what things stand on.
    may_touch: bool,
    /// When the angles that were given last were read.
    given: Vec<Option<Instant>>,
    /// Where what the joints do is kept, if it is.
    tracks: Option<LedTracks>,
    /// What it is told to do just now, if that is told.
    leg: Option<Leg>,
}

impl<'a> LedBody<'a> {
    /// For the arms of the robot.
    pub fn new(rig: Arc<Rig>, ropes: Ropes, context: &'a dyn JobContext) -> Self {
        let hands: Vec<JointIndex> = rig.arms.iter().flat_map(|arm| arm.hand.iter().copied()).collect();
        let bodies = CollisionModel::of_rig(&rig);
        let allowances = |hand: &[JointIndex]| {
            let mut links: Vec<_> = hand.iter().flat_map(|joint| bodies.links_moved_by(*joint)).collect();
            links.sort_unstable();
            links.dedup();
            let to = |body| Allowance { links: links.clone(), body, depth_m: AROUND_DEPTH_M };
            vec![to(Solid::Table), to(Solid::Touchscreen)]
        };
        let finger_allowances =
            rig.arms.iter().map(|arm| (arm.hand.clone(), allowances(&arm.hand))).collect();
        Self {
            rig,
            ropes,
            context,
            began: Instant::now(),
            pairs: 0,
            hands,
            finger_allowances,
            acting: 0,
            given_way: vec![],
            may_touch: false,
            given: vec![],
            tracks: None,
            leg: None,
        }
    }

    /// From now on what the joints do goes into these tracks.
    pub fn keep_tracks(&mut self, tracks: Tracks) -> LedTracks {
        let tracks = LedTracks::begin(tracks, &self.ropes, self.began);
        self.tracks.insert(tracks).clone()
    }

    /// What follows is told as it goes on.
    pub fn begin_leg(&mut self, doing: &'static str, share: [f64; 2]) {
        let leg = Leg::new(doing, share);
        leg.report(self.context);
        self.leg = Some(leg);
    }

    /// For one hand of the robot, which acts before its fingers are sent anywhere.
    pub fn of_arm(mut self, arm: &str) -> Self {
        self.acting = self.rig.arms.iter().position(|known| known.name == arm).unwrap_or(self.acting);
        self
    }

    /// The hand whose fingers are among these goals acts.
    fn acts(&mut self, goals: &[(JointIndex, f64)]) {
        let among = |(hand, _): &(Vec<JointIndex>, _)| goals.iter().any(|(joint, _)| hand.contains(joint));
        self.acting = self.finger_allowances.iter().position(among).unwrap_or(self.acting);
    }

    /// How the joints are.
    fn state(&mut self) -> Result<Arc<JointState>, Halt> {
        match self.carry_out(LeadOrder::State)? {
            LeadAnswer::State(state) => Ok(state),
            _ => Err(Halt::Lost("the arm answered something else".to_owned())),
        }
    }

    /// The same once all joints are heard: those that this computer is too busy to hear in time are waited for, and
    /// nothing is moved meanwhile. Those that do not answer at all are waited for but a moment.
    fn state_heard(&mut self) -> Result<Arc<JointState>, Halt> {
        let began = Instant::now();
        let mut silent_since = None;
        loop {
            let state = self.state()?;
            if state.unknown.is_empty() || began.elapsed() > HEARD_WITHIN {
                return Ok(state);
            }
            if are_merely_late(&state) {
                silent_since = None;
            } else if silent_since.get_or_insert_with(Instant::now).elapsed() >= SILENT_FOR {
                return Ok(state);
            }
            if state.stopped {
                return Err(Halt::Stopped);
            }
            self.may_go_on()?;
            std::thread::sleep(ASKED_EVERY);
        }
    }

    /// The same, unless it must not go on: STOP, or somebody wants it to end.
    fn state_to_go_on(&mut self) -> Result<Arc<JointState>, Halt> {
        self.may_go_on()?;
        let state = self.state()?;
        if state.stopped { Err(Halt::Stopped) } else { Ok(state) }
    }

    fn may_go_on(&self) -> Result<(), Halt> {
        let cancelled = self.ropes.reins.is_ended() || self.context.checkpoint().is_err();
        if cancelled { Err(Halt::Cancelled) } else { Ok(()) }
    }

    /// Hands an order over and waits for what becomes of it.
    fn carry_out(&self, order: LeadOrder) -> Result<LeadAnswer, Halt> {
        self.ropes.leader.order(order)?;
        let mut left = LONGEST;
        loop {
            if let Some(tracks) = &self.tracks {
                tracks.take();
            }
            if let Some(answer) = self.ropes.leader.answer(ASKED_EVERY)? {
                return Ok(answer);
            }
            if !self.ropes.reins.is_tight() && !self.ropes.leader.waits() {
                left = left.saturating_sub(ASKED_EVERY);
                if let Some(leg) = &self.leg {
                    leg.goes_on(ASKED_EVERY);
                    leg.report(self.context);
                }
            }
            if left.is_zero() {
                return Err(self.call_off(Halt::Lost("the arm does not come to its goal".to_owned())));
            }
            if let Err(ended) = self.may_go_on() {
                return Err(self.call_off(ended));
            }
        }
    }

    /// The arm holds; what becomes of the order under way is of no interest any more.
    fn call_off(&self, why: Halt) -> Halt {
        if self.ropes.leader.order(LeadOrder::Hold).is_ok() {
            // Its own answer, or that of the order that it ended.
            let _ = self.ropes.leader.answer(READ_WITHIN);
        }
        why
    }

    /// Joints of a posture that are elsewhere than they were sent before.
    fn turning(&mut self, way: &[Posture]) -> Result<Vec<Vec<(JointIndex, f64)>>, Halt> {
        let from = self.commanded()?;
        let joints = turning(&self.rig, &from, way, SAME_RAD);
        Ok(way.iter().map(|to| joints.iter().map(|joint| (*joint, to[*joint])).collect()).collect())
    }

    fn let_touch(&mut self, may: bool) -> Result<(), Halt> {
        if may != self.may_touch {
            let own = self.finger_allowances.get(self.acting).filter(|_| may);
            let allowed = own.map(|(_, allowed)| allowed.clone()).unwrap_or_default();
            self.carry_out(LeadOrder::MayTouch(allowed))?;
            self.may_touch = may;
        }
        Ok(())
    }
}

impl Body for LedBody<'_> {
    fn rig(&self) -> &Arc<Rig> {
        &self.rig
    }

    fn now_s(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    /// Each time of readings that are newer than those of the time before: who compares the two would take an
    /// arm that was not read in between for one that stands.
    fn servos(&mut self) -> Result<Vec<ServoState>, Halt> {
        let began = Instant::now();
        loop {
            let state = self.state_heard()?;
            let servos = state.joints.iter().map(|reading| known(&state, reading)).collect::<Option<_>>();
            let servos = servos.ok_or_else(|| unknown(&self.rig, &state))?;
            let read: Vec<_> = state.joints.iter().map(|reading| reading.read_at).collect();
            if are_newer(&read, &self.given) {
                self.given = read;
                return Ok(servos);
            }
            if began.elapsed() > HEARD_WITHIN {
                let what = Unheard::TooBusy.advice();
                return Err(Halt::Lost(format!("the joints are not read any more: {what}")));
            }
            std::thread::sleep(READ_AGAIN);
        }
    }

    fn commanded(&mut self) -> Result<Posture, Halt> {
        let state = self.state()?;
        let commanded = state.commanded.clone().ok_or_else(|| unknown(&self.rig, &state))?;
        let (joints, angles_rad): (Vec<_>, Vec<_>) = self.given_way.iter().copied().unzip();
        Ok(commanded.with(&joints, &angles_rad))
    }

    fn follow(&mut self, way: &[Posture], speed_rad_s: f64) -> Result<(), Halt> {
        self.state_to_go_on()?;
        let from = self.commanded()?;
        if let Some(leg) = &mut self.leg {
            leg.sets_out(&from, way, speed_rad_s);
        }
        let way = self.turning(way)?;
        let goals = way.last().cloned().unwrap_or_default();
        if goals.is_empty() {
            return Ok(());
        }
        self.acts(&goals);
        if closes(&self.hands, &from, &goals) {
            self.let_touch(true)?;
            self.carry_out(LeadOrder::Close { goals: goals.clone() })?;
            self.given_way.retain(|(joint, _)| goals.iter().all(|(other, _)| other != joint));
            self.given_way.extend(goals);
            return Ok(());
        }
        let opens = goals.iter().any(|(joint, _)| self.hands.contains(joint));
        if opens {
            self.given_way.retain(|(joint, _)| goals.iter().all(|(other, _)| other != joint));
        }
        let arm_moves = goals.iter().any(|(joint, _)| !self.hands.contains(joint));
        self.carry_out(LeadOrder::Follow { way, speed_rad_s })?;
        // The hand has left what the thing stood on, or it never was there.
        if arm_moves { self.let_touch(false) } else { Ok(()) }
    }

    fn grip(&mut self) -> Result<(), Halt> {
        if self.given_way.is_empty() {
            return Ok(());
        }
        self.carry_out(LeadOrder::Close { goals: self.given_way.clone() }).map(drop)
    }

    fn wait(&mut self, duration_s: f64) -> Result<(), Halt> {
        let mut left = plumbline_model::duration::seconds(duration_s).unwrap_or_default();
        loop {
            // Before it is asked whether it has ended: what ends it lets go of the reins after that, and an arm that
            // held must not go on in between.
            let paused = self.ropes.reins.is_tight();
            self.state_to_go_on()?;
            if left.is_zero() && !paused {
                return Ok(());
            }
            let nap = if paused { ASKED_EVERY } else { left.min(ASKED_EVERY) };
            std::thread::sleep(nap);
            if !paused {
                left = left.saturating_sub(nap);
            }
        }
    }

    fn look(&mut self) -> Result<Sight, Halt> {
        self.wait(0.0)?;
        let since = Instant::now();
        let frame = loop {
            self.state_to_go_on()?;
            if let Some(frame) = self.ropes.sights.after(since, ASKED_EVERY) {
                break frame;
            }
            if since.elapsed() > PAIR_WITHIN {
                let why = format!("none came within {} s: look whether they are open", PAIR_WITHIN.as_secs());
                return Err(Halt::Blind(why));
            }
        };
        let posture = self.posture_at(frame.stamp.captured_at)?;
        self.pairs += 1;
        Ok(Sight {
            left: frame.left,
            right: frame.right,
            posture,
            at_s: frame.stamp.captured_at.saturating_duration_since(self.began).as_secs_f64(),
            eyes_on_s: self.ropes.eyes_on.map(|eyes_on| eyes_on.seconds_at(frame.stamp.captured_at)),
            seq: self.pairs,
        })
    }
}

impl LedBody<'_> {
    /// Until the arm has moved once more, fingers may meet what things stand on.
    ///
    /// # Errors
    /// When there is nobody to tell.
    pub fn let_fingers_touch(&mut self) -> Result<(), Halt> {
        self.let_touch(true)
    }

    /// Where the joints were when a pair was captured.
    fn posture_at(&mut self, when: Instant) -> Result<Posture, Halt> {
        loop {
            if let LeadAnswer::At(Some(posture)) = self.carry_out(LeadOrder::At(when))? {
                return Ok(posture);
            }
            if when.elapsed() > READ_WITHIN {
                let state = self.state_heard()?;
                // Where the head stands decides where everything is that the eyes see.
                let knows = state.knows(self.rig.eyes.pan) && state.knows(self.rig.eyes.tilt);
                return state.measured.clone().filter(|_| knows).ok_or_else(|| unknown(&self.rig, &state));
            }
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

impl From<GivenUp> for Halt {
    fn from(why: GivenUp) -> Self {
        match why {
            GivenUp::Stopped => Self::Stopped,
            GivenUp::Lost(what) => Self::Lost(what),
            GivenUp::Refused(what) => Self::Refused(what),
        }
    }
}
