//! What stands somewhere: the eyes in the head, the table, the touchscreen.

use nalgebra::Vector3;

use super::Reader;
use super::parts::{EyesPart, LensPart, ScreenPart, TablePart, WorkspacePart};
use crate::camera::{Camera, CameraModel, Fisheye};
use crate::frame::{Direction as Axis, Point, Pose};
use crate::plausible;
use crate::robot::error::RigError;
use crate::robot::rig::{EyeMount, TableTop, WorkPatch};
use crate::session::{CalibratedAt, Touchscreen};
use crate::stereo::StereoCameras;

impl Reader<'_> {
    pub(in crate::robot) fn eyes(&self, part: &EyesPart) -> Result<EyeMount, RigError> {
        let vectors = [
            part.left_position_m,
            part.left_rotation_rad,
            part.right_from_left_rotation_rad,
            part.right_from_left_translation_m,
        ];
        self.finite("eyes", vectors.as_flattened())?;
        let [position, rotation, right_rotation, right_translation] = vectors.map(Vector3::from);
        self.plausible("eyes", plausible::LINK_LENGTH_M, &part.left_position_m)?;
        self.plausible(
            "eyes",
            plausible::ANGLE_RAD,
            &[part.left_rotation_rad, part.right_from_left_rotation_rad].concat(),
        )?;
        self.plausible("eyes", plausible::BASELINE_M, &[right_translation.norm()])?;
        Ok(EyeMount {
            link: self.robot.find_link(&part.link).map_err(|error| self.unknown("eyes", error))?,
            pan: self.joint("eyes", &part.pan)?,
            tilt: self.joint("eyes", &part.tilt)?,
            head_from_left: EyeMount::pose(position, rotation),
            cameras: StereoCameras {
                left: self.lens("eyes.left", &part.left)?,
                right: self.lens("eyes.right", &part.right)?,
                right_from_left: Pose::from_rotation_vector(right_rotation, right_translation),
            },
            calibrated_at: CalibratedAt::default(),
        })
    }

    fn lens(&self, place: &str, part: &LensPart) -> Result<Camera, RigError> {
        self.finite(place, &[part.fx_px, part.fy_px, part.cx_px, part.cy_px, part.skew_px])?;
        self.finite(place, &part.k)?;
        if part.width_px == 0 || part.height_px == 0 || part.fx_px <= 0.0 || part.fy_px <= 0.0 {
            return Err(self.value(place, "image size and focal lengths must be positive".to_owned()));
        }
        let lens = Fisheye {
            fx_px: part.fx_px,
            fy_px: part.fy_px,
            cx_px: part.cx_px,
            cy_px: part.cy_px,
            skew_px: part.skew_px,
            k: part.k,
        };
        let (width_px, height_px) = (part.width_px, part.height_px);
        let camera = Camera { model: CameraModel::Fisheye(lens), width_px, height_px };
        camera.check_plausible().map_err(|what| self.value(place, what.to_string()))?;
        Ok(camera)
    }

    pub(in crate::robot) fn table(&self, part: &TablePart) -> Result<TableTop, RigError> {
        self.plausible("table", plausible::PLACE_M, &[part.height_m])?;
        self.plausible("table", plausible::PLACE_M, &[part.x_range_m, part.y_range_m].concat())?;
        if part.x_range_m[0] >= part.x_range_m[1] || part.y_range_m[0] >= part.y_range_m[1] {
            return Err(self.value("table", "ranges go from the smaller to the larger value".to_owned()));
        }
        Ok(TableTop { height_m: part.height_m, x_range_m: part.x_range_m, y_range_m: part.y_range_m })
    }

    pub(in crate::robot) fn work_patch(&self, part: &WorkspacePart) -> Result<WorkPatch, RigError> {
        self.plausible("workspace", plausible::PLACE_M, &[part.headroom_m])?;
        self.plausible("workspace", plausible::PLACE_M, &[part.x_range_m, part.y_range_m].concat())?;
        let rising = part.x_range_m[0] < part.x_range_m[1] && part.y_range_m[0] < part.y_range_m[1];
        if !rising || part.headroom_m <= 0.0 {
            let what = "ranges go from the smaller to the larger value, and the headroom is positive";
            return Err(self.value("workspace", what.to_owned()));
        }
        Ok(WorkPatch { x_range_m: part.x_range_m, y_range_m: part.y_range_m, headroom_m: part.headroom_m })
    }

    pub(in crate::robot) fn screen(&self, part: &ScreenPart) -> Result<Touchscreen, RigError> {
        let axis = |name: &str, vector: [f64; 3]| {
            Axis::new(Vector3::from(vector))
                .ok_or_else(|| self.value("touchscreen", format!("{name} has no direction")))
        };
        self.plausible("touchscreen", plausible::DIRECTION, &[part.u_axis, part.v_axis].concat())?;
        self.plausible("touchscreen", plausible::SCREEN_PLACE_M, &part.origin_m)?;
        self.finite("touchscreen", &[part.width_m, part.height_m])?;
        let (u_axis, v_axis) = (axis("u_axis", part.u_axis)?, axis("v_axis", part.v_axis)?);
        let sized = part.width_px > 0 && part.height_px > 0 && part.width_m > 0.0 && part.height_m > 0.0;
        if !sized || u_axis.vector().dot(&v_axis.vector()).abs() > 1e-6 {
            return Err(
                self.value("touchscreen", "sizes must be positive and the axes at right angles".to_owned())
            );
        }
        self.plausible("touchscreen", plausible::SCREEN_SIDE_M, &[part.width_m, part.height_m])?;
        let pixels = [f64::from(part.width_px), f64::from(part.height_px)];
        self.plausible("touchscreen", plausible::SCREEN_SIDE_PX, &pixels)?;
        let [x, y, z] = part.origin_m;
        Ok(Touchscreen {
            width_px: part.width_px,
            height_px: part.height_px,
            width_m: part.width_m,
            height_m: part.height_m,
            origin: Point::new(x, y, z),
            u_axis,
            v_axis,
        })
    }
}
