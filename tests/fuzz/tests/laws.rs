//! What a writer writes its reader reads back, for made-up contents of every text format; and nothing that
//! is read panics, whatever the bytes are.

use std::path::Path;

use jiff::Timestamp;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use plumbline_correction::tables::{HeightPoint, HeightTable, YawPoint, YawTable};
use plumbline_fuzz::dice::Dice;
use plumbline_fuzz::readers;
use plumbline_model::formats::CalibrationFormat;
use plumbline_model::robot::Rig;
use plumbline_model::session::{
    Chain, LocalizationRow, LocalizationTable, Manifest, PoseRow, PoseTable, RigReference, Screen,
    StereoImages, TouchRow, TouchTable, Touchscreen,
};
use plumbline_model::touchscreen::{ScreenPlacement, place_screen};
use plumbline_model::{
    Camera, CameraModel, Fisheye, Pinhole, Pixel, Point, Pose, Robot, Session, StereoCalibration,
    StereoCameras,
};
use plumbline_vision::calibration_file;

/// Contents per law.
const TIMES: u64 = 60;

fn dice(name: &str, index: u64) -> Dice {
    Dice::new(4, name, index)
}

/// A number of any usual size, with all its digits, now and then a round one.
fn number(dice: &mut Dice) -> f64 {
    match dice.below(5) {
        0 => dice.below(9) as f64 - 4.0,
        1 => dice.around() * 1e-7,
        2 => -0.0,
        _ => dice.around() * 1.5,
    }
}

fn maybe<T>(dice: &mut Dice, value: T) -> Option<T> {
    (!dice.once_in(4)).then_some(value)
}

/// Words as people write them: with commas, quotes, other scripts. Without spaces at the ends, which a
/// table does not keep.
fn words(dice: &mut Dice) -> String {
    const WORDS: [&str; 8] = ["a", "left, far", "say \"so\"", "naïve", "指", "x=y", "#3", "it's"];
    (0..1 + dice.below(3)).map(|_| *dice.pick(&WORDS)).collect::<Vec<_>>().join(" ")
}

fn numbers(dice: &mut Dice, count: usize) -> Vec<Option<f64>> {
    (0..count)
        .map(|_| {
            let value = number(dice);
            maybe(dice, value)
        })
        .collect()
}

fn joints() -> Vec<String> {
    ["one", "two_b", "three"].map(str::to_owned).to_vec()
}

fn screen(dice: &mut Dice) -> Touchscreen {
    let moved = Isometry3::from_parts(
        Vector3::new(0.01 * dice.around(), 0.01 * dice.around(), 0.01 * dice.around()).into(),
        UnitQuaternion::from_scaled_axis(Vector3::new(0.02 * dice.around(), 0.0, 0.02 * dice.around())),
    );
    Rig::built_in("nico").expect("comes along").touchscreen.moved(&moved)
}

fn touch(dice: &mut Dice) -> TouchRow {
    let pixel: Pixel<Screen> = Pixel::new(1900.0 * dice.uniform(), 1000.0 * dice.uniform());
    let target = Point::<Robot>::new(0.4 + 0.1 * dice.around(), 0.1 * dice.around(), 0.05);
    let (group, side, set) = (words(dice), words(dice), words(dice));
    TouchRow {
        commanded_rad: (0..3).map(|_| Some(number(dice))).collect(),
        encoder_rad: numbers(dice, 3),
        touch: maybe(dice, pixel),
        group: maybe(dice, group),
        approach: maybe(dice, side),
        set: maybe(dice, set),
        screen_height_m: maybe(dice, 0.01),
        payload_kg: maybe(dice, 0.25),
        move_secs: maybe(dice, 1.5),
        t_secs: Some(100.0 * dice.uniform()),
        target: maybe(dice, target),
        temperature_c: vec![Some(20.0 + 20.0 * dice.uniform()); 3],
        load: vec![Some(0.5 * dice.around()); 3],
    }
}

fn session(dice: &mut Dice) -> Session {
    let rows = 1 + dice.below(9);
    let touches: Vec<TouchRow> = (0..rows).map(|_| touch(dice)).collect();
    let poses: Vec<PoseRow> = (0..rows)
        .map(|_| PoseRow {
            commanded_rad: (0..3).map(|_| Some(number(dice))).collect(),
            encoder_rad: numbers(dice, 3),
            measured: Some(Point::new(number(dice), number(dice), number(dice))),
            torque_nm: numbers(dice, 3),
            payload_kg: maybe(dice, 0.0),
            t_secs: Some(100.0 * dice.uniform()),
            group: Some(words(dice)),
            approach: Some("plus".to_owned()),
            set: Some(words(dice)),
            ..PoseRow::default()
        })
        .collect();
    let seen: Vec<LocalizationRow> = (0..rows)
        .map(|k| LocalizationRow {
            truth: Some(Point::new(0.3 + 0.1 * dice.uniform(), 0.1 * dice.around(), 0.05)),
            estimate: Some(Point::new(0.3 + 0.1 * dice.uniform(), 0.1 * dice.around(), 0.05)),
            left: Some(Pixel::new(640.0 * dice.uniform(), 480.0 * dice.uniform())),
            right: Some(Pixel::new(640.0 * dice.uniform(), 480.0 * dice.uniform())),
            head_rad: vec![Some(0.3 * dice.around())],
            t_secs: Some(50.0 * dice.uniform()),
            object: Some(words(dice)),
            background_m: Some(dice.uniform()),
            group: Some(words(dice)),
            set: Some(words(dice)),
            valid: k % 3 != 2,
        })
        .collect();
    Session {
        manifest: Manifest {
            rig: if dice.once_in(2) {
                RigReference::Named(words(dice))
            } else {
                RigReference::File(words(dice).into())
            },
            started: Timestamp::from_second(1_700_000_000 + dice.below(100_000_000) as i64).expect("a time"),
            operator: words(dice),
            notes: format!("{}\nsecond line \\ {}", words(dice), words(dice)),
            touchscreen: Some(screen(dice)),
            chain: Some(Chain { tip: words(dice), joints: joints() }),
            extra: toml::Table::from_iter([
                ("lamp".to_owned(), toml::Value::from(words(dice))),
                (
                    "room".to_owned(),
                    toml::Value::Table(toml::Table::from_iter([("t_c".to_owned(), 21.5.into())])),
                ),
            ]),
        },
        touches: Some(TouchTable::from_rows(joints(), &touches)),
        localizations: Some(LocalizationTable::from_rows(vec!["head_z".to_owned()], &seen)),
        poses: Some(PoseTable::from_rows(joints(), &poses)),
        stereo: StereoImages::default(),
        log: None,
    }
}

#[test]
fn a_session_comes_back_to_the_last_bit() {
    for index in 0..TIMES {
        let folder = tempfile::tempdir().expect("a folder");
        let written = session(&mut dice("session", index));
        written.write(folder.path()).expect("written");
        let read = Session::read(folder.path()).unwrap_or_else(|error| panic!("{index}: {error}"));
        assert_eq!(read, written, "{index}");
        let rows = |session: &Session| session.touches.as_ref().expect("touches").rows().collect::<Vec<_>>();
        assert_eq!(rows(&read), rows(&written), "{index}");
    }
}

fn cameras(dice: &mut Dice, fisheye: bool, third: bool) -> StereoCameras {
    let mut camera = || {
        let (fx_px, fy_px) = (150.0 + 20.0 * dice.uniform(), 150.0 + 20.0 * dice.uniform());
        let (cx_px, cy_px) = (320.0 + 9.0 * dice.around(), 240.0 + 9.0 * dice.around());
        let mut small = |size: f64| size * dice.around();
        let model = if fisheye {
            let k = [small(0.01), small(0.005), small(0.001), small(0.0002)];
            CameraModel::Fisheye(Fisheye { fx_px, fy_px, cx_px, cy_px, skew_px: 0.0, k })
        } else {
            let [k1, k2, k3] = [small(0.1), small(0.05), if third { small(0.01) } else { 0.0 }];
            let [p1, p2] = [small(1e-3), small(1e-3)];
            CameraModel::Pinhole(Pinhole { fx_px, fy_px, cx_px, cy_px, k1, k2, p1, p2, k3 })
        };
        Camera { model, width_px: 640, height_px: 480 }
    };
    let (left, right) = (camera(), camera());
    let mut small = |size: f64| size * dice.around();
    let turn = Vector3::new(small(0.02), small(0.02), small(0.02));
    let at = Vector3::new(-0.07 + small(0.01), small(0.002), small(0.002));
    StereoCameras { left, right, right_from_left: Pose::from_rotation_vector(turn, at) }
}

#[test]
fn calibrations_come_back_in_every_format() {
    let folder = tempfile::tempdir().expect("a folder");
    for index in 0..TIMES {
        let mut dice = dice("cameras", index);
        let written = cameras(&mut dice, index % 2 == 0, index % 4 == 1);
        for format in CalibrationFormat::ALL {
            let names: &[&str] = match format {
                CalibrationFormat::RosCameraInfo => &["left.yaml", "right.yaml"],
                CalibrationFormat::OpenCvStorage => dice.pick::<&[&str]>(&[&["a.yml"], &["a.xml"]]),
                _ => &["a.yaml"],
            };
            let files: Vec<_> = names.iter().map(|name| folder.path().join(name)).collect();
            let saved = calibration_file::save(&StereoCalibration::bare(written), &files, format);
            // The third radial coefficient of a pinhole has no place there.
            if format == CalibrationFormat::KalibrCamchain && index % 4 == 1 {
                let said = saved.expect_err("it would be lost").to_string();
                assert!(said.contains("k3") && said.contains("OpenCV"), "{said}");
                continue;
            }
            saved.unwrap_or_else(|error| panic!("{index} {}: {error}", format.name()));
            let read = calibration_file::load(&files)
                .unwrap_or_else(|error| panic!("{index} {}: {error}", format.name()))
                .cameras;
            for (ours, theirs) in [(written.left, read.left), (written.right, read.right)] {
                assert_eq!(ours.size_px(), theirs.size_px());
                assert_eq!(ours.model.kind(), theirs.model.kind(), "{}", format.name());
                for (a, b) in ours.model.parameters().iter().zip(theirs.model.parameters()) {
                    assert!((a - b).abs() <= 1e-12 * a.abs(), "{}: {a} became {b}", format.name());
                }
            }
            let moved = written.right_from_left.isometry.inverse() * read.right_from_left.isometry;
            let (turned, shifted) = (moved.rotation.angle(), moved.translation.vector.norm());
            // Rotations are written as matrices, which lose the last digits of a vector.
            assert!(turned < 1e-7 && shifted < 1e-12, "{}: {turned} rad, {shifted} m", format.name());
        }
    }
}

#[test]
fn placements_come_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("screen.toml");
    for index in 0..TIMES {
        let mut dice = dice("placement", index);
        let (nominal, real) = (screen(&mut dice), screen(&mut dice));
        let touches: Vec<_> =
            [(90.0, 80.0), (1800.0, 100.0), (1700.0, 1000.0), (100.0, 900.0), (950.0, 500.0)]
                .into_iter()
                .map(|(u, v)| {
                    let at = real.point_at(Pixel::new(u, v)).coords;
                    let off = 0.001 * dice.around();
                    (Pixel::new(u, v), Point::<Robot>::new(at.x + off, at.y - off, at.z + off))
                })
                .collect();
        let written = place_screen(&nominal, &touches).expect("placed").of_rig("nico");
        written.write(&file).expect("written");
        assert_eq!(ScreenPlacement::read(&file, "nico").expect("read"), written);
    }
}

#[test]
fn tables_come_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let (height, yaw) = (folder.path().join("height.csv"), folder.path().join("yaw.csv"));
    for index in 0..TIMES {
        let mut dice = dice("tables", index);
        let mut place = |k: usize| {
            (
                0.25 + 0.08 * (k / 3) as f64 + 0.01 * dice.uniform(),
                0.1 * (k % 3) as f64 + 0.01 * dice.uniform(),
            )
        };
        let count = 6 + index as usize % 9;
        let heights =
            (0..count).map(&mut place).map(|(x_m, y_m)| HeightPoint { x_m, y_m, height_m: 0.1 * x_m });
        let written = HeightTable::new(heights.collect()).expect("a table");
        written.write(&height).expect("written");
        assert_eq!(HeightTable::read(&height).expect("read"), written);
        let yaws =
            (0..count).map(place).map(|(x_m, y_m)| YawPoint { x_m, y_m, z_m: 0.1 + x_m / 4.0, yaw_rad: y_m });
        let written = YawTable::new(yaws.collect()).expect("a table");
        written.write(&yaw).expect("written");
        assert_eq!(YawTable::read(&yaw).expect("read"), written);
    }
}

/// What texts of all formats are made of.
const PRINTABLE: &[u8] = b"{}[]\"':=,.-\n 0123456789e<>/abcxyz";

/// Bytes that have nothing to do with any format, and the beginnings of all of them.
fn noise(dice: &mut Dice) -> Vec<u8> {
    const BEGINNINGS: [&[u8]; 9] = [
        b"",
        b"{",
        b"[[",
        b"%YAML:1.0\n---\n",
        b"<?xml version=\"1.0\"?>\n<opencv_storage>",
        b"\x89PNG\r\n\x1a\n",
        b"\xff\xd8\xff",
        b"a,b\n",
        b"format = 1\n",
    ];
    let mut bytes = dice.pick(&BEGINNINGS).to_vec();
    let printable = dice.once_in(2);
    let count = dice.below(300);
    bytes.extend((0..count).map(|_| {
        let byte = dice.bits() as u8;
        if printable { PRINTABLE[usize::from(byte) % PRINTABLE.len()] } else { byte }
    }));
    bytes
}

#[test]
fn noise_is_refused_and_panics_nobody() {
    let root = tempfile::tempdir().expect("a folder");
    // One file each: where there are more, the others are missing, which is a case, too.
    let file_of = |files: &[&str]| {
        files.iter().find(|file| Path::new(file).extension().is_some()).map(|file| (*file).to_owned())
    };
    for reader in readers::all().into_iter().filter(|reader| !reader.name.starts_with("detector")) {
        let Some(file) = file_of(reader.files) else { continue };
        for index in 0..15 {
            let folder = root.path().join(reader.name);
            let path = folder.join(file.as_str());
            std::fs::create_dir_all(path.parent().expect("a folder above it")).expect("made");
            std::fs::write(&path, noise(&mut dice(reader.name, index))).expect("written");
            let heard = (reader.read)(&folder);
            assert_eq!(plumbline_fuzz::check::fault(&heard, reader.finite), None, "{} {index}", reader.name);
            std::fs::remove_dir_all(&folder).expect("removed");
        }
    }
}
