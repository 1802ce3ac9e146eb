//! The thread that steps the physics.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

use plumbline_hardware::joints::Touch;
use plumbline_model::{Board, Pose, Robot, duration};

use super::command::{TwinCommand, TwinState};
use super::{Shared, TOUCHES, Touches, lock};
use crate::board_presets::default_board;
use crate::error::TwinError;
use crate::physics::World;
use crate::scenery::scenery;
use crate::servos::Fault;
use crate::toys::Toy;

/// A twin that is further behind than this gives up catching up, s.
const MOST_BEHIND_S: f64 = 0.1;
/// Longest stretch of physics between two looks at commands.
const STRETCH: Duration = Duration::from_millis(20);

/// How many times faster than everything else the eyes' clock may run.
const WARM_UP_PACES: std::ops::RangeInclusive<f64> = 1.0..=60.0;

/// Steps, obeys, publishes.
pub(super) struct Runner {
    shared: Arc<Shared>,
    incoming: Receiver<TwinCommand>,
    pace: f64,
    revision: u64,
    /// Wall clock and simulated time from which both are counted.
    base: (Instant, f64),
    /// The same for the real-time factor.
    measured: (Instant, f64),
    factor: f64,
    refusal: Option<String>,
    toy_order: Vec<bool>,
}

impl Runner {
    pub(super) fn new(shared: Arc<Shared>, incoming: Receiver<TwinCommand>, pace: f64) -> Self {
        let time_s = lock(&shared.world).time_s();
        let now = (Instant::now(), time_s);
        Self {
            shared,
            incoming,
            pace,
            revision: 0,
            base: now,
            measured: now,
            factor: pace,
            refusal: None,
            toy_order: vec![],
        }
    }

    pub(super) fn run(mut self) {
        self.toy_order = self.visible();
        while !self.shared.end.load(Ordering::Relaxed) {
            while let Ok(command) = self.incoming.try_recv() {
                self.obey(command);
            }
            assert!(!self.shared.struck.load(Ordering::Relaxed), "struck by a test");
            self.catch_up();
            self.publish();
            let nap_s = (World::STEP_S / self.pace).clamp(5e-4, 0.01);
            std::thread::sleep(duration::seconds(nap_s).unwrap_or(STRETCH));
        }
    }

    /// Steps until the simulated clock has caught up, but not for long.
    fn catch_up(&mut self) {
        let (began, began_s) = self.base;
        let target_s = began_s + began.elapsed().as_secs_f64() * self.pace;
        let mut world = lock(&self.shared.world);
        let servos = world.rig().servos.len();
        let hot = lock(&self.shared.bank).faults().contains(&Fault::HotServo);
        if let Some(suspect) = lock(&self.shared.bank).suspect() {
            world.heat_servo(suspect, if hot { Fault::HEATING_K_PER_S } else { 0.0 });
        }
        let stop_at = Instant::now() + STRETCH;
        while world.time_s() < target_s && Instant::now() < stop_at {
            {
                let mut bank = lock(&self.shared.bank);
                for servo in 0..servos {
                    world.drive(servo, bank.drive(servo));
                    bank.take(servo, world.reading(servo), World::STEP_S);
                }
            }
            world.step();
        }
        let time_s = world.time_s();
        drop(world);
        if target_s - time_s > MOST_BEHIND_S * self.pace.max(1.0) {
            self.base = (Instant::now(), time_s);
        }
        let wall_s = self.measured.0.elapsed().as_secs_f64();
        if wall_s > 1.0 {
            self.factor = (time_s - self.measured.1) / wall_s;
            self.measured = (Instant::now(), time_s);
        }
    }

    fn obey(&mut self, command: TwinCommand) {
        let done = match command {
            TwinCommand::PlaceObject { toy, x_m, y_m } => lock(&self.shared.world).place_toy(toy, x_m, y_m),
            TwinCommand::RemoveObject { toy } => {
                lock(&self.shared.world).remove_toy(toy);
                Ok(())
            }
            TwinCommand::PlaceBoard { robot_from_board } => self.hold_board(Some(robot_from_board)),
            TwinCommand::HideBoard => self.hold_board(None),
            TwinCommand::PrepareTouch { screen_height_m, payload_kg } => {
                let mut world = lock(&self.shared.world);
                world.raise_screen(screen_height_m).and_then(|()| world.load_hand(payload_kg))
            }
            TwinCommand::AdvanceWarmUp { minutes } => self.advance(minutes),
            TwinCommand::WarmUpPace { times } => self.warm_up_pace(times),
            TwinCommand::CoolEyes => {
                lock(&self.shared.world).cool_eyes();
                Ok(())
            }
            TwinCommand::Pace(pace) => check_pace(pace).map(|()| {
                self.pace = pace;
                self.restart_clock();
            }),
            TwinCommand::Reset => {
                self.reset();
                Ok(())
            }
            // These go to the bus directly.
            TwinCommand::Fault { .. } | TwinCommand::ClearFaults => Ok(()),
        };
        self.refusal = done.err().map(|error| error.to_string());
        let visible = self.visible();
        if visible != self.toy_order {
            self.toy_order = visible;
            self.revision += 1;
            let scenery = Arc::new(scenery(&lock(&self.shared.world), default_board(), self.revision));
            lock(&self.shared.latest).0 = scenery;
        }
    }

    fn reset(&mut self) {
        let mut world = lock(&self.shared.world);
        world.reset();
        let home = world.rig().home();
        let angles: Vec<f64> = world.rig().servos.iter().map(|servo| home[servo.joint]).collect();
        drop(world);
        lock(&self.shared.bank).hold(&angles);
        *lock(&self.shared.touches) = Touches::default();
        self.restart_clock();
    }

    fn restart_clock(&mut self) {
        let now = (Instant::now(), lock(&self.shared.world).time_s());
        (self.base, self.measured) = (now, now);
    }

    fn hold_board(&self, place: Option<Pose<Robot, Board>>) -> Result<(), TwinError> {
        let finite = place.is_none_or(|p| p.isometry.to_homogeneous().iter().all(|v| v.is_finite()));
        if !finite {
            return Err(TwinError::Value {
                what: "the place of the board",
                value: "not a number".to_owned(),
                remedy: "give numbers",
            });
        }
        lock(&self.shared.world).hold_board(place);
        Ok(())
    }

    fn advance(&self, minutes: f64) -> Result<(), TwinError> {
        if !(0.0..=6000.0).contains(&minutes) {
            return Err(TwinError::Value {
                what: "the advance of the eyes' clock",
                value: format!("{minutes} min"),
                remedy: "give 0 to 6000 minutes",
            });
        }
        lock(&self.shared.world).advance_warm_up(minutes * 60.0);
        Ok(())
    }

    fn warm_up_pace(&self, times: f64) -> Result<(), TwinError> {
        if !WARM_UP_PACES.contains(&times) {
            return Err(TwinError::Value {
                what: "the pace of the eyes' clock",
                value: times.to_string(),
                remedy: "give 1 to 60 times as fast as everything else",
            });
        }
        lock(&self.shared.world).set_warm_up_pace(times);
        Ok(())
    }

    /// What of the movable things is out: the scenery changes with it.
    fn visible(&self) -> Vec<bool> {
        let world = lock(&self.shared.world);
        let toys = Toy::ALL.into_iter().map(|toy| world.toy(toy).is_some());
        toys.chain([world.board().is_some()]).collect()
    }

    pub(super) fn publish(&self) {
        let mut world = lock(&self.shared.world);
        let snapshot = world.snapshot();
        let contacts = world.take_touches();
        let is_down = world.is_touched();
        let mut state = TwinState {
            time_s: world.time_s(),
            eyes_on_s: world.eyes_on_s(),
            warm_up_pace: world.warm_up_pace(),
            real_time_factor: self.factor,
            toys: Toy::ALL.into_iter().map(|t| (t, world.toy(t).map(|p| p.translation.vector))).collect(),
            board: world.board(),
            screen_height_m: world.screen_raised_m(),
            payload_kg: world.hand_load_kg(),
            faults: vec![],
            refusal: self.refusal.clone(),
        };
        drop(world);
        lock(&self.shared.latest).1 = snapshot;
        let mut published = lock(&self.shared.state);
        if state.refusal.is_none() {
            state.refusal = published.refusal.take();
        }
        *published = state;
        drop(published);
        let mut touches = lock(&self.shared.touches);
        for contact in contacts {
            let [u, v] = contact.pixel.map(f64::from);
            let touch = Touch { u_px: u, v_px: v, at: Instant::now(), is_down: true };
            touches.newest = Some(touch);
            if touches.waiting.len() == TOUCHES {
                touches.waiting.pop_front();
            }
            touches.waiting.push_back(touch);
        }
        if let Some(newest) = &mut touches.newest {
            newest.is_down = is_down;
        }
    }
}

pub(super) fn check_pace(pace: f64) -> Result<(), TwinError> {
    if (0.01..=100.0).contains(&pace) {
        return Ok(());
    }
    Err(TwinError::Value {
        what: "the pace of the twin",
        value: pace.to_string(),
        remedy: "give 0.01 to 100 simulated seconds per second",
    })
}
