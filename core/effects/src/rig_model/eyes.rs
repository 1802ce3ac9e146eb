//! With which eyes effects on the eyes were found. A mount or lenses that are calibrated anew hold what
//! such an effect had to explain: in force beside them, it would count twice. Of what grows while the eyes warm up they
//! hold what has grown until they were calibrated: where that time is known, the rest stays in force.

use std::sync::Arc;

use plumbline_model::robot::{CalibratedAt, Rig};

use super::{Contents, ModelEffect, RigModel};
use crate::library::Kind;

/// Numbers of eyes that differ by less are the same, m, rad or px: a file keeps them to the last digits.
const SAME: f64 = 1e-9;

/// What tells eyes from others: how they sit in the head and to each other, and their lenses.
pub fn numbers_of_eyes(rig: &Rig) -> Vec<f64> {
    let eyes = &rig.eyes;
    let pose = |at: &nalgebra::Isometry3<f64>| {
        let (shift, turn) = (at.translation.vector, at.rotation.scaled_axis());
        [shift.x, shift.y, shift.z, turn.x, turn.y, turn.z]
    };
    let cameras = &eyes.cameras;
    let lenses = [&cameras.left, &cameras.right].into_iter().flat_map(|camera| camera.model.parameters());
    let places = [pose(&eyes.head_from_left.isometry), pose(&cameras.right_from_left.isometry)];
    places.into_iter().flatten().chain(lenses).collect()
}

pub(super) fn are_same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME)
}

/// Whether an effect concerns the eyes.
pub(super) fn is_of_eyes(effect: &ModelEffect) -> bool {
    Kind::of_id(&effect.id).is_some_and(Kind::is_of_eyes)
}

/// When a calibration of other eyes holds for an effect that it does not make void, s: for what grows, where that is
/// known.
fn held_at_s(effect: &ModelEffect, calibrated_at: &CalibratedAt) -> Option<f64> {
    let kind = Kind::of_id(&effect.id)?;
    kind.held_at_s(calibrated_at).filter(|_| kind.is_growth_of_eyes(effect.shape))
}

impl ModelEffect {
    /// The same beside the calibration of these eyes: what grows counts from it, or from cold eyes where it is not
    /// known how warm they were. When an effect was found, and by which program, says nothing of that.
    #[must_use]
    pub fn beside(mut self, calibrated_at: &CalibratedAt) -> Self {
        if let Some(kind) = Kind::of_id(&self.id).filter(|kind| kind.is_growth_of_eyes(self.shape)) {
            self.reference_s = kind.held_at_s(calibrated_at).unwrap_or(0.0);
        }
        self
    }
}

impl Contents {
    /// Takes effects on the eyes to other eyes: what grows goes on from the new calibration, all else goes.
    pub(super) fn take_to_eyes(&mut self, calibrated_at: &CalibratedAt) {
        self.effects.retain_mut(|effect| {
            if !is_of_eyes(effect) {
                return true;
            }
            let held_at_s = held_at_s(effect, calibrated_at);
            effect.reference_s = held_at_s.unwrap_or(effect.reference_s);
            held_at_s.is_some()
        });
        if !self.effects.iter().any(is_of_eyes) {
            self.eyes_left = None;
        }
    }
}

impl RigModel {
    /// Whether effects on the eyes were found with the eyes of `rig` (its lenses and mount), or nobody knows with which.
    fn is_of_eyes_of(&self, rig: &Rig) -> bool {
        let known = &self.contents.eyes;
        known.is_empty() || are_same(known, &numbers_of_eyes(rig))
    }

    /// Effects on the eyes that are not in force with the eyes of `rig` (its lenses and mount), for they were found with
    /// others. Where it is not known with which eyes they were found, there are none.
    pub fn effects_of_other_eyes(&self, rig: &Rig) -> Vec<&ModelEffect> {
        if self.is_of_eyes_of(rig) {
            return vec![];
        }
        let is_void = |effect: &&ModelEffect| {
            is_of_eyes(effect) && held_at_s(effect, &rig.eyes.calibrated_at).is_none()
        };
        self.effects().iter().filter(is_void).collect()
    }

    /// The model for these eyes: effects that were found with others go, and what grows goes on from when these were
    /// calibrated.
    #[must_use]
    pub fn for_eyes_of(self: &Arc<Self>, rig: &Rig) -> Arc<Self> {
        if self.is_of_eyes_of(rig) || !self.effects().iter().any(is_of_eyes) {
            return self.clone();
        }
        let mut model = Self::clone(self);
        model.contents.take_to_eyes(&rig.eyes.calibrated_at);
        Arc::new(model)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig_model::Addition;

    fn nico() -> Rig {
        Rig::built_in("nico").expect("comes with the program")
    }

    fn effect(id: &str, site: &str, values: &[f64]) -> ModelEffect {
        ModelEffect {
            id: id.to_owned(),
            site: site.to_owned(),
            title: String::new(),
            tip: Some("right_index_tip".to_owned()),
            shape: None,
            reference_s: 0.0,
            values: values.to_vec(),
            covariance: vec![],
            probability: None,
            parameters: vec![],
        }
    }

    fn addition(effects: Vec<ModelEffect>, rig: &Rig) -> Addition {
        Addition {
            effects,
            screens: vec![],
            externals: vec![],
            eyes: numbers_of_eyes(rig),
            together: vec![],
            replaces: false,
            at: jiff::Timestamp::UNIX_EPOCH,
            sentence: String::new(),
            sessions: vec![],
            version: String::new(),
            gap: None,
        }
    }

    fn ids(model: &RigModel) -> Vec<&str> {
        model.effects().iter().map(|effect| effect.id.as_str()).collect()
    }

    #[test]
    fn an_effect_on_the_eyes_is_in_force_with_the_eyes_it_was_found_with_and_with_no_others() {
        let rig = nico();
        let mut model = RigModel::nominal(&rig);
        let found = vec![effect("joint-zero", "r_elbow_y", &[0.02]), effect("eye-yaw", "right", &[0.004])];
        model.add(&rig, addition(found, &rig)).expect("they fit");
        let model = Arc::new(model);
        assert!(Arc::ptr_eq(&model, &model.for_eyes_of(&rig)));
        let mut mounted = rig.clone();
        mounted.eyes.head_from_left.isometry.translation.vector.x += 0.002;
        let stale: Vec<&str> =
            model.effects_of_other_eyes(&mounted).into_iter().map(|effect| effect.id.as_str()).collect();
        assert_eq!(stale, ["eye-yaw"]);
        assert_eq!(ids(&model.for_eyes_of(&mounted)), ["joint-zero"]);
        // The old mount comes back: so does what was found with it.
        assert_eq!(ids(&model.for_eyes_of(&rig)), ["joint-zero", "eye-yaw"]);
        // A search with the new eyes takes its place, and does not add to it.
        let mut next = RigModel::clone(&model);
        next.add(&mounted, addition(vec![effect("eye-yaw", "right", &[0.001])], &mounted)).expect("it fits");
        assert_eq!(ids(&next), ["joint-zero", "eye-yaw"]);
        assert_eq!(next.effects()[1].values, [0.001]);
        assert!(next.effects_of_other_eyes(&mounted).is_empty());
    }

    #[test]
    fn where_it_is_not_known_with_which_eyes_they_were_found_they_stay() {
        let rig = nico();
        let mut model = RigModel::nominal(&rig);
        let unknown = Addition { eyes: vec![], ..addition(vec![effect("eye-yaw", "right", &[0.004])], &rig) };
        model.add(&rig, unknown).expect("it fits");
        let mut mounted = rig.clone();
        mounted.eyes.head_from_left.isometry.translation.vector.x += 0.002;
        assert!(model.effects_of_other_eyes(&mounted).is_empty());
    }

    #[test]
    fn what_grows_goes_on_from_a_new_calibration_of_which_it_is_known_how_warm_the_eyes_were() {
        let rig = nico();
        let grown = |id, site, values| ModelEffect { shape: Some(300.0), ..effect(id, site, values) };
        let found = vec![
            grown("eye-yaw", "right", &[0.006]),
            grown("camera-mount", "eyes", &[0.0, 0.004, 0.0]),
            effect("head-joint", "head_z", &[0.01]),
        ];
        let mut model = RigModel::nominal(&rig);
        model.add(&rig, addition(found, &rig)).expect("they fit");
        let mut calibrated = rig.clone();
        calibrated.eyes.cameras.right_from_left.isometry.translation.vector.x -= 0.001;
        let references = |model: &RigModel| -> Vec<(String, f64)> {
            model.effects().iter().map(|effect| (effect.id.clone(), effect.reference_s)).collect()
        };
        let in_force = |calibrated_at: CalibratedAt| {
            let mut rig = calibrated.clone();
            rig.eyes.calibrated_at = calibrated_at;
            let model = Arc::new(model.clone());
            let void = model.effects_of_other_eyes(&rig).len();
            let left = references(&model.for_eyes_of(&rig));
            assert_eq!(void + left.len(), 3, "what is not in force is said: {left:?}");
            left
        };
        assert!(in_force(CalibratedAt::default()).is_empty());
        let eyes = CalibratedAt { cameras_s: Some(720.0), mount_s: None };
        assert_eq!(in_force(eyes), [("eye-yaw".to_owned(), 720.0)]);
        let both = CalibratedAt { mount_s: Some(900.0), ..eyes };
        assert_eq!(in_force(both), [("eye-yaw".to_owned(), 720.0), ("camera-mount".to_owned(), 900.0)]);
        // The calibration that they were found with comes back.
        assert_eq!(references(&Arc::new(model.clone()).for_eyes_of(&rig)), references(&model));
        // A search beside the new one adds to what was in force in it.
        calibrated.eyes.calibrated_at = both;
        model
            .add(&calibrated, addition(vec![effect("box-bias", "eyes", &[1.0, 0.0])], &calibrated))
            .expect("fits");
        let after = [("eye-yaw", 720.0), ("camera-mount", 900.0), ("box-bias", 0.0)];
        assert_eq!(references(&model), after.map(|(id, reference_s)| (id.to_owned(), reference_s)));
        assert!(model.effects_of_other_eyes(&calibrated).is_empty());
    }

    #[test]
    fn an_effect_counts_from_the_calibration_that_it_is_added_beside_whenever_it_was_found() {
        let both = CalibratedAt { cameras_s: Some(720.0), mount_s: Some(900.0) };
        let of_cameras = ModelEffect { shape: Some(300.0), ..effect("eye-yaw", "right", &[0.006]) };
        let of_mount =
            ModelEffect { shape: Some(300.0), ..effect("camera-mount", "eyes", &[0.0, 0.004, 0.0]) };
        // Found beside cold eyes, by a program that did not say it, or beside another calibration.
        for found_s in [0.0, 60.0] {
            let beside = |effect: &ModelEffect, calibrated_at: &CalibratedAt| {
                ModelEffect { reference_s: found_s, ..effect.clone() }.beside(calibrated_at).reference_s
            };
            assert_eq!(beside(&of_cameras, &both), 720.0);
            assert_eq!(beside(&of_mount, &both), 900.0);
            assert_eq!(beside(&of_cameras, &CalibratedAt::default()), 0.0);
        }
        assert_eq!(effect("eye-yaw", "right", &[0.006]).beside(&both).reference_s, 0.0, "it does not grow");
    }

    #[test]
    fn the_file_keeps_with_which_eyes_they_were_found() {
        let (rig, folder) = (nico(), tempfile::tempdir().expect("a temporary folder"));
        let mut model = RigModel::nominal(&rig);
        model.add(&rig, addition(vec![effect("eye-yaw", "right", &[0.004])], &rig)).expect("it fits");
        let file = folder.path().join("rig-model.toml");
        model.write(&file, &rig).expect("written");
        let read = RigModel::read(&file, &rig).expect("readable");
        assert_eq!(read, model);
        assert!(read.effects_of_other_eyes(&rig).is_empty());
    }
}
