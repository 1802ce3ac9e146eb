//! Grasps of the live twin in a lab that was commissioned: how many are held.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use plumbline_grasp::Method;
use plumbline_twin::Toy;

use super::bench::{Bench, is_truly_lifted, truly_at_m, words};
use crate::command::{GraspCommand, GraspTarget, TwinCommand};

/// Six of the published places, near and far, left and right.
const SIX_M: [[f64; 2]; 6] = [[0.3, -0.3], [0.2, -0.2], [0.4, -0.2], [0.3, -0.1], [0.4, 0.0], [0.3, 0.1]];
/// Calibrated eyes were warm.
const WARM_MINUTES: f64 = 60.0;

/// A copy of a folder, so that nothing is written into it.
fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("writable");
    for entry in std::fs::read_dir(from).expect("a folder").flatten() {
        let (path, into) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            copy(&path, &into);
        } else {
            std::fs::copy(&path, &into).expect("a copy");
        }
    }
}

/// Grasps of a tomato by M5 in the lab commissioned in `PLUMBLINE_LAB` (of the twin "lab"), at
/// `PLUMBLINE_PLACES` ("x,y;x,y", else six), a fresh twin for each. Judged by where the tomato really is.
#[test]
#[ignore = "minutes; figures for who works on grasps"]
fn six_places_in_a_lab() {
    let lab = PathBuf::from(std::env::var("PLUMBLINE_LAB").expect("PLUMBLINE_LAB is a commissioned lab"));
    let places = std::env::var("PLUMBLINE_PLACES").ok().map_or(SIX_M.to_vec(), |text| {
        let number = |number: &str| number.trim().parse().expect("a number");
        text.split(';')
            .map(|place| place.split_once(',').expect("x,y"))
            .map(|(x, y)| [number(x), number(y)])
            .collect()
    });
    let mut held = 0;
    for at_m in &places {
        let folder = tempfile::tempdir().expect("a temporary folder");
        copy(&lab, folder.path());
        let Some(bench) = Bench::start_in(folder, "lab", Toy::Tomato, *at_m) else { return };
        bench.send(TwinCommand::AdvanceWarmUp { minutes: WARM_MINUTES });
        bench.send(GraspCommand::Method(Method::M5));
        bench.send(GraspCommand::Target(GraspTarget { class: Some("Tomato".to_owned()), near_m: None }));
        let began = Instant::now();
        let run = bench.grasp();
        let view = bench.until("a new look at the twin", |view| view.twin.running);
        let lifted = is_truly_lifted(&view, Toy::Tomato);
        held += usize::from(lifted);
        println!(
            "{at_m:?}: lifted {lifted} at {:.3?}, {}, fingers {:.2?}, looks {:.1?} mm, {:.1} s, twin at {:.2} of its pace",
            truly_at_m(&view, Toy::Tomato).unwrap_or_default(),
            words(run.outcome.as_ref()),
            run.fingers_open_rad,
            run.iterations.iter().filter_map(|look| look.distance_m).map(|m| m * 1e3).collect::<Vec<_>>(),
            began.elapsed().as_secs_f64(),
            view.twin.real_time_factor,
        );
        // How long it stays in the hand, where that is asked.
        let hold_s = std::env::var("PLUMBLINE_HOLD_S").ok().and_then(|s| s.parse::<u64>().ok()).unwrap_or(0);
        for second in 1..=hold_s {
            let later = Instant::now() + Duration::from_secs(1);
            let view = bench.until("a second", |_| Instant::now() > later);
            if !is_truly_lifted(&view, Toy::Tomato) {
                println!("    it is lost after {second} s");
                break;
            }
            if second == hold_s {
                println!("    it is held for {hold_s} s");
            }
        }
    }
    println!("held {held}/{}", places.len());
}
