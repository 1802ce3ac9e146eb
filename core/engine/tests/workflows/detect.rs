//! Detection, driven without threads, with detectors that are made up.

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use image::{Rgb, RgbImage};
use plumbline_engine::detect::{DetectStage, DetectorError, Detects, OpenDetector};
use plumbline_engine::ground::stage::{Stage, Timed};
use plumbline_engine::state::State;
use plumbline_engine::view::{DetectionTiming, DetectorFacts, DetectorState, LookedAt, SourceView};
use plumbline_engine::{
    Action, AimChoice, Command, DetectCommand, DetectorChoice, LiveCommand, Products, Skipped, SourceSpec,
    View,
};
use plumbline_model::detection::{ClassIndex, ClassNames, Detection, PixelBox};
use plumbline_model::robot::Rig;
use plumbline_model::{Eye, Stamp, StereoFrame, Unattended};
use plumbline_vision::detect::{DetectError, Part};

const SIZE_PX: (u32, u32) = (640, 480);

/// What the made-up detector does on the next image.
#[derive(Clone, Default)]
struct Plan {
    /// What it sees in the left and in the right eye.
    boxes: [Vec<Detection>; 2],
    /// Runs of the network so far.
    runs: Arc<AtomicUsize>,
    /// Fails with these words, or panics.
    trouble: Option<(String, bool)>,
    /// What was looked at, eye by eye.
    parts: Arc<Mutex<Vec<Part>>>,
}

#[derive(Clone, Default)]
struct FakeDetector(Arc<Mutex<Plan>>);

impl Detects for FakeDetector {
    fn facts(&self) -> DetectorFacts {
        DetectorFacts { name: "made up".to_owned(), names: ClassNames::published(), ..Default::default() }
    }

    fn detect(
        &mut self,
        _: &RgbImage,
        _: f32,
        found: &mut Vec<Detection>,
    ) -> Result<DetectionTiming, DetectorError> {
        found.clear();
        let plan = self.0.lock().expect("no test panics with the lock").clone();
        let run = plan.runs.fetch_add(1, Ordering::SeqCst);
        match plan.trouble {
            Some((words, true)) => panic!("{words}"),
            Some((reason, false)) => {
                return Err(DetectError::Run { model: "good.onnx".to_owned(), reason }.into());
            }
            None => found.extend_from_slice(&plan.boxes[run % 2]),
        }
        Ok(DetectionTiming::default())
    }

    fn detect_in(
        &mut self,
        image: &RgbImage,
        part: Part,
        iou: f32,
        found: &mut Vec<Detection>,
    ) -> Result<DetectionTiming, DetectorError> {
        self.0.lock().expect("no test panics with the lock").parts.lock().expect("likewise").push(part);
        self.detect(image, iou, found)
    }
}

/// A state with its detection stage, looking through eyes with nominal lenses.
struct Desk {
    state: State,
    stage: DetectStage,
    plan: Arc<Mutex<Plan>>,
    seq: u64,
}

impl Desk {
    fn new(folder: &Path) -> Self {
        let fake = FakeDetector::default();
        let plan = fake.0.clone();
        let mut state = State::new(folder);
        state.set_detector_opener(OpenDetector::new(move |choice, _| match choice {
            DetectorChoice::File(file) if !file.ends_with("good.onnx") => {
                let (model, reason) = ("bad.onnx".to_owned(), "it is a text".to_owned());
                Err(DetectError::NotOnnx { model, reason }.into())
            }
            _ => Ok(Box::new(fake.clone())),
        }));
        state.source_changed(SourceView { spec: Some(SourceSpec::Twin), ..SourceView::default() });
        let mut desk = Self { state, stage: DetectStage::default(), plan, seq: 0 };
        desk.work();
        desk
    }

    /// Boxes are wanted, and a detector sees these things.
    fn looking(folder: &Path, left: Vec<Detection>, right: Vec<Detection>) -> Self {
        let mut desk = Self::new(folder);
        desk.plan.lock().expect("fresh").boxes = [left, right];
        desk.apply(LiveCommand::Want(Products { detections: true, ..Products::default() }));
        desk
    }

    fn apply(&mut self, command: impl Into<Command>) {
        self.state.apply(command.into());
        self.work();
    }

    fn trouble(&self, trouble: Option<(&str, bool)>) {
        let trouble = trouble.map(|(words, panics)| (words.to_owned(), panics));
        self.plan.lock().expect("fresh").trouble = trouble;
    }

    fn runs(&self) -> usize {
        self.plan.lock().expect("fresh").runs.load(Ordering::SeqCst)
    }

    /// A pair comes from the source; the stage is not run yet.
    fn show(&mut self) {
        let image = Arc::new(RgbImage::from_pixel(SIZE_PX.0, SIZE_PX.1, Rgb([90, 100, 110])));
        let frame = StereoFrame {
            stamp: Stamp { seq: self.seq, captured_at: Instant::now() },
            left: image.clone(),
            right: image,
            time_difference_s: None,
            name: None,
            beside: Default::default(),
        };
        self.seq += 1;
        self.state.frame(0, frame, Instant::now());
    }

    /// The stage does what there is to do.
    fn detect(&mut self) {
        let Some(input) = self.state.detect_input() else { return };
        let stamp = input.frame.stamp;
        let result = self.stage.process(input);
        self.state.detected(Timed { stamp, busy: Duration::ZERO, result }, Instant::now());
    }

    fn work(&mut self) {
        loop {
            let actions = self.state.take_actions();
            if actions.is_empty() {
                return;
            }
            for action in actions {
                let Action::Start(id, work) = action else { continue };
                self.state.work_ended(id, work.run(&Unattended).into(), Duration::ZERO);
            }
        }
    }

    fn view(&mut self) -> View {
        self.state.view(Skipped::default(), 0, Instant::now())
    }

    /// Names and confidences of what is shown, in order.
    fn shown(&mut self) -> Vec<(String, f32)> {
        let view = self.view();
        let found = view.detect.found.as_ref().map(|found| found.objects.clone()).unwrap_or_default();
        found.iter().map(|object| (object.name.clone(), object.confidence())).collect()
    }
}

fn thing(class: usize, confidence: f32, at: (f32, f32)) -> Detection {
    let area = PixelBox::from_middle(at.0, at.1, 30.0, 30.0);
    Detection { class: ClassIndex(class), confidence, area }
}

fn names(shown: &[(String, f32)]) -> Vec<&str> {
    shown.iter().map(|(name, _)| name.as_str()).collect()
}

/// Boxes of a ball in both eyes, and where it is in the left eye's frame.
fn ball(class: usize) -> ([Detection; 2], [f64; 3]) {
    let at_m = [0.03, 0.05, 0.42];
    let cameras = Rig::built_in("nico").expect("comes with the program").eyes.cameras;
    let in_left = plumbline_model::Point::new(at_m[0], at_m[1], at_m[2]);
    let in_right = cameras.right_from_left * in_left;
    let boxes =
        [(Eye::Left, in_left.coords.coords), (Eye::Right, in_right.coords.coords)].map(|(eye, at)| {
            let middle = cameras.camera(eye).project(&at).expect("in view");
            thing(class, 0.9, (middle.u_px as f32 + 0.5, middle.v_px as f32 + 0.5))
        });
    (boxes, at_m)
}

#[test]
fn a_threshold_changes_what_is_shown_at_once_and_the_network_is_not_run_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let boxes =
        vec![thing(0, 0.9, (100.0, 100.0)), thing(7, 0.4, (300.0, 200.0)), thing(5, 0.1, (400.0, 300.0))];
    let mut desk = Desk::looking(folder.path(), boxes, vec![]);
    desk.show();
    desk.detect();
    assert_eq!(names(&desk.shown()), ["Banana", "Tomato"], "0.25 is the usual threshold");
    let runs = desk.runs();
    assert_eq!(runs, 2, "both eyes");

    desk.apply(DetectCommand::Confidence(0.5));
    desk.detect();
    assert_eq!(names(&desk.shown()), ["Banana"]);
    desk.apply(DetectCommand::ClassConfidence { class: "Orange".to_owned(), confidence: Some(0.05) });
    desk.detect();
    assert_eq!(names(&desk.shown()), ["Banana", "Orange"]);
    desk.apply(DetectCommand::Show { class: "Banana".to_owned(), shown: false });
    desk.detect();
    assert_eq!(names(&desk.shown()), ["Orange"]);
    let left_out = desk.view().detect.found.as_ref().map(|found| found.left_out);
    assert_eq!((left_out, desk.runs()), (Some(2), runs));

    // What is one thing is decided by the network's answer itself.
    desk.apply(DetectCommand::Iou(0.3));
    desk.detect();
    assert_eq!(desk.runs(), runs + 2);
}

#[test]
fn thresholds_out_of_range_are_refused_and_change_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut desk = Desk::looking(folder.path(), vec![], vec![]);
    for bad in [f32::NAN, -0.1, 1.5, 0.01] {
        desk.apply(DetectCommand::Confidence(bad));
        assert_eq!(desk.view().detect.settings.confidence, 0.25);
    }
    let last = desk.view().notices.last().map(|notice| notice.text.clone()).unwrap_or_default();
    assert!(last.contains("between 0.05 and 1"), "{last}");
}

#[test]
fn an_object_of_both_eyes_has_a_place_and_one_of_a_single_eye_a_reason() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let ([left, right], at_m) = ball(7);
    let mut desk = Desk::looking(folder.path(), vec![left, thing(0, 0.8, (200.0, 150.0))], vec![right]);
    desk.show();
    desk.detect();
    let view = desk.view();
    let found = view.detect.found.as_ref().expect("found");
    assert_eq!(found.no_places_because, None);
    let [tomato, banana] = &found.objects[..] else { panic!("{:?}", found.objects) };
    assert!(tomato.in_both() && tomato.epipolar_px.expect("paired").abs() < 0.5, "{tomato:?}");
    let place = tomato.place.as_ref().expect("a place");
    let range_m = at_m.iter().map(|m| m * m).sum::<f64>().sqrt();
    assert!((place.range_m - range_m).abs() < 0.04 + 2.0 * place.range_sigma_m, "{place:?}");
    assert!(place.sigma_m.iter().all(|sigma| *sigma > 1e-4 && *sigma < 0.2), "{place:?}");
    let seen = tomato.left.as_ref().expect("in both");
    assert!(!seen.line_in_other.is_empty());
    let why = banana.place.as_ref().expect_err("one eye tells no distance");
    assert!(why.to_string().contains("left eye") && banana.alone_because.is_some(), "{why}");
}

#[test]
fn the_workspace_is_looked_at_while_nothing_is_beyond_it() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut desk = Desk::looking(folder.path(), vec![], vec![]);
    let mut looked = |ceiling: &[Detection]| {
        desk.plan.lock().expect("no panic").boxes[1] = ceiling.to_vec();
        desk.show();
        desk.detect();
        let parts = desk.plan.lock().expect("no panic").parts.clone();
        std::mem::take(&mut *parts.lock().expect("no panic"))
    };
    assert_eq!(looked(&[]), [Part::Lit; 2], "first everything");
    let part = looked(&[]);
    let [Part::Region(left), Part::Region(right)] = part[..] else { panic!("{part:?}") };
    for region in [left, right] {
        let share = f64::from(region.width_px * region.height_px) / f64::from(SIZE_PX.0 * SIZE_PX.1);
        assert!(share > 0.02 && share < 0.5 && region.on_image(SIZE_PX) == Some(region), "{region:?}");
    }
    let beyond = [thing(6, 0.9, (320.0, 40.0))];
    let found = (0..8).find(|_| looked(&beyond) == [Part::Lit; 2]);
    assert!(found.is_some(), "what is beyond is found after some pairs");
    let with_it = looked(&beyond);
    assert_eq!(with_it[0], part[0]);
    assert!(
        matches!(with_it[1], Part::Region(region) if region.holds(&beyond[0].area)),
        "it is kept in view: {with_it:?}"
    );
    looked(&[]);
    assert_eq!(looked(&[]), [Part::Lit; 2], "what is gone is looked for");
    assert_eq!(looked(&[]), part);
    let at = desk.view().detect.found.as_ref().expect("found").looked_at;
    assert!(matches!(at, LookedAt::Workspace { with_beyond: false, .. }), "{at:?}");
    assert!(at.words().contains("the workspace"), "{}", at.words());
}

#[test]
fn rates_count_pairs_not_moves_of_a_slider_and_begin_anew_when_asked() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let ([left, right], _) = ball(7);
    let mut desk = Desk::looking(folder.path(), vec![left], vec![right]);
    for _ in 0..3 {
        desk.show();
        desk.detect();
        desk.detect();
    }
    let detect = desk.view().detect;
    assert_eq!(detect.counted, 3);
    let tomato = detect.rates.iter().find(|rates| rates.name == "Tomato").expect("counted");
    assert_eq!((tomato.left, tomato.right, tomato.agree), (1.0, 1.0, Some(1.0)));
    desk.apply(DetectCommand::ResetRates);
    assert_eq!(desk.view().detect.counted, 0);
}

#[test]
fn a_detector_that_cannot_be_read_is_a_sentence_and_can_be_read_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut desk = Desk::new(folder.path());
    desk.apply(DetectCommand::Use(DetectorChoice::File("bad.onnx".into())));
    desk.apply(LiveCommand::Want(Products { detections: true, ..Products::default() }));
    desk.show();
    let view = desk.view();
    let DetectorState::Failed { name, why } = &view.detect.detector else { panic!("{:?}", view.detect) };
    let told =
        "bad.onnx is not a usable ONNX file (it is a text): export the detector again with format=onnx.";
    assert_eq!((name.as_str(), why.as_str()), ("bad.onnx", told));
    assert!(view.live.raw.is_some() && desk.state.detect_input().is_none());

    desk.apply(DetectCommand::Use(DetectorChoice::Shipped));
    assert!(matches!(desk.view().detect.detector, DetectorState::Ready(_)));
    // The one in use goes on when another one cannot be had.
    desk.apply(DetectCommand::Use(DetectorChoice::File("bad.onnx".into())));
    let view = desk.view();
    assert!(matches!(view.detect.detector, DetectorState::Ready(_)));
    assert!(
        view.detect.refused.as_ref().is_some_and(|why| why.contains("not a usable ONNX file")),
        "{:?}",
        view.detect
    );
    assert!(desk.state.detect_input().is_some());
}

#[test]
fn a_detector_that_fails_on_a_pair_says_so_and_goes_on_with_the_next() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut desk = Desk::looking(folder.path(), vec![thing(0, 0.9, (100.0, 100.0))], vec![]);
    desk.trouble(Some(("one pixel", false)));
    desk.show();
    desk.detect();
    let view = desk.view();
    let told = "good.onnx failed on this image (one pixel): try another file; if it goes on, export the detector again.";
    assert_eq!(view.detect.failed.as_deref(), Some(told));
    assert!(view.detect.found.is_none() && matches!(view.detect.detector, DetectorState::Ready(_)));
    desk.trouble(None);
    desk.show();
    desk.detect();
    assert_eq!(desk.view().detect.failed, None);
    assert_eq!(names(&desk.shown()), ["Banana"]);
}

#[test]
fn a_detector_that_panics_is_let_go_and_the_pictures_go_on() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut desk = Desk::looking(folder.path(), vec![], vec![]);
    desk.trouble(Some(("index 9 out of range", true)));
    desk.show();
    desk.detect();
    let view = desk.view();
    let DetectorState::Failed { why, .. } = &view.detect.detector else { panic!("{:?}", view.detect) };
    assert!(why.contains("index 9 out of range") && why.contains("choose another one"), "{why}");
    let runs = desk.runs();
    desk.show();
    desk.detect();
    assert_eq!(desk.runs(), runs, "it is not asked again");
    assert!(desk.view().live.raw.as_ref().is_some_and(|frame| frame.stamp.seq == 1));
    desk.trouble(None);
    desk.apply(DetectCommand::Retry);
    desk.detect();
    assert!(desk.view().detect.found.is_some());
}

#[test]
fn what_an_earlier_detector_or_setup_found_is_not_shown_as_new() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let ([left, right], _) = ball(7);
    let mut desk = Desk::looking(folder.path(), vec![left], vec![right]);
    desk.show();
    let input = desk.state.detect_input().expect("there is a detector");
    let stamp = input.frame.stamp;
    let late = desk.stage.process(input);
    desk.apply(DetectCommand::Use(DetectorChoice::File("good.onnx".into())));
    desk.state.detected(Timed { stamp, busy: Duration::ZERO, result: late }, Instant::now());
    assert!(desk.view().detect.found.is_none(), "another detector is in use by now");

    desk.detect();
    assert_eq!(desk.view().detect.stale, None);
    let aim = AimChoice::Manual { pitch_rad: 0.4, horizontal_field_of_view_rad: 1.2 };
    desk.apply(LiveCommand::Aim(aim));
    let stale = desk.view().detect.stale.clone().expect("places rest on the aim before");
    assert!(stale.contains("anew"), "{stale}");
    desk.detect();
    assert_eq!(desk.view().detect.stale, None);
}

#[test]
fn boxes_of_the_photograph_before_are_said_to_be_that() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut desk = Desk::looking(folder.path(), vec![thing(0, 0.9, (100.0, 100.0))], vec![]);
    desk.state.source_changed(SourceView { photographs: true, ..SourceView::default() });
    desk.show();
    desk.detect();
    assert_eq!(desk.view().detect.stale, None);
    desk.show();
    let stale = desk.view().detect.stale.clone().expect("this one was not looked at yet");
    assert!(stale.contains("pair before"), "{stale}");
    let found = desk.view().detect.found.clone().expect("still drawn");
    assert!(found.no_places_because.as_ref().is_some_and(|why| why.contains("calibrat")), "{found:?}");
}

#[test]
fn nothing_is_read_or_run_while_nobody_looks() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut desk = Desk::new(folder.path());
    desk.show();
    desk.detect();
    assert_eq!((desk.runs(), desk.view().detect.detector.clone()), (0, DetectorState::None));
    desk.apply(LiveCommand::Want(Products { detections: true, ..Products::default() }));
    desk.detect();
    assert_eq!(desk.runs(), 2);
    desk.apply(LiveCommand::Want(Products::default()));
    assert!(desk.view().detect.found.is_none() && desk.state.detect_input().is_none());
}

#[test]
fn thresholds_filter_and_detector_are_remembered() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut desk = Desk::new(folder.path());
    desk.apply(DetectCommand::Confidence(0.4));
    desk.apply(DetectCommand::Show { class: "Duck".to_owned(), shown: false });
    desk.apply(DetectCommand::Use(DetectorChoice::File("good.onnx".into())));
    let settings = desk.view().detect.settings.clone();
    let mut again = Desk::new(folder.path());
    assert_eq!(again.view().detect.settings, settings);
    assert_eq!(settings.detector, DetectorChoice::File("good.onnx".into()));

    std::fs::write(folder.path().join("detection.json"), "{\"confidence\": 7}").expect("written");
    let mut broken = Desk::new(folder.path());
    assert_eq!(broken.view().detect.settings.confidence, 0.25);
    let told = broken.view().notices.iter().any(|notice| notice.text.contains("detection.json"));
    assert!(told, "{:?}", broken.view().notices);
}
