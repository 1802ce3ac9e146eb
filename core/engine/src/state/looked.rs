//! What tying the arms to the eyes sees of the rest, and what follows when it was accepted.

use super::State;
use super::rooms::Neighbors;
use crate::gap::GapWorkflow;
use crate::grasp::GraspWorkflow;
use crate::ground::World;
use crate::handeye::{HandEyeAround, HandEyeWorkflow};

impl Neighbors<HandEyeWorkflow> for State {
    fn around(&self, world: World) -> HandEyeAround {
        let (gap, touch) = (self.rooms.gap.of(world), self.rooms.touch.of(world));
        // Those that the model was learned from, else those that were made last.
        let searched = gap.found().map(|(shown, _)| shown.folders.clone());
        let one = searched.and_then(|folders| <[_; 1]>::try_from(folders).ok()).map(|[folder]| folder);
        let newest = || touch.finished_session().map(|(session, _)| session.to_owned());
        let is_twin = world == World::Twin && self.twin.running;
        HandEyeAround {
            grasp: <Self as Neighbors<GraspWorkflow>>::around(self, world),
            added: gap.model().cloned(),
            is_changing: gap.is_changing(),
            touches: one.or_else(newest),
            twin: is_twin.then(|| self.twin.clone()),
        }
    }

    fn after(&mut self, world: World) {
        if let Some(model) = self.rooms.handeye.of_mut(world).take_accepted() {
            self.with::<GapWorkflow>(world, |gap, around, context| gap.put_in_use(model, around, context));
        }
    }
}
