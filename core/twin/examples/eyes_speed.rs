//! How fast the twin's eyes draw: pairs per second and how much of the processor they take.
//!
//! `cargo run --release -p plumbline-twin --example eyes_speed -- [pairs] [made-up|twin] [image prefix]`
//! draws the made-up lab, or what a twin sees one second after its start.

#![allow(clippy::print_stdout)]

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_model::robot::Rig;
use plumbline_twin::eyes::{EyeOptions, EyeRenderer, Sensor, sample};
use plumbline_twin::scene::{Scenery, Snapshot};
use plumbline_twin::{Scenario, Twin, TwinSettings};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let pairs: u32 = arguments.next().map_or(Ok(60), |text| text.parse())?;
    let (scenery, mut snapshot) = match arguments.next().as_deref() {
        Some("twin") => twin()?,
        _ => sample::lab(),
    };
    let opened = Instant::now();
    let mut renderer = EyeRenderer::new(EyeOptions::default())?;
    let first = renderer.render(&scenery, &snapshot, &Sensor::default(), 0)?;
    println!("{}; open and first pair {:.2} s", renderer.adapter_name(), opened.elapsed().as_secs_f64());
    if let Some(prefix) = arguments.next() {
        first.left.save(format!("{prefix}_left.png"))?;
        first.right.save(format!("{prefix}_right.png"))?;
    }
    let (start, busy) = (Instant::now(), cpu_seconds());
    let eyes = snapshot.eyes;
    for i in 0..pairs {
        // The head moves a little, so that nothing can be kept from pair to pair.
        let shift = nalgebra::Translation3::new(0.0, 0.0, 0.0005 * f64::from(i % 7));
        snapshot.eyes.robot_from_left.isometry = shift * eyes.robot_from_left.isometry;
        snapshot.eyes.robot_from_right.isometry = shift * eyes.robot_from_right.isometry;
        renderer.render(&scenery, &snapshot, &Sensor::default(), u64::from(i))?;
    }
    let wall = start.elapsed().as_secs_f64();
    let (cores, each) = match (busy, cpu_seconds()) {
        (Some(before), Some(after)) => (
            format!("{:.2} cores busy", (after - before) / wall),
            format!("{:.1} ms of processor time", (after - before) * 1000.0 / f64::from(pairs)),
        ),
        _ => ("processor time unknown".to_owned(), String::new()),
    };
    println!(
        "{} items, {pairs} pairs: {:.1} pairs/s, {:.1} ms and {each} per pair, {cores} (of {})",
        scenery.items.len(),
        f64::from(pairs) / wall,
        wall * 1000.0 / f64::from(pairs),
        std::thread::available_parallelism().map_or(0, usize::from)
    );
    Ok(())
}

/// What a twin of the robot sees one second after its start, its head bowed as for work.
fn twin() -> Result<(Scenery, Snapshot), Box<dyn std::error::Error>> {
    let rig = Arc::new(Rig::built_in("nico")?);
    let scenario = Scenario::built_in("lab")?;
    let twin = Twin::start(TwinSettings { rig, scenario, seed: 1, pace: 1.0 })?;
    std::thread::sleep(Duration::from_secs(1));
    let (scenery, mut snapshot) = twin.scene().newest();
    let bow = nalgebra::UnitQuaternion::from_axis_angle(&nalgebra::Vector3::y_axis(), 30_f64.to_radians());
    let middle = snapshot.eyes.robot_from_left.isometry.translation.vector;
    if snapshot.eyes.robot_from_left.isometry.rotation.transform_vector(&nalgebra::Vector3::z()).z > -0.2 {
        let about = nalgebra::Translation3::from(middle) * bow * nalgebra::Translation3::from(-middle);
        snapshot.eyes.robot_from_left.isometry = about * snapshot.eyes.robot_from_left.isometry;
        snapshot.eyes.robot_from_right.isometry = about * snapshot.eyes.robot_from_right.isometry;
    }
    Ok((Arc::unwrap_or_clone(scenery), snapshot))
}

/// Processor time of this process so far, all threads; `None` where the system does not tell.
fn cpu_seconds() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let after_name = stat.rsplit_once(')')?.1;
    let ticks = |field: usize| after_name.split_whitespace().nth(field)?.parse::<f64>().ok();
    // User and system time, in hundredths of a second.
    Some((ticks(11)? + ticks(12)?) / 100.0)
}
