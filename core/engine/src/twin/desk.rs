//! The operator's side of the twin: starting it, placing things, its clock, its faults.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use plumbline_model::Point;
use plumbline_model::frame::{Board, Pose, Robot};
use plumbline_model::robot::Rig;
use plumbline_twin::{
    Fault, Scenario, Toy, Twin, TwinSettings, TwinTouchscreen, board_presets, few_board_presets,
};

use super::board_tour::{BoardTours, TourStep};
use super::command::TwinCommand;
use super::eyes::TwinEyesPlug;
use super::unable::TwinUnable;
use super::view::{FaultView, ToyView, TwinView};
use crate::ground::notice::NoticeLevel;
use crate::truth::TruthPlug;

/// So much around the touchscreen is kept free of toys while it is touched: a hand is broad, m.
const BESIDE_SCREEN_M: f64 = 0.06;
const PHYSICS_FAILED: &str = "The twin's physics have failed inside, so the twin has ended. Nothing real is hurt: connect to the twin again, and report it with the log.";
/// The same twin every time.
const SEED: u64 = 1;

/// The twin and what the operator does with it.
pub struct TwinDesk {
    eyes: TwinEyesPlug,
    truth: TruthPlug,
    twin: Option<Twin>,
    scenario: String,
    failed: Option<String>,
    board_places: Vec<Pose<Robot, Board>>,
    few_places: Vec<Pose<Robot, Board>>,
    tours: BoardTours,
    /// Toys that made room for the board that lies on the table, and where they stood (x, y in the robot's
    /// frame, m).
    made_room: Vec<(Toy, [f64; 2])>,
    /// The same of those that made room on the screen that is touched.
    off_screen: Vec<(Toy, [f64; 2])>,
    notes: Vec<(NoticeLevel, String)>,
}

impl TwinDesk {
    /// None runs.
    pub fn new(eyes: TwinEyesPlug) -> Self {
        Self {
            eyes,
            truth: TruthPlug::default(),
            twin: None,
            scenario: String::new(),
            failed: None,
            board_places: Vec::new(),
            few_places: Vec::new(),
            tours: BoardTours::default(),
            made_room: Vec::new(),
            off_screen: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Shows the twin to truth mode, which nobody asked for at first.
    #[must_use]
    pub fn with_truth(self, truth: TruthPlug) -> Self {
        Self { truth, ..self }
    }

    /// Whether a twin runs.
    pub fn is_running(&self) -> bool {
        self.twin.is_some()
    }

    /// Where its servos are reached.
    pub fn port(&self) -> Option<PathBuf> {
        self.twin.as_ref().map(Twin::port)
    }

    /// Its touchscreen.
    pub fn touchscreen(&self) -> Option<TwinTouchscreen> {
        self.twin.as_ref().map(Twin::touchscreen)
    }

    /// Messages since the last call.
    pub fn take_notes(&mut self) -> Vec<(NoticeLevel, String)> {
        std::mem::take(&mut self.notes)
    }

    /// Starts a twin in place of a running one; gives the port of its servos.
    pub fn start(&mut self, scenario: &str, rig: &Arc<Rig>) -> Result<PathBuf, TwinUnable> {
        self.eyes.set(None);
        self.twin = None;
        self.tours = BoardTours::default();
        self.made_room.clear();
        self.off_screen.clear();
        scenario.clone_into(&mut self.scenario);
        let started = self.try_start(scenario, rig);
        self.failed = started.as_ref().err().map(ToString::to_string);
        started
    }

    fn try_start(&mut self, scenario: &str, rig: &Arc<Rig>) -> Result<PathBuf, TwinUnable> {
        let scenario = Scenario::named_or_file(scenario)?;
        let settings = TwinSettings { rig: rig.clone(), scenario, seed: SEED, pace: 1.0 };
        let twin = Twin::start(settings)?;
        (self.board_places, self.few_places) = (board_presets(rig), few_board_presets(rig));
        self.eyes.set(Some(twin.scene()));
        let port = twin.port();
        self.twin = Some(twin);
        Ok(port)
    }

    /// Does what the operator asked.
    pub fn control(&mut self, command: TwinCommand, rig: &Rig) -> Result<(), TwinUnable> {
        let touched = match &command {
            TwinCommand::PlaceToy { toy, .. } | TwinCommand::RemoveToy { toy } => Toy::from_name(toy),
            _ => None,
        };
        let takes_board = matches!(
            command,
            TwinCommand::HoldBoard { .. }
                | TwinCommand::TourBoard(true)
                | TwinCommand::TourFew
                | TwinCommand::TourRest
                | TwinCommand::HideBoard
        );
        let resets = matches!(command, TwinCommand::Reset);
        self.carry_out(command, rig)?;
        // Whoever was put somewhere by hand stays there.
        for away in [&mut self.made_room, &mut self.off_screen] {
            away.retain(|(toy, _)| !resets && Some(*toy) != touched);
        }
        if takes_board {
            self.put_back(rig);
        }
        Ok(())
    }

    fn carry_out(&mut self, command: TwinCommand, rig: &Rig) -> Result<(), TwinUnable> {
        let twin = self.twin.as_ref().ok_or(TwinUnable::NotRunning)?;
        let toy = |name: &str| Toy::from_name(name).ok_or_else(|| TwinUnable::NoToy(name.to_owned()));
        let send = |command| {
            twin.send(command);
            Ok(())
        };
        use plumbline_twin::TwinCommand as To;
        match command {
            TwinCommand::PlaceToy { toy: name, x_m, y_m } => {
                let on = |range: [f64; 2], value: f64| value >= range[0] && value <= range[1];
                if !(on(rig.table.x_range_m, x_m) && on(rig.table.y_range_m, y_m)) {
                    return Err(TwinUnable::BesideTable);
                }
                send(To::PlaceObject { toy: toy(&name)?, x_m, y_m })
            }
            TwinCommand::RemoveToy { toy: name } => send(To::RemoveObject { toy: toy(&name)? }),
            TwinCommand::HoldBoard { place } => {
                let robot_from_board = self.board_places.get(place).copied();
                let robot_from_board =
                    robot_from_board.ok_or(TwinUnable::NoPlace(self.board_places.len()))?;
                self.tours.break_off();
                send(To::PlaceBoard { robot_from_board })
            }
            TwinCommand::LayBoard { x_m, y_m, yaw_rad } => {
                self.tours.break_off();
                let robot_from_board = lying(rig, x_m, y_m, yaw_rad)?;
                self.make_room(&robot_from_board, rig);
                let twin = self.twin.as_ref().ok_or(TwinUnable::NotRunning)?;
                twin.send(To::PlaceBoard { robot_from_board });
                Ok(())
            }
            TwinCommand::TourBoard(on) => {
                self.tours.break_off();
                if on {
                    self.tours.begin(self.board_places.clone());
                }
                Ok(())
            }
            TwinCommand::TourFew => {
                self.tours.begin(self.few_places.clone());
                Ok(())
            }
            TwinCommand::TourRest => {
                self.tours.go_on(&self.board_places);
                Ok(())
            }
            TwinCommand::HideBoard => {
                self.tours.break_off();
                send(To::HideBoard)
            }
            TwinCommand::PrepareTouch { screen_height_m, payload_kg } => {
                self.tours.break_off();
                self.free_screen(rig);
                // Whoever made room for the board on the screen comes back when nobody touches it any more.
                let on_screen = |at: &[f64; 2]| is_on_screen([at[0], at[1], rig.table.height_m].into(), rig);
                let before = std::mem::take(&mut self.made_room);
                let (later, back): (Vec<_>, Vec<_>) = before.into_iter().partition(|(_, at)| on_screen(at));
                self.made_room = back;
                self.put_back(rig);
                self.off_screen.extend(later);
                let twin = self.twin.as_ref().ok_or(TwinUnable::NotRunning)?;
                twin.send(To::HideBoard);
                twin.send(To::PrepareTouch { screen_height_m, payload_kg });
                Ok(())
            }
            TwinCommand::EndTouch => {
                self.leave_screen(rig);
                Ok(())
            }
            TwinCommand::AdvanceWarmUp { minutes } => {
                if !(minutes > 0.0 && minutes <= 600.0) {
                    return Err(TwinUnable::TooLong);
                }
                send(To::AdvanceWarmUp { minutes })
            }
            TwinCommand::WarmUpPace { times } => send(To::WarmUpPace { times }),
            TwinCommand::CoolEyes => send(To::CoolEyes),
            TwinCommand::Fault { name, on } => {
                let fault = Fault::from_name(&name).ok_or_else(|| TwinUnable::NoFault(name.clone()))?;
                send(To::Fault { fault, on })
            }
            TwinCommand::Reset => {
                self.tours = BoardTours::default();
                send(To::Reset)
            }
        }
    }

    /// Puts toys away that stand where the board is to lie: they would hide its corners. Those that made
    /// room for it elsewhere come back.
    fn make_room(&mut self, robot_from_board: &Pose<Robot, Board>, rig: &Rig) {
        let Some(twin) = &self.twin else { return };
        let hides = |toy: Toy, at_m: [f64; 2]| is_on_board(toy, at_m, robot_from_board, rig);
        let before = std::mem::take(&mut self.made_room);
        let (stay_away, back): (Vec<_>, Vec<_>) = before.into_iter().partition(|(toy, at)| hides(*toy, *at));
        let mut away = vec![];
        for (toy, place) in &twin.state().toys {
            let Some(at_m) = place.map(|place| [place.x, place.y]).filter(|at_m| hides(*toy, *at_m)) else {
                continue;
            };
            twin.send(plumbline_twin::TwinCommand::RemoveObject { toy: *toy });
            away.push((*toy, at_m));
        }
        if !away.is_empty() {
            let names: Vec<&str> = away.iter().map(|(toy, _)| toy.name()).collect();
            let text = format!(
                "Put away to make room for the board, and back where they stood once it is gone: {}.",
                names.join(", ")
            );
            self.notes.push((NoticeLevel::Info, text));
        }
        self.made_room = back;
        self.put_back(rig);
        self.made_room = [stay_away, away].concat();
    }

    /// Nobody touches the screen any more. Where the board is out, toys come back once it is put away.
    fn leave_screen(&mut self, rig: &Rig) {
        let is_board_out = self.twin.as_ref().is_some_and(|twin| twin.state().board.is_some());
        self.made_room.append(&mut self.off_screen);
        if !is_board_out {
            self.put_back(rig);
        }
    }

    /// Toys that made room stand where they stood.
    fn put_back(&mut self, rig: &Rig) {
        let Some(twin) = &self.twin else { return };
        let mut back = vec![];
        for (toy, [x_m, y_m]) in std::mem::take(&mut self.made_room) {
            // One that was at the very edge, or had been pushed off the table, cannot be put there.
            let on = |range: [f64; 2], value: f64| value >= range[0] && value <= range[1];
            if on(rig.table.x_range_m, x_m) && on(rig.table.y_range_m, y_m) {
                twin.send(plumbline_twin::TwinCommand::PlaceObject { toy, x_m, y_m });
                back.push(toy.name());
            }
        }
        if !back.is_empty() {
            let text = format!("Back where they stood: {}.", back.join(", "));
            self.notes.push((NoticeLevel::Info, text));
        }
    }

    /// Puts toys away that lie on the touchscreen or near it: a finger would land on them.
    pub fn free_screen(&mut self, rig: &Rig) {
        let Some(twin) = &self.twin else { return };
        let mut away = vec![];
        for (toy, place) in &twin.state().toys {
            let Some(place) = place.filter(|place| is_on_screen(*place, rig)) else { continue };
            twin.send(plumbline_twin::TwinCommand::RemoveObject { toy: *toy });
            away.push((*toy, [place.x, place.y]));
        }
        // One that was put away just now may still be seen.
        away.retain(|(toy, _)| !self.off_screen.iter().any(|(known, _)| known == toy));
        if !away.is_empty() {
            let names: Vec<&str> = away.iter().map(|(toy, _)| toy.name()).collect();
            let text = format!(
                "Put away, so that the screen can be touched, and back where they stood once the run is closed and no hand is there: {}.",
                names.join(", ")
            );
            self.notes.push((NoticeLevel::Info, text));
            self.off_screen.extend(away);
        }
    }

    /// Goes on with what takes time.
    pub fn tick(&mut self, now: Instant, _rig: &Rig) {
        if self.twin.as_ref().is_some_and(Twin::has_failed) {
            return self.let_go_of_the_failed();
        }
        self.truth.look(self.twin.as_ref(), now);
        let Some(twin) = &self.twin else { return };
        match self.tours.step(now, self.eyes.looks()) {
            TourStep::Stays => {}
            TourStep::Holds(robot_from_board) => {
                twin.send(plumbline_twin::TwinCommand::PlaceBoard { robot_from_board });
            }
            TourStep::Ends { places } => {
                twin.send(plumbline_twin::TwinCommand::HideBoard);
                let all = if places == self.board_places.len() { "all " } else { "" };
                let text = format!("The board was shown at {all}{places} places.");
                self.notes.push((NoticeLevel::Info, text));
            }
        }
    }

    /// Its servos would answer for ever with the angles they had: without it their bus is gone, and
    /// that is said too.
    fn let_go_of_the_failed(&mut self) {
        self.eyes.set(None);
        self.twin = None;
        self.tours = BoardTours::default();
        self.notes.push((NoticeLevel::Error, PHYSICS_FAILED.to_owned()));
        self.failed = Some(PHYSICS_FAILED.to_owned());
    }

    /// What the window shows.
    pub fn view(&self) -> TwinView {
        let scenarios = Scenario::built_in_names()
            .filter_map(|name| Scenario::built_in(name).ok())
            .map(|scenario| (scenario.name.clone(), scenario.about.clone()))
            .collect();
        let view = TwinView {
            running: self.twin.is_some(),
            failed: self.failed.clone(),
            scenarios,
            scenario: self.scenario.clone(),
            board_places: self.board_places.len(),
            few_board_places: self.few_places.len(),
            board_tour: self.tours.view(),
            board_places_left: self.tours.left(),
            ..TwinView::default()
        };
        let Some(twin) = &self.twin else { return view };
        let state = twin.state();
        let toy = |toy: Toy| ToyView {
            name: toy.name().to_owned(),
            place: state.toys.iter().find(|(placed, _)| *placed == toy).and_then(|(_, place)| *place).map(
                // Rolling by less than this is not worth drawing the window again.
                |place| Point::new(rounded(place.x), rounded(place.y), rounded(place.z)),
            ),
            radius_m: toy.radius_m(),
            rgb: color(toy),
        };
        let fault = |fault: Fault| FaultView {
            name: fault.name().to_owned(),
            about: fault.about().to_owned(),
            on: state.faults.contains(&fault),
        };
        TwinView {
            // Whole seconds: the window need not be drawn again for less.
            time_s: state.time_s.floor(),
            eyes_on_s: state.eyes_on_s.floor(),
            warm_up_pace: state.warm_up_pace,
            real_time_factor: (state.real_time_factor * 20.0).round() / 20.0,
            toys: Toy::ALL.into_iter().map(toy).collect(),
            board: state.board,
            screen_height_m: state.screen_height_m,
            payload_kg: state.payload_kg,
            faults: Fault::ALL.iter().copied().map(fault).collect(),
            ..view
        }
    }
}

/// As it is drawn on the map and in the 3D scene.
fn color(toy: Toy) -> [u8; 3] {
    match toy {
        Toy::Tomato => [205, 48, 38],
        Toy::Banana => [236, 200, 52],
        Toy::Duck => [245, 214, 70],
        Toy::Mushroom => [150, 104, 68],
        Toy::Onion => [232, 228, 214],
        Toy::Orange => [240, 138, 36],
    }
}

fn rounded(meters: f64) -> f64 {
    (meters * 1e3).round() / 1e3
}

/// The board flat on the table, its center at a place.
fn lying(rig: &Rig, x_m: f64, y_m: f64, yaw_rad: f64) -> Result<Pose<Robot, Board>, TwinUnable> {
    if ![x_m, y_m, yaw_rad].iter().all(|value| value.is_finite()) {
        return Err(TwinUnable::NotNumbers);
    }
    let board = plumbline_model::default_board();
    let turn = nalgebra::UnitQuaternion::from_scaled_axis(nalgebra::Vector3::z() * yaw_rad)
        // z goes into the board, which is down; its columns then run to the robot's right.
        * nalgebra::UnitQuaternion::from_scaled_axis(nalgebra::Vector3::x() * std::f64::consts::PI);
    let half = nalgebra::Vector3::new(
        0.5 * f64::from(board.inner_columns - 1) * board.square_m,
        0.5 * f64::from(board.inner_rows - 1) * board.square_m,
        0.0,
    );
    let center = nalgebra::Vector3::new(x_m, y_m, rig.table.height_m + BOARD_THICKNESS_M);
    let origin = center - turn * half;
    Ok(Pose::new(nalgebra::Isometry3::from_parts(origin.into(), turn)))
}

/// Whether a toy at a place stands on the touchscreen, or so near that a hand would meet it.
fn is_on_screen(place: nalgebra::Vector3<f64>, rig: &Rig) -> bool {
    let screen = &rig.touchscreen;
    let pixel = screen.pixel_at(Point::from(nalgebra::Point3::from(place)));
    let near = |at_px: f64, count: u32, size_m: f64| {
        let at_m = at_px * size_m / f64::from(count);
        at_m > -BESIDE_SCREEN_M && at_m < size_m + BESIDE_SCREEN_M
    };
    near(pixel.u_px, screen.width_px, screen.width_m) && near(pixel.v_px, screen.height_px, screen.height_m)
}

/// Whether a toy at a place of the table would hide some of a lying board.
fn is_on_board(toy: Toy, [x_m, y_m]: [f64; 2], robot_from_board: &Pose<Robot, Board>, rig: &Rig) -> bool {
    let board = plumbline_model::default_board();
    let size = |corners: u32| f64::from(corners - 1) * board.square_m;
    let place = nalgebra::Point3::new(x_m, y_m, rig.table.height_m);
    let on_board = robot_from_board.isometry.inverse() * place;
    // The eyes look from the side, so what stands near hides something too.
    let reach_m = 2.0 * board.square_m + 2.0 * toy.radius_m();
    let inside = |value: f64, size_m: f64| value > -reach_m && value < size_m + reach_m;
    inside(on_board.x, size(board.inner_columns)) && inside(on_board.y, size(board.inner_rows))
}

/// The printed side lies this high above the table, m; the touchscreen's glass is lower.
const BOARD_THICKNESS_M: f64 = 0.006;

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use plumbline_model::Pixel;

    use super::super::board_tour::NOBODY_LOOKS;
    use super::super::view::BoardTour;
    use super::*;

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
        desk.control(TwinCommand::PrepareTouch { screen_height_m: 0.0, payload_kg: 0.0 }, &rig)
            .expect("free");
        // The next touch makes sure, perhaps before anything has moved.
        desk.free_screen(&rig);
        until(&desk, "room", &|desk| place(desk, Toy::Tomato).is_none());
        desk.control(TwinCommand::EndTouch, &rig).expect("as asked");
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
        assert_eq!(desk.view().board_tour, Some(BoardTour { place: 3, of: all }));
        desk.control(TwinCommand::TourBoard(false), &rig).expect("as asked");
        assert_eq!((desk.view().board_tour, desk.view().board_places_left), (None, all - 2));
        desk.control(TwinCommand::TourRest, &rig).expect("as asked");
        desk.tick(begun, &rig);
        assert_eq!(desk.view().board_tour, Some(BoardTour { place: 3, of: all }), "the third once more");
        assert_eq!(desk.view().board_places_left, 0);
        desk.control(TwinCommand::TourBoard(true), &rig).expect("as asked");
        desk.tick(begun, &rig);
        assert_eq!(desk.view().board_tour, Some(BoardTour { place: 1, of: all }), "all means all");
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
}
