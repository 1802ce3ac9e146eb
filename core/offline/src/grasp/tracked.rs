//! The joints of a twin over time while it grasps, onto disk.

use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;

use plumbline_grasp::Step;
use plumbline_grasp::tracks::{EVERY_S, JointAt, JointsAt, Tracks};
use plumbline_model::files::FileError;
use plumbline_model::robot::Rig;
use plumbline_twin::{CoursePoint, Lockstep};

/// The joint tracks of an attempt that goes on, if they are kept. Clones share them.
#[derive(Clone, Default)]
pub(super) struct Tracked(Rc<RefCell<Kept>>);

#[derive(Default)]
struct Kept {
    tracks: Option<Tracks>,
    /// Why something was not kept.
    problem: Option<FileError>,
}

impl Tracked {
    /// From now on all joints of the twin are kept in this file, in place of what was in it.
    ///
    /// # Errors
    /// When it cannot be written: what cannot be kept is not begun.
    pub fn begin(file: &Path, twin: &mut Lockstep) -> Result<Self, FileError> {
        let tracks = Tracks::begin(file, twin.rig())?;
        twin.keep_course(EVERY_S);
        let tracked = Self(Rc::new(RefCell::new(Kept { tracks: Some(tracks), problem: None })));
        tracked.step(Step::Ready);
        tracked.take(twin);
        Ok(tracked)
    }

    /// A step begins.
    pub fn step(&self, step: Step) {
        if let Some(tracks) = &mut self.0.borrow_mut().tracks {
            tracks.step(step);
        }
    }

    /// Writes what the joints did since.
    pub fn take(&self, twin: &mut Lockstep) {
        let kept = &mut *self.0.borrow_mut();
        let Some(tracks) = &mut kept.tracks else { return };
        let rows: Vec<JointsAt> = twin.take_course().iter().map(|point| row(point, twin.rig())).collect();
        if let Err(problem) = tracks.add(&rows) {
            kept.problem.get_or_insert(problem);
        }
    }

    /// Nothing is kept any more; why something was not.
    pub fn end(&self, twin: &mut Lockstep) -> Option<FileError> {
        self.take(twin);
        twin.end_course();
        self.0.take().problem
    }
}

fn row(point: &CoursePoint, rig: &Rig) -> JointsAt {
    let joint = |joint| JointAt {
        measured_rad: Some(point.encoders[joint]),
        commanded_rad: Some(point.commanded[joint]),
    };
    let joints = rig.servos.iter().map(|servo| joint(servo.joint)).collect();
    JointsAt { at_s: point.at_s, joints }
}
