//! What became of touches, in words.

use plumbline_engine::view::{TouchFigures, TouchOutcome, TouchState};
use plumbline_model::touch_plan::{Purpose, Side};
use plumbline_widgets::format;

use super::parts::error_length_m;

/// "12.3 mm off", "out of reach: …".
pub fn outcome(touch: &TouchState) -> String {
    match &touch.outcome {
        TouchOutcome::Waiting => "to come".to_owned(),
        TouchOutcome::Unreachable(why) => format!("out of reach: {why}"),
        TouchOutcome::UnderWay => "under way".to_owned(),
        TouchOutcome::Touched => {
            error_length_m(touch).map_or("touched".to_owned(), |off| format!("{} off", format::mm(off)))
        }
        TouchOutcome::Missed(why) => format!("no contact: {why}"),
        TouchOutcome::Skipped => "left out".to_owned(),
        TouchOutcome::Rejected => "does not count".to_owned(),
    }
}

/// From where the finger comes.
pub fn side(side: Side) -> &'static str {
    match side {
        Side::Above => "above",
        Side::Left => "the robot's left",
        Side::Right => "the robot's right",
    }
}

/// What a run is for.
pub fn purpose(purpose: Purpose) -> &'static str {
    match purpose {
        Purpose::PlaceScreen => "Place screen",
        Purpose::Train => "Train",
        Purpose::Check => "Check",
    }
}

/// "1 touch", "80 touches".
pub fn touches(count: usize) -> String {
    format::count(count, "touch")
}

/// What touches with the effects are better by than those as the robot is described; certain where their
/// intervals lie apart.
pub fn proof(described: &TouchFigures, with: &TouchFigures) -> String {
    let [[low, high], [described_low, described_high]] = [with.mean_interval_m, described.mean_interval_m];
    let places = format!("Mean error ± 95 % over {} and {}", touches(described.count), touches(with.count));
    let verdict = if high < described_low {
        format!(
            "the effects take {} of the error away",
            format::percent(1.0 - with.mean_m / described.mean_m.max(f64::MIN_POSITIVE))
        )
    } else if described_high < low {
        "with the effects it misses by more: take them out, and search the gap again".to_owned()
    } else {
        "so far it cannot be told whether the effects help".to_owned()
    };
    format!("{places}: {verdict}.")
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

    #[test]
    fn what_effects_are_worth_is_said_as_far_as_it_is_known() {
        let described = figures(6e-3, 1e-3);
        assert!(
            proof(&described, &figures(1.2e-3, 0.3e-3)).contains("the effects take 80 % of the error away")
        );
        assert!(proof(&described, &figures(5e-3, 1e-3)).contains("cannot be told"));
        assert!(proof(&described, &figures(9e-3, 1e-3)).contains("it misses by more"));
    }
}
