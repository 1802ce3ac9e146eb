//! Whether a correction would count twice what the calibration in use holds already.

use plumbline_effects::{Growth, RobotModel};

use super::DriftAround;

/// Eyes that have gone no more than this share of their way when they were calibrated, were cold.
const COLD_SHARE: f64 = 0.15;
/// Where no law was found yet: with a time constant of 1 to 2.5 min, eyes have gone 11 to 26 % of their way by then.
const COLD_MIN: f64 = 0.3;
const REMEDY: &str = "Take it for how long to wait; to correct by it, calibrate the eyes cold first.";

/// A law begins at switching on: what is to be said of a calibration that was not made then, or nobody knows when.
pub(super) fn counted_twice(around: &DriftAround) -> Option<String> {
    if !around.is_calibrated {
        return None;
    }
    let Some(minutes) = around.calibrated_min else {
        return Some(format!(
            "It is not known how long the cameras had been on when the calibration in use was made: if they were warm, \
             what the eyes had turned until then is in it already, and correcting by what is found would count it \
             twice. {REMEDY}"
        ));
    };
    (!was_cold(minutes, &around.model)).then(|| {
        let minutes = if minutes < 10.0 { format!("{minutes:.1}") } else { format!("{minutes:.0}") };
        format!(
            "The calibration in use was made when the cameras had been on for {minutes} min: what the eyes had turned \
             until then is in it already, and correcting by what is found would count it twice. {REMEDY}"
        )
    })
}

/// By the laws in use, the fastest one deciding.
fn was_cold(minutes: f64, model: &RobotModel) -> bool {
    let shares = laws(model).map(|law| law.share(60.0 * minutes));
    shares.reduce(f64::max).map_or(minutes <= COLD_MIN, |share| share <= COLD_SHARE)
}

/// How the eyes in use turn while they get warm.
fn laws(model: &RobotModel) -> impl Iterator<Item = Growth> {
    model.added().effects().iter().filter(|effect| effect.tip.is_none()).filter_map(|effect| {
        let named = |name| {
            let found = effect.parameters.iter().find(|parameter| parameter.name == name);
            found.map(|parameter| parameter.value)
        };
        Some(Growth {
            time_constant_s: named("time_constant_s")?,
            delay_s: named("delay_s").unwrap_or(0.0),
            late_s: named("late_s").unwrap_or(0.0),
        })
    })
}

#[cfg(test)]
mod tests {
    use plumbline_model::robot::default_rig;

    use super::*;

    #[test]
    fn without_a_law_a_third_of_a_minute_is_cold_and_a_minute_is_not() {
        let model = RobotModel::nominal(default_rig());
        assert!(was_cold(0.25, &model));
        assert!(!was_cold(1.0, &model), "eyes with a time constant of a minute have gone 63 % of their way");
    }
}
