//! Rows of sessions, and that their predictions are those of the model.

use plumbline_model::measured_data;
use plumbline_model::predict::predict_session;
use plumbline_model::robot::Rig;
use plumbline_model::{Pixel, Session};

use super::{Measurements, MeasurementsError, What};
use crate::forward::Assumed;
use crate::library::Effect;

fn measured(folder: &str) -> Option<(Session, Rig)> {
    let path = measured_data::folder(folder).ok()?;
    Some((Session::read(&path).expect("a session"), Rig::built_in("nico").expect("comes along")))
}

#[test]
fn without_effects_touches_are_predicted_as_the_model_does() {
    let Some((session, rig)) = measured("nico-touch/touch-245") else { return };
    let nominal = predict_session(&session, &rig, None).expect("predictable");
    let screen = session.manifest.touchscreen.clone().unwrap_or_else(|| rig.touchscreen.clone());
    let sessions = [("touches".to_owned(), session)];
    let measurements = Measurements::of_sessions(&sessions, &rig).expect("usable");
    let assumed = Assumed::nominal(&measurements);
    assert_eq!(measurements.rows.len(), 245);
    let middle = screen.middle();
    let [u_m, v_m] = screen.pitch_m();
    for (row, expected) in measurements.rows.iter().zip(&nominal.touches) {
        let seen = measurements.predict(row, &assumed).expect("predictable");
        let pixel: Pixel<plumbline_model::session::Screen> =
            Pixel::new(seen[0] / u_m + middle.u_px, seen[1] / v_m + middle.v_px);
        assert!(pixel.distance_px(&expected.touch) < 1e-6);
        assert!((seen[2] - expected.above_glass_m).abs() < 1e-12);
    }
}

#[test]
fn without_effects_the_eyes_estimate_the_known_place() {
    let Some((session, rig)) = measured("nico-vision/grid-z5") else { return };
    let sessions = [("grid".to_owned(), session)];
    let measurements = Measurements::of_sessions(&sessions, &rig).expect("usable");
    let assumed = Assumed::nominal(&measurements);
    assert_eq!(measurements.rows.iter().filter(|row| row.what == What::Place).count(), 36);
    for row in &measurements.rows {
        let eyes = measurements.apparatus(row).eyes.as_ref().expect("a grid has eyes");
        let seen = measurements.predict(row, &assumed).expect("in view");
        let nominal = crate::eyes::EyesDeviation::none(eyes.neck.len());
        let in_left = eyes.robot_from_left(&row.neck_rad, &nominal).inverse() * row.truth_m.expect("known");
        for (a, b) in seen.iter().zip(eyes.natural(&in_left)) {
            assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
    }
}

#[test]
fn tangents_have_a_column_for_every_parameter() {
    let Some((session, rig)) = measured("nico-touch/touch-245") else { return };
    let sessions = [("touches".to_owned(), session)];
    let measurements = Measurements::of_sessions(&sessions, &rig).expect("usable");
    let arm = measurements.apparatuses[0].arm.as_ref().expect("touches have an arm");
    let candidates = Effect::all(arm);
    let count: usize = candidates.iter().map(|effect| effect.parameters().len()).sum();
    let assumed = Assumed::nominal(&measurements);
    let tangents = measurements.tangents(&measurements.rows[0], &assumed, &candidates).expect("predictable");
    assert_eq!(tangents.effects.shape(), (3, count));
    assert_eq!(tangents.gauge.shape(), (3, 6));
    assert!(tangents.effects.iter().chain(tangents.gauge.iter()).all(|value| value.is_finite()));
}

#[test]
fn no_session_is_said_so() {
    let rig = Rig::built_in("nico").expect("comes along");
    let error = Measurements::of_sessions(&[], &rig).expect_err("nothing given");
    assert_eq!(error, MeasurementsError::NoSession);
}

#[test]
fn rows_that_cannot_be_are_left_out_by_name() {
    let rig = Rig::built_in("nico").expect("comes along");
    let folder = tempfile::tempdir().expect("temporary folder");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
    write("session.toml", "format = 1\nrig = \"nico\"\nstarted = 2026-01-01T00:00:00Z\n");
    let mut text = "true_x_m,true_y_m,true_z_m,est_x_m,est_y_m,est_z_m\n".to_owned();
    for i in 0..8 {
        let x_m = if i == 2 { "-1e308".to_owned() } else { format!("0.{i}2") };
        text += &format!("0.3,0.1,0.05,{x_m},0.1,0.05\n");
    }
    write("localizations.csv", &text);
    let session = Session::read(folder.path()).expect("one row only");
    let measurements = Measurements::of_sessions(&[("made up".to_owned(), session)], &rig).expect("usable");
    let out = measurements.left_out.iter().find(|out| out.row == 2).expect("left out");
    assert!(out.why.contains("line 4, column est_x_m: -1.000e308 m cannot be"), "{}", out.why);
    assert!(measurements.rows.iter().all(|row| row.row != 2));
}
