//! Times of the live pipeline and its parts, and its ratio to the published pipeline in the
//! same run: `cargo bench -p plumbline-vision --features peers`. Without the feature, ours alone.
//!
//! Works on a real pair if the measured data are at hand, else on a made-up one.

use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use image::GrayImage;
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use plumbline_model::aim::AimedPair;
use plumbline_model::{Workspace, measured_data};
use plumbline_vision::depth::PointMap;
use plumbline_vision::disparity::{Matcher, Settings};
#[cfg(feature = "peers")]
use plumbline_vision::disparity_bench::PublishedPipeline;
use plumbline_vision::disparity_bench::{LivePipeline, NEAREST_M, compare_with_published};
use plumbline_vision::rectify::Rectifier;
use plumbline_vision::synthetic::{Plane, Scene, granite_texture, nico_like_eyes};

/// Repetitions for the ratio.
const ROUNDS: usize = 25;

/// A real raw pair, or the reason why there is none.
fn real_pair() -> Result<(GrayImage, GrayImage), String> {
    let folder = measured_data::folder("nico-scenes").map_err(|reason| reason.to_string())?;
    let images = folder.join("images");
    let names = std::fs::read_dir(&images).map_err(|error| error.to_string())?;
    let mut rights: Vec<String> = names
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.starts_with("right_"))
        .collect();
    rights.sort_unstable();
    let right = rights.first().ok_or("there is no pair in nico-scenes")?;
    let gray = |name: &str| image::open(images.join(name)).map(|image| image.to_luma8());
    let left = gray(&right.replace("right_", "left_")).map_err(|error| error.to_string())?;
    Ok((left, gray(right).map_err(|error| error.to_string())?))
}

/// A table of granite.
fn made_up_pair() -> (GrayImage, GrayImage) {
    let workspace = Workspace::default();
    let height = Translation3::new(0.0, 0.0, workspace.table_height_m);
    let robot_from_table = Isometry3::from_parts(height, UnitQuaternion::identity());
    let left_from_table = workspace.robot_from_left.inverse().isometry * robot_from_table;
    let table = Plane::new(left_from_table, granite_texture(0.008, 7));
    Scene { planes: vec![table], ..Scene::default() }.render_pair(&nico_like_eyes(), 2.0, 11)
}

fn pipeline(criterion: &mut Criterion) {
    let (left, right) = real_pair().unwrap_or_else(|reason| {
        eprintln!("{reason}; a made-up pair is used");
        made_up_pair()
    });
    let pair = AimedPair::suited(&nico_like_eyes(), &Workspace::default()).expect("NICO's eyes can be aimed");
    let rectifier = Rectifier::new(&pair).expect("the eyes see the table");
    let settings = Settings::live(pair.disparity_at(NEAREST_M) as u32);
    let mut matcher = Matcher::new(settings).expect("usable range");
    let mut full = Matcher::new(Settings { quality: plumbline_vision::disparity::Quality::Full, ..settings })
        .expect("usable range");
    let views = rectifier.rectify_gray(&left, &right).expect("right size");
    let masks = Some(rectifier.masks());
    let map = matcher.compute(&views.left, &views.right, masks).expect("views of one size");

    let mut group = criterion.benchmark_group("pair");
    group.sample_size(30).warm_up_time(Duration::from_secs(1)).measurement_time(Duration::from_secs(3));
    group.bench_function("maps (once)", |b| b.iter(|| Rectifier::new(&pair)));
    group.bench_function("rectify", |b| b.iter(|| rectifier.rectify_gray(&left, &right)));
    group.bench_function("disparity, live", |b| b.iter(|| matcher.compute(&views.left, &views.right, masks)));
    group.bench_function("disparity, full", |b| b.iter(|| full.compute(&views.left, &views.right, masks)));
    group.bench_function("points", |b| b.iter(|| PointMap::new(&map, &pair)));
    let mut ours = LivePipeline::new(&pair, NEAREST_M).expect("usable range");
    group.bench_function("all, ours", |b| b.iter(|| ours.run(&left, &right)));
    #[cfg(feature = "peers")]
    let mut published = PublishedPipeline::new(&pair.cameras).expect("fisheye eyes");
    #[cfg(feature = "peers")]
    group.bench_function("all, published", |b| b.iter(|| published.run(&left, &right)));
    group.finish();

    let report = compare_with_published(&left, &right, &pair, NEAREST_M, ROUNDS).expect("both pipelines run");
    let (Some(published_ms), Some(ratio)) = (report.published_ms, report.ratio()) else {
        eprintln!(
            "ours {:.2} ms; to compare with the published pipeline, add --features peers",
            report.ours_ms
        );
        return;
    };
    eprintln!(
        "ours {:.2} ms, published {:.2} ms: ratio {:.3} on {} threads; depth step at 0.6 m {:.2} mm against {:.2} mm",
        report.ours_ms,
        published_ms,
        ratio,
        report.threads,
        1e3 * report.depth_step_ours_m,
        1e3 * report.depth_step_published_m
    );
}

criterion_group!(benches, pipeline);
criterion_main!(benches);
