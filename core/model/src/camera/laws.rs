//! Laws that every camera model obeys.

use nalgebra::Vector3;

use super::{CameraModel, Fisheye, ModelKind, Pinhole, ProjectError};
use crate::pixel::Pixel;

fn members() -> Vec<CameraModel> {
    vec![
        CameraModel::Fisheye(Fisheye {
            fx_px: 150.7,
            fy_px: 150.6,
            cx_px: 321.3,
            cy_px: 238.1,
            skew_px: 0.0,
            k: [-0.0084, -0.008, 0.0017, -0.00026],
        }),
        CameraModel::Fisheye(Fisheye {
            fx_px: 300.0,
            fy_px: 310.0,
            cx_px: 640.0,
            cy_px: 400.0,
            skew_px: -0.07,
            k: [0.0; 4],
        }),
        CameraModel::Pinhole(Pinhole::ideal(500.0, 320.0, 240.0)),
        CameraModel::Pinhole(Pinhole {
            fx_px: 524.6,
            fy_px: 526.9,
            cx_px: 312.4,
            cy_px: 247.4,
            k1: -0.36,
            k2: 0.175,
            p1: 0.001,
            p2: -0.0005,
            k3: 0.0,
        }),
    ]
}

/// Directions up to the edge of what both kinds can see, the axis itself included.
fn directions(kind: ModelKind) -> Vec<Vector3<f64>> {
    let thetas: &[f64] = match kind {
        ModelKind::Fisheye => &[0.0, 1e-12, 1e-6, 0.1, 0.5, 1.0, 1.5, 1.65],
        ModelKind::Pinhole => &[0.0, 1e-12, 1e-6, 0.1, 0.3, 0.5],
    };
    let mut all = Vec::new();
    for theta in thetas {
        for i in 0..8 {
            let phi = f64::from(i) * 0.8;
            all.push(Vector3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()));
        }
    }
    all
}

#[test]
fn unproject_undoes_project() {
    for model in members() {
        for direction in directions(model.kind()) {
            let pixel = model.project(&(direction * 0.7)).expect("visible");
            let back = model.unproject(pixel).expect("on the image");
            assert!((back - direction).norm() < 1e-11, "{model:?}: {direction} came back as {back}");
        }
    }
}

#[test]
fn jacobians_agree_with_differences() {
    for model in members() {
        for direction in directions(model.kind()) {
            // Differences cannot resolve the limit next to the axis; the axis itself they can.
            let off_axis = direction.x.hypot(direction.y);
            if off_axis > 0.0 && off_axis < 1e-3 {
                continue;
            }
            let point = direction * 0.7;
            let jacobian = model.project_with_jacobian(&point).expect("visible");
            let pixel = |p: &Vector3<f64>| model.project(p).expect("visible").vector();
            assert!((jacobian.pixel_px - pixel(&point)).norm() < 1e-9);
            let h = 1e-6;
            for axis in 0..3 {
                let mut step = Vector3::zeros();
                step[axis] = h;
                let numeric = (pixel(&(point + step)) - pixel(&(point - step))) / (2.0 * h);
                let analytic = jacobian.by_point.column(axis);
                assert!(
                    (numeric - analytic).norm() < 1e-3,
                    "{model:?} at {point}, axis {axis}: {numeric} {analytic}"
                );
            }
            if matches!(model, CameraModel::Fisheye(m) if m.skew_px != 0.0) {
                continue; // from_parameters drops the skew by design
            }
            for i in 0..model.kind().parameter_count() {
                let shifted = |delta: f64| {
                    let mut p = model.parameters();
                    p[i] += delta;
                    CameraModel::from_parameters(model.kind(), &p).project(&point).expect("visible").vector()
                };
                let numeric = (shifted(h) - shifted(-h)) / (2.0 * h);
                let analytic = jacobian.by_parameter.column(i);
                assert!(
                    (numeric - analytic).norm() < 1e-4 * (1.0 + numeric.norm()),
                    "{model:?} parameter {i}"
                );
            }
        }
    }
}

#[test]
fn parameters_round_trip() {
    for model in members() {
        if !matches!(model, CameraModel::Fisheye(m) if m.skew_px != 0.0) {
            assert_eq!(CameraModel::from_parameters(model.kind(), &model.parameters()), model);
        }
    }
}

#[test]
fn a_pinhole_refuses_what_is_behind_it() {
    let model = CameraModel::Pinhole(Pinhole::ideal(500.0, 320.0, 240.0));
    assert!(matches!(model.project(&Vector3::new(0.1, 0.0, -1.0)), Err(ProjectError::Behind { .. })));
}

#[test]
fn a_folding_lens_refuses_beyond_the_fold() {
    let model = CameraModel::Fisheye(Fisheye {
        fx_px: 150.0,
        fy_px: 150.0,
        cx_px: 320.0,
        cy_px: 240.0,
        skew_px: 0.0,
        k: [-0.3, 0.0, 0.0, 0.0],
    });
    let far = Vector3::new(1.4f64.sin(), 0.0, 1.4f64.cos());
    assert!(matches!(model.project(&far), Err(ProjectError::BeyondLens { .. })));
    assert!(matches!(model.unproject(Pixel::new(900.0, 240.0)), Err(ProjectError::NoDirection { .. })));
}

#[test]
fn no_direction_is_an_error_not_a_pixel() {
    for model in members() {
        assert_eq!(model.project(&Vector3::zeros()), Err(ProjectError::Undefined));
        assert_eq!(model.project(&Vector3::new(f64::NAN, 0.0, 1.0)), Err(ProjectError::Undefined));
        assert!(model.unproject(Pixel::new(f64::NAN, 3.0)).is_err());
    }
}
