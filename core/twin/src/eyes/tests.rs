//! Laws of the renderer: geometry, occlusion, light, noise, errors.

use super::*;
use super::sample;

/// A renderer, or a word on why the test is left out.
fn renderer() -> Option<EyeRenderer> {
    match EyeRenderer::new(EyeOptions::default()) {
        Ok(renderer) => Some(renderer),
        Err(RenderError::NoAdapter) => {
            eprintln!("skipped: no Vulkan device on this machine");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn the_lab_looks_right() {
    let Some(mut renderer) = renderer() else { return };
    let (scenery, snapshot) = sample::lab();
    eprintln!("{} items", scenery.items.len());
    let pair = renderer.render(&scenery, &snapshot, &Sensor::default(), 1).expect("an image");
    let folder = std::env::temp_dir();
    pair.left.save(folder.join("twin_left.png")).expect("saved");
    pair.right.save(folder.join("twin_right.png")).expect("saved");
    let start = std::time::Instant::now();
    for seed in 0..10 {
        renderer.render(&scenery, &snapshot, &Sensor::default(), seed).expect("an image");
    }
    eprintln!("{:.1} ms per pair", start.elapsed().as_secs_f64() * 100.0);
}
