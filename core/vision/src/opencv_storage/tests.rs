//! Round trips through OpenCV's own writer and reader, and files that cannot be used.

use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use plumbline_model::camera::{Camera, CameraModel, Fisheye, Pinhole};
use plumbline_model::formats::{CalibrationFormat, FormatError, LengthUnit, ReadOptions};
use plumbline_model::{ModelKind, Pose, StereoCalibration, StereoCameras};

use crate::calibration_file::{load, load_with, save};

fn fisheye_eyes() -> StereoCameras {
    let camera = |cx_px: f64, skew_px: f64| Camera {
        model: CameraModel::Fisheye(Fisheye {
            fx_px: 150.123_456_789_012_34,
            fy_px: 149.987_654_321_098_76,
            cx_px,
            cy_px: 240.0 - 1.0 / 3.0,
            skew_px,
            k: [-0.008_4, -8.0e-3 / 7.0, 1.7e-13, -2.6e-4],
        }),
        width_px: 640,
        height_px: 480,
    };
    StereoCameras {
        left: camera(321.3, 0.0),
        right: camera(317.7, -0.071),
        right_from_left: Pose::from_rotation_vector(
            Vector3::new(0.004, -0.021, 0.013),
            Vector3::new(-0.069_93, 0.1 / 300.0, -7e-4),
        ),
    }
}

fn pinhole_eyes() -> StereoCameras {
    let mut eyes = fisheye_eyes();
    for camera in [&mut eyes.left, &mut eyes.right] {
        camera.model = CameraModel::Pinhole(Pinhole {
            fx_px: 524.6,
            fy_px: 526.9,
            cx_px: 312.4,
            cy_px: 247.4,
            k1: -0.36,
            k2: 0.175,
            p1: 1.0 / 3000.0,
            p2: -5e-4,
            k3: 0.01,
        });
    }
    eyes.right.width_px = 1280;
    eyes
}

fn assert_same(a: &StereoCameras, b: &StereoCameras) {
    assert_eq!((a.left, a.right), (b.left, b.right));
    assert_eq!(a.right_from_left.translation_m(), b.right_from_left.translation_m());
    let turned = (a.right_from_left.rotation() - b.right_from_left.rotation()).amax();
    assert!(turned <= 1e-15, "rotations differ by {turned}");
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder for the test")
}

/// A file that OpenCV wrote, changed as text.
fn damaged(folder: &Path, change: impl Fn(&str) -> String) -> Vec<PathBuf> {
    let file = folder.join("damaged.yml");
    let calibration = StereoCalibration::bare(fisheye_eyes());
    save(&calibration, std::slice::from_ref(&file), CalibrationFormat::OpenCvStorage).expect("written");
    let text = std::fs::read_to_string(&file).expect("readable");
    let changed = change(&text);
    assert_ne!(text, changed, "the test changes something");
    std::fs::write(&file, changed).expect("written");
    vec![file]
}

#[test]
fn yaml_xml_and_json_come_back_digit_for_digit() {
    let folder = folder();
    for eyes in [fisheye_eyes(), pinhole_eyes()] {
        for name in ["cameras.yml", "cameras.yaml", "cameras.xml", "cameras.json", "cameras.txt"] {
            let file = vec![folder.path().join(name)];
            save(&StereoCalibration::bare(eyes), &file, CalibrationFormat::OpenCvStorage).expect(name);
            assert_same(&load(&file).expect(name).cameras, &eyes);
        }
    }
    let left_over = std::fs::read_dir(folder.path()).expect("readable").count();
    assert_eq!(left_over, 5, "temporary files were left behind");
}

#[test]
fn every_format_is_recognized_by_its_content() {
    let folder = folder();
    let mut eyes = fisheye_eyes();
    if let CameraModel::Fisheye(lens) = &mut eyes.right.model {
        lens.skew_px = 0.0; // Kalibr has no place for it
    }
    let calibration = StereoCalibration::bare(eyes);
    for format in CalibrationFormat::ALL {
        let names: &[&str] =
            if format == CalibrationFormat::RosCameraInfo { &["a.txt", "b.txt"] } else { &["c.txt"] };
        let files: Vec<PathBuf> = names.iter().map(|name| folder.path().join(name)).collect();
        let name = format.name();
        save(&calibration, &files, format).expect(name);
        let back = load(&files).expect(name).cameras;
        assert_eq!((back.left, back.right), (eyes.left, eyes.right), "{name}");
        let difference = back.right_from_left.translation_m() - eyes.right_from_left.translation_m();
        assert!(difference.amax() <= 1e-15, "{name}: {difference}");
        let turned = (back.right_from_left.rotation() - eyes.right_from_left.rotation()).amax();
        assert!(turned <= 1e-15, "{name}: {turned}");
    }
}

#[test]
fn a_wrong_number_of_files_is_refused() {
    let folder = folder();
    let calibration = StereoCalibration::bare(fisheye_eyes());
    let one = [folder.path().join("one.yaml")];
    let error = save(&calibration, &one, CalibrationFormat::RosCameraInfo).expect_err("one file");
    assert!(error.to_string().contains("two files"), "{error}");
    assert!(!one[0].exists());
}

/// OpenCV's stereo sample writes two files, without the image size, in units of squares.
#[test]
fn the_two_files_of_the_opencv_sample_are_joined() {
    let folder = folder();
    let matrix = |rows: usize, columns: usize, data: &str| {
        format!("!!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: [ {data} ]\n")
    };
    let k = matrix(3, 3, "5.3e+02, 0., 3.2e+02, 0., 5.3e+02,\n       2.4e+02, 0., 0., 1.");
    let d = matrix(1, 14, "-0.28, 0.06, 0., 0., 0.02, 0., 0., 0., 0., 0., 0., 0., 0., 0.");
    let intrinsics = format!("%YAML:1.0\n---\nM1: {k}D1: {d}M2: {k}D2: {d}");
    let r = matrix(3, 3, "1., 0., 0., 0., 1., 0., 0., 0., 1.");
    let t = matrix(3, 1, "-3.34, 0.04, -0.02");
    let files = vec![folder.path().join("intrinsics.yml"), folder.path().join("extrinsics.yml")];
    std::fs::write(&files[0], intrinsics).expect("written");
    std::fs::write(&files[1], format!("%YAML:1.0\n---\nR: {r}T: {t}")).expect("written");

    let error = load(&files).expect_err("no image size").to_string();
    assert!(error.contains("image_width"), "{error}");
    let mut options = ReadOptions { image_size_px: Some((640, 480)), ..ReadOptions::default() };
    let error = load_with(&files, &options).expect_err("in squares");
    assert!(matches!(error, FormatError::ImplausibleBaseline { .. }), "{error}");
    assert!(error.to_string().contains("unit of length"), "{error}");

    options.length_unit = Some(LengthUnit::Squares { side_m: 0.025 });
    let eyes = load_with(&files, &options).expect("complete").cameras;
    assert!((eyes.baseline_m() - 0.025 * 3.34_f64.hypot(0.04).hypot(0.02)).abs() < 1e-15);
    assert_eq!(eyes.left.model.kind(), ModelKind::Pinhole);
    assert_eq!(eyes.left.model.parameters()[4..], [-0.28, 0.06, 0.0, 0.0, 0.02]);
}

#[test]
fn millimeters_are_noticed() {
    let folder = folder();
    let mut eyes = fisheye_eyes();
    eyes.right_from_left.isometry.translation.vector *= 1000.0;
    let file = vec![folder.path().join("mm.xml")];
    save(&StereoCalibration::bare(eyes), &file, CalibrationFormat::OpenCvStorage).expect("written");
    let error = load(&file).expect_err("69 m apart").to_string();
    assert!(error.contains("millimeters") && error.contains("mm.xml") && error.contains("\"T\""), "{error}");
    let options = ReadOptions { length_unit: Some(LengthUnit::Millimeters), ..ReadOptions::default() };
    let back = load_with(&file, &options).expect("with its unit").cameras;
    assert!((back.baseline_m() - fisheye_eyes().baseline_m()).abs() < 1e-15);
}

#[test]
fn other_names_for_the_matrices_are_understood() {
    let folder = folder();
    let files = damaged(folder.path(), |text| {
        text.replace("\nM1:", "\nK1:")
            .replace("\nM2:", "\ncameraMatrix2:")
            .replace("\nD1:", "\ndistCoeffs1:")
            .replace("\nT:", "\ntranslation:")
    });
    assert_same(&load(&files).expect("understood").cameras, &fisheye_eyes());
}

#[test]
fn four_coefficients_without_a_model_are_a_fisheye_unless_stated() {
    let folder = folder();
    let without_model = |text: &str| {
        text.lines().filter(|line| !line.starts_with("distortion_model")).collect::<Vec<_>>().join("\n")
            + "\n"
    };
    let files = damaged(folder.path(), |text| without_model(text).replace("-7.0999999999999994e-02", "0."));
    assert_eq!(load(&files).expect("readable").cameras.left.model.kind(), ModelKind::Fisheye);
    let options = ReadOptions { model: Some(ModelKind::Pinhole), ..ReadOptions::default() };
    assert_eq!(load_with(&files, &options).expect("readable").cameras.left.model.kind(), ModelKind::Pinhole);
}

/// What goes wrong, and what the message must name.
#[test]
fn unusable_files_say_what_is_wrong() {
    let folder = folder();
    let expect = |change: &dyn Fn(&str) -> String, words: &[&str]| {
        let error = load(&damaged(folder.path(), change)).expect_err("damaged").to_string();
        for word in words.iter().chain(&["damaged.yml"]) {
            assert!(error.contains(word), "\"{word}\" is not in: {error}");
        }
    };
    expect(&|text| text.replace("\nM2:", "\nMZ:"), &["\"M2\"", "missing", "K2"]);
    expect(&|text| text.replace("\nT:", "\nTT:"), &["\"T\"", "missing"]);
    expect(&|text| text.replace("1.5012345678901235e+02", ".Nan"), &["\"M1\"", "line ", "no usable number"]);
    expect(&|text| text.replace("1.5012345678901235e+02", "-1.5e+02"), &["\"M1\"", "focal lengths"]);
    expect(
        &|text| {
            text.replace(
                "R: !!opencv-matrix\n   rows: 3\n   cols: 3",
                "R: !!opencv-matrix\n   rows: 1\n   cols: 9",
            )
        },
        &["\"R\"", "3×3", "1×9"],
    );
    expect(
        &|text| text.replace("distortion_model1: fisheye", "distortion_model1: omni"),
        &["omni", "fisheye", "pinhole"],
    );
    expect(&|text| text.replace("image_width: 640", "image_width: 0"), &["image_width", "at least 1"]);
    expect(&|text| text.replace("image_width: 640", "image_width: wide"), &["image_width", "pixels"]);
    expect(&|text| text[..text.find("\nT:").expect("T") + 1].to_owned(), &["\"T\"", "missing"]);
    expect(&|text| text[..text.find("T: !!").expect("T") + 70].to_owned(), &["OpenCV storage", "line "]);
    let swapped = |text: &str| {
        let at = text.find("\nT:").expect("T");
        let (head, tail) = text.split_at(at);
        head.to_owned() + &tail.replacen("[ -", "[ ", 1)
    };
    expect(&swapped, &["left of the left eye", "M1 and D1 must be the left"]);
}

#[test]
fn what_is_no_storage_is_refused() {
    let folder = folder();
    let expect = |name: &str, bytes: &[u8], word: &str| {
        let file = folder.path().join(name);
        std::fs::write(&file, bytes).expect("written");
        let error = load(&[file]).expect_err(name).to_string();
        assert!(error.contains(word) && error.contains(name), "{error}");
    };
    expect("empty.yml", b"", "is empty");
    expect("picture.yml", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "PNG picture");
    expect("other.xml", b"<?xml version=\"1.0\"?>\n<robot/>\n", "OpenCV storage");
    expect(
        "cut.xml",
        b"<?xml version=\"1.0\"?>\n<opencv_storage>\n<M1 type_id=\"opencv-mat",
        "OpenCV storage",
    );
    expect("cut.json", b"{ \"M1\": { \"type_id\": \"opencv-matrix\", \"rows\": 3,", "OpenCV storage");
    expect("noise.yml", &[0xfe, 0x00, 0x81, 0x99], "not a text file");
    let absent = folder.path().join("absent.yml");
    assert!(matches!(load(&[absent]), Err(FormatError::File(_))));
    assert!(matches!(load(&[]), Err(FormatError::FileCount { .. })));
}

#[test]
fn a_refused_write_leaves_the_old_file() {
    let folder = folder();
    let file = vec![folder.path().join("kept.yml")];
    save(&StereoCalibration::bare(fisheye_eyes()), &file, CalibrationFormat::OpenCvStorage).expect("written");
    let before = std::fs::read(&file[0]).expect("readable");
    let mut broken = fisheye_eyes();
    broken.right_from_left.isometry.translation.vector.y = f64::NAN;
    let error = save(&StereoCalibration::bare(broken), &file, CalibrationFormat::OpenCvStorage);
    assert!(matches!(error, Err(FormatError::NotFinite { .. })));
    assert_eq!(std::fs::read(&file[0]).expect("readable"), before);
    assert_eq!(std::fs::read_dir(folder.path()).expect("readable").count(), 1);
}

#[test]
fn lenses_that_cannot_be_and_files_that_nest_too_deep_are_refused() {
    let folder = folder();
    let said = |change: &dyn Fn(&str) -> String| {
        load(&damaged(folder.path(), change)).expect_err("it cannot be").to_string()
    };
    let mut eyes = fisheye_eyes();
    if let CameraModel::Fisheye(lens) = &mut eyes.left.model {
        lens.fx_px *= 1000.0;
    }
    let file = folder.path().join("telescope.yml");
    let telescope = StereoCalibration::bare(eyes);
    save(&telescope, std::slice::from_ref(&file), CalibrationFormat::OpenCvStorage).expect("written");
    let refused = load(&[file]).expect_err("a telescope").to_string();
    assert!(refused.contains("telescope.yml") && refused.contains("cannot be a focal length"), "{refused}");
    for text in [
        format!("%YAML:1.0\n---\na: {}\n", "[".repeat(20_000)),
        format!("<?xml version=\"1.0\"?>\n<opencv_storage>{}</opencv_storage>\n", "<a>".repeat(20_000)),
        format!("%YAML:1.0\n---\na:\n   {}1\n", "- ".repeat(20_000)),
    ] {
        let said = said(&|_| text.clone());
        assert!(said.contains("levels deep"), "{said}");
    }
}

#[test]
fn tags_that_opencv_never_comes_back_from_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("eyes.yaml");
    save(
        &StereoCalibration::bare(fisheye_eyes()),
        std::slice::from_ref(&file),
        CalibrationFormat::OpenCvStorage,
    )
    .expect("written");
    let text = std::fs::read_to_string(&file).expect("there");
    let at = text.find("data: [").expect("a matrix") + "data: [".len();
    std::fs::write(&file, format!("{} !!binary x,{}", &text[..at], &text[at..])).expect("written");
    let said = load(&[file]).expect_err("not OpenCV's").to_string();
    assert!(said.contains("!!binary") && said.contains("line"), "{said}");
}
