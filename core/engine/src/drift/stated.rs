//! How well places are known with the correction by time that is in use, as it states itself.

use std::sync::Arc;

use nalgebra::Matrix3;
use plumbline_drift::PlaceError;
use plumbline_effects::robot_model::worst_sigma_m;
use plumbline_effects::{RobotModel, SeenUnder};
use plumbline_model::Point;

use super::DriftAround;

/// Standard deviations from the middle to the surface inside which 95 % of places lie: the root of 95 % of chi-square with
/// three degrees of freedom.
const NINETY_FIVE: f64 = 2.795;
/// It is told anew after so long, s: what it tells changes over minutes.
const EVERY_S: f64 = 10.0;

/// What was told last, with which model, and when by the clock of the eyes, counted.
#[derive(Clone, Debug, Default)]
pub(super) struct Stated {
    told: Option<(Arc<RobotModel>, u64, Option<[f64; 3]>)>,
}

impl Stated {
    /// Half of the longest axis of what holds 95 % of places near, in the middle and far, m: what the correction leaves
    /// open, and what is not known of lenses and mount. `None`: nothing is corrected by time, or nobody knows how long
    /// the eyes have been on.
    pub fn ninety_five_m(&mut self, table: &[[PlaceError; 3]; 3], around: &DriftAround) -> Option<[f64; 3]> {
        let on_s = around.eyes_on_s.filter(|_| around.model.has_growth_of_eyes())?;
        let now = (on_s.max(0.0) / EVERY_S) as u64;
        let is_of_now = |told: &&(Arc<RobotModel>, u64, Option<[f64; 3]>)| {
            Arc::ptr_eq(&told.0, &around.model) && told.1 == now
        };
        if let Some((_, _, told)) = self.told.as_ref().filter(is_of_now) {
            return *told;
        }
        let stated = stated_m(table, around, on_s);
        self.told = Some((around.model.clone(), now, stated));
        stated
    }
}

fn stated_m(table: &[[PlaceError; 3]; 3], around: &DriftAround, on_s: f64) -> Option<[f64; 3]> {
    let (model, posture) = (&around.model, around.posture());
    let seen = SeenUnder { t_secs: Some(on_s), ..SeenUnder::default() };
    let of_row = |[_, middle, _]: &[PlaceError; 3]| {
        let at = Point::new(middle.at_m.x, middle.at_m.y, middle.at_m.z);
        let (left, right) = model.project(&at, &posture, &seen)?;
        let in_left = model.rig().eyes.cameras.triangulate(left, right)?;
        let place = model.place(&in_left, &Matrix3::zeros(), &posture, &seen)?;
        Some(NINETY_FIVE * worst_sigma_m(&place.covariance_m2)).filter(|half_m| half_m.is_finite())
    };
    let [near, middle, far] = [0, 1, 2].map(|row| of_row(&table[row]));
    Some([near?, middle?, far?])
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use plumbline_effects::rig_model::EyesLeft;
    use plumbline_model::robot::default_rig;

    use super::*;
    use crate::rig_models::made_up::model_with;

    /// A right eye that has turned since it was calibrated; what its law leaves, rad; `None`: it does not grow with time.
    fn around(left_rad: Option<f64>, eyes_on_s: Option<f64>) -> DriftAround {
        let rig = default_rig();
        let mut added = model_with(&rig, &[("eye-yaw", "right", &[0.006])]);
        for effect in &mut added.contents.effects {
            effect.shape = left_rad.map(|_| 300.0);
        }
        added.contents.eyes_left =
            left_rad.map(|left_rad| EyesLeft { bearing_rad: left_rad, disparity_rad: left_rad });
        DriftAround {
            is_live: true,
            is_recorded: false,
            recorded_head_rad: None,
            opened: 1,
            model: Arc::new(RobotModel::new(rig, Arc::new(added)).expect("it fits")),
            own_eyes: false,
            robot: Arc::default(),
            eyes_on_s,
            clock_settings: 0,
            is_calibrated: true,
            is_mounted: true,
            clock_pace: 1.0,
            world: None,
            twin: None,
            found: None,
            board: None,
        }
    }

    fn table() -> [[PlaceError; 3]; 3] {
        let z_m = default_rig().table.height_m;
        let place = |x_m: f64, y_m: f64| PlaceError {
            at_m: Vector3::new(x_m, y_m, z_m),
            error_m: Vector3::zeros(),
            along_m: 0.0,
            across_m: 0.0,
        };
        [0.25, 0.4, 0.55].map(|x_m| [-0.2, 0.0, 0.2].map(|y_m| place(x_m, y_m)))
    }

    #[test]
    fn what_a_correction_by_time_leaves_open_is_stated_wider_the_farther_and_the_more_is_left() {
        let stated =
            |left_rad| Stated::default().ninety_five_m(&table(), &around(Some(left_rad), Some(600.0)));
        let (little, much) = (stated(2e-4).expect("stated"), stated(2e-3).expect("stated"));
        for [near_m, middle_m, far_m] in [little, much] {
            assert!(0.0 < near_m && near_m < middle_m && middle_m < far_m, "{near_m} {middle_m} {far_m}");
        }
        assert!(much.iter().zip(little).all(|(much_m, little_m)| *much_m > little_m), "{much:?} {little:?}");
    }

    #[test]
    fn nothing_is_stated_where_nothing_is_corrected_by_time_or_nobody_knows_the_time() {
        for around in [around(None, Some(600.0)), around(Some(1e-3), None)] {
            assert_eq!(Stated::default().ninety_five_m(&table(), &around), None);
        }
    }

    #[test]
    fn it_is_told_anew_with_another_model_and_as_time_passes() {
        let mut stated = Stated::default();
        let little = stated.ninety_five_m(&table(), &around(Some(2e-4), Some(600.0)));
        assert_ne!(stated.ninety_five_m(&table(), &around(Some(2e-3), Some(600.0))), little);
        let one = around(Some(2e-4), Some(600.0));
        let first = stated.ninety_five_m(&table(), &one);
        assert_eq!(
            stated.ninety_five_m(&table(), &DriftAround { eyes_on_s: Some(603.0), ..one.clone() }),
            first
        );
        assert!(stated.ninety_five_m(&table(), &DriftAround { eyes_on_s: Some(630.0), ..one }).is_some());
    }
}
