//! Calibration files: what is written comes back, and what cannot be used says why.

mod common;

use std::fs;
use std::path::{Path, PathBuf};

use common::{calibration, fisheye_eyes, pinhole_eyes, skewed_eyes};
use plumbline_model::camera::CameraModel;
use plumbline_model::formats::{
    FormatError, LengthUnit, ReadOptions, kalibr, mrcal, native, read_any, read_with, ros,
};
use plumbline_model::{StereoCalibration, StereoCameras};

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder for the test")
}

fn read_text(file: &Path) -> String {
    fs::read_to_string(file).expect("readable")
}

/// Lenses bit for bit; the pose to the last digit or, through a rotation matrix, to 1e-15.
fn assert_same(found: &StereoCameras, expected: &StereoCameras) {
    assert_eq!((found.left, found.right), (expected.left, expected.right));
    let turned = (found.right_from_left.rotation() - expected.right_from_left.rotation()).amax();
    let moved = (found.right_from_left.translation_m() - expected.right_from_left.translation_m()).amax();
    assert!(turned <= 1e-15 && moved <= 1e-15, "rotation off by {turned}, translation by {moved}");
}

#[test]
fn a_native_file_comes_back_bit_for_bit() {
    let folder = folder();
    let file = folder.path().join("rig-cameras.yaml");
    for expected in [calibration(), StereoCalibration::bare(pinhole_eyes(0.01))] {
        native::write(&expected, &file).expect("written");
        let found = native::read(&file).expect("read");
        assert_eq!(found, expected);
        assert_eq!(read_any(std::slice::from_ref(&file)).expect("recognized"), expected);
        let (a, b) = (found.cameras.right_from_left.isometry, expected.cameras.right_from_left.isometry);
        assert_eq!(a.rotation.coords.map(f64::to_bits), b.rotation.coords.map(f64::to_bits));
    }
    assert_eq!(fs::read_dir(folder.path()).expect("readable").count(), 1, "only the file itself remains");
}

#[test]
fn thirty_pairs_of_forty_corners_stay_below_half_a_megabyte() {
    let folder = folder();
    let file = folder.path().join("rig-cameras.yaml");
    let mut many = calibration();
    let evidence = many.evidence.as_mut().expect("present");
    evidence.board = plumbline_model::Chessboard::new(8, 5, 0.03).expect("usable");
    let pixel = |i: usize, j: usize| {
        // As a single-precision corner detector gives them.
        Some(plumbline_model::Pixel::new(f64::from(i as f32 * 7.3 + 11.1), f64::from(j as f32 / 3.0)))
    };
    evidence.observations = (0..30)
        .map(|i| plumbline_model::PairObservation {
            name: format!("{i:02}.png"),
            left: Some((0..40).map(|j| pixel(i, j)).collect()),
            right: Some((0..40).map(|j| pixel(j, i)).collect()),
        })
        .collect();
    let mut fit = many.per_pair[0].clone();
    let residual = fit.residuals[0];
    fit.residuals = (0..80).map(|corner| plumbline_model::CornerResidual { corner, ..residual }).collect();
    many.per_pair = vec![fit; 30];
    native::write(&many, &file).expect("written");
    let bytes = fs::metadata(&file).expect("there").len();
    assert!(bytes < 500_000, "{bytes} bytes");
    assert_eq!(native::read(&file).expect("read"), many);
}

#[test]
fn a_calibration_with_nan_is_not_written_over_a_good_one() {
    let folder = folder();
    let file = folder.path().join("rig-cameras.yaml");
    native::write(&calibration(), &file).expect("written");
    let before = read_text(&file);
    let mut broken = calibration();
    broken.per_pair[0].residuals[1].error_px[0] = f64::NAN;
    let error = native::write(&broken, &file).expect_err("NaN");
    assert!(matches!(error, FormatError::NotFinite { .. }), "{error}");
    assert!(error.to_string().contains("pairs[0].residuals[1][4]"), "{error}");
    assert_eq!(read_text(&file), before);
    assert_eq!(fs::read_dir(folder.path()).expect("readable").count(), 1, "nothing temporary remains");

    let nowhere = folder.path().join("absent/rig-cameras.yaml");
    let error = native::write(&calibration(), &nowhere).expect_err("no such folder").to_string();
    assert!(error.contains("cannot be written") && error.contains("choose a folder"), "{error}");
}

#[test]
fn ros_files_come_back() {
    let folder = folder();
    let files = ["left.yaml", "right.yaml"].map(|name| folder.path().join(name));
    for eyes in [fisheye_eyes(), skewed_eyes(), pinhole_eyes(0.01)] {
        ros::write(&eyes, &files[0], &files[1]).expect("written");
        assert_same(&read_any(&files).expect("read").cameras, &eyes);
        let whole_folder = [folder.path().to_path_buf()];
        assert_same(&read_any(&whole_folder).expect("read from the folder").cameras, &eyes);
    }
}

#[test]
fn ros_files_have_the_keys_that_ros_expects_in_its_order() {
    let folder = folder();
    let files = ["left.yaml", "right.yaml"].map(|name| folder.path().join(name));
    let eyes = fisheye_eyes();
    ros::write(&eyes, &files[0], &files[1]).expect("written");
    let right = read_text(&files[1]);
    let keys: Vec<&str> = right
        .lines()
        .filter(|line| !line.starts_with(' '))
        .filter_map(|line| line.split(':').next())
        .collect();
    let expected = [
        "image_width",
        "image_height",
        "camera_name",
        "camera_matrix",
        "distortion_model",
        "distortion_coefficients",
        "rectification_matrix",
        "projection_matrix",
    ];
    assert_eq!(keys, expected);
    assert!(right.contains("distortion_model: equidistant"));
    // The baseline hides in P[0][3] = -f·B, in meters.
    let projection =
        right.split("projection_matrix").nth(1).expect("P").split(['[', ']']).nth(1).expect("data");
    let p: Vec<f64> = projection.split(',').map(|x| x.trim().parse().expect("a number")).collect();
    assert!((p[3] + p[0] * eyes.baseline_m()).abs() < 1e-12, "{p:?}");
}

/// Five digits, as ROS's own calibrator prints them, are no reason to refuse a file.
#[test]
fn rounded_ros_files_are_accepted() {
    let folder = folder();
    let files = ["left.yaml", "right.yaml"].map(|name| folder.path().join(name));
    let eyes = fisheye_eyes();
    ros::write(&eyes, &files[0], &files[1]).expect("written");
    for file in &files {
        let rounded: Vec<String> = read_text(file)
            .lines()
            .map(|line| match line.split_once("data: [") {
                Some((head, data)) => {
                    let numbers: Vec<String> = data
                        .trim_end_matches(']')
                        .split(',')
                        .map(|x| format!("{:.5}", x.trim().parse::<f64>().expect("a number")))
                        .collect();
                    format!("{head}data: [{}]", numbers.join(", "))
                }
                None => line.to_owned(),
            })
            .collect();
        fs::write(file, rounded.join("\n")).expect("written");
    }
    let found = read_any(&files).expect("read").cameras;
    let r = found.right_from_left.rotation();
    assert!((r.transpose() * r - nalgebra::Matrix3::identity()).amax() < 1e-14, "a proper rotation");
    assert!((r - eyes.right_from_left.rotation()).amax() < 3e-5);
    assert!((found.baseline_m() - eyes.baseline_m()).abs() < 1e-6);
}

#[test]
fn camchains_come_back() {
    let folder = folder();
    let file = folder.path().join("camchain.yaml");
    for eyes in [fisheye_eyes(), pinhole_eyes(0.0)] {
        kalibr::write(&eyes, &file).expect("written");
        assert_same(&read_any(std::slice::from_ref(&file)).expect("read").cameras, &eyes);
    }
    let text = read_text(&file);
    assert!(
        text.contains("distortion_model: radtan")
            && text.contains("intrinsics: [524.6, 526.9, 312.4, 247.4]")
    );
}

#[test]
fn what_kalibr_cannot_hold_is_refused_not_dropped() {
    let folder = folder();
    let file = folder.path().join("camchain.yaml");
    for (eyes, what) in [(skewed_eyes(), "skew"), (pinhole_eyes(0.01), "k3")] {
        let error = kalibr::write(&eyes, &file).expect_err(what).to_string();
        assert!(error.contains(what) && error.contains("ROS camera_info"), "{error}");
        assert!(!file.exists());
    }
}

/// A camchain with block lists and an alias, as Python's YAML writer makes them.
#[test]
fn a_camchain_in_another_style_is_read() {
    let text = "cam0:\n  cam_overlaps: [1]\n  camera_model: pinhole\n  distortion_coeffs: &d\n  - -0.01\n  - 2.0e-3\n  - 0\n  - 0.0\n  distortion_model: equidistant\n  intrinsics: &k [150.5, 151.25, 320, 240]\n  resolution: [640, 480]\n  rostopic: /left/image_raw\ncam1:\n  T_cn_cnm1:\n  - [1.0, 0.0, 0.0, -0.07]\n  - [0.0, 1.0, 0.0, 0.0]\n  - [0.0, 0.0, 1.0, 0.0]\n  - [0.0, 0.0, 0.0, 1.0]\n  camera_model: pinhole\n  distortion_coeffs: *d\n  distortion_model: equidistant\n  intrinsics: *k\n  resolution: [640, 480]\n  timeshift_cam_imu: 0.0\n";
    let folder = folder();
    let file = folder.path().join("camchain.yaml");
    fs::write(&file, text).expect("written");
    let eyes = read_any(&[file]).expect("read").cameras;
    let CameraModel::Fisheye(lens) = eyes.right.model else { panic!("equidistant is a fisheye") };
    assert_eq!((lens.fx_px, lens.fy_px, lens.cx_px, lens.k), (150.5, 151.25, 320.0, [-0.01, 2e-3, 0.0, 0.0]));
    assert_eq!(eyes.right_from_left.translation_m().as_slice(), [-0.07, 0.0, 0.0]);
}

#[test]
fn another_unit_of_length_is_noticed_and_can_be_given() {
    let folder = folder();
    let file = [folder.path().join("camchain.yaml")];
    let mut eyes = fisheye_eyes();
    eyes.right_from_left.isometry.translation.vector *= 1000.0;
    kalibr::write(&eyes, &file[0]).expect("written");
    let error = read_any(&file).expect_err("70 m apart");
    assert!(matches!(error, FormatError::ImplausibleBaseline { .. }), "{error}");
    for word in ["camchain.yaml", "T_cn_cnm1", "millimeters", "unit"] {
        assert!(error.to_string().contains(word), "{error}");
    }
    let options = ReadOptions { length_unit: Some(LengthUnit::Millimeters), ..ReadOptions::default() };
    let found = read_with(&file, &options).expect("with its unit").cameras;
    assert!((found.baseline_m() - fisheye_eyes().baseline_m()).abs() < 1e-15);
    // Whoever says meters is believed.
    let options = ReadOptions { length_unit: Some(LengthUnit::Meters), ..ReadOptions::default() };
    assert!(read_with(&file, &options).expect("as stated").cameras.baseline_m() > 69.0);
}

#[test]
fn mrcal_gets_every_kept_corner_once() {
    let folder = folder();
    let file = folder.path().join("corners.vnl");
    let mut evidence = calibration().evidence.expect("present");
    evidence.observations[1].name = "02.png".to_owned();
    mrcal::write_corners(&evidence, &file).expect("written");
    let text = read_text(&file);
    let mut lines = text.lines().skip_while(|line| line.starts_with("##"));
    assert_eq!(lines.next(), Some("# filename x y weight"));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(' ').collect()).collect();
    assert!(rows.iter().all(|row| row.len() == 4));
    let of = |name: &str| rows.iter().filter(|row| row[0] == name).collect::<Vec<_>>();
    assert_eq!(of("left/01.png").len(), 12);
    assert_eq!(of("left/01.png")[1][1].parse::<f64>().expect("a number"), 100.0 + 1.0 / 3.0);
    assert_eq!(of("left/01.png")[5][1..], ["-", "-", "-"], "the corner that was not measured");
    assert_eq!(of("left/02.png"), [&["left/02.png", "-", "-", "-"]], "an eye that saw nothing");
    assert!(of("left/03.png").is_empty(), "a dropped pair");

    evidence.observations[0].name = "pair 1.png".to_owned();
    let error = mrcal::write_corners(&evidence, &file).expect_err("a space").to_string();
    assert!(error.contains("pair 1.png") && error.contains("rename"), "{error}");
}

/// Writes all formats, applies a change to the text of one, and reads.
fn read_changed(name: &str, change: &dyn Fn(&str) -> String) -> Result<StereoCalibration, FormatError> {
    let folder = folder();
    let file = |name: &str| folder.path().join(name);
    native::write(&calibration(), &file("rig-cameras.yaml")).expect("written");
    kalibr::write(&fisheye_eyes(), &file("camchain.yaml")).expect("written");
    ros::write(&fisheye_eyes(), &file("left.yaml"), &file("right.yaml")).expect("written");
    let text = read_text(&file(name));
    let changed = change(&text);
    assert_ne!(text, changed, "the test changes something");
    fs::write(file(name), changed).expect("written");
    match name {
        "left.yaml" | "right.yaml" => read_any(&[file("left.yaml"), file("right.yaml")]),
        _ => read_any(&[file(name)]),
    }
}

/// The change must make the file unusable, and the message must name these words and the file.
fn refused(name: &str, change: impl Fn(&str) -> String, words: &[&str]) {
    let error = read_changed(name, &change).expect_err("unusable").to_string();
    for word in words.iter().chain(&[name]) {
        assert!(error.contains(word), "\"{word}\" is not in: {error}");
    }
}

fn without(key: &'static str) -> impl Fn(&str) -> String {
    move |text| text.lines().filter(|line| !line.trim().starts_with(key)).collect::<Vec<_>>().join("\n")
}

fn instead(from: &'static str, to: &'static str) -> impl Fn(&str) -> String {
    move |text| text.replacen(from, to, 1)
}

#[test]
fn damaged_native_files_say_what_and_where() {
    let name = "rig-cameras.yaml";
    refused(name, without("fx_px"), &["cameras.left.fx_px", "missing"]);
    refused(
        name,
        instead("fx_px: 150.12345678901235", "fx_px: .nan"),
        &["cameras.left.fx_px", "line 11", "number"],
    );
    refused(
        name,
        instead("fx_px: 150.12345678901235", "fx_px: -150"),
        &["cameras.left.fx_px", "greater than zero"],
    );
    refused(name, instead("fx_px: 150.12345678901235", "fx_px: wide"), &["cameras.left.fx_px", "\"wide\""]);
    refused(name, instead("model: fisheye", "model: omni"), &["\"omni\"", "fisheye and pinhole"]);
    refused(name, instead("width_px: 640", "width_px: 640.5"), &["width_px", "whole number"]);
    refused(
        name,
        instead("rotation_wxyz: [0.9", "rotation_wxyz: [0.1"),
        &["right_from_left.rotation_wxyz", "length 1"],
    );
    refused(name, instead("version: 1", "version: 2"), &["version", "newer program"]);
    refused(name, instead("~, ", ""), &["observations[0].left", "12 corners", "11"]);
    refused(name, instead("- [right, 11, ", "- [middle, 11, "), &["residuals[1][0]", "left or right"]);
    refused(name, |text| text[..text.len() / 10].to_owned(), &[]);
    refused(
        name,
        |text| text[..text.find("distortion").unwrap_or(text.len()) - 1].replace("format: ", "format: \""),
        &["YAML", "line"],
    );
}

#[test]
fn every_truncation_of_a_native_file_is_noticed() {
    let folder = folder();
    let file = folder.path().join("rig-cameras.yaml");
    native::write(&calibration(), &file).expect("written");
    let text = read_text(&file);
    let whole = text.trim_end().len();
    let ends = (1..whole).step_by(97).chain(whole - 40..whole).filter(|&end| text.is_char_boundary(end));
    for end in ends {
        fs::write(&file, &text[..end]).expect("written");
        assert!(native::read(&file).is_err(), "cut at {end} of {whole}");
    }
}

#[test]
fn damaged_ros_files_say_what_and_where() {
    refused(
        "right.yaml",
        |text| text[..text.find("projection_matrix").expect("there")].to_owned(),
        &["projection_matrix", "missing"],
    );
    refused("left.yaml", without("image_width"), &["image_width", "missing"]);
    refused(
        "left.yaml",
        instead("distortion_model: equidistant", "distortion_model: rational_polynomial"),
        &["rational_polynomial", "equidistant", "plumb_bob", "line 8"],
    );
    refused(
        "left.yaml",
        instead("data: [150.12345678901235", "data: [nan"),
        &["camera_matrix.data[0]", "nan"],
    );
    refused(
        "left.yaml",
        instead("data: [150.12345678901235, ", "data: ["),
        &["camera_matrix.data", "3×3", "8"],
    );
    refused("left.yaml", instead("rows: 3", "rows: 4"), &["camera_matrix.rows", "3"]);
    refused(
        "right.yaml",
        instead("-0.00026", "-0.00026, 1.0"),
        &["distortion_coefficients", "4 coefficients", "5"],
    );
    refused(
        "right.yaml",
        instead("camera_name: right", "camera_name: nico_left"),
        &["nico_left", "left eye's file first"],
    );
    refused(
        "right.yaml",
        |text| {
            let at = text.find("rectification_matrix").expect("there");
            text[..at].to_owned() + &text[at..].replacen("data: [0.9", "data: [0.5", 1)
        },
        &["rectification_matrix", "not a rotation"],
    );
}

#[test]
fn eyes_in_the_wrong_order_are_noticed() {
    let folder = folder();
    let files = ["a.yaml", "b.yaml"].map(|name| folder.path().join(name));
    ros::write(&fisheye_eyes(), &files[0], &files[1]).expect("written");
    let swapped = [files[1].clone(), files[0].clone()];
    let by_name = read_any(&swapped).expect_err("swapped").to_string();
    assert!(by_name.contains("b.yaml") && by_name.contains("left eye's file first"), "{by_name}");
    // Without names the sign of the baseline still tells.
    for file in &files {
        let text = read_text(file)
            .replace("camera_name: left", "camera_name: eye")
            .replace("camera_name: right", "camera_name: eye");
        fs::write(file, text).expect("written");
    }
    assert_same(&read_any(&files).expect("in order").cameras, &fisheye_eyes());
    let by_sign = read_any(&swapped).expect_err("swapped");
    assert!(matches!(by_sign, FormatError::EyesSwapped { .. }), "{by_sign}");
    // The same eye twice has no baseline.
    let twice = read_any(&[files[0].clone(), files[0].clone()]).expect_err("one eye");
    assert!(matches!(twice, FormatError::NoBaseline { .. }), "{twice}");
    // In a camchain the order is that of cam0 and cam1.
    refused(
        "camchain.yaml",
        |text| text.replace("-0.06993]", "0.06993]"),
        &["T_cn_cnm1", "cam0 must be the left eye"],
    );
}

#[test]
fn damaged_camchains_say_what_and_where() {
    let name = "camchain.yaml";
    refused(name, without("T_cn_cnm1"), &[]);
    refused(name, |text| text[..text.find("cam1:").expect("there")].to_owned(), &["cam1", "missing"]);
    refused(
        name,
        instead("camera_model: pinhole", "camera_model: omni"),
        &["cam0.camera_model", "omni", "equidistant"],
    );
    refused(
        name,
        instead("distortion_model: equidistant", "distortion_model: fov"),
        &["cam0.distortion_model", "fov", "radtan"],
    );
    refused(
        name,
        instead("resolution: [640, 480]", "resolution: [640]"),
        &["cam0.resolution", "width, height"],
    );
    refused(name, instead("intrinsics: [", "intrinsics: [1.0, "), &["cam0.intrinsics", "4 numbers", "5"]);
    refused(name, instead("[0.0, 0.0, 0.0, 1.0]", "[0.0, 0.0, 0.1, 1.0]"), &["T_cn_cnm1", "last row"]);
    refused(name, instead("resolution: [640, 480]", "resolution: [640, 480"), &["YAML", "line"]);
}

#[test]
fn what_is_no_calibration_is_told_apart() {
    let folder = folder();
    let expect = |name: &str, bytes: &[u8], word: &str| {
        let file = folder.path().join(name);
        fs::write(&file, bytes).expect("written");
        let error = read_any(&[file]).expect_err(name).to_string();
        assert!(error.contains(word) && error.contains(name), "{error}");
    };
    expect("empty.yaml", b"", "is empty");
    expect("blank.yaml", b"\n  \n", "is empty");
    expect("photo.yaml", b"\xff\xd8\xff\xe0\0\x10JFIF", "JPEG picture");
    expect("noise.yaml", &[0x00, 0xc3, 0x28], "not a text file");
    expect("prose.yaml", b"This is not a calibration.\n", "no calibration in a known format");
    expect("other.yaml", b"answer: 42\n", "its keys: answer");
    expect("broken.yaml", b"a: [1, 2\nb: 3\n", "does not parse as YAML");
    expect("twice.yaml", b"cam0: 1\ncam0: 2\n", "does not parse as YAML");
    let error = read_any(&[folder.path().to_path_buf()]).expect_err("a folder").to_string();
    assert!(error.contains("left.yaml and right.yaml"), "{error}");
    let absent = read_any(&[folder.path().join("absent.yaml")]).expect_err("absent");
    assert!(matches!(absent, FormatError::File(_)), "{absent}");
    assert!(matches!(read_any(&[]), Err(FormatError::FileCount { .. })));
}

#[test]
fn one_ros_file_is_half_a_calibration() {
    let folder = folder();
    let files: [PathBuf; 2] = ["l.yaml", "r.yaml"].map(|name| folder.path().join(name));
    ros::write(&fisheye_eyes(), &files[0], &files[1]).expect("written");
    let error = read_any(&files[..1]).expect_err("one eye").to_string();
    assert!(error.contains("one eye") && error.contains("right eye's file"), "{error}");
}

/// Changes a written calibration of this program and reads it.
fn spoiled(from: &str, to: &str) -> Result<StereoCalibration, FormatError> {
    let folder = folder();
    let file = folder.path().join("rig-cameras.yaml");
    native::write(&calibration(), &file).expect("written");
    let text = read_text(&file);
    let changed = text.replacen(from, to, 1);
    assert_ne!(changed, text, "the test changes something");
    fs::write(&file, changed).expect("written");
    native::read(&file)
}

#[test]
fn cameras_that_cannot_be_are_refused() {
    for (from, to, words) in [
        ("fx_px: 150.1", "fx_px: 150123.1", ["cameras.left", "150123.1235 px cannot be a focal length"]),
        ("translation_m: [-0.06993", "translation_m: [-69.93", ["right_from_left", "69.93"]),
        (
            "translation_m: [-0.06993",
            "translation_m: [-1e308",
            ["right_from_left", "cannot be a distance between the eyes"],
        ),
        ("cx_px: 321.3", "cx_px: -1e308", ["cameras.left", "principal point"]),
        ("k1_k2_k3_k4: [-0.0084", "k1_k2_k3_k4: [-8400.0", ["cameras.left", "coefficient of a fisheye lens"]),
    ] {
        let error = spoiled(from, to).expect_err("it cannot be").to_string();
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    }
}

#[test]
fn a_calibration_that_answers_otherwise_than_it_did_is_refused() {
    for (from, to) in [
        ("fx_px: 150.1", "fx_px: 157.1"),
        ("translation_m: [-0.06993", "translation_m: [-0.0799"),
        ("k1_k2_k3_k4: [-0.0084", "k1_k2_k3_k4: [-0.0184"),
        ("cy_px: 239.6", "cy_px: 239.7"),
    ] {
        let error = spoiled(from, to).expect_err("changed");
        assert!(matches!(error, FormatError::OtherAnswers { .. }), "{error}");
        let said = error.to_string();
        assert!(said.contains("self_test") && said.contains("calibrate again"), "{said}");
    }
    // What no answer depends on is kept as well.
    for (from, to, what) in [
        ("square_mean_m: 0.03008", "square_mean_m: 30.08", "summary"),
        ("[left, 0, 33.6", "[left, 0, 333.6", "residuals"),
        ("translation_m: [0.01, -0.02", "translation_m: [0.01, -0.0200001", "places of the board"),
        ("- [[100.0, 200.0]", "- [[100.0, -1.0e+308]", "corners"),
        ("- [-4.28571", "- [-4.98571", "covariance"),
    ] {
        let said = spoiled(from, to).expect_err("changed").to_string();
        assert!(said.contains(&format!("the {what} in this file are not those")), "{said}");
    }
    // Files of older programs have none.
    let folder = folder();
    let file = folder.path().join("rig-cameras.yaml");
    native::write(&calibration(), &file).expect("written");
    let text = read_text(&file);
    let (before, after) = text.split_once("self_test:").expect("it is there");
    let rest = after.split_once("complete:").expect("the end").1;
    fs::write(&file, format!("{before}complete:{rest}")).expect("written");
    assert_eq!(native::read(&file).expect("read"), calibration());
}

#[test]
fn foreign_cameras_that_cannot_be_are_refused() {
    let folder = folder();
    let files = ["left.yaml", "right.yaml"].map(|name| folder.path().join(name));
    let mut eyes = fisheye_eyes();
    if let CameraModel::Fisheye(lens) = &mut eyes.left.model {
        lens.fx_px *= 1000.0;
    }
    ros::write(&eyes, &files[0], &files[1]).expect("written");
    let error = read_any(&files).expect_err("a telescope").to_string();
    assert!(
        error.contains("left.yaml") && error.contains("camera_matrix") && error.contains("focal length"),
        "{error}"
    );
    kalibr::write(&eyes, &files[0]).expect("written");
    let error = read_any(&files[..1]).expect_err("a telescope").to_string();
    assert!(error.contains("cam0.intrinsics") && error.contains("focal length"), "{error}");
}

#[test]
fn files_that_nest_beyond_all_measure_are_refused() {
    let folder = folder();
    let file = folder.path().join("deep.yaml");
    for text in [
        format!("format: {}{}\n", "[".repeat(20_000), "]".repeat(20_000)),
        format!("format:\n {}1\n", "- ".repeat(20_000)),
        format!("format: {}1{}\n", "{a: ".repeat(20_000), "}".repeat(20_000)),
    ] {
        fs::write(&file, text).expect("written");
        let error = read_any(std::slice::from_ref(&file)).expect_err("too deep").to_string();
        assert!(error.contains("levels deep"), "{error}");
    }
}
