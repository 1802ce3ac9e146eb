//! Draws a training set: `… --example training_set -- FOLDER [PAIRS] [SEED] [FIRST] [VAL_SHARE]`.

#![allow(clippy::print_stdout)]

use std::path::PathBuf;
use std::time::Instant;

use plumbline_model::Unattended;
use plumbline_twin::training_set::{SetOptions, generate};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, or: u64| arguments.get(i).map_or(Ok(or), |text| text.parse());
    let out = PathBuf::from(arguments.first().ok_or("name a folder")?);
    let options = SetOptions {
        pairs: number(1, 20)? as usize,
        seed: number(2, 1)?,
        first: number(3, 0)? as usize,
        val_share: arguments.get(4).map_or(Ok(0.1), |text| text.parse())?,
    };
    let start = Instant::now();
    let summary = generate(&out, &options, &Unattended)?;
    println!("{summary:?}, {:.2} pairs/s", summary.pairs as f64 / start.elapsed().as_secs_f64());
    Ok(())
}
