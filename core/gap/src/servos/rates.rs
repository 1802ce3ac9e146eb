//! How fast joints move that all come from one side while the tip comes down on a surface: what is fast lags more by the
//! viscous part of its friction, and does not stick for that.
//!
//! Every joint moves in the positive (or every one in the negative) direction, as the session says, and the tip meets the
//! surface from above. Where the joints that lift it would win at equal rates, those that lower it have to be faster. Taken is
//! what changes equal rates least: joints that lower the tip are faster in proportion to how far they lower it per radian.

use plumbline_effects::What;
use plumbline_effects::arm::Arm;
use plumbline_effects::measurements::Observation;

/// Per joint: its mean rate from both sides in units of that of a joint which nothing asks to be faster; `None` where no row
/// was made by coming down.
pub(super) fn rates(arm: &Arm, rows: &[&Observation]) -> Option<Vec<f64>> {
    let down: Vec<&&Observation> = rows.iter().filter(|row| row.what == What::Touch).collect();
    if down.is_empty() {
        return None;
    }
    let mut sums = vec![0.0; arm.len()];
    for row in &down {
        let lifts = lifts(arm, row.angles_rad());
        for side in [1.0, -1.0] {
            let sinks: Vec<f64> = lifts.iter().map(|lift| -side * lift).collect();
            sums.iter_mut().zip(of_one_side(&sinks)).for_each(|(sum, rate)| *sum += 0.5 * rate);
        }
    }
    Some(sums.into_iter().map(|sum| sum / down.len() as f64).collect())
}

/// How far each joint lifts the tip per radian (per meter, where it slides).
fn lifts(arm: &Arm, angles_rad: &[f64]) -> Vec<f64> {
    let frames = arm.frames(angles_rad);
    let tip_m = frames.robot_from_tip.translation.vector;
    let each = arm.parts.iter().zip(&frames.axes).zip(&frames.robot_from_joint);
    each.map(|((part, axis), joint)| match part.slides {
        true => axis.z,
        false => axis.cross(&(tip_m - joint.translation.vector)).z,
    })
    .collect()
}

/// Rates of joints that all come from one side, by how far each lowers the tip (less than zero: lifts it).
fn of_one_side(sinks: &[f64]) -> Vec<f64> {
    let together: f64 = sinks.iter().sum();
    let square: f64 = sinks.iter().map(|sink| sink.max(0.0).powi(2)).sum();
    let more = if square > 0.0 { (-together / square).max(0.0) } else { 0.0 };
    sinks.iter().map(|sink| 1.0 + more * sink.max(0.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_that_lower_the_tip_anyway_move_alike() {
        assert_eq!(of_one_side(&[0.3, 0.2, -0.1]), [1.0; 3]);
    }

    #[test]
    fn the_only_one_that_lowers_the_tip_is_as_fast_as_all_that_lift_it_ask_for() {
        let rates = of_one_side(&[-0.3, -0.2, 0.1, 0.0]);
        assert_eq!((rates[0], rates[1], rates[3]), (1.0, 1.0, 1.0));
        let comes_down: f64 = rates.iter().zip([-0.3, -0.2, 0.1, 0.0]).map(|(rate, sink)| rate * sink).sum();
        assert!(comes_down.abs() < 1e-12, "just enough");
        assert!((rates[2] - 5.0).abs() < 1e-12);
    }

    #[test]
    fn nothing_is_asked_of_joints_that_only_lift_the_tip() {
        assert_eq!(of_one_side(&[-0.3, -0.2]), [1.0; 2]);
    }
}
