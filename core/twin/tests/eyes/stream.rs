//! The eyes as a live source.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_hardware::{Next, StereoSource};
use plumbline_twin::eyes::{SceneView, Sensor, TwinEyes, TwinEyesOptions, sample};

use super::{patch, renderer};

#[test]
fn the_stream_delivers_what_is_there_now() {
    if renderer().is_none() {
        return;
    }
    let (scenery, snapshot) = sample::lab();
    let scenery = Arc::new(scenery);
    let view: SceneView = Arc::new(move || (scenery.clone(), snapshot.clone()));
    assert!(TwinEyes::open(view.clone(), TwinEyesOptions { rate_hz: 0.0, ..Default::default() }).is_err());
    let mut eyes = TwinEyes::open(view, TwinEyesOptions::default()).expect("opened");
    let mut next = || {
        let begin = Instant::now();
        loop {
            match eyes.next_pair().expect("no error") {
                Next::Pair(pair) => return pair,
                _ if begin.elapsed() > Duration::from_secs(20) => panic!("no pair within 20 s"),
                _ => std::thread::sleep(Duration::from_millis(2)),
            }
        }
    };
    let (first, second) = (next(), next());
    assert_eq!((first.stamp.seq, second.stamp.seq), (0, 1));
    assert!(second.stamp.captured_at > first.stamp.captured_at);
    assert!(first.left != second.left, "noise stands still");
    let controls = eyes.controls();
    let dark = Sensor { exposure: 0.05, ..controls.sensor() };
    controls.set_sensor(dark).expect("usable");
    assert!(controls.set_sensor(Sensor { blur_px: -1.0, ..dark }).is_err());
    let bright = patch(&second.left, 300, 200, 60).0;
    let begin = Instant::now();
    loop {
        match eyes.next_pair().expect("no error") {
            Next::Pair(pair) if patch(&pair.left, 300, 200, 60).0 < 0.7 * bright => break,
            _ if begin.elapsed() > Duration::from_secs(20) => panic!("the exposure was not changed"),
            _ => std::thread::sleep(Duration::from_millis(5)),
        }
    }
    assert_eq!(eyes.describe().kind, plumbline_hardware::SourceKind::Twin);
}

#[test]
fn a_stream_that_cannot_go_on_says_why() {
    if renderer().is_none() {
        return;
    }
    let (scenery, mut snapshot) = sample::lab();
    snapshot.robot_from_body[0].translation.y = f64::NAN;
    let scenery = Arc::new(scenery);
    let view: SceneView = Arc::new(move || (scenery.clone(), snapshot.clone()));
    let mut eyes = TwinEyes::open(view, TwinEyesOptions::default()).expect("opened");
    let begin = Instant::now();
    let error = loop {
        match eyes.next_pair() {
            Err(error) => break error.to_string(),
            Ok(Next::NotYet) if begin.elapsed() < Duration::from_secs(20) => {
                std::thread::sleep(Duration::from_millis(5));
            }
            Ok(other) => panic!("{other:?}"),
        }
    };
    assert!(error.contains("body 0"), "{error}");
}
