//! What is no file, too large or a link to nothing is refused at once by every verb that reads it.

use std::process::Command;

use super::desk::Desk;

/// Every verb with one of its inputs in place of FILE.
const READERS: [&str; 15] = [
    "train --model m1 --session FILE --out model.json",
    "gap --session FILE",
    "gap --session s --rig-model FILE",
    "predict --session FILE",
    "predict --session s --rig-model FILE",
    "correct --model FILE --points points.csv",
    "ik --rig nico --tip right_index_tip --targets FILE",
    "disparity --left FILE --right FILE --rectified --max-disparity 64 --out map.pfm",
    "disparity --left a.png --right a.png --cameras FILE --max-disparity 64 --out map.pfm",
    "locate --cameras FILE --left a.png --right a.png --points points.csv",
    "locate --lab FILE --left a.png --right a.png --points points.csv",
    "calibrate stereo --left FILE --right FILE --board 8x5 --square-mm 30 --out cameras.yaml",
    "calibrate check --cameras FILE --left s --right s --board 8x5 --square-mm 30",
    "detect --model FILE --images a.png",
    "detect-eval --model a.png --data FILE",
];

fn desk() -> Desk {
    let desk = Desk::new();
    desk.write("points.csv", "u_px,v_px\n900,500\n");
    let mut bytes = std::io::Cursor::new(vec![]);
    image::RgbImage::new(64, 64).write_to(&mut bytes, image::ImageFormat::Png).expect("encoded");
    desk.write("a.png", bytes.into_inner());
    desk
}

/// All readers refuse the input, at once, and name it or what it is.
fn all_refuse(desk: &Desk, input: &str, words: &[&str]) {
    let mut wrong = vec![];
    for reader in READERS {
        let before = desk.files();
        let ended = desk.run(&reader.replace("FILE", input));
        let named = words.iter().any(|word| ended.said.contains(word));
        if ended.status != Some(1) || !named || ended.took.as_secs() >= 10 || desk.files() != before {
            wrong.push(format!("{reader}: {:?} after {:?}: {}", ended.status, ended.took, ended.said));
        }
    }
    assert!(wrong.is_empty(), "{input}:\n{}", wrong.join("\n"));
}

#[test]
fn pipes_devices_and_dangling_links_are_refused_at_once() {
    let desk = desk();
    assert!(Command::new("mkfifo").arg(desk.path("pipe")).status().expect("run").success());
    all_refuse(&desk, "pipe", &["pipe"]);
    all_refuse(&desk, "/dev/zero", &["zero"]);
    std::os::unix::fs::symlink("gone", desk.path("dangling")).expect("a link");
    all_refuse(&desk, "dangling", &["dangling"]);
}

#[test]
fn what_is_too_large_is_refused_at_once() {
    let desk = desk();
    // With a hole: it takes no room on the disk.
    std::fs::File::create(desk.path("huge")).expect("made").set_len(3_000_000_000_000).expect("a hole");
    let before = std::fs::metadata(desk.path("huge")).expect("there").len();
    for reader in READERS {
        let ended = desk.run(&reader.replace("FILE", "huge"));
        assert_eq!(ended.status, Some(1), "{reader}: {}", ended.said);
        assert!(ended.took.as_secs() < 10 && ended.said.contains("huge"), "{reader}: {}", ended.said);
    }
    assert_eq!(std::fs::metadata(desk.path("huge")).expect("there").len(), before);
}

#[test]
fn optional_files_that_are_links_to_nothing_are_told() {
    let desk = desk();
    std::os::unix::fs::symlink("on-the-other-disk.csv", desk.path("s/poses.csv")).expect("a link");
    let words = "poses.csv is a link to on-the-other-disk.csv, which does not exist";
    desk.refuses("gap --session s", words);
    desk.refuses("predict --session s", words);
    desk.refuses("train --model m1 --session s --out model.json", words);
}

#[test]
fn tables_have_an_end_and_cells_are_quoted_shortly() {
    let desk = desk();
    let touches = std::fs::read_to_string(desk.path("s/touches.csv")).expect("there");
    let (header, rows) = touches.split_once('\n').expect("rows");
    let row = rows.lines().next().expect("a row");
    desk.write("s/touches.csv", format!("{header}\n{}", format!("{row}\n").repeat(200_001)));
    desk.refuses("train --model m1 --session s --out model.json", "has more than 200000 rows");
    let long = row.replacen("0.", &format!("\u{1b}[2J{}", "x".repeat(2_000_000)), 1);
    desk.write("s/touches.csv", format!("{header}\n{long}\n"));
    let ended = desk.run("train --model m1 --session s --out model.json");
    assert_eq!(ended.status, Some(1));
    assert!(ended.said.len() < 1000 && ended.said.contains("… ("), "{} bytes", ended.said.len());
    assert!(!ended.said.contains('\u{1b}'));
    desk.write("points.csv", format!("u_px,v_px\n{},1\n", "9".repeat(2_000_000)));
    desk.write("many.csv", format!("x_m,y_m,z_m\n{}", "0.3,0,0\n".repeat(200_001)));
    desk.refuses("ik --rig nico --tip right_index_tip --targets many.csv", "more than 200000 rows");
    desk.write("long.csv", format!("x_m,y_m,z_m\n{},0,0\n", "x".repeat(2_000_000)));
    let ended = desk.run("ik --rig nico --tip right_index_tip --targets long.csv");
    assert!(ended.status == Some(1) && ended.said.len() < 1000, "{} bytes", ended.said.len());
}
