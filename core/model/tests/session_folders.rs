//! Session folders: what is written comes back, unknown things are kept, and what cannot be
//! used says file, line and column.

mod common;

use std::fs;
use std::path::{Path, PathBuf};

use plumbline_model::frame::Robot;
use plumbline_model::session::{
    Chain, LocalizationRow, LocalizationTable, Manifest, PoseRow, PoseTable, RigReference, TouchRow,
    TouchTable, Touchscreen,
};
use plumbline_model::{Direction, Eye, Pixel, Point, Session, SessionError, measured_data};

const MANIFEST: &str = "format = 1\nrig = \"nico\"\nstarted = 2026-11-21T10:04:00Z\n[touchscreen]\nwidth_px = 1920\nheight_px = 1080\nwidth_m = 0.475\nheight_m = 0.267\norigin_m = [0.53, 0.2375, 0.056]\nu_axis = [0.0, -1.0, 0.0]\nv_axis = [-1.0, 0.0, 0.0]\n[chain]\ntip = \"right_index_tip\"\njoints = [\"a\", \"b\"]\n";
const TOUCHES: &str = "cmd_a_rad,cmd_b_rad,touch_u_px,touch_v_px\n0.1,0.2,960.0,540.5\n0.3,,,\n";

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder for the test")
}

fn put(folder: &Path, name: &str, text: &str) {
    let file = folder.join(name);
    fs::create_dir_all(file.parent().expect("inside the folder")).expect("made");
    fs::write(file, text).expect("written");
}

/// A session folder with these files.
fn session_of(files: &[(&str, &str)]) -> Result<Session, SessionError> {
    let folder = folder();
    for (name, text) in files {
        put(folder.path(), name, text);
    }
    Session::read(folder.path())
}

/// The session must be refused with a message that holds these words.
fn refused(files: &[(&str, &str)], words: &[&str]) {
    let error = session_of(files).expect_err("unusable").to_string();
    for word in words {
        assert!(error.contains(word), "\"{word}\" is not in: {error}");
    }
}

fn manifest() -> Manifest {
    let axis = |x, y, z| Direction::<Robot>::new(nalgebra::Vector3::new(x, y, z)).expect("not zero");
    Manifest {
        rig: RigReference::Named("nico".to_owned()),
        started: "2026-11-21T10:04:00.25Z".parse().expect("a time"),
        operator: "Ada \"the operator\"".to_owned(),
        notes: "two\nlines, Košice".to_owned(),
        touchscreen: Some(Touchscreen {
            width_px: 1920,
            height_px: 1080,
            width_m: 0.475,
            height_m: 0.1 / 3.0,
            origin: Point::new(0.53, 0.2375, 0.056),
            u_axis: axis(0.0, -1.0, 0.0),
            v_axis: axis(-1.0, 0.0, 0.0),
        }),
        chain: Some(Chain {
            tip: "right_index_tip".to_owned(),
            joints: vec!["a".to_owned(), "b".to_owned()],
        }),
        extra: toml::toml! {
            room = "3.14"
            weather = { sky = "gray", wind_m_per_s = 2.5 }
            [chain]
            note = "greased on Monday"
            [lighting]
            lamps = 3
            since = 2026-11-20T08:00:00Z
        },
    }
}

fn touches() -> Vec<TouchRow> {
    let complete = TouchRow {
        commanded_rad: vec![Some(0.1), Some(-1.0 / 3.0)],
        encoder_rad: vec![Some(0.11), None],
        touch: Some(Pixel::new(960.25, 1.0 / 7.0)),
        group: Some("g, with a comma".to_owned()),
        approach: Some("plus".to_owned()),
        set: Some("line \"3\"".to_owned()),
        screen_height_m: Some(0.05),
        payload_kg: Some(0.25),
        move_secs: Some(2.0),
        t_secs: Some(1e-7),
        target: Some(Point::new(0.3, -0.2, 0.056)),
        temperature_c: vec![Some(41.0), None],
        load: vec![None, Some(-0.2)],
    };
    let bare = TouchRow {
        commanded_rad: vec![Some(-1.0e-300), Some(0.0)],
        encoder_rad: vec![None; 2],
        temperature_c: vec![None; 2],
        load: vec![None; 2],
        ..TouchRow::default()
    };
    vec![complete, bare]
}

#[test]
fn a_session_comes_back() {
    let folder = folder();
    let joints = vec!["a".to_owned(), "b".to_owned()];
    let localization = LocalizationRow {
        truth: Some(Point::new(0.4, 0.1, 0.05)),
        estimate: Some(Point::new(0.41, 0.1, 1.0 / 30.0)),
        left: Some(Pixel::new(300.5, 200.0)),
        right: None,
        head_rad: vec![Some(0.0), Some(-0.25)],
        t_secs: Some(600.0),
        object: Some("tomato".to_owned()),
        background_m: Some(0.9),
        valid: false,
        ..LocalizationRow::default()
    };
    let valid = LocalizationRow {
        truth: Some(Point::new(0.2, 0.0, 0.05)),
        head_rad: vec![None, None],
        ..LocalizationRow::default()
    };
    let pose = PoseRow {
        commanded_rad: vec![Some(0.1), None],
        encoder_rad: vec![Some(0.1), Some(0.2)],
        measured: Some(Point::new(1.0, 2.0, 3.0)),
        torque_nm: vec![None, Some(1.5)],
        payload_kg: Some(0.0),
        ..PoseRow::default()
    };
    let session = Session {
        manifest: manifest(),
        touches: Some(TouchTable::from_rows(joints.clone(), &touches())),
        localizations: Some(LocalizationTable::from_rows(
            vec!["head_z".to_owned(), "head_y".to_owned()],
            &[localization.clone(), valid.clone()],
        )),
        poses: Some(PoseTable::from_rows(joints, std::slice::from_ref(&pose))),
        stereo: Default::default(),
        log: None,
    };
    session.write(folder.path()).expect("written");
    let back = Session::read(folder.path()).expect("read");
    assert_eq!(back, session);
    let rows = |table: &Option<TouchTable>| {
        table.iter().flat_map(|t| t.rows().collect::<Vec<_>>()).collect::<Vec<_>>()
    };
    assert_eq!(rows(&back.touches), touches());
    let localizations: Vec<_> = back.localizations.as_ref().expect("there").rows().collect();
    assert_eq!(localizations, [localization, valid]);
    assert_eq!(back.poses.as_ref().expect("there").row(0), Some(pose));
    assert_eq!(back.poses.as_ref().expect("there").row(1), None);
    assert_eq!(fs::read_dir(folder.path()).expect("readable").count(), 4, "nothing temporary remains");

    // Written once more, the files are the same.
    let text = |name: &str| fs::read_to_string(folder.path().join(name)).expect("readable");
    let names = ["session.toml", "touches.csv", "localizations.csv", "poses.csv"];
    let before = names.map(text);
    back.write(folder.path()).expect("written");
    assert_eq!(names.map(text), before);
}

#[test]
fn empty_cells_are_not_measured() {
    let session = session_of(&[("session.toml", MANIFEST), ("touches.csv", TOUCHES)]).expect("read");
    let table = session.touches.expect("there");
    assert_eq!(table.joints(), ["a", "b"]);
    assert_eq!(table.commanded_rad("a"), Some(&[Some(0.1), Some(0.3)][..]));
    assert_eq!(table.commanded_rad("b"), Some(&[Some(0.2), None][..]));
    assert_eq!(table.encoder_rad("a"), None);
    let rows: Vec<TouchRow> = table.rows().collect();
    assert_eq!(rows[0].touch, Some(Pixel::new(960.0, 540.5)));
    assert_eq!((rows[1].touch, rows[1].payload_kg), (None, None));
}

#[test]
fn spaces_around_a_label_do_not_make_another_label() {
    let table = TOUCHES.replacen('\n', ",set,group\n", 1);
    let lines = table.lines().enumerate().map(|(i, line)| match i {
        0 => line.to_owned(),
        _ => format!("{line}, grid ,  "),
    });
    let table = lines.collect::<Vec<_>>().join("\n");
    let session = session_of(&[("session.toml", MANIFEST), ("touches.csv", &table)]).expect("read");
    for row in session.touches.expect("there").rows() {
        assert_eq!((row.set.as_deref(), row.group), (Some("grid"), None));
    }
}

#[test]
fn unknown_columns_and_keys_are_kept() {
    let folder = folder();
    let table = "color,cmd_a_rad,cmd_b_rad,touch_u_px,touch_v_px,load_note\nred,0.1,0.2,1.0,2.0,\"x, y\"\n,0.1,0.2,1.0,2.0,007\n";
    put(folder.path(), "session.toml", &format!("{MANIFEST}\n[lighting]\nlamps = 3\n"));
    put(folder.path(), "touches.csv", table);
    let session = Session::read(folder.path()).expect("read");
    let colors = session.touches.as_ref().expect("there").table().texts("color").expect("kept");
    assert_eq!(colors, [Some("red".to_owned()), None]);
    session.write(folder.path()).expect("written");
    assert_eq!(fs::read_to_string(folder.path().join("touches.csv")).expect("readable"), table);
    let manifest = fs::read_to_string(folder.path().join("session.toml")).expect("readable");
    assert!(manifest.contains("[lighting]\nlamps = 3"), "{manifest}");
}

/// As spreadsheets save it: byte order mark, CRLF, capital TRUE, spaces.
#[test]
fn a_table_saved_by_a_spreadsheet_is_read() {
    let table = "\u{feff}true_x_m,true_y_m,true_z_m,est_x_m, est_y_m,est_z_m,valid\r\n0.2,0.1,0.05, 0.21,0.1,0.06,TRUE\r\n0.2,0.1,0.05,,,,False\r\n0.2,0.1,0.05,0.2,0.1,0.05,\r\n";
    let session = session_of(&[("session.toml", MANIFEST), ("localizations.csv", table)]).expect("read");
    let rows: Vec<LocalizationRow> = session.localizations.expect("there").rows().collect();
    assert_eq!(rows.iter().map(|row| row.valid).collect::<Vec<_>>(), [true, false, true]);
    assert_eq!(rows[0].estimate, Some(Point::new(0.21, 0.1, 0.06)));
    assert_eq!(rows[1].estimate, None);
}

#[test]
fn images_are_paired_by_name_and_orphans_reported() {
    let folder = folder();
    put(folder.path(), "session.toml", MANIFEST);
    for name in [
        "left/b.png",
        "left/a.jpg",
        "left/c.png",
        "right/a.jpg",
        "right/b.png",
        "right/d.JPEG",
        "right/notes.txt",
    ] {
        put(&folder.path().join("stereo"), name, "x");
    }
    let session = Session::read(folder.path()).expect("read");
    let pairs: Vec<&str> = session.stereo.pairs.iter().map(|pair| pair.name.as_str()).collect();
    assert_eq!(pairs, ["a.jpg", "b.png"]);
    assert!(session.stereo.pairs[0].right.ends_with("stereo/right/a.jpg"));
    let orphans: Vec<(Eye, &str)> = session
        .stereo
        .unpaired
        .iter()
        .map(|image| (image.eye, image.file.file_name().and_then(|name| name.to_str()).expect("a name")))
        .collect();
    assert_eq!(orphans, [(Eye::Left, "c.png"), (Eye::Right, "d.JPEG")]);
}

#[test]
fn tables_that_cannot_be_used_say_where() {
    let with = |table: &'static str| [("session.toml", MANIFEST), ("touches.csv", table)];
    const HEAD: &str = "cmd_a_rad,cmd_b_rad,touch_u_px,touch_v_px\n";
    let row = |text: &str| -> &'static str {
        Box::leak(format!("{HEAD}0.1,0.2,1.0,2.0\n{text}\n").into_boxed_str())
    };
    refused(&with(""), &["touches.csv", "is empty", "column names"]);
    refused(&[("touches.csv", HEAD)], &["is no session", "session.toml"]);
    refused(
        &with("cmd_a_rad,touch_u_px,touch_v_px\n"),
        &["touches.csv", "line 1", "cmd_b_rad", "missing", "chain"],
    );
    refused(&with("cmd_a_rad,cmd_b_rad,touch_u_px\n"), &["touches.csv", "touch_v_px", "missing"]);
    refused(&with("cmd_a_rad,cmd_b_rad,touch_u_px,touch_v_px,cmd_a_rad\n"), &["cmd_a_rad", "twice"]);
    refused(&with("cmd_a_rad;cmd_b_rad;touch_u_px;touch_v_px\n0,1;0,2;1;2\n"), &["line 1", "commas"]);
    refused(&with(row("0.1,0.2,1.0")), &["touches.csv", "line 3", "3 cells", "has 4", "touch_v_px"]);
    refused(&with(row("0,1,0.2,1.0,2.0")), &["line 3", "5 cells", "column number 5", "decimal comma"]);
    refused(
        &with(row("0.1,left,1.0,2.0")),
        &["touches.csv", "line 3", "column cmd_b_rad", "\"left\"", "a number"],
    );
    for bad in ["nan", "NaN", "inf", "-inf", "1e999"] {
        let text: &'static str = row(Box::leak(format!("0.1,0.2,{bad},2.0").into_boxed_str()));
        refused(&with(text), &["line 3", "column touch_u_px", bad, "not a finite number"]);
    }
    refused(&with(row("0.1,0.2,,2.0")), &["line 3", "column touch_u_px", "is empty"]);

    let located = |table: &'static str| [("session.toml", MANIFEST), ("localizations.csv", table)];
    refused(&located("true_x_m,true_y_m,true_z_m\n"), &["est_x_m (or left_u_px)", "right_v_px"]);
    refused(&located("true_x_m,true_y_m,true_z_m,est_x_m,est_y_m\n"), &["est_z_m", "missing"]);
    refused(
        &located("true_x_m,true_y_m,true_z_m,left_u_px,left_v_px,right_u_px\n"),
        &["right_v_px", "missing"],
    );
    refused(
        &located("true_x_m,true_y_m,true_z_m,est_x_m,est_y_m,est_z_m,valid\n0,0,0,0,0,0,maybe\n"),
        &["line 2", "column valid", "\"maybe\"", "true or false"],
    );
    refused(
        &located("true_x_m,true_y_m,true_z_m,est_x_m,est_y_m,est_z_m,head_z_rad\n0,0,0,0,0,0,up\n"),
        &["line 2", "column head_z_rad", "\"up\""],
    );

    let posed = |table: &'static str| [("session.toml", MANIFEST), ("poses.csv", table)];
    refused(&posed("cmd_a_rad,meas_x_m,meas_y_m,meas_z_m\n"), &["poses.csv", "cmd_b_rad or enc_b_rad"]);
    refused(&posed("cmd_a_rad,enc_b_rad,meas_x_m,meas_y_m\n"), &["poses.csv", "meas_z_m"]);
}

/// Ten good rows and what is given, of the columns of [`TOUCHES`] and more.
fn among_good_rows(more: &str) -> String {
    let good = "0.1,0.2,960.0,540.5,0.3,-0.1,0.06,0.0,0.0\n".repeat(10);
    format!(
        "cmd_a_rad,cmd_b_rad,touch_u_px,touch_v_px,target_x_m,target_y_m,target_z_m,screen_height_m,payload_kg\n{good}{more}"
    )
}

#[test]
fn a_row_that_cannot_be_is_set_aside_and_named() {
    for (row, words) in [
        (
            "1e9,0.2,960,540,0.3,0,0.06,0,0",
            ["line 12, column cmd_a_rad", "1.000e9 rad cannot be a joint angle"],
        ),
        (
            "0.1,0.2,-1e308,540,0.3,0,0.06,0,0",
            ["column touch_u_px", "-1.000e308 px cannot be a coordinate of a touch"],
        ),
        ("0.1,0.2,960,540,300,0,0.06,0,0", ["column target_x_m", "looks like millimeters"]),
        ("0.1,0.2,960,540,0.3,0,0.06,5,0", ["column screen_height_m", "5 m cannot be a height of the block"]),
        (
            "0.1,0.2,960,540,0.3,0,0.06,0,-5",
            ["column payload_kg", "-5 kg cannot be a payload, which is 0 to 20 kg"],
        ),
    ] {
        let table = among_good_rows(&format!("{row}\n"));
        let session =
            session_of(&[("session.toml", MANIFEST), ("touches.csv", &table)]).expect("one row only");
        let aside: Vec<_> = session.implausible().collect();
        let [(name, at, what)] = aside[..] else { panic!("one row: {aside:?}") };
        assert_eq!((name, at), ("touches.csv", 10));
        assert!(words.iter().all(|word| what.contains(word)), "{what}");
        let touches = session.touches.as_ref().expect("there");
        assert_eq!(touches.row_count(), 11, "its place is kept");
        let row = touches.row(10).expect("a row");
        assert_eq!(
            (row.touch, row.target, row.payload_kg, row.commanded_rad),
            (None, None, None, vec![None; 2])
        );
        assert!(touches.row(9).expect("a row").touch.is_some());
    }
}

#[test]
fn a_column_that_cannot_be_is_refused() {
    let bad = |column: usize, value: &str| {
        let text = among_good_rows("");
        let lines = text.lines().enumerate().map(|(i, line)| {
            let mut cells: Vec<&str> = line.split(',').collect();
            if i > 0 {
                cells[column] = value;
            }
            cells.join(",") + "\n"
        });
        lines.collect::<String>()
    };
    for (column, value, words) in [
        (
            4,
            "300",
            ["touches.csv, line 2, column target_x_m: 300 m", "in 10 of the 10 rows: correct the column"],
        ),
        (1, "90", ["column cmd_b_rad", "it looks like degrees, where radians belong"]),
        (7, "5", ["column screen_height_m", "-0.5 to 1 m"]),
        (8, "-5", ["column payload_kg", "nothing weighs less than nothing"]),
    ] {
        refused(&[("session.toml", MANIFEST), ("touches.csv", &bad(column, value))], &words);
    }
    let located = |truth: &str, estimate: &str| {
        format!(
            "true_x_m,true_y_m,true_z_m,est_x_m,est_y_m,est_z_m\n{}",
            format!("{truth},{estimate}\n").repeat(5)
        )
    };
    let in_millimeters = located("300,-200,50", "310,-190,52");
    refused(
        &[("session.toml", MANIFEST), ("localizations.csv", &in_millimeters)],
        &["localizations.csv, line 2, column true_x_m: 300 m", "millimeters", "5 of the 5 rows"],
    );
    // An estimate that failed lands on the wall.
    let failed = located("0.3,-0.2,0.05", "5.1,-2.0,1.2");
    let session =
        session_of(&[("session.toml", MANIFEST), ("localizations.csv", &failed)]).expect("it can be");
    assert_eq!(session.implausible().count(), 0);
    let posed = "cmd_a_rad,cmd_b_rad,meas_x_m,meas_y_m,meas_z_m\n0.1,0.2,1514.2,-520.7,119.4\n";
    refused(
        &[("session.toml", MANIFEST), ("poses.csv", posed)],
        &["meas_x_m", "-200 to 200 m", "millimeters"],
    );
}

#[test]
fn screens_that_cannot_be_are_refused() {
    let with = |from: &str, to: &str, words: &[&str]| {
        let text = MANIFEST.replace(from, to);
        assert_ne!(text, MANIFEST, "the test changes something");
        refused(&[("session.toml", &text), ("touches.csv", TOUCHES)], words);
    };
    with(
        "height_m = 0.267",
        "height_m = 5.0",
        &["session.toml, line 8", "touchscreen.height_m", "5 m cannot be"],
    );
    with("width_m = 0.475", "width_m = 475", &["touchscreen.width_m", "looks like millimeters"]);
    with("0.2375, 0.056]", "0.2375, 5.0]", &["touchscreen.origin_m", "an arm has to reach it"]);
    with("[0.0, -1.0, 0.0]", "[0.0, -1e308, 0.0]", &["touchscreen.u_axis", "a component of a direction"]);
    with("width_px = 1920", "width_px = 900000", &["touchscreen.width_px", "1 to 20000 px"]);
}

#[test]
fn manifests_that_nest_beyond_all_measure_are_refused() {
    for deep in [
        format!("a = {}1{}\n", "[".repeat(20_000), "]".repeat(20_000)),
        format!("a = {}1{}\n", "{b = ".repeat(20_000), "}".repeat(20_000)),
        format!("{}a = 1\n", "b.".repeat(20_000)),
        format!("[{}a]\n", "b.".repeat(20_000)),
    ] {
        refused(
            &[("session.toml", &format!("{MANIFEST}{deep}")), ("touches.csv", TOUCHES)],
            &["levels deep"],
        );
    }
}

#[test]
fn the_line_is_right_below_a_cell_of_several_lines() {
    let table =
        "set,cmd_a_rad,cmd_b_rad,touch_u_px,touch_v_px\n\"two\nlines\",0.1,0.2,1.0,2.0\nx,0.1,0.2,,2.0\n";
    refused(&[("session.toml", MANIFEST), ("touches.csv", table)], &["line 4", "touch_u_px"]);
}

#[test]
fn a_table_that_is_not_utf8_names_its_line() {
    let folder = folder();
    put(folder.path(), "session.toml", MANIFEST);
    let mut bytes = TOUCHES.as_bytes().to_vec();
    bytes.extend(b"0.1,0.2,\xe9,1\n");
    fs::write(folder.path().join("touches.csv"), bytes).expect("written");
    let error = Session::read(folder.path()).expect_err("Latin-1").to_string();
    assert!(error.contains("touches.csv, line 4") && error.contains("UTF-8"), "{error}");
}

#[test]
fn manifests_that_cannot_be_used_say_where() {
    let with = |change: &dyn Fn(&str) -> String, words: &[&str]| {
        let text = change(MANIFEST);
        assert_ne!(text, MANIFEST, "the test changes something");
        let mut all = vec!["session.toml"];
        all.extend(words);
        refused(&[("session.toml", &text), ("touches.csv", TOUCHES)], &all);
    };
    with(&|m| m.replace("format = 1", "format = 2"), &["format", "line 1", "newer program"]);
    with(&|m| m.replace("format = 1\n", ""), &["format", "missing"]);
    with(&|m| m.replace("rig = \"nico\"\n", ""), &["rig", "rig_file", "missing"]);
    with(&|m| m.replace("rig = ", "rig_file = \"rig.toml\"\nrig = "), &["rig_file", "rig is given too"]);
    with(&|m| m.replace("2026-11-21T10:04:00Z", "2026-11-21T10:04:00"), &["started", "line 3", "offset"]);
    with(&|m| m.replace("width_px = 1920", "width_px = -1"), &["touchscreen.width_px", "line 5"]);
    with(&|m| m.replace("width_m = 0.475", "width_m = nan"), &["touchscreen.width_m", "line 7"]);
    with(&|m| m.replace("height_m = 0.267", "height_m = \"0.267\""), &["touchscreen.height_m", "a number"]);
    with(&|m| m.replace("[0.53, 0.2375, 0.056]", "[0.53, 0.2375]"), &["touchscreen.origin_m", "3 numbers"]);
    with(&|m| m.replace("[0.0, -1.0, 0.0]", "[0.0, 0.0, 0.0]"), &["touchscreen.u_axis", "zero"]);
    with(&|m| m.replace("[0.0, -1.0, 0.0]", "[1.0, -1.0, 0.0]"), &["touchscreen.v_axis", "right angle"]);
    with(&|m| m.replace("[\"a\", \"b\"]", "[]"), &["chain.joints", "at least one"]);
    with(&|m| m.replace("[\"a\", \"b\"]", "[\"a\", \"a\"]"), &["chain.joints[1]", "not in the list yet"]);
    with(&|m| m.replace("tip = ", "tip: "), &["line 13", "TOML"]);
    refused(&[("touches.csv", TOUCHES)], &["session.toml", "is no session"]);
    refused(&[("session.toml", ""), ("touches.csv", TOUCHES)], &["session.toml", "is empty"]);
}

#[test]
fn tables_need_what_explains_them() {
    let bare = "format = 1\nrig = \"nico\"\nstarted = 2026-11-21T10:04:00Z\n";
    refused(&[("session.toml", bare), ("touches.csv", TOUCHES)], &["touches.csv", "[touchscreen]"]);
    let screen = MANIFEST.split("[chain]").next().expect("the part before");
    refused(&[("session.toml", screen), ("touches.csv", TOUCHES)], &["touches.csv", "[chain]"]);
    refused(&[("session.toml", bare), ("poses.csv", "cmd_a_rad\n")], &["poses.csv", "[chain]"]);
    refused(&[("session.toml", bare)], &["no measurements", "touches.csv"]);
    let error = Session::read(Path::new("no-such-folder")).expect_err("absent").to_string();
    assert!(error.contains("not a folder") && error.contains("session.toml"), "{error}");

    // Neither can such a session be written.
    let folder = folder();
    let mut session = session_of(&[("session.toml", MANIFEST), ("touches.csv", TOUCHES)]).expect("read");
    session.manifest.touchscreen = None;
    assert!(matches!(session.write(folder.path()), Err(SessionError::NeedsSection { .. })));
    assert_eq!(fs::read_dir(folder.path()).expect("readable").count(), 0);
}

#[test]
fn a_session_begins_with_nothing_measured_and_is_none_before_something_is() {
    let folder = folder();
    let started = "2026-11-21T10:04:00Z".parse().expect("a time");
    let begun = Session::new(Manifest::of_rig("nico", started));
    begun.write(folder.path()).expect("written");
    let error = Session::read(folder.path()).expect_err("nothing was measured");
    assert!(matches!(error, SessionError::NothingMeasured { .. }), "{error}");
    put(folder.path(), "log.mcap", "x");
    let read = Session::read(folder.path()).expect("a session");
    assert_eq!((&read.manifest, &read.touches, &read.stereo), (&begun.manifest, &None, &begun.stereo));
    assert_eq!(read.manifest.rig, RigReference::Named("nico".to_owned()));
}

#[test]
fn a_log_alone_is_a_session() {
    let session = session_of(&[("session.toml", MANIFEST), ("log.mcap", "x")]).expect("read");
    assert!(session.log.is_some_and(|file| file.ends_with("log.mcap")));
}

#[test]
fn the_example_in_this_repository_is_a_session() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../sessions/example");
    let session = Session::read(&folder).expect("read");
    assert_eq!(session.touches.expect("there").row_count(), 4);
    assert_eq!(session.localizations.expect("there").row_count(), 3);
    assert_eq!(session.poses.expect("there").row_count(), 2);
}

#[test]
fn measured_sessions_are_read_and_written_without_loss() {
    let expected = [
        ("nico-touch/touch-245", 245, 0),
        ("nico-vision/grid-z5", 0, 36),
        ("nico-vision/grid-z5-pivot-corrected", 0, 36),
    ];
    for (name, touches, localizations) in expected {
        let Ok(folder_of_session) = measured_data::folder(name) else { return };
        let session = Session::read(&folder_of_session).expect(name);
        assert_eq!(session.touches.as_ref().map_or(0, TouchTable::row_count), touches, "{name}");
        assert_eq!(
            session.localizations.as_ref().map_or(0, LocalizationTable::row_count),
            localizations,
            "{name}"
        );
        let copy = folder();
        session.write(copy.path()).expect("written");
        let back = Session::read(copy.path()).expect("read");
        assert_eq!(back, session, "{name}");
        for table in back.touches.iter() {
            assert!(table.rows().all(|row| row.touch.is_some() && row.target.is_some()));
            assert!(
                table.rows().all(|row| row.commanded_rad.iter().chain(&row.encoder_rad).all(Option::is_some))
            );
        }
    }
}

#[test]
fn columns_that_the_format_does_not_define_are_written_and_come_back() {
    let row = |angle_rad: f64| TouchRow {
        commanded_rad: vec![Some(angle_rad), Some(0.1 / 3.0)],
        touch: Some(Pixel::new(960.0, 540.5)),
        encoder_rad: vec![None; 2],
        temperature_c: vec![None; 2],
        load: vec![None; 2],
        ..TouchRow::default()
    };
    let rows = [row(0.1), row(0.2)];
    let joints = vec!["a".to_owned(), "b".to_owned()];
    let later = |row: usize| (row == 1).then_some(0.1 / 3.0);
    let empty = |_: usize| None;
    let table = TouchTable::from_rows_with(
        joints.clone(),
        &rows,
        &[("later_a_rad".to_owned(), &later), ("later_b_rad".to_owned(), &empty)],
    );
    let folder = folder();
    let file = folder.path().join("touches.csv");
    table.write(&file).expect("written");
    let read = TouchTable::read(&file, &joints).expect("read");
    assert_eq!(read.rows().collect::<Vec<_>>(), rows);
    assert_eq!(read.extra_numbers("later_a_rad"), Some(vec![None, Some(0.1 / 3.0)]));
    assert_eq!(read.extra_numbers("later_b_rad"), None, "a column without a value is left out");
}
