//! Time of the detector on both eyes against the bare network, and against `predict` of
//! ultralytics on the same file with as many threads: `cargo bench -p plumbline-vision --bench detect`.
//!
//! Takes the detector that comes with the program, or the ONNX file that `PLUMBLINE_DETECTOR`
//! names; a real pair if the measured data are at hand, else a made-up one. Looks at all of the images,
//! at what is lit of them, and where the workspace would be with the head as it stands at rest are
//! taken in turn, so that another load of the machine counts for all of them. With
//! `PLUMBLINE_DETECTOR_BEFORE`, another ONNX file, that one takes its turn too and is what the others
//! are compared with. The comparison with the published way needs
//! a Python with ultralytics and onnxruntime: `PLUMBLINE_PYTHON`, else `python3`. Medians are taken
//! over `PLUMBLINE_ROUNDS`, else 40.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use image::RgbImage;
use plumbline_model::robot::Rig;
use plumbline_model::{Eye, StereoCalibration, measured_data};
use plumbline_vision::detect::{DetectSettings, Detector, DetectorOptions, Part, shipped_detector};
use plumbline_vision::detect_places::{PlaceFinder, PlaceOptions};
use plumbline_vision::synthetic::nico_like_eyes;

/// Both eyes may take so many times one bare run.
const MOST_RUNS: f64 = 2.1;
/// Both eyes with places may take so long on two idle cores, ms.
const MOST_BOTH_MS: f64 = 75.0;
/// The published way to run a detector.
const PEER: &str = include_str!("detect_peer.py");

/// Repetitions.
fn rounds() -> usize {
    let asked = std::env::var("PLUMBLINE_ROUNDS").ok().and_then(|text| text.parse().ok());
    asked.filter(|rounds| *rounds > 0).unwrap_or(40)
}

fn main() {
    let file = std::env::var_os("PLUMBLINE_DETECTOR").map(PathBuf::from);
    let Some(file) = file.or_else(|| shipped_detector().map(|shipped| shipped.file)) else {
        eprintln!("skipped: no detector comes with the program; set PLUMBLINE_DETECTOR to an ONNX file");
        return;
    };
    let mut detector = match Detector::open(&file, &DetectorOptions::default()) {
        Ok(detector) => detector,
        Err(reason) => {
            eprintln!("skipped: {reason}");
            return;
        }
    };
    eprintln!("{}", detector.info().summary());
    let pair = real_pair().unwrap_or_else(|reason| {
        eprintln!("{reason}; a made-up pair is used");
        made_up_pair()
    });
    let ours_ms = time(&mut detector, &pair);
    turns(&file, &pair);
    match peer_ms(&file, &pair[0]) {
        Ok(peer_ms) => {
            // Once more, so that another load of the machine does not count for one of them.
            let again_ms = time(&mut detector, &pair);
            let ours_ms = 0.5 * (ours_ms + again_ms);
            let ratio = ours_ms / peer_ms;
            eprintln!(
                "one image: ours {ours_ms:.2} ms, ultralytics {peer_ms:.2} ms: ratio {ratio:.3} (at most 1)"
            );
        }
        Err(reason) => eprintln!("skipped: comparison with ultralytics: {reason}"),
    }
}

/// A way of looking that is timed: what it is called, by which detector, at what of both eyes.
struct Way {
    name: &'static str,
    detector: Detector,
    parts: [Part; 2],
    times: Vec<Duration>,
}

/// Prints the time of both eyes with pairing and places, for all ways of looking in turn.
fn turns(file: &Path, pair: &[RgbImage; 2]) {
    let open = |file: &Path| Detector::open(file, &DetectorOptions::default()).expect("it opened before");
    let rig = Rig::built_in("nico").expect("comes with the program");
    let (cameras, workspace) = (rig.eyes.cameras, rig.workspace(&rig.home()));
    let size = pair[0].dimensions();
    let regions = Eye::BOTH.map(|eye| Part::of_workspace(&cameras, &workspace, eye, size));
    let way = |name, file: &Path, parts| Way { name, detector: open(file), parts, times: Vec::new() };
    let before = std::env::var_os("PLUMBLINE_DETECTOR_BEFORE").map(PathBuf::from);
    let mut ways: Vec<Way> = before.iter().map(|file| way("before", file, [Part::Whole; 2])).collect();
    ways.extend([
        way("all of the image", file, [Part::Whole; 2]),
        way("what is lit", file, [Part::Lit; 2]),
        way("the workspace", file, regions),
    ]);
    let calibration = StereoCalibration::bare(cameras);
    let mut finder = PlaceFinder::new(Some(&calibration), PlaceOptions::default());
    let (settings, mut boxes, mut places) = (DetectSettings::default(), [Vec::new(), Vec::new()], Vec::new());
    for round in 0..rounds() + 3 {
        for Way { detector, parts, times, .. } in &mut ways {
            let begun = Instant::now();
            for ((image, part), found) in pair.iter().zip(parts).zip(&mut boxes) {
                detector.detect_in(image, *part, &settings, found).expect("the network runs");
            }
            finder.find((&pair[0], &boxes[0]), (&pair[1], &boxes[1]), &mut places);
            if round >= 3 {
                times.push(begun.elapsed());
            }
        }
    }
    let of_first = median_ms(ways[0].times.clone());
    for Way { name, times, .. } in ways {
        let ms = median_ms(times);
        eprintln!(
            "both eyes with places, {name}: {ms:.1} ms, ratio {:.3} (at most {MOST_BOTH_MS} ms)",
            ms / of_first
        );
    }
}

/// Prints where the time goes and returns that of one image, ms.
fn time(detector: &mut Detector, pair: &[RgbImage; 2]) -> f64 {
    let settings = DetectSettings::default();
    let calibration = StereoCalibration::bare(nico_like_eyes());
    let mut finder = PlaceFinder::new(Some(&calibration), PlaceOptions::default());
    let (mut left, mut right, mut places) = (Vec::new(), Vec::new(), Vec::new());
    let mut times: [Vec<Duration>; 6] = Default::default();
    for round in 0..rounds() + 5 {
        let begun = Instant::now();
        let timing = detector.detect(&pair[0], &settings, &mut left).expect("the network runs");
        let one = begun.elapsed();
        detector.detect(&pair[1], &settings, &mut right).expect("the network runs");
        finder.find((&pair[0], &left), (&pair[1], &right), &mut places);
        let both = begun.elapsed();
        let bare = detector.run_again().expect("the network runs");
        if round >= 5 {
            let row = [timing.before, timing.network, timing.after, one, both, bare];
            times.iter_mut().zip(row).for_each(|(times, time)| times.push(time));
        }
    }
    let [before, network, after, one, both, bare] = times.map(median_ms);
    let ratio = both / bare;
    eprintln!("{} boxes left, {} right, {} things", left.len(), right.len(), places.len());
    eprintln!("one image {one:.2} ms: letterbox {before:.2}, network {network:.2}, suppression {after:.2}");
    eprintln!(
        "both eyes with pairing and places {both:.2} ms, bare network once {bare:.2} ms: ratio {ratio:.3} (at most {MOST_RUNS})"
    );
    one
}

fn median_ms(mut times: Vec<Duration>) -> f64 {
    times.sort_unstable();
    times[times.len() / 2].as_secs_f64() * 1e3
}

/// Median time of `predict`, with as many threads as here.
fn peer_ms(model: &Path, image: &RgbImage) -> Result<f64, String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let png = folder.path().join("image.png");
    image.save(&png).map_err(|error| error.to_string())?;
    let python = std::env::var_os("PLUMBLINE_PYTHON").unwrap_or_else(|| "python3".into());
    let output = Command::new(&python)
        .args(["-c", PEER])
        .args([model.as_os_str(), png.as_os_str()])
        .arg(rounds().to_string())
        .output()
        .map_err(|error| format!("{} cannot be run ({error})", python.display()))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let said = String::from_utf8_lossy(&output.stderr);
    let number = text.lines().last().and_then(|line| line.trim().parse().ok());
    number.ok_or_else(|| said.lines().last().unwrap_or("it printed no number").to_owned())
}

fn real_pair() -> Result<[RgbImage; 2], String> {
    let images = measured_data::folder("nico-scenes").map_err(|reason| reason.to_string())?.join("images");
    let entries = std::fs::read_dir(&images).map_err(|error| error.to_string())?;
    let mut rights: Vec<String> = entries
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.starts_with("right_"))
        .collect();
    rights.sort_unstable();
    let right = rights.first().ok_or("there is no pair in nico-scenes")?;
    let read = |name: &str| {
        image::open(images.join(name)).map(|image| image.to_rgb8()).map_err(|error| error.to_string())
    };
    Ok([read(&right.replace("right_", "left_"))?, read(right)?])
}

fn made_up_pair() -> [RgbImage; 2] {
    [0u32, 24].map(|shift| {
        RgbImage::from_fn(640, 480, |x, y| {
            let x = x + shift;
            image::Rgb(
                [x * y / 300, (x / 40 + y / 40) % 2 * 200, x * x / 900 + y].map(|value| (value % 256) as u8),
            )
        })
    })
}
