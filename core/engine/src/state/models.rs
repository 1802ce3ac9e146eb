//! What is known of the robot in each world, put together anew where something was accepted or taken back.

use std::sync::Arc;

use plumbline_model::robot::Rig;

use super::recorded::is_recording;
use super::rooms::Rooms;
use super::{Action, State};
use crate::ground::World;
use crate::ground::notice::NoticeLevel;
use crate::ground::text::sentence;
use crate::rig_models::{Accepted, calibrated_at, mounted, other_eyes};
use crate::robot::RobotControl;
use crate::source::view::SourceView;

impl State {
    /// Where the eyes are over the table, for the maps of the next assessment.
    pub(super) fn use_workspace(&mut self) {
        let workspace = self.rooms.live.workspace();
        self.rooms.eyes.iter_mut().for_each(|eyes| eyes.set_workspace(workspace));
    }

    /// The robot of a world, with what was calibrated there.
    pub(super) fn rig_of(&self, world: World) -> Arc<Rig> {
        self.models.of(world).rig().clone()
    }

    /// Puts together anew what is known of the robot, where something was accepted or taken back, and
    /// hands it to everybody who looks, moves or touches.
    pub(super) fn use_models(&mut self) {
        World::ALL.into_iter().for_each(|world| self.put_together(world));
        let shown = self.shown;
        self.rooms.live.set_model(self.models.of(shown));
        self.rooms.live.set_calibration(self.rooms.eyes.of(shown).in_use());
        self.use_eyes_clock();
        self.use_workspace();
        let of_arm = self.model_of_the_arm();
        if !Arc::ptr_eq(&self.told_the_arm, &of_arm) {
            self.told_the_arm = of_arm.clone();
            self.actions.push(Action::Robot(RobotControl::UseModel(of_arm)));
        }
    }

    /// How long the eyes of a world have been on, s: a twin knows it, of other eyes the operator does. Of what was
    /// recorded the recording does, whatever runs now.
    pub(super) fn eyes_on_s(&self, world: World) -> Option<f64> {
        let source = self.rooms.source.view();
        if self.shown == world && is_recording(source.spec.as_ref()) {
            return self.then.and_then(|then| then.on_s);
        }
        match world {
            World::Twin if self.shown == World::Twin && !self.shows_own_eyes() => None,
            World::Twin => self.twin.running.then_some(self.twin.eyes_on_s),
            World::Robot => self.rooms.eyes.of(World::Robot).on_s(source, self.clock.time().instant),
        }
    }

    /// Tells whoever looks live; by whole seconds, because nothing moves in less.
    pub(super) fn use_eyes_clock(&mut self) {
        let on_s = self.eyes_on_s(self.shown).map(f64::floor);
        self.rooms.live.set_eyes_on(on_s);
        let is_recorded = is_recording(self.rooms.source.view().spec.as_ref());
        let apart_rad = if is_recorded { 0.0 } else { self.rooms.eyes.of(self.shown).turned_apart_rad() };
        self.rooms.live.set_seen_apart(apart_rad);
    }

    /// The cameras may have been away.
    pub(super) fn follow_cameras(&mut self, source: &SourceView) {
        let now = self.clock.time();
        if let Some(words) = self.rooms.eyes.of_mut(World::Robot).follow(source, now) {
            self.notices.add(NoticeLevel::Warning, words);
        }
    }

    pub(super) fn put_together(&mut self, world: World) {
        let Rooms { eyes, mount, touch, gap, .. } = &self.rooms;
        let (eyes, mount) = (eyes.of(world).in_use(), mount.of(world).in_use());
        let accepted = Accepted {
            cameras: eyes.map(|calibration| &calibration.cameras),
            head_from_left: mount.map(|mount| mount.head_from_left),
            calibrated_at: calibrated_at(eyes.map(|eyes| &**eyes), mount.map(|mount| &**mount)),
            mounted: mount.map(|mount| mounted(mount)),
            screen: touch.of(world).screen(),
            effects: gap.of(world).model().filter(|effects| {
                !self.refused.as_ref().is_some_and(|refused| Arc::ptr_eq(refused, effects))
            }),
        };
        let known = self.models.of_mut(world);
        if accepted.is_in(known, &self.rig) {
            return;
        }
        match accepted.robot_model(&self.rig) {
            Ok(model) => {
                // While the program starts the effects may be read before the eyes that they belong to.
                let Rooms { eyes, mount, .. } = &self.rooms;
                let is_read = eyes.of(world).accepted().is_some() && mount.of(world).accepted().is_some();
                let others = accepted.effects.map(|effects| effects.effects_of_other_eyes(model.rig()));
                if let Some(words) = others.as_deref().and_then(other_eyes).filter(|_| is_read) {
                    self.notices.add(NoticeLevel::Warning, words);
                }
                *known = Arc::new(model);
            }
            Err(reason) => {
                self.refused = accepted.effects.cloned();
                self.notices.add(NoticeLevel::Error, sentence(&reason.to_string()));
            }
        }
    }
}
