//! What a calibration means on the table: its uncertainty, its difference to the one in use,
//! and what speaks against it.

use plumbline_model::{
    Cancelled, JobContext, LeftCamera, Point, StereoCalibration, StereoCameras, Workspace, counted,
};

use super::geometry::{depth_per_px_m, point_sigma_m, project_both};
use super::map::TableMap;

/// Distance for which the depth of one pixel is stated, meters.
pub const STATED_AT_M: f64 = 0.45;
/// Noise of a match in each coordinate of each eye, pixels: what matching of textured places
/// reaches on the eyes' images.
pub const MATCH_SIGMA_PX: f64 = 0.15;
/// Nodes of the maps along x and y.
const NODES: (usize, usize) = (17, 37);

/// What a calibration means on the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Assessment {
    /// One standard deviation of a point on the table; `None`: the calibration does not say how well it is known.
    pub uncertainty: Option<TableMap>,
    /// How far a point moves against the calibration in use.
    pub difference: Option<TableMap>,
    /// Change of distance at [`STATED_AT_M`] that moves the match by one pixel, meters.
    pub depth_per_px_m: Option<f64>,
    /// What speaks against it, in sentences.
    pub doubts: Vec<String>,
}

/// Looks at a calibration from all sides.
pub fn assess(
    calibration: &StereoCalibration,
    in_use: Option<&StereoCalibration>,
    workspace: &Workspace,
    context: &dyn JobContext,
) -> Result<Assessment, Cancelled> {
    context.checkpoint()?;
    let uncertainty = uncertainty_map(calibration, workspace);
    context.checkpoint()?;
    Ok(Assessment {
        uncertainty,
        difference: in_use.map(|in_use| difference_map(&calibration.cameras, &in_use.cameras, workspace)),
        depth_per_px_m: depth_per_px_m(&calibration.cameras, STATED_AT_M),
        doubts: doubts(calibration, in_use),
    })
}

/// One standard deviation of points on the table: match and parameters. `None`: how well the parameters are known was
/// not said, as by files of other programs; what matching alone leaves open would look too good.
pub fn uncertainty_map(calibration: &StereoCalibration, workspace: &Workspace) -> Option<TableMap> {
    let covariance = calibration.covariance.as_ref()?;
    Some(over_table(workspace, |point_in_left| {
        point_sigma_m(&calibration.cameras, Some(covariance), point_in_left, MATCH_SIGMA_PX)
    }))
}

/// How far a point of the table that `before` sees moves when `after` locates it from the same
/// two pixels.
pub fn difference_map(after: &StereoCameras, before: &StereoCameras, workspace: &Workspace) -> TableMap {
    over_table(workspace, |point_in_left| {
        let [left, right] = project_both(before, point_in_left)?;
        Some(after.triangulate(left, right)?.distance_m(&point_in_left))
    })
}

fn over_table(workspace: &Workspace, value: impl Fn(Point<LeftCamera>) -> Option<f64>) -> TableMap {
    let left_from_robot = workspace.robot_from_left.inverse();
    let ([x0, x1], [y0, y1]) = (workspace.x_range_m, workspace.y_range_m);
    TableMap::fill(NODES.0, NODES.1, (x0, x1), (y0, y1), workspace.table_height_m, |x, y, z| {
        value(left_from_robot * Point::new(x, y, z))
    })
}

/// Sentences that an operator should read before accepting.
fn doubts(calibration: &StereoCalibration, in_use: Option<&StereoCalibration>) -> Vec<String> {
    let mut doubts = Vec::new();
    let baseline_mm = calibration.cameras.baseline_m() * 1000.0;
    if let Some(summary) = &calibration.summary {
        if summary.rms_stereo_px > 0.6 {
            doubts.push(format!(
                "The residuals are {:.2} px; a good calibration has less than 0.3 px. Look at the largest bars, drop what is wrong and solve again.",
                summary.rms_stereo_px
            ));
        }
        if let Some(cross_validated_px) = summary.cross_validated_px
            && cross_validated_px > 1.5 * summary.rms_stereo_px
        {
            doubts.push(format!(
                "On pairs that it has not seen the error is {:.1} times as large: too few pairs, or all in the same place. Collect more.",
                cross_validated_px / summary.rms_stereo_px
            ));
        }
    }
    if calibration.per_pair.len() < 10 && calibration.evidence.is_some() {
        doubts.push(format!(
            "It rests on {} only; 15 to 40 make a good calibration.",
            counted(calibration.per_pair.len(), "pair")
        ));
    }
    if let Some(in_use) = in_use {
        let before_mm = in_use.cameras.baseline_m() * 1000.0;
        if (baseline_mm - before_mm).abs() > 0.02 * before_mm {
            doubts.push(format!(
                "The eyes are {baseline_mm:.2} mm apart, with the calibration in use {before_mm:.2} mm. Is the side of the square right?"
            ));
        }
    }
    doubts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eyes::place::nominal_cameras;
    use nalgebra::{DMatrix, Vector3};
    use plumbline_model::{ModelKind, ParameterCovariance, Pose, Unattended};

    fn calibration(baseline_m: f64) -> StereoCalibration {
        let mut cameras = nominal_cameras((640, 480), ModelKind::Fisheye);
        cameras.right_from_left =
            Pose::from_rotation_vector(Vector3::zeros(), Vector3::new(-baseline_m, 0.0, 0.0));
        StereoCalibration::bare(cameras)
    }

    #[test]
    fn a_calibration_does_not_differ_from_itself() {
        let same = calibration(0.07);
        let map = difference_map(&same.cameras, &same.cameras, &Workspace::default());
        assert!(map.greatest_m().expect("the table is seen") < 1e-9);
        assert!(map.values_m.iter().flatten().count() > 300, "most of the table is seen by both eyes");
    }

    #[test]
    fn a_baseline_one_percent_longer_moves_every_point_by_one_percent_of_its_distance() {
        let (before, after) = (calibration(0.07), calibration(0.0707));
        let workspace = Workspace::default();
        let assessment = assess(&after, Some(&before), &workspace, &Unattended).expect("not cancelled");
        let difference = assessment.difference.expect("there is one in use");
        let eye = workspace.robot_from_left.translation_m();
        let (x, y) = (difference.x_range_m.0, 0.0);
        let expected_m = 0.01 * (Vector3::new(x, y, difference.z_m) - eye).norm();
        let measured_m = difference.at(0, 18).expect("the middle is seen");
        assert!((measured_m / expected_m - 1.0).abs() < 0.01, "{measured_m} instead of {expected_m}");
        assert!(assessment.doubts.is_empty(), "{:?}", assessment.doubts);
    }

    #[test]
    fn another_baseline_raises_a_doubt() {
        let (before, after) = (calibration(0.07), calibration(0.0467));
        let assessment =
            assess(&after, Some(&before), &Workspace::default(), &Unattended).expect("not cancelled");
        assert!(assessment.doubts[0].contains("square"), "{:?}", assessment.doubts);
    }

    #[test]
    fn far_places_are_less_certain_and_what_nobody_said_is_not_known() {
        let untold = calibration(0.07);
        assert!(uncertainty_map(&untold, &Workspace::default()).is_none(), "a file of another program");
        let mut matrix = DMatrix::zeros(22, 22);
        matrix[(19, 19)] = 0.0007f64.powi(2);
        let told = StereoCalibration { covariance: Some(ParameterCovariance { matrix }), ..untold };
        let map = uncertainty_map(&told, &Workspace::default()).expect("it is said");
        let middle = 18;
        let (near, far) = (map.at(0, middle).expect("seen"), map.at(16, middle).expect("seen"));
        assert!(far > 1.5 * near, "{near} near, {far} far");
    }
}
