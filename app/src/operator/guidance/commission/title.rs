//! Commissioning in words: its steps, how far they are, what came of them, what all of it took.

use plumbline_engine::View;
use plumbline_engine::view::{CommissionFigure, CommissionSpent, CommissionStep, TouchPhase};
use plumbline_widgets::format;

use super::super::touch::{done_of, wanted};

/// What a step does: "Place the screen".
pub fn name(step: CommissionStep) -> &'static str {
    match step {
        CommissionStep::Eyes => "Calibrate the eyes",
        CommissionStep::Mount => "Find how the eyes sit in the head",
        CommissionStep::Screen => "Place the screen",
        CommissionStep::Touches => "Touch the screen",
        CommissionStep::Effects => "Find what makes the arm miss",
        CommissionStep::Hands => "Look at the hands",
        CommissionStep::Check => "Check with new touches",
        CommissionStep::Grasp => "Grasp",
    }
}

/// "Commissioning, 2 of 8 done: place the screen – 2 of 8 touches". The rail counts its steps otherwise, so the present one
/// has no number here.
pub(super) fn title(view: &View, step: Option<CommissionStep>) -> String {
    let Some(step) = step else { return "Commissioning: all 8 steps are done".to_owned() };
    let name = name(step);
    let (first, rest) = name.split_at(1);
    let far = far(view, step).map_or_else(String::new, |far| format!(" – {far}"));
    let done = view.commission.steps.iter().filter(|step| step.done().is_some()).count();
    format!("Commissioning, {done} of 8 done: {}{rest}{far}", first.to_lowercase())
}

/// How far a step is.
fn far(view: &View, step: CommissionStep) -> Option<String> {
    match step {
        CommissionStep::Eyes => {
            let pairs = super::eyes::pairs(view);
            (pairs > 0).then(|| format::count(pairs, "pair"))
        }
        CommissionStep::Mount => {
            let (views, left) = (view.mount.views.len(), view.mount.planned.len());
            (views > 0).then(|| format!("{views} of {} views", views + left))
        }
        CommissionStep::Screen | CommissionStep::Touches | CommissionStep::Check => {
            let running = matches!(
                view.touch.phase,
                TouchPhase::Running { .. } | TouchPhase::Waiting { .. } | TouchPhase::Paused { .. }
            );
            let (done, all) = (done_of(view.touch.counts), wanted(view.touch.counts));
            running.then(|| format!("{done} of {all} touches"))
        }
        CommissionStep::Effects | CommissionStep::Hands | CommissionStep::Grasp => None,
    }
}

/// "9 min · 32 touches · 14 views".
pub fn spent(spent: &CommissionSpent) -> String {
    let minutes = spent.time.as_secs() / 60;
    let touches = format::count(spent.touches, "touch");
    format!("{minutes} min · {touches} · {}", format::count(spent.views, "view"))
}

/// More are counted.
const MOST_EFFECTS: usize = 3;

/// What came of a step: "0.11 px left over in the images".
pub fn done_in_words(figure: &CommissionFigure) -> String {
    match figure {
        CommissionFigure::Unknown => "done".to_owned(),
        CommissionFigure::Pixels(px) => format!("{} left over in the images", format::px(*px)),
        CommissionFigure::Placed { rms_m, touches, is_doubtful } => {
            let doubtful = if *is_doubtful { "doubtful: " } else { "" };
            format!("{doubtful}{}, which agree to {}", format::count(*touches, "touch"), format::mm(*rms_m))
        }
        CommissionFigure::Touches(touches) => format::count(*touches, "touch"),
        CommissionFigure::Effects(effects) if effects.is_empty() => {
            "nothing is missing in the model".to_owned()
        }
        CommissionFigure::Effects(effects) => {
            let counted = format::count(effects.len(), "effect");
            let (told, more) = effects.split_at(effects.len().min(MOST_EFFECTS));
            let and_more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
            format!("{counted} in the model: {}{and_more}", told.join(", "))
        }
        CommissionFigure::NotInLibrary => "something is missing that no known effect explains".to_owned(),
        CommissionFigure::Seen { before_m, after_m } if after_m < before_m => {
            format!("seen {} beside the arm, {} before", format::mm(*after_m), format::mm(*before_m))
        }
        CommissionFigure::Seen { before_m, after_m } => {
            format!(
                "seen {} beside the arm, no nearer than before ({})",
                format::mm(*after_m),
                format::mm(*before_m)
            )
        }
        CommissionFigure::Missed { mean_m: Some(mean_m), touches } => {
            format!("{touches} new touches miss by {}", format::mm(*mean_m))
        }
        CommissionFigure::Missed { mean_m: None, touches } => format::count(*touches, "new touch"),
        CommissionFigure::Held(object) => format!("the {} was held", object.to_lowercase()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_doubtful_when_it_was_accepted_stays_so() {
        let said =
            |is_doubtful| done_in_words(&CommissionFigure::Placed { rms_m: 5.8e-3, touches: 4, is_doubtful });
        assert_eq!(said(true), "doubtful: 4 touches, which agree to 5.80 mm");
        assert_eq!(said(false), "4 touches, which agree to 5.80 mm");
    }

    #[test]
    fn views_are_counted_of_all_that_are_planned_until_the_last() {
        use std::sync::Arc;

        use plumbline_engine::view::{HeadViewSummary, MountView};

        let far = |taken: usize, left: usize| {
            let view = |name: usize| HeadViewSummary {
                is_colder: false,
                name: name.to_string(),
                pan_rad: 0.0,
                tilt_rad: 0.0,
                corners: (54, 54),
                rms_px: None,
            };
            let views: Vec<HeadViewSummary> = (0..taken).map(view).collect();
            let planned = vec![(0.0, 0.0); left];
            let mount = MountView { views: views.into(), planned: planned.into(), ..MountView::default() };
            far(&View { mount: Arc::new(mount), ..View::default() }, CommissionStep::Mount)
        };
        assert_eq!(far(0, 8), None);
        assert_eq!(far(6, 2).as_deref(), Some("6 of 8 views"));
        assert_eq!(far(8, 0).as_deref(), Some("8 of 8 views"));
    }

    #[test]
    fn hands_that_are_seen_no_nearer_than_before_are_not_told_as_a_gain() {
        let said = |before_m, after_m| done_in_words(&CommissionFigure::Seen { before_m, after_m });
        assert_eq!(said(0.005_77, 0.001_26), "seen 1.26 mm beside the arm, 5.77 mm before");
        let worse = said(0.001_01, 0.001_26);
        assert_eq!(worse, "seen 1.26 mm beside the arm, no nearer than before (1.01 mm)");
    }
}
