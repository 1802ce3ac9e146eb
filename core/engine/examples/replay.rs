//! Replays a folder of chessboard pairs through the whole live pipeline and prints rates, times
//! and memory: `cargo run --release -p plumbline-engine --example replay -- FOLDER [PAIRS] [HZ]`.
//!
//! The folder holds pairs of a board of 9×6 squares of 30 mm. Memory must not grow from the
//! first quarter to the end.
#![allow(clippy::print_stdout)]

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_engine::{
    Engine, EngineSettings, EyesCommand, LiveCommand, ProbePoint, Products, SourceCommand, SourceSpec, View,
};
use plumbline_model::Eye;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let Some(folder) = arguments.next().map(PathBuf::from) else {
        println!("give a folder of chessboard pairs (9x6 squares of 30 mm)");
        return;
    };
    let mut number = |usual: f64| arguments.next().and_then(|text| text.parse().ok()).unwrap_or(usual);
    let (pairs, rate_hz) = (number(2000.0) as u64, number(30.0));
    let data = tempfile::tempdir().expect("temporary folder");
    let (wake, woken) = crossbeam_channel::bounded(1);
    let settings = EngineSettings { data_dir: Some(data.path().to_owned()), ..EngineSettings::default() };
    let ring = move || {
        let _ = wake.try_send(());
    };
    let engine = Engine::start(settings, Arc::new(ring));
    let until = |what: &str, fulfilled: &dyn Fn(&View) -> bool| {
        let begun = Instant::now();
        while !fulfilled(&engine.view()) {
            assert!(begun.elapsed() < Duration::from_secs(120), "{what}: {:?}", engine.view().notices);
            let _ = woken.recv_timeout(Duration::from_millis(100));
        }
        begun.elapsed()
    };

    engine.send(EyesCommand::ChooseBoard { columns: 9, rows: 6, square_m: 0.03 });
    engine.send(SourceCommand::Open(SourceSpec::Folder(folder)));
    until("a picture", &|view| view.live.raw.is_some());
    engine.send(EyesCommand::CollectRecording);
    let found = until("pairs", &|view| !view.eyes.collected.is_empty());
    engine.send(EyesCommand::Solve);
    let solved = until("a proposal", &|view| view.eyes.proposal.is_some());
    println!("found {} pairs in {found:.2?}, solved in {solved:.2?}", engine.view().eyes.collected.len());
    engine.send(EyesCommand::Accept);
    until("a calibration", &|view| view.eyes.in_use.is_some());

    engine.send(LiveCommand::Want(Products {
        rectified: true,
        disparity: true,
        corners: true,
        detections: false,
    }));
    engine.send(LiveCommand::Probe(ProbePoint::Raw { eye: Eye::Left, u_px: 330.0, v_px: 250.0 }));
    engine.send(SourceCommand::PairsPerSecond(rate_hz));
    let first = newest(&engine.view());
    let (begun, begun_cpu) = (Instant::now(), cpu_time());
    let (mut early, mut views) = (None, 0u64);
    while newest(&engine.view()) < first + pairs {
        views += u64::from(woken.recv_timeout(Duration::from_secs(5)).is_ok());
        if early.is_none() && newest(&engine.view()) >= first + pairs / 4 {
            early = Some(resident_mib());
        }
    }
    let (took, cpu) = (begun.elapsed(), cpu_time() - begun_cpu);
    let view = engine.view();
    println!(
        "{pairs} pairs at {:.1} Hz, {views} views, {:.0} % of a core",
        pairs as f64 / took.as_secs_f64(),
        100.0 * cpu / took.as_secs_f64()
    );
    let statistics = &view.live.statistics;
    for (name, stage) in [
        ("source", &statistics.source),
        ("rectify", &statistics.rectify),
        ("corners", &statistics.corners),
        ("probe", &statistics.probe),
    ] {
        println!(
            "{name:8} {:5.1} Hz, busy {:5.1?}, latency {:5.1?}, skipped {}",
            stage.per_second.unwrap_or_default(),
            stage.busy.unwrap_or_default(),
            stage.latency.unwrap_or_default(),
            stage.skipped
        );
    }
    let (early, late) = (early.unwrap_or_default(), resident_mib());
    println!("resident memory {early:.1} MiB after a quarter, {late:.1} MiB at the end");
    let begun = Instant::now();
    drop(engine);
    println!("closed in {:.0?}", begun.elapsed());
    assert!(late < early + 20.0, "memory grows");
}

fn newest(view: &View) -> u64 {
    view.live.raw.as_ref().map_or(0, |frame| frame.stamp.seq)
}

/// Resident memory of this process; 0 where the system does not tell.
fn resident_mib() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap_or_default();
    line.split_whitespace().next().and_then(|kib| kib.parse::<f64>().ok()).unwrap_or_default() / 1024.0
}

/// User and system time of this process, seconds; 0 where the system does not tell.
fn cpu_time() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The name in parentheses may hold spaces; times are in ticks of 10 ms.
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks = |i: usize| fields.get(i).and_then(|text| text.parse::<f64>().ok()).unwrap_or_default();
    (ticks(11) + ticks(12)) / 100.0
}
