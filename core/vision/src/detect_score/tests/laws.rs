//! What must hold of any score.

use plumbline_model::{ClassIndex, ClassNames, PixelBox};

use super::super::*;

/// A few things in two classes on some images, and boxes around most of them, from a seed.
fn some_images(seed: u64) -> Vec<ScoredImage> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut random = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let image = |_| {
        let mut image = ScoredImage::default();
        for _ in 0..3 {
            let class = ClassIndex((random() * 2.0) as usize);
            let area = ScoreBox {
                x_px: 400.0 * random(),
                y_px: 300.0 * random(),
                width_px: 10.0 + 90.0 * random(),
                height_px: 10.0 + 90.0 * random(),
            };
            image.truth.push(TruthBox::new(class, area));
            let near =
                ScoreBox { x_px: area.x_px + 8.0 * random(), y_px: area.y_px - 8.0 * random(), ..area };
            if random() < 0.9 {
                image.found.push(FoundBox { class, confidence: 0.2 + 0.8 * random(), area: near });
            }
            if random() < 0.3 {
                let far = ScoreBox { x_px: 600.0 * random(), ..area };
                image.found.push(FoundBox { class, confidence: random(), area: far });
            }
        }
        image
    };
    (0..12).map(image).collect()
}

fn score(images: &[ScoredImage]) -> Scores {
    average_precision(images, 2, &IouThresholds::coco())
}

#[test]
fn perfect_boxes_score_one_and_none_score_zero() {
    let mut images = some_images(1);
    for image in &mut images {
        image.found =
            image.truth.iter().map(|t| FoundBox { class: t.class, confidence: 0.9, area: t.area }).collect();
    }
    let perfect = score(&images).overall;
    for ap in [perfect.ap, perfect.ap50, perfect.ap75, perfect.ar_100] {
        assert!((ap.expect("there is truth") - 1.0).abs() < 1e-12);
    }
    images.iter_mut().for_each(|image| image.found.clear());
    assert_eq!(score(&images).overall.ap, Some(0.0));
}

#[test]
fn a_wrong_box_less_sure_than_all_never_helps_and_one_surer_than_all_hurts() {
    for seed in 1..20 {
        let images = some_images(seed);
        let before = score(&images);
        let class = ClassIndex(0);
        let with = |confidence: f64| {
            let mut with = images.clone();
            let area = ScoreBox { x_px: 5000.0, y_px: 5000.0, width_px: 20.0, height_px: 20.0 };
            with[3].found.push(FoundBox { class, confidence, area });
            score(&with).per_class[0].summary.ap.expect("there is truth")
        };
        let ap = before.per_class[0].summary.ap.expect("there is truth");
        assert!(with(1e-6) <= ap + 1e-12);
        assert!(with(1.0) < ap, "seed {seed}");
    }
}

#[test]
fn neither_the_order_of_images_nor_of_boxes_matters() {
    for seed in 1..20 {
        let images = some_images(seed);
        let mut turned = images.clone();
        turned.reverse();
        for image in &mut turned {
            image.truth.reverse();
            image.found.reverse();
        }
        let (a, b) = (score(&images).overall, score(&turned).overall);
        for (a, b) in a.in_order().into_iter().zip(b.in_order()) {
            assert!((a.unwrap_or(-1.0) - b.unwrap_or(-1.0)).abs() < 1e-12, "seed {seed}");
        }
    }
}

#[test]
fn a_score_only_depends_on_the_order_of_confidences() {
    let images = some_images(5);
    let mut squeezed = images.clone();
    squeezed
        .iter_mut()
        .flat_map(|image| &mut image.found)
        .for_each(|found| found.confidence = found.confidence.powi(3));
    assert_eq!(score(&images).overall, score(&squeezed).overall);
}

#[test]
fn a_higher_overlap_is_never_easier() {
    for seed in 1..20 {
        let summary = score(&some_images(seed)).overall;
        assert!(summary.ap50 >= summary.ap75 && summary.ap50 >= summary.ap, "seed {seed}");
    }
}

#[test]
fn a_class_that_is_nowhere_has_no_score() {
    let mut images = some_images(2);
    images.iter_mut().for_each(|image| image.truth.retain(|truth| truth.class.0 == 0));
    let scores = score(&images);
    assert_eq!(scores.per_class[1].summary.ap, None);
    assert_eq!(scores.overall.ap, scores.per_class[0].summary.ap);
    assert_eq!(score(&[]).overall, Summary::default());
    assert_eq!(scores.best_confidence(ClassIndex(1)), None);
    assert_eq!(scores.at_confidence(ClassIndex(1), 0.5).expect("a class").recall(), None);
    assert_eq!(scores.at_confidence(ClassIndex(2), 0.5), None);
}

#[test]
fn thresholds_count_right_wrong_and_missed() {
    let area = |x_px: f64| ScoreBox { x_px, y_px: 0.0, width_px: 10.0, height_px: 10.0 };
    let class = ClassIndex(0);
    let found = |x_px, confidence| FoundBox { class, confidence, area: area(x_px) };
    let image = ScoredImage {
        truth: [0.0, 100.0, 200.0].map(|x_px| TruthBox::new(class, area(x_px))).to_vec(),
        found: vec![
            found(0.0, 0.9),
            found(500.0, 0.8),
            found(100.0, 0.6),
            found(700.0, 0.6),
            found(200.0, 0.1),
        ],
    };
    let scores = average_precision(&[image], 1, &IouThresholds::coco());
    let point = scores.at_confidence(class, 0.5).expect("a class");
    assert_eq!((point.right, point.wrong, point.missed), (2, 2, 1));
    assert_eq!((point.precision(), point.recall()), (Some(0.5), Some(2.0 / 3.0)));
    let none = scores.at_confidence(class, 0.95).expect("a class");
    assert_eq!((none.precision(), none.recall()), (None, Some(0.0)));
    // All five: 3 right, 2 wrong, F1 0.75; the first alone: 0.5; four: 4/7.
    let best = scores.best_confidence(class).expect("found");
    assert_eq!((best.confidence, best.f1()), (0.1, Some(0.75)));
}

#[test]
fn every_thing_and_every_box_is_in_one_cell() {
    for seed in 1..20 {
        let images = some_images(seed);
        let options = ConfusionOptions::default();
        let matrix = ConfusionMatrix::new(&images, 2, &options);
        let mut things = vec![0; images.len()];
        let mut boxes = vec![0; images.len()];
        for truth in matrix.lines() {
            for found in matrix.lines() {
                for entry in matrix.entries(Cell { truth, found }) {
                    things[entry.image] += usize::from(entry.truth.is_some());
                    boxes[entry.image] += usize::from(entry.found.is_some());
                    let image = &images[entry.image];
                    assert_eq!(entry.truth.map(|thing| image.truth[thing].class), truth);
                    assert_eq!(entry.found.map(|found| image.found[found].class), found);
                }
            }
        }
        for (index, image) in images.iter().enumerate() {
            let sure = image.found.iter().filter(|found| found.confidence >= options.confidence).count();
            assert_eq!((things[index], boxes[index]), (image.truth.len(), sure));
        }
    }
}

#[test]
fn a_matrix_shows_what_is_taken_for_what() {
    let area = |x: f32| PixelBox::new(x, 0.0, x + 10.0, 10.0);
    let truth = |class, x| TruthBox::new(ClassIndex(class), area(x));
    let found =
        |class, confidence, x| FoundBox { class: ClassIndex(class), confidence, area: area(x).into() };
    let crowd = TruthBox { crowd: true, ..truth(0, 900.0) };
    let image = ScoredImage {
        truth: vec![truth(0, 0.0), truth(1, 100.0), truth(1, 200.0), crowd],
        found: vec![
            found(0, 0.9, 1.0),
            found(0, 0.8, 100.0),
            found(1, 0.2, 200.0),
            found(1, 0.7, 300.0),
            found(0, 0.7, 900.0),
        ],
    };
    let matrix = ConfusionMatrix::new(&[image], 2, &ConfusionOptions::default());
    let cell = |truth: Option<usize>, found: Option<usize>| {
        matrix.count(Cell { truth: truth.map(ClassIndex), found: found.map(ClassIndex) })
    };
    assert_eq!(cell(Some(0), Some(0)), 1);
    assert_eq!(cell(Some(1), Some(0)), 1, "a duck taken for a banana");
    assert_eq!(cell(Some(1), None), 1, "its box is not sure enough");
    assert_eq!(cell(None, Some(1)), 1);
    assert_eq!(cell(None, Some(0)), 0, "inside a crowd");
    assert_eq!(cell(Some(7), None), 0);
    let text = matrix_csv(&matrix, &ClassNames::new(["Banana", "Duck, yellow"]));
    let expected = "there / taken for,Banana,\"Duck, yellow\",missed\nBanana,1,0,0\n\"Duck, yellow\",1,0,1\nnothing there,0,1,\n";
    assert_eq!(text, expected);
}

#[test]
fn intervals_hold_the_score_and_shrink_with_more_scenes() {
    let few = some_images(3);
    let many: Vec<ScoredImage> = (1..12).flat_map(some_images).collect();
    let width = |images: &[ScoredImage]| {
        let scores = score(images);
        let names: Vec<String> = (0..images.len()).map(|i| i.to_string()).collect();
        let scenes: Vec<&str> = names.iter().map(String::as_str).collect();
        let groups = [vec![1], vec![0, 1], vec![]];
        let intervals = scores.intervals(&scenes, &groups, &IntervalOptions::default());
        assert_eq!(intervals, scores.intervals(&scenes, &groups, &IntervalOptions::default()));
        let ScoreIntervals { overall, per_class, groups } = intervals;
        assert_eq!(groups, [per_class[1], overall, Intervals::default()], "classes taken as one");
        let interval = overall.ap50.expect("enough scenes");
        let ap50 = scores.overall.ap50.expect("there is truth");
        assert!(interval.low <= ap50 && ap50 <= interval.high, "{interval:?} {ap50}");
        assert_eq!(per_class.len(), 2);
        interval.high - interval.low
    };
    let (few, many) = (width(&few), width(&many));
    assert!(many < 0.6 * few, "{many} {few}");
}

#[test]
fn images_of_one_scene_are_one_witness() {
    let images = some_images(4);
    let scores = score(&images);
    let ScoreIntervals { overall, per_class, .. } =
        scores.intervals(&["the same"; 12], &[], &IntervalOptions::default());
    assert_eq!(overall, Intervals::default(), "one scene says nothing of others");
    assert!(per_class.iter().all(|class| *class == Intervals::default()));
    // Every image twice: the same witnesses, so the same interval.
    let names: Vec<String> = (0..24).map(|i| format!("{:02}", i / 2)).collect();
    let twice: Vec<ScoredImage> = images.iter().flat_map(|image| [image.clone(), image.clone()]).collect();
    let scenes: Vec<&str> = names.iter().map(String::as_str).collect();
    let once: Vec<&str> = scenes.iter().step_by(2).copied().collect();
    let options = IntervalOptions { draws: 50, ..IntervalOptions::default() };
    let of_twice = score(&twice).intervals(&scenes, &[], &options);
    let (a, b) = (scores.intervals(&once, &[], &options).overall.ap50, of_twice.overall.ap50);
    let (a, b) = (a.expect("enough"), b.expect("enough"));
    assert!((a.low - b.low).abs() < 0.02 && (a.high - b.high).abs() < 0.02, "{a:?} {b:?}");
}

#[test]
fn one_box_with_two_classes_is_one_box_of_the_matrix() {
    let area = ScoreBox { x_px: 5.0, y_px: 5.0, width_px: 10.0, height_px: 10.0 };
    let found = |class, confidence| FoundBox { class: ClassIndex(class), confidence, area };
    let image = ScoredImage {
        truth: vec![TruthBox::new(ClassIndex(0), area)],
        found: vec![found(0, 0.4), found(1, 0.7)],
    };
    let matrix = ConfusionMatrix::new(&[image], 2, &ConfusionOptions::default());
    let boxes: usize = matrix
        .lines()
        .flat_map(|truth| matrix.lines().map(move |found| (truth, found)))
        .map(|(truth, found)| matrix.count(Cell { truth, found }))
        .sum();
    assert_eq!(boxes, 1);
    assert_eq!(matrix.count(Cell { truth: Some(ClassIndex(0)), found: Some(ClassIndex(1)) }), 1);
}
