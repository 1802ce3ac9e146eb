//! From how fast a tip should go to how fast the joints must turn.
//!
//! Damped least squares over the tip's velocity and its turn about the vertical: near a
//! stretched arm the tip goes slower than asked instead of the joints going wild.
//! Source: Nakamura and Hanafusa: Inverse kinematic solutions with singularity robustness (1986).

use nalgebra::{DMatrix, DVector};
use plumbline_model::robot::Chain;

use super::command::JogRates;

/// Below this singular value (m/rad) directions are damped.
const DAMPING: f64 = 0.02;
/// A turn of 1 rad/s counts as much as this many m/s.
const LEVER_M: f64 = 0.1;

/// Joint speeds (rad/s, one per joint of the chain) at which the tip goes as asked, all slowed
/// down together so that none is faster than `fastest_rad_s`.
pub fn joint_rates(chain: &Chain, angles_rad: &[f64], rates: &JogRates, fastest_rad_s: f64) -> Vec<f64> {
    let (_, jacobian) = chain.jacobian(angles_rad);
    let mut rows = DMatrix::zeros(4, chain.len());
    rows.rows_mut(0, 3).copy_from(&jacobian.rows(0, 3));
    rows.row_mut(3).copy_from(&(jacobian.row(5) * LEVER_M));
    let [x, y, z] = rates.velocity_m_s;
    let wanted = DVector::from_vec(vec![x, y, z, rates.yaw_rad_s * LEVER_M]);
    let square = &rows * rows.transpose() + DMatrix::identity(4, 4) * (DAMPING * DAMPING);
    let Some(inverse) = square.try_inverse() else { return vec![0.0; chain.len()] };
    let speeds = rows.transpose() * inverse * wanted;
    let fastest = speeds.amax();
    let slow_down = if fastest > fastest_rad_s { fastest_rad_s / fastest } else { 1.0 };
    speeds.iter().map(|speed| speed * slow_down).collect()
}

#[cfg(test)]
mod tests {
    use plumbline_model::robot::Rig;

    use super::*;

    fn chain() -> (Rig, Chain) {
        let rig = Rig::built_in("nico").expect("the rig that comes with the program");
        let chain = rig.chain("right_index_tip").expect("a tip");
        (rig, chain)
    }

    #[test]
    fn the_tip_goes_where_it_is_asked_to() {
        let (rig, chain) = chain();
        let pose = rig.pose("touch-ready").expect("a pose of NICO").applied_to(&rig.home());
        let angles = pose.of(chain.joints());
        let rates = JogRates { velocity_m_s: [0.05, -0.02, 0.01], yaw_rad_s: 0.0 };
        let speeds = joint_rates(&chain, &angles, &rates, 10.0);
        let step = 1e-3;
        let moved: Vec<f64> = angles.iter().zip(&speeds).map(|(a, s)| a + s * step).collect();
        let went = (chain.robot_from_tip(&moved).translation_m()
            - chain.robot_from_tip(&angles).translation_m())
            / step;
        let asked = nalgebra::Vector3::from(rates.velocity_m_s);
        assert!((went - asked).norm() < 0.15 * asked.norm(), "{went:?}");
    }

    #[test]
    fn no_joint_is_faster_than_allowed_even_at_a_stretched_arm() {
        let (_, chain) = chain();
        let stretched = vec![0.0, 1.2, 0.0, std::f64::consts::PI, 0.0, 0.0];
        let rates = JogRates { velocity_m_s: [1.0, 1.0, 1.0], yaw_rad_s: 3.0 };
        for speed in joint_rates(&chain, &stretched, &rates, 0.5) {
            assert!(speed.is_finite() && speed.abs() <= 0.5 + 1e-12, "{speed}");
        }
    }

    #[test]
    fn no_wish_no_motion() {
        let (rig, chain) = chain();
        let speeds = joint_rates(&chain, &rig.home().of(chain.joints()), &JogRates::default(), 0.5);
        assert!(speeds.iter().all(|speed| *speed == 0.0));
    }
}
