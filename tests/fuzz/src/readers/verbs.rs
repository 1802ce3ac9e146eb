//! Whole verbs on small folders in which one file is changed.

use std::path::Path;

use plumbline_correction::Method;
use plumbline_model::{InnerCorners, ModelKind, Unattended};
use plumbline_offline::{
    CalibrateArgs, CheckArgs, CorrectArgs, DetectEvalArgs, DisparityArgs, GapArgs, IkArgs, LocateArgs,
    LocateEyes, PredictArgs, Split, TrainArgs, calibrate_stereo, check, correct, detect_eval, disparity, gap,
    ik, locate, predict, scores, train,
};
use plumbline_vision::detect::DetectorOptions;

use super::{Reader, one};
use crate::check::Heard;

const ARM: &[&str] = &["arm/short/", "arm/rig-model.toml"];
const OWN: &[&str] = &["arm/own-rig/"];

pub fn readers() -> Vec<Reader> {
    vec![
        one("verb-predict", &["arm/session/", "arm/rig-model.toml"], 40, |folder| {
            predicted(folder, "arm/session", Some("arm/rig-model.toml"))
        }),
        one("verb-predict-placed", &["arm/short/", "arm/placement.toml"], 15, |folder| {
            predicted(folder, "arm/short", Some("arm/placement.toml"))
        }),
        one("verb-predict-own-rig", OWN, 30, |folder| predicted(folder, "arm/own-rig", None)),
        one("verb-train", &["arm/short/"], 12, |folder| trained(folder, Method::M1)),
        one("verb-train-network", &["arm/short/"], 1, |folder| trained(folder, Method::M3)),
        one("verb-correct", &["models/m1.json", "arm/pixels.csv"], 25, |folder| {
            corrected(folder, "models/m1.json")
        }),
        one("verb-correct-network", &["models/m3.json", "arm/pixels.csv"], 15, |folder| {
            corrected(folder, "models/m3.json")
        }),
        one("verb-ik", &["arm/targets.csv", "arm/rig-model.toml", "arm/own-rig/nico/"], 25, |folder| {
            solved(folder, "arm/targets.csv", false)
        }),
        one("verb-ik-turned", &["arm/turned.csv", "arm/rig-model.toml", "arm/own-rig/nico/"], 15, |folder| {
            solved(folder, "arm/turned.csv", true)
        }),
        one("verb-gap", ARM, 3, |folder| {
            let args = GapArgs {
                sessions: vec![folder.join("arm/short")],
                rig_model: Some(folder.join("arm/rig-model.toml")),
                seed: 1,
                add_to: Some(folder.join("out-model.toml")),
                report: Some(folder.join("out.html")),
            };
            gap(&args, &Unattended).map(|report| report.sentence).into()
        }),
        one("verb-gap-own-rig", OWN, 2, |folder| {
            let args = GapArgs {
                sessions: vec![folder.join("arm/own-rig")],
                rig_model: None,
                seed: 1,
                add_to: None,
                report: None,
            };
            gap(&args, &Unattended).map(|report| report.sentence).into()
        }),
        Reader {
            changed: &["views/cameras.yaml", "views/points.csv"],
            ..one("verb-locate", &["views/"], 30, located)
        },
        one("verb-locate-images", &["views/"], 15, located),
        Reader {
            changed: &["views/cameras.yaml"],
            ..one("verb-disparity", &["views/"], 25, |folder| matched(folder, true))
        },
        one("verb-disparity-rectified", &["views/left.png", "views/right.png"], 15, |folder| {
            matched(folder, false)
        }),
        one("verb-calibrate", &["boards/left/", "boards/right/"], 2, |folder| {
            let args = CalibrateArgs {
                left: folder.join("boards/left"),
                right: folder.join("boards/right"),
                board: InnerCorners { columns: 8, rows: 5 },
                square_m: 0.03,
                model: ModelKind::Fisheye,
                exclude: vec![],
                out: Some(folder.join("out.yaml")),
            };
            calibrate_stereo(&args, &Unattended).into()
        }),
        Reader {
            changed: &["boards/cameras.yaml"],
            ..one("verb-check", &["boards/"], 4, |folder| {
                let args = CheckArgs {
                    cameras: vec![folder.join("boards/cameras.yaml")],
                    left: folder.join("boards/left"),
                    right: folder.join("boards/right"),
                    board: InnerCorners { columns: 8, rows: 5 },
                    square_m: 0.03,
                    exclude: vec![],
                };
                check(&args, &Unattended).into()
            })
        },
        one("verb-detect-eval", &["detectors/seeing.onnx", "labels/"], 6, |folder| {
            let args = DetectEvalArgs {
                models: vec![folder.join("detectors/seeing.onnx")],
                data: folder.join("labels/data.yaml"),
                split: Split::Train,
                csv: Some(folder.join("out.csv")),
                matrices: Some(folder.join("out-matrices")),
                options: DetectorOptions { threads: Some(1), ..DetectorOptions::default() },
                judging: scores::EvaluateOptions::default(),
            };
            match detect_eval(&args, &Unattended) {
                Ok(report) => Heard::accepted(&report).and(report.problems).and(report.notes),
                Err(error) => Heard::refused(error),
            }
        }),
    ]
}

fn predicted(folder: &Path, session: &str, rig_model: Option<&str>) -> Heard {
    let args =
        PredictArgs { session: folder.join(session), rig_model: rig_model.map(|file| folder.join(file)) };
    predict(&args, &Unattended).into()
}

fn trained(folder: &Path, method: Method) -> Heard {
    let args = TrainArgs {
        session: folder.join("arm/short"),
        method,
        out: folder.join("out.json"),
        seed: 1,
        published_recipe: false,
    };
    match train(&args, &Unattended) {
        Ok(report) => Heard::accepted(&report).and(report.left_out),
        Err(error) => Heard::refused(error),
    }
}

fn corrected(folder: &Path, model: &str) -> Heard {
    let args = CorrectArgs { model: folder.join(model), points: folder.join("arm/pixels.csv") };
    match correct(&args, &Unattended) {
        Ok(report) => Heard::accepted(&report).and(report.remarks),
        Err(error) => Heard::refused(error),
    }
}

fn solved(folder: &Path, targets: &str, own_rig: bool) -> Heard {
    let file = folder.join("arm/own-rig/nico/rig.toml");
    let args = IkArgs {
        rig: if own_rig { file.display().to_string() } else { "nico".to_owned() },
        tip: "right_index_tip".to_owned(),
        targets: folder.join(targets),
        upright: false,
        rig_model: Some(folder.join("arm/rig-model.toml")),
    };
    ik(&args, &Unattended).into()
}

fn located(folder: &Path) -> Heard {
    let args = LocateArgs {
        eyes: LocateEyes::Calibrated { cameras: vec![folder.join("views/cameras.yaml")], robot: None },
        left: folder.join("views/left.png"),
        right: folder.join("views/right.png"),
        points: folder.join("views/points.csv"),
    };
    match locate(&args, &Unattended) {
        Ok(report) => {
            let reasons: Vec<String> =
                report.points.iter().filter_map(|point| point.reason.clone()).collect();
            Heard::accepted(&report).and(report.notes).and(reasons)
        }
        Err(error) => Heard::refused(error),
    }
}

fn matched(folder: &Path, with_cameras: bool) -> Heard {
    let args = DisparityArgs {
        left: folder.join("views/left.png"),
        right: folder.join("views/right.png"),
        cameras: if with_cameras { vec![folder.join("views/cameras.yaml")] } else { vec![] },
        max_disparity_px: 32,
        out: Some(folder.join("out.pfm")),
    };
    match disparity(&args, &Unattended) {
        Ok(report) => Heard::accepted(&report).and(report.notes),
        Err(error) => Heard::refused(error),
    }
}
