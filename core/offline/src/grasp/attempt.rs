//! One attempt on a twin, carried out and judged.

use std::cell::RefCell;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;

use plumbline_engine::grasp::{Keeping, KeepingError, image_name};
use plumbline_engine::trials::Judged;
use plumbline_grasp::attempt::HandFinder;
use plumbline_grasp::plan::GraspPlan;
use plumbline_grasp::record::Iteration;
use plumbline_grasp::see::{Looker, Seen};
use plumbline_grasp::{
    Body, Grasper, Grip, Halt, Hand, HoldWatch, Knowledge, Order, Record, ServoState, Sight, Step, Watch,
};
use plumbline_model::robot::{Posture, Rig};
use plumbline_twin::eyes::EyeRenderer;
use plumbline_twin::{Lockstep, Scenario, Toy};
use plumbline_vision::detect::{DetectSettings, DetectorOptions, shipped_detector};

use super::judge::Judge;
use super::tracked::Tracked;
use crate::OfflineError;
use crate::twin_body::TwinBody;

/// Since the eyes were switched on, s: they have warmed up, as in the published experiment.
const WARM_S: f64 = 1800.0;

/// What is still in the hand this long after the attempt is held, s: a thing can be there when it is looked
/// for and fall out later.
const HOLDS_S: f64 = 10.0;
/// In this time the hand is felt once, s.
const FEELS_S: f64 = 0.5;

/// Somebody who interferes with an attempt.
pub(super) trait Meddler {
    /// The twin before it begins.
    fn before(&mut self, _twin: &mut Lockstep) {}

    /// Does something before the arm moves along a way, or ends it.
    fn moves(&mut self, _step: Step, _way: &[Posture], _twin: &mut Lockstep) -> Result<(), Halt> {
        Ok(())
    }

    /// Changes what the eyes have seen.
    fn sees(&mut self, _step: Step, _sight: &mut Sight) {}

    /// Keeps the eyes from giving a pair.
    fn blinds(&mut self, _step: Step) -> Result<(), Halt> {
        Ok(())
    }

    /// Changes what the servos say.
    fn feels(&mut self, _step: Step, _servos: &mut [ServoState]) {}

    /// Is told what goes to disk before a step begins.
    fn keeps(&mut self, _record: &Record) {}
}

/// Who does something before moves only.
impl<F: FnMut(Step, &mut Lockstep) -> Result<(), Halt>> Meddler for F {
    fn moves(&mut self, step: Step, _way: &[Posture], twin: &mut Lockstep) -> Result<(), Halt> {
        self(step, twin)
    }
}

/// Nobody interferes.
impl Meddler for () {}

/// What attempts of one twin share.
pub(super) struct Bench {
    rig: Arc<Rig>,
    scenario: Scenario,
    grasper: Grasper,
    eyes: Option<EyeRenderer>,
    /// Where records and images of attempts go.
    keeping: Option<Keeping>,
    /// Where the joint tracks of the next attempt go.
    tracks: Option<PathBuf>,
    /// Why something of the last attempt was not kept.
    problem: Option<KeepingError>,
}

/// A thing at a place, and how it is to be grasped.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Task {
    pub order: Order,
    pub toy: Toy,
    pub at_m: [f64; 2],
    pub seed: u64,
}

impl Bench {
    pub fn new(
        rig: Arc<Rig>,
        scenario: Scenario,
        knowledge: Knowledge,
        finder: &mut dyn FnMut(Hand) -> Option<Box<dyn HandFinder>>,
    ) -> Result<Self, OfflineError> {
        let shipped = shipped_detector().ok_or(OfflineError::NoDetector)?;
        // One thread, so that a sum of numbers is the same on every machine.
        let options = DetectorOptions { threads: Some(1), ..DetectorOptions::default() };
        let looker = Looker::new(shipped.open(&options)?, &knowledge, DetectSettings::default());
        let grasper = Grasper::new(knowledge, looker, finder)?;
        Ok(Self { rig, scenario, grasper, eyes: None, keeping: None, tracks: None, problem: None })
    }

    /// From now on, record and images of an attempt go into this folder, as in the window.
    pub fn keep_in(&mut self, folder: PathBuf) -> Result<(), OfflineError> {
        plumbline_model::files::make_folder(&folder)?;
        self.keeping = Some(Keeping::of(folder));
        Ok(())
    }

    /// From now on, the joints of an attempt go into this file as it goes on, in place of what was in it.
    pub fn track_in(&mut self, file: PathBuf) {
        self.tracks = Some(file);
    }

    /// The robot as described.
    #[cfg(test)]
    pub fn rig(&self) -> &Rig {
        &self.rig
    }

    /// What plans, sees and grasps.
    #[cfg(test)]
    pub fn grasper(&self) -> &Grasper {
        &self.grasper
    }

    /// Carries out one attempt in a world of its own, whose clock begins in 1970: two runs of the same
    /// attempt are the same file.
    pub fn attempt(&mut self, task: &Task) -> Result<(Record, Judged), OfflineError> {
        self.attempt_disturbed(task, &mut ())
    }

    /// The same, with somebody who interferes.
    pub fn attempt_disturbed(
        &mut self,
        task: &Task,
        meddler: &mut dyn Meddler,
    ) -> Result<(Record, Judged), OfflineError> {
        let mut body = self.world(task)?;
        let done = self.attempt_in(&mut body, task, meddler);
        self.put_away(body);
        let done = done?;
        if let Some(problem) = self.problem.take() {
            return Err(problem.into());
        }
        if let Some(keeping) = &self.keeping {
            keeping.record(&done.0)?;
        }
        Ok(done)
    }

    /// A world of its own for attempts one after another, with the thing in its place and the robot at home.
    pub fn world(&mut self, task: &Task) -> Result<TwinBody, OfflineError> {
        let mut twin =
            Lockstep::new(self.rig.clone(), &self.scenario, task.seed)?.with_eyes(self.eyes.take());
        twin.advance_warm_up(WARM_S);
        Ok(TwinBody::new(twin, task.toy, task.at_m)?)
    }

    /// Ends a world; the next one draws with its eyes.
    pub fn put_away(&mut self, body: TwinBody) {
        self.eyes = body.into_twin().take_eyes();
    }

    /// One attempt in a world as it is now. What cannot be kept is not begun.
    pub fn attempt_in(
        &mut self,
        body: &mut TwinBody,
        task: &Task,
        meddler: &mut dyn Meddler,
    ) -> Result<(Record, Judged), OfflineError> {
        body.taken_over();
        meddler.before(body.twin());
        let judge = Rc::new(RefCell::new(Judge::new(body.twin(), task.toy, &self.rig)));
        let step = Rc::new(RefCell::new(Step::Ready));
        let meddler = RefCell::new(meddler);
        let tracked = match &self.tracks {
            Some(file) => Tracked::begin(file, body.twin()).map_err(KeepingError::from)?,
            None => Tracked::default(),
        };
        let mut watched = Watched {
            body: &mut *body,
            judge: judge.clone(),
            step: step.clone(),
            meddler: &meddler,
            tracked: tracked.clone(),
            last: Step::Ready,
        };
        let keeping = self.keeping.as_ref();
        let (kept, number) = (tracked.clone(), 1);
        let mut watch =
            Steps { step, meddler: &meddler, tracked: kept, keeping, number, looks: 0, problem: None };
        let mut record =
            self.grasper.attempt(&mut watched, &task.order, jiff::Timestamp::UNIX_EPOCH, &mut watch);
        self.problem = watch.problem.or(tracked.end(body.twin()).map(KeepingError::from));
        self.hold(body, &mut record);
        let judged = judge.borrow().judge(body.twin(), &record);
        Ok((record, judged))
    }

    /// Stands still with what is in the hand; as in the window, the record keeps that it slipped out.
    fn hold(&self, body: &mut TwinBody, record: &mut Record) {
        let grip = Grip::of_rig(&self.rig, record.hand).filter(|_| record.is_success());
        let mut watch = grip.map(HoldWatch::new);
        let ended_s = body.now_s();
        while body.now_s() - ended_s < HOLDS_S || watch.as_ref().is_some_and(HoldWatch::doubts) {
            body.twin().wait(FEELS_S);
            let Some(felt) = &mut watch else { continue };
            record.slipped_after_s = felt.feel(body.servos().ok().as_deref(), body.now_s() - ended_s);
            if record.slipped_after_s.is_some() {
                watch = None;
            }
        }
    }
}

/// Tells the judge where the attempt is, and the meddler what is kept; keeps what is seen.
struct Steps<'a, 'm> {
    step: Rc<RefCell<Step>>,
    meddler: &'a RefCell<&'m mut dyn Meddler>,
    tracked: Tracked,
    keeping: Option<&'a Keeping>,
    /// Which try it is, from 1.
    number: usize,
    /// Looks at the hand in this try.
    looks: usize,
    /// Why something was not kept.
    problem: Option<KeepingError>,
}

impl Watch for Steps<'_, '_> {
    fn step(&mut self, step: Step) {
        *self.step.borrow_mut() = step;
        self.tracked.step(step);
    }

    fn about_to(&mut self, record: &Record) {
        self.meddler.borrow_mut().keeps(record);
        if let Some(Err(problem)) = self.keeping.map(|keeping| keeping.record(record)) {
            self.problem = Some(problem);
        }
    }

    fn again(&mut self, number: usize, _of: usize, _why: &str) {
        (self.number, self.looks) = (number, 0);
    }

    fn saw(&mut self, step: Step, sight: &Sight, _seen: &[Seen]) {
        self.looks += usize::from(step == Step::Align);
        let name = image_name(self.number, step, self.looks);
        if let Some(Err(problem)) = self.keeping.map(|keeping| keeping.images(&name, sight)) {
            self.problem = Some(problem);
        }
    }

    fn planned(&mut self, _plan: &GraspPlan) {}

    fn aligned(&mut self, _iteration: &Iteration) {}
}

/// A body with a judge at its side, who looks at it and is not seen.
struct Watched<'a, 'm> {
    body: &'a mut TwinBody,
    judge: Rc<RefCell<Judge>>,
    step: Rc<RefCell<Step>>,
    meddler: &'a RefCell<&'m mut dyn Meddler>,
    tracked: Tracked,
    /// Of the last move.
    last: Step,
}

impl Body for Watched<'_, '_> {
    fn rig(&self) -> &Arc<Rig> {
        self.body.rig()
    }

    fn now_s(&self) -> f64 {
        self.body.now_s()
    }

    fn servos(&mut self) -> Result<Vec<ServoState>, Halt> {
        let mut servos = self.body.servos()?;
        self.meddler.borrow_mut().feels(*self.step.borrow(), &mut servos);
        Ok(servos)
    }

    fn commanded(&mut self) -> Result<Posture, Halt> {
        self.body.commanded()
    }

    fn follow(&mut self, way: &[Posture], speed_rad_s: f64) -> Result<(), Halt> {
        let step = *self.step.borrow();
        self.meddler.borrow_mut().moves(step, way, self.body.twin())?;
        if step == Step::Close && self.last != Step::Close {
            self.judge.borrow_mut().closing(self.body.twin());
        }
        self.last = step;
        let done = self.body.follow(way, speed_rad_s);
        self.tracked.take(self.body.twin());
        done
    }

    fn grip(&mut self) -> Result<(), Halt> {
        self.body.grip()
    }

    fn wait(&mut self, duration_s: f64) -> Result<(), Halt> {
        let done = self.body.wait(duration_s);
        self.tracked.take(self.body.twin());
        done
    }

    fn look(&mut self) -> Result<Sight, Halt> {
        let step = *self.step.borrow();
        match step {
            Step::Look => self.judge.borrow_mut().looked(self.body.twin()),
            Step::Align => self.judge.borrow_mut().aligned(self.body.twin()),
            _ => {}
        }
        let mut sight = self.body.look()?;
        self.meddler.borrow_mut().blinds(step)?;
        self.meddler.borrow_mut().sees(step, &mut sight);
        Ok(sight)
    }
}
