//! What touches with the effects and without them say of the effects in use.

use jiff::Timestamp;
use plumbline_engine::view::{Figure, Subject, TimelineEntry, TouchFigures, TouchPhase, TouchView};
use plumbline_engine::{Correction, View};
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

    /// How far the finger missed with the effects, mean, m.
    pub fn with_m(&self) -> f64 {
        self.with.mean_m
    }

    /// Share of the error that the effects take away.
    pub fn share(&self) -> f64 {
        1.0 - self.with.mean_m / self.described.mean_m.max(f64::MIN_POSITIVE)
    }

    /// Why held-out rows said more, where they did by much: `closure` is the share of the gap that they told.
    pub fn beside_held_out(&self, closure: Option<f64>) -> Option<String> {
        let closure =
            closure.filter(|closure| closure - self.share() > MORE && self.worth() == Worth::Help)?;
        Some(format!(
            "Held-out rows said {}: that is of the part above the noise, at places like those that were learned \
             from. These are whole errors at new places.",
            format::percent(closure)
        ))
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
            Worth::Help => {
                format!("Proven: the effects take {} of the error away.", format::percent(self.share()))
            }
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
            "{touches}: {described} beside the target as the robot is described, {with} with the effects, on average: \
             of the fingertip on the screen, not of the palm."
        )
    }
}

/// A difference of shares that is worth a word.
const MORE: f64 = 0.1;

/// How far a check missed that the timeline tells of, before and after, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToldCheck {
    /// As the robot is described; `None`: not touched.
    pub described_m: Option<f64>,
    /// Corrected.
    pub with_m: f64,
}

/// The newest check of targets that were corrected with that ("effects", "M3"), of those since a moment; `None`: there is
/// none.
pub fn told_check(view: &View, with: &str, since: Option<Timestamp>) -> Option<ToldCheck> {
    let corrected = format!("corrected with {with}");
    let is_one = |entry: &&TimelineEntry| {
        entry.subject == Subject::Check
            && entry.title.ends_with(&corrected)
            && since.is_none_or(|since| entry.at >= since)
    };
    let check = view.timeline.entries.iter().rev().find(is_one)?;
    let meters = |figure: &Figure| match figure {
        Figure::Meters(m) => Some(*m),
        _ => None,
    };
    let described_m = check.before.as_ref().and_then(meters);
    Some(ToldCheck { described_m, with_m: check.after.as_ref().and_then(meters)? })
}

/// What an earlier run of the program proved of the effects in use; `None`: nothing since they were changed.
pub fn proven_before(view: &View) -> Option<String> {
    let changed = view.gap.model.history.last().map(|step| step.at);
    if view.gap.model.effects.is_empty() {
        return None;
    }
    let check = told_check(view, Correction::Effects.name(), changed)?;
    let described_m = check.described_m.filter(|described_m| check.with_m < *described_m)?;
    let [described, with] = [described_m, check.with_m].map(format::mm);
    Some(format!(
        "Touched both ways before: {described} beside the target as the robot is described, {with} with the effects, \
         on average. The timeline has it."
    ))
}

/// That the finger landed nearer with the correction model in use than in a proof with the effects, and where to choose
/// it; `None`: it did not, or nobody checked it.
pub fn model_was_better(view: &View, with_effects_m: f64) -> Option<String> {
    let name = view.models.in_use.as_ref()?.method().name();
    let check = told_check(view, name, None).filter(|check| check.with_m < with_effects_m)?;
    Some(format!(
        "With {name} a check missed by {}: to send touches by it, choose {name} under Targets corrected by.",
        format::mm(check.with_m)
    ))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_engine::view::{EntryKind, TimelineView};

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
    fn that_held_out_rows_said_much_more_is_explained_and_a_little_more_is_not() {
        let helps = proof(2.6e-3, 0.3e-3);
        let said = helps.beside_held_out(Some(0.91)).expect("56 % beside 91 %");
        assert!(said.contains("91 %") && said.contains("above the noise"), "{said}");
        assert_eq!(helps.beside_held_out(Some(0.6)), None);
        assert_eq!(helps.beside_held_out(None), None);
        assert_eq!(proof(5e-3, 1e-3).beside_held_out(Some(0.91)), None, "nothing was proven");
    }

    fn told(title: &str, before_m: Option<f64>, after_m: f64) -> TimelineEntry {
        TimelineEntry {
            number: 1,
            at: Timestamp::UNIX_EPOCH,
            subject: Subject::Check,
            kind: EntryKind::Measured,
            title: title.to_owned(),
            before: before_m.map(Figure::Meters),
            after: Some(Figure::Meters(after_m)),
            basis: String::new(),
            id_before: None,
            id_after: None,
            outside: false,
            by_undo: false,
        }
    }

    #[test]
    fn the_newest_check_of_each_correction_is_found_and_an_older_one_than_asked_for_is_not() {
        let entries = [
            told("20 touches at new targets, corrected with effects", Some(6e-3), 3e-3),
            told("20 touches at new targets, corrected with M3", None, 0.9e-3),
            told("20 touches at new targets, corrected with effects", Some(5e-3), 2e-3),
        ];
        let timeline =
            TimelineView { is_known: true, entries: Arc::from(entries), ..TimelineView::default() };
        let view = View { timeline: Arc::new(timeline), ..View::default() };
        let effects = ToldCheck { described_m: Some(5e-3), with_m: 2e-3 };
        assert_eq!(told_check(&view, "effects", None), Some(effects));
        assert_eq!(told_check(&view, "M3", None), Some(ToldCheck { described_m: None, with_m: 0.9e-3 }));
        assert_eq!(told_check(&view, "M2", None), None);
        let later = Timestamp::from_second(10).expect("a moment");
        assert_eq!(told_check(&view, "effects", Some(later)), None, "the model was changed since");
        assert_eq!(proven_before(&view), None, "no effect is in use");
    }

    #[test]
    fn without_touches_both_ways_nothing_is_proven() {
        let view = View::default();
        assert_eq!(Proof::of_run(&view.touch), None);
        assert_eq!(Proof::of_model(&view), None);
    }
}
