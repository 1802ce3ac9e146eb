//! Prints how much the twin of a scenario misses, beside the real robot.
#![allow(clippy::print_stdout, reason = "this is its purpose")]

use std::sync::Arc;

use nalgebra::Vector3;
use plumbline_model::robot::Rig;
use plumbline_twin::{Scenario, judging};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "lab".to_owned());
    let scenario = if name.ends_with(".toml") {
        Scenario::from_toml(&name, &std::fs::read_to_string(&name)?)?
    } else {
        Scenario::built_in(&name)?
    };
    let rig = Arc::new(Rig::built_in("nico")?);
    let touches = judging::touches(&rig, &scenario, 1, 9, 4)?;
    let errors: Vec<_> = touches.iter().filter_map(|touch| touch.error_m).collect();
    for touch in &touches {
        match touch.error_m {
            Some(e) => println!(
                "{:6.0?} px: {:6.1} {:6.1} mm, upright {:.2}",
                touch.target_px,
                e.x * 1e3,
                e.y * 1e3,
                touch.upright
            ),
            None => println!("{:6.0?} px: no touch, upright {:.2}", touch.target_px, touch.upright),
        }
    }
    let count = errors.len().max(1) as f64;
    let mean = errors.iter().map(|e| e.norm()).sum::<f64>() / count;
    let bias = errors.iter().sum::<nalgebra::Vector2<f64>>() / count;
    let spread = (errors.iter().map(|e| (e - bias).norm_squared()).sum::<f64>() / count).sqrt();
    let most = errors.iter().map(|e| e.norm()).fold(0.0, f64::max);
    println!(
        "{name}: {} of {} touched; error mean {:.1} mm, most {:.1} mm, bias {:.1} {:.1} mm, rms about it {:.1} mm",
        errors.len(),
        touches.len(),
        mean * 1e3,
        most * 1e3,
        bias.x * 1e3,
        bias.y * 1e3,
        spread * 1e3,
    );
    println!("the real robot: mean 11.5 mm, most 28.7 mm, rms about a rigid placement 6.8 mm");
    let corners = [[0.5, 0.4], [0.5, -0.4], [0.5, 0.0], [0.35, 0.0], [0.2, 0.4], [0.2, 0.0]];
    let points = corners.map(|[x, y]| Vector3::new(x, y, 0.05));
    for minutes in [2.0, 5.0, 10.0, 30.0] {
        for drift in judging::drift(&rig, &scenario, &points, minutes)? {
            let (p, d, e) = (drift.point, drift.drift_m * 1e3, drift.cold_error_m * 1e3);
            println!(
                "{minutes:4.0} min at ({:.2}, {:5.2}): drift {:5.1} mm ({:.1} {:.1} {:.1}); cold error {:.1} mm",
                p.x,
                p.y,
                d.norm(),
                d.x,
                d.y,
                d.z,
                e.norm()
            );
        }
    }
    Ok(())
}
