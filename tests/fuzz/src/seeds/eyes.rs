//! What verbs of the eyes read: calibrations in every format, a mount, small images of both eyes.

use std::path::Path;

use image::GrayImage;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use plumbline_model::formats::CalibrationFormat;
use plumbline_model::frame::Board;
use plumbline_model::robot::Rig;
use plumbline_model::{
    Camera, CameraModel, Chessboard, Eye, Fisheye, InnerCorners, ModelKind, Pinhole, Pixel, Point, Pose,
    Robot, StereoCalibration, StereoCameras, Unattended,
};
use plumbline_offline::{CalibrateArgs, calibrate_stereo};
use plumbline_vision::calibration_file;
use plumbline_vision::mount::{
    HeadView, MountOptions, PlannedTarget, Target, calibrate_mount, plan_head_views,
};
use plumbline_vision::synthetic::{Plane, Scene, chessboard_texture, granite_texture, nico_like_eyes};

use super::{Problem, all, put};

/// Images are smaller than NICO's by this, so that a case takes milliseconds.
const SMALLER: u32 = 4;
/// For pairs in which a chessboard is found.
const BOARD_SMALLER: u32 = 2;

pub fn make(folder: &Path) -> Result<(), Problem> {
    std::fs::create_dir_all(folder.join("cameras/ros"))?;
    std::fs::create_dir_all(folder.join("mount"))?;
    for (name, cameras) in [("", eyes(1)), ("pinhole-", pinhole_eyes())] {
        let calibration = StereoCalibration::bare(cameras);
        let file = |name_of: &str| folder.join(format!("cameras/{name}{name_of}"));
        calibration_file::save(&calibration, &[file("kalibr.yaml")], CalibrationFormat::KalibrCamchain)?;
        calibration_file::save(&calibration, &[file("opencv.yaml")], CalibrationFormat::OpenCvStorage)?;
        calibration_file::save(&calibration, &[file("opencv.xml")], CalibrationFormat::OpenCvStorage)?;
        calibration_file::save(&calibration, &[file("bare.yaml")], CalibrationFormat::Native)?;
        let both = [file("ros-left.yaml"), file("ros-right.yaml")];
        calibration_file::save(&calibration, &both, CalibrationFormat::RosCameraInfo)?;
    }
    let mut far = eyes(1);
    far.right_from_left.isometry.translation.vector *= 1000.0;
    let opencv = CalibrationFormat::OpenCvStorage;
    calibration_file::save(
        &StereoCalibration::bare(far),
        &[folder.join("cameras/millimeters.yaml")],
        opencv,
    )?;
    all([&|| views(folder), &|| boards(folder), &|| mount(folder)])
}

/// NICO's eyes with fewer pixels.
fn eyes(smaller: u32) -> StereoCameras {
    let full = nico_like_eyes();
    let camera = |camera: &Camera| {
        let by = f64::from(smaller);
        let CameraModel::Fisheye(lens) = camera.model else { return *camera };
        let center = |c_px: f64| (c_px + 0.5) / by - 0.5;
        let lens = Fisheye {
            fx_px: lens.fx_px / by,
            fy_px: lens.fy_px / by,
            cx_px: center(lens.cx_px),
            cy_px: center(lens.cy_px),
            ..lens
        };
        Camera {
            model: CameraModel::Fisheye(lens),
            width_px: camera.width_px / smaller,
            height_px: camera.height_px / smaller,
        }
    };
    StereoCameras {
        left: camera(&full.left),
        right: camera(&full.right),
        right_from_left: full.right_from_left,
    }
}

fn pinhole_eyes() -> StereoCameras {
    let camera = |cx_px: f64| Camera {
        model: CameraModel::Pinhole(Pinhole {
            fx_px: 300.0,
            fy_px: 300.5,
            cx_px,
            cy_px: 240.0,
            k1: -0.1,
            k2: 0.02,
            p1: 1e-4,
            p2: -2e-4,
            k3: 0.0,
        }),
        width_px: 640,
        height_px: 480,
    };
    let full = nico_like_eyes();
    StereoCameras { left: camera(320.0), right: camera(322.0), right_from_left: full.right_from_left }
}

/// A table seen by small eyes, with points to locate.
fn views(folder: &Path) -> Result<(), Problem> {
    let cameras = eyes(SMALLER);
    let lying = Isometry3::from_parts(
        Vector3::new(0.0, 0.0, 0.4).into(),
        UnitQuaternion::from_scaled_axis(Vector3::new(0.5, 0.1, 0.0)),
    );
    let scene = Scene { planes: vec![Plane::new(lying, granite_texture(0.012, 5))], ..Scene::default() };
    let (left, right) = scene.render_pair(&cameras, 1.0, 3);
    save(folder, "views/left.png", &left)?;
    save(folder, "views/right.png", &right)?;
    let calibration = StereoCalibration::bare(cameras);
    calibration_file::save(&calibration, &[folder.join("views/cameras.yaml")], CalibrationFormat::Native)?;
    put(folder, "views/points.csv", "u_px,v_px\n80,60\n70.5,66\n100,50\n")?;
    Ok(())
}

/// Pairs with a chessboard, and the calibration that comes of them.
fn boards(folder: &Path) -> Result<(), Problem> {
    let board = Chessboard::new(8, 5, 0.03)?;
    let center = board.corner(board.corner_count() - 1).coords.coords * 0.5;
    let poses = [
        ([-0.05, -0.03, 0.24], [0.35, 0.1, 0.1]),
        ([0.06, 0.03, 0.26], [-0.3, 0.3, -0.2]),
        ([0.0, 0.04, 0.22], [0.1, -0.45, 0.3]),
        ([0.05, -0.04, 0.28], [-0.2, -0.3, 0.0]),
        ([-0.06, 0.02, 0.25], [0.4, 0.3, -0.1]),
    ];
    let mut kept = 0;
    for (k, (at, turn)) in poses.into_iter().enumerate() {
        let pose = Isometry3::from_parts(
            Vector3::from(at).into(),
            UnitQuaternion::from_scaled_axis(Vector3::from(turn)),
        ) * Isometry3::translation(-center.x, -center.y, 0.0);
        let plane = Plane::new(pose, chessboard_texture(&board));
        let scene = Scene { planes: vec![plane], background: 120.0, ..Scene::default() };
        let cameras = eyes(BOARD_SMALLER);
        let (left, right) = scene.render_pair(&cameras, 1.0, k as u64);
        save(folder, &format!("boards/left/{k}.png"), &left)?;
        save(folder, &format!("boards/right/{k}.png"), &right)?;
        kept += 1;
    }
    let args = CalibrateArgs {
        left: folder.join("boards/left"),
        right: folder.join("boards/right"),
        board: "8x5".parse::<InnerCorners>()?,
        square_m: 0.03,
        model: ModelKind::Fisheye,
        exclude: vec![],
        out: Some(folder.join("cameras/native.yaml")),
    };
    let report = calibrate_stereo(&args, &Unattended)?;
    if report.pairs_used < 3 {
        return Err(format!("only {} of {kept} made-up pairs can be used", report.pairs_used).into());
    }
    std::fs::copy(folder.join("cameras/native.yaml"), folder.join("boards/cameras.yaml"))?;
    Ok(())
}

fn mount(folder: &Path) -> Result<(), Problem> {
    let rig = Rig::built_in("nico")?;
    let cameras = rig.eyes.cameras;
    let board = Chessboard::new(8, 5, 0.03)?;
    let place = Pose::<Robot, Board>::new(Isometry3::from_parts(
        Vector3::new(0.32, 0.08, 0.05).into(),
        UnitQuaternion::from_scaled_axis(Vector3::new(std::f64::consts::PI, 0.0, 0.0)),
    ));
    let what = PlannedTarget::board(&board, &place);
    let stands = plan_head_views(&rig, &cameras, &rig.home(), &what, 5)?;
    let corners: Vec<Point<Robot>> = board.corners().into_iter().map(|corner| place * corner).collect();
    let views: Vec<HeadView> = stands
        .into_iter()
        .enumerate()
        .map(|(k, (pan_rad, tilt_rad))| {
            let mut posture = rig.home();
            posture[rig.eyes.pan] = pan_rad;
            posture[rig.eyes.tilt] = tilt_rad;
            let head = rig.description.forward(&posture).of(rig.eyes.link).isometry;
            let left_from_robot = (head * rig.eyes.head_from_left.isometry).inverse();
            let seen = |eye: Eye| {
                let pixel = |point: &Point<Robot>| {
                    let in_left = left_from_robot * point.coords;
                    let in_eye = match eye {
                        Eye::Left => in_left,
                        Eye::Right => cameras.right_from_left.isometry * in_left,
                    };
                    let pixel = cameras.camera(eye).project(&in_eye.coords).ok()?;
                    // Not perfect, so that there are residuals.
                    let off = 0.1 * (pixel.u_px * 7.0 + k as f64).sin();
                    Some(Pixel::new(pixel.u_px + off, pixel.v_px - off))
                };
                Some(corners.iter().map(pixel).collect())
            };
            HeadView {
                name: format!("view {k}"),
                posture: posture.clone(),
                left: seen(Eye::Left),
                right: seen(Eye::Right),
            }
        })
        .collect();
    let solved = calibrate_mount(
        &rig,
        &cameras,
        &views,
        &Target::UnknownBoard(board),
        &MountOptions::default(),
        &Unattended,
    )?;
    Ok(solved.write(&folder.join("mount/mount.toml"))?)
}

fn save(folder: &Path, path: &str, image: &GrayImage) -> Result<(), Problem> {
    let mut bytes = std::io::Cursor::new(vec![]);
    image.write_to(&mut bytes, image::ImageFormat::Png)?;
    put(folder, path, bytes.into_inner())?;
    Ok(())
}
