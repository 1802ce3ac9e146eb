//! Sessions that are held out as a whole: where they stand only their own rows say.

use plumbline_effects::{Assumed, Measurements};
use plumbline_model::Unattended;

use crate::compare::placed;
use crate::floor::Floor;
use crate::search;

/// The frame of a session without any training row can only come from its own rows, and so can the place of a marker
/// that was mounted anew for it.
pub(super) fn place(
    measurements: &Measurements,
    floor: &Floor,
    training: &[usize],
    tested: &[(usize, usize)],
    mut models: Vec<&mut Assumed>,
) {
    for session in 0..measurements.apparatuses.len() {
        let own = |i: usize| measurements.rows[i].session == session;
        if training.iter().any(|&i| own(i)) || !tested.iter().any(|&(i, _)| own(i)) {
            continue;
        }
        let rows = measurements.only(tested.iter().map(|(i, _)| *i).filter(|&i| own(i)));
        let all: Vec<usize> = (0..rows.rows.len()).collect();
        // An external frame and a marker can stand anywhere, farther off than a fit reaches.
        let Ok(start) = placed(&rows, &all, &Unattended) else { continue };
        for assumed in &mut models {
            stand_as(assumed, &start, &rows, session);
            let fitted = search::place(&rows, floor, assumed);
            stand_as(assumed, &fitted, &rows, session);
        }
    }
}

/// Takes over where the frame of a session stands, and its marker where that was mounted anew.
fn stand_as(assumed: &mut Assumed, other: &Assumed, measurements: &Measurements, session: usize) {
    assumed.placements[session] = other.placements[session];
    if measurements.apparatuses[session].tip_is_unknown {
        assumed.set_mount(session, other.mount(session));
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
    use plumbline_effects::What;
    use plumbline_model::Session;
    use plumbline_model::robot::Rig;
    use rand::rngs::StdRng;
    use rand::{Rng, SeedableRng};

    use super::*;
    use crate::compare::residuals;
    use crate::finding::FloorSource;
    use crate::floor::KindFloor;

    const ROWS: usize = 40;
    const BASE_RAD: [f64; 6] = [-0.03, 0.31, 0.44, 1.55, 1.07, 0.73];
    const MANIFEST: &str = r#"
format = 1
rig = "nico"
started = 2026-01-01T00:00:00Z
[chain]
tip = "right_index_tip"
tip_place = "unknown"
joints = ["r_shoulder_z", "r_shoulder_y", "r_arm_x", "r_elbow_y", "r_wrist_z", "r_wrist_x"]
"#;

    fn session(random: &mut StdRng) -> Session {
        let joints = ["r_shoulder_z", "r_shoulder_y", "r_arm_x", "r_elbow_y", "r_wrist_z", "r_wrist_x"];
        let mut text =
            joints.map(|joint| format!("cmd_{joint}_rad,")).concat() + "meas_x_m,meas_y_m,meas_z_m\n";
        for _ in 0..ROWS {
            text += &BASE_RAD.map(|angle| format!("{},", angle + random.random_range(-0.4..0.4))).concat();
            text += "0,0,0\n";
        }
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("session.toml"), MANIFEST).expect("writable");
        std::fs::write(folder.path().join("poses.csv"), text).expect("writable");
        Session::read(folder.path()).expect("well formed")
    }

    /// Two sessions, each with its own external frame and its marker mounted anew, and what is true of them.
    fn two_sessions() -> (Measurements, Assumed) {
        let mut random = StdRng::seed_from_u64(3);
        let sessions = ["first", "second"].map(|title| (title.to_owned(), session(&mut random)));
        let rig = Rig::built_in("nico").expect("comes along");
        let mut made = Measurements::of_sessions(&sessions, &rig).expect("usable");
        let mut truth = Assumed::nominal(&made);
        let frame = |x: f64, turn: [f64; 3]| {
            let turn = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
            Isometry3::from_parts(Translation3::new(x, -0.7, 0.9), turn)
        };
        truth.placements = vec![frame(1.2, [0.4, -1.1, 2.0]), frame(-2.0, [1.5, 0.3, -2.2])];
        truth.set_mount(0, Isometry3::translation(0.02, 0.01, -0.03));
        truth.set_mount(1, Isometry3::translation(-0.04, 0.03, 0.05));
        for row in 0..made.rows.len() {
            made.rows[row].measured = made.predict(&made.rows[row], &truth).expect("predictable");
        }
        (made, truth)
    }

    #[test]
    fn a_marker_of_a_session_that_was_held_out_whole_is_placed_with_its_frame() {
        let (made, truth) = two_sessions();
        let training: Vec<usize> = (0..ROWS).collect();
        let tested: Vec<(usize, usize)> = (ROWS..2 * ROWS).map(|row| (row, 0)).collect();
        let kind =
            KindFloor { what: What::Pose, sd: vec![1e-3; 3], degrees_of_freedom: 100.0, sigma_m: None };
        let floor = Floor { kinds: vec![kind], source: FloorSource::Repeats };
        let mut before = placed(&made, &training, &Unattended).expect("not cancelled");
        let mut after = before.clone();
        place(&made, &floor, &training, &tested, vec![&mut before, &mut after]);
        for assumed in [&before, &after] {
            let off_m = assumed.mount(1).translation.vector - truth.mount(1).translation.vector;
            assert!(off_m.norm() < 2e-3, "{off_m:?}");
            for residual in residuals(&made, assumed).into_iter().flatten().skip(ROWS) {
                assert!(residual.iter().all(|left| left.abs() < 2e-3), "{residual:?}");
            }
        }
    }
}
