//! A twin that runs, as its operator has it.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_model::Pixel;
use plumbline_model::robot::Rig;
use plumbline_twin::Toy;

use super::TwinDesk;
use crate::twin::board_tour::NOBODY_LOOKS;
use crate::twin::command::TwinCommand;
use crate::twin::eyes::TwinEyesPlug;
use crate::twin::view::BoardTour;

fn place(desk: &TwinDesk, toy: Toy) -> Option<nalgebra::Vector3<f64>> {
    let twin = desk.twin.as_ref().expect("it runs");
    twin.state().toys.iter().find(|(known, _)| *known == toy).and_then(|(_, place)| *place)
}

fn until(desk: &TwinDesk, what: &str, holds: &dyn Fn(&TwinDesk) -> bool) {
    let begun = Instant::now();
    while !holds(desk) {
        assert!(begun.elapsed() < Duration::from_secs(30), "never: {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn put(desk: &mut TwinDesk, toy: Toy, [x_m, y_m]: [f64; 2], rig: &Rig) {
    let command = TwinCommand::PlaceToy { toy: toy.name().to_owned(), x_m, y_m };
    desk.control(command, rig).expect("on the table");
    until(desk, "it stands", &|desk| {
        place(desk, toy).is_some_and(|at| (at.x - x_m).hypot(at.y - y_m) < 0.03 && at.z < 0.15)
    });
}

#[test]
fn toys_make_room_on_the_screen_and_come_back_when_nobody_touches_it_any_more() {
    let rig = Arc::new(Rig::built_in("nico").expect("the rig that comes with the program"));
    let mut desk = TwinDesk::new(TwinEyesPlug::default());
    desk.start("perfect", &rig).expect("a twin");
    let screen = &rig.touchscreen;
    let middle = Pixel::new(0.5 * f64::from(screen.width_px), 0.5 * f64::from(screen.height_px));
    let middle = screen.point_at(middle).coords;
    put(&mut desk, Toy::Tomato, [middle.x, middle.y], &rig);
    let stood = place(&desk, Toy::Tomato).expect("it stands");
    desk.control(TwinCommand::PrepareTouch { screen_height_m: 0.0, payload_kg: 0.0 }, &rig).expect("free");
    // The next touch makes sure, perhaps before anything has moved.
    desk.free_screen(&rig);
    until(&desk, "room", &|desk| place(desk, Toy::Tomato).is_none());
    assert!(desk.view().made_room.contains(&"tomato".to_owned()));
    desk.control(TwinCommand::EndTouch, &rig).expect("as asked");
    assert!(desk.view().made_room.is_empty());
    until(&desk, "the tomato is back", &|desk| {
        place(desk, Toy::Tomato).is_some_and(|at| (at.x - stood.x).hypot(at.y - stood.y) < 0.03)
    });
    let said = desk.take_notes();
    let count = |begins: &str| said.iter().filter(|(_, text)| text.starts_with(begins)).count();
    assert_eq!((count("Put away"), count("Back where they stood: tomato")), (1, 1), "{said:?}");
    desk.control(TwinCommand::EndTouch, &rig).expect("as asked");
    assert!(desk.take_notes().is_empty(), "once");
}

#[test]
fn toys_make_room_for_the_board_and_come_back_where_they_stood() {
    let rig = Arc::new(Rig::built_in("nico").expect("the rig that comes with the program"));
    let mut desk = TwinDesk::new(TwinEyesPlug::default());
    desk.start("perfect", &rig).expect("a twin");
    put(&mut desk, Toy::Tomato, [0.35, 0.0], &rig);
    put(&mut desk, Toy::Duck, [0.30, 0.05], &rig);
    let stood = place(&desk, Toy::Tomato).expect("it stands");
    let lay = |x_m: f64, y_m: f64| TwinCommand::LayBoard { x_m, y_m, yaw_rad: 0.0 };
    desk.control(lay(0.35, 0.0), &rig).expect("it lies");
    until(&desk, "room", &|desk| [Toy::Tomato, Toy::Duck].iter().all(|toy| place(desk, *toy).is_none()));
    assert!(desk.take_notes().iter().any(|(_, text)| text.contains("make room")));
    // What is put somewhere by hand meanwhile stays there.
    put(&mut desk, Toy::Duck, [0.30, -0.45], &rig);
    desk.control(TwinCommand::HideBoard, &rig).expect("hidden");
    until(&desk, "the tomato is back", &|desk| {
        place(desk, Toy::Tomato).is_some_and(|at| (at.x - stood.x).hypot(at.y - stood.y) < 0.02)
    });
    let duck = place(&desk, Toy::Duck).expect("it stands");
    assert!((duck.y + 0.45).abs() < 0.03, "{duck}");
    let said = desk.take_notes();
    let back = said.iter().find(|(_, text)| text.starts_with("Back where they stood: "));
    assert!(back.is_some_and(|(_, text)| text.contains("tomato") && !text.contains("duck")), "{said:?}");
    desk.control(TwinCommand::HideBoard, &rig).expect("hidden");
    assert!(desk.take_notes().is_empty(), "once");
}

#[test]
fn a_tour_of_the_board_that_was_broken_off_goes_on_where_it_was() {
    let rig = Arc::new(Rig::built_in("nico").expect("the rig that comes with the program"));
    let mut desk = TwinDesk::new(TwinEyesPlug::default());
    desk.start("perfect", &rig).expect("a twin");
    let all = desk.view().board_places;
    assert_eq!((desk.view().board_tour, desk.view().board_places_left), (None, 0));
    desk.control(TwinCommand::TourBoard(true), &rig).expect("as asked");
    // Nobody looks: it goes on all the same after a while.
    let begun = Instant::now();
    (0..3).for_each(|i| desk.tick(begun + NOBODY_LOOKS * i, &rig));
    assert_eq!(desk.view().board_tour, Some(BoardTour { place: 3, of: all, waits: None }));
    desk.control(TwinCommand::TourBoard(false), &rig).expect("as asked");
    assert_eq!((desk.view().board_tour, desk.view().board_places_left), (None, all - 2));
    desk.control(TwinCommand::TourRest, &rig).expect("as asked");
    desk.tick(begun, &rig);
    assert_eq!(
        desk.view().board_tour,
        Some(BoardTour { place: 3, of: all, waits: None }),
        "the third once more"
    );
    assert_eq!(desk.view().board_places_left, 0);
    desk.control(TwinCommand::TourBoard(true), &rig).expect("as asked");
    desk.tick(begun, &rig);
    assert_eq!(desk.view().board_tour, Some(BoardTour { place: 1, of: all, waits: None }), "all means all");
}

#[test]
fn physics_that_fail_end_the_twin_and_are_said() {
    let rig = Arc::new(Rig::built_in("nico").expect("the rig that comes with the program"));
    let mut desk = TwinDesk::new(TwinEyesPlug::default());
    desk.start("perfect", &rig).expect("a twin");
    desk.tick(Instant::now(), &rig);
    assert!(desk.is_running() && desk.take_notes().is_empty());
    desk.twin.as_ref().expect("it runs").fail_on_trial();
    let begun = Instant::now();
    while desk.is_running() {
        assert!(begun.elapsed() < Duration::from_secs(30), "it is never noticed");
        desk.tick(Instant::now(), &rig);
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(desk.view().failed.is_some_and(|why| why.contains("physics have failed inside")));
    assert_eq!(desk.take_notes().len(), 1);
    assert!(
        desk.control(TwinCommand::Reset, &rig).expect_err("it ended").to_string().contains("not running")
    );
    desk.start("perfect", &rig).expect("another twin");
    assert!(desk.is_running() && desk.view().failed.is_none());
}
