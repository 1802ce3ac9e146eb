//! What tests of this workflow share.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use plumbline_correction::CorrectionModel;
use plumbline_effects::RobotModel;
use plumbline_model::robot::Rig;
use plumbline_model::session::Screen;
use plumbline_model::touch_plan::{Pattern, PlanOptions, Side, TouchArea};
use plumbline_model::{Pixel, Unattended};

use super::command::TouchCommand;
use super::record::{Standing, TouchRecord};
use super::refusal::Held;
use super::view::{TouchPhase, TouchView};
use super::work::{Context, TouchWork};
use super::{TouchAround, TouchWorkflow};
use crate::ground::jobs::JobId;
use crate::ground::jobs::list::JobList;
use crate::ground::notice::{NoticeLevel, Notices};
use crate::ground::{Asked, LongWork, Time, Workflow};
use crate::robot::view::{Connection, RobotView};
use crate::robot::{
    RobotControl, TouchMeasurement, TouchNews, TouchOrder, TouchRun, TouchStage, WithdrawOrder,
};

/// The rig that comes with the program.
pub fn rig() -> Arc<Rig> {
    static RIG: OnceLock<Arc<Rig>> = OnceLock::new();
    RIG.get_or_init(|| Arc::new(Rig::built_in("nico").expect("the rig that comes with the program"))).clone()
}

/// A touch of which only the place matters.
pub fn record(number: usize, group: &str, target: Pixel<Screen>, touched: Pixel<Screen>) -> TouchRecord {
    TouchRecord {
        number,
        standing: Standing::Counts,
        touched,
        target,
        sent_m: Some([0.4, 0.0, 0.056]),
        group: group.to_owned(),
        set: "set".to_owned(),
        side: Side::Above,
        screen_height_m: 0.0,
        payload_kg: 0.0,
        commanded_rad: vec![],
        encoder_rad: vec![],
        later_encoder_rad: vec![],
        direction: vec![],
        temperature_c: vec![],
        load: vec![],
        move_secs: None,
        connected_secs: None,
    }
}

/// A workflow on a folder, with a robot that does what it is told when the test says so. Work runs
/// at once.
pub struct Desk {
    pub workflow: TouchWorkflow,
    pub robot: RobotView,
    pub rig: Arc<Rig>,
    pub models: Vec<Arc<CorrectionModel>>,
    pub model: Arc<RobotModel>,
    /// What the hand holds.
    pub in_hand: Option<Held>,
    pub notices: Notices,
    /// What the robot's thread was told and the test has not looked at.
    pub controls: VecDeque<RobotControl>,
    /// Where the real fingertip lands beside the place that was sent, px.
    pub bias_px: (f64, f64),
    jobs: JobList,
    asked: Vec<Asked<TouchWork, RobotControl>>,
    began: Instant,
    clock: Instant,
    /// Work that is not done by itself, by its title.
    pub held: Option<&'static str>,
    waiting: VecDeque<(JobId, TouchWork)>,
}

impl Desk {
    /// A workflow on this folder, restored, with a twin connected.
    pub fn new(folder: &Path) -> Self {
        let (rig, began) = (rig(), Instant::now());
        let ready = rig.pose("touch-ready").expect("NICO has it").applied_to(&rig.home());
        let robot = RobotView {
            rig: Some(rig.clone()),
            connection: Connection::Connected { to: "test".to_owned(), twin: true },
            measured: Some(ready),
            ..RobotView::default()
        };
        let mut desk = Self {
            workflow: TouchWorkflow::new(folder),
            robot,
            rig: rig.clone(),
            models: vec![],
            model: Arc::new(RobotModel::nominal(rig.clone())),
            in_hand: None,
            notices: Notices::default(),
            controls: VecDeque::new(),
            bias_px: (8.0, -5.0),
            jobs: JobList::default(),
            asked: vec![],
            began,
            clock: began,
            held: None,
            waiting: VecDeque::new(),
        };
        desk.with(TouchWorkflow::restore);
        desk
    }

    fn with(&mut self, act: impl FnOnce(&mut TouchWorkflow, &TouchAround, &mut Context<'_>)) {
        let around = self.around();
        let time = Time { instant: self.clock, ..Time::now() };
        let mut context = Context::new(&mut self.notices, &mut self.jobs, time, &mut self.asked);
        act(&mut self.workflow, &around, &mut context);
        self.work();
    }

    fn around(&self) -> TouchAround {
        let robot = Arc::new(self.robot.clone());
        TouchAround {
            rig: self.rig.clone(),
            robot,
            models: self.models.clone(),
            model: self.model.clone(),
            held: self.in_hand.clone(),
        }
    }

    /// Does the work that was asked for, and what follows from it.
    fn work(&mut self) {
        for asked in std::mem::take(&mut self.asked) {
            match asked {
                Asked::Start(id, work) if self.held.is_some_and(|title| work.title().contains(title)) => {
                    self.waiting.push_back((id, work));
                }
                Asked::Start(id, work) => self.finish_work(id, work),
                Asked::Control(control) => self.controls.push_back(control),
                Asked::Cancel(_) => {}
            }
        }
    }

    fn finish_work(&mut self, id: JobId, work: TouchWork) {
        match work.run(&Unattended) {
            Ok(result) => {
                self.with(|workflow, around, context| workflow.work_done(id, result, around, context));
            }
            Err(error) => {
                self.notices.add(NoticeLevel::Error, error.to_string());
                self.with(|workflow, around, context| workflow.work_ended(id, None, around, context));
            }
        }
    }

    /// Lets work go on that was held.
    pub fn release(&mut self) {
        self.held = None;
        while let Some((id, work)) = self.waiting.pop_front() {
            self.finish_work(id, work);
        }
    }

    /// Work that was held ends as if it had been cancelled.
    pub fn cancel(&mut self) {
        while let Some((id, _)) = self.waiting.pop_front() {
            self.with(|workflow, around, context| workflow.work_ended(id, None, around, context));
        }
    }

    /// Applies a command.
    pub fn apply(&mut self, command: TouchCommand) {
        self.with(|workflow, around, context| workflow.apply(command, around, context));
    }

    /// Time passes, then the robot has something new.
    pub fn wait(&mut self, time: Duration) {
        self.clock += time;
        self.step();
    }

    pub fn step(&mut self) {
        self.with(|workflow, around, context| workflow.step(around, context));
    }

    pub fn view(&self) -> TouchView {
        self.workflow.shown(&self.around(), self.clock)
    }

    /// The newest message.
    pub fn said(&mut self) -> String {
        self.notices.view().last().map(|notice| notice.text.clone()).unwrap_or_default()
    }

    /// Plans and starts.
    pub fn start(&mut self, options: PlanOptions) {
        self.apply(TouchCommand::Plan(options));
        assert_eq!(self.view().phase, TouchPhase::Planned, "{}", self.said());
        self.apply(TouchCommand::Start);
    }

    /// The order that the robot's thread has got.
    pub fn order(&mut self) -> Option<TouchOrder> {
        while let Some(control) = self.controls.pop_front() {
            if let RobotControl::Touch(order) = control {
                return Some(*order);
            }
        }
        None
    }

    /// The order that the robot's thread has got to go away from the screen.
    pub fn withdrawal(&mut self) -> Option<WithdrawOrder> {
        while let Some(control) = self.controls.pop_front() {
            if let RobotControl::Withdraw(order) = control {
                return Some(*order);
            }
        }
        None
    }

    /// The arm goes away from the screen as ordered.
    pub fn withdraw(&mut self, order: &WithdrawOrder) {
        self.robot.measured = order.way.last().cloned();
        self.say_away(order, TouchRun::Away);
    }

    /// What the robot says of its way from the screen.
    pub fn say_away(&mut self, order: &WithdrawOrder, state: TouchRun) {
        let news = TouchNews { order: order.order, number: order.number, state };
        self.with(|workflow, around, context| workflow.news(news, around, context));
    }

    /// What the robot says of an order.
    pub fn say(&mut self, order: &TouchOrder, state: TouchRun) {
        let news = TouchNews { order: order.order, number: Some(order.number), state };
        self.with(|workflow, around, context| workflow.news(news, around, context));
    }

    /// The robot does as ordered.
    pub fn touch(&mut self, order: &TouchOrder) {
        self.say(order, TouchRun::Doing(TouchStage::Lowering));
        let measured = self.measure(order);
        self.say(order, TouchRun::Touched(Box::new(measured)));
    }

    /// What is measured when the robot does as ordered.
    pub fn measure(&mut self, order: &TouchOrder) -> TouchMeasurement {
        self.clock += Duration::from_secs(9);
        let view = self.view();
        let (sent, screen) = (view.touches[order.number - 1].sent, view.screen.expect("there is one"));
        let nearest = |a: &usize, b: &usize| {
            order.lower_tip[*a].distance_m(&sent).total_cmp(&order.lower_tip[*b].distance_m(&sent))
        };
        let at = (0..order.lower.len()).min_by(nearest).expect("a way down");
        let chain = self.rig.chain(&order.tip).expect("the tip");
        let angles: Vec<Option<f64>> = order.lower[at].of(chain.joints()).into_iter().map(Some).collect();
        let sent_px = screen.pixel_at(sent);
        let pixel = Pixel::new(sent_px.u_px + self.bias_px.0, sent_px.v_px + self.bias_px.1);
        let count = angles.len();
        TouchMeasurement {
            pixel,
            at: self.clock,
            commanded_rad: angles.clone(),
            commanded_tip: Some(sent),
            encoder_rad: angles.clone(),
            later_encoder_rad: angles,
            direction: vec![1; count],
            temperature_c: vec![Some(31.5); count],
            load: vec![Some(0.1); count],
            move_secs: 1.25,
            connected_secs: self.clock.saturating_duration_since(self.began).as_secs_f64(),
        }
    }

    /// The robot does whatever it is told, until nothing more comes.
    pub fn touch_all(&mut self) {
        while let Some(control) = self.controls.pop_front() {
            match control {
                RobotControl::Touch(order) => self.touch(&order),
                RobotControl::Withdraw(order) => self.withdraw(&order),
                _ => {}
            }
        }
    }
}

/// A part of the screen that the right arm reaches.
pub fn area() -> TouchArea {
    TouchArea { u_px: [900.0, 1300.0], v_px: [500.0, 850.0] }
}

/// A grid in that area, two of its targets twice more.
pub fn grid(columns: usize, rows: usize) -> PlanOptions {
    let again = Pattern::Again { targets: 2, times: 2 };
    PlanOptions { patterns: vec![Pattern::Grid { columns, rows }, again], ..PlanOptions::quick(area()) }
}

/// The only session of a folder.
pub fn only_session(folder: &Path) -> PathBuf {
    let sessions = std::fs::read_dir(folder.join("sessions")).expect("sessions");
    let mut sessions: Vec<PathBuf> = sessions.flatten().map(|entry| entry.path()).collect();
    assert_eq!(sessions.len(), 1, "{sessions:?}");
    sessions.remove(0)
}
