//! How an attempt goes on, for the window; and what is kept of it on the way.

use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::Point3;
use plumbline_grasp::plan::GraspPlan;
use plumbline_grasp::see::Seen;
use plumbline_grasp::{Failure, Knowledge, Method, Outcome, Record, Sight, Step, Watch};
use plumbline_model::robot::Posture;
use plumbline_model::{Eye, JobContext};

use super::keeping::{Keeping, KeepingError, image_name};
use super::stepwise::StopAfterEach;
use super::tracks::LedTracks;
use super::view::{BetweenSteps, GraspIteration, GraspRun, LampState};
use crate::robot::Reins;

/// What the window sees of an attempt while it goes on. Clones share it.
#[derive(Clone, Debug, Default)]
pub struct Progress(Arc<Mutex<GraspRun>>);

impl Progress {
    /// Of an attempt that begins.
    pub fn new(method: Method, object: &str) -> Self {
        let lamps = steps_of(method).map(|step| (step, LampState::Dark)).collect();
        let tries = [1, method.tries()];
        let object = object.to_owned();
        let run = GraspRun { method: Some(method), object, lamps, tries, ..GraspRun::default() };
        Self(Arc::new(Mutex::new(run)))
    }

    /// As it is now.
    pub fn run(&self) -> GraspRun {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Changes it.
    pub fn change(&self, change: impl FnOnce(&mut GraspRun)) {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner));
    }

    /// Everything that the record of its end says.
    pub fn ended(&self, record: &Record) {
        self.change(|run| {
            run.outcome.clone_from(&record.outcome);
            run.fingers_open_rad = record.fingers_open_rad;
            run.seconds = record.seconds;
            let last = match &record.outcome {
                // Whether it holds was looked at: all steps were made.
                Some(Outcome::Success) | None => LampState::Done,
                Some(Outcome::Failed { failure: Failure::Slipped | Failure::ReachWrong, .. }) => {
                    LampState::Done
                }
                _ => LampState::Failed,
            };
            run.lamps
                .iter_mut()
                .filter(|(_, lamp)| *lamp == LampState::Lit)
                .for_each(|(_, lamp)| *lamp = last);
        });
    }
}

fn steps_of(method: Method) -> impl Iterator<Item = Step> {
    Step::ALL.into_iter().filter(move |step| *step != Step::Align || method.aligns())
}

/// Watches an attempt: tells the window, and keeps what has to be on disk before it goes on.
pub struct Watcher<'a> {
    progress: Progress,
    keeping: Option<Keeping>,
    context: &'a dyn JobContext,
    reins: Reins,
    /// Whether it holds after each step.
    pub stops: StopAfterEach,
    /// Where what the joints do is kept, if it is.
    pub tracks: Option<LedTracks>,
    knowledge: Knowledge,
    /// Which try it is, from 1.
    number: usize,
    /// Looks at the hand in this try.
    looks: usize,
    /// Where the joints were at the last look.
    looked_from: Option<Posture>,
    /// The plan that was shown last.
    pub plan: Option<GraspPlan>,
    /// Why it could not be kept, so that it was ended.
    pub problem: Option<KeepingError>,
}

impl<'a> Watcher<'a> {
    /// `keeping`: where it is kept, if it is.
    pub fn new(
        progress: Progress,
        keeping: Option<Keeping>,
        context: &'a dyn JobContext,
        reins: Reins,
        knowledge: Knowledge,
    ) -> Self {
        let (number, looks) = (1, 0);
        let (plan, problem, looked_from) = (None, None, None);
        let (stops, tracks) = (StopAfterEach::default(), None);
        Self {
            progress,
            keeping,
            context,
            reins,
            stops,
            tracks,
            knowledge,
            number,
            looks,
            looked_from,
            plan,
            problem,
        }
    }

    /// Where a point (robot frame, m) is in both eyes at the last look, raw px.
    fn in_eyes(&self, [x_m, y_m, z_m]: [f64; 3]) -> [Option<[f64; 2]>; 2] {
        let Some(posture) = &self.looked_from else { return [None; 2] };
        let cameras = &self.knowledge.calibration.cameras;
        let left_from_robot = self.knowledge.robot_from_left(posture).isometry.inverse();
        let in_left = left_from_robot * Point3::new(x_m, y_m, z_m);
        let in_right = cameras.right_from_left.isometry * in_left;
        let pixel = |eye: Eye, point: Point3<f64>| {
            cameras.camera(eye).model.project(&point.coords).ok().map(|pixel| [pixel.u_px, pixel.v_px])
        };
        [pixel(Eye::Left, in_left), pixel(Eye::Right, in_right)]
    }

    /// How many steps are behind it, and what it does.
    fn tell(&self, step: Step, doing: &str) {
        let place = Step::ALL.iter().position(|other| *other == step).unwrap_or_default();
        self.context.report(place as f64 / Step::ALL.len() as f64, doing);
    }

    /// Keeps something; what cannot be kept ends the attempt.
    fn keep(&mut self, keep: impl FnOnce(&Keeping) -> Result<(), KeepingError>) {
        if let Some(keeping) = &self.keeping
            && let Err(problem) = keep(keeping)
        {
            log::error!("{problem}");
            self.problem.get_or_insert(problem);
            self.reins.end();
        }
    }
}

impl Watch for Watcher<'_> {
    fn again(&mut self, number: usize, tries: usize, why: &str) {
        (self.number, self.looks) = (number, 0);
        self.progress.change(|run| {
            run.tries = [number, tries];
            run.again = Some(why.to_owned());
            run.lamps.iter_mut().for_each(|(_, lamp)| *lamp = LampState::Dark);
            run.iterations.clear();
            (run.wanted_px, run.hand_px) = ([None; 2], [None; 2]);
        });
    }

    fn step(&mut self, step: Step) {
        if let Some(tracks) = &self.tracks {
            tracks.step(step);
        }
        self.progress.change(|run| {
            if step != Step::Again {
                run.again = None;
            }
            for (other, lamp) in &mut run.lamps {
                if *other == step {
                    *lamp = LampState::Lit;
                } else if *lamp == LampState::Lit {
                    *lamp = LampState::Done;
                }
            }
        });
        self.tell(step, &step.title().to_lowercase());
    }

    fn saw(&mut self, step: Step, sight: &Sight, seen: &[Seen]) {
        self.looks += usize::from(step == Step::Align);
        let name = image_name(self.number, step, self.looks);
        self.keep(|keeping| keeping.images(&name, sight));
        self.looked_from = Some(sight.posture.clone());
        if !seen.is_empty() || step != Step::Align {
            self.progress.change(|run| run.seen = seen.to_vec());
        }
        self.tell(step, &step.title().to_lowercase());
    }

    fn planned(&mut self, plan: &GraspPlan) {
        let wanted_px = self.in_eyes(plan.palm_m.into());
        self.progress.change(|run| (run.hand, run.wanted_px) = (Some(plan.hand), wanted_px));
        self.plan = Some(plan.clone());
    }

    fn aligned(&mut self, iteration: &GraspIteration) {
        let hand_px = iteration.hand_m.map_or([None; 2], |hand_m| self.in_eyes(hand_m));
        self.progress.change(|run| {
            run.hand_px = hand_px;
            run.iterations.push(iteration.clone());
        });
        self.tell(Step::Align, "align");
    }

    fn about_to(&mut self, record: &Record) {
        self.keep(|keeping| keeping.record(record));
        self.progress.change(|run| run.chosen = record.chosen);
    }

    fn holds_between(&mut self, done: Step, next: Step) -> bool {
        let holds = self.stops.hold_between(BetweenSteps { done, next }, &self.progress, &self.reins);
        if holds {
            self.tell(next, &format!("holds before {}", next.title().to_lowercase()));
        }
        holds
    }
}

#[cfg(test)]
mod tests {
    use image::{Rgb, RgbImage};
    use jiff::Timestamp;
    use plumbline_effects::RobotModel;
    use plumbline_grasp::Corrections;
    use plumbline_model::robot::Rig;
    use plumbline_model::{StereoCalibration, Unattended};

    use super::*;

    fn knowledge() -> Knowledge {
        let rig = Arc::new(Rig::built_in("nico").expect("comes with the program"));
        Knowledge {
            model: RobotModel::nominal(rig.clone()),
            calibration: Arc::new(StereoCalibration::bare(rig.eyes.cameras)),
            described: rig,
            corrections: Corrections::default(),
        }
    }

    /// A pair that is gray all over.
    fn pair(knowledge: &Knowledge, gray: u8) -> Sight {
        let image = Arc::new(RgbImage::from_pixel(4, 3, Rgb([gray; 3])));
        let posture = knowledge.described.home();
        Sight { left: image.clone(), right: image, posture, at_s: 0.0, eyes_on_s: None, seq: 1 }
    }

    #[test]
    fn images_of_every_try_stay_on_disk() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let keeping = Keeping::begin(folder.path(), Method::M5, Timestamp::UNIX_EPOCH).expect("writable");
        let attempt = folder.path().join(keeping.name());
        let (knowledge, progress) = (knowledge(), Progress::new(Method::M5, "Tomato"));
        let mut watcher =
            Watcher::new(progress, Some(keeping), &Unattended, Reins::default(), knowledge.clone());
        for (number, gray) in [(1, 50), (2, 100), (3, 150)] {
            if number > 1 {
                watcher.again(number, 3, "the hand closed beside the tomato");
            }
            for step in [Step::Look, Step::Align, Step::Align, Step::Check] {
                watcher.saw(step, &pair(&knowledge, gray), &[]);
            }
        }
        assert!(watcher.problem.is_none(), "{:?}", watcher.problem);
        for (before, gray) in [("", 50), ("try2_", 100), ("try3_", 150)] {
            for name in ["before", "aligned_1", "aligned_2", "after"] {
                for eye in ["left", "right"] {
                    let file = attempt.join(format!("{before}{name}_{eye}.png"));
                    let seen = image::open(&file).unwrap_or_else(|error| panic!("{file:?}: {error}"));
                    assert_eq!(seen.to_rgb8().get_pixel(1, 1), &Rgb([gray; 3]), "{file:?}");
                }
            }
        }
        assert_eq!(std::fs::read_dir(&attempt).expect("there").count(), 24, "and nothing else");
    }
}
