//! Whether hand and object are known well enough for the hand to close around the object.

use nalgebra::Matrix3;

use super::End;

/// How far off a hand may be over the table, in the worst direction, and still lift what it closes around,
/// m: 6 mm to either side are lifted at all places of `tests/tolerance.rs` (`off_by`), 12 mm are not.
const HOLDS_M: f64 = 0.009;
/// Hand and object together may be this uncertain over the table, m: of a hundred hands eighty are then
/// nearer than [`HOLDS_M`].
const MOST_SIGMA_M: f64 = HOLDS_M / 1.28;

/// Refuses when hand and object together are not known well enough.
pub(super) fn sure_enough(object_m2: &Matrix3<f64>, hand_m2: &Matrix3<f64>) -> Result<(), End> {
    let what = "hand and object are known";
    known_to(what, &(object_m2 + hand_m2), "calibrate the mount of the eyes, or name the effects in Gap")
}

/// Refuses, before anything moves, an object whose place alone is not known well enough: whatever is known
/// of the hand later, both together would be refused over the object.
pub(super) fn sure_of_object(object: &str, object_m2: &Matrix3<f64>) -> Result<(), End> {
    let what = format!("where the {} stands is known", object.to_lowercase());
    known_to(
        &what,
        object_m2,
        "put it nearer to the middle of what both eyes see, or calibrate the eyes and their mount",
    )
}

fn known_to(what: &str, covariance_m2: &Matrix3<f64>, remedy: &str) -> Result<(), End> {
    let sigma_m = over_table_m(covariance_m2);
    if sigma_m <= MOST_SIGMA_M {
        return Ok(());
    }
    let (sigma_mm, needed_mm) = (sigma_m * 1e3, MOST_SIGMA_M * 1e3);
    let how = if sigma_m.is_finite() { format!("to {sigma_mm:.1} mm only") } else { "not at all".to_owned() };
    Err(End::Refused(format!("{what} {how}, {needed_mm:.1} mm are needed: {remedy}")))
}

/// Standard deviation in the worst direction over the table, m; infinite where it is no number.
pub(super) fn over_table_m(covariance_m2: &Matrix3<f64>) -> f64 {
    let (a, b, c) = (covariance_m2[(0, 0)], covariance_m2[(0, 1)], covariance_m2[(1, 1)]);
    let (mean, half) = (0.5 * (a + c), 0.5 * (a - c));
    let worst_m2 = mean + half.hypot(b);
    if worst_m2.is_nan() { f64::INFINITY } else { worst_m2.max(0.0).sqrt() }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    fn refused(done: Result<(), End>) -> Option<String> {
        match done {
            Ok(()) => None,
            Err(End::Refused(why) | End::Failed(_, why)) => Some(why),
        }
    }

    /// Over the table in its worst direction, and far less known in height, which does not count.
    fn worst_m2(sigma_m: f64) -> Matrix3<f64> {
        let mut covariance_m2 = Matrix3::from_diagonal(&Vector3::new(1e-6, 1e-6, 0.02f64.powi(2)));
        // Along the diagonal of x and y.
        let half = 0.5 * (sigma_m.powi(2) - 1e-6);
        covariance_m2[(0, 0)] += half;
        covariance_m2[(1, 1)] += half;
        (covariance_m2[(0, 1)], covariance_m2[(1, 0)]) = (half, half);
        covariance_m2
    }

    #[test]
    fn hand_and_object_are_refused_where_together_they_are_less_known_than_a_hand_forgives() {
        assert!((over_table_m(&worst_m2(0.005)) - 0.005).abs() < 1e-9);
        assert_eq!(refused(sure_enough(&worst_m2(0.004), &worst_m2(0.004))), None);
        // Each by itself would do.
        let why = refused(sure_enough(&worst_m2(0.006), &worst_m2(0.006))).expect("refused");
        assert!(
            why.contains("known to 8.5 mm only, 7.0 mm are needed") && why.contains("calibrate"),
            "{why}"
        );
        let unknown = Matrix3::from_element(f64::NAN);
        let why = refused(sure_enough(&worst_m2(0.001), &unknown)).expect("nothing is known of it");
        assert!(why.contains("are known not at all, 7.0 mm are needed"), "{why}");
    }

    #[test]
    fn an_object_that_is_too_uncertain_by_itself_is_refused_before_anything_moves() {
        assert_eq!(refused(sure_of_object("Tomato", &worst_m2(0.0069))), None);
        let why = refused(sure_of_object("Tomato", &worst_m2(0.012))).expect("refused");
        assert!(why.contains("the tomato stands is known to 12.0 mm only"), "{why}");
        // What is refused so would be refused later with the best of hands.
        assert!(refused(sure_enough(&worst_m2(0.012), &Matrix3::zeros())).is_some());
    }
}
