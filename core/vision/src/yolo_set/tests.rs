//! Sets written and read, and what is wrong with sets.

use std::path::{Path, PathBuf};

use plumbline_model::{ClassIndex, ClassNames, PixelBox, Unattended};
use tempfile::TempDir;

use super::*;

fn image_file(folder: &Path, name: &str, size_px: (u32, u32), shade: u8) -> PathBuf {
    std::fs::create_dir_all(folder).expect("a folder");
    let path = folder.join(name);
    image::RgbImage::from_pixel(size_px.0, size_px.1, image::Rgb([shade; 3])).save(&path).expect("saved");
    path
}

fn text_file(path: &Path, text: &str) {
    std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
    std::fs::write(path, text).expect("written");
}

fn labeled(path: PathBuf, boxes: Vec<LabeledBox>, split: Option<Split>) -> LabeledImage {
    LabeledImage { scene: scene_of(&path), path, size_px: (64, 48), boxes, split }
}

fn a_box(class: usize) -> LabeledBox {
    LabeledBox { class: ClassIndex(class), area: PixelBox::new(3.3, 7.1, 21.7, 40.9) }
}

fn two_names() -> ClassNames {
    ClassNames::new(["Tomato", "Left hand's palm"])
}

/// A set of ten pairs, all of one part or of none.
fn pairs(folder: &Path, split: Option<Split>) -> YoloSet {
    let mut images = Vec::new();
    for scene in 0..10 {
        for side in ["left", "right"] {
            let name = format!("{side}_{}.25.png", 1_767_628_247 + 60 * scene);
            let path = image_file(folder, &name, (64, 48), scene as u8);
            images.push(labeled(path, vec![a_box(scene % 2)], split));
        }
    }
    images.sort_by(|a, b| a.path.cmp(&b.path));
    YoloSet { names: two_names(), images }
}

#[test]
fn what_is_written_is_read_again() {
    let folder = TempDir::new().expect("a folder");
    let mut set = pairs(&folder.path().join("from"), Some(Split::Train));
    set.images[0].boxes.clear();
    let to = folder.path().join("to");
    let report = set.write(&to, &WriteOptions::default(), &Unattended).expect("written");
    assert_eq!((report.added, report.boxes, report.backgrounds, report.per_split), (20, 19, 1, [20, 0, 0]));
    let survey = YoloSet::survey(&report.data_yaml, &Split::ALL, &Unattended).expect("read");
    assert_eq!((survey.problems.len(), survey.without_labels), (0, 0));
    assert_eq!(survey.set.names, set.names);
    for (read, written) in survey.set.images.iter().zip(&set.images) {
        assert_eq!(read.path.file_name(), written.path.file_name());
        assert_eq!((&read.scene, read.size_px, read.split), (&written.scene, written.size_px, written.split));
        assert_eq!(read.boxes.len(), written.boxes.len());
        for (read, written) in read.boxes.iter().zip(&written.boxes) {
            assert_eq!(read.class, written.class);
            assert!((read.area.x0_px - written.area.x0_px).abs() < 1e-4);
            assert!((read.area.y1_px - written.area.y1_px).abs() < 1e-4);
        }
    }
}

#[test]
fn pairs_and_neighbors_in_time_stay_together() {
    let folder = TempDir::new().expect("a folder");
    let mut set = pairs(folder.path(), None);
    // A second after the first pair: nothing has moved.
    let path = image_file(folder.path(), "left_1767628248.25.png", (64, 48), 99);
    set.images.push(labeled(path, Vec::new(), None));
    let mut again = set.clone();
    let counts = set.split(&SplitOptions::default()).expect("split");
    assert_eq!((counts.scenes, counts.train + counts.val), (10, 21));
    assert!((3..=5).contains(&counts.val), "{counts:?}");
    let part = |scene: &str| -> Vec<Split> {
        set.images.iter().filter(|image| image.scene == scene).filter_map(|image| image.split).collect()
    };
    for image in &set.images {
        assert!(part(&image.scene).iter().all(|split| Some(*split) == image.split));
    }
    assert_eq!(part("1767628247.25")[0], part("1767628248.25")[0]);
    again.split(&SplitOptions::default()).expect("split");
    assert_eq!(again, set, "the same seed, the same parts");
    let seeds = (2..12).map(|seed| {
        let mut other = set.clone();
        other.images.iter_mut().for_each(|image| image.split = None);
        other.split(&SplitOptions { seed, ..SplitOptions::default() }).expect("split");
        other
    });
    assert!(seeds.into_iter().any(|other| other != set), "another seed, other parts");
}

#[test]
fn the_order_of_images_does_not_change_their_parts() {
    let folder = TempDir::new().expect("a folder");
    let mut set = pairs(folder.path(), None);
    let mut turned = set.clone();
    turned.images.reverse();
    set.split(&SplitOptions::default()).expect("split");
    turned.split(&SplitOptions::default()).expect("split");
    turned.images.reverse();
    assert_eq!(turned, set);
}

#[test]
fn one_scene_cannot_be_split() {
    let folder = TempDir::new().expect("a folder");
    let mut set = pairs(folder.path(), None);
    set.images.truncate(1);
    let error = set.split(&SplitOptions::default()).expect_err("one scene");
    assert!(error.to_string().contains("one scene"), "{error}");
    let error = set.split(&SplitOptions { val_fraction: 1.0, ..SplitOptions::default() });
    assert!(matches!(error, Err(YoloSetError::Fraction(_))));
}

#[test]
fn a_set_with_other_names_or_another_order_is_not_added_to() {
    let folder = TempDir::new().expect("a folder");
    let set = pairs(&folder.path().join("from"), Some(Split::Val));
    let to = folder.path().join("to");
    let report = set.write(&to, &WriteOptions::default(), &Unattended).expect("written");
    let before = std::fs::read_to_string(&report.data_yaml).expect("there");
    let mut turned = set.clone();
    turned.names = ClassNames::new(["Left hand's palm", "Tomato"]);
    let error = turned.write(&to, &WriteOptions::default(), &Unattended).expect_err("another order");
    let words = error.to_string();
    assert!(
        words.contains("Tomato, Left hand's palm") && words.contains("Left hand's palm, Tomato"),
        "{words}"
    );
    assert_eq!(std::fs::read_to_string(&report.data_yaml).expect("there"), before);
}

#[test]
fn adding_keeps_the_part_of_images_and_scenes_and_writes_corrected_boxes() {
    let folder = TempDir::new().expect("a folder");
    let from = folder.path().join("from");
    let set = pairs(&from, Some(Split::Val));
    let to = folder.path().join("to");
    set.write(&to, &WriteOptions::default(), &Unattended).expect("written");
    let mut more = set.clone();
    more.images.truncate(1);
    more.images[0].split = Some(Split::Train);
    more.images[0].boxes = vec![a_box(0), a_box(1)];
    let new = image_file(&from, "1767628247.25_third.png", (64, 48), 77);
    more.images.push(labeled(new, Vec::new(), Some(Split::Train)));
    more.images[1].scene = "1767628247.25".to_owned();
    let report = more.write(&to, &WriteOptions::default(), &Unattended).expect("added");
    assert_eq!((report.added, report.relabeled, report.per_split), (1, 1, [0, 2, 0]));
    let read = YoloSet::read(&report.data_yaml, Split::Val).expect("read");
    assert_eq!(read.images.len(), 21);
    let of = |name: &str| read.images.iter().find(|image| image.path.ends_with(name)).expect("there");
    assert_eq!(of("left_1767628247.25.png").boxes.len(), 2);
    assert_eq!(of("1767628247.25_third.png").scene, "1767628247.25", "the table of scenes is read");
    // The same name for another picture.
    image_file(&from, "left_1767628247.25.png", (64, 48), 200);
    let error = more.write(&to, &WriteOptions::default(), &Unattended).expect_err("another picture");
    assert!(matches!(error, YoloSetError::NameTaken(_)), "{error}");
}

#[test]
fn a_folder_with_something_else_is_not_written_to() {
    let folder = TempDir::new().expect("a folder");
    let set = pairs(&folder.path().join("from"), Some(Split::Val));
    let error = set.write(folder.path(), &WriteOptions::default(), &Unattended).expect_err("not empty");
    assert!(matches!(error, YoloSetError::NotASet(_)), "{error}");
}

#[test]
fn bad_rows_are_named_and_the_rest_is_read() {
    let folder = TempDir::new().expect("a folder");
    let images = folder.path().join("images");
    for name in ["a.png", "b.png", "c.png"] {
        image_file(&images, name, (100, 50), 9);
    }
    text_file(&images.join("broken.png"), "no picture");
    let rows = "0 0.5 0.5 0.2 0.4\n\n5 0.5 0.5 0.2 0.2\n0 0.5 0.5 0.2\n0 0.5 0.5 nan 0.2\n0 50 20 10 10\n\
                0.5 0.5 0.5 0.1 0.1\n0 0.5 0.5 0 0.1\n0 0.5 0.5 0.1 0.1 0.93\n0 0.5 0.5 0.2 0.4\n\
                1 0.1 0.2 0.3 0.2 0.3 0.6 0.1 0.6\n";
    text_file(&folder.path().join("labels/a.txt"), rows);
    text_file(&folder.path().join("labels/b.txt"), "");
    let yaml = folder.path().join("data.yaml");
    text_file(&yaml, "train: images\nnc: 2\nnames: [Tomato, Duck]\n");
    let survey = YoloSet::survey(&yaml, &[Split::Train], &Unattended).expect("read");
    let lines: Vec<Option<usize>> = survey.problems.iter().map(|problem| problem.line).collect();
    assert_eq!(lines, [3, 4, 5, 6, 7, 8, 9].map(Some).into_iter().chain([None]).collect::<Vec<_>>());
    for (problem, words) in survey.problems.iter().zip([
        "class 5",
        "4 numbers",
        "nan",
        "50 is outside",
        "0.5",
        "no extent",
        "confidence",
        "no image",
    ]) {
        assert!(problem.to_string().contains(words), "{problem} should say {words}");
    }
    assert_eq!((survey.polygons, survey.repeated_rows, survey.without_labels), (1, 1, 1));
    assert_eq!(survey.set.images.len(), 3);
    let areas: Vec<PixelBox> = survey.set.images[0].boxes.iter().map(|labeled| labeled.area).collect();
    assert_eq!(areas, [PixelBox::new(40.0, 15.0, 60.0, 35.0), PixelBox::new(10.0, 10.0, 30.0, 30.0)]);
    let error = YoloSet::read(&yaml, Split::Train).expect_err("strict");
    assert!(error.to_string().contains("a.txt, line 3"), "{error}");
}

#[test]
fn every_way_to_say_where_images_are() {
    let folder = TempDir::new().expect("a folder");
    let root = folder.path().join("set");
    let first = image_file(&root.join("one/images"), "a.png", (8, 8), 1);
    image_file(&root.join("two/images/deep"), "b.jpg", (8, 8), 2);
    text_file(&root.join("two/labels/deep/b.txt"), "0 0.5 0.5 0.5 0.5\n");
    text_file(&root.join("list.txt"), &format!("./two/images/deep/b.jpg\n{}\n", first.display()));
    let yaml = folder.path().join("data.yaml");
    let paths = |text: &str, split| {
        text_file(&yaml, &format!("{text}\nnames:\n  0: Tomato\n"));
        YoloSet::read(&yaml, split).map(|set| set.images.len())
    };
    assert_eq!(paths("path: set\ntrain: one/images\nval: two/images", Split::Val).expect("a folder"), 1);
    assert_eq!(paths("path: set\nval: [one/images, two/images]", Split::Val).expect("folders"), 2);
    assert_eq!(paths("path: set\nval: list.txt", Split::Val).expect("a list"), 2);
    assert_eq!(paths("val: ../set/one/images", Split::Val).expect("packed"), 1);
    assert_eq!(paths(&format!("path: {}\nval: two", root.display()), Split::Val).expect("absolute"), 1);
    let missing = paths("path: set\nval: three/images", Split::Val).expect_err("no folder");
    assert!(missing.to_string().contains("three/images"), "{missing}");
    let other = paths("path: set\ntrain: one/images", Split::Val).expect_err("no val");
    assert!(other.to_string().contains("only train"), "{other}");
}

#[test]
fn names_are_a_list_or_numbered_and_agree_with_their_count() {
    let folder = TempDir::new().expect("a folder");
    let yaml = folder.path().join("data.yaml");
    let names = |text: &str| {
        text_file(&yaml, text);
        YoloSet::read_names(&yaml)
    };
    let expected = ClassNames::new(["Tomato", "Duck"]);
    assert_eq!(names("train: x\nnames: ['Tomato', Duck]").expect("a list"), expected);
    assert_eq!(names("train: x\nnc: 2\nnames:\n  1: Duck\n  0: Tomato").expect("numbered"), expected);
    assert_eq!(names("names: [1, 2]").expect("numbers as names"), ClassNames::new(["1", "2"]));
    let words = |text: &str| names(text).expect_err("refused").to_string();
    assert!(words("nc: 3\nnames: [Tomato, Duck]").contains("nc: 3 but names 2"));
    assert!(words("names:\n  0: Tomato\n  2: Duck").contains("no number 1"));
    assert!(words("names: [Tomato, Tomato]").contains("Tomato"));
    assert!(words("train: images").contains("no names"));
    assert!(words("just a sentence").contains("data.yaml"));
    assert!(YoloSet::read_names(&folder.path().join("none.yaml")).is_err());
}

#[test]
fn classes_are_joined_by_name_never_by_number() {
    let theirs = ClassNames::new(["Duck", "left hand", "Tomato", "Lemon"]);
    let ours = ClassNames::published();
    let proposal = MappingProposal::new(&theirs, &ours);
    assert!(proposal.renumbered);
    let unknown: Vec<(&str, Option<ClassIndex>)> =
        proposal.unknown.iter().map(|class| (class.name.as_str(), class.similar)).collect();
    assert_eq!(unknown, [("left hand", Some(ClassIndex(2))), ("Lemon", None)]);
    let error = ClassMapping::by_name(&theirs, &ours).expect_err("not all known");
    assert!(error.to_string().contains("left hand, Lemon"), "{error}");
    let choices = [ClassTarget::Class(ClassIndex(2)), ClassTarget::LeaveOut];
    let mapping = proposal.decide(&choices).expect("decided");
    let folder = TempDir::new().expect("a folder");
    let path = image_file(folder.path(), "a.png", (64, 48), 5);
    let set = YoloSet { names: theirs, images: vec![labeled(path, (0..4).map(a_box).collect(), None)] };
    let mapped = set.mapped(&mapping);
    let classes: Vec<usize> = mapped.images[0].boxes.iter().map(|labeled| labeled.class.0).collect();
    assert_eq!((classes, &mapped.names), (vec![1, 2, 7], &ours));
    assert!(proposal.decide(&[ClassTarget::LeaveOut, ClassTarget::Class(ClassIndex(8))]).is_err());
}

#[test]
fn scenes_by_name() {
    let scene = |name: &str| scene_of(Path::new(name));
    assert_eq!(scene("x/left_1767628247.1403224.jpg"), "1767628247.1403224");
    assert_eq!(scene("right_1767628247.1403224.jpg"), scene("left_1767628247.1403224.png"));
    assert_eq!(scene("000012-L.png"), scene("000012-R.png"));
    assert_eq!(scene("left_17_jpg.rf.8ab.jpg"), scene("right_17_jpg.rf.9cd.jpg"));
    assert_ne!(scene("a_l_1.png"), scene("a_r_1.png"), "a letter in the middle may mean anything");
    assert_eq!(scene("left.png"), "left");
    assert_eq!(seconds_of("1767628247.5"), Some(1_767_628_247.5));
    assert_eq!(seconds_of("table_1767628247500"), Some(1_767_628_247.5));
    assert_eq!(seconds_of("000012"), None);
}

#[test]
fn labels_lie_beside_the_last_folder_of_images() {
    let label = |image: &str| label_file_of(Path::new(image));
    assert_eq!(label("/a/images/b/images/c.jpg"), Path::new("/a/images/b/labels/c.txt"));
    assert_eq!(label("/a/b/images"), Path::new("/a/b/images.txt"));
    assert_eq!(label("/a/b/c.d.png"), Path::new("/a/b/c.d.txt"));
}
