//! What a robot with the model's effects should have measured, row by row.

use nalgebra::{DMatrix, Isometry3};
use plumbline_model::predict::{PredictError, SessionPrediction, predict_session};
use plumbline_model::robot::Rig;
use plumbline_model::session::{LocalizationTable, Screen, Session, TouchTable, Touchscreen};
use plumbline_model::{Pixel, Point};

use super::{PlacedExternal, PlacedScreen, RigModel, tips};
use crate::arm::Arm;
use crate::eyes::Eyes;
use crate::forward::Assumed;
use crate::library::{Present, Surface};
use crate::looking::Looking;
use crate::measurements::{LeftOut, Measurements, What};

/// Predicts every row of a session as [`predict_session`] does, with the effects of a model. Touches
/// are projected onto `screen`, or onto the screen where the model has it for this session; poses are
/// in the external frame where the model has one, else in the robot's. Without effects it is
/// [`predict_session`] itself.
///
/// # Errors
/// As [`predict_session`].
pub fn predict_session_with(
    session: &Session,
    rig: &Rig,
    screen: Option<&Touchscreen>,
    model: &RigModel,
) -> Result<SessionPrediction, PredictError> {
    if model.is_nominal() {
        return predict_session(session, rig, screen);
    }
    let own = session.manifest.touchscreen.as_ref();
    let screen = screen.or_else(|| own.and_then(|own| model.screen(own))).or(own);
    let mut prediction = predict_session(session, rig, screen)?;
    let filled = filled(session, &prediction);
    // What is wrong with the session was said already; what is left is that no row can be used.
    let mut measurements = match Measurements::of_sessions(&[(String::new(), filled)], rig) {
        Ok(measurements) => measurements,
        Err(error) => {
            let rows = 0..prediction.poses.len();
            let table = What::Pose.table();
            let left_out = |row| LeftOut { session: 0, table: table.to_owned(), row, why: error.to_string() };
            tips::tell(session, &rows.map(left_out).collect::<Vec<_>>(), None, &mut prediction);
            return Ok(prediction);
        }
    };
    let tip = session.manifest.chain.as_ref().map(|chain| chain.tip.as_str());
    let apparatus = &mut measurements.apparatuses[0];
    if let (Some(screen), Some(_)) = (screen, &apparatus.surface) {
        apparatus.surface = Some(Surface::of(screen));
    }
    let effects = model.present(tip, apparatus.arm.as_ref(), apparatus.eyes.as_ref());
    let on_screen =
        Assumed { effects: effects.clone(), placements: vec![Isometry3::identity()], ..Assumed::default() };
    let external = model.external(session.manifest.pose_setup().external_frame.as_deref());
    let outside = Assumed {
        effects: in_the_air(&effects),
        placements: vec![external.map(|placed| placed.external_from_robot).unwrap_or_default()],
        mounts: vec![external.map(|placed| placed.tip_from_marker).unwrap_or_default()],
        ..Assumed::default()
    };
    let has_pixels = session.localizations.as_ref().is_some_and(|table| table.table().has("left_u_px"));
    let seen: Vec<_> = session.localizations.iter().flat_map(LocalizationTable::rows).collect();
    for row in &measurements.rows {
        match row.what {
            What::Touch => {
                let (Some(screen), Some(at)) = (screen, measurements.predict(row, &on_screen)) else {
                    continue;
                };
                let touch = &mut prediction.touches[row.row];
                touch.touch = pixel(screen, at[0], at[1]);
                touch.above_glass_m = at[2];
            }
            What::Pose | What::OrientedPose => {
                let Some(at) = measurements.external_from_tip(row, &outside) else { continue };
                let Some(pose) = &mut prediction.poses[row.row] else { continue };
                let [x, y, z] = at.translation.vector.into();
                pose.tip = Point::new(x, y, z);
                pose.turn = at.rotation;
            }
            What::Place | What::EyePoints => {
                let Some(eyes) = &measurements.apparatuses[0].eyes else { continue };
                let looking = Looking { eyes, row, effects: &effects };
                let located = &mut prediction.localizations[row.row];
                let truth = seen.get(row.row).and_then(|seen| seen.truth);
                located.estimate = truth.and_then(|truth| looking.estimate(truth));
                located.pixels = truth.filter(|_| has_pixels).and_then(|truth| looking.pixels(truth));
                located.corrected = located.corrected.and_then(|inferred| looking.place_of(inferred));
            }
        }
    }
    tips::tell(session, &measurements.left_out, external, &mut prediction);
    Ok(prediction)
}

impl RigModel {
    /// Where the model has a screen that is taken to lie at `nominal`: as it was placed with that
    /// screen, else as it was placed last with one of the same resolution. `None` without any.
    pub fn screen(&self, nominal: &Touchscreen) -> Option<&Touchscreen> {
        self.placed(nominal).map(|placed| &placed.screen)
    }

    /// So much higher than the table around it the glass of a screen lies, m; `None`: nobody measured it.
    pub fn glass_over_table_m(&self, nominal: &Touchscreen) -> Option<f64> {
        self.placed(nominal)?.over_table_m
    }

    fn placed(&self, nominal: &Touchscreen) -> Option<&PlacedScreen> {
        let size = |screen: &Touchscreen| (screen.width_px, screen.height_px);
        let screens = &self.contents.screens;
        let same = screens.iter().rev().find(|placed| placed.is_of(nominal));
        let other = || screens.iter().rev().find(|placed| size(&placed.screen) == size(nominal));
        same.or_else(other)
    }

    /// The external frame of this label that was placed last; without a label, or where no frame that the model
    /// has is labeled, the last one of all.
    pub fn external(&self, frame: Option<&str>) -> Option<&PlacedExternal> {
        let placed = &self.contents.externals;
        match frame {
            Some(label) if placed.iter().any(|one| one.frame.is_some()) => {
                placed.iter().rev().find(|one| one.frame.as_deref() == Some(label))
            }
            _ => placed.last(),
        }
    }

    /// Effects that an arm which ends in `tip`, or eyes, have. Those of the other arm are left out, and
    /// those of another tip's own.
    pub fn present(&self, tip: Option<&str>, arm: Option<&Arm>, eyes: Option<&Eyes>) -> Vec<Present> {
        self.measured(tip, arm, eyes).present
    }

    /// The same, with how well their values are known.
    pub(crate) fn measured(&self, tip: Option<&str>, arm: Option<&Arm>, eyes: Option<&Eyes>) -> Measured {
        // What was found on one arm says nothing of another one, whatever its site is called.
        let of_arm = |own: &str| arm.is_none_or(|arm| arm.has_tip(own));
        let here = |effect: &super::ModelEffect| {
            let same = |own: &str| if effect.is_of_the_tip() { Some(own) == tip } else { of_arm(own) };
            effect.tip.as_deref().is_none_or(same)
        };
        let all = self.effects().iter().enumerate().filter(|(_, effect)| here(effect));
        let (numbers, present): (Vec<usize>, Vec<Present>) =
            all.filter_map(|(i, effect)| effect.on(arm, eyes).map(|present| (i, present))).unzip();
        Measured { covariance: self.contents.covariance_of(&numbers), present }
    }

    /// Whether it is said how well the effects of an arm are known together.
    pub(crate) fn is_known_together(&self, arm: &Arm) -> bool {
        let tips = self.contents.together.iter().filter_map(|together| together.tip.as_deref());
        tips.into_iter().any(|tip| arm.has_tip(tip))
    }

    /// Rows for a search for what comes in addition: predictions of these rows hold this model's
    /// effects. Frames are where the sessions say, since a search places them itself.
    pub fn put_into(&self, mut measurements: Measurements) -> Measurements {
        measurements.present = self.present_in(&measurements);
        measurements
    }

    /// Effects that the arm and the eyes of these rows have.
    pub(super) fn present_in(&self, measurements: &Measurements) -> Vec<Present> {
        let tip = measurements.apparatuses.iter().find_map(|apparatus| apparatus.tip.as_deref());
        let arm = measurements.apparatuses.iter().find_map(|apparatus| apparatus.arm.as_ref());
        let eyes = measurements.apparatuses.iter().find_map(|apparatus| apparatus.eyes.as_ref());
        self.present(tip, arm, eyes)
    }
}

/// Effects that are there, and how well their values are known.
#[derive(Clone, Debug)]
pub(crate) struct Measured {
    pub present: Vec<Present>,
    /// Covariance of all values in turn; zero where nobody knows it.
    pub covariance: DMatrix<f64>,
}

impl Measured {
    /// Those of them that are wanted.
    pub fn of(self, is_wanted: impl Fn(&Present) -> bool) -> Self {
        let mut rows = vec![];
        let mut next = 0;
        for present in &self.present {
            let count = present.values.len();
            if is_wanted(present) {
                rows.extend(next..next + count);
            }
            next += count;
        }
        let covariance = self.covariance.select_rows(&rows).select_columns(&rows);
        Self { present: self.present.into_iter().filter(is_wanted).collect(), covariance }
    }
}

/// Those that are there without a touchscreen.
pub(super) fn in_the_air(effects: &[Present]) -> Vec<Present> {
    effects.iter().filter(|present| !present.effect.kind.is_of_contact()).cloned().collect()
}

/// The pixel at this place along u and v from the middle of the image, m.
fn pixel(screen: &Touchscreen, u_m: f64, v_m: f64) -> Pixel<Screen> {
    let ([pitch_u_m, pitch_v_m], middle) = (screen.pitch_m(), screen.middle());
    Pixel::new(middle.u_px + u_m / pitch_u_m, middle.v_px + v_m / pitch_v_m)
}

/// The session as if something had been measured in every row: predictions do not need it.
fn filled(session: &Session, nominal: &SessionPrediction) -> Session {
    let mut filled = session.clone();
    if let (Some(table), Some(screen)) = (&session.touches, &session.manifest.touchscreen) {
        let rows: Vec<_> = table
            .rows()
            .map(|mut row| {
                row.touch = row.touch.or(Some(screen.middle()));
                row
            })
            .collect();
        filled.touches = Some(TouchTable::from_rows(table.joints().to_vec(), &rows));
    }
    if let Some(table) = &session.poses {
        let rows: Vec<_> = table
            .rows()
            .zip(&nominal.poses)
            .map(|(mut row, nominal)| {
                row.measured = row.measured.or(nominal.map(|nominal| Point::from(nominal.tip.coords)));
                row
            })
            .collect();
        filled.poses = Some(table.with_rows(&rows));
    }
    if let Some(table) = &session.localizations {
        let rows: Vec<_> = table
            .rows()
            .zip(&nominal.localizations)
            .map(|(mut row, nominal)| {
                row.truth = row.truth.or(nominal.corrected);
                row.estimate = row.truth;
                (row.left, row.right, row.valid) = (None, None, true);
                row
            })
            .collect();
        filled.localizations = Some(LocalizationTable::from_rows(table.head_joints().to_vec(), &rows));
    }
    filled
}
