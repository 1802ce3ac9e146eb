//! Editing the tables of grasp height and yaw.

use plumbline_correction::tables::{HeightTable, YawPoint, YawTable};

use super::*;
use crate::models::command::{GraspTable, TablesCommand};
use crate::models::tables::Tables;

const HEIGHT: GraspTable = GraspTable::Height;

fn tell(lab: &mut Lab, command: TablesCommand) -> Arc<crate::models::view::TablesView> {
    lab.tell(ModelsCommand::Tables(command)).tables.clone()
}

/// A smooth bowl of 5 × 4 points.
fn fill(lab: &mut Lab) {
    for i in 0..5 {
        for j in 0..4 {
            let (x_m, y_m) = (0.25 + 0.06 * f64::from(i), -0.3 + 0.1 * f64::from(j));
            let value = 0.1 + 0.2 * (x_m - 0.37).powi(2) + 0.1 * y_m * y_m;
            tell(lab, TablesCommand::Add { table: HEIGHT, at_m: [x_m, y_m, 0.0], value });
        }
    }
}

#[test]
fn points_are_added_changed_removed_and_every_change_is_taken_back() {
    let mut lab = Lab::new();
    fill(&mut lab);
    let filled = lab.view().tables.clone();
    assert_eq!(filled.height.as_ref().map(|table| table.points.len()), Some(20));
    assert_eq!(filled.height_errors_m.len(), 20);
    assert!(
        filled.height_errors_m.iter().all(|error_m| error_m.abs() < 0.02),
        "{:?}",
        filled.height_errors_m
    );
    assert!(filled.height_field.values_m.iter().any(Option::is_some));
    let change = TablesCommand::Change { table: HEIGHT, point: 5, at_m: [0.315, -0.2, 0.0], value: 0.2 };
    let changed = tell(&mut lab, change);
    let point = changed.height.as_ref().expect("a table").points[5];
    assert_eq!((point.x_m, point.y_m, point.height_m), (0.315, -0.2, 0.2));
    let worst = changed.height_errors_m.iter().map(|error_m| error_m.abs()).fold(0.0, f64::max);
    assert!(worst == changed.height_errors_m[5].abs() && worst > 0.03, "{:?}", changed.height_errors_m);
    tell(&mut lab, TablesCommand::Remove { table: HEIGHT, point: 5 });
    // Fifty steps and more go back.
    let mut back = lab.view().tables.clone();
    for _ in 0..22 {
        assert!(back.can_undo);
        back = tell(&mut lab, TablesCommand::Undo);
    }
    assert!(back.height.is_none() && !back.can_undo);
    tell(&mut lab, TablesCommand::Undo);
    assert!(lab.said().contains("no change"), "{}", lab.said());
}

#[test]
fn tables_are_kept_and_come_back_after_a_restart() {
    let mut lab = Lab::new();
    fill(&mut lab);
    let kept = lab.view().tables.clone();
    let mut lab = lab.restarted();
    let back = lab.view().tables.clone();
    assert_eq!(back.height, kept.height);
    assert_eq!((&back.height_errors_m, &back.height_field), (&kept.height_errors_m, &kept.height_field));
    assert!(HeightTable::read(&lab.path("tables/height.csv")).is_ok());
}

#[test]
fn edits_that_come_faster_than_they_are_kept_are_kept_in_the_end() {
    let mut lab = Lab::new();
    for i in 0..6_u8 {
        let at_m = [0.3 + 0.01 * f64::from(i), 0.02 * f64::from(i % 2), 0.0];
        let add = TablesCommand::Add { table: HEIGHT, at_m, value: 0.1 };
        lab.state.apply(Command::Models(ModelsCommand::Tables(add)));
    }
    lab.work(&Unattended);
    let kept = HeightTable::read(&lab.path("tables/height.csv")).expect("kept");
    assert_eq!(kept.points.len(), 6);
}

#[test]
fn tables_are_read_and_written_as_files() {
    let mut lab = Lab::new();
    let file = lab.path("yaw.csv");
    let yaws = "x_m,y_m,z_m,yaw_rad\n0.2,-0.3,0.05,-0.5\n0.4,-0.3,0.05,-0.2\n0.2,0.1,0.05,0.4\n0.4,0.1,0.08,0.6\n0.3,-0.1,0.08,0.1\n";
    std::fs::write(&file, yaws).expect("written");
    let read = tell(&mut lab, TablesCommand::Import { table: GraspTable::Yaw, file });
    assert_eq!(read.yaw.as_ref().map(|table| table.points.len()), Some(5));
    assert_eq!(read.yaw_errors_rad.len(), 5);
    let out = lab.path("out.csv");
    tell(&mut lab, TablesCommand::Export { table: GraspTable::Yaw, file: out.clone() });
    assert!(std::fs::read_to_string(&out).expect("written").starts_with("x_m,y_m,z_m,yaw_rad\n0.2,-0.3"));
    tell(&mut lab, TablesCommand::Export { table: HEIGHT, file: out.clone() });
    assert!(lab.said().contains("no points"), "{}", lab.said());
    tell(&mut lab, TablesCommand::Import { table: HEIGHT, file: out });
    assert!(lab.said().contains("line 1"), "{}", lab.said());
    assert!(lab.view().tables.height.is_none());
}

/// A file of yaw at one height: `count` points, all with this value.
fn yaw_file(lab: &Lab, z_m: f64, count: u32, yaw_rad: f64) -> PathBuf {
    let place = |i: u32| (0.2 + 0.05 * f64::from(i % 4), -0.3 + 0.05 * f64::from(i));
    let point = |i: u32| {
        let (x_m, y_m) = place(i);
        YawPoint { x_m, y_m, z_m, yaw_rad }
    };
    let file = lab.path("layer.csv");
    YawTable::new((0..count).map(point).collect()).expect("a good table").write(&file).expect("written");
    file
}

#[test]
fn yaw_is_brought_together_from_files_of_one_height_each() {
    let mut lab = Lab::new();
    let import = |lab: &mut Lab, z_m: f64, count: u32, yaw_rad: f64| {
        let file = yaw_file(lab, z_m, count, yaw_rad);
        let read = tell(lab, TablesCommand::Import { table: GraspTable::Yaw, file });
        (read.yaw.as_ref().map_or(0, |table| table.points.len()), lab.said())
    };
    let first = "Yaw table: 6 points at 70 mm read, 0 at other heights kept.";
    assert_eq!(import(&mut lab, 0.07, 6, 0.1), (6, first.to_owned()));
    let second = "Yaw table: 5 points at 120 mm read, 6 at other heights kept.";
    assert_eq!(import(&mut lab, 0.12, 5, 0.2), (11, second.to_owned()));
    let told = lab.whole_view().notices.iter().filter(|notice| notice.text.contains("read")).count();
    assert_eq!(told, 2, "each import is told once");
    // 1 mm beside is the same height, more is another one.
    let again = "Yaw table: 4 points at 71 mm read, 6 replaced, 5 at other heights kept.";
    assert_eq!(import(&mut lab, 0.071, 4, 0.3), (9, again.to_owned()));
    let beside = "Yaw table: 4 points at 72.2 mm read, 9 at other heights kept.";
    assert_eq!(import(&mut lab, 0.0722, 4, 0.4), (13, beside.to_owned()));
    let tables = lab.view().tables.clone();
    let yaws = |z_m: f64| -> Vec<f64> {
        let points = &tables.yaw.as_ref().expect("a table").points;
        points.iter().filter(|point| point.z_m == z_m).map(|point| point.yaw_rad).collect()
    };
    assert_eq!((yaws(0.12), yaws(0.071), yaws(0.07)), (vec![0.2; 5], vec![0.3; 4], vec![]));
    assert_eq!(tables.yaw_errors_rad.len(), 13, "the whole can be used");
    let back = tell(&mut lab, TablesCommand::Undo);
    assert_eq!(back.yaw.as_ref().map(|table| table.points.len()), Some(9));
}

#[test]
fn an_import_of_heights_replaces_them_all_and_leaves_yaw_alone() {
    let mut lab = Lab::new();
    fill(&mut lab);
    let file = yaw_file(&lab, 0.07, 6, 0.1);
    tell(&mut lab, TablesCommand::Import { table: GraspTable::Yaw, file });
    let file = lab.path("heights.csv");
    std::fs::write(&file, "x_m,y_m,height_m\n0.2,-0.3,0.1\n0.4,-0.3,0.1\n0.2,0.1,0.1\n0.4,0.1,0.12\n")
        .expect("written");
    let read = tell(&mut lab, TablesCommand::Import { table: HEIGHT, file });
    assert_eq!(read.height.as_ref().map(|table| table.points.len()), Some(4));
    assert_eq!(read.yaw.as_ref().map(|table| table.points.len()), Some(6));
    assert_eq!(lab.said(), "The height table was read: 4 points.");
}

#[test]
fn the_published_yaw_files_make_one_table_in_any_order() {
    let folder = match plumbline_model::measured_data::folder("nico-tables") {
        Ok(folder) => folder,
        Err(reason) => return eprintln!("{reason}"),
    };
    let mut lab = Lab::new();
    for name in ["rh_yaw_z10.csv", "rh_yaw_z5.csv", "rh_yaw_z15.csv", "rh_yaw_z5.csv"] {
        tell(&mut lab, TablesCommand::Import { table: GraspTable::Yaw, file: folder.join(name) });
    }
    assert_eq!(lab.said(), "Yaw table: 47 points at 70 mm read, 47 replaced, 85 at other heights kept.");
    let tables = lab.view().tables.clone();
    let table = tables.yaw.clone().expect("a table");
    assert_eq!((table.points.len(), tables.yaw_errors_rad.len()), (132, 132));
    assert!(tables.remarks.is_empty(), "{:?}", tables.remarks);
}

#[test]
fn changes_that_cannot_be_are_refused_and_change_nothing() {
    let mut lab = Lab::new();
    fill(&mut lab);
    let before = lab.view().tables.height.clone();
    for (command, said) in [
        (TablesCommand::Add { table: HEIGHT, at_m: [0.25, -0.3, 0.0], value: 0.1 }, "at this place already"),
        (TablesCommand::Add { table: HEIGHT, at_m: [f64::NAN, 0.0, 0.0], value: 0.1 }, "x_m"),
        (TablesCommand::Remove { table: HEIGHT, point: 20 }, "no point 20"),
        (
            TablesCommand::Change { table: GraspTable::Yaw, point: 0, at_m: [0.0; 3], value: 0.1 },
            "no point 0",
        ),
        (TablesCommand::AddHere { table: HEIGHT }, "Connect to the robot"),
    ] {
        tell(&mut lab, command);
        assert!(lab.said().contains(said), "{}", lab.said());
        assert_eq!(lab.view().tables.height, before);
    }
}

#[test]
fn a_table_of_few_points_says_that_it_cannot_be_used_yet() {
    let mut lab = Lab::new();
    let add = |x_m: f64| TablesCommand::Add { table: HEIGHT, at_m: [x_m, 0.0, 0.0], value: 0.1 };
    tell(&mut lab, add(0.3));
    let two = tell(&mut lab, add(0.4));
    assert!(two.height_errors_m.is_empty() && two.remarks.len() == 1, "{:?}", two.remarks);
    let one = tell(&mut lab, TablesCommand::Remove { table: HEIGHT, point: 0 });
    assert_eq!(one.height.as_ref().map(|table| table.points.len()), Some(1));
}

#[test]
fn the_palm_is_where_the_kinematics_put_it() {
    let rig = nico();
    let posture = rig.home();
    let (place, yaw_rad) = crate::models::tables::palm(&rig, Some(&posture)).expect("known");
    let chain = rig.chain("right_palm_center").expect("a tip");
    let there = chain.robot_from_tip_in(&posture);
    assert_eq!(place, <[f64; 3]>::from(there.translation_m()));
    let heading = there.isometry.rotation * Vector3::x();
    assert!((heading.x.atan2(heading.y) + yaw_rad - std::f64::consts::FRAC_PI_2).sin().abs() < 1e-12);
    assert!(crate::models::tables::palm(&rig, None).is_none());
    assert!(Tables::default().height.is_none());
}
