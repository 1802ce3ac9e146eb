//! Corners of a board with what the model missed.

use plumbline_model::{CornerResidual, Eye};

use crate::overlay::{Mark, Overlay, PointShape};
use crate::theme::Role;

/// The corners that one eye measured, each with an arrow from the predicted towards the
/// measured position, `scale` times its length. Corners left out of the fit are crossed.
pub fn residual_arrows(residuals: &[CornerResidual], eye: Eye, scale: f64) -> Overlay {
    let mut overlay = Overlay::new();
    for residual in residuals.iter().filter(|residual| residual.eye == eye) {
        let measured = [residual.measured.u_px, residual.measured.v_px];
        let predicted = [0, 1].map(|i| measured[i] - residual.error_px[i]);
        if residual.left_out {
            overlay.cross(measured, Role::NoiseFloor);
            overlay.push(Mark::Arrow {
                from_px: predicted,
                vector_px: residual.error_px,
                scale,
                ink: Role::NoiseFloor.into(),
            });
        } else {
            overlay.point(measured, PointShape::Dot, 2.0, Role::Measured);
            overlay.arrow(predicted, residual.error_px, scale, Role::Difference);
        }
    }
    overlay
}

/// A round magnification that makes the typical residual about `wanted_px` image pixels long:
/// 1, 2, 5, 10, …; 1 without residuals.
pub fn arrow_scale(residuals: &[CornerResidual], wanted_px: f64) -> f64 {
    let mut norms: Vec<f64> = residuals
        .iter()
        .filter(|r| !r.left_out)
        .map(CornerResidual::norm_px)
        .filter(|n| n.is_finite())
        .collect();
    norms.sort_by(f64::total_cmp);
    match norms.get(norms.len() / 2) {
        Some(median) if *median > 0.0 => {
            let wanted = (wanted_px / median).max(1.0);
            let power = 10f64.powf(wanted.log10().floor());
            let steps = [5.0, 2.0, 1.0].map(|factor| factor * power);
            steps.into_iter().find(|step| *step <= wanted * (1.0 + 1e-9)).unwrap_or(1.0)
        }
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plumbline_model::Pixel;

    fn residual(eye: Eye, error_px: [f64; 2], left_out: bool) -> CornerResidual {
        CornerResidual { eye, corner: 0, measured: Pixel::new(100.0, 50.0), error_px, left_out }
    }

    #[test]
    fn arrows_run_from_predicted_to_measured_at_scale_one() {
        let overlay = residual_arrows(&[residual(Eye::Left, [3.0, -4.0], false)], Eye::Left, 1.0);
        let arrow = overlay.marks.iter().find_map(|mark| match mark {
            Mark::Arrow { from_px, vector_px, scale, .. } => Some((*from_px, *vector_px, *scale)),
            _ => None,
        });
        assert_eq!(overlay.arrow_scale(), Some(1.0));
        let (from, vector, scale) = arrow.expect("one arrow");
        assert_eq!([from[0] + scale * vector[0], from[1] + scale * vector[1]], [100.0, 50.0]);
    }

    #[test]
    fn only_the_eye_asked_for_and_left_out_ones_crossed() {
        let residuals = [
            residual(Eye::Left, [0.1, 0.0], false),
            residual(Eye::Right, [0.1, 0.0], false),
            residual(Eye::Right, [9.0, 0.0], true),
        ];
        let shapes = |eye| {
            let marks = residual_arrows(&residuals, eye, 10.0).marks;
            let shape = |mark: &Mark| match mark {
                Mark::Point { shape, .. } => Some(*shape),
                _ => None,
            };
            marks.iter().filter_map(shape).collect::<Vec<_>>()
        };
        assert_eq!(shapes(Eye::Left), [PointShape::Dot]);
        assert_eq!(shapes(Eye::Right), [PointShape::Dot, PointShape::Cross]);
    }

    #[test]
    fn scales_are_round_and_ignore_outliers() {
        let mut residuals = vec![residual(Eye::Left, [0.07, 0.0], false); 9];
        residuals.push(residual(Eye::Left, [80.0, 0.0], true));
        assert_eq!(arrow_scale(&residuals, 10.0), 100.0);
        assert_eq!(arrow_scale(&residuals, 20.0), 200.0);
        assert_eq!(arrow_scale(&[], 10.0), 1.0);
        assert_eq!(arrow_scale(&[residual(Eye::Left, [50.0, 0.0], false)], 10.0), 1.0);
    }
}
