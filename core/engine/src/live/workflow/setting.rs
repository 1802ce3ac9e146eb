//! What it rests on: calibration, model, head and aim, and the setup that is made of them.

use std::sync::Arc;

use plumbline_effects::RobotModel;
use plumbline_model::aim::DEFAULT_SIZE_PX;
use plumbline_model::robot::Posture;
use plumbline_model::{AimError, AimedPair, StereoCalibration, Workspace};

use super::LiveWorkflow;
use crate::live::command::{AimChoice, HeadPose};
use crate::live::setup::{LiveSetup, NoSetup, aimed, max_disparity_px};

/// Turns of the head from which the virtual pair is aimed anew, rad.
const AIM_ANEW_RAD: f64 = 0.02;

impl LiveWorkflow {
    /// Takes over the calibration in use; does nothing if it is the one already known.
    pub fn set_calibration(&mut self, calibration: Option<&Arc<StereoCalibration>>) {
        let same = match (&self.calibration, calibration) {
            (Some(known), Some(new)) => Arc::ptr_eq(known, new),
            (None, None) => true,
            _ => false,
        };
        if !same {
            self.calibration = calibration.cloned();
            self.set_up();
        }
    }

    /// The head has turned. A small turn only moves the eyes; a larger one aims the virtual pair
    /// anew.
    pub fn set_head(&mut self, head: HeadPose) {
        self.head = head;
        let turned_rad = (head.head_z_rad - self.aimed_for.head_z_rad)
            .abs()
            .max((head.head_y_rad - self.aimed_for.head_y_rad).abs());
        if turned_rad > AIM_ANEW_RAD {
            self.set_up();
            return;
        }
        let posture = self.posture();
        if let Ok(setup) = &mut self.setup {
            Arc::make_mut(setup).posture = posture;
        }
    }

    /// A recording says how the head stood then; how it stands now is kept until that is closed.
    pub fn set_recorded_head(&mut self, head: HeadPose) {
        self.head_before.get_or_insert(self.head);
        self.set_head(head);
    }

    /// A recording was closed: the head stands as the robot says, else as it did before.
    pub fn leave_recorded_head(&mut self, known: Option<HeadPose>) {
        let before = self.head_before.take();
        if let Some(head) = known.or(before) {
            self.set_head(head);
        }
    }

    /// For how long the eyes have been on, s; `None`: nobody knows.
    pub fn set_eyes_on(&mut self, eyes_on_s: Option<f64>) {
        if eyes_on_s != self.eyes_on_s {
            self.eyes_on_s = eyes_on_s;
            if let Ok(setup) = &mut self.setup {
                Arc::make_mut(setup).eyes_on_s = eyes_on_s;
            }
        }
    }

    /// How far the right eye was seen to have turned against the left one since they were calibrated, rad; 0: nobody has
    /// seen that.
    pub fn set_seen_apart(&mut self, apart_rad: f64) {
        if apart_rad != self.apart_rad {
            self.apart_rad = apart_rad;
            if let Ok(setup) = &mut self.setup {
                Arc::make_mut(setup).apart_rad = apart_rad;
            }
        }
    }

    /// Takes over what is known of the robot; places rest on it from now on.
    pub fn set_model(&mut self, model: &Arc<RobotModel>) {
        if Arc::ptr_eq(&self.model, model) {
            return;
        }
        let before = std::mem::replace(&mut self.model, model.clone());
        if before.rig().eyes != model.rig().eyes || !Arc::ptr_eq(before.added(), model.added()) {
            self.nominal = self.nominal.as_ref().map(|_| lenses_of(model));
            self.set_up();
        } else if let Ok(setup) = &mut self.setup {
            Arc::make_mut(setup).model = model.clone();
        }
    }

    /// Whether the rig's lenses stand in as long as nobody has calibrated these eyes.
    pub fn use_nominal_lenses(&mut self, wanted: bool) {
        if wanted != self.nominal.is_some() {
            self.nominal = wanted.then(|| lenses_of(&self.model));
            self.set_up();
        }
    }

    /// The part of the table that the eyes look at, and from where.
    pub fn workspace(&self) -> Workspace {
        let posture = self.posture();
        let robot_from_left = self.model.robot_from_left(&posture);
        Workspace { robot_from_left, ..self.model.rig().workspace(&posture) }
    }

    fn posture(&self) -> Posture {
        let HeadPose { head_z_rad, head_y_rad } = self.head;
        let rig = self.model.rig();
        rig.home().with(&[rig.eyes.pan, rig.eyes.tilt], &[head_z_rad, head_y_rad])
    }

    /// Makes a new setup from calibration, aim and head.
    pub(super) fn set_up(&mut self) {
        self.generation += 1;
        self.clear_products();
        self.aimed_for = self.head;
        self.setup = match self.calibration.as_ref().or(self.nominal.as_ref()) {
            None => Err(NoSetup::NotCalibrated),
            Some(calibration) => {
                let workspace = self.workspace();
                aimed(self.aim, &calibration.cameras, &workspace)
                    // A head that looks away from the table still shows what is in front of it.
                    .or_else(|error| match (self.aim, error) {
                        (AimChoice::Table, AimError::TooWide { .. }) => {
                            AimedPair::turned_down(&calibration.cameras, 0.0, 2.0, DEFAULT_SIZE_PX)
                        }
                        (_, error) => Err(error),
                    })
                    .map(|pair| {
                        Arc::new(LiveSetup {
                            generation: self.generation,
                            calibration: calibration.clone(),
                            max_disparity_px: max_disparity_px(&pair, &workspace),
                            pair,
                            model: self.model.clone(),
                            title: self.model.title().into(),
                            posture: self.posture(),
                            eyes_on_s: self.eyes_on_s,
                            apart_rad: self.apart_rad,
                        })
                    })
                    .map_err(NoSetup::from)
            }
        };
    }
}

/// Lenses that nobody calibrated, as they are in a model.
fn lenses_of(model: &RobotModel) -> Arc<StereoCalibration> {
    Arc::new(StereoCalibration::bare(model.rig().eyes.cameras))
}
