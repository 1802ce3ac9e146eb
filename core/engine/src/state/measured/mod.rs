//! What was measured in a world without anything being put in use by it, as the timeline sees it.

mod told;

use std::sync::Arc;

use jiff::Timestamp;
use plumbline_gap::plan_for;
use plumbline_model::counted;
use plumbline_model::touch_plan::Purpose;

use self::told::{name_of, of_detectors, of_health, of_places, of_trials};
use super::State;
use crate::drift::PlacesResult;
use crate::eyes::ToldHealth;
use crate::ground::World;
use crate::scores::Evaluation;
use crate::timeline::Measured;
use crate::timeline::view::{Figure, Subject};
use crate::touch::RunStanding;
use crate::touch::command::Correction;
use crate::trials::view::ShownTrials;

/// All of it, cheap to compare.
#[derive(Clone, Debug, Default)]
pub(super) struct MeasuredNow {
    health: Option<ToldHealth>,
    run: Option<RunStanding>,
    places: Option<PlacesResult>,
    trials: Option<Arc<ShownTrials>>,
    judged: Option<(Timestamp, Arc<Evaluation>)>,
}

impl MeasuredNow {
    pub fn is(&self, other: &Self) -> bool {
        fn same<T>(a: Option<&Arc<T>>, b: Option<&Arc<T>>) -> bool {
            a.map(Arc::as_ptr) == b.map(Arc::as_ptr)
        }
        let of =
            |now: &Self| (now.health.as_ref().map(|told| told.at), now.judged.as_ref().map(|(at, _)| *at));
        of(self) == of(other)
            && self.run == other.run
            && self.places == other.places
            && same(self.trials.as_ref(), other.trials.as_ref())
    }
}

impl State {
    pub(super) fn measured_of(&self, world: World) -> MeasuredNow {
        let rooms = &self.rooms;
        let is_told = |run: &RunStanding| {
            run.is_finished && run.purpose != Purpose::PlaceScreen && run.mean_m.is_some()
        };
        MeasuredNow {
            health: rooms.eyes.of(world).told_health(),
            run: rooms.touch.of(world).run_standing().filter(is_told),
            places: rooms.drift.places_result(world),
            trials: rooms
                .trials
                .of(world)
                .resting()
                .filter(|shown| shown.experiment.is_of_twin() == (world == World::Twin)),
            // Detectors are of no world: whoever looks at one finds them there.
            judged: rooms.scores.judged(),
        }
    }

    /// The same for the timeline, oldest first as far as that is known.
    pub(super) fn told_of(&self, world: World) -> Vec<Measured> {
        let now = self.measured_of(world);
        let mut all = vec![];
        all.extend(now.health.as_ref().map(of_health));
        all.extend(now.run.as_ref().and_then(|run| self.of_run(world, run)));
        all.extend(now.places.as_ref().map(of_places));
        all.extend(now.trials.as_deref().and_then(of_trials));
        all.extend(now.judged.as_ref().and_then(|(at, judged)| of_detectors(*at, judged)));
        all
    }

    fn of_run(&self, world: World, run: &RunStanding) -> Option<Measured> {
        let (with, described_m) = self.rooms.touch.of(world).run_corrected();
        let touches = counted(run.touched, "touch");
        let (subject, title) = match (run.purpose, with) {
            (Purpose::Check, Some(with)) => {
                (Subject::Check, format!("{touches} at new targets, corrected with {}", with.name()))
            }
            (Purpose::Check, None) => {
                (Subject::Check, format!("{touches} at new targets, without a correction"))
            }
            (Purpose::Train | Purpose::PlaceScreen, _) => match self.suggested(world) {
                Some(what) => (Subject::Experiment, format!("suggested and made: {what}")),
                None => (Subject::Touches, format!("{touches} to learn from")),
            },
        };
        // Where none of them was sent as the robot is described, what the model was learned from tells how it was.
        let learned_m = with.filter(|_| subject == Subject::Check && described_m.is_none());
        let learned_m = learned_m.and_then(|with| self.without_m(world, with));
        let of_target = match subject {
            Subject::Check => "mean distance from the target".to_owned(),
            _ => format!("mean distance from the target, {touches}"),
        };
        let basis = match (described_m, learned_m) {
            (Some(_), _) => format!("{of_target}; before: touches of the same run as the robot is described"),
            (None, Some(_)) => {
                format!("{of_target}; before: without a model, at the touches that it was judged on")
            }
            (None, None) => of_target,
        };
        Some(Measured {
            subject,
            id: name_of(&run.session),
            at: None,
            title,
            before: described_m.or(learned_m).map(Figure::Meters),
            after: Figure::Meters(run.mean_m?),
            basis,
        })
    }

    /// How far touches missed without the correction model in use, mean, m; `None`: that is not what corrected.
    fn without_m(&self, world: World, with: Correction) -> Option<f64> {
        let models = self.rooms.models.of(world);
        let in_use = models.accepted()?.1?.method();
        (with == Correction::Model(in_use)).then(|| models.mean_before_m())?
    }

    /// What the shown finding suggested to be measured, where that is what the run of touches did.
    fn suggested(&self, world: World) -> Option<String> {
        let next = self.rooms.gap.of(world).suggested()?;
        let made = self.rooms.touch.of(world).run_options()?;
        let planned = plan_for(next, made.finger, made.area)?;
        (planned == *made).then(|| next.what.clone())
    }
}
