//! What both eyes saw when everything was remembered, and how it looks now.

use image::GrayImage;
use nalgebra::{Rotation3, Vector3};
use plumbline_effects::SeenUnder;
use plumbline_model::robot::Posture;
use plumbline_vision::follow::{EyeTurn, RememberedEye, fit_eye_turn};
use plumbline_vision::health::HealthError;

use super::WatcherSetup;
use super::reference::{Kept, ReferenceSeen, keep};

/// Pictures of both eyes with what stood where.
#[derive(Debug)]
pub(super) struct Remembered {
    eyes: [RememberedEye; 2],
    /// How the eyes had turned already, rad.
    base_rad: [Vector3<f64>; 2],
    pub posture: Posture,
    references: Vec<Kept>,
    /// When that was.
    under: SeenUnder,
}

/// What is seen of it.
pub(super) struct Looked {
    pub turns_rad: [Vector3<f64>; 2],
    pub sigmas_rad: [f64; 2],
    pub references: Vec<ReferenceSeen>,
    pub along_share: f64,
}

impl Remembered {
    pub fn new(
        setup: &WatcherSetup,
        (left, right): (&GrayImage, &GrayImage),
        base_rad: [Vector3<f64>; 2],
        under: SeenUnder,
    ) -> Result<Self, HealthError> {
        let cameras = &setup.model.rig().eyes.cameras;
        let eyes = [RememberedEye::new(&cameras.left, left)?, RememberedEye::new(&cameras.right, right)?];
        let references = keep(&setup.references, &eyes);
        Ok(Self { eyes, base_rad, posture: setup.posture.clone(), references, under })
    }

    /// `None`: too little of it is seen again, or it does not go with the eyes.
    pub fn look(
        &self,
        setup: &WatcherSetup,
        (left, right): (&GrayImage, &GrayImage),
        last_rad: [Vector3<f64>; 2],
        now: &SeenUnder,
    ) -> Result<Option<Looked>, HealthError> {
        let mut followed = Vec::with_capacity(2);
        let mut turns: Vec<EyeTurn> = Vec::with_capacity(2);
        for (eye, image) in [left, right].into_iter().enumerate() {
            let since =
                (Rotation3::new(last_rad[eye]) * Rotation3::new(self.base_rad[eye]).inverse()).scaled_axis();
            let places = self.eyes[eye].follow(image, &since)?;
            let Some(turn) = fit_eye_turn(self.eyes[eye].camera(), &places) else { return Ok(None) };
            followed.push(places);
            turns.push(turn);
        }
        let total = [0, 1].map(|eye: usize| {
            (Rotation3::new(turns[eye].rotation_rad) * Rotation3::new(self.base_rad[eye])).scaled_axis()
        });
        let since = [0, 1].map(|eye: usize| turns[eye].rotation_rad);
        let both = [0, 1].map(|eye: usize| (&turns[eye], followed[eye].as_slice()));
        let seen = |kept: &Kept| kept.seen(setup, both, &since, [&self.under, now]);
        let references = self.references.iter().map(seen).collect();
        let flags = turns.iter().flat_map(|turn| &turn.went_along);
        let (along, all) = flags.fold((0u32, 0u32), |(along, all), went| (along + u32::from(*went), all + 1));
        let sigmas_rad = [0, 1].map(|eye: usize| turns[eye].covariance_rad2.trace().max(0.0).sqrt());
        let along_share = f64::from(along) / f64::from(all.max(1));
        Ok(Some(Looked { turns_rad: total, sigmas_rad, references, along_share }))
    }
}
