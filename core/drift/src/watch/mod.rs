//! One look after the other: how each eye has turned since the first, and what moved by itself.

mod reference;
mod remembered;

use std::sync::Arc;

use image::GrayImage;
use nalgebra::Vector3;
use plumbline_effects::{RobotModel, SeenUnder};
use plumbline_model::robot::Posture;
use plumbline_vision::health::{HealthError, Match, Turn, epipolar_px, find_matches, fit_turn};

pub use reference::{Reference, ReferenceKind, ReferenceSeen};
use remembered::Remembered;

use crate::cost::{TableError, errors};

/// Between the eyes places are matched in one of so many looks: that takes longer than following them.
const MATCH_EVERY: usize = 15;
/// Joints that moved by more than this stand elsewhere, rad.
const MOVED_RAD: f64 = 0.006;
/// After so many looks in a row at which nothing could be followed, or a reference stands elsewhere, what is
/// seen is remembered anew.
const ANEW_AFTER: usize = 3;
/// What the eyes turned against each other while the head moved counts beyond this many standard deviations,
/// and beyond this angle (rad): matches are a few thousandths of a degree off with what is seen.
const SURE: f64 = 4.0;
const LEAST_TURN_RAD: f64 = 7e-4;

/// What a look rests on.
#[derive(Clone, Debug)]
pub struct WatcherSetup {
    /// The robot as it is known, with the calibration of the eyes in use.
    pub model: Arc<RobotModel>,
    /// Angles of all joints by the encoders, rad.
    pub posture: Posture,
    /// Time since the eyes were switched on, s; `None`: not known.
    pub eyes_on_s: Option<f64>,
    /// What stands where, in the order of importance: a place belongs to the first that it lies in.
    pub references: Vec<Reference>,
}

/// What a look found.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// How the left and the right eye have turned since the first look, rad, own axes.
    pub turns_rad: [Vector3<f64>; 2],
    /// How well, rad: one standard deviation of each eye's size.
    pub sigmas_rad: [f64; 2],
    /// How the right eye has turned against the left one since then, rad, axes of the right eye.
    pub against_rad: Vector3<f64>,
    /// Whether it is known which eye turned: the head stood still whenever one did.
    pub knows_which: bool,
    /// How far off that puts places on the table.
    pub table: TableError,
    /// How far places leave the epipolar planes of the calibration in use, rms, px; `None`: not matched this time.
    pub epipolar_px: Option<f64>,
    /// References that could be looked for.
    pub references: Vec<ReferenceSeen>,
    /// Share of the followed places that go with the eyes.
    pub along_share: f64,
}

/// Why nothing came of a look.
#[derive(Debug, thiserror::Error)]
pub enum WatchError {
    /// Too little to see, or another size.
    #[error(transparent)]
    Images(#[from] HealthError),
    /// Something hides it.
    #[error(
        "too little of what was seen before is seen again: something moves or stands before the eyes, or the light has \
         changed; it looks again by itself"
    )]
    NotSeenAgain,
    /// The head looks elsewhere.
    #[error("the eyes do not look at the table: turn the head toward it")]
    TableNotSeen,
}

/// Looks at pairs and remembers what it needs.
#[derive(Debug, Default)]
pub struct Watcher {
    remembered: Option<Remembered>,
    /// The last turns, rad.
    turns_rad: [Vector3<f64>; 2],
    first: Option<SeenUnder>,
    matched: Option<Turn>,
    looks: usize,
    misses: usize,
    elsewhere: usize,
    lost_which: bool,
}

impl Watcher {
    /// Looks at a pair (left, right) of eyes at rest.
    ///
    /// # Errors
    /// When the images are of another size, or there is too little to see in them; nothing is forgotten.
    pub fn look(&mut self, setup: &WatcherSetup, pair: (&GrayImage, &GrayImage)) -> Result<Look, WatchError> {
        let now = SeenUnder { t_secs: setup.eyes_on_s, ..SeenUnder::default() };
        let first = *self.first.get_or_insert(now);
        let stood = self.stood(setup);
        let mut epipolar = None;
        if stood == Stood::HeadElsewhere || self.looks.is_multiple_of(MATCH_EVERY) {
            epipolar = self.match_eyes(setup, pair, stood)?;
        }
        self.looks += 1;
        if stood == Stood::HeadElsewhere {
            self.remembered = None;
        }
        let looked = match &self.remembered {
            None => None,
            Some(remembered) => remembered.look(setup, pair, self.turns_rad, &now)?,
        };
        let Some(looked) = looked else {
            return self.begin(setup, pair, &first, &now, epipolar);
        };
        self.misses = 0;
        self.turns_rad = looked.turns_rad;
        self.elsewhere =
            if looked.references.iter().any(ReferenceSeen::is_elsewhere) { self.elsewhere + 1 } else { 0 };
        if stood == Stood::ArmElsewhere || self.elsewhere >= ANEW_AFTER {
            self.remember(setup, pair, now)?;
        }
        let table = self.table(setup, &first, &now)?;
        Ok(Look {
            turns_rad: looked.turns_rad,
            sigmas_rad: looked.sigmas_rad,
            against_rad: self.against_rad(setup),
            knows_which: !self.lost_which,
            table,
            epipolar_px: epipolar,
            references: looked.references,
            along_share: looked.along_share,
        })
    }

    /// Nothing is remembered, or nothing of it is seen again.
    fn begin(
        &mut self,
        setup: &WatcherSetup,
        pair: (&GrayImage, &GrayImage),
        first: &SeenUnder,
        now: &SeenUnder,
        epipolar: Option<f64>,
    ) -> Result<Look, WatchError> {
        if self.remembered.is_some() {
            self.misses += 1;
            if self.misses < ANEW_AFTER {
                return Err(WatchError::NotSeenAgain);
            }
        }
        self.remember(setup, pair, *now)?;
        self.misses = 0;
        let table = self.table(setup, first, now)?;
        Ok(Look {
            turns_rad: self.turns_rad,
            sigmas_rad: [0.0; 2],
            against_rad: self.against_rad(setup),
            knows_which: !self.lost_which,
            table,
            epipolar_px: epipolar,
            references: Vec::new(),
            along_share: 1.0,
        })
    }

    fn remember(
        &mut self,
        setup: &WatcherSetup,
        pair: (&GrayImage, &GrayImage),
        now: SeenUnder,
    ) -> Result<(), WatchError> {
        self.remembered = Some(Remembered::new(setup, pair, self.turns_rad, now)?);
        self.elsewhere = 0;
        Ok(())
    }

    fn table(
        &self,
        setup: &WatcherSetup,
        first: &SeenUnder,
        now: &SeenUnder,
    ) -> Result<TableError, WatchError> {
        errors(&setup.model, &setup.posture, self.turns_rad, first, now).ok_or(WatchError::TableNotSeen)
    }

    fn against_rad(&self, setup: &WatcherSetup) -> Vector3<f64> {
        let right_from_left = setup.model.rig().eyes.cameras.right_from_left.isometry.rotation;
        self.turns_rad[1] - right_from_left * self.turns_rad[0]
    }

    fn stood(&self, setup: &WatcherSetup) -> Stood {
        let Some(remembered) = &self.remembered else { return Stood::Still };
        let eyes = &setup.model.rig().eyes;
        let moved = |joint| (remembered.posture[joint] - setup.posture[joint]).abs() > MOVED_RAD;
        if moved(eyes.pan) || moved(eyes.tilt) {
            return Stood::HeadElsewhere;
        }
        let arm = setup.model.rig().servos.iter().any(|servo| moved(servo.joint));
        if arm { Stood::ArmElsewhere } else { Stood::Still }
    }

    /// Matches places between the eyes. Where the head has moved since, what the eyes turned against each
    /// other meanwhile is told from that: nobody knows which of them it was.
    fn match_eyes(
        &mut self,
        setup: &WatcherSetup,
        (left, right): (&GrayImage, &GrayImage),
        stood: Stood,
    ) -> Result<Option<f64>, WatchError> {
        let cameras = &setup.model.rig().eyes.cameras;
        let pair = [(left.clone(), right.clone())];
        let matches: Vec<Match> = match find_matches(cameras, &pair) {
            Ok((matches, _)) => matches,
            Err(HealthError::TooFew { .. } | HealthError::NotDetermined) => return Ok(None),
            Err(error) => return Err(error.into()),
        };
        if let Ok(turn) = fit_turn(cameras, &matches) {
            if let (Stood::HeadElsewhere, Some(before)) = (stood, &self.matched) {
                let moved = turn.rotation_rad - before.rotation_rad;
                let variance = (turn.covariance_rad2 + before.covariance_rad2).trace();
                if moved.norm() > (SURE * variance.max(0.0).sqrt()).max(LEAST_TURN_RAD) {
                    self.turns_rad[1] += moved;
                    self.lost_which = true;
                }
            }
            self.matched = Some(turn);
        }
        Ok(Some(epipolar_px(cameras, &matches)?))
    }
}

/// Whether everything stands as it did when it was remembered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stood {
    Still,
    ArmElsewhere,
    HeadElsewhere,
}
