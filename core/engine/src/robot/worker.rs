//! What the robot's thread knows and does. Owns no thread and reads the clock only where told,
//! so that tests drive it with a made-up arm.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_effects::rig_model::Conditions;
use plumbline_effects::{ModelArm, RobotModel};
use plumbline_hardware::joints::{
    Chains, Motion, Move, MoveId, MoveOutcome, Pace, Refusal, Setpoint, SetpointKind,
};
use plumbline_model::frame::{Point, Pose, Robot, Tip};
use plumbline_model::robot::{Chain, JointIndex, Posture, Reach, Rig};

use super::Switches;
use super::arm::Arm;
use super::command::{Destination, JOG_DEADLINE_MS, JogRates, RobotCommand};
use super::connect::{self, Connected};
use super::control::RobotControl;
use super::destination::{Circumstances, Resolved, resolve};
use super::history::Histories;
use super::jog::joint_rates;
use super::lead::Leading;
use super::path::{Paths, duration};
use super::poses::PoseLibrary;
use super::touching::Touching;
use super::unable::{FASTEST_JOG, NoDestination, SPEEDS, Unable, holds_unheard, is_unheard};
use super::view::{Connection, PortView, Preview, RobotView};
use crate::ground::notice::NoticeLevel;
use crate::ground::text::sentence;
use crate::twin::TwinDesk;
use crate::twin::view::TwinView;

/// The trail of the tip goes back this far.
const TRAIL: Duration = Duration::from_secs(30);
/// Places nearer than this to the last one are left out of the trail, m.
const TRAIL_STEP_M: f64 = 0.002;

/// Why what moved the arm ends.
const TORQUE_SWITCHED: &str =
    "torque was switched by hand meanwhile: look how the arm stands, then begin anew";

/// What the state is told.
#[derive(Clone, Debug)]
pub struct News {
    /// For the window.
    pub robot: Arc<RobotView>,
    /// For the window.
    pub twin: Arc<TwinView>,
    /// Counts twins started: a new one has new eyes.
    pub twins_started: u64,
}

/// The running move.
#[derive(Clone, Debug)]
pub(super) struct Running {
    pub id: MoveId,
    pub title: String,
}

/// Jogging: what is asked, until when, and where that leads.
#[derive(Clone, Debug)]
pub(super) struct Jog {
    rates: JogRates,
    until: Instant,
    last: Instant,
    goal: Posture,
}

/// What the robot's thread knows and does.
pub struct Worker {
    pub(super) rig: Arc<Rig>,
    pub(super) switches: Switches,
    pub(super) poses: PoseLibrary,
    pub(super) connection: Connection,
    /// Whether what was connected last, or could not be, is the twin.
    pub(super) reached_twin: bool,
    pub(super) arm: Option<Box<dyn Arm>>,
    pub(super) connected_at: Option<Instant>,
    pub(super) desk: TwinDesk,
    pub(super) tip: String,
    pub(super) chain: Chain,
    /// The robot as it is known; its description is `rig`.
    model: Arc<RobotModel>,
    /// What that is called for people.
    pub(super) title: Arc<str>,
    /// The arm of the chosen tip with the model's effects; `None` when it cannot be moved.
    pub(super) arm_model: Option<ModelArm>,
    /// Which joints move together.
    pub(super) together: Chains,
    reach: Option<Reach>,
    pub(super) paths: Paths,
    pub(super) preview: Option<(Resolved, Preview)>,
    pub(super) running: Option<Running>,
    pub(super) jog: Option<Jog>,
    pub(super) refusal: Option<String>,
    /// Whether that was merely because joints were not heard.
    pub(super) is_unheard: bool,
    /// How often something was not carried out.
    pub(super) refused: u64,
    seen_refusal: u64,
    pub(super) speed: f64,
    pub(super) ports: Option<Arc<[PortView]>>,
    pub(super) histories: Histories,
    pub(super) trail: VecDeque<(Instant, Point<Robot>)>,
    pub(super) twins_started: u64,
    pub(super) touching: Touching,
    pub(super) leading: Leading,
    notes: Vec<(NoticeLevel, String)>,
    pub(super) told: Option<News>,
    pub(super) told_at: Option<Instant>,
}

impl Worker {
    /// Not connected.
    pub fn new(rig: Arc<Rig>, data_dir: &std::path::Path, switches: Switches, desk: TwinDesk) -> Self {
        let (poses, problem) = PoseLibrary::read(data_dir, &rig);
        let tip =
            rig.arms.first().and_then(|arm| arm.tips.first()).map(|tip| tip.link.clone()).unwrap_or_default();
        let paths = Paths::new(&rig);
        let model = Arc::new(RobotModel::nominal(rig.clone()));
        let chain = rig.chain(&tip).or_else(|_| rig.chain(&rig.description.links()[0].name));
        Self {
            switches,
            poses,
            connection: Connection::None,
            reached_twin: false,
            arm: None,
            connected_at: None,
            desk,
            chain: chain.expect("the base is a link, and a rig's tips are checked when it is read"),
            reach: Reach::with_model(&rig, &tip, paths.model()).ok(),
            arm_model: model.arm(&tip).ok(),
            title: model.title().into(),
            model,
            together: Chains::of(&rig.description),
            tip,
            paths,
            preview: None,
            running: None,
            jog: None,
            refusal: None,
            is_unheard: false,
            refused: 0,
            seen_refusal: 0,
            speed: 1.0,
            ports: None,
            histories: Histories::new(rig.servos.len()),
            trail: VecDeque::new(),
            twins_started: 0,
            touching: Touching::default(),
            leading: Leading::default(),
            notes: problem.map(|text| (NoticeLevel::Warning, text)).into_iter().collect(),
            told: None,
            told_at: None,
            rig,
        }
    }

    /// Takes the place of a worker that failed: twins are counted on, so that a new one is told from
    /// those before.
    pub fn in_place_of_one_that_started(mut self, twins: u64) -> Self {
        self.twins_started = twins;
        self
    }

    /// Whether there is something to look at often.
    pub fn is_awake(&self) -> bool {
        self.arm.is_some() || self.desk.is_running()
    }

    /// Messages for the operator since the last call.
    pub fn take_notes(&mut self) -> Vec<(NoticeLevel, String)> {
        self.notes.extend(self.desk.take_notes());
        std::mem::take(&mut self.notes)
    }

    /// What to show while a command that takes long is carried out.
    pub fn announce(&self, control: &RobotControl) -> Option<News> {
        let (to, doing) = match control {
            RobotControl::Robot(RobotCommand::ConnectTwin { scenario }) => {
                (twin_called(scenario), "starting the simulation")
            }
            RobotControl::Robot(RobotCommand::ConnectPort { path }) => {
                (path.display().to_string(), "asking the bus who is there")
            }
            RobotControl::Robot(RobotCommand::Scan) => {
                let (Connection::Connected { to, .. } | Connection::Lost { to, .. }) = &self.connection
                else {
                    return None;
                };
                (to.clone(), "asking the bus who is there")
            }
            _ => return None,
        };
        let told = self.told.clone()?;
        let connection = Connection::Connecting { to, doing: doing.to_owned() };
        let robot = Arc::new(RobotView { connection, ..(*told.robot).clone() });
        Some(News { robot, ..told })
    }

    /// Does what the operator asked.
    pub fn control(&mut self, control: RobotControl) {
        if self.is_led() {
            // Whoever led until just now may be gone.
            self.step_lead(Instant::now());
        }
        let result = match control {
            control if self.touching.forbids(&control) => Err(self.touching.busy()),
            control if self.leading.forbids(&control) => Err(self.leading.busy()),
            RobotControl::Robot(command) => self.robot(command),
            RobotControl::Lead(led) => self.begin_lead(led),
            RobotControl::Twin(command) => self.desk.control(command, &self.rig).map_err(Unable::from),
            RobotControl::TurnHead { pan_rad, tilt_rad } => self.turn_head(pan_rad, tilt_rad),
            RobotControl::Touch(order) => {
                self.begin_touch(*order, Instant::now());
                Ok(())
            }
            RobotControl::AbandonTouch => {
                self.abandon_touch();
                Ok(())
            }
            RobotControl::Contact(contact) => {
                self.felt_by_window(contact);
                Ok(())
            }
            RobotControl::UseModel(model) => {
                self.use_model(model);
                Ok(())
            }
        };
        match result {
            Ok(()) => {}
            Err(reason) => self.refuse_because(reason.to_string(), reason.is_unheard()),
        }
    }

    /// From now on the robot is known so. A move that is shown was found with another arm where the
    /// effects are others: it is shown no more.
    pub fn use_model(&mut self, model: Arc<RobotModel>) {
        let screen_moved = self.rig.touchscreen != model.rig().touchscreen;
        let other_effects = !Arc::ptr_eq(self.model.added(), model.added())
            && self.model.added().contents != model.added().contents;
        (self.rig, self.title) = (model.rig().clone(), model.title().into());
        self.arm_model = model.arm(&self.tip).ok();
        self.model = model;
        if screen_moved {
            self.paths.place(&self.rig);
            self.reach = Reach::with_model(&self.rig, &self.tip, self.paths.model()).ok();
        }
        if other_effects {
            self.preview = None;
            self.trail.clear();
        }
    }

    /// Where the tip is when encoders read a posture.
    pub(super) fn tip_by_encoders(&self, encoders: &Posture) -> Pose<Robot, Tip> {
        match &self.arm_model {
            Some(arm) => arm.robot_from_tip_by_encoders(encoders, &Conditions::default()),
            None => self.chain.robot_from_tip_in(encoders),
        }
    }

    pub(super) fn note(&mut self, level: NoticeLevel, text: String) {
        self.notes.push((level, text));
    }

    fn refuse(&mut self, reason: String) {
        self.refuse_because(reason, false);
    }

    fn refuse_because(&mut self, reason: String, is_unheard: bool) {
        self.notes.push((NoticeLevel::Warning, reason.clone()));
        (self.refusal, self.is_unheard) = (Some(reason), is_unheard);
        self.refused += 1;
    }

    fn robot(&mut self, command: RobotCommand) -> Result<(), Unable> {
        if !matches!(command, RobotCommand::ListPorts | RobotCommand::Jog(_) | RobotCommand::EndJog) {
            self.refusal = None;
        }
        match command {
            RobotCommand::ConnectTwin { scenario } => self.connect_twin(&scenario),
            RobotCommand::ConnectPort { path } => self.connect_port(path),
            RobotCommand::Disconnect => {
                self.disconnect();
                Ok(())
            }
            RobotCommand::ListPorts => {
                self.ports = Some(connect::ports()?);
                Ok(())
            }
            RobotCommand::Scan => self.scan(),
            RobotCommand::ShortenAnswers => Ok(self.arm()?.shorten_answers()?),
            RobotCommand::Torque { joints, on } => self.torque(&joints, on),
            RobotCommand::Preview(destination) => self.show(&destination),
            RobotCommand::ClearPreview => {
                self.preview = None;
                Ok(())
            }
            RobotCommand::RunPreview => self.run_preview(),
            RobotCommand::Jog(rates) => self.begin_jog(rates, Instant::now()),
            RobotCommand::EndJog => self.end_jog(),
            RobotCommand::ChooseTip { link } => {
                self.chain = self.rig.chain(&link)?;
                self.reach = Reach::with_model(&self.rig, &link, self.paths.model()).ok();
                self.arm_model = self.model.arm(&link).ok();
                self.tip = link;
                self.trail.clear();
                Ok(())
            }
            RobotCommand::Speed(speed) => {
                if !(SPEEDS.0..=SPEEDS.1).contains(&speed) {
                    return Err(Unable::Speed { asked: speed });
                }
                self.speed = speed;
                if let Some((resolved, _)) = self.preview.take() {
                    self.preview_of(resolved);
                }
                Ok(())
            }
            RobotCommand::ReleaseStop => {
                self.switches.stop.release();
                Ok(())
            }
            RobotCommand::SavePose { title, joints } => self.save_pose(&title, &joints),
            RobotCommand::DeletePose { name } => Ok(self.poses.delete(&name, &self.rig.clone())?),
            RobotCommand::DismissRefusal => Ok(()),
        }
    }

    fn connect_twin(&mut self, scenario: &str) -> Result<(), Unable> {
        self.disconnect();
        let to = twin_called(scenario);
        let port = self.desk.start(scenario, &self.rig).map_err(Unable::from).and_then(|port| {
            self.twins_started += 1;
            Ok(connect::open(&port, true, &self.rig, &self.paths, &self.switches)?)
        });
        self.connected(to, true, port)
    }

    fn connect_port(&mut self, path: PathBuf) -> Result<(), Unable> {
        self.disconnect();
        let to = path.display().to_string();
        let arm = connect::open(&path, false, &self.rig, &self.paths, &self.switches);
        self.connected(to, false, arm.map_err(Unable::from))
    }

    fn connected(&mut self, to: String, twin: bool, arm: Result<Connected, Unable>) -> Result<(), Unable> {
        self.reached_twin = twin;
        match arm {
            Ok(arm) => {
                self.arm = Some(arm);
                self.connected_at = Some(Instant::now());
                self.connection = Connection::Connected { to, twin };
                Ok(())
            }
            Err(reason) => {
                self.connection = Connection::Lost { to, reason: reason.to_string() };
                Err(reason)
            }
        }
    }

    fn disconnect(&mut self) {
        self.interrupt_touch("the robot was disconnected: connect it again");
        self.interrupt_lead("the robot was disconnected: connect it again");
        if let Some(arm) = self.arm.take() {
            // If it cannot be told to hold it is gone already.
            let _ = arm.hold();
        }
        self.connection = Connection::None;
        (self.preview, self.running, self.jog) = (None, None, None);
        self.trail.clear();
        self.histories.clear();
        self.seen_refusal = 0;
    }

    fn scan(&mut self) -> Result<(), Unable> {
        // Who is there is asked when the bus is opened: it is closed and opened again.
        let (Connection::Connected { to, .. } | Connection::Lost { to, .. }) = self.connection.clone() else {
            return Err(Unable::NothingToScan);
        };
        if !self.reached_twin {
            return self.connect_port(to.into());
        }
        // A twin goes on while nobody is connected to it, and everything on its table stays where it is.
        let port = self.desk.port().ok_or(Unable::TwinEnded)?;
        self.disconnect();
        let arm = connect::open(&port, true, &self.rig, &self.paths, &self.switches);
        self.connected(to, true, arm.map_err(Unable::from))
    }

    pub(super) fn arm(&self) -> Result<&dyn Arm, Unable> {
        self.arm.as_deref().ok_or(Unable::NotConnected)
    }

    /// Present angles.
    pub(super) fn present(&self) -> Option<Posture> {
        self.arm.as_ref()?.state()?.measured.clone()
    }

    /// Whether it is known where some joints are, and what moves with them.
    fn knows(&self, joints: &[JointIndex]) -> Result<(), Unable> {
        let Some(state) = self.arm.as_ref().and_then(|arm| arm.state()) else { return Ok(()) };
        Ok(self.together.check(&self.rig, joints, &state.unknown, &state.late)?)
    }

    fn torque(&mut self, joints: &[JointIndex], on: bool) -> Result<(), Unable> {
        let all: Vec<JointIndex> = self.rig.servos.iter().map(|servo| servo.joint).collect();
        let joints = if joints.is_empty() { &all } else { joints };
        self.end_lead(TORQUE_SWITCHED);
        Ok(self.arm()?.torque(joints, on)?)
    }

    fn show(&mut self, destination: &Destination) -> Result<(), Unable> {
        self.preview = None;
        let present = self.present().ok_or(Unable::NotReadToShow)?;
        let poses = self.poses.all(&self.rig);
        let reach = self.reach.as_ref().zip(self.arm_model.as_ref());
        let around = Circumstances { model: &self.model, reach, present: &present, poses: &poses };
        let resolved = resolve(destination, &around)?;
        self.knows(&resolved.joints)?;
        self.preview_of(resolved);
        Ok(())
    }

    fn preview_of(&mut self, resolved: Resolved) {
        let Some(present) = self.present() else { return };
        let path = self.paths.check(&present, &resolved.end);
        let turn = |joint: &JointIndex| (*joint, (resolved.end[*joint] - present[*joint]).abs());
        let largest = resolved.joints.iter().map(turn).max_by(|a, b| a.1.total_cmp(&b.1));
        let title = |joint| self.rig.servo_of(joint).map_or_else(String::new, |servo| servo.title.clone());
        let preview = Preview {
            title: resolved.title.clone(),
            end: resolved.end.clone(),
            path,
            duration: duration(largest.map_or(0.0, |(_, turn_rad)| turn_rad), self.peak_speed_rad_s()),
            largest_turn: largest.map(|(joint, turn_rad)| (title(joint), turn_rad)),
            model: self.title.clone(),
            tip_sigma_m: resolved.tip_sigma_m,
        };
        self.preview = Some((resolved, preview));
    }

    fn peak_speed_rad_s(&self) -> f64 {
        (self.speed * self.rig.gate.usual_speed_rad_s).min(self.rig.gate.speed_rad_s)
    }

    fn run_preview(&mut self) -> Result<(), Unable> {
        let (resolved, _) = self.preview.take().ok_or(Unable::NoPreview)?;
        let present = self.present().ok_or(Unable::NotRead)?;
        self.knows(&resolved.joints)?;
        // The arm may have moved since it was shown.
        self.paths.check(&present, &resolved.end)?;
        self.begin(resolved)
    }

    fn turn_head(&mut self, pan_rad: f64, tilt_rad: f64) -> Result<(), Unable> {
        self.refusal = None;
        let present = self.present().ok_or(Unable::NotRead)?;
        let joints = vec![self.rig.eyes.pan, self.rig.eyes.tilt];
        self.knows(&joints)?;
        let end = present.with(&joints, &[pan_rad, tilt_rad]);
        self.paths.check(&present, &end)?;
        self.begin(Resolved::of_joints("the head to its next pose".to_owned(), end, joints))
    }

    fn begin(&mut self, resolved: Resolved) -> Result<(), Unable> {
        let goals = resolved.joints.iter().map(|joint| (*joint, resolved.end[*joint])).collect();
        let motion = Move { goals, pace: Pace::PeakSpeed(self.peak_speed_rad_s()) };
        self.jog = None;
        let id = self.arm()?.begin(motion)?;
        self.running = Some(Running { id, title: resolved.title });
        Ok(())
    }

    fn begin_jog(&mut self, rates: JogRates, now: Instant) -> Result<(), Unable> {
        let is_slow = |rate: &f64, fastest: f64| (-fastest..=fastest).contains(rate);
        let [fastest_m_s, fastest_rad_s] = FASTEST_JOG;
        if !rates.velocity_m_s.iter().all(|rate| is_slow(rate, fastest_m_s))
            || !is_slow(&rates.yaw_rad_s, fastest_rad_s)
        {
            return Err(Unable::TooFast);
        }
        if self.switches.stop.is_pressed() {
            return Err(Refusal::Stopped.into());
        }
        let until = now + Duration::from_millis(JOG_DEADLINE_MS);
        match &mut self.jog {
            Some(jog) => (jog.rates, jog.until) = (rates, until),
            None => {
                let goal = self.present().ok_or(Unable::NotRead)?;
                self.knows(self.chain.joints())?;
                self.refusal = None;
                (self.preview, self.running) = (None, None);
                self.jog = Some(Jog { rates, until, last: now, goal });
                self.step_jog(now);
            }
        }
        Ok(())
    }

    fn end_jog(&mut self) -> Result<(), Unable> {
        if self.jog.take().is_some() {
            self.arm()?.hold()?;
        }
        Ok(())
    }

    /// Sends the next joint speeds of a jog; ends it when its time is over or it would lead
    /// into something.
    fn step_jog(&mut self, now: Instant) {
        let Some(mut jog) = self.jog.take() else { return };
        if now >= jog.until || self.switches.stop.is_pressed() {
            let _ = self.arm().map(|arm| arm.hold());
            return;
        }
        let fastest = self.peak_speed_rad_s();
        let speeds = match &self.arm_model {
            Some(arm) => joint_rates(arm, &jog.goal, &jog.rates, fastest),
            None => return self.refuse(Unable::from(NoDestination::NoTip).to_string()),
        };
        let step_s = now.saturating_duration_since(jog.last).as_secs_f64().min(0.1);
        let ahead = |seconds: f64| {
            let angles: Vec<f64> = self
                .chain
                .joints()
                .iter()
                .zip(&speeds)
                .map(|(joint, speed)| jog.goal[*joint] + speed * seconds)
                .collect();
            jog.goal.with(self.chain.joints(), &angles)
        };
        // Looks as far ahead as the setpoint lasts.
        let lookahead_s = JOG_DEADLINE_MS as f64 / 1e3;
        if let Err(reason) = self.paths.check(&jog.goal, &ahead(lookahead_s)) {
            let _ = self.arm().map(|arm| arm.hold());
            return self.refuse(reason.to_string());
        }
        let goal = ahead(step_s);
        let setpoint = Setpoint {
            kind: SetpointKind::Velocity,
            joints: self.chain.joints().iter().copied().zip(speeds.iter().copied()).collect(),
            valid_for: Duration::from_millis(JOG_DEADLINE_MS),
        };
        match self.arm().map(|arm| arm.follow(setpoint)) {
            Ok(Ok(())) => {
                (jog.goal, jog.last) = (goal, now);
                // Where the arm really is counts more than where it was sent.
                if let Some(present) = self.present()
                    && present.distance_rad(&jog.goal) > 0.2
                {
                    jog.goal = present;
                }
                self.jog = Some(jog);
            }
            Ok(Err(refusal)) => self.refuse(sentence(&refusal.to_string())),
            Err(reason) => self.refuse(reason.to_string()),
        }
    }

    fn save_pose(&mut self, title: &str, joints: &[JointIndex]) -> Result<(), Unable> {
        let present = self.present().ok_or(Unable::NotReadToSave)?;
        let all: Vec<JointIndex> = self.rig.servos.iter().map(|servo| servo.joint).collect();
        let joints = if joints.is_empty() { &all } else { joints };
        self.knows(joints)?;
        let rig = self.rig.clone();
        let clamped = |joint: &JointIndex| {
            // An encoder may read half a tick beyond the limit at which it stands.
            let limits = rig.limits(*joint);
            let angle_rad = present[*joint];
            let near = limits.excess_rad(angle_rad).abs() < 0.02;
            (*joint, if near { angle_rad.clamp(limits.lower_rad, limits.upper_rad) } else { angle_rad })
        };
        Ok(self.poses.save(title, joints.iter().map(clamped).collect(), &rig)?)
    }

    /// Looks at the joints and goes on with what runs.
    pub fn tick(&mut self, now: Instant) {
        self.desk.tick(now, &self.rig);
        self.step_jog(now);
        self.step_touch(now);
        self.step_lead(now);
        let Some(state) = self.arm.as_ref().and_then(|arm| arm.state()) else { return };
        if let Some(reason) = &state.gone {
            let Connection::Connected { to, .. } = self.connection.clone() else { return };
            let reason = sentence(reason);
            self.disconnect();
            self.connection = Connection::Lost { to, reason: reason.clone() };
            return self.refuse(reason);
        }
        if let Some((number, refusal)) = &state.refusal
            && *number > self.seen_refusal
        {
            self.seen_refusal = *number;
            self.refuse_because(sentence(&refusal.to_string()), is_unheard(refusal));
        }
        if let Some(running) = &self.running
            && let Some(outcome) = state.outcome(running.id)
        {
            if let MoveOutcome::Held(reason) = outcome {
                let text = format!("Not finished: {}. {}", running.title, sentence(&reason.to_string()));
                self.refuse_because(text, holds_unheard(reason));
            }
            self.running = None;
        }
        if !matches!(state.motion, Motion::Moving { .. } | Motion::Following) && self.jog.is_none() {
            self.running = self.running.take().filter(|running| state.outcome(running.id).is_none());
        }
        if let Some(since) = self.connected_at {
            self.histories.note(now.saturating_duration_since(since).as_secs_f64(), &state.joints);
        }
        if let Some(posture) = &state.measured
            && self.chain.joints().iter().all(|joint| state.knows(*joint))
        {
            self.follow_tip(posture, now);
        }
    }

    fn follow_tip(&mut self, posture: &Posture, now: Instant) {
        while self.trail.front().is_some_and(|(at, _)| now.saturating_duration_since(*at) > TRAIL) {
            self.trail.pop_front();
        }
        let place = self.tip_by_encoders(posture).translation_m();
        let place = Point::new(place.x, place.y, place.z);
        if self.trail.back().is_none_or(|(_, last)| last.distance_m(&place) > TRAIL_STEP_M) {
            self.trail.push_back((now, place));
        }
    }
}

/// How the twin of a scenario is called.
fn twin_called(scenario: &str) -> String {
    format!("twin \"{}\"", crate::twin::short_name(scenario))
}
