//! What the robot's thread knows and does. Owns no thread and reads the clock only where told,
//! so that tests drive it with a made-up arm.

mod connecting;
mod jogging;
mod known;
mod moving;
mod ticking;

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Instant;

use plumbline_effects::{ModelArm, RobotModel};
use plumbline_hardware::joints::{Chains, MoveId};
use plumbline_model::frame::{Point, Robot};
use plumbline_model::robot::{Chain, Posture, Reach, Rig};

use self::jogging::Jog;
use crate::ground::notice::NoticeLevel;
use crate::robot::Switches;
use crate::robot::arm::Arm;
use crate::robot::command::RobotCommand;
use crate::robot::connect;
use crate::robot::control::RobotControl;
use crate::robot::destination::Resolved;
use crate::robot::history::Histories;
use crate::robot::lead::Leading;
use crate::robot::path::Paths;
use crate::robot::poses::PoseLibrary;
use crate::robot::said::Said;
use crate::robot::touching::Touching;
use crate::robot::unable::{SPEEDS, Unable};
use crate::robot::view::{Connection, PortView, Preview, RobotView};
use crate::twin::TwinDesk;
use crate::twin::view::TwinView;

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
pub(in crate::robot) struct Running {
    pub id: MoveId,
    pub title: String,
}

/// What the robot's thread knows and does.
pub struct Worker {
    pub(in crate::robot) rig: Arc<Rig>,
    pub(in crate::robot) switches: Switches,
    pub(in crate::robot) poses: PoseLibrary,
    pub(in crate::robot) connection: Connection,
    /// Whether what was connected last, or could not be, is the twin.
    pub(in crate::robot) reached_twin: bool,
    pub(in crate::robot) arm: Option<Box<dyn Arm>>,
    pub(in crate::robot) connected_at: Option<Instant>,
    pub(in crate::robot) desk: TwinDesk,
    pub(in crate::robot) tip: String,
    pub(in crate::robot) chain: Chain,
    /// The robot as it is known; its description is `rig`.
    model: Arc<RobotModel>,
    /// What that is called for people.
    pub(in crate::robot) title: Arc<str>,
    /// The arm of the chosen tip with the model's effects; `None` when it cannot be moved.
    pub(in crate::robot) arm_model: Option<ModelArm>,
    /// Which joints move together.
    pub(in crate::robot) together: Chains,
    reach: Option<Reach>,
    pub(in crate::robot) paths: Paths,
    pub(in crate::robot) preview: Option<(Resolved, Preview)>,
    pub(in crate::robot) running: Option<Running>,
    pub(in crate::robot) jog: Option<Jog>,
    pub(in crate::robot) refusal: Option<String>,
    /// Whether that was merely because joints were not heard.
    pub(in crate::robot) is_unheard: bool,
    /// How often something was not carried out.
    pub(in crate::robot) refused: u64,
    seen_refusal: u64,
    said: Said,
    pub(in crate::robot) speed: f64,
    pub(in crate::robot) ports: Option<Arc<[PortView]>>,
    pub(in crate::robot) histories: Histories,
    pub(in crate::robot) trail: VecDeque<(Instant, Point<Robot>)>,
    pub(in crate::robot) twins_started: u64,
    pub(in crate::robot) touching: Touching,
    pub(in crate::robot) leading: Leading,
    notes: Vec<(NoticeLevel, String)>,
    pub(in crate::robot) told: Option<News>,
    pub(in crate::robot) told_at: Option<Instant>,
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
            said: Said::default(),
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
            RobotControl::BoardLooked(look) => {
                self.desk.looked(look);
                Ok(())
            }
            RobotControl::TurnHead { pan_rad, tilt_rad } => self.turn_head(pan_rad, tilt_rad),
            RobotControl::Touch(order) => {
                self.begin_touch(*order, Instant::now());
                Ok(())
            }
            RobotControl::Withdraw(order) => {
                self.begin_withdrawing(*order);
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

    pub(in crate::robot) fn note(&mut self, level: NoticeLevel, text: String) {
        self.notes.push((level, text));
    }

    fn refuse(&mut self, reason: String) {
        self.refuse_because(reason, false);
    }

    fn refuse_because(&mut self, reason: String, is_unheard: bool) {
        if self.said.is_news(&reason, Instant::now()) {
            self.notes.push((NoticeLevel::Warning, reason.clone()));
        }
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
                self.forget_level();
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

    pub(in crate::robot) fn arm(&self) -> Result<&dyn Arm, Unable> {
        self.arm.as_deref().ok_or(Unable::NotConnected)
    }

    /// Present angles.
    pub(in crate::robot) fn present(&self) -> Option<Posture> {
        self.arm.as_ref()?.state()?.measured.clone()
    }
}
