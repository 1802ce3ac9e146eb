//! A calibration from the parsed file.

use nalgebra::{DMatrix, Isometry3, Quaternion, Translation3, UnitQuaternion};

use super::{COMPLETE, FORMAT, VERSION, self_test};
use crate::calibration::{
    CalibrationOptions, CornerResidual, Corners, Evidence, FitSummary, PairFit, PairObservation,
    ParameterCovariance, RejectedPair, StereoCalibration,
};
use crate::camera::{Camera, CameraModel, Fisheye, ModelKind, Pinhole};
use crate::chessboard::Chessboard;
use crate::formats::document::Document;
use crate::formats::error::{FormatError, Place};
use crate::formats::node::Field;
use crate::frame::{Frame, Pose};
use crate::pixel::{Eye, Pixel};
use crate::plausible::{self, Implausible};
use crate::stereo::StereoCameras;

/// Largest deviation of a quaternion's squared length from 1 that is rounding.
const QUATERNION_TOLERANCE: f64 = 1e-9;

/// Reads everything.
pub(crate) fn calibration(document: &Document) -> Result<StereoCalibration, FormatError> {
    let root = document.root();
    check_format(&root)?;
    let evidence = root.find("evidence")?.map(|field| evidence(&field)).transpose()?;
    let cameras = cameras(&root.get("cameras")?)?;
    if let Some(answers) = root.find(self_test::KEY)? {
        self_test::check(&cameras, &answers)?;
    }
    let calibration = StereoCalibration {
        cameras,
        covariance: root.find("covariance")?.map(|field| covariance(&field)).transpose()?,
        summary: root.find("summary")?.map(|field| summary(&field)).transpose()?,
        per_pair: list(&root, "pairs", pair_fit)?,
        rejected: list(&root, "rejected", rejected_pair)?,
        evidence,
    };
    if let Some(sums) = root.find(self_test::SUMS)? {
        self_test::check_sums(&calibration, &sums)?;
    }
    Ok(calibration)
}

fn check_format(root: &Field<'_>) -> Result<(), FormatError> {
    let format = root.get("format")?;
    if format.text()? != FORMAT {
        return Err(format.out_of_range(format!("\"{FORMAT}\"")));
    }
    let version = root.get("version")?;
    if version.count()? != VERSION {
        return Err(version.out_of_range(format!(
            "{VERSION}, the version that this program knows (a newer program may be needed)"
        )));
    }
    match root.find(COMPLETE)? {
        Some(mark) if mark.flag()? => Ok(()),
        _ => Err(FormatError::Syntax {
            place: Place { line: None, ..root.place() },
            language: "a whole calibration",
            reason: format!("its last line, \"{COMPLETE}: true\", is missing"),
        }),
    }
}

/// The items of a list, which may be absent.
fn list<T>(
    parent: &Field<'_>,
    key: &str,
    item: impl Fn(&Field<'_>) -> Result<T, FormatError>,
) -> Result<Vec<T>, FormatError> {
    match parent.find(key)? {
        Some(field) => field.items()?.map(|one| item(&one)).collect(),
        None => Ok(Vec::new()),
    }
}

fn optional_number(parent: &Field<'_>, key: &str) -> Result<Option<f64>, FormatError> {
    parent.find(key)?.map(|field| field.number()).transpose()
}

fn model_kind(field: &Field<'_>) -> Result<ModelKind, FormatError> {
    let name = field.text()?;
    match name.as_str() {
        "fisheye" => Ok(ModelKind::Fisheye),
        "pinhole" => Ok(ModelKind::Pinhole),
        _ => Err(FormatError::UnsupportedModel {
            place: field.place(),
            found: name,
            supported: "fisheye and pinhole",
        }),
    }
}

fn cameras(field: &Field<'_>) -> Result<StereoCameras, FormatError> {
    let apart = field.get("right_from_left")?;
    let cameras = StereoCameras {
        left: camera(&field.get("left")?)?,
        right: camera(&field.get("right")?)?,
        right_from_left: pose(&apart)?,
    };
    implausible(&apart, plausible::BASELINE_M.check(cameras.baseline_m()))?;
    Ok(cameras)
}

fn implausible(field: &Field<'_>, checked: Result<(), Implausible>) -> Result<(), FormatError> {
    checked.map_err(|what| FormatError::Implausible { place: field.place(), what: Box::new(what) })
}

fn camera(field: &Field<'_>) -> Result<Camera, FormatError> {
    let (fx_px, fy_px) = (field.get("fx_px")?.positive()?, field.get("fy_px")?.positive()?);
    let (cx_px, cy_px) = (field.get("cx_px")?.number()?, field.get("cy_px")?.number()?);
    let model = match model_kind(&field.get("model")?)? {
        ModelKind::Fisheye => CameraModel::Fisheye(Fisheye {
            fx_px,
            fy_px,
            cx_px,
            cy_px,
            skew_px: field.get("skew_px")?.number()?,
            k: field.get("k1_k2_k3_k4")?.exactly()?,
        }),
        ModelKind::Pinhole => {
            let [k1, k2, p1, p2, k3] = field.get("k1_k2_p1_p2_k3")?.exactly()?;
            CameraModel::Pinhole(Pinhole { fx_px, fy_px, cx_px, cy_px, k1, k2, p1, p2, k3 })
        }
    };
    let camera = Camera {
        model,
        width_px: field.get("width_px")?.pixels()?,
        height_px: field.get("height_px")?.pixels()?,
    };
    implausible(field, camera.check_plausible())?;
    Ok(camera)
}

fn pose<To: Frame, From: Frame>(field: &Field<'_>) -> Result<Pose<To, From>, FormatError> {
    let rotation = field.get("rotation_wxyz")?;
    let [w, x, y, z] = rotation.exactly()?;
    let quaternion = Quaternion::new(w, x, y, z);
    if (quaternion.norm_squared() - 1.0).abs() > QUATERNION_TOLERANCE {
        return Err(rotation.out_of_range("a quaternion (w, x, y, z) of length 1"));
    }
    let translation: [f64; 3] = field.get("translation_m")?.exactly()?;
    // Unchecked: normalizing once more would change the last digits.
    Ok(Pose::new(Isometry3::from_parts(
        Translation3::from(translation),
        UnitQuaternion::new_unchecked(quaternion),
    )))
}

fn summary(field: &Field<'_>) -> Result<FitSummary, FormatError> {
    let number = |key: &str| field.get(key)?.number();
    Ok(FitSummary {
        rms_left_px: number("rms_left_px")?,
        rms_right_px: number("rms_right_px")?,
        rms_stereo_px: number("rms_stereo_px")?,
        cross_validated_px: optional_number(field, "cross_validated_px")?,
        epipolar_px: number("epipolar_px")?,
        square_mean_m: number("square_mean_m")?,
        square_sd_m: number("square_sd_m")?,
    })
}

fn covariance(field: &Field<'_>) -> Result<ParameterCovariance, FormatError> {
    let matrix = field.get("matrix")?;
    let rows: Vec<Vec<f64>> = matrix.items()?.map(|row| row.numbers()).collect::<Result<_, _>>()?;
    let size = rows.len();
    if let Some(row) = rows.iter().find(|row| row.len() != size) {
        return Err(
            matrix.wrong_size(format!("{size} numbers in each of {size} rows"), row.len().to_string())
        );
    }
    Ok(ParameterCovariance { matrix: DMatrix::from_row_iterator(size, size, rows.into_iter().flatten()) })
}

fn rejected_pair(field: &Field<'_>) -> Result<RejectedPair, FormatError> {
    Ok(RejectedPair { name: field.get("name")?.text()?, reason: field.get("reason")?.text()? })
}

fn evidence(field: &Field<'_>) -> Result<Evidence, FormatError> {
    let board_field = field.get("board")?;
    let whole = |key: &str| board_field.get(key)?.pixels();
    let board = Chessboard::new(
        whole("inner_columns")?,
        whole("inner_rows")?,
        board_field.get("square_m")?.of(plausible::SQUARE_M)?.positive()?,
    )
    .map_err(|error| board_field.out_of_range(format!("a usable board ({error})")))?;
    let options = field.get("options")?;
    Ok(Evidence {
        board,
        options: CalibrationOptions {
            model: model_kind(&options.get("model")?)?,
            leave_out_bad_corners: options.get("leave_out_bad_corners")?.flag()?,
            cross_validation_folds: options.get("cross_validation_folds")?.count()?,
        },
        observations: list(field, "observations", |pair| observation(pair, &board))?,
        dropped_pairs: list(field, "dropped_pairs", |name| name.text())?,
        created: field.get("created")?.timestamp()?,
        software: field.get("software")?.text()?,
        minutes_since_on: optional_number(field, "minutes_since_on")?,
        source: field.get("source")?.text()?,
    })
}

fn observation(field: &Field<'_>, board: &Chessboard) -> Result<PairObservation, FormatError> {
    let eye = |eye: Eye| field.find(&eye.to_string())?.map(|seen| corners(&seen, board)).transpose();
    Ok(PairObservation { name: field.get("name")?.text()?, left: eye(Eye::Left)?, right: eye(Eye::Right)? })
}

fn corners(field: &Field<'_>, board: &Chessboard) -> Result<Corners, FormatError> {
    let mut corners = Corners::with_capacity(board.corner_count());
    for row in field.items()? {
        for corner in row.items()? {
            corners.push(if corner.is_null() {
                None
            } else {
                let [u, v] = corner.exactly()?;
                Some(Pixel::new(u, v))
            });
        }
    }
    if corners.len() != board.corner_count() {
        return Err(field.wrong_size(
            format!("{} corners, as the board has", board.corner_count()),
            corners.len().to_string(),
        ));
    }
    Ok(corners)
}

fn pair_fit(field: &Field<'_>) -> Result<PairFit, FormatError> {
    Ok(PairFit {
        name: field.get("name")?.text()?,
        left_px: optional_number(field, "left_px")?,
        right_px: optional_number(field, "right_px")?,
        epipolar_px: optional_number(field, "epipolar_px")?,
        left_from_board: pose(&field.get("left_from_board")?)?,
        residuals: list(field, "residuals", residual)?,
    })
}

fn residual(field: &Field<'_>) -> Result<CornerResidual, FormatError> {
    let cells: Vec<Field<'_>> = field.items()?.collect();
    let (eye, corner, pixels, left_out) = match &cells[..] {
        [eye, corner, pixels @ ..] if pixels.len() == 4 => (eye, corner, pixels, None),
        [eye, corner, pixels @ .., mark] if pixels.len() == 4 => (eye, corner, pixels, Some(mark)),
        _ => {
            return Err(field.wrong_size(
                "6 entries (eye, corner, u, v, du, dv) or 7 (and left_out)",
                cells.len().to_string(),
            ));
        }
    };
    if let Some(mark) = left_out.filter(|mark| !mark.text().is_ok_and(|text| text == "left_out")) {
        return Err(mark.wrong_type("left_out"));
    }
    let eye_name = eye.text()?;
    let pixel = |i: usize| pixels[i].number();
    Ok(CornerResidual {
        eye: Eye::BOTH
            .into_iter()
            .find(|e| e.to_string() == eye_name)
            .ok_or_else(|| eye.wrong_type("left or right"))?,
        corner: corner.count()?,
        measured: Pixel::new(pixel(0)?, pixel(1)?),
        error_px: [pixel(2)?, pixel(3)?],
        left_out: left_out.is_some(),
    })
}
