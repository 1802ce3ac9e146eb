//! The joints over time while an attempt goes on, onto disk: what the robot's thread has read, as soon as
//! there is time for it.

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_grasp::Step;
use plumbline_grasp::tracks::{EVERY_S, JointAt, JointsAt, Tracks};
use plumbline_hardware::joints::JointState;
use plumbline_model::files::FileError;

use super::body::Ropes;

/// While it is paused, which may be for hours, rows are this far apart, s.
const PAUSED_EVERY_S: f64 = 1.0;

/// The joint tracks of an attempt that goes on. Clones share them.
#[derive(Clone, Debug)]
pub struct LedTracks(Rc<RefCell<Kept>>);

#[derive(Debug)]
struct Kept {
    tracks: Tracks,
    ropes: Ropes,
    /// The clock of the attempt begins here.
    began: Instant,
    /// Of the last row.
    written_s: Option<f64>,
    /// Why something was not kept.
    problem: Option<FileError>,
}

impl LedTracks {
    /// From now on, what the joints of this robot do is kept.
    pub fn begin(tracks: Tracks, ropes: &Ropes, began: Instant) -> Self {
        ropes.leader.keep_course(Duration::from_secs_f64(EVERY_S));
        let kept = Kept { tracks, ropes: ropes.clone(), began, written_s: None, problem: None };
        Self(Rc::new(RefCell::new(kept)))
    }

    /// A step begins: what was read before is of the one before.
    pub fn step(&self, step: Step) {
        self.take();
        self.0.borrow_mut().tracks.step(step);
    }

    /// Writes what was read since. What cannot be kept ends the attempt.
    pub fn take(&self) {
        self.0.borrow_mut().take();
    }

    /// Writes what is left; why something was not kept.
    pub fn end(&self) -> Option<FileError> {
        self.take();
        self.0.borrow_mut().problem.take()
    }
}

impl Kept {
    fn take(&mut self) {
        let (states, lost) = self.ropes.leader.take_course();
        if lost > 0 {
            log::warn!("{lost} readings of the joints are not in the tracks: this machine is too busy");
        }
        let every_s = if self.ropes.reins.is_tight() { PAUSED_EVERY_S } else { 0.0 };
        let mut rows = vec![];
        for row in states.iter().filter_map(|state| row(state, self.began)) {
            if self.written_s.is_none_or(|written_s| row.at_s - written_s >= every_s) {
                self.written_s = Some(row.at_s);
                rows.push(row);
            }
        }
        if let Err(problem) = self.tracks.add(&rows) {
            log::error!("{problem}");
            self.problem.get_or_insert(problem);
            self.ropes.reins.end();
        }
    }
}

/// `None`: it was read before the attempt began.
fn row(state: &Arc<JointState>, began: Instant) -> Option<JointsAt> {
    let after = state.stamp.captured_at.checked_duration_since(began)?;
    let joints = state.joints.iter().map(|reading| JointAt {
        measured_rad: reading.angle_rad.filter(|_| state.knows(reading.joint)),
        commanded_rad: reading.goal_rad,
    });
    Some(JointsAt { at_s: after.as_secs_f64(), joints: joints.collect() })
}

#[cfg(test)]
mod tests {
    use plumbline_grasp::tracks::FILE;
    use plumbline_model::robot::Rig;

    use super::*;
    use crate::grasp::sights::Sights;
    use crate::robot::{Leader, Led, Reins, made_up};

    struct Desk {
        folder: tempfile::TempDir,
        rig: Rig,
        led: Led,
        reins: Reins,
        began: Instant,
        tracks: LedTracks,
    }

    impl Desk {
        fn new() -> Self {
            let folder = tempfile::tempdir().expect("a temporary folder");
            let (rig, reins) = (Rig::built_in("nico").expect("comes with the program"), Reins::default());
            let (leader, led) = Leader::pair("grasping", true, &reins);
            let ropes = Ropes { leader, sights: Sights::default(), reins: reins.clone(), eyes_on: None };
            let began = Instant::now();
            let tracks = Tracks::begin(&folder.path().join(FILE), &rig).expect("writable");
            let tracks = LedTracks::begin(tracks, &ropes, began);
            Self { folder, rig, led, reins, began, tracks }
        }

        /// The robot's thread has read the joints ten times a second from one time (ms) to another.
        fn read(&self, from: u64, until: u64) {
            let silent = [self.rig.servos[1].joint];
            for ms in (from..until).step_by(100) {
                let at = self.began + Duration::from_millis(ms);
                self.led.note(&made_up::state(&self.rig, at, [0.1, 0.2], &silent));
            }
        }

        fn rows(&self) -> Vec<Vec<String>> {
            let text = std::fs::read_to_string(self.folder.path().join(FILE)).expect("there");
            text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
        }
    }

    #[test]
    fn what_was_read_before_a_step_began_is_of_the_one_before() {
        let desk = Desk::new();
        // Before the clock of the attempt began.
        let early = desk.began.checked_sub(Duration::from_millis(150)).expect("the machine runs for longer");
        desk.led.note(&made_up::state(&desk.rig, early, [0.0; 2], &[]));
        desk.tracks.step(Step::Approach);
        desk.read(0, 500);
        desk.tracks.step(Step::Lower);
        desk.read(500, 700);
        assert!(desk.tracks.end().is_none());
        let rows = desk.rows();
        let of = |step: &str| rows.iter().filter(|row| row.last().is_some_and(|of| of == step)).count();
        assert_eq!((rows.len(), of("approach"), of("lower")), (7, 5, 2), "{rows:?}");
        assert_eq!(rows[1][..5], ["0.100", "0.1000", "0.2000", "", "0.2000"], "the second servo is silent");
    }

    #[test]
    fn while_it_is_paused_a_row_a_second_is_enough() {
        let desk = Desk::new();
        desk.tracks.step(Step::Approach);
        desk.read(0, 300);
        desk.tracks.take();
        desk.reins.hold_tight(true);
        desk.read(300, 5200);
        desk.tracks.take();
        desk.reins.hold_tight(false);
        desk.read(5200, 5500);
        assert!(desk.tracks.end().is_none());
        let times: Vec<String> = desk.rows().into_iter().map(|row| row[0].clone()).collect();
        let paused = ["1.200", "2.200", "3.200", "4.200"];
        let wanted = [&["0.000", "0.100", "0.200"][..], &paused, &["5.200", "5.300", "5.400"]].concat();
        assert_eq!(times, wanted);
    }
}
