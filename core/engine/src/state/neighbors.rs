//! What each workflow can see of the rest, and what follows for the others when it has changed.

use std::path::Path;

use plumbline_correction::Method;
use plumbline_grasp::Corrections;
use plumbline_hardware::SourceSpec;
use plumbline_model::touch_plan::Finger;
use plumbline_vision::detect::Provider;

use super::State;
use super::rooms::{Neighbors, Rooms};
use crate::commission::CommissionWorkflow;
use crate::detect::{DetectAround, DetectWorkflow};
use crate::drift::{BoardAt, DriftAround, DriftWorkflow, Told};
use crate::eyes::view::{CaptureEnded, DriftTold, Drifted};
use crate::eyes::{EyesAround, EyesWorkflow};
use crate::gap::{GapAround, GapWorkflow};
use crate::grasp::{GraspAround, GraspWorkflow};
use crate::ground::World;
use crate::ground::text::sentence;
use crate::labels::{LabelsAround, LabelsWorkflow};
use crate::live::LiveWorkflow;
use crate::models::{ModelsAround, ModelsWorkflow};
use crate::mount::{MountAround, MountWorkflow};
use crate::recording::{RecordingAround, RecordingWorkflow};
use crate::rig_models::other_eyes;
use crate::robot::view::MotionState;
use crate::scores::ScoresWorkflow;
use crate::source::SourceWorkflow;
use crate::source::view::SourceStatus;
use crate::timeline::view::Subject;
use crate::touch::refusal::Held;
use crate::touch::{TouchAround, TouchWorkflow};
use crate::truth::{Seen, TruthAround, TruthWorkflow};

impl Neighbors<SourceWorkflow> for State {
    fn around(&self, _world: World) {}
}

impl Neighbors<RecordingWorkflow> for State {
    fn around(&self, _world: World) -> RecordingAround {
        let source = self.rooms.source.view();
        let cameras = self.rooms.eyes.of(self.shown).in_use().map(|calibration| calibration.cameras);
        RecordingAround {
            world: self.shown,
            is_live: source.replay.is_none() && source.status == SourceStatus::Running,
            opened: source.opened,
            spec: source.spec.clone(),
            superseded: source.counters.superseded,
            rig: self.rig.name.clone(),
            cameras,
        }
    }
}

impl Neighbors<DetectWorkflow> for State {
    fn around(&self, _world: World) -> DetectAround {
        let Rooms { live, source, .. } = &self.rooms;
        DetectAround {
            newest: live.newest().cloned(),
            opened: self.shown_of,
            photographs: source.view().photographs,
            setup: live.setup(),
            arm_moves: self.arm_comes_first(),
        }
    }
}

impl Neighbors<DriftWorkflow> for State {
    fn around(&self, _world: World) -> DriftAround {
        let source = self.rooms.source.view();
        let Rooms { eyes, mount, .. } = &self.rooms;
        DriftAround {
            is_live: source.status == SourceStatus::Running && !source.photographs,
            is_recorded: source.replay.is_some(),
            recorded_head_rad: self.then.and_then(|then| then.head_rad),
            opened: source.opened,
            model: self.models.of(self.shown).clone(),
            own_eyes: self.shows_own_eyes() && self.shown == self.arm_of,
            robot: self.robot.clone(),
            eyes_on_s: self.eyes_on_s(self.shown),
            clock_settings: match self.shown {
                World::Twin => 0,
                World::Robot => self.rooms.eyes.of(World::Robot).clock_settings(),
            },
            is_calibrated: eyes.of(self.shown).in_use().is_some(),
            is_mounted: mount.of(self.shown).in_use().is_some(),
            clock_pace: match self.shown {
                World::Twin if self.shows_own_eyes() => self.twin.warm_up_pace,
                _ => 1.0,
            },
            world: (self.shown == self.arm_of).then_some(self.shown),
            twin: (self.shown == World::Twin && self.twin.running).then(|| self.twin.clone()),
            found: self.rooms.detect.found().cloned(),
            board: self
                .shown_eyes()
                .board_at()
                .map(|(captured_at, outlines)| BoardAt { captured_at, outlines }),
        }
    }

    fn after(&mut self, _world: World) {
        // What was watched is explained where all that is missing is looked for.
        if let Some(log) = self.rooms.drift.next_log() {
            self.with::<GapWorkflow>(self.arm_of, |gap, around, context| gap.explain(&log, around, context));
        }
    }
}

impl Neighbors<LiveWorkflow> for State {
    fn around(&self, _world: World) {}

    fn after(&mut self, _world: World) {
        self.use_workspace();
        let wanted = self.rooms.live.wants_detections();
        self.with::<DetectWorkflow>(World::default(), |detect, _, context| detect.want(wanted, context));
    }
}

/// It sees what all others know, and none of them sees it.
impl Neighbors<TruthWorkflow> for State {
    fn around(&self, _world: World) -> TruthAround {
        let robot = &self.robot;
        let found = self.rooms.detect.found().filter(|_| self.shown == World::Twin && self.shows_own_eyes());
        let seen = found.iter().flat_map(|found| &found.objects).filter_map(|object| {
            let place = object.best_place().ok()?;
            Some(Seen { name: object.name.clone(), place: place.point_in_robot })
        });
        TruthAround {
            is_twin: self.twin.running && robot.connection.is_connected() && self.arm_of == World::Twin,
            model: self.models.of(World::Twin).clone(),
            measured: robot.measured.clone(),
            tip: robot.tip_place.as_ref().map(|place| (robot.tip.clone(), place.point)),
            seen: seen.collect(),
        }
    }
}

/// Data sets belong to no world: images of both may be labeled together.
impl Neighbors<LabelsWorkflow> for State {
    fn around(&self, _world: World) -> LabelsAround {
        let detect = &self.rooms.detect;
        let (detector, provider) = detect.chosen();
        LabelsAround {
            open: detect.opener().clone(),
            detector: detector.clone(),
            provider,
            confidence: detect.settings().confidence,
            newest: self.rooms.live.newest().cloned(),
            opened: self.rooms.source.view().opened,
        }
    }
}

impl Neighbors<ScoresWorkflow> for State {
    fn around(&self, _world: World) -> Provider {
        self.rooms.detect.chosen().1
    }
}

impl State {
    /// Whether the arm moves, or a run of touches has it between two moves: who looks by itself steps back then.
    fn arm_comes_first(&self) -> bool {
        let moves = matches!(self.robot.motion, MotionState::Moving { .. });
        moves || self.rooms.touch.of(self.arm_of).is_touching()
    }

    /// Why what is in use and was calibrated is in doubt all the same, a sentence each, in the order in which it is made.
    pub(super) fn in_doubt(&self, world: World) -> impl Iterator<Item = (Subject, String)> {
        let Rooms { eyes, mount, touch, gap, .. } = &self.rooms;
        let eyes = eyes.of(world);
        let of_mount = mount.of(world).stale(eyes.in_use().map(|eyes| &**eyes), eyes.accepted().is_some());
        let of_screen = touch.of(world).placement().and_then(|placement| {
            let doubt = format!("the place of the screen is in doubt, for {}", placement.doubts().first()?);
            Some(sentence(&doubt))
        });
        let rig = self.models.of(world).rig();
        let of_effects =
            gap.of(world).model().and_then(|model| other_eyes(&model.effects_of_other_eyes(rig)));
        let told = [
            (Subject::Eyes, eyes.does_not_hold().map(str::to_owned)),
            (Subject::Mount, of_mount.map(str::to_owned)),
            (Subject::Screen, of_screen),
            (Subject::Effects, of_effects),
        ];
        told.into_iter().filter_map(|(subject, why)| Some((subject, why?)))
    }

    /// How far places have moved since drift is watched, for whoever judged the eyes.
    fn drifted(&self) -> Option<Drifted> {
        let (watch, told) = self.rooms.drift.newest(self.rooms.source.view().opened)?;
        let told = match told {
            Told::Nothing => DriftTold::Nothing,
            Told::Anew => DriftTold::Anew,
            Told::Newest(model, newest) => {
                let off_m = [0, 1, 2].map(|row| [newest.along_m[row], newest.across_m[row]]);
                DriftTold::Off { model: model.clone(), off_m }
            }
        };
        Some(Drifted { watch, told })
    }
}

impl Neighbors<EyesWorkflow> for State {
    fn around(&self, world: World) -> EyesAround {
        let source = self.rooms.source.view();
        let shows_twin = source.spec == Some(SourceSpec::Twin);
        EyesAround {
            newest: self.rooms.live.newest().cloned(),
            source: source.clone(),
            twin_on_s: self.eyes_on_s(World::Twin).filter(|_| shows_twin),
            rig: self.models.of(world).rig().clone(),
            arm_moves: self.arm_of == world && self.arm_comes_first(),
            is_watched: self.rooms.drift.is_watching(),
            drifted: self.drifted().filter(|_| self.shown == world),
            is_corrected: self.models.of(world).has_growth_apart(),
        }
    }

    fn after(&mut self, _world: World) {
        self.use_models();
    }
}

impl Neighbors<MountWorkflow> for State {
    fn around(&self, world: World) -> MountAround {
        let eyes = self.rooms.eyes.of(world);
        MountAround {
            rig: self.rig.clone(),
            robot: self.robot.clone(),
            calibration: eyes.in_use().cloned(),
            is_eyes_known: eyes.accepted().is_some(),
            board: *eyes.board(),
            has_eyes: self.rooms.source.view().spec.is_some(),
            eyes_on_s: self.eyes_on_s(world),
        }
    }

    fn after(&mut self, world: World) {
        if self.rooms.mount.of(world).wants_corners() {
            self.rooms.eyes.of_mut(world).end_auto_capture(CaptureEnded::MountLooks);
        }
        self.use_models();
    }
}

impl Neighbors<TouchWorkflow> for State {
    fn around(&self, world: World) -> TouchAround {
        TouchAround {
            rig: self.rig.clone(),
            robot: self.robot.clone(),
            models: self.rooms.models.of(world).usable(),
            model: self.models.of(world).clone(),
            held: (self.rooms.grasp.of(world).in_hand())
                .map(|held| Held { hand: held.hand.name(), object: held.object }),
        }
    }

    fn after(&mut self, world: World) {
        self.use_models();
        // A run that has ended is counted before anything else is offered.
        self.with::<CommissionWorkflow>(world, |room, around, context| room.look(around, context));
        let finished = self.rooms.touch.of(world).finished_session();
        let Some(finished) = finished.map(|(session, revision)| (session.to_owned(), revision)) else {
            return;
        };
        if self.learned_from.get(&world) == Some(&finished) {
            return;
        }
        // What is told below comes back here.
        self.learned_from.insert(world, finished.clone());
        if self.rooms.touch.of(world).finger() == Some(Finger::Right) {
            self.with::<ModelsWorkflow>(world, |models, around, context| {
                models.touched(&finished.0, around, context);
            });
        }
        self.with::<GapWorkflow>(world, |gap, _, context| gap.touched(&finished.0, context));
    }
}

impl Neighbors<ModelsWorkflow> for State {
    fn around(&self, world: World) -> ModelsAround {
        ModelsAround {
            rig: self.rig_of(world),
            robot: self.robot.clone(),
            newest_session: self.rooms.touch.of(world).session().map(Path::to_owned),
        }
    }
}

impl Neighbors<GapWorkflow> for State {
    fn around(&self, world: World) -> GapAround {
        GapAround {
            rig: self.rig_of(world),
            newest_session: self.rooms.touch.of(world).session().map(Path::to_owned),
        }
    }

    fn after(&mut self, world: World) {
        self.use_models();
        self.with::<TouchWorkflow>(world, |touch, around, context| touch.refresh(around, context));
    }
}

impl Neighbors<GraspWorkflow> for State {
    fn around(&self, world: World) -> GraspAround {
        let Rooms { eyes, mount, touch, models, detect, source, trials, .. } = &self.rooms;
        let usable = models.of(world).usable();
        let model = |method| usable.iter().find(|model| model.method() == method).cloned();
        let (detector, provider) = detect.chosen();
        let lost = self.rooms.handeye.of(world).lost(self.rooms.gap.of(world).model()).map(str::to_owned);
        let looking = (self.rooms.handeye.of(world).is_looking())
            .then_some("The eyes look at the hands: wait for the end, or cancel it, first.");
        GraspAround {
            described: self.rig.clone(),
            model: self.models.of(world).clone(),
            robot: self.robot.clone(),
            calibration: eyes.of(world).in_use().cloned(),
            eyes_on_min: self.eyes_on_s(world).map(|on_s| on_s / 60.0),
            in_doubt: self.in_doubt(world).next().map(|(_, why)| why).or(lost),
            has_mount: mount.of(world).in_use().is_some(),
            has_screen: touch.of(world).screen().is_some(),
            corrections: Corrections {
                m1: model(Method::M1),
                m2: model(Method::M2),
                m3: model(Method::M3),
                hand: None,
            },
            detector: (detector.clone(), provider),
            own_eyes: self.shown == world && self.shows_own_eyes(),
            source: source.view().clone(),
            pair_age_s: self.rooms.live.newest_pair_age_s(self.clock.time().instant),
            found: detect.found().cloned(),
            in_experiment: trials.of(world).is_under_way(),
            goes_first: touch.of(world).in_the_way().or(looking),
            touches_paused: touch.of(world).is_under_way(),
        }
    }
}
