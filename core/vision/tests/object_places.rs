//! Objects of real stereo pairs, boxed by hand, placed with the calibration of the same eyes.
#![allow(clippy::print_stderr)]

use std::path::Path;

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use plumbline_model::{
    CalibrationOptions, Chessboard, ClassIndex, ClassNames, Detection, PixelBox, StereoCalibration,
    Unattended, measured_data,
};
use plumbline_vision::detect_places::{Estimate, PlaceFinder, PlaceOptions, RangeFrom, Seen};
use plumbline_vision::{calibrate, chessboard};

/// Solves the chessboard pairs of the eyes.
fn calibration(folder: &Path) -> StereoCalibration {
    let board = Chessboard::new(8, 5, 0.03).expect("usable");
    let mut names: Vec<_> = std::fs::read_dir(folder.join("left"))
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name())
        .collect();
    names.sort();
    let gray = |eye: &str, name: &std::ffi::OsStr| {
        image::open(folder.join(eye).join(name)).expect("an image").to_luma8()
    };
    let observations: Vec<_> = names
        .iter()
        .map(|name| {
            let (left, right) = (gray("left", name), gray("right", name));
            chessboard::find_in_pair(&name.to_string_lossy(), &left, &right, &board).observation
        })
        .collect();
    let options = CalibrationOptions { cross_validation_folds: 0, ..Default::default() };
    let size = (640, 480);
    calibrate::solve(&board, &observations, [size, size], &options, &[], &Unattended).expect("it solves")
}

fn boxes(folder: &Path, stem: &str) -> Vec<Detection> {
    let text = std::fs::read_to_string(folder.join("labels").join(format!("{stem}.txt"))).expect("labels");
    text.lines()
        .map(|line| {
            let numbers: Vec<f32> = line.split_whitespace().map(|n| n.parse().expect("a number")).collect();
            let [class, x, y, w, h] = numbers[..] else { panic!("not a label: {line}") };
            let area = PixelBox::from_middle(x * 640.0, y * 480.0, w * 640.0, h * 480.0);
            Detection { class: ClassIndex(class as usize), confidence: 0.9, area }
        })
        .collect()
}

#[test]
fn labeled_objects_of_real_pairs_are_paired_and_lie_on_one_table() {
    let (scenes, boards) =
        match (measured_data::folder("nico-scenes"), measured_data::folder("nico-chessboard")) {
            (Ok(scenes), Ok(boards)) => (scenes, boards),
            (Err(missing), _) | (_, Err(missing)) => {
                eprintln!("{missing}");
                return;
            }
        };
    let calibration = calibration(&boards);
    let names = ClassNames::published();
    let mut finder = PlaceFinder::new(Some(&calibration), PlaceOptions::for_classes(&names));
    let (mut out, mut on_table, mut sigmas, mut of_scenes) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut common, mut paired, mut own) = (0, 0, 0);
    let mut off_line_px: Vec<f64> = Vec::new();
    for entry in std::fs::read_dir(scenes.join("images")).expect("a folder") {
        let name = entry.expect("an entry").file_name().to_string_lossy().into_owned();
        let Some(stamp) = name.strip_prefix("right_").and_then(|n| n.strip_suffix(".jpg")) else { continue };
        let stems = [format!("left_{stamp}"), format!("right_{stamp}")];
        let [left, right] = stems.each_ref().map(|stem| {
            let path = scenes.join("images").join(format!("{stem}.jpg"));
            (image::open(path).expect("an image").to_rgb8(), boxes(&scenes, stem))
        });
        common += left.1.iter().filter(|l| right.1.iter().any(|r| r.class == l.class)).count();
        finder.find((&left.0, &left.1), (&right.0, &right.1), &mut out);
        let mut standing = Vec::new();
        for object in &out {
            let Seen::Both { epipolar_px, eyes_disagree: None, .. } = object.seen else { continue };
            paired += 1;
            off_line_px.push(epipolar_px.abs());
            let place = object.place.as_ref().expect("a pair meets");
            own += usize::from(place.from == RangeFrom::OwnPixelsAndBoxes);
            let name = names.get(object.class).expect("published");
            if !name.ends_with("Hand") {
                on_table.push(place.middle.point.coords.coords);
                sigmas.push(place.middle.sigma_m());
                standing.push((middle_height_m(name), place.middle));
            }
        }
        of_scenes.push(standing);
    }
    let middle = on_table.iter().sum::<Vector3<f64>>() / on_table.len() as f64;
    let scatter: Matrix3<f64> = on_table.iter().map(|p| (p - middle) * (p - middle).transpose()).sum();
    let plane = plumbline_model::decompose::symmetric_eigen(scatter).expect("finite");
    let rms_m = (plane.eigenvalues.min().max(0.0) / on_table.len() as f64).sqrt();
    sigmas.sort_by(f64::total_cmp);
    off_line_px.sort_by(f64::total_cmp);
    eprintln!(
        "{paired} of {common} common objects paired, {own} by own pixels, epipolar distance median {:.2} px, \
         largest {:.2} px; {} toys within {:.1} mm rms of one plane, stated sigma median {:.1} mm",
        off_line_px[off_line_px.len() / 2],
        off_line_px[off_line_px.len() - 1],
        on_table.len(),
        1e3 * rms_m,
        1e3 * sigmas[sigmas.len() / 2]
    );
    assert_eq!(paired, common);
    assert!(own * 10 >= paired * 9, "only {own} of {paired} by their own pixels");
    // Middles are 10 to 30 mm above the table, so they cannot all lie in one plane.
    assert!(rms_m < 0.015, "places scatter by {rms_m} m about a plane");
    of_scenes.retain(|standing| standing.len() >= 3);
    let chi2 = chi2_of_heights(&of_scenes);
    eprintln!("heights over the table of {} scenes: chi2 {chi2:.2} per degree of freedom", of_scenes.len());
    assert!((0.4..1.8).contains(&chi2), "places are not as uncertain as stated: {chi2}");
}

/// Heights of the toys' middles over the table, as far as photographs tell, m; and how sure that is.
fn middle_height_m(name: &str) -> f64 {
    match name {
        "Tomato" => 0.027,
        "Mushroom" | "Onion" => 0.020,
        "Duck" => 0.019,
        "Orange" => 0.018,
        _ => 0.015,
    }
}
const HEIGHT_SIGMA_M: f64 = 0.003;

/// Squared differences of middles from their heights over the table, in units of what is stated, per degree
/// of freedom. The head stands a little differently in every scene: each has its own distance to the table,
/// whose tilt they share.
fn chi2_of_heights(scenes: &[Vec<(f64, Estimate)>]) -> f64 {
    let all: Vec<(usize, f64, Estimate)> =
        scenes.iter().enumerate().flat_map(|(k, of)| of.iter().map(move |(h, e)| (k, *h, *e))).collect();
    let unknowns = scenes.len() + 2;
    let (mut normal, mut chi2) = (Vector3::new(0.0, 0.9, 0.43), 0.0);
    for _ in 0..30 {
        let length = 1.0 / normal.y;
        let sigma = |estimate: &Estimate| {
            ((normal.transpose() * estimate.covariance_m2 * normal).x + HEIGHT_SIGMA_M.powi(2)).sqrt()
        };
        let mut design = DMatrix::zeros(all.len(), unknowns);
        let mut right = DVector::zeros(all.len());
        for (row, (scene, height_m, estimate)) in all.iter().enumerate() {
            let (at, weight) = (estimate.point.coords.coords, 1.0 / (length * sigma(estimate)));
            design[(row, *scene)] = weight;
            design[(row, unknowns - 2)] = weight * at.x;
            design[(row, unknowns - 1)] = weight * at.z;
            right[row] = weight * (at.y + length * height_m);
        }
        let square = design.transpose() * &design;
        let found = square.cholesky().expect("seen from above").solve(&(design.transpose() * &right));
        let slope = Vector3::new(-found[unknowns - 2], 1.0, -found[unknowns - 1]);
        normal = slope.normalize();
        chi2 = (right - design * found).norm_squared() / (all.len() - unknowns) as f64;
    }
    chi2
}
