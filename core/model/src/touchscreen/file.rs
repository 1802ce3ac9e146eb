//! Screen placements as files, and in a rig.

use std::path::Path;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::{PlacementError, ScreenPlacement};
use crate::formats::depth;
use crate::formats::text_file;
use crate::frame::{Direction, Point, Robot};
use crate::plausible;
use crate::robot::Rig;
use crate::session::Touchscreen;

/// Version of the format.
const FORMAT: u32 = 1;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: u32,
    rig: String,
    at: String,
    touches: usize,
    rms_m: f64,
    moved_m: [f64; 3],
    turned_rad: [f64; 3],
    sd_m: [f64; 3],
    sd_rad: [f64; 3],
    remarks: Vec<String>,
    residuals_m: Vec<[f64; 3]>,
    screen: ScreenPart,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ScreenPart {
    width_px: u32,
    height_px: u32,
    width_m: f64,
    height_m: f64,
    origin_m: [f64; 3],
    u_axis: [f64; 3],
    v_axis: [f64; 3],
}

impl ScreenPlacement {
    /// The placement with the short name of its rig.
    pub fn of_rig(self, rig: &str) -> Self {
        Self { rig: rig.to_owned(), ..self }
    }

    /// The rig with its touchscreen where it was measured to lie.
    ///
    /// # Errors
    /// When the placement belongs to another rig.
    pub fn applied_to(&self, rig: &Rig) -> Result<Rig, PlacementError> {
        self.belongs_to(&rig.name)?;
        Ok(Rig { touchscreen: self.screen.clone(), ..rig.clone() })
    }

    /// Writes it in one step: after a crash there is the old file or the new one.
    ///
    /// # Errors
    /// When it does not name its rig, or the file cannot be written.
    pub fn write(&self, file: &Path) -> Result<(), PlacementError> {
        if self.rig.is_empty() {
            return Err(PlacementError::NoRig);
        }
        let unusable = |reason: String| PlacementError::NotPlacement { file: file.to_path_buf(), reason };
        let text = toml::to_string(&File::of(self)).map_err(|error| unusable(error.to_string()))?;
        // What cannot be read again must not replace what could.
        Self::parse(file, &text)?;
        Ok(text_file::write(file, &text)?)
    }

    /// Reads a placement of the rig with this short name.
    ///
    /// # Errors
    /// When the file cannot be read, is no placement, or belongs to another rig.
    pub fn read(file: &Path, rig: &str) -> Result<Self, PlacementError> {
        let placement = Self::parse(file, &text_file::read(file)?)?;
        placement.belongs_to(rig)?;
        Ok(placement)
    }

    fn belongs_to(&self, rig: &str) -> Result<(), PlacementError> {
        if self.rig == rig {
            return Ok(());
        }
        Err(PlacementError::OtherRig { found: self.rig.clone(), expected: rig.to_owned() })
    }

    fn parse(file: &Path, text: &str) -> Result<Self, PlacementError> {
        let unusable = |reason: String| PlacementError::NotPlacement { file: file.to_path_buf(), reason };
        depth::check(depth::of_toml(text)).map_err(unusable)?;
        let parts: File = toml::from_str(text).map_err(|error| unusable(error.message().to_owned()))?;
        parts.placement().map_err(unusable)
    }
}

impl File {
    fn of(placement: &ScreenPlacement) -> Self {
        let screen = &placement.screen;
        Self {
            format: FORMAT,
            rig: placement.rig.clone(),
            at: placement.at.to_string(),
            touches: placement.touches,
            rms_m: placement.rms_m,
            moved_m: placement.moved_m,
            turned_rad: placement.turned_rad,
            sd_m: placement.sd_m,
            sd_rad: placement.sd_rad,
            remarks: placement.remarks.clone(),
            residuals_m: placement.residuals_m.clone(),
            screen: ScreenPart {
                width_px: screen.width_px,
                height_px: screen.height_px,
                width_m: screen.width_m,
                height_m: screen.height_m,
                origin_m: screen.origin.coords.coords.into(),
                u_axis: screen.u_axis.vector().into(),
                v_axis: screen.v_axis.vector().into(),
            },
        }
    }

    fn placement(self) -> Result<ScreenPlacement, String> {
        if self.format != FORMAT {
            return Err(format!("it has format {}, this program reads {FORMAT}", self.format));
        }
        let vectors = [self.moved_m, self.turned_rad, self.sd_m, self.sd_rad];
        let numbers = vectors.iter().chain(&self.residuals_m).flatten().chain([&self.rms_m]);
        if let Some(number) = numbers.into_iter().find(|number| !number.is_finite()) {
            return Err(format!("it holds {number}"));
        }
        if self.residuals_m.len() != self.touches {
            return Err(format!("it holds {} residuals of {} touches", self.residuals_m.len(), self.touches));
        }
        Ok(ScreenPlacement {
            screen: self.screen.screen()?,
            moved_m: self.moved_m,
            turned_rad: self.turned_rad,
            sd_m: self.sd_m,
            sd_rad: self.sd_rad,
            rms_m: self.rms_m,
            touches: self.touches,
            residuals_m: self.residuals_m,
            remarks: self.remarks,
            at: self.at.parse().map_err(|error| format!("at = \"{}\": {error}", self.at))?,
            rig: self.rig,
        })
    }
}

impl ScreenPart {
    fn screen(self) -> Result<Touchscreen, String> {
        let axis = |name: &str, vector: [f64; 3]| {
            Direction::<Robot>::new(Vector3::from(vector)).ok_or_else(|| format!("{name} has no direction"))
        };
        let [x, y, z] = self.origin_m;
        let screen = Touchscreen {
            width_px: self.width_px,
            height_px: self.height_px,
            width_m: self.width_m,
            height_m: self.height_m,
            origin: Point::new(x, y, z),
            u_axis: axis("u_axis", self.u_axis)?,
            v_axis: axis("v_axis", self.v_axis)?,
        };
        if !screen.is_usable() {
            return Err("the screen has no size, or its axes are not at right angles".to_owned());
        }
        let wrong = |what: plausible::Implausible| what.to_string();
        plausible::SCREEN_PLACE_M.check_all(screen.origin.coords.iter()).map_err(wrong)?;
        plausible::SCREEN_SIDE_M.check_all(&[screen.width_m, screen.height_m]).map_err(wrong)?;
        let pixels = [f64::from(screen.width_px), f64::from(screen.height_px)];
        plausible::SCREEN_SIDE_PX.check_all(&pixels).map_err(wrong)?;
        Ok(screen)
    }
}
