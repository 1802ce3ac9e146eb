//! Which files pair, and what is said about those that do not.

use plumbline_hardware::{
    FolderSource, PairFolder, PairProblem, Replay, Report, SourceError, SourceOptions, SourceSpec, open,
};
use plumbline_model::Eye;

use crate::world::{World, moments, picture, reports, sized_picture};

fn once() -> SourceOptions {
    SourceOptions { replay: Replay::ONCE, ..SourceOptions::default() }
}

fn open_folder(world: &World) -> FolderSource {
    FolderSource::new(PairFolder::open_one(world.path()).expect("pairs"), Replay::ONCE).expect("a source")
}

fn refusal(spec: &SourceSpec) -> SourceError {
    open(spec, &once()).err().expect("this must be refused")
}

#[test]
fn two_folders_pair_by_name_in_natural_order() {
    let world = World::new();
    world.save_pairs([10, 2, 1]);
    let spec = SourceSpec::Folders { left: world.at("left"), right: world.at("right") };
    let mut source = open(&spec, &once()).expect("pairs");
    assert_eq!(source.describe().pair_count, Some(3));
    assert_eq!(source.describe().image_size, Some((32, 24)));
    assert_eq!(moments(source.as_mut()), [1, 2, 10]);
    assert_eq!(reports(source.as_mut()), [""; 0]);
}

#[test]
fn one_folder_in_every_layout() {
    let layouts: [fn(Eye, u8) -> String; 7] = [
        |eye, moment| format!("{eye}/{moment}.png"),
        |eye, moment| format!("{}/{moment}.jpg", eye.to_string().to_uppercase()),
        |eye, moment| format!("eye_{eye}/{moment}.png"),
        |eye, moment| format!("stereo/{eye}/{moment}.png"),
        |eye, moment| format!("{eye}_{moment}.jpg"),
        |eye, moment| format!("{eye}{moment:02}.png"),
        |eye, moment| format!("frame{moment}-{eye}.png"),
    ];
    for name in layouts {
        let world = World::new();
        world.write("calibration.yaml", "not an image, and no reason to complain");
        for moment in [3, 1, 2] {
            for eye in Eye::BOTH {
                world.save(&name(eye, moment), &picture(eye, moment));
            }
        }
        let mut source = open_folder(&world);
        assert_eq!(moments(&mut source), [1, 2, 3], "{}", name(Eye::Left, 1));
        assert_eq!(reports(&mut source), [""; 0], "{}", name(Eye::Left, 1));
    }
}

#[test]
fn one_eye_of_two_folders_finds_the_other() {
    let world = World::new();
    world.save_pairs([1, 2]);
    for given in ["left", "right"] {
        let folder = PairFolder::open_one(&world.at(given)).expect("its sibling is beside it");
        assert_eq!(folder.pairs().len(), 2);
        assert!(folder.pairs()[0].left.ends_with("left/frame_1.png"));
    }
}

#[test]
fn names_pair_up_to_extension_and_eye() {
    let world = World::new();
    world.save("left/a.png", &picture(Eye::Left, 1));
    world.save("right/a.jpg", &picture(Eye::Right, 1));
    world.save("left/left_b.png", &picture(Eye::Left, 2));
    world.save("right/right_b.png", &picture(Eye::Right, 2));
    let folder = PairFolder::open_one(world.path()).expect("pairs");
    let names: Vec<&str> = folder.pairs().iter().map(|pair| pair.name.as_str()).collect();
    assert_eq!(names, ["a.png", "left_b.png"]);
    assert!(folder.pairs()[1].right.ends_with("right/right_b.png"));
}

#[test]
fn unequal_counts_are_told_by_name_and_the_rest_goes_on() {
    let world = World::new();
    world.save_pairs([1, 2, 4]);
    world.save("left/frame_3.png", &picture(Eye::Left, 3));
    world.save("right/frame_5.png", &picture(Eye::Right, 5));
    world.write("left/frame_6.bmp", "BM");
    let mut source = open_folder(&world);
    assert_eq!(
        reports(&mut source),
        [
            "left/frame_6.bmp is left out: this kind of image is not read; save it as PNG or JPEG",
            "left/frame_3.png has no partner: there is no right image of that name, so it is left out",
            "right/frame_5.png has no partner: there is no left image of that name, so it is left out",
        ]
    );
    assert_eq!(moments(&mut source), [1, 2, 4]);
}

#[test]
fn a_bad_pair_is_skipped_and_told_once_with_its_file() {
    let world = World::new();
    world.save_pairs(1..=6);
    world.write("left/frame_2.png", "this is no picture");
    let whole = std::fs::read(world.at("right/frame_3.png")).expect("an image");
    world.write("right/frame_3.png", &whole[..whole.len() / 2]);
    world.save("right/frame_4.png", &sized_picture(Eye::Right, 4, (16, 24)));
    for eye in Eye::BOTH {
        world.save(&format!("{eye}/frame_5.png"), &sized_picture(eye, 5, (64, 48)));
    }
    let folder = PairFolder::open_one(world.path()).expect("pairs");
    let mut source = FolderSource::new(folder, Replay { looping: true, ..Replay::ONCE }).expect("a source");
    let pairs = crate::world::collect(&mut source, 4).expect("good pairs remain");
    assert_eq!(pairs.iter().map(crate::world::moment_of).collect::<Vec<_>>(), [1, 6, 1, 6]);
    assert_eq!(pairs.iter().map(|pair| pair.stamp.seq).collect::<Vec<_>>(), [0, 1, 2, 3]);

    let told = reports(&mut source);
    assert_eq!(told.len(), 4, "once, not once a round: {told:?}");
    let expected = [
        "pair frame_2.png is skipped: left image frame_2.png is not an image, it begins with the text \"this is no picture\"",
        "pair frame_3.png is skipped: right image frame_3.png is cut off after",
        "pair frame_4.png is skipped: the left image is 32x24 px and the right 16x24 px",
        "pair frame_5.png is skipped: its images are 64x48 px while the others are 32x24 px",
    ];
    for (told, expected) in told.iter().zip(expected) {
        assert!(told.starts_with(expected), "{told}");
    }
    assert_eq!(source.folder().pairs().len(), 6);
    assert_eq!(plumbline_hardware::StereoSource::counters(&source).skipped, 8);
}

#[test]
fn the_first_pair_may_be_the_odd_one() {
    let world = World::new();
    world.save_pairs(1..=5);
    for eye in Eye::BOTH {
        world.save(&format!("{eye}/frame_1.png"), &sized_picture(eye, 1, (64, 48)));
    }
    assert_eq!(moments(&mut open_folder(&world)), [2, 3, 4, 5]);
}

#[test]
fn when_no_pair_is_usable_the_first_reason_is_given() {
    let world = World::new();
    world.write("left/a.png", "");
    world.write("right/a.png", "");
    world.write("left/b.png", "text");
    world.write("right/b.png", "text");
    for looping in [false, true] {
        let folder = PairFolder::open_one(world.path()).expect("files that look like pairs");
        let mut source = FolderSource::new(folder, Replay { looping, ..Replay::ONCE }).expect("a source");
        let error = crate::world::collect(&mut source, 1).expect_err("nothing is usable").to_string();
        assert!(
            error.starts_with("none of the 2 pairs can be used; the first one fails because left image a.png is empty (0 bytes)"),
            "{error}"
        );
    }
}

#[test]
fn a_pair_can_be_read_out_of_order() {
    let world = World::new();
    world.save_pairs([1, 2]);
    world.write("right/frame_2.png", "text");
    let folder = PairFolder::open_one(world.path()).expect("pairs");
    let problem = folder.load(&folder.pairs()[1]).expect_err("a text");
    assert!(matches!(problem, PairProblem::Image { eye: Eye::Right, .. }), "{problem}");
    let pair = folder.load(&folder.pairs()[0]).expect("a good pair");
    assert_eq!((pair.left, pair.right), (picture(Eye::Left, 1), picture(Eye::Right, 1)));
}

#[test]
fn conversions_are_told_once_per_kind() {
    let world = World::new();
    for name in ["left/1.png", "right/1.png", "left/2.png", "right/2.png"] {
        let gray = image::ImageBuffer::<image::Luma<u16>, _>::from_pixel(8, 8, image::Luma([65535_u16]));
        world.save(name, &picture(Eye::Left, 0));
        gray.save(world.at(name)).expect("saving");
    }
    let mut source = open_folder(&world);
    assert_eq!(crate::world::collect(&mut source, 9).expect("pairs").len(), 2);
    assert_eq!(
        reports(&mut source),
        ["left/1.png: gray image, shown as gray RGB", "left/1.png: 16-bit image, reduced to 8 bits"]
    );
}

#[test]
fn folders_that_cannot_be_a_source_are_refused_precisely() {
    let world = World::new();
    world.save_pairs([1]);
    std::fs::create_dir(world.at("empty")).expect("a folder");
    world.save("mixed/left_1.png", &picture(Eye::Left, 1));
    world.save("mixed/frame_2.png", &picture(Eye::Left, 1));
    world.save("others/something.png", &picture(Eye::Right, 1));
    world.save("wrong/right_1.png", &picture(Eye::Right, 1));
    world.write("file.txt", "text");
    world.save("toys/images/1.png", &picture(Eye::Left, 1));
    world.write("toys/data.yaml", "names: [tomato]");
    let (left, right) = (world.at("left"), world.at("right"));
    let folders = |left: &std::path::Path, right: &std::path::Path| SourceSpec::Folders {
        left: left.to_path_buf(),
        right: right.to_path_buf(),
    };
    let cases = [
        (SourceSpec::Folder(world.at("gone")), "gone does not exist: check the path"),
        (SourceSpec::Folder(world.at("empty")), "holds no PNG or JPEG image"),
        (SourceSpec::Folder(world.at("file.txt")), "file.txt is not a folder"),
        (SourceSpec::Folder(world.at("mixed")), "no pairs were recognized"),
        (SourceSpec::Folder(world.at("toys")), "toys is a data set for detectors"),
        (folders(&left, &world.at("empty")), "empty holds no PNG or JPEG image"),
        (folders(&left, &left), "was given for both eyes"),
        (folders(&left, &world.at("others")), "(found frame_1.png and something.png)"),
        (folders(&world.at("wrong"), &right), "say right, but it was given for the left eye"),
    ];
    for (spec, expected) in cases {
        let error = refusal(&spec).to_string();
        assert!(error.contains(expected), "{spec:?}: {error}");
        assert!(error.contains(':'), "what to do is missing: {error}");
    }
}

#[test]
fn hidden_files_of_the_operating_system_are_no_images() {
    let world = World::new();
    world.save_pairs([1]);
    world.write("left/._frame_1.png", "resource fork");
    world.write("left/.DS_Store", "folder view");
    let mut source = open_folder(&world);
    assert_eq!(moments(&mut source), [1]);
    assert_eq!(reports(&mut source), [""; 0]);
}

#[test]
fn images_without_an_eye_in_their_name_are_told_beside_good_pairs() {
    let world = World::new();
    world.save("left_1.png", &picture(Eye::Left, 1));
    world.save("right_1.png", &picture(Eye::Right, 1));
    world.save("overview.png", &picture(Eye::Right, 1));
    let folder = PairFolder::open_one(world.path()).expect("one pair");
    assert!(
        matches!(folder.reports(), [Report::Ignored { file, .. }] if file == "overview.png"),
        "{:?}",
        folder.reports()
    );
}
