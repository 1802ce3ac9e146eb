//! What a set promises.

use std::fs;
use std::sync::atomic::{AtomicUsize, Ordering};

use plumbline_model::ClassNames;

use super::*;
use crate::hand_look::{self, HandLook};
use crate::scene::Shape;
use crate::toys::Toy;

fn rig() -> Rig {
    Rig::built_in("nico").expect("valid")
}

fn painter() -> Option<SetPainter> {
    match SetPainter::new(EyeOptions::default()) {
        Ok(painter) => Some(painter),
        Err(error) => {
            plumbline_model::measured_data::left_out(error);
            None
        }
    }
}

#[test]
fn classes_are_the_published_ones() {
    let names = ClassNames::published();
    for toy in Toy::ALL {
        let class = names.get(scene::class_of_toy(toy)).expect("in the list");
        assert_eq!(class.to_lowercase(), toy.name());
    }
    let hand = |arm| scene::class_of_hand(arm).and_then(|class| names.get(class).map(str::to_owned));
    assert_eq!(hand("left").as_deref(), Some("LeftHand"));
    assert_eq!(hand("right").as_deref(), Some("RightHand"));
    assert_eq!(hand("middle"), None);
}

#[test]
fn two_hundred_scenes_have_every_class_and_some_have_no_toy() {
    let rig = rig();
    let bank = Bank::new(&rig);
    let (mut of_class, mut bare, mut most) = ([0; 8], 0, 0);
    for index in 0..200 {
        let scene = Scene::draw(&rig, &bank, 3, index);
        let toys = scene.things.iter().filter(|thing| ![2, 6].contains(&thing.class.0)).count();
        bare += usize::from(toys == 0);
        most = most.max(toys);
        for thing in &scene.things {
            of_class[thing.class.0] += 1;
        }
    }
    assert!(of_class.iter().all(|count| *count > 40), "{of_class:?}");
    assert!((5..40).contains(&bare), "{bare} scenes without a toy");
    assert!(most >= 6);
}

#[test]
fn a_scene_depends_on_seed_and_number_alone() {
    let rig = rig();
    let bank = Bank::new(&rig);
    let draw = |seed, index| Scene::draw(&rig, &bank, seed, index).scenery(&[]);
    let first = draw(8, 5);
    let _ = draw(8, 4);
    assert_eq!(first, draw(8, 5));
    assert_ne!(first, draw(8, 6));
    assert_ne!(first, draw(9, 5));
}

#[test]
fn what_is_labeled_as_a_hand_is_the_palm_without_fingers() {
    let rig = rig();
    let bank = Bank::new(&rig);
    let palm_parts = |wire| {
        let look = HandLook { wire, ..HandLook::default() };
        hand_look::palm(&nalgebra::Isometry3::identity(), &nalgebra::Vector3::repeat(0.02), &look).len()
    };
    let mut hands = 0;
    for index in 0..40 {
        let scene = Scene::draw(&rig, &bank, 1, index);
        for thing in scene.things.iter().filter(|thing| [2, 6].contains(&thing.class.0)) {
            hands += 1;
            let count = thing.robot_from_shapes.len();
            assert!(count == palm_parts(None) || count == palm_parts(Some(0.1)), "{count}");
            // All of it is near the palm's plate; a finger would reach farther.
            let middle = thing.robot_from_shapes[0].0.translation.vector;
            let Shape::Box { half_m } = &thing.robot_from_shapes[0].1 else { panic!("a plate first") };
            for (place, _) in &thing.robot_from_shapes {
                assert!((place.translation.vector - middle).norm() < half_m.norm() + 0.006);
            }
            // Fingers and thumb are drawn, but not as the palm.
            let scenery = scene.scenery(&[]);
            assert!(scenery.items.iter().filter(|item| item.object == thing.object).count() == count);
        }
    }
    assert!(hands > 20);
}

#[test]
fn the_same_seed_gives_the_same_pair_and_boxes_enclose_what_is_seen() {
    let Some(mut painter) = painter() else { return };
    let once = painter.pair(21, 3).expect("drawn");
    let _ = painter.pair(21, 4).expect("drawn");
    let again = painter.pair(21, 3).expect("drawn");
    assert_eq!(once.labels, again.labels);
    assert_eq!(once.images, again.images);

    let mut boxes = 0;
    for index in 0..4 {
        let scene = Scene::draw(&painter.rig, &painter.bank, 21, index);
        let objects =
            painter.renderer.objects(&scene.scenery(&[]), &scene.snapshot, &scene.sensor).expect("drawn");
        let (labels, _) = label(&scene.things, &scene.snapshot, &objects);
        for (image, own) in objects.iter().zip(&labels) {
            for label in own {
                boxes += 1;
                let area = label.area;
                let (width, height) = image.dimensions();
                assert!(area.x0_px >= 0.0 && area.y0_px >= 0.0);
                assert!(area.x1_px <= width as f32 && area.y1_px <= height as f32);
                // One object of the class has a pixel at all four sides and none outside.
                let exact = scene.things.iter().filter(|thing| thing.class == label.class).any(|thing| {
                    let mut sides = [false; 4];
                    let mut inside = true;
                    for (x, y, pixel) in image.enumerate_pixels() {
                        if pixel.0[0] != thing.object {
                            continue;
                        }
                        let (x, y) = (x as f32, y as f32);
                        inside &= x >= area.x0_px && x < area.x1_px && y >= area.y0_px && y < area.y1_px;
                        sides[0] |= x == area.x0_px;
                        sides[1] |= x == area.x1_px - 1.0;
                        sides[2] |= y == area.y0_px;
                        sides[3] |= y == area.y1_px - 1.0;
                    }
                    inside && sides == [true; 4]
                });
                assert!(exact, "{label:?}");
            }
        }
    }
    assert!(boxes > 4);
}

#[test]
fn what_is_left_in_a_pair_is_labeled_or_not_seen() {
    let Some(mut painter) = painter() else { return };
    for index in 0..6 {
        let (scene, without) = painter.clear_scene(5, index).expect("looked at");
        let objects = painter
            .renderer
            .objects(&scene.scenery(&without), &scene.snapshot, &scene.sensor)
            .expect("drawn");
        let (_, barely) = label(&scene.things, &scene.snapshot, &objects);
        assert!(barely.is_empty(), "pair {index}");
    }
}

/// Cancels after some checkpoints.
struct Patience(AtomicUsize);

impl JobContext for Patience {
    fn checkpoint(&self) -> Result<(), Cancelled> {
        let left = self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1));
        left.map(|_| ()).map_err(|_| Cancelled)
    }
    fn report(&self, _fraction: f64, _doing: &str) {}
}

#[test]
fn a_set_has_its_files_and_an_image_is_never_without_labels() {
    if painter().is_none() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let options = SetOptions { pairs: 5, seed: 2, first: 0, val_share: 0.5, ..SetOptions::default() };
    let error = generate(folder.path(), &options, &Patience(AtomicUsize::new(2))).expect_err("cancelled");
    assert!(matches!(error, SetError::Cancelled(_)));
    let read = |file: &str| fs::read_to_string(folder.path().join(file)).expect("written");
    let yaml = read("data.yaml");
    let order: Vec<usize> = ClassNames::published()
        .iter()
        .map(|(i, name)| yaml.find(&format!("  {}: {name}\n", i.0)).expect("named"))
        .collect();
    assert!(order.is_sorted());
    let mut images = 0;
    for split in ["train", "val"] {
        for entry in fs::read_dir(folder.path().join("images").join(split)).expect("a folder") {
            let path = entry.expect("an entry").path();
            images += 1;
            let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
            let text = read(&format!("labels/{split}/{name}.txt"));
            for line in text.lines() {
                let numbers: Vec<f64> = line.split(' ').map(|word| word.parse().expect("a number")).collect();
                let [class, x, y, w, h] = numbers[..] else { panic!("five numbers: {line}") };
                assert!(class < 8.0 && w > 0.0 && h > 0.0);
                assert!(x - 0.5 * w >= -1e-9 && x + 0.5 * w <= 1.0 + 1e-9);
                assert!(y - 0.5 * h >= -1e-9 && y + 0.5 * h <= 1.0 + 1e-9);
            }
            assert_eq!(image::open(&path).expect("an image").to_rgb8().dimensions(), (640, 480));
        }
    }
    assert_eq!(images, 4);
    let whole = generate(folder.path(), &options, &plumbline_model::Unattended).expect("drawn");
    assert_eq!(whole.pairs, 5);
    assert!(read("recipe.json").contains("\"seed\": 2"));
}

#[test]
fn options_that_cannot_be_used_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    for options in [
        SetOptions { pairs: 0, ..SetOptions::default() },
        SetOptions { val_share: 1.5, ..SetOptions::default() },
        SetOptions { val_share: f64::NAN, ..SetOptions::default() },
    ] {
        let error = generate(folder.path(), &options, &plumbline_model::Unattended).expect_err("refused");
        assert!(matches!(error, SetError::Option { .. }), "{error}");
    }
}

#[test]
fn the_share_for_validation_is_spread_evenly() {
    let options = SetOptions { val_share: 0.2, ..SetOptions::default() };
    let val: Vec<usize> = (0..20).filter(|index| options.is_val(*index)).collect();
    assert_eq!(val, [4, 9, 14, 19]);
    let none = SetOptions { val_share: 0.0, ..options };
    assert!((0..50).all(|index| !none.is_val(index)));
    let all = SetOptions { val_share: 1.0, ..options };
    assert!((0..50).all(|index| all.is_val(index)));
}

#[test]
fn the_twins_own_scenes_are_the_same_again_and_boxes_enclose_what_is_seen() {
    let Some(mut painter) = painter() else { return };
    let mut boxes = 0;
    for index in [0, 3, 5] {
        let once = painter.twin_pair(4, index).expect("draws");
        let other = painter.twin_pair(4, index + 1).expect("draws");
        let again = painter.twin_pair(4, index).expect("draws");
        assert_eq!(once.labels, again.labels);
        assert_eq!(once.images, again.images);
        assert_ne!(once.images, other.images);
        for label in once.labels.iter().flatten() {
            assert_eq!(label.area.on_image((640, 480)), Some(label.area));
            assert!(label.area.width_px() >= 4.0 || label.area.height_px() >= 4.0, "{label:?}");
            boxes += 1;
        }
    }
    assert!(boxes >= 6, "{boxes}");
}

#[test]
fn a_folder_holds_one_set() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("set");
    let options = SetOptions { pairs: 2, seed: 5, ..SetOptions::default() };
    files::prepare(&out, &options).expect("a new folder");
    // Drawn in parts, and again.
    files::prepare(&out, &SetOptions { first: 2, pairs: 7, ..options }).expect("the same set");
    let recipe = fs::read_to_string(out.join(files::RECIPE)).expect("written");
    for other in [
        SetOptions { seed: 6, ..options },
        SetOptions { world: SetWorld::Twin, ..options },
        SetOptions { val_share: 0.5, ..options },
    ] {
        let refused = files::prepare(&out, &other).expect_err("another set");
        assert!(matches!(refused, SetError::OtherSet { .. }));
        let words = refused.to_string();
        assert!(
            words.contains("holds a set that was drawn with seed 5, world randomised, 0.1 of"),
            "{words}"
        );
        assert!(words.contains("choose an empty folder"), "{words}");
    }
    assert_eq!(fs::read_to_string(out.join(files::RECIPE)).expect("still there"), recipe);
    fs::write(folder.path().join("thesis.txt"), "mine").expect("written");
    let refused = files::prepare(folder.path(), &options).expect_err("somebody's folder");
    assert!(
        refused.to_string().contains("is not empty and holds no set that this program drew"),
        "{refused}"
    );
    assert!(!folder.path().join("data.yaml").exists());
    // A link to nothing is not "no recipe".
    let other = folder.path().join("other");
    fs::create_dir(&other).expect("a folder");
    std::os::unix::fs::symlink("gone", other.join(files::RECIPE)).expect("a link");
    assert!(matches!(files::prepare(&other, &options), Err(SetError::File(_))));
}
