//! Errors against the stated uncertainty.

use nalgebra::Point3;
use plumbline_model::{Detection, Eye, StereoCalibration};

use super::{ball, ball_box, detection, images, is_above_table, scene, shaken, small_eyes};
use crate::detect_places::{ObjectPlace, PlaceOptions, RangeFrom, Seen, places};
use crate::synthetic::Noise;

const RADII_M: [f64; 4] = [0.032, 0.022, 0.027, 0.04];

/// Balls all over the view, apart from each other in both eyes.
fn centers(noise: &mut Noise) -> Vec<(Point3<f64>, usize)> {
    let mut chosen: Vec<(Point3<f64>, usize)> = Vec::new();
    for _ in 0..200 {
        let range_m = noise.between(0.25, 0.75);
        let (x, y) = (noise.between(-0.6, 0.7), noise.between(-0.5, 0.5));
        let center = Point3::from(nalgebra::Vector3::new(x, y, 1.0).normalize() * range_m);
        let kind = chosen.len() % 4;
        // Far apart as angles, and so in both eyes.
        let apart = chosen.iter().all(|(other, k)| {
            let least_rad = 1.3 * (RADII_M[kind] + RADII_M[*k]) / range_m.min(other.coords.norm()) + 0.1;
            center.coords.angle(&other.coords) > least_rad
        });
        if apart && is_above_table(&center, RADII_M[kind]) && chosen.len() < 5 {
            chosen.push((center, kind));
        }
    }
    chosen
}

struct Judged {
    error_m: f64,
    nees: f64,
    from: RangeFrom,
    along_sigmas: f64,
}

fn judge(place: &ObjectPlace, truth: &[(Point3<f64>, usize)]) -> Option<Judged> {
    let Seen::Both { left, right, .. } = place.seen else { return None };
    assert_eq!(left, right, "a wrong pair");
    let found = place.place.as_ref().ok()?;
    let error = found.middle.point.coords - truth[left].0;
    let nees = (error.transpose() * found.middle.covariance_m2.try_inverse()? * error).x;
    let along = error.dot(&truth[left].0.coords.normalize());
    Some(Judged {
        error_m: error.norm(),
        nees,
        from: found.from,
        along_sigmas: along / found.middle.sigma_m(),
    })
}

#[test]
fn middles_of_balls_are_found_within_their_stated_uncertainty() {
    let cameras = small_eyes();
    let calibration = StereoCalibration::bare(cameras);
    let mut noise = Noise::new(5);
    let (mut judged, mut asked) = (Vec::new(), 0);
    for scene_seed in 0..12 {
        let truth = centers(&mut noise);
        asked += truth.len();
        let balls = truth.iter().map(|(center, kind)| ball(*center, RADII_M[*kind], *kind)).collect();
        let [left, right] = images(&scene(balls, 1.5, scene_seed), scene_seed);
        let boxes = Eye::BOTH.map(|eye| -> Vec<Detection> {
            truth
                .iter()
                .map(|(center, kind)| {
                    let area = ball_box(&cameras, eye, center, RADII_M[*kind]);
                    detection(*kind, shaken(&area, 1.0, &mut noise))
                })
                .collect()
        });
        let found = places(&calibration, (&left, &boxes[0]), (&right, &boxes[1]), &PlaceOptions::default());
        judged.extend(found.iter().filter_map(|place| judge(place, &truth)));
    }
    assert!(judged.len() * 100 >= asked * 97, "{} of {asked} were placed", judged.len());
    let n = judged.len();
    let matched = judged.iter().filter(|j| j.from == RangeFrom::OwnPixelsAndBoxes).count();
    let within = judged.iter().filter(|j| j.nees < 7.815).count();
    let nees = judged.iter().map(|j| j.nees).sum::<f64>() / n as f64;
    let bias = judged.iter().map(|j| j.along_sigmas).sum::<f64>() / n as f64;
    let mut errors: Vec<f64> = judged.iter().map(|j| j.error_m).collect();
    errors.sort_by(f64::total_cmp);
    eprintln!(
        "{n} of {asked} placed, {matched} by own pixels; median {:.1} mm, 95 % {:.1} mm; {within} within the 95 % region, mean NEES {nees:.2} (3), bias along the ray {bias:.2} sigma",
        1e3 * errors[n / 2],
        1e3 * errors[n * 95 / 100]
    );
    assert!(matched * 10 >= n * 8, "only {matched} of {n} by their own pixels");
    assert!(within * 100 >= n * 88, "only {within} of {n} within the stated 95 % region");
    assert!(nees > 1.0, "the stated uncertainty is far too large: mean NEES {nees}");
    assert!(errors[n / 2] < 0.012, "median error {} m", errors[n / 2]);
}
