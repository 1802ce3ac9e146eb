//! A made-up arm and a made-up screen.

use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use plumbline_hardware::joints::{
    Grip, HoldReason, JointReading, JointState, Motion, Move, MoveId, MoveOutcome, Refusal, ScreenGone,
    Setpoint, Touch, TouchSource,
};
use plumbline_model::robot::{Chain, JointIndex, Posture, Rig};
use plumbline_model::touch_plan::Side;
use plumbline_model::{Pixel, Point, Robot, Stamp};

use crate::motion::{Planner, ScreenPlace, TouchPace, Wanted};
use crate::robot::arm::{Arm, Census};
use crate::robot::view::Connection;
use crate::robot::{Switches, TouchOrder, TouchRun, TouchStage, Worker};
use crate::twin::{TwinDesk, TwinEyesPlug};

pub const TARGET: [f64; 2] = [960.0, 700.0];
/// The made-up encoders read this much beside the goals, rad.
pub const SAG_RAD: f64 = 0.0007;
const TICK: Duration = Duration::from_millis(5);
const PATIENCE: Duration = Duration::from_secs(30);

/// What reached the arm.
#[derive(Clone, Debug, PartialEq)]
pub enum Asked {
    Move(Move),
    Follow(Setpoint),
    Hold,
}

impl Asked {
    pub fn joints(&self) -> Vec<JointIndex> {
        match self {
            Self::Move(motion) => motion.goals.iter().map(|(joint, _)| *joint).collect(),
            Self::Follow(setpoint) => setpoint.joints.iter().map(|(joint, _)| *joint).collect(),
            Self::Hold => vec![],
        }
    }
}

/// The made-up arm: it is at once where it is sent.
pub struct Made {
    pub asked: Vec<Asked>,
    pub followed: Vec<Posture>,
    pub commanded: Posture,
    pub motion: Motion,
    pub refusal: Option<(u64, Refusal)>,
    /// What a move that was begun comes to; `None`: it never ends.
    pub outcome: Option<MoveOutcome>,
    pub refuse: Option<Refusal>,
    pub gone: Option<String>,
    pub load: f64,
    pub torque_on: bool,
    pub tremble_rad: f64,
    /// Encoders are read so long after the moment.
    pub silent: Duration,
    outcomes: Vec<(MoveId, MoveOutcome)>,
    past: Vec<(Instant, Posture)>,
    now: Instant,
    seq: u64,
}

struct FakeArm {
    made: Arc<Mutex<Made>>,
    rig: Arc<Rig>,
}

impl FakeArm {
    fn made(&self) -> MutexGuard<'_, Made> {
        self.made.lock().expect("no test panics in here")
    }
}

impl Arm for FakeArm {
    fn shorten_answers(&self) -> Result<(), Refusal> {
        Ok(())
    }

    fn state(&self) -> Option<Arc<JointState>> {
        let made = self.made();
        let sign = if made.seq.is_multiple_of(2) { 1.0 } else { -1.0 };
        let measured = sagging(&made.commanded, SAG_RAD + sign * made.tremble_rad);
        let reading = |servo: &plumbline_model::robot::Servo| JointReading {
            angle_rad: Some(measured[servo.joint]),
            goal_rad: Some(made.commanded[servo.joint]),
            speed_rad_s: Some(0.0),
            load: Some(made.load),
            temperature_c: Some(31.0),
            voltage_v: Some(12.0),
            torque_on: Some(made.torque_on),
            force: Some(1.0),
            read_at: Some(made.now),
            age: Some(Duration::ZERO),
            ..JointReading::new(servo.joint, servo.id)
        };
        let joints: Vec<JointReading> = self.rig.servos.iter().map(reading).collect();
        Some(Arc::new(JointState {
            motion: made.motion.clone(),
            measured: Some(measured),
            commanded: Some(made.commanded.clone()),
            outcomes: made.outcomes.clone().into(),
            refusal: made.refusal.clone(),
            gone: made.gone.clone(),
            ..JointState::new(Stamp { seq: made.seq, captured_at: made.now }, joints)
        }))
    }

    fn at(&self, when: Instant) -> (Option<Posture>, Option<Posture>) {
        let made = self.made();
        let commanded = made.past.iter().rev().find(|(at, _)| *at <= when).map(|(_, past)| past.clone());
        let read = made.now >= when + made.silent;
        let measured = commanded.as_ref().map(|commanded| sagging(commanded, SAG_RAD)).filter(|_| read);
        (commanded, measured)
    }

    fn begin(&self, motion: Move) -> Result<MoveId, Refusal> {
        let mut made = self.made();
        made.asked.push(Asked::Move(motion.clone()));
        if let Some(refusal) = made.refuse.clone() {
            return Err(refusal);
        }
        let id = MoveId(made.asked.len() as u64);
        if let Some(outcome) = made.outcome.clone() {
            made.outcomes.push((id, outcome));
            motion.goals.iter().for_each(|(joint, angle_rad)| made.commanded[*joint] = *angle_rad);
        }
        made.motion = Motion::Holding(HoldReason::Arrived);
        Ok(id)
    }

    fn follow(&self, setpoint: Setpoint) -> Result<(), Refusal> {
        let mut made = self.made();
        setpoint.joints.iter().for_each(|(joint, angle_rad)| made.commanded[*joint] = *angle_rad);
        if made.motion == Motion::Holding(HoldReason::Arrived) {
            made.motion = Motion::Following;
        }
        let posture = made.commanded.clone();
        made.followed.push(posture);
        made.asked.push(Asked::Follow(setpoint));
        Ok(())
    }

    fn grip(&self, _grip: Grip) -> Result<(), Refusal> {
        unreachable!("touches grip nothing")
    }

    fn hold(&self) -> Result<(), Refusal> {
        self.made().asked.push(Asked::Hold);
        Ok(())
    }

    fn torque(&self, _joints: &[JointIndex], _on: bool) -> Result<(), Refusal> {
        Ok(())
    }

    fn census(&self) -> Census {
        Census::default()
    }
}

fn sagging(posture: &Posture, by_rad: f64) -> Posture {
    Posture::new(posture.angles_rad().iter().map(|angle| angle + by_rad).collect())
}

/// The made-up screen.
#[derive(Clone)]
pub struct FakeScreen(Arc<Mutex<Result<Option<Touch>, ScreenGone>>>);

impl TouchSource for FakeScreen {
    fn newest(&mut self) -> Result<Option<Touch>, ScreenGone> {
        *self.0.lock().expect("no test panics in here")
    }
}

pub struct Bench {
    pub worker: Worker,
    pub rig: Arc<Rig>,
    pub chain: Chain,
    pub order: TouchOrder,
    pub sent: Point<Robot>,
    pub now: Instant,
    pub stages: Vec<TouchStage>,
    pub switches: Switches,
    made: Arc<Mutex<Made>>,
    screen: FakeScreen,
    _folder: tempfile::TempDir,
}

impl Bench {
    pub fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let rig = Arc::new(Rig::built_in("nico").expect("the rig that comes with the program"));
        let switches = Switches::default();
        let desk = TwinDesk::new(TwinEyesPlug::default());
        let mut worker = Worker::new(rig.clone(), folder.path(), switches.clone(), desk);
        let planner =
            Planner::new(&rig, "right_index_tip", ScreenPlace::Measured).expect("it can point at the screen");
        let ready = planner.ready(&rig.home());
        let target = Pixel::new(TARGET[0], TARGET[1]);
        let sent = rig.touchscreen.point_at(target);
        let path = planner.plan(&Wanted::straight(target, sent, Side::Above), &ready).expect("in reach");
        let chain = planner.chain().clone();
        let order = TouchOrder::along(path, &chain, &rig.touchscreen, &TouchPace::default(), 7, 1);
        let now = Instant::now();
        let made = Arc::new(Mutex::new(Made {
            asked: vec![],
            followed: vec![],
            commanded: ready,
            motion: Motion::Holding(HoldReason::Connected),
            refusal: None,
            outcome: Some(MoveOutcome::Arrived { residual_rad: 0.0 }),
            refuse: None,
            gone: None,
            load: 0.1,
            torque_on: true,
            tremble_rad: 0.0,
            silent: Duration::ZERO,
            outcomes: vec![],
            past: vec![],
            now,
            seq: 0,
        }));
        worker.arm = Some(Box::new(FakeArm { made: made.clone(), rig: rig.clone() }));
        worker.connected_at = Some(now);
        worker.connection = Connection::Connected { to: "test".to_owned(), twin: false };
        let screen = FakeScreen(Arc::new(Mutex::new(Ok(None))));
        Self { worker, rig, chain, order, sent, now, stages: vec![], switches, made, screen, _folder: folder }
    }

    pub fn arm(&self) -> MutexGuard<'_, Made> {
        self.made.lock().expect("no test panics in here")
    }

    pub fn start(&mut self) {
        self.worker.begin_touch_with(self.order.clone(), Box::new(self.screen.clone()), self.now);
    }

    /// Height of the commanded tip above the point that it is sent to, m.
    pub fn height_m(&self) -> f64 {
        self.chain.robot_from_tip_in(&self.arm().commanded).translation_m().z - self.sent.coords.z
    }

    pub fn contact(&self, [u_px, v_px]: [f64; 2]) -> Touch {
        Touch { u_px, v_px, at: self.now, is_down: true }
    }

    pub fn show(&self, found: Result<Option<Touch>, ScreenGone>) {
        *self.screen.0.lock().expect("no test panics in here") = found;
    }

    /// The glass feels the finger where it is.
    pub fn touch_at_the_glass(&mut self) {
        let felt = matches!(*self.screen.0.lock().expect("no test panics in here"), Ok(Some(_)));
        if !felt && self.height_m() <= 0.0 {
            self.show(Ok(Some(self.contact(TARGET))));
        }
    }

    /// One tick.
    pub fn pass(&mut self) {
        self.now += TICK;
        {
            let mut made = self.arm();
            (made.now, made.seq) = (self.now, made.seq + 1);
            let now = (made.now, made.commanded.clone());
            made.past.push(now);
        }
        self.worker.tick(self.now);
    }

    /// One tick, then what came of it.
    pub fn tick(&mut self) -> Option<TouchRun> {
        self.pass();
        self.collect()
    }

    pub fn collect(&mut self) -> Option<TouchRun> {
        let mut end = None;
        for news in self.worker.take_touch_news() {
            assert_eq!((news.order, news.number), (self.order.order, Some(self.order.number)));
            match news.state {
                TouchRun::Doing(stage) => self.stages.push(stage),
                state => {
                    assert!(end.is_none(), "it ends once");
                    end = Some(state);
                }
            }
        }
        end
    }

    /// Ticks until something holds.
    pub fn until(&mut self, mut holds: impl FnMut(&mut Self) -> bool) {
        let began = self.now;
        while !holds(self) {
            let end = self.tick();
            assert!(end.is_none(), "it ended: {end:?}");
            assert!(self.now < began + PATIENCE, "never; stages {:?}", self.stages);
        }
    }

    pub fn until_stage(&mut self, stage: TouchStage) {
        if stage == TouchStage::Dwelling || stage == TouchStage::Retreating {
            return self.until(|bench| {
                bench.touch_at_the_glass();
                bench.stages.last() == Some(&stage)
            });
        }
        self.until(|bench| bench.stages.last() == Some(&stage));
    }

    /// Ticks until the touch is over.
    pub fn until_end(&mut self, mut meanwhile: impl FnMut(&mut Self)) -> TouchRun {
        let began = self.now;
        loop {
            meanwhile(self);
            if let Some(end) = self.tick() {
                return end;
            }
            assert!(self.now < began + PATIENCE, "never over; stages {:?}", self.stages);
        }
    }
}
