//! What the experiment with grasps sees of the rest, and what follows from it for grasping.

use super::State;
use super::rooms::Neighbors;
use crate::grasp::GraspWorkflow;
use crate::ground::{Workflow as _, World};
use crate::trials::{GraspNow, TrialsAround, TrialsWorkflow};

impl Neighbors<TrialsWorkflow> for State {
    fn around(&self, world: World) -> TrialsAround {
        let grasp = self.rooms.grasp.of(world);
        TrialsAround {
            rig: self.rig_of(world),
            robot: self.robot.clone(),
            twin: self.twin.clone(),
            is_twin: world == World::Twin,
            grasp: GraspNow { is_idle: grasp.is_idle(), newest: grasp.newest().cloned() },
            newest_pair: self.rooms.live.newest().map(|frame| frame.stamp.captured_at),
        }
    }

    fn after(&mut self, world: World) {
        for wish in self.rooms.trials.of_mut(world).take_wishes() {
            self.with::<GraspWorkflow>(world, |grasp, around, context| grasp.apply(wish, around, context));
        }
    }
}
