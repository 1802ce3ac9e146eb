//! By which calibrations of the eyes the places of sessions were localized, beside which what grows as they warm up
//! counts.

use plumbline_effects::Kind;
use plumbline_gap::finding::NamedEffect;
use plumbline_model::Session;
use plumbline_model::robot::Rig;

/// Said of what grows where nobody knows how warm the eyes were.
const FROM_COLD: &str = "The sessions do not say how long the cameras had been on when the eyes were calibrated: what \
    grows as they warm up counts from cold eyes. If they were warm, a correction by it counts twice what the calibration \
    holds: give the times in [eyes] of session.toml (cameras_calibrated_at_s, mount_calibrated_at_s), or watch anew.";
/// Said of what grows where the sessions are of several calibrations.
const OTHER_CALIBRATIONS: &str = "The sessions were localized by calibrations of eyes that were not equally warm: what \
    grows counts from that of the newest session. Search in each by itself.";

/// The session of places that was begun last: the calibration that it was localized by is the one in use.
pub(super) fn newest_localized<'a>(sessions: impl Iterator<Item = &'a Session>) -> Option<&'a Session> {
    sessions.filter(|session| session.localizations.is_some()).max_by_key(|session| session.manifest.started)
}

/// What has to be known of effects that grow as the eyes warm up, and of the calibrations beside which they count.
pub(super) fn of_calibrations(sessions: &[Session], rig: &Rig, effects: &[NamedEffect]) -> Vec<String> {
    let grows =
        |effect: &NamedEffect| Kind::of_id(&effect.id).filter(|kind| kind.is_growth_of_eyes(effect.shape));
    let kinds: Vec<Kind> = effects.iter().filter_map(grows).collect();
    if kinds.is_empty() {
        return vec![];
    }
    let calibrated_at = &rig.eyes.calibrated_at;
    let mut warnings = vec![];
    if kinds.iter().any(|kind| kind.held_at_s(calibrated_at).is_none()) {
        warnings.push(FROM_COLD.to_owned());
    }
    let mut localized = sessions.iter().filter(|session| session.localizations.is_some());
    if localized.any(|session| session.manifest.calibrated_at() != *calibrated_at) {
        warnings.push(OTHER_CALIBRATIONS.to_owned());
    }
    warnings
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use plumbline_model::robot::CalibratedAt;

    use super::*;
    use crate::gap::read;

    fn named(id: &str, site: &str, shape: Option<f64>) -> NamedEffect {
        NamedEffect {
            id: id.to_owned(),
            site: site.to_owned(),
            title: String::new(),
            probability: 1.0,
            class_probability: 1.0,
            parameters: vec![],
            shape,
            reference_s: 0.0,
            values: vec![0.006],
            covariance: vec![],
            size_sigmas: 9.0,
            size_m: 0.01,
            class: vec![],
            beside: vec![],
            split_by: None,
            runner_up: None,
            not_addable: None,
        }
    }

    /// A thing that stands still, seen beside eyes that were calibrated after so long, since so many minutes.
    fn watched(folder: &Path, calibrated_at: CalibratedAt, minute: i64) {
        let started = jiff::Timestamp::UNIX_EPOCH + jiff::Span::new().minutes(minute);
        std::fs::create_dir_all(folder).expect("made");
        let manifest = folder.join("session.toml");
        std::fs::write(&manifest, format!("format = 1\nrig = \"nico\"\nstarted = {started}\n"))
            .expect("written");
        let mut read = plumbline_model::session::Manifest::read(&manifest).expect("well formed");
        read.set_calibrated_at(&calibrated_at);
        read.write(&manifest).expect("written");
        let mut rows = "true_x_m,true_y_m,true_z_m,est_x_m,est_y_m,est_z_m,t_secs\n".to_owned();
        for k in 0..20 {
            rows += &format!("0.4,0.1,0.05,{},0.1,0.05,{}\n", 0.4 + 1e-3 * f64::from(k), 30 * k);
        }
        std::fs::write(folder.join("localizations.csv"), rows).expect("written");
    }

    #[test]
    fn the_robot_is_as_warm_as_when_the_eyes_of_the_watched_session_were_calibrated() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let [early, late] = ["early", "late"].map(|name| folder.path().join(name));
        let known = CalibratedAt { cameras_s: Some(720.0), mount_s: Some(780.0) };
        watched(&early, CalibratedAt::default(), 0);
        watched(&late, known, 60);
        let grows = [named("eye-yaw", "right", Some(300.0))];
        let said = |folders: &[PathBuf], effects: &[NamedEffect]| {
            let given = read(folders, None).expect("readable");
            (given.rig.eyes.calibrated_at, of_calibrations(&given.sessions, &given.rig, effects))
        };
        assert_eq!(said(std::slice::from_ref(&late), &grows), (known, vec![]));
        let (cold, warnings) = said(std::slice::from_ref(&early), &grows);
        assert_eq!(cold, CalibratedAt::default());
        assert!(matches!(&warnings[..], [words] if words.contains("counts from cold eyes")), "{warnings:?}");
        // What does not grow counts from no time.
        assert_eq!(said(std::slice::from_ref(&early), &[named("eye-yaw", "right", None)]).1, [""; 0]);
        // The newest one tells, in whatever order they are given.
        let (at, warnings) = said(&[late, early], &grows);
        assert_eq!(at, known);
        assert!(matches!(&warnings[..], [words] if words.contains("newest session")), "{warnings:?}");
    }
}
