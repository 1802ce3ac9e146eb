//! Killed at any moment, the program leaves the old file or the new one, and the next run works.

use std::path::Path;
use std::time::{Duration, Instant};

use super::desk::{Desk, Dice};

const PAIRS: &str = "--left lab/board/left --right lab/board/right --board 8x5 --square-mm 30";
/// Kills of one verb: half of them at any moment, half when the file is just being written.
const KILLS: usize = 12;

/// Kills a verb again and again; `is_whole` judges a target that is not the old one.
fn survives(desk: &Desk, words: &str, target: &str, is_whole: impl Fn(&Desk) -> bool) {
    let done = desk.run(words);
    assert_eq!(done.status, Some(0), "{words}: {}", done.said);
    assert!(is_whole(desk), "{words} did not even finish well");
    let mut dice = Dice(11);
    let (mut hits, mut new) = (0, 0);
    for kill in 0..KILLS {
        desk.write(target, "old");
        let mut inputs = desk.files();
        inputs.remove(Path::new(target));
        let mut child = desk.command(words).spawn().expect("the program starts");
        let began = Instant::now();
        let moment = done.took.mul_f64(1.1 * dice.share());
        while child.try_wait().expect("a child").is_none() {
            let writes = kill % 2 == 1 && is_writing(&desk.path(""), child.id());
            if writes || (kill % 2 == 0 && began.elapsed() >= moment) {
                hits += usize::from(writes);
                // As SIGKILL: nothing of it can run any more.
                let _ = child.kill();
                break;
            }
            if kill % 2 == 0 {
                std::thread::sleep(Duration::from_micros(200));
            }
        }
        let _ = child.wait_with_output();
        let mut after = desk.files();
        let left = after.remove(Path::new(target)).expect("the old file or the new one");
        assert!(after == inputs, "{words}, kill {kill}: another file was changed or came to be");
        if left != b"old" {
            new += 1;
            assert!(is_whole(desk), "{words}, kill {kill}: half a file");
        }
    }
    println!("{words}: {KILLS} kills, {hits} of them while it wrote, {new} times the new file was there");
    // What was left behind is in nobody's way.
    let again = desk.run(words);
    assert_eq!(again.status, Some(0), "{words}: {}", again.said);
    assert!(is_whole(desk));
}

/// Whether a process has a file of its own in the folder that is just being written.
fn is_writing(folder: &Path, process: u32) -> bool {
    let start = format!(".{process}-");
    let names = std::fs::read_dir(folder).into_iter().flatten().flatten();
    names.into_iter().any(|entry| entry.file_name().to_string_lossy().starts_with(&start))
}

#[test]
fn train() {
    let desk = Desk::new();
    desk.write("points.csv", "u_px,v_px\n900,500\n");
    survives(&desk, "train --model m1 --session s --out model.json", "model.json", |desk| {
        desk.run("correct --model model.json --points points.csv").status == Some(0)
    });
}

#[test]
fn gap() {
    let desk = Desk::new();
    let is_whole = |desk: &Desk| desk.run("predict --session s --rig-model model.toml").status == Some(0);
    survives(&desk, "gap --session s --add --out model.toml", "model.toml", is_whole);
}

#[test]
fn calibrate() {
    let desk = Desk::with_pairs();
    let words = format!("calibrate stereo {PAIRS} --out cameras.yaml");
    survives(&desk, &words, "cameras.yaml", |desk| {
        plumbline_model::formats::read_any(&[desk.path("cameras.yaml")]).is_ok()
    });
}
