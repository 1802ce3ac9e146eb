//! Sessions, robots, models of robots, correction models, tables.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use plumbline_correction::CorrectionModel;
use plumbline_correction::tables::{HeightTable, YawTable};
use plumbline_effects::{Measurements, RigModel};
use plumbline_gap::Finding;
use plumbline_model::robot::Rig;
use plumbline_model::robot::collision::CollisionModel;
use plumbline_model::session::{LocalizationTable, Manifest, PoseTable, TouchTable};
use plumbline_model::touchscreen::ScreenPlacement;
use plumbline_model::{Pixel, Session};
use plumbline_report::sample;

use super::{Reader, one};
use crate::check::Heard;

pub fn readers() -> Vec<Reader> {
    vec![
        one("manifest", &["arm/session/session.toml"], 30, |folder| {
            Manifest::read(&folder.join("arm/session/session.toml")).into()
        }),
        one("touches", &["arm/short/touches.csv"], 30, |folder| {
            TouchTable::read(&folder.join("arm/short/touches.csv"), &joints()).into()
        }),
        one("poses", &["arm/session/poses.csv"], 20, |folder| {
            PoseTable::read(&folder.join("arm/session/poses.csv"), &joints()).into()
        }),
        one("localizations", &["arm/session/localizations.csv"], 20, |folder| {
            LocalizationTable::read(&folder.join("arm/session/localizations.csv")).into()
        }),
        one("session", &["arm/session/"], 40, session),
        one("rig", &["arm/own-rig/nico/"], 40, rig),
        one("measured-rig", &["arm/measured.toml", "arm/small.urdf"], 30, |folder| {
            used(Rig::read_measured(&folder.join("arm/measured.toml")))
        }),
        one("urdf", &["arm/small.urdf"], 50, |folder| {
            used(Rig::read_measured(&folder.join("arm/small.urdf")))
        }),
        one("rig-model", &["arm/rig-model.toml"], 40, |folder| {
            RigModel::read(&folder.join("arm/rig-model.toml"), &nico()).into()
        }),
        one("placement", &["arm/placement.toml"], 30, |folder| {
            ScreenPlacement::read(&folder.join("arm/placement.toml"), "nico").into()
        }),
        Reader {
            finite: false,
            ..one("correction-m1", &["models/m1.json"], 30, |folder| {
                correction(&folder.join("models/m1.json"))
            })
        },
        Reader {
            finite: false,
            ..one("correction-m2", &["models/m2.json"], 20, |folder| {
                correction(&folder.join("models/m2.json"))
            })
        },
        Reader {
            finite: false,
            ..one("correction-m3", &["models/m3.json"], 30, |folder| {
                correction(&folder.join("models/m3.json"))
            })
        },
        Reader {
            finite: false,
            ..one("correction-onnx", &["models/m2.onnx"], 30, |folder| {
                correction(&folder.join("models/m2.onnx"))
            })
        },
        Reader {
            finite: false,
            ..one("correction-published", &["models/published.json"], 20, |folder| {
                correction(&folder.join("models/published.json"))
            })
        },
        one("height-table", &["tables/height.csv"], 30, height),
        one("yaw-table", &["tables/yaw.csv"], 30, yaw),
        one("finding", &["finding/named.json"], 20, |folder| finding(&folder.join("finding/named.json"))),
        one("finding-pixels", &["finding/pixels.json"], 10, |folder| {
            finding(&folder.join("finding/pixels.json"))
        }),
    ]
}

/// The robot that comes with the program.
pub fn nico() -> Arc<Rig> {
    static RIG: OnceLock<Arc<Rig>> = OnceLock::new();
    RIG.get_or_init(|| Arc::new(Rig::built_in("nico").expect("comes with the program"))).clone()
}

fn joints() -> Vec<String> {
    ["r_shoulder_z", "r_shoulder_y", "r_arm_x", "r_elbow_y", "r_wrist_z", "r_wrist_x"]
        .map(str::to_owned)
        .to_vec()
}

/// What is read of a session is also put into the rows that everything else works on.
fn session(folder: &Path) -> Heard {
    match Session::read(&folder.join("arm/session")) {
        Err(error) => Heard::refused(error),
        Ok(session) => {
            let heard = Heard::accepted(&session);
            match Measurements::of_sessions(&[("session".to_owned(), session)], &nico()) {
                Ok(measurements) => heard.and(measurements.remarks()),
                Err(error) => heard.and([error]),
            }
        }
    }
}

fn rig(folder: &Path) -> Heard {
    used(Rig::read(&folder.join("arm/own-rig/nico/rig.toml")))
}

/// A robot is also put into its first pose and looked at for collisions.
fn used(rig: Result<Rig, plumbline_model::robot::RigError>) -> Heard {
    match rig {
        Err(error) => Heard::refused(error),
        Ok(rig) => {
            let home = rig.home();
            let poses = rig.description.forward(&home);
            let solids = CollisionModel::of_rig(&rig);
            Heard::accepted((
                rig.description.joints(),
                poses.all(),
                solids.check_posture(&home, &[]).map(|_| "looked at").map_err(|error| error.to_string()),
            ))
        }
    }
}

/// A model is also asked.
fn correction(file: &Path) -> Heard {
    match CorrectionModel::import(file) {
        Err(error) => Heard::refused(error),
        Ok(model) => {
            let answers: Vec<_> = [(0.0, 0.0), (900.0, 500.0), (-1e9, 1e9)]
                .map(|(u, v)| model.correct(Pixel::new(u, v)).target)
                .to_vec();
            Heard::accepted((answers, model.provenance(), model.network_shape()))
        }
    }
}

fn height(folder: &Path) -> Heard {
    match HeightTable::read(&folder.join("tables/height.csv")) {
        Err(error) => Heard::refused(error),
        Ok(table) => Heard::from(table.interpolate(0.35, 0.0)).and(table.leave_one_out().err()),
    }
}

fn yaw(folder: &Path) -> Heard {
    match YawTable::read(&folder.join("tables/yaw.csv")) {
        Err(error) => Heard::refused(error),
        Ok(table) => Heard::from(table.interpolate(0.35, 0.0, 0.12)).and(table.leave_one_out().err()),
    }
}

/// A finding is also put on a page.
fn finding(file: &Path) -> Heard {
    match Finding::read(file) {
        Err(error) => Heard::refused(error),
        Ok(finding) => {
            let context = sample::context();
            let page = plumbline_report::html(&finding, &context).len();
            match plumbline_report::pdf(&finding, &context) {
                Ok(pdf) => Heard::accepted((page, pdf.len())),
                Err(error) => Heard::refused(error),
            }
        }
    }
}
