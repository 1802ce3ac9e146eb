//! Views of data sets and of scores that no engine made, one per state.

use std::path::PathBuf;
use std::sync::Arc;

use image::{Rgb, RgbImage};
use plumbline_engine::view::{
    CellPicture, DetectError, ImportView, LabelBox, LabelCounts, LabelImage, LabelProblem, LabelSetView,
    LabelState, LabelsView, ModelScores, NotShown, OpenedCell, ProposedBox, Score, ScoreRow, ScoreTable,
    ScoredModelFile, ScoresView, ShownLabels,
};
use plumbline_engine::{ConfusionCell, JobId, View};
use plumbline_model::{ClassIndex, ClassNames, PixelBox};

use crate::made_up::everything;

/// The view of one state of labeling.
pub fn labeling(labels: LabelsView) -> View {
    View { labels: Arc::new(labels), ..everything() }
}

/// The view of one state of judging.
pub fn judging(scores: ScoresView) -> View {
    View { scores: Arc::new(scores), ..everything() }
}

/// A table with a few round things.
fn picture(number: u32) -> Arc<RgbImage> {
    let things = [(150, 210, [222, 190, 60]), (330, 250, [205, 70, 50]), (470, 190, [235, 150, 40])];
    Arc::new(RgbImage::from_fn(640, 480, |x, y| {
        let shift = 11 * (number % 5);
        for (u, v, color) in things {
            let (dx, dy) = (x.abs_diff(u + shift), y.abs_diff(v));
            if dx * dx + dy * dy < 30 * 30 {
                return Rgb(color);
            }
        }
        let level = 90 + (y / 8) as u8 + ((x / 40 + y / 40) % 2) as u8 * 6;
        Rgb([level, level - 8, level - 20])
    }))
}

fn label(class: usize, x: f32, y: f32) -> LabelBox {
    LabelBox { class: ClassIndex(class), area: PixelBox::from_middle(x, y, 64.0, 62.0) }
}

fn image(i: usize) -> LabelImage {
    let eye = if i.is_multiple_of(2) { "left" } else { "right" };
    let state = match i {
        0..=5 => LabelState::Labeled,
        6 => LabelState::ToCheck,
        _ => LabelState::Unlabeled,
    };
    LabelImage {
        name: format!("{eye}_{}.140322", 1_767_628_247 + 30 * (i / 2)),
        state,
        boxes: if state == LabelState::Unlabeled { 0 } else { 3 },
        unusable: None,
        problems: usize::from(i == 4),
    }
}

/// A data set is open and an image of it is shown.
pub fn open() -> LabelsView {
    let images: Vec<LabelImage> = (0..24).map(image).collect();
    let thumbnail = |number: u32| Arc::new(image::imageops::thumbnail(&*picture(number), 128, 96));
    let thumbnails = images.iter().zip(0..).map(|(image, number)| (image.name.clone(), thumbnail(number)));
    let problem = LabelProblem {
        image: images[4].name.clone(),
        index: Some(1),
        text: "Tomato: the same as box 1. Delete one of them.".to_owned(),
    };
    let set = LabelSetView { folder: "lab/toys-november".into(), names: ClassNames::published() };
    LabelsView {
        set: Some(Arc::new(set)),
        thumbnails: Arc::new(thumbnails.collect()),
        counts: LabelCounts { labeled: 6, unlabeled: 17, to_check: 1, boxes: 21 },
        shown: Some(ShownLabels {
            name: images[4].name.clone(),
            index: 4,
            pixels: Some(Ok(picture(4))),
            boxes: Arc::from([label(0, 194.0, 210.0), label(7, 374.0, 250.0)]),
            revision: 3,
            proposals: Arc::default(),
            proposing: false,
            locked: None,
            can_undo: true,
            can_redo: false,
            can_copy: true,
            problems: Arc::from([problem.clone()]),
        }),
        images: images.into(),
        problems: Arc::from([problem]),
        detector: Some("plumbline-detector".to_owned()),
        ..LabelsView::default()
    }
}

/// The detector proposed something.
pub fn proposed() -> LabelsView {
    let mut labels = open();
    if let Some(shown) = &mut labels.shown {
        let proposed = ProposedBox { label: label(5, 514.0, 190.0), confidence: 0.83 };
        shown.proposals = Arc::from([proposed]);
    }
    labels
}

/// Something is not on disk.
pub fn unsaved() -> LabelsView {
    let why = "Boxes of 1 image are not on disk: lab/toys-november/labels/left_1.txt cannot be written (No space left on device). They are kept here.";
    LabelsView { unsaved: Some(why.to_owned()), ..open() }
}

/// The shown image cannot be read.
pub fn unreadable() -> LabelsView {
    let mut labels = open();
    let why = "left_1767628307.140322.png cannot be read (unexpected end of file). Restore the file or take it out of the data set.".to_owned();
    if let Some(shown) = &mut labels.shown {
        shown.pixels = Some(Err(NotShown::Unusable(why.clone())));
        shown.locked = Some(why);
    }
    labels
}

/// An import waits.
pub fn import() -> LabelsView {
    let names = ["Banana", "LeftHand", "RightHand", "Tomato", "Cup"];
    let here = |name: &str| ClassNames::published().index_of(name);
    let view = ImportView {
        from: "colleague/data.yaml".into(),
        classes: names.iter().map(|name| ((*name).to_owned(), here(name))).collect(),
        renumbered: true,
        images: 240,
        boxes: 911,
        skipped: vec!["left_1767628247.140322".to_owned()],
        problems: vec!["colleague/labels/a.txt, line 2: the box has no extent.".to_owned()],
    };
    LabelsView { import: Some(Arc::new(view)), ..open() }
}

/// The last data set could not be opened.
pub fn not_opened() -> LabelsView {
    let why = "toys/data.yaml cannot be used (it has no names): give the data.yaml of a YOLO set.".to_owned();
    LabelsView { failed: Some(why), recent: Some("lab/toys-november".into()), ..LabelsView::default() }
}

fn files() -> Arc<[ScoredModelFile]> {
    let file = |name: &str, shipped| ScoredModelFile { file: PathBuf::from(name), chosen: true, shipped };
    Arc::from([
        file("plumbline-detector.onnx", true),
        file("yolo12s.onnx", false),
        file("yolov3-spp.onnx", false),
    ])
}

fn score(map50_95: f64, interval: bool) -> Score {
    let ends = |value: f64| interval.then_some([value - 0.04, (value + 0.03).min(1.0)]);
    let map50 = (map50_95 + 0.14).min(0.995);
    Score { map50_95, map50_95_interval: ends(map50_95), map50, map50_interval: ends(map50) }
}

/// What is said of a detector whose own boxes became the labels.
pub const OWN_LABELS: &str =
    "judged by itself: 189 of 230 labels stand exactly where it puts its own boxes, so it proposed them.";

fn scores(all: f64) -> ModelScores {
    let class =
        |i: usize| if i == 4 { None } else { Some(score((all + 0.012 * i as f64 - 0.03).min(0.99), true)) };
    let cell = |row: usize, column: usize| match (row, column) {
        (8, 8) => 0,
        (row, column) if row == column => 20 + 3 * row,
        (2, 6) | (6, 2) => 4,
        (row, 8) if row % 3 == 2 => 3,
        (8, 3) => 2,
        _ => 0,
    };
    ModelScores {
        all: score(all, true),
        tomato: Some(score((all + 0.12).min(0.97), true)),
        hands: Some(score(all - 0.15, false)),
        classes: (0..8).map(class).collect(),
        times_ms: [1.31, 14.2, 0.42],
        unknown_to_model: vec![],
        unknown_to_set: vec![],
        other_order: false,
        judged_by_itself: None,
        confusion: (0..9).map(|row| (0..9).map(|column| cell(row, column)).collect()).collect(),
        confusion_confidence: 0.25,
    }
}

/// Detectors and a data set are chosen.
pub fn chosen() -> ScoresView {
    ScoresView { models: files(), set: Some("lab/toys-november".into()), ..ScoresView::default() }
}

/// Judging is under way.
pub fn evaluating() -> ScoresView {
    ScoresView { evaluating: Some(JobId(7)), ..chosen() }
}

/// It failed.
pub fn failed() -> ScoresView {
    let why = "The val part of lab/toys-november has no box to judge by. Choose another part, or label its images first.";
    ScoresView { failed: Some(why.to_owned()), ..chosen() }
}

/// Three detectors were judged, one of them with trouble.
pub fn judged() -> ScoresView {
    let swapped = ModelScores {
        other_order: true,
        unknown_to_model: vec!["Onion".to_owned()],
        unknown_to_set: vec!["Cup".to_owned()],
        judged_by_itself: Some(OWN_LABELS.to_owned()),
        ..scores(0.71)
    };
    let (model, reason) = ("yolov3-spp.onnx".to_owned(), "it is a text".to_owned());
    let no_onnx = DetectError::NotOnnx { model, reason };
    let row = |model: &str, scores| ScoreRow { model: model.to_owned(), scores };
    let table = ScoreTable {
        set: "lab/toys-november".into(),
        names: ClassNames::published(),
        images: 120,
        instances: vec![23, 26, 31, 29, 0, 38, 42, 41],
        left_out: vec!["images/left_9.png: unexpected end of file.".to_owned()],
        rows: vec![
            row("plumbline-detector", Ok(scores(0.81))),
            row("yolo12s", Ok(swapped)),
            row("yolov3-spp", Err(Arc::new(no_onnx.into()))),
        ],
    };
    ScoresView { table: Some(Arc::new(table)), ..chosen() }
}

/// A cell is open.
pub fn cell() -> ScoresView {
    let pictures = (0..4u32).map(|i| CellPicture {
        name: format!("left_{}", 1_767_628_247 + i),
        pixels: Ok(picture(i)),
        truth: vec![label(2, 150.0, 210.0), label(7, 330.0, 250.0)],
        found: vec![
            ProposedBox { label: label(6, 153.0, 212.0), confidence: 0.71 },
            ProposedBox { label: label(7, 331.0, 250.0), confidence: 0.93 },
        ],
        in_cell: vec![(Some(0), Some(0))],
    });
    let opened = OpenedCell {
        model: 0,
        cell: ConfusionCell { truth: Some(2), found: Some(6) },
        pictures: pictures.collect(),
        of: 4,
    };
    ScoresView { cell: Some(Arc::new(opened)), ..judged() }
}

/// One of its images is large.
pub fn large() -> ScoresView {
    ScoresView { picture: Some(0), ..cell() }
}
