//! How fast the twin's eyes draw the made-up lab: pairs per second and how much of the processor they
//! take. `cargo run --release -p plumbline-twin --example eyes_speed -- [pairs] [image prefix]`

#![allow(clippy::print_stdout)]

use std::time::Instant;

use plumbline_twin::eyes::{EyeOptions, EyeRenderer, Sensor, sample};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let pairs: u32 = arguments.next().map_or(Ok(60), |text| text.parse())?;
    let opened = Instant::now();
    let mut renderer = EyeRenderer::new(EyeOptions::default())?;
    let (scenery, mut snapshot) = sample::lab();
    let first = renderer.render(&scenery, &snapshot, &Sensor::default(), 0)?;
    println!("{}; open and first pair {:.2} s", renderer.adapter_name(), opened.elapsed().as_secs_f64());
    if let Some(prefix) = arguments.next() {
        first.left.save(format!("{prefix}_left.png"))?;
        first.right.save(format!("{prefix}_right.png"))?;
    }
    let (start, busy) = (Instant::now(), cpu_seconds());
    for i in 0..pairs {
        // The head turns a little, so that nothing can be kept from pair to pair.
        snapshot.eyes = sample::eyes(0.52 + 0.001 * f64::from(i % 7));
        renderer.render(&scenery, &snapshot, &Sensor::default(), u64::from(i))?;
    }
    let wall = start.elapsed().as_secs_f64();
    let cores = match (busy, cpu_seconds()) {
        (Some(before), Some(after)) => format!("{:.2} cores busy", (after - before) / wall),
        _ => "processor time unknown".to_owned(),
    };
    println!(
        "{} items, {pairs} pairs: {:.1} pairs/s, {:.1} ms per pair, {cores} (of {})",
        scenery.items.len(),
        f64::from(pairs) / wall,
        wall * 1000.0 / f64::from(pairs),
        std::thread::available_parallelism().map_or(0, usize::from)
    );
    Ok(())
}

/// Processor time of this process so far, all threads; `None` where the system does not tell.
fn cpu_seconds() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let after_name = stat.rsplit_once(')')?.1;
    let ticks = |field: usize| after_name.split_whitespace().nth(field)?.parse::<f64>().ok();
    // User and system time, in hundredths of a second.
    Some((ticks(11)? + ticks(12)?) / 100.0)
}
