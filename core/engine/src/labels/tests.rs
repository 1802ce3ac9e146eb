//! A data set from the first capture to the export, as commands and finished work; and what goes wrong.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use image::{Rgb, RgbImage};
use plumbline_model::{ClassIndex, ClassNames, Detection, PixelBox, Stamp, StereoFrame, Unattended};
use plumbline_vision::yolo_set::{Split, YoloSet};

use super::command::{BoxEdit, LabelsCommand};
use super::view::LabelState;
use crate::command::Command;
use crate::detect::view::{DetectionTiming, DetectorFacts};
use crate::detect::{DetectorError, Detects, OpenDetector};
use crate::state::{Action, State};
use crate::view::View;

/// The state with its work done at once, in the order in which it was asked for.
struct Desk {
    state: State,
    folder: tempfile::TempDir,
}

impl Desk {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut desk = Self { state: State::new(&folder.path().join("data")), folder };
        desk.work();
        desk
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

    fn send(&mut self, command: LabelsCommand) -> View {
        self.state.apply(Command::Labels(command));
        self.work();
        self.view()
    }

    fn view(&mut self) -> View {
        self.state.view(Default::default(), 0, Instant::now())
    }

    fn said(&mut self) -> String {
        self.view().notices.last().map(|notice| notice.text.clone()).unwrap_or_default()
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn see(&mut self, seq: u64) {
        let image = |level: u8| Arc::new(RgbImage::from_pixel(64, 48, Rgb([level, 40, 90])));
        let stamp = Stamp { seq, captured_at: Instant::now() };
        let frame = StereoFrame {
            stamp,
            left: image(10 + seq as u8),
            right: image(200 - seq as u8),
            time_difference_s: None,
            name: None,
            beside: Default::default(),
        };
        self.state.frame(0, frame, Instant::now());
    }

    /// A new data set with so many pairs.
    fn with_pairs(pairs: u64) -> Self {
        let mut desk = Self::new();
        let (folder, names) = (desk.path("toys"), vec!["Tomato".into(), "Duck".into()]);
        desk.send(LabelsCommand::Create { folder, names });
        for seq in 1..=pairs {
            desk.see(seq);
            desk.send(LabelsCommand::Capture);
            std::thread::sleep(Duration::from_millis(2));
        }
        desk
    }

    fn add(&mut self, x: f32, class: usize) -> View {
        let area = PixelBox::new(x, 10.0, x + 16.0, 26.0);
        let image = self.view().labels.shown.as_ref().expect("an image is shown").name.clone();
        self.send(LabelsCommand::Edit { image, edit: BoxEdit::Add { class: ClassIndex(class), area } })
    }

    fn label_text(&mut self) -> Option<String> {
        let name = self.view().labels.shown.as_ref()?.name.clone();
        std::fs::read_to_string(self.path(&format!("toys/labels/{name}.txt"))).ok()
    }
}

#[test]
fn a_captured_pair_is_labeled_and_every_change_is_on_disk() {
    let mut desk = Desk::with_pairs(1);
    let view = desk.view();
    let names: Vec<&str> = view.labels.images.iter().map(|image| image.name.as_str()).collect();
    assert!(names.len() == 2 && names[0].starts_with("left_") && names[1].starts_with("right_"));
    assert_eq!(names[0]["left_".len()..], names[1]["right_".len()..], "one scene, one time");
    assert_eq!(desk.label_text(), None, "nobody said anything about it yet");

    desk.add(8.0, 1);
    assert_eq!(desk.label_text().as_deref(), Some("1 0.25000000 0.37500000 0.25000000 0.33333333\n"));
    let view = desk.add(30.0, 0);
    assert_eq!(view.labels.shown.as_ref().map(|shown| shown.boxes.len()), Some(2));
    assert_eq!(desk.label_text().map(|text| text.lines().count()), Some(2));

    desk.send(LabelsCommand::Undo);
    desk.send(LabelsCommand::Undo);
    assert_eq!(desk.label_text(), None, "taken back to nobody having said anything");
    assert_eq!(desk.view().labels.images[0].state, LabelState::Unlabeled);
    desk.send(LabelsCommand::Redo);
    assert_eq!(desk.label_text().map(|text| text.lines().count()), Some(1));

    let again = desk.send(LabelsCommand::Open { path: desk.path("toys") });
    assert_eq!(again.labels.images[0].boxes, 1);
    assert_eq!(again.labels.images[0].state, LabelState::Labeled);
    assert_eq!(again.labels.images[1].state, LabelState::Unlabeled);
}

#[test]
fn the_same_pair_is_captured_once() {
    let mut desk = Desk::with_pairs(1);
    desk.send(LabelsCommand::Capture);
    assert!(desk.said().contains("in the data set already"));
    assert_eq!(desk.view().labels.images.len(), 2);
}

#[test]
fn boxes_are_copied_from_the_image_before_of_the_same_eye() {
    let mut desk = Desk::with_pairs(2);
    let names: Vec<String> = desk.view().labels.images.iter().map(|i| i.name.clone()).collect();
    desk.send(LabelsCommand::Choose { image: names[0].clone() });
    desk.add(8.0, 0);
    desk.send(LabelsCommand::Step(1));
    desk.add(30.0, 1);
    let view = desk.send(LabelsCommand::Choose { image: names[2].clone() });
    assert!(view.labels.shown.as_ref().is_some_and(|shown| shown.can_copy));
    let view = desk.send(LabelsCommand::CopyPrevious);
    let shown = view.labels.shown.as_ref().expect("shown");
    assert_eq!(shown.boxes.len(), 1);
    assert_eq!(shown.boxes[0].class, ClassIndex(0), "from the left image, not from the one just before");
    let view = desk.send(LabelsCommand::Undo);
    assert!(view.labels.shown.as_ref().is_some_and(|shown| shown.boxes.is_empty()));
}

#[test]
fn nothing_here_is_an_empty_file_and_to_check_is_kept_beside() {
    let mut desk = Desk::with_pairs(1);
    let view = desk.send(LabelsCommand::NothingHere);
    assert_eq!(desk.label_text().as_deref(), Some(""));
    assert_eq!(view.labels.counts.labeled, 1);
    let view = desk.send(LabelsCommand::ToCheck(true));
    assert_eq!((view.labels.counts.labeled, view.labels.counts.to_check), (0, 1));
    let again = desk.send(LabelsCommand::Open { path: desk.path("toys") });
    assert_eq!(again.labels.counts.to_check, 1);
    desk.send(LabelsCommand::ToCheck(false));
    assert!(!desk.path("toys/to-check.txt").exists());
}

struct Finds;

impl Detects for Finds {
    fn facts(&self) -> DetectorFacts {
        DetectorFacts { names: ClassNames::new(["Duck", "Cup", "Tomato"]), ..DetectorFacts::default() }
    }

    fn detect(
        &mut self,
        _: &RgbImage,
        _: f32,
        found: &mut Vec<Detection>,
    ) -> Result<DetectionTiming, DetectorError> {
        found.clear();
        for (class, confidence) in [(2, 0.9), (1, 0.8), (0, 0.1)] {
            let area = PixelBox::new(10.0, 10.0, 30.0, 30.0);
            found.push(Detection { class: ClassIndex(class), confidence, area });
        }
        Ok(DetectionTiming::default())
    }
}

#[test]
fn proposals_are_matched_by_name_and_are_nothing_until_accepted() {
    let mut desk = Desk::with_pairs(1);
    desk.state.set_detector_opener(OpenDetector::new(|_, _| Ok(Box::new(Finds))));
    let view = desk.send(LabelsCommand::Propose);
    let shown = view.labels.shown.as_ref().expect("shown");
    let proposed: Vec<usize> = shown.proposals.iter().map(|p| p.label.class.0).collect();
    assert_eq!(proposed, [0], "Tomato is number 2 there and 0 here; Cup is unknown; Duck is too unsure");
    assert!(desk.view().notices.iter().any(|notice| notice.text.contains("(Cup)")));
    assert_eq!(desk.label_text(), None);
    let view = desk.send(LabelsCommand::AcceptProposals);
    let shown = view.labels.shown.as_ref().expect("shown");
    assert!(shown.proposals.is_empty() && shown.boxes.len() == 1);
    assert!(desk.label_text().is_some_and(|text| text.starts_with("0 ")));
}

#[test]
fn a_corrected_proposal_is_accepted_as_it_was_corrected() {
    let mut desk = Desk::with_pairs(1);
    desk.state.set_detector_opener(OpenDetector::new(|_, _| Ok(Box::new(Finds))));
    desk.send(LabelsCommand::Propose);
    let area = Some(PixelBox::new(12.0, 12.0, 28.0, 28.0));
    let view = desk.send(LabelsCommand::AcceptProposal { index: 0, class: Some(ClassIndex(1)), area });
    let shown = view.labels.shown.as_ref().expect("shown");
    assert_eq!((shown.boxes[0].class, Some(shown.boxes[0].area)), (ClassIndex(1), area));
    assert!(shown.proposals.is_empty());
}

#[test]
fn an_export_is_split_by_scene_and_keeps_the_order_of_classes() {
    let mut desk = Desk::with_pairs(1);
    // Scenes lie seconds apart, as a person captures them.
    for second in 0..9 {
        for eye in ["left", "right"] {
            let name = format!("{eye}_{}.500000.png", 1_767_628_247 + 10 * second);
            let image = RgbImage::from_pixel(64, 48, Rgb([second as u8, 9, 9]));
            image.save(desk.path("toys/images").join(name)).expect("written");
        }
    }
    let view = desk.send(LabelsCommand::Open { path: desk.path("toys") });
    for image in view.labels.images.iter() {
        desk.send(LabelsCommand::Choose { image: image.name.clone() });
        desk.add(8.0, 0);
    }
    desk.send(LabelsCommand::ToCheck(true));
    let folder = desk.path("export");
    let export = LabelsCommand::Export { folder: folder.clone(), train_percent: 80, seed: 3 };
    desk.send(export.clone());
    assert!(desk.said().contains("images to train on"), "{}", desk.said());
    let set = YoloSet::read_all(&folder.join("data.yaml")).expect("a good data set");
    assert_eq!(set.names, ClassNames::new(["Tomato", "Duck"]));
    assert_eq!(set.images.len(), 19, "what is to be checked stays behind");
    let of = |split| set.images.iter().filter(move |i| i.split == Some(split)).map(|i| i.scene.as_str());
    assert!(of(Split::Val).all(|scene| of(Split::Train).all(|other| other != scene)));
    assert!((3..=5).contains(&of(Split::Val).count()), "about a fifth");
    desk.send(export);
    assert!(desk.said().contains("is not empty"), "an export never mixes with another one");
}

fn write_other_set(folder: &Path, names: &str) {
    std::fs::create_dir_all(folder.join("images")).expect("made");
    std::fs::create_dir_all(folder.join("labels")).expect("made");
    std::fs::write(folder.join("data.yaml"), format!("train: images\nval: images\nnames: {names}\n"))
        .expect("written");
    RgbImage::new(64, 48).save(folder.join("images/left_1.png")).expect("written");
    std::fs::write(folder.join("labels/left_1.txt"), "0 0.5 0.5 0.5 0.5\n2 0.5 0.5 0.2 0.2\n")
        .expect("written");
}

#[test]
fn an_import_with_other_order_is_matched_by_name_and_shown_before_anything_is_written() {
    let mut desk = Desk::with_pairs(1);
    let other = desk.path("other");
    write_other_set(&other, "[Duck, Tomato, Cup]");
    let view = desk.send(LabelsCommand::Import { path: other });
    let plan = view.labels.import.clone().expect("a plan");
    assert!(plan.renumbered);
    let classes: Vec<Option<usize>> = plan.classes.iter().map(|(_, here)| here.map(|c| c.0)).collect();
    assert_eq!(classes, [Some(1), Some(0), None]);
    assert_eq!((plan.images, plan.boxes), (1, 1));
    assert!(!desk.path("toys/images/left_1.png").exists(), "nothing is written yet");
    let view = desk.send(LabelsCommand::AcceptImport);
    assert_eq!(view.labels.images.len(), 3);
    let text = std::fs::read_to_string(desk.path("toys/labels/left_1.txt")).expect("imported");
    assert!(text.starts_with("1 ") && text.lines().count() == 1, "{text}");
    assert_eq!(
        view.labels.set.as_ref().map(|set| set.names.clone()),
        Some(ClassNames::new(["Tomato", "Duck"]))
    );
}

#[test]
fn a_broken_data_yaml_says_so_and_what_was_open_stays_open() {
    let mut desk = Desk::with_pairs(1);
    let broken = desk.path("broken");
    std::fs::create_dir(&broken).expect("made");
    std::fs::write(broken.join("data.yaml"), "names: [a\ntrain: :").expect("written");
    let view = desk.send(LabelsCommand::Open { path: broken.clone() });
    assert!(desk.said().contains("data.yaml cannot be used"), "{}", desk.said());
    assert_eq!(view.labels.images.len(), 2);
    desk.send(LabelsCommand::Close);
    let view = desk.send(LabelsCommand::Open { path: broken });
    assert!(view.labels.failed.as_ref().is_some_and(|why| why.contains("cannot be used")));
    let view = desk.send(LabelsCommand::Open { path: desk.path("nowhere") });
    assert!(view.labels.failed.as_ref().is_some_and(|why| why.contains("no data.yaml")));
}

#[test]
fn an_image_that_cannot_be_read_is_in_the_list_with_its_reason() {
    let mut desk = Desk::with_pairs(1);
    std::fs::write(desk.path("toys/images/left_0.png"), b"not a picture").expect("written");
    let good = std::fs::read(
        std::fs::read_dir(desk.path("toys/images"))
            .expect("there")
            .flatten()
            .map(|e| e.path())
            .find(|p| p.to_string_lossy().contains("right"))
            .expect("a right image"),
    )
    .expect("read");
    std::fs::write(desk.path("toys/images/left_1.png"), &good[..good.len() / 2]).expect("written");
    let view = desk.send(LabelsCommand::Open { path: desk.path("toys") });
    let bad: Vec<&str> =
        view.labels.images.iter().filter(|i| i.unusable.is_some()).map(|i| i.name.as_str()).collect();
    assert_eq!(bad, ["left_0", "left_1"]);
    let view = desk.send(LabelsCommand::Choose { image: "left_1".into() });
    assert!(
        matches!(&view.labels.shown.as_ref().expect("shown").pixels, Some(Err(why)) if why.to_string().contains("left_1.png"))
    );
    assert!(view.labels.problems.iter().any(|problem| problem.image == "left_0"));
}

#[test]
fn labels_that_would_be_lost_cannot_be_changed() {
    let mut desk = Desk::with_pairs(1);
    let name = desk.view().labels.images[0].name.clone();
    let file = desk.path(&format!("toys/labels/{name}.txt"));
    std::fs::write(&file, "0 0.5 0.5 0.2 0.2\n9 0.5 0.5 0.2 0.2\n").expect("written");
    let view = desk.send(LabelsCommand::Open { path: desk.path("toys") });
    let why = view.labels.shown.as_ref().and_then(|shown| shown.locked.clone()).expect("locked");
    assert!(why.contains("line 2") && why.contains("class 9"), "{why}");
    desk.add(1.0, 0);
    let text = std::fs::read_to_string(&file).expect("still there");
    assert_eq!(text.lines().count(), 2, "nothing was written over it");
}

#[test]
fn what_cannot_be_written_is_kept_said_and_written_later() {
    let mut desk = Desk::with_pairs(1);
    // A file where the folder of labels should be: refused even to root, unlike a read-only folder.
    let labels = desk.path("toys/labels");
    std::fs::remove_dir_all(&labels).expect("empty so far");
    std::fs::write(&labels, "in the way").expect("written");
    let view = desk.add(8.0, 0);
    let why = view.labels.unsaved.clone().expect("it is said");
    assert!(why.contains("not on disk") && why.contains("kept here"), "{why}");
    assert_eq!(view.labels.shown.as_ref().map(|shown| shown.boxes.len()), Some(1));
    let view = desk.send(LabelsCommand::Close);
    assert!(view.labels.set.is_some(), "a data set with unsaved boxes stays open");
    let view = desk.send(LabelsCommand::Open { path: desk.path("other") });
    assert!(view.labels.set.as_ref().is_some_and(|set| set.folder == desk.path("toys")));
    assert!(desk.state.last_write().is_some(), "written at the latest when the program ends");
    std::fs::remove_file(&labels).expect("removed");
    let view = desk.send(LabelsCommand::SaveAgain);
    assert_eq!(view.labels.unsaved, None);
    assert!(desk.label_text().is_some() && desk.state.last_write().is_none());
}

#[test]
fn a_change_while_another_is_being_written_is_not_overtaken() {
    let mut desk = Desk::with_pairs(1);
    let name = desk.view().labels.images[0].name.clone();
    for x in [2.0, 20.0, 40.0] {
        let area = PixelBox::new(x, 10.0, x + 16.0, 26.0);
        let edit = BoxEdit::Add { class: ClassIndex(0), area };
        // Nothing is carried out in between.
        desk.state.apply(Command::Labels(LabelsCommand::Edit { image: name.clone(), edit }));
    }
    assert!(desk.state.last_write().is_some());
    desk.work();
    assert_eq!(desk.label_text().map(|text| text.lines().count()), Some(3));
    assert!(desk.state.last_write().is_none());
}

#[test]
fn a_new_data_set_needs_an_empty_folder_and_names_of_their_own() {
    let mut desk = Desk::with_pairs(1);
    desk.send(LabelsCommand::Create { folder: desk.path("toys"), names: vec!["A".into()] });
    assert!(desk.said().contains("is not empty"));
    desk.send(LabelsCommand::Create { folder: desk.path("b"), names: vec!["A".into(), "A".into()] });
    assert!(desk.said().contains("Class 2 is called \"A\""), "{}", desk.said());
}

/// Opening a data set writes what the program looks for when it begins.
#[test]
fn a_data_set_opened_while_the_last_one_is_looked_for_is_not_the_last_one() {
    let ends = |found_late: bool| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut desk = Desk { state: State::new(&folder.path().join("data")), folder };
        let looking = if found_late { desk.state.take_actions() } else { Vec::new() };
        let (folder, names) = (desk.path("toys"), vec!["Tomato".into()]);
        let opened = desk.send(LabelsCommand::Create { folder, names });
        assert_eq!(opened.labels.recent, None);
        for action in looking {
            let Action::Start(id, work) = action else { continue };
            desk.state.work_ended(id, work.run(&Unattended).into(), Duration::ZERO);
        }
        let open = desk.view().labels.recent.clone();
        (open, desk.send(LabelsCommand::Close).labels.recent.clone().is_some())
    };
    assert_eq!(ends(true), (None, true));
    assert_eq!(ends(true), ends(false));
}
