//! What tying the arms to the eyes sees of the rest, and what follows when it was accepted.

use std::path::Path;

use super::State;
use super::rooms::Neighbors;
use crate::gap::GapWorkflow;
use crate::grasp::{GraspAround, GraspWorkflow};
use crate::ground::World;
use crate::handeye::{HandEyeAround, HandEyeWorkflow};

impl Neighbors<HandEyeWorkflow> for State {
    fn around(&self, world: World) -> HandEyeAround {
        let (gap, touch) = (self.rooms.gap.of(world), self.rooms.touch.of(world));
        // Those that the model was learned from, else those that were made to learn from, on whatever day. What was
        // touched to check a model was sent elsewhere on purpose.
        let searched = gap.found().map(|(shown, _)| shown.folders.clone());
        let one = searched.and_then(|folders| <[_; 1]>::try_from(folders).ok()).map(|[folder]| folder);
        let is_twin = world == World::Twin && self.twin.running;
        // A look of its own is not in its own way.
        let grasp = GraspAround {
            goes_first: touch.in_the_way(),
            ..<Self as Neighbors<GraspWorkflow>>::around(self, world)
        };
        HandEyeAround {
            waits: self.rooms.grasp.of(world).waits(&grasp),
            grasp,
            added: gap.model().cloned(),
            is_changing: gap.is_changing(),
            touches: one.or_else(|| touch.trained_session().map(Path::to_owned)),
            sessions: touch.sessions(),
            held: self.rooms.grasp.of(world).in_hand(),
            twin: is_twin.then(|| self.twin.clone()),
        }
    }

    fn after(&mut self, world: World) {
        if let Some(model) = self.rooms.handeye.of_mut(world).take_accepted() {
            self.with::<GapWorkflow>(world, |gap, around, context| gap.put_in_use(model, around, context));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;
    use std::time::Duration;

    use jiff::Timestamp;
    use plumbline_model::robot::default_rig;
    use plumbline_model::session::{Chain, Manifest, names};
    use plumbline_model::touch_plan::{Finger, Purpose};
    use plumbline_model::{Pixel, Unattended};

    use super::*;
    use crate::ground::jobs::Outcome;
    use crate::state::Action;
    use crate::touch::record::Progress;
    use crate::touch::store::PROGRESS;
    use crate::touch::testing::record;

    /// A finished run of one touch, as a lab keeps it.
    fn run(lab: &Path, name: &str, (purpose, finger, started): (Purpose, Finger, Timestamp)) -> PathBuf {
        let session = lab.join("sessions").join(name);
        std::fs::create_dir_all(&session).expect("made");
        let rig = default_rig();
        let manifest = Manifest {
            touchscreen: Some(rig.touchscreen.clone()),
            chain: Some(Chain { tip: finger.tip().to_owned(), joints: vec!["r_shoulder_z".to_owned()] }),
            ..Manifest::of_rig(&rig.name, started)
        };
        manifest.write(&session.join(names::MANIFEST)).expect("written");
        let mut progress = Progress::new(purpose, started, 1);
        progress.records = vec![record(1, "g", Pixel::new(100.0, 200.0), Pixel::new(101.0, 201.0))];
        progress.finished = true;
        let text = serde_json::to_string(&progress).expect("it can be said");
        std::fs::write(session.join(PROGRESS), text).expect("written");
        session
    }

    /// What was accepted and done before is read.
    fn opened(lab: &Path) -> State {
        let mut state = State::new(lab);
        loop {
            let actions = state.take_actions();
            let works: Vec<_> = actions
                .into_iter()
                .filter_map(|action| match action {
                    Action::Start(id, work) => Some((id, work)),
                    _ => None,
                })
                .collect();
            if works.is_empty() {
                return state;
            }
            for (id, work) in works {
                let result = work.run(&Unattended).expect("it can be read");
                state.work_ended(id, Outcome::Done(result), Duration::ZERO);
            }
        }
    }

    #[test]
    fn a_lab_that_is_opened_again_finds_its_touches_and_none_says_where_it_looked() {
        let folder = tempfile::tempdir().expect("a folder for the test");
        let lab = folder.path();
        let around = |state: &State| <State as Neighbors<HandEyeWorkflow>>::around(state, World::Robot);
        let none = around(&opened(lab));
        assert_eq!((none.touches, none.sessions), (None, lab.join("sessions")));
        let at = |second| Timestamp::from_second(second).expect("a time");
        let learned = run(lab, "learned", (Purpose::Train, Finger::Right, at(1_000)));
        run(lab, "checked", (Purpose::Check, Finger::Right, at(2_000)));
        assert_eq!(
            around(&opened(lab)).touches.as_ref(),
            Some(&learned),
            "a check is not what is learned from"
        );
        run(lab, "left", (Purpose::Train, Finger::Left, at(2_500)));
        assert_eq!(
            around(&opened(lab)).touches,
            Some(learned),
            "the other arm is not the one that was learned"
        );
        let newer = run(lab, "newer", (Purpose::Train, Finger::Right, at(3_000)));
        assert_eq!(around(&opened(lab)).touches, Some(newer));
    }
}
