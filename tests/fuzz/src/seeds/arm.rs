//! What verbs of the arm read: a session, models of the robot, targets, correction models, tables.

use std::path::Path;

use jiff::Timestamp;
use nalgebra::{Isometry3, Vector3};
use plumbline_correction::tables::{HeightPoint, HeightTable, YawPoint, YawTable};
use plumbline_correction::{CorrectionModel, Method, TouchData, TrainOptions, train};
use plumbline_effects::RigModel;
use plumbline_effects::rig_model::{Addition, ModelEffect, PlacedScreen};
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::session::{
    Chain, External, LocalizationRow, LocalizationTable, Manifest, PoseRow, PoseTable, RigReference, Screen,
    StereoImages, TouchRow, TouchTable,
};
use plumbline_model::touchscreen::place_screen;
use plumbline_model::{Pixel, Point, Robot, Session, Unattended};

use super::{Problem, all, put};
use crate::dice::Dice;

const JOINTS: [&str; 6] = ["r_shoulder_z", "r_shoulder_y", "r_arm_x", "r_elbow_y", "r_wrist_z", "r_wrist_x"];
/// A posture with the fingertip near the screen, and how far others go from it, rad.
const BASE: [f64; 6] = [-0.03, 0.31, 0.44, 1.55, 1.07, 0.73];
const SPREAD: [f64; 6] = [0.35, 0.0, 0.12, 0.25, 0.3, 0.15];
const TIP: &str = "right_index_tip";

pub fn make(folder: &Path) -> Result<(), Problem> {
    let rig = Rig::built_in("nico")?;
    let mut dice = Dice::new(1, "arm", 0);
    let long = session(&rig, &mut dice, 22)?;
    long.write(&folder.join("arm/session"))?;
    let short = Session { poses: None, localizations: None, ..session(&rig, &mut dice, 13)? };
    short.write(&folder.join("arm/short"))?;
    let own_rig = RigReference::File("nico/rig.toml".into());
    let with_rig = Session { manifest: Manifest { rig: own_rig, ..short.manifest.clone() }, ..short };
    with_rig.write(&folder.join("arm/own-rig"))?;
    for (name, content) in [
        ("rig.toml", include_str!("../../../../assets/robots/nico/rig.toml")),
        ("nico.urdf", include_str!("../../../../assets/robots/nico/nico.urdf")),
    ] {
        put(folder, &format!("arm/own-rig/nico/{name}"), content)?;
    }
    put(folder, "arm/small.urdf", SMALL_URDF)?;
    put(folder, "arm/measured.toml", "name = \"small\"\ndescription = \"small.urdf\"\n")?;
    put(folder, "arm/targets.csv", "x_m,y_m,z_m\n0.35,-0.1,0.06\n0.4,0.0,0.06\n")?;
    put(folder, "arm/turned.csv", "x_m,y_m,z_m,roll_rad,pitch_rad,yaw_rad\n0.35,-0.1,0.08,0.1,0.2,-0.3\n")?;
    put(folder, "arm/pixels.csv", "u_px,v_px\n900,500\n1000.5,600\n")?;
    all([
        &|| Ok(rig_model(&rig, &long)?.write(&folder.join("arm/rig-model.toml"), &rig)?),
        &|| placement(folder, &rig, &long),
        &|| models(folder, &long),
        &|| tables(folder),
    ])
}

fn session(rig: &Rig, dice: &mut Dice, places: usize) -> Result<Session, Problem> {
    let joints: Vec<String> = JOINTS.iter().map(ToString::to_string).collect();
    let screen = rig.touchscreen.clone();
    let chain = rig.chain(TIP)?;
    let indices: Vec<_> =
        JOINTS.iter().map(|joint| rig.description.find_joint(joint)).collect::<Result<_, _>>()?;
    let (mut touches, mut poses) = (vec![], vec![]);
    let mut place = 0;
    while place < places {
        let angles: Vec<f64> = (0..6).map(|j| BASE[j] + SPREAD[j] * dice.around()).collect();
        // The true elbow is off, so that there is a gap to find.
        let mut posture: Posture = rig.home();
        for ((index, angle), joint) in indices.iter().zip(&angles).zip(JOINTS) {
            posture[*index] = angle + if joint == "r_elbow_y" { 0.03 } else { 0.0 };
        }
        let tip = chain.robot_from_tip_in(&posture).isometry.translation.vector;
        let pixel = screen.pixel_at(Point::<Robot>::new(tip.x, tip.y, tip.z));
        if !(100.0..1800.0).contains(&pixel.u_px) || !(100.0..950.0).contains(&pixel.v_px) {
            continue;
        }
        for repeat in 0..2 {
            let noise = |dice: &mut Dice| 0.0008 * dice.around();
            let touched = tip + Vector3::new(noise(dice), noise(dice), noise(dice));
            let pixel = screen.pixel_at(Point::<Robot>::new(touched.x, touched.y, touched.z));
            let angles: Vec<Option<f64>> = angles.iter().copied().map(Some).collect();
            touches.push(TouchRow {
                commanded_rad: angles.clone(),
                encoder_rad: angles.clone(),
                touch: Some(pixel),
                group: Some(format!("p{place}")),
                approach: Some(["plus", "minus"][place % 2].to_owned()),
                set: Some(format!("s{}", place / 6)),
                screen_height_m: Some(0.0),
                payload_kg: Some(if place == 3 { 0.25 } else { 0.0 }),
                move_secs: Some(2.0),
                t_secs: Some((10 * place + 3 * repeat) as f64),
                target: None,
                temperature_c: vec![Some(31.5); 6],
                load: vec![Some(0.1); 6],
            });
            if place < 12 {
                poses.push(PoseRow {
                    commanded_rad: angles,
                    measured: Some(Point::<External>::new(touched.x + 1.0, touched.y, touched.z)),
                    payload_kg: Some(0.0),
                    group: Some(format!("p{place}")),
                    set: Some(format!("s{}", place / 6)),
                    ..PoseRow::default()
                });
            }
        }
        place += 1;
    }
    let seen: Vec<LocalizationRow> = (0..10)
        .map(|k| {
            let at = Point::<Robot>::new(0.3 + 0.02 * f64::from(k), 0.1 * dice.around(), 0.05);
            let estimate = Point::new(at.coords.x + 0.01, at.coords.y - 0.004, at.coords.z + 0.01);
            LocalizationRow {
                truth: Some(at),
                estimate: Some(estimate),
                head_rad: vec![Some(0.05 * f64::from(k)), Some(-0.5)],
                object: Some("Tomato".to_owned()),
                set: Some(format!("s{}", k / 4)),
                valid: k != 3,
                ..LocalizationRow::default()
            }
        })
        .collect();
    Ok(Session {
        manifest: Manifest {
            rig: RigReference::Named("nico".to_owned()),
            started: Timestamp::from_second(1_770_000_000)?,
            operator: "nobody".to_owned(),
            notes: "made up".to_owned(),
            touchscreen: Some(screen),
            chain: Some(Chain { tip: TIP.to_owned(), joints: joints.clone() }),
            extra: toml::Table::new(),
        },
        touches: Some(TouchTable::from_rows(joints.clone(), &touches)),
        localizations: Some(LocalizationTable::from_rows(
            vec!["head_z".to_owned(), "head_y".to_owned()],
            &seen,
        )),
        poses: Some(PoseTable::from_rows(joints, &poses)),
        stereo: StereoImages::default(),
        log: None,
    })
}

fn rig_model(rig: &Rig, session: &Session) -> Result<RigModel, Problem> {
    let effect = |id: &str, site: &str, values: Vec<f64>| ModelEffect {
        id: id.to_owned(),
        site: site.to_owned(),
        title: format!("{id} of {site}"),
        tip: Some(TIP.to_owned()),
        shape: None,
        reference_s: 0.0,
        covariance: vec![],
        values,
        probability: Some(0.9),
        parameters: vec![],
    };
    let screen = session.manifest.touchscreen.as_ref().ok_or("a session of touches has a screen")?;
    let moved = Isometry3::translation(0.001, 0.0, -0.002);
    let mut model = RigModel::nominal(rig);
    let mut addition = Addition {
        effects: vec![effect("joint-zero", "r_elbow_y", vec![0.03])],
        screens: vec![PlacedScreen::moved("session", screen, &moved)],
        externals: vec![],
        eyes: vec![],
        together: vec![],
        replaces: true,
        at: Timestamp::from_second(1_770_000_100)?,
        sentence: "made up".to_owned(),
        sessions: vec!["session".to_owned()],
        version: "0".to_owned(),
        gap: None,
    };
    model.add(rig, addition.clone())?;
    addition.replaces = false;
    addition.effects = vec![effect("joint-zero", "r_wrist_z", vec![-0.01])];
    model.add(rig, addition)?;
    Ok(model)
}

fn placement(folder: &Path, rig: &Rig, session: &Session) -> Result<(), Problem> {
    let screen = session.manifest.touchscreen.as_ref().ok_or("a session of touches has a screen")?;
    let touches: Vec<(Pixel<Screen>, Point<Robot>)> =
        [(100.0, 100.0), (1800.0, 120.0), (1700.0, 1000.0), (150.0, 950.0), (900.0, 500.0)]
            .into_iter()
            .map(|(u, v)| {
                let pixel = Pixel::new(u, v);
                let at = screen.point_at(pixel).coords;
                (pixel, Point::new(at.x + 0.002, at.y + 1e-6 * u, at.z + 0.001))
            })
            .collect();
    let placement = place_screen(screen, &touches)?.of_rig(&rig.name);
    Ok(placement.write(&folder.join("arm/placement.toml"))?)
}

fn models(folder: &Path, session: &Session) -> Result<(), Problem> {
    std::fs::create_dir_all(folder.join("models"))?;
    let rig = Rig::built_in("nico")?;
    let data = TouchData::of_session(session, &rig.chain(TIP)?)?;
    let options = TrainOptions { members: 1, iterations: 20, folds: 2, ..TrainOptions::default() };
    for method in [Method::M1, Method::M2, Method::M3] {
        let model: CorrectionModel = train(&data, method, &options, &Unattended, &mut |_| {})?;
        let name = method.name().to_lowercase();
        model.write(&folder.join(format!("models/{name}.json")))?;
        if method != Method::M1 {
            model.write_onnx(&folder.join(format!("models/{name}.onnx")))?;
        }
    }
    let matrix = |rows: usize, columns: usize| {
        (0..rows)
            .map(|i| (0..columns).map(|j| 0.01 * (i as f64) - 0.02 * (j as f64)).collect())
            .collect::<Vec<Vec<f64>>>()
    };
    let weights = serde_json::json!([matrix(2, 16), vec![0.1; 16], matrix(16, 2), vec![0.2; 2]]);
    put(folder, "models/published.json", weights.to_string())?;
    Ok(())
}

fn tables(folder: &Path) -> Result<(), Problem> {
    std::fs::create_dir_all(folder.join("tables"))?;
    let places =
        (0..4).flat_map(|i| (0..3).map(move |j| (0.25 + 0.1 * f64::from(i), 0.15 * f64::from(j) - 0.15)));
    let heights =
        places.clone().map(|(x_m, y_m)| HeightPoint { x_m, y_m, height_m: 0.06 + 0.02 * x_m * y_m });
    HeightTable::new(heights.collect())?.write(&folder.join("tables/height.csv"))?;
    let yaws = places.map(|(x_m, y_m)| YawPoint { x_m, y_m, z_m: 0.1 + 0.1 * x_m, yaw_rad: y_m });
    YawTable::new(yaws.collect())?.write(&folder.join("tables/yaw.csv"))?;
    Ok(())
}

const SMALL_URDF: &str = r#"<robot name="small">
  <link name="base"><inertial><mass value="1.0"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="arm"><visual><geometry><cylinder radius="0.02" length="0.3"/></geometry></visual>
    <collision><origin xyz="0 0 0.15"/><geometry><box size="0.04 0.04 0.3"/></geometry></collision></link>
  <link name="tip"/>
  <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.1" rpy="0 0.1 0"/>
    <axis xyz="0 1 0"/><limit lower="-1.5" upper="1.5" effort="2" velocity="1"/></joint>
  <joint name="end" type="fixed"><parent link="arm"/><child link="tip"/><origin xyz="0 0 0.3"/></joint>
</robot>
"#;
