//! What touches with the effects and without them say of the effects in use.

use plumbline_engine::View;
use plumbline_engine::view::{TouchFigures, TouchPhase, TouchView};
use plumbline_widgets::format;

/// Touches of the same places, as the robot is described and with the effects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proof {
    described: TouchFigures,
    with: TouchFigures,
}

/// What effects are worth, as far as touches tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Worth {
    /// The finger misses by less with them.
    Help,
    /// The intervals overlap.
    Untold,
    /// The finger misses by more with them.
    Harm,
}

impl Proof {
    /// Of a run that touched both ways.
    pub fn of_run(touch: &TouchView) -> Option<Self> {
        let is_proof = touch.plan.as_ref()?.options.beside_described;
        let (described, with) = touch.figures_described.zip(touch.figures)?;
        is_proof.then_some(Self { described, with })
    }

    /// Of the model in use: `None` where nothing was touched both ways since it was changed.
    pub fn of_model(view: &View) -> Option<Self> {
        let (touch, model) = (&view.touch, &view.gap.model);
        if touch.phase != TouchPhase::Finished || model.effects.is_empty() {
            return None;
        }
        let folder = touch.session.as_ref()?;
        let session = view.gap.sessions.iter().find(|session| session.folder == *folder)?;
        let changed = model.history.last().map(|step| step.at);
        let is_newer = changed.is_none_or(|at| session.started.is_some_and(|started| started >= at));
        Self::of_run(touch).filter(|_| is_newer)
    }

    /// What the effects are worth; certain only where the 95 % intervals lie apart.
    pub fn worth(&self) -> Worth {
        let [[low, high], [described_low, described_high]] =
            [self.with.mean_interval_m, self.described.mean_interval_m];
        if high < described_low {
            Worth::Help
        } else if described_high < low {
            Worth::Harm
        } else {
            Worth::Untold
        }
    }

    /// The answer in a line.
    pub fn headline(&self) -> String {
        match self.worth() {
            Worth::Help => format!(
                "Proven: the effects take {} of the error away.",
                format::percent(1.0 - self.with.mean_m / self.described.mean_m.max(f64::MIN_POSITIVE))
            ),
            Worth::Untold => "So far it cannot be told whether the effects help.".to_owned(),
            Worth::Harm => {
                "With the effects it misses by more: take them out, and search the gap again.".to_owned()
            }
        }
    }

    /// What the answer rests on: "20 touches: 6.00 mm beside the target as described, 1.20 mm with the effects."
    pub fn figures(&self) -> String {
        let touches = format::count(self.described.count + self.with.count, "touch");
        let [described, with] = [self.described, self.with].map(|figures| format::mm(figures.mean_m));
        format!(
            "{touches}: {described} beside the target as the robot is described, {with} with the effects, on average."
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures(mean_m: f64, half_m: f64) -> TouchFigures {
        TouchFigures {
            count: 10,
            mean_m,
            mean_interval_m: [mean_m - half_m, mean_m + half_m],
            largest_m: 2.0 * mean_m,
            bias_m: [0.0; 2],
            noise_m: None,
            repeats: 0,
        }
    }

    fn proof(with_m: f64, half_m: f64) -> Proof {
        Proof { described: figures(6e-3, 1e-3), with: figures(with_m, half_m) }
    }

    #[test]
    fn what_effects_are_worth_is_said_as_far_as_it_is_known() {
        let helps = proof(1.2e-3, 0.3e-3);
        assert_eq!(helps.worth(), Worth::Help);
        assert_eq!(helps.headline(), "Proven: the effects take 80 % of the error away.");
        assert!(helps.figures().starts_with("20 touches: 6.00 mm beside the target"), "{}", helps.figures());
        assert!(helps.figures().contains("1.20 mm with the effects"), "{}", helps.figures());
        let untold = proof(5e-3, 1e-3);
        assert!(untold.worth() == Worth::Untold && untold.headline().contains("cannot be told"));
        let harm = proof(9e-3, 1e-3);
        assert!(harm.worth() == Worth::Harm && harm.headline().contains("misses by more"));
    }

    #[test]
    fn without_touches_both_ways_nothing_is_proven() {
        let view = View::default();
        assert_eq!(Proof::of_run(&view.touch), None);
        assert_eq!(Proof::of_model(&view), None);
    }
}
