//! An output is never one of the inputs, and nothing but a file is written over.

use super::desk::Desk;

const LOST: &str = "which is part of what it is computed from";
const PAIRS: &str = "--left lab/board/left --right lab/board/right --board 8x5 --square-mm 30";
const MATCH: &str = "disparity --left lab/table/left/table_00.png --right lab/table/right/table_00.png \
                     --rectified --max-disparity 64";

fn link(to: &str, at: std::path::PathBuf) {
    std::os::unix::fs::symlink(to, at).expect("a link");
}

#[test]
fn training_does_not_write_over_the_measurement() {
    let desk = Desk::new();
    desk.refuses("train --model m1 --session s --out s/touches.csv", LOST);
    desk.refuses("train --model m1 --session s --out s/session.toml", LOST);
    desk.refuses("train --model m1 --session s --out ./s/../s/touches.csv", LOST);
    link("s/touches.csv", desk.path("link.json"));
    desk.refuses("train --model m1 --session s --out link.json", LOST);
    std::fs::hard_link(desk.path("s/touches.csv"), desk.path("hard.json")).expect("a second name");
    desk.refuses("train --model m1 --session s --out hard.json", LOST);
    link("s", desk.path("t"));
    desk.refuses("train --model m1 --session t --out s/touches.csv", LOST);
    // Beside the tables is a good place for a model, also a second time.
    for _ in 0..2 {
        let ended = desk.run("train --model m1 --session s --out s/model.json");
        assert_eq!(ended.status, Some(0), "{}", ended.said);
    }
}

#[test]
fn a_search_does_not_write_over_the_measurement() {
    let desk = Desk::new();
    desk.refuses("gap --session s --report s/touches.csv", LOST);
    desk.refuses("gap --session s --add --out s/session.toml", LOST);
    desk.refuses("gap --session s --add --out both --report both", LOST);
    let rig = include_str!("../../../assets/robots/nico/rig.toml");
    desk.write("nico/rig.toml", rig);
    desk.write("nico/nico.urdf", include_str!("../../../assets/robots/nico/nico.urdf"));
    desk.refuses("gap --session s --rig-model nico/rig.toml --add --out nico/rig.toml", LOST);
    desk.refuses("gap --session s --rig-model nico/rig.toml --report nico/rig.toml", LOST);
    // The robot's description that the session names is an input, too.
    let manifest = std::fs::read_to_string(desk.path("s/session.toml")).expect("there");
    desk.write("s/session.toml", manifest.replace("rig = \"nico\"", "rig_file = \"../nico/rig.toml\""));
    desk.refuses("gap --session s --report nico/rig.toml", LOST);
    desk.refuses("train --model m1 --session s --out nico/rig.toml", LOST);
}

#[test]
fn work_on_images_does_not_write_over_them() {
    let desk = Desk::with_pairs();
    desk.refuses(&format!("{MATCH} --out lab/table/left/table_00.png"), LOST);
    desk.refuses(&format!("{MATCH} --out lab/table/right/../right/table_00.png"), LOST);
    desk.refuses(&format!("calibrate stereo {PAIRS} --out lab/board/left/pair_00.png"), LOST);
    desk.refuses(&format!("calibrate stereo {PAIRS} --out lab/board/right/pair_03.png"), LOST);
    link("lab/table/left/table_00.png", desk.path("map.pfm"));
    desk.refuses(&format!("{MATCH} --out map.pfm"), LOST);
}

#[test]
fn judging_does_not_write_over_the_set() {
    let desk = Desk::new();
    set(&desk);
    for file in ["set/data.yaml", "set/images/val/a.png", "set/labels/val/a.txt", "tiny.onnx"] {
        desk.refuses(&format!("detect-eval --model tiny.onnx --data set/data.yaml --csv {file}"), LOST);
    }
    desk.refuses("detect --model tiny.onnx --images set/images/val --labels-out set/labels/val", LOST);
    desk.write("flat/a.png", png());
    desk.write("flat/a.txt", "0 0.5 0.5 0.5 0.5\n");
    desk.refuses("detect --model tiny.onnx --images flat --labels-out flat", LOST);
}

#[test]
fn what_is_no_file_is_not_written_over() {
    let desk = Desk::with_pairs();
    let train = "train --model m1 --session s --out";
    desk.refuses(&format!("{train} /dev/null"), "/dev/null is a device, which is not replaced");
    assert!(std::os::unix::fs::FileTypeExt::is_char_device(
        &std::fs::metadata("/dev/null").expect("there").file_type()
    ));
    desk.refuses(&format!("{train} lab"), "lab is a folder, which is not replaced");
    assert!(std::process::Command::new("mkfifo").arg(desk.path("pipe")).status().expect("run").success());
    desk.refuses(&format!("{MATCH} --out pipe"), "pipe is a pipe, which is not replaced");
    link("/dev/full", desk.path("full"));
    desk.refuses(&format!("{MATCH} --out full"), "full is a device, which is not replaced");
    link("gone.json", desk.path("dangling"));
    desk.refuses(&format!("{train} dangling"), "dangling is a link to gone.json, which does not exist");
    desk.refuses(&format!("{train} nowhere/model.json"), "choose a folder that exists");
    // A link is followed, and stays one.
    desk.write("old.pfm", "old");
    link("old.pfm", desk.path("map.pfm"));
    let ended = desk.run(&format!("{MATCH} --out map.pfm"));
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    assert!(std::fs::symlink_metadata(desk.path("map.pfm")).expect("there").is_symlink());
    assert!(desk.files()[std::path::Path::new("old.pfm")].starts_with(b"Pf\n"));
}

/// A set with one image, and a file that is called like a detector.
fn set(desk: &Desk) {
    desk.write("set/data.yaml", "train: images/val\nval: images/val\nnames: [Duck]\n");
    desk.write("set/images/val/a.png", png());
    desk.write("set/labels/val/a.txt", "0 0.5 0.5 0.5 0.5\n");
    desk.write("tiny.onnx", include_bytes!("../../../core/vision/tests/detectors/end-to-end.onnx"));
}

fn png() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(vec![]);
    image::RgbImage::new(64, 64).write_to(&mut bytes, image::ImageFormat::Png).expect("encoded");
    bytes.into_inner()
}
