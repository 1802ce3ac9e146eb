//! Whatever is put in use or taken back, by whichever workflow, stands on the timeline; and each can be
//! taken back.

use std::path::Path;

use jiff::Timestamp;
use plumbline_effects::RigModel;
use plumbline_effects::rig_model::{Addition, ModelEffect};
use plumbline_engine::timeline::view::{EntryKind, Subject};
use plumbline_engine::view::TimelineEntry;
use plumbline_engine::{EyesCommand, FileLength, GapCommand, TimelineCommand, TouchCommand, rig_models};
use plumbline_model::formats::native;
use plumbline_model::robot::{Rig, default_rig};
use plumbline_model::touchscreen::place_screen;
use plumbline_model::{Pixel, Point, StereoCalibration};

use crate::common::{Desk, eyes};

fn entries(desk: &mut Desk) -> Vec<TimelineEntry> {
    desk.view().timeline.entries.to_vec()
}

/// The newest entry.
fn newest(desk: &mut Desk) -> TimelineEntry {
    entries(desk).pop().expect("something happened")
}

/// Reads a calibration whose eyes are so much farther apart, and accepts it.
fn accept(desk: &mut Desk, folder: &Path, factor: f64) -> String {
    let mut cameras = eyes();
    cameras.right_from_left.isometry.translation.vector *= factor;
    let file = folder.join(format!("eyes-{factor}.yaml"));
    native::write(&StereoCalibration::bare(cameras), &file).expect("written");
    desk.apply(EyesCommand::Import { files: vec![file], length: FileLength::AsPrescribed });
    desk.apply(EyesCommand::Accept);
    desk.view().eyes.in_use.as_ref().expect("accepted").id.clone()
}

#[test]
fn a_calibration_is_taken_back_to_the_one_before_and_to_none() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut desk = Desk::new(folder.path());
    assert!(entries(&mut desk).is_empty());
    let first = accept(&mut desk, folder.path(), 1.0);
    let second = accept(&mut desk, folder.path(), 1.01);
    let entry = newest(&mut desk);
    assert_eq!((entry.subject, entry.kind), (Subject::Eyes, EntryKind::PutInUse));
    assert_eq!((entry.id_before.as_ref(), entry.id_after.as_ref()), (Some(&first), Some(&second)));

    desk.apply(EyesCommand::UseEarlier { id: entry.id_before });
    assert_eq!(desk.view().eyes.in_use.as_ref().map(|in_use| &in_use.id), Some(&first));
    assert_eq!(newest(&mut desk).kind, EntryKind::TakenBack);
    desk.apply(EyesCommand::UseEarlier { id: None });
    assert!(desk.view().eyes.in_use.is_none(), "as before the first one");
    assert_eq!(entries(&mut desk).len(), 4);

    // All of it is there after a restart, and nothing is told twice.
    let mut again = Desk::new(folder.path());
    assert!(again.view().eyes.in_use.is_none());
    assert_eq!(entries(&mut again), entries(&mut desk));
    again.apply(EyesCommand::UseEarlier { id: Some(second.clone()) });
    assert_eq!(newest(&mut again).id_after, Some(second));
}

/// Its file on the shelf, which goes away while this acts.
fn without_file(folder: &Path, id: &str, act: impl FnOnce()) {
    let shelf = folder.join("calibrations");
    let files = std::fs::read_dir(shelf).expect("there").flatten().map(|entry| entry.path());
    let mine =
        files.filter(|file| file.file_name().is_some_and(|name| name.to_string_lossy().starts_with(id)));
    let mine: Vec<_> =
        mine.map(|file| (file.clone(), folder.join(file.file_name().expect("it has a name")))).collect();
    assert!(!mine.is_empty(), "{id} is kept");
    mine.iter().for_each(|(file, away)| std::fs::rename(file, away).expect("moved away"));
    act();
    mine.iter().for_each(|(file, away)| std::fs::rename(away, file).expect("moved back"));
}

#[test]
fn undo_is_one_command_and_what_was_refused_is_no_step_back() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut desk = Desk::new(folder.path());
    let first = accept(&mut desk, folder.path(), 1.0);
    let second = accept(&mut desk, folder.path(), 1.01);
    let back = |id: &str| TimelineCommand::TakeBack { subject: Subject::Eyes, to: Some(id.to_owned()) };
    without_file(folder.path(), &first, || desk.apply(back(&first)));
    assert_eq!(desk.view().eyes.in_use.as_ref().map(|in_use| &in_use.id), Some(&second), "it is not there");
    assert_eq!(entries(&mut desk).len(), 2);
    // Used again on purpose later, it is no step back.
    desk.apply(EyesCommand::UseEarlier { id: Some(first.clone()) });
    assert!(!newest(&mut desk).by_undo, "{:?}", newest(&mut desk));
    desk.apply(back(&second));
    let entry = newest(&mut desk);
    assert!(entry.by_undo && entry.id_after.as_ref() == Some(&second), "{entry:?}");
    // What is only measured cannot be taken back, and it is said.
    desk.apply(TimelineCommand::TakeBack { subject: Subject::Check, to: None });
    assert!(desk.last_notice().contains("cannot be taken back"), "{}", desk.last_notice());
}

/// A place of the screen, moved by this.
fn place(folder: &Path, rig: &Rig, moved_m: f64) {
    let pixels = [[0.0, 0.0], [1919.0, 0.0], [1919.0, 1079.0], [0.0, 1079.0]];
    let touches: Vec<_> = pixels
        .into_iter()
        .map(|[u_px, v_px]| {
            let pixel = Pixel::new(u_px, v_px);
            let at = rig.touchscreen.point_at(pixel).coords;
            (pixel, Point::new(at.x + moved_m, at.y, at.z))
        })
        .collect();
    let placement = place_screen(&rig.touchscreen, &touches).expect("four corners").of_rig(&rig.name);
    placement.write(rig_models::screen_in(folder).file()).expect("written");
}

#[test]
fn a_place_of_the_screen_stays_on_its_shelf() {
    let (folder, rig) = (tempfile::tempdir().expect("temporary folder"), default_rig());
    place(folder.path(), &rig, 0.01);
    let mut desk = Desk::new(folder.path());
    let found = newest(&mut desk);
    assert_eq!((found.subject, found.kind), (Subject::Screen, EntryKind::Found));
    desk.apply(TouchCommand::UseNominalPlacement);
    assert!(desk.view().touch.placement.is_none());
    assert_eq!((newest(&mut desk).kind, newest(&mut desk).id_after), (EntryKind::TakenBack, None));
    desk.apply(TouchCommand::UseEarlierPlacement { id: found.id_after.clone().expect("it has one") });
    assert!(desk.view().touch.placement.is_some());
    assert_eq!(newest(&mut desk).id_after, found.id_after);
    desk.apply(TouchCommand::UseEarlierPlacement { id: "../screen".to_owned() });
    assert!(desk.last_notice().contains("not kept any more"), "{}", desk.last_notice());
}

#[test]
fn effects_that_the_command_line_added_are_on_the_line_and_are_taken_back() {
    let (folder, rig) = (tempfile::tempdir().expect("temporary folder"), default_rig());
    let mut desk = Desk::new(folder.path());
    assert!(entries(&mut desk).is_empty());
    drop(desk);
    let effect = ModelEffect {
        id: "joint-zero".to_owned(),
        site: "r_elbow_y".to_owned(),
        title: "zero of the right elbow".to_owned(),
        tip: Some("right_index_tip".to_owned()),
        shape: None,
        reference_s: 0.0,
        values: vec![0.03],
        covariance: vec![1e-4],
        probability: None,
        parameters: vec![],
    };
    let addition = Addition {
        effects: vec![effect],
        screens: vec![],
        externals: vec![],
        eyes: vec![],
        together: vec![],
        replaces: false,
        at: Timestamp::now(),
        sentence: String::new(),
        sessions: vec![],
        version: String::new(),
        gap: None,
    };
    let mut model = RigModel::nominal(&rig);
    model.add(&rig, addition).expect("it fits");
    rig_models::save(folder.path(), &model, &rig).expect("written");
    let mut desk = Desk::new(folder.path());
    let entry = newest(&mut desk);
    assert_eq!((entry.subject, entry.title.as_str()), (Subject::Effects, "zero of the right elbow"));
    desk.apply(GapCommand::Undo);
    let entry = newest(&mut desk);
    assert_eq!((entry.kind, entry.id_after), (EntryKind::TakenBack, None));
}
