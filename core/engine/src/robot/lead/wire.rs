//! What passes between who leads the arm and the robot's thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender};
use plumbline_hardware::joints::JointState;
use plumbline_model::robot::collision::Allowance;
use plumbline_model::robot::{JointIndex, Posture};

use super::course::Course;

/// One order is under way at a time; a second place lets it be ended.
const WAITING: usize = 4;

/// What is to be done.
#[derive(Clone, Debug, PartialEq)]
pub enum LeadOrder {
    /// Through places one after another, each joints and their angles (rad), to rest at the last.
    Follow {
        /// Joints that are named nowhere stay.
        way: Vec<Vec<(JointIndex, f64)>>,
        /// Peak joint speed, rad/s.
        speed_rad_s: f64,
    },
    /// Fingers bend until they are at these angles (rad) or meet something, each for itself.
    Close {
        /// Fingers and how far they bend around nothing.
        goals: Vec<(JointIndex, f64)>,
    },
    /// From now on these may meet; empty: nothing may.
    MayTouch(Vec<Allowance>),
    /// Ends what is under way; the arm holds.
    Hold,
    /// How the joints are.
    State,
    /// Where the joints were.
    At(Instant),
}

/// What became of it.
#[derive(Clone, Debug)]
pub enum LeadAnswer {
    /// It was done.
    Done,
    /// How the joints are.
    State(Arc<JointState>),
    /// Where they were; `None`: that moment is not, or not yet, covered.
    At(Option<Posture>),
    /// It was not carried out to its end; the arm holds.
    GivenUp(GivenUp),
}

/// Why an order ended early. Reads as a sentence.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GivenUp {
    /// STOP.
    #[error("STOP was pressed")]
    Stopped,
    /// The robot does not answer, or not all of it.
    #[error("{0}")]
    Lost(String),
    /// What protects the robot refused.
    #[error("{0}")]
    Refused(String),
}

/// Held tight, the arm stands wherever it is, and goes on when they are let loose.
#[derive(Clone, Debug, Default)]
pub struct Reins {
    tight: Arc<AtomicBool>,
    ended: Arc<AtomicBool>,
}

impl Reins {
    /// Pauses, or goes on.
    pub fn hold_tight(&self, tight: bool) {
        self.tight.store(tight, Ordering::Release);
    }

    /// Whether it pauses.
    pub fn is_tight(&self) -> bool {
        self.tight.load(Ordering::Acquire)
    }

    /// It shall end as soon as it can, for good.
    pub fn end(&self) {
        self.ended.store(true, Ordering::Release);
    }

    /// Whether it shall end.
    pub fn is_ended(&self) -> bool {
        self.ended.load(Ordering::Acquire)
    }
}

/// The side of the robot's thread.
#[derive(Clone, Debug)]
pub struct Led {
    /// What is being done, for people: "grasping".
    pub title: String,
    /// Whether the arm may move by it.
    pub moves: bool,
    pub(super) orders: Receiver<LeadOrder>,
    answers: Sender<LeadAnswer>,
    pub(super) reins: Reins,
    course: Course,
    waits: Arc<AtomicBool>,
}

impl Led {
    /// How the joints are now, for who wants to know it all the time.
    pub(crate) fn note(&self, state: &Arc<JointState>) {
        self.course.note(state);
    }

    /// Whether the arm stands and waits for joints that were late.
    pub(super) fn wait(&self, waits: bool) {
        self.waits.store(waits, Ordering::Release);
    }

    /// An answer that nobody waits for is let go: whoever leads has ended.
    pub(super) fn tell(&self, answer: LeadAnswer) {
        if let Err(error) = self.answers.try_send(answer) {
            log::debug!("an answer of the arm was not waited for: {error}");
        }
    }
}

/// The side of whoever leads. Dropped, the arm holds and is free for others.
#[derive(Clone, Debug)]
pub struct Leader {
    orders: Sender<LeadOrder>,
    answers: Receiver<LeadAnswer>,
    course: Course,
    waits: Arc<AtomicBool>,
}

impl Leader {
    /// Both sides; `moves`: whether the arm may move by it.
    pub fn pair(title: &str, moves: bool, reins: &Reins) -> (Self, Led) {
        let (orders_in, orders) = crossbeam_channel::bounded(WAITING);
        let (answers_in, answers) = crossbeam_channel::bounded(WAITING);
        let (course, waits) = (Course::default(), Arc::<AtomicBool>::default());
        let led = Led {
            title: title.to_owned(),
            moves,
            orders,
            answers: answers_in,
            reins: reins.clone(),
            course: course.clone(),
            waits: waits.clone(),
        };
        (Self { orders: orders_in, answers, course, waits }, led)
    }

    /// From now on what the joints do is kept, also while an order is carried out: their states, this far
    /// apart at least.
    pub fn keep_course(&self, every: Duration) {
        self.course.keep(every);
    }

    /// The states since this was asked last, oldest first, and how many more there were than could wait.
    pub fn take_course(&self) -> (Vec<Arc<JointState>>, usize) {
        self.course.take()
    }

    /// Whether the arm stands by itself and waits for joints that this computer was too busy to hear: that is no time
    /// in which it moves.
    pub fn waits(&self) -> bool {
        self.waits.load(Ordering::Acquire)
    }

    /// Hands an order over.
    ///
    /// # Errors
    /// When there is nobody who could carry it out.
    pub fn order(&self, order: LeadOrder) -> Result<(), GivenUp> {
        self.orders.send_timeout(order, Duration::from_secs(2)).map_err(|_| self.why_gone())
    }

    /// Why nobody is there any more, as far as it was told: who may not lead at all was told so before his first order.
    fn why_gone(&self) -> GivenUp {
        let told = self.answers.try_iter().filter_map(|answer| match answer {
            LeadAnswer::GivenUp(why) => Some(why),
            _ => None,
        });
        told.last().unwrap_or_else(connection_ended)
    }

    /// What became of it; `None` when that is not known within this time.
    ///
    /// # Errors
    /// When it was given up, or there is nobody who could.
    pub fn answer(&self, patience: Duration) -> Result<Option<LeadAnswer>, GivenUp> {
        match self.answers.recv_timeout(patience) {
            Ok(LeadAnswer::GivenUp(why)) => Err(why),
            Ok(answer) => Ok(Some(answer)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(connection_ended()),
        }
    }
}

fn connection_ended() -> GivenUp {
    GivenUp::Lost("the connection to the arm ended: connect again".to_owned())
}
