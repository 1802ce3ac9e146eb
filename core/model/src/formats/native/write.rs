//! The text of a calibration file.

use std::fmt::Write;

use super::{COMPLETE, FORMAT, VERSION, self_test};
use crate::calibration::{
    Corners, Evidence, FitSummary, PairFit, PairObservation, ParameterCovariance, RejectedPair,
    StereoCalibration,
};
use crate::camera::{Camera, CameraModel, ModelKind};
use crate::chessboard::Chessboard;
use crate::formats::yaml::{number, numbers, quoted};
use crate::frame::{Frame, Pose};
use crate::pixel::Eye;
use crate::stereo::StereoCameras;

/// Lines of YAML at a depth of indentation.
struct Lines {
    text: String,
    depth: usize,
}

impl Lines {
    fn line(&mut self, content: impl AsRef<str>) {
        for _ in 0..self.depth {
            self.text.push_str("  ");
        }
        self.text.push_str(content.as_ref());
        self.text.push('\n');
    }

    fn value(&mut self, key: &str, value: impl AsRef<str>) {
        self.line(format!("{key}: {}", value.as_ref()));
    }

    fn number(&mut self, key: &str, value: f64) {
        self.value(key, number(value));
    }

    /// Absent numbers are left out.
    fn maybe(&mut self, key: &str, value: Option<f64>) {
        if let Some(value) = value {
            self.number(key, value);
        }
    }

    fn group(&mut self, head: &str, body: impl FnOnce(&mut Self)) {
        self.line(head);
        self.depth += 1;
        body(self);
        self.depth -= 1;
    }

    /// A list with one group per item, or `key: []`.
    fn list<T>(&mut self, key: &str, items: &[T], mut item: impl FnMut(&mut Self, &T)) {
        if items.is_empty() {
            return self.value(key, "[]");
        }
        self.group(&format!("{key}:"), |lines| items.iter().for_each(|one| item(lines, one)));
    }
}

/// Renders the whole file.
pub(super) fn render(calibration: &StereoCalibration) -> String {
    let mut lines = Lines { text: String::new(), depth: 0 };
    lines.line("# Stereo calibration. Lengths in meters, angles in radians, image positions in pixels");
    lines.line("# from the center of the top-left pixel. Rotations are unit quaternions w, x, y, z;");
    lines.line("# right_from_left takes points of the left camera to the right camera.");
    lines.value("format", FORMAT);
    lines.value("version", VERSION.to_string());
    cameras(&mut lines, &calibration.cameras);
    if let Some(fit) = &calibration.summary {
        summary(&mut lines, fit);
    }
    if let Some(covariance) = &calibration.covariance {
        parameter_covariance(&mut lines, covariance, &calibration.cameras);
    }
    lines.list("rejected", &calibration.rejected, rejected_pair);
    if let Some(made_from) = &calibration.evidence {
        evidence(&mut lines, made_from);
    }
    lines.list("pairs", &calibration.per_pair, pair_fit);
    lines.line("# What these cameras answered when this was written: x, y, z in the left camera, and where");
    lines.line("# the left and the right eye see it. Other answers mean that a number above was changed.");
    lines.list(self_test::KEY, &self_test::answers(calibration), |lines, answer| {
        lines.line(format!("- {}", numbers(answer)));
    });
    lines.value(self_test::SUMS, numbers(&self_test::sums(calibration)));
    lines.line("# The last line: a file without it was cut off.");
    lines.value(COMPLETE, "true");
    lines.text
}

fn kind_name(kind: ModelKind) -> &'static str {
    match kind {
        ModelKind::Fisheye => "fisheye",
        ModelKind::Pinhole => "pinhole",
    }
}

fn cameras(lines: &mut Lines, cameras: &StereoCameras) {
    lines.group("cameras:", |lines| {
        for eye in Eye::BOTH {
            lines.group(&format!("{eye}:"), |lines| camera(lines, cameras.camera(eye)));
        }
        let (angle, baseline) =
            (cameras.right_from_left.isometry.rotation.angle().to_degrees(), cameras.baseline_m() * 1000.0);
        lines.group(
            &format!("right_from_left: # {baseline:.3} mm apart, turned by {angle:.3} degrees"),
            |lines| {
                pose(lines, &cameras.right_from_left);
            },
        );
    });
}

fn camera(lines: &mut Lines, camera: &Camera) {
    lines.value("model", kind_name(camera.model.kind()));
    lines.value("width_px", camera.width_px.to_string());
    lines.value("height_px", camera.height_px.to_string());
    let (fx, fy) = camera.model.focal_px();
    let center = camera.model.principal_point();
    lines.number("fx_px", fx);
    lines.number("fy_px", fy);
    lines.number("cx_px", center.u_px);
    lines.number("cy_px", center.v_px);
    match camera.model {
        CameraModel::Fisheye(lens) => {
            lines.number("skew_px", lens.skew_px);
            lines.value("k1_k2_k3_k4", numbers(&lens.k));
        }
        CameraModel::Pinhole(lens) => {
            lines.value("k1_k2_p1_p2_k3", numbers(&[lens.k1, lens.k2, lens.p1, lens.p2, lens.k3]));
        }
    }
}

fn pose<To: Frame, From: Frame>(lines: &mut Lines, pose: &Pose<To, From>) {
    let q = pose.isometry.rotation.quaternion();
    lines.value("rotation_wxyz", numbers(&[q.w, q.i, q.j, q.k]));
    lines.value("translation_m", numbers(pose.translation_m().iter()));
}

fn summary(lines: &mut Lines, fit: &FitSummary) {
    lines.group("summary:", |lines| {
        lines.number("rms_left_px", fit.rms_left_px);
        lines.number("rms_right_px", fit.rms_right_px);
        lines.number("rms_stereo_px", fit.rms_stereo_px);
        lines.maybe("cross_validated_px", fit.cross_validated_px);
        lines.number("epipolar_px", fit.epipolar_px);
        lines.number("square_mean_m", fit.square_mean_m);
        lines.number("square_sd_m", fit.square_sd_m);
    });
}

fn parameter_covariance(lines: &mut Lines, covariance: &ParameterCovariance, cameras: &StereoCameras) {
    let mut names: Vec<String> = Vec::new();
    for eye in Eye::BOTH {
        let kind = cameras.camera(eye).model.kind();
        names.extend(kind.parameter_names().iter().map(|name| format!("{eye}_{name}")));
    }
    names.extend(["rx", "ry", "rz", "tx", "ty", "tz"].map(str::to_owned));
    lines.group("covariance:", |lines| {
        lines.line(format!("# of {}", names.join(", ")));
        lines.group("matrix:", |lines| {
            for row in covariance.matrix.row_iter() {
                lines.line(format!("- {}", numbers(row.iter())));
            }
        });
    });
}

fn rejected_pair(lines: &mut Lines, pair: &RejectedPair) {
    lines.line(format!("- {{name: {}, reason: {}}}", quoted(&pair.name), quoted(&pair.reason)));
}

fn evidence(lines: &mut Lines, evidence: &Evidence) {
    let Chessboard { inner_columns, inner_rows, square_m } = evidence.board;
    let options = &evidence.options;
    let dropped: Vec<String> = evidence.dropped_pairs.iter().map(|name| quoted(name)).collect();
    lines.group("evidence:", |lines| {
        lines.value("created", quoted(&evidence.created.to_string()));
        lines.value("software", quoted(&evidence.software));
        lines.value("source", quoted(&evidence.source));
        lines.maybe("minutes_since_on", evidence.minutes_since_on);
        lines.group("board:", |lines| {
            lines.value("inner_columns", inner_columns.to_string());
            lines.value("inner_rows", inner_rows.to_string());
            lines.number("square_m", square_m);
        });
        lines.group("options:", |lines| {
            lines.value("model", kind_name(options.model));
            lines.value("leave_out_bad_corners", options.leave_out_bad_corners.to_string());
            lines.value("cross_validation_folds", options.cross_validation_folds.to_string());
        });
        lines.value("dropped_pairs", format!("[{}]", dropped.join(", ")));
        lines.line("# One line per row of the board, [u, v] per corner, ~ where it was not measured.");
        lines.list("observations", &evidence.observations, |lines, pair| {
            observation(lines, pair, inner_columns as usize);
        });
    });
}

fn observation(lines: &mut Lines, pair: &PairObservation, columns: usize) {
    lines.group(&format!("- name: {}", quoted(&pair.name)), |lines| {
        for eye in Eye::BOTH {
            if let Some(corners) = pair.corners(eye) {
                corner_rows(lines, eye, corners, columns);
            }
        }
    });
}

fn corner_rows(lines: &mut Lines, eye: Eye, corners: &Corners, columns: usize) {
    let rows: Vec<_> = corners.chunks(columns.max(1)).collect();
    lines.list(&eye.to_string(), &rows, |lines, row| {
        let cells: Vec<String> = row
            .iter()
            .map(|corner| match corner {
                Some(pixel) => numbers(&[pixel.u_px, pixel.v_px]),
                None => "~".to_owned(),
            })
            .collect();
        lines.line(format!("- [{}]", cells.join(", ")));
    });
}

fn pair_fit(lines: &mut Lines, pair: &PairFit) {
    lines.group(&format!("- name: {}", quoted(&pair.name)), |lines| {
        lines.maybe("left_px", pair.left_px);
        lines.maybe("right_px", pair.right_px);
        lines.maybe("epipolar_px", pair.epipolar_px);
        lines.group("left_from_board:", |lines| pose(lines, &pair.left_from_board));
        lines.line("# eye, corner, measured u and v, measured minus predicted u and v [, left_out]");
        lines.list("residuals", &pair.residuals, |lines, residual| {
            let mut text = String::new();
            // Writing to a String cannot fail.
            let _ = write!(
                text,
                "- [{}, {}, {}, {}, {}, {}",
                residual.eye,
                residual.corner,
                number(residual.measured.u_px),
                number(residual.measured.v_px),
                number(residual.error_px[0]),
                number(residual.error_px[1]),
            );
            text.push_str(if residual.left_out { ", left_out]" } else { "]" });
            lines.line(text);
        });
    });
}
