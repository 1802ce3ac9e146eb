//! The arm as its callers see it: a thread owns the bus; everybody else reads the newest state and
//! leaves wishes.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Sender, TrySendError};
use plumbline_model::duration;
use plumbline_model::robot::{JointIndex, Posture, Rig};

use super::chains::Chains;
use super::command::{Motion, Move, MoveId, MoveOutcome, Setpoint};
use super::controller::Controller;
use super::exchange::{Exchange, Silence};
use super::grip::Grip;
use super::limiter::Limiter;
use super::options::ArmOptions;
use super::reading::JointState;
use super::refusal::{HoldReason, Refusal, Unheard};
use super::requests::{Request, note_scan};
use super::ring::StateRing;
use super::servo_unit::ServoUnit;
use super::stop::StopSwitch;
use crate::dynamixel::{Bus, BusError, BusScan, BusTiming, ExpectedServo, ScanRange, ServoPort};

/// Requests that wait at most.
const REQUESTS: usize = 16;
/// A pause is cut into pieces of this length, in which the stop is noticed.
const NAP: Duration = Duration::from_millis(1);

/// Moves the joints of a rig through its servo bus, within its limits.
///
/// Dropped, it lets the arm hold where it is, with torque.
pub struct ArmDriver {
    shared: Arc<Shared>,
    requests: Sender<Request>,
    limiter: Limiter,
    chains: Chains,
    stop: StopSwitch,
    scan: BusScan,
    ids: AtomicU64,
    thread: Option<JoinHandle<()>>,
}

struct Shared {
    ring: Mutex<StateRing>,
    setpoint: Mutex<Option<(Instant, Setpoint)>>,
    end: AtomicBool,
}

/// A panic while a lock was held leaves plain data, nothing half done.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Servos and boards that a rig expects on its bus.
pub fn expected_servos(rig: &Rig) -> Vec<ExpectedServo> {
    let servo = |id: u8, model: &str, title: &str| ExpectedServo {
        id,
        model: model.to_owned(),
        title: title.to_owned(),
    };
    let servos = rig.servos.iter().map(|s| servo(s.id, &s.model, &s.title));
    servos.chain(rig.boards.iter().map(|b| servo(b.id, &b.model, &b.title))).collect()
}

impl ArmDriver {
    /// Looks who is on the bus, reads all joints, and starts the thread. Nothing moves, nothing is
    /// written, and torque stays as it is. Servos that do not answer, or are not what the rig expects, stay out of use.
    ///
    /// # Errors
    /// When nobody answers, or the port is gone.
    pub fn connect(port: Box<dyn ServoPort>, rig: Arc<Rig>, options: ArmOptions) -> Result<Self, BusError> {
        let timing = BusTiming { baud: rig.bus.baud, ..options.timing };
        let mut bus = Bus::new(port, timing);
        let scan = bus.scan(&expected_servos(&rig), ScanRange::Expected)?;
        if scan.found.is_empty() && scan.duplicates_suspected.is_empty() {
            return Err(BusError::Silent { port: bus.port_name(), baud: timing.baud });
        }
        let units = rig.servos.iter().filter_map(ServoUnit::new).collect();
        let silence = Silence { cycles: options.missed_cycles, time: options.silence };
        let mut exchange = Exchange::new(bus, units, rig.gate.speed_rad_s, rig.gate.step_rad, silence);
        for slot in &mut exchange.slots {
            note_scan(slot, &scan);
            // Who it is was asked just now; who holds already goes on holding where it was told to.
            (slot.verify, slot.found_at_start) = (false, !slot.silent);
        }
        exchange.bus.be_patient(true);
        exchange.note_return_delays(options.return_delay.as_secs_f64())?;
        let stop = options.stop.clone();
        let limiter = Limiter { rig: rig.clone(), guards: options.guards.clone() };
        let mut controller = Controller::new(exchange, scan.clone(), rig, options);
        let limiter = Limiter { guards: controller.guards(), ..limiter };
        controller.cycle(std::iter::empty(), || None);
        controller.exchange.bus.be_patient(false);
        let shared = Arc::new(Shared {
            ring: Mutex::default(),
            setpoint: Mutex::default(),
            end: AtomicBool::new(false),
        });
        lock(&shared.ring).push(Arc::new(controller.state()));
        let (requests, queue) = crossbeam_channel::bounded(REQUESTS);
        let thread = std::thread::Builder::new()
            .name("joint bus".to_owned())
            .spawn({
                let shared = shared.clone();
                move || run(controller, &queue, &shared)
            })
            .map_err(|error| BusError::NoThread { detail: error.to_string() })?;
        let ids = AtomicU64::new(1);
        let chains = Chains::of(&limiter.rig.description);
        Ok(Self { shared, requests, limiter, chains, stop, scan, ids, thread: Some(thread) })
    }

    /// Who was on the bus when it was connected; what a later scan found stands in
    /// [`JointState::scan`].
    pub fn scan(&self) -> &BusScan {
        &self.scan
    }

    /// Asks the bus anew who is there; the arm holds meanwhile, with all ids for seconds.
    ///
    /// # Errors
    /// When too much waits, or the driver ended.
    pub fn scan_again(&self, range: ScanRange) -> Result<(), Refusal> {
        self.request(Request::Scan(range))
    }

    /// The newest state.
    pub fn state(&self) -> Arc<JointState> {
        lock(&self.shared.ring).newest().cloned().expect("the first state is stored before the thread starts")
    }

    /// Where all joints were at a moment of the last four seconds, interpolated between readings:
    /// for the time an image was taken. `None` when readings do not cover it.
    pub fn posture_at(&self, at: Instant) -> Option<Posture> {
        lock(&self.shared.ring).posture_at(at)
    }

    /// What was commanded at a moment of the last four seconds, interpolated between cycles: for
    /// the time of a contact. `None` when no state covers it.
    pub fn commanded_at(&self, at: Instant) -> Option<Posture> {
        lock(&self.shared.ring).commanded_at(at)
    }

    /// The stop of this arm.
    pub fn stop_switch(&self) -> &StopSwitch {
        &self.stop
    }

    /// Whether a move would be accepted now, and how long it would take. Nothing moves.
    ///
    /// # Errors
    /// Why not: which joint, which limit, by how much.
    pub fn check(&self, wanted: &Move) -> Result<Duration, Refusal> {
        let state = self.state();
        if let Some(reason) = &state.gone {
            return Err(Refusal::Gone(reason.clone()));
        }
        let unknown =
            || Refusal::Unknown { joint: JointIndex(0), name: "the arm".to_owned(), why: Unheard::Silent };
        let joints: Vec<JointIndex> = wanted.goals.iter().map(|(joint, _)| *joint).collect();
        self.chains.check(&self.limiter.rig, &joints, &state.unknown, &state.late)?;
        let sent = state.commanded.as_ref().ok_or_else(unknown)?;
        let present = state.measured.as_ref().ok_or_else(unknown)?;
        let start = self.limiter.set_out(sent, present, &joints, &state.at_rest);
        let line = self.limiter.plan(&start, present, wanted)?;
        // The limiter bounds it.
        Ok(duration::seconds(line.duration_s).unwrap_or_default())
    }

    /// Asks for a move; it takes the place of whatever moves. How it ends, or that it is refused,
    /// stands in [`JointState::outcomes`].
    ///
    /// # Errors
    /// When too much waits, or the driver ended.
    pub fn start_move(&self, wanted: Move) -> Result<MoveId, Refusal> {
        let id = MoveId(self.ids.fetch_add(1, Ordering::Relaxed));
        self.request(Request::Move(id, wanted))?;
        Ok(id)
    }

    /// Waits until a move has ended; `None` when it has not within `longest`.
    pub fn wait_for(&self, id: MoveId, longest: Duration) -> Option<MoveOutcome> {
        let end = Instant::now() + longest;
        loop {
            if let Some(outcome) = self.state().outcome(id) {
                return Some(outcome.clone());
            }
            if Instant::now() >= end {
                return None;
            }
            std::thread::sleep(Duration::from_millis(4));
        }
    }

    /// Jogs, or streams goals: the newest setpoint counts, for as long as it says.
    pub fn follow(&self, setpoint: Setpoint) {
        *lock(&self.shared.setpoint) = Some((Instant::now(), setpoint));
    }

    /// Ends jogging at once, without waiting for the setpoint's deadline.
    pub fn end_following(&self) {
        if let Some((_, setpoint)) = lock(&self.shared.setpoint).as_mut() {
            setpoint.valid_for = Duration::ZERO;
        }
    }

    /// Lets fingers close, and press on what they meet from then on, while the arm moves and while it
    /// stands, until they are moved otherwise. STOP makes them press no farther than they do. That it is
    /// refused stands in [`JointState::refusal`].
    ///
    /// # Errors
    /// When too much waits, or the driver ended.
    pub fn grip(&self, grip: Grip) -> Result<(), Refusal> {
        self.request(Request::Grip(grip))
    }

    /// Lets the arm hold where it is. For emergencies use the stop, which does not queue.
    ///
    /// # Errors
    /// When too much waits, or the driver ended.
    pub fn hold(&self) -> Result<(), Refusal> {
        self.request(Request::Hold)
    }

    /// Takes hold: switches torque on; the joints (empty: all) hold where they are. One that shut
    /// down after an overload is given its force again.
    ///
    /// # Errors
    /// When too much waits, or the driver ended.
    pub fn engage(&self, joints: &[JointIndex]) -> Result<(), Refusal> {
        self.request(Request::Torque { joints: joints.to_vec(), on: true })
    }

    /// Switches torque off: **the joints (empty: all) go limp and the arm sinks.** Support it
    /// first. Allowed while STOP is latched.
    ///
    /// # Errors
    /// When too much waits, or the driver ended.
    pub fn relax(&self, joints: &[JointIndex]) -> Result<(), Refusal> {
        self.request(Request::Torque { joints: joints.to_vec(), on: false })
    }

    /// Lets servos that wait longer than they need to before each answer wait less. They keep that in
    /// their memory for good, and take it only while they are limp; others are left alone.
    ///
    /// # Errors
    /// When too much waits, or the driver ended.
    pub fn shorten_answers(&self) -> Result<(), Refusal> {
        self.request(Request::ShortenAnswers)
    }

    fn request(&self, request: Request) -> Result<(), Refusal> {
        self.requests.try_send(request).map_err(|error| match error {
            TrySendError::Full(_) => Refusal::Busy,
            TrySendError::Disconnected(_) => Refusal::Gone("the thread of the bus ended".to_owned()),
        })
    }
}

impl Drop for ArmDriver {
    fn drop(&mut self) {
        self.shared.end.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            log::error!("the thread of the joint bus panicked; the servos keep the goal they were sent last");
        }
    }
}

/// The thread. A panic (of a guard, say) ends it and is told like a port that is gone: servos keep
/// the goal they were sent last.
fn run(controller: Controller, queue: &Receiver<Request>, shared: &Shared) {
    let drive = std::panic::AssertUnwindSafe(|| drive(controller, queue, shared));
    if std::panic::catch_unwind(drive).is_ok() {
        return;
    }
    let mut ring = lock(&shared.ring);
    let Some(newest) = ring.newest() else { return };
    let reason =
        "what drives the joints failed inside: note what was done before, and connect again".to_owned();
    let motion = Motion::Holding(HoldReason::Gone(reason.clone()));
    let failed = JointState { motion, gone: Some(reason), ..JointState::clone(newest) };
    ring.push(Arc::new(failed));
}

fn drive(mut controller: Controller, queue: &Receiver<Request>, shared: &Shared) {
    let mut next = Instant::now();
    while !shared.end.load(Ordering::Acquire) {
        controller.cycle(queue.try_iter(), || newest_setpoint(shared));
        lock(&shared.ring).push(Arc::new(controller.state()));
        controller.on_state();
        next = (next + controller.period()).max(Instant::now());
        while Instant::now() < next && !shared.end.load(Ordering::Acquire) {
            if controller.stop_is_new() && !controller.is_gone() {
                controller.stop_now();
            }
            std::thread::sleep(NAP.min(next.saturating_duration_since(Instant::now())));
        }
    }
    controller.end();
}

/// A copy of the newest setpoint; the lock is held for no longer than that.
fn newest_setpoint(shared: &Shared) -> Option<(Instant, Setpoint)> {
    lock(&shared.setpoint).clone()
}
