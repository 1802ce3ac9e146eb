//! What paths dropped on the window are taken for.

use std::path::PathBuf;

use plumbline_hardware::{SourceError, SourceSpec};
use plumbline_model::Eye;

use crate::world::{World, picture};

fn world() -> World {
    let world = World::new();
    world.save_pairs([1]);
    world.save("flat/left_1.png", &picture(Eye::Left, 1));
    world.save("flat/right_1.png", &picture(Eye::Right, 1));
    for name in ["eye-left.avi", "eye-right.AVI", "one.mp4", "two.mp4", "notes.txt"] {
        world.write(name, "content does not matter here");
    }
    std::fs::create_dir(world.at("a")).expect("a folder");
    std::fs::create_dir(world.at("b")).expect("a folder");
    world
}

fn dropped(world: &World, names: &[&str]) -> Result<SourceSpec, SourceError> {
    let paths: Vec<PathBuf> = names.iter().map(|name| world.at(name)).collect();
    SourceSpec::from_paths(&paths)
}

#[test]
fn folders_videos_and_images_in_any_order() {
    let world = world();
    let folders = SourceSpec::Folders { left: world.at("left"), right: world.at("right") };
    assert_eq!(dropped(&world, &["left", "right"]), Ok(folders.clone()));
    assert_eq!(dropped(&world, &["right", "left"]), Ok(folders.clone()));
    assert_eq!(dropped(&world, &["right/frame_1.png", "left/frame_1.png"]), Ok(folders));
    let videos = SourceSpec::Videos { left: world.at("eye-left.avi"), right: world.at("eye-right.AVI") };
    assert_eq!(dropped(&world, &["eye-right.AVI", "eye-left.avi"]), Ok(videos));
    let flat = SourceSpec::Folder(world.at("flat"));
    assert_eq!(dropped(&world, &["flat"]), Ok(flat.clone()));
    assert_eq!(dropped(&world, &["flat/right_1.png"]), Ok(flat));
    let one_named = SourceSpec::Folders { left: world.at("a"), right: world.at("right") };
    assert_eq!(dropped(&world, &["a", "right"]), Ok(one_named), "one name that says its eye is enough");
}

#[test]
fn what_cannot_be_a_source_is_refused_with_a_way_out() {
    let world = world();
    let cases: [(&[&str], &str); 7] = [
        (&[], "nothing was given: give a folder"),
        (&["nowhere"], "nowhere does not exist"),
        (&["notes.txt"], "notes.txt is neither a folder nor an image nor a video"),
        (&["eye-left.avi"], "is the video of one eye only"),
        (&["one.mp4", "two.mp4"], "do not say which is the left eye: name them left and right"),
        (&["a", "b"], "the names a and b do not say which is the left eye"),
        (&["a", "b", "left"], "these 3 paths do not make a pair of eyes"),
    ];
    for (names, expected) in cases {
        let error = dropped(&world, names).expect_err("no source").to_string();
        assert!(error.contains(expected), "{names:?}: {error}");
    }
}

#[test]
fn a_source_can_be_saved_and_read_again() {
    let specs = [
        SourceSpec::Folders { left: "l".into(), right: "r".into() },
        SourceSpec::Folder("pairs".into()),
        SourceSpec::Videos { left: "l.avi".into(), right: "r.avi".into() },
        SourceSpec::Cameras { left_index: 0, right_index: 2 },
    ];
    for spec in specs {
        let text = serde_json::to_string(&spec).expect("plain data");
        assert_eq!(serde_json::from_str::<SourceSpec>(&text).expect("the same"), spec, "{text}");
    }
}
