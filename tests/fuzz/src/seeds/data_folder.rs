//! The operator's data folder, as the program keeps it.

use std::path::Path;

use super::{Problem, put};

pub fn make(folder: &Path) -> Result<(), Problem> {
    put(folder, "data/poses/nico.toml", POSES)?;
    put(folder, "data/detection.json", DETECTION)?;
    put(folder, "data/sessions/one/progress.json", PROGRESS)?;
    for name in ["session.toml", "touches.csv"] {
        let content = std::fs::read(folder.join("arm/short").join(name))?;
        put(folder, &format!("data/sessions/one/{name}"), content)?;
    }
    put(folder, "data/rig-model.toml", std::fs::read(folder.join("arm/rig-model.toml"))?)?;
    put(folder, "data/screen-placement.toml", std::fs::read(folder.join("arm/placement.toml"))?)?;
    Ok(())
}

const POSES: &str = "[[pose]]\ntitle = \"Wave\"\njoints_rad = { r_elbow_y = 1.2, r_wrist_z = 0.4 }\n\n[[pose]]\n\
title = \"Rest\"\njoints_rad = { r_shoulder_y = 0.1 }\n";

const DETECTION: &str = r#"{"confidence":0.4,"iou":0.6,"hidden":[],"class_confidence":{"Tomato":0.5}}"#;

const PROGRESS: &str = r#"{"format":1,"purpose":"train","started":"2026-01-01T00:00:00Z","planned":10,"finished":true,
"prepared":[0.0,0.0],"records":[],"ended":{},"again":[],"gave_placement":null}"#;
