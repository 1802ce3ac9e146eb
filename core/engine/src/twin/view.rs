//! The twin, as far as the operator may see and move it: what was placed where, its clock, the
//! faults that were switched on. What the scenario hides is not here.

use nalgebra::Vector3;
use plumbline_model::frame::{Board, Point, Pose, Robot};

/// The twin.
#[derive(Clone, Debug, PartialEq)]
pub struct TwinView {
    /// Whether it runs.
    pub running: bool,
    /// Why it does not although it was asked to, and what to do.
    pub failed: Option<String>,
    /// Scenarios to choose from: name, and a sentence for people.
    pub scenarios: Vec<(String, String)>,
    /// The one in use.
    pub scenario: String,
    /// Simulated time since start, s.
    pub time_s: f64,
    /// Simulated seconds per second; below its pace when the machine is too slow.
    pub real_time_factor: f64,
    /// Time since the eyes were switched on, s.
    pub eyes_on_s: f64,
    /// How many times faster than everything else the eyes' clock runs; 1 unless it was asked for.
    pub warm_up_pace: f64,
    /// Toys: name, and where it stands now (`None`: put away).
    pub toys: Vec<ToyView>,
    /// Toys that made room for the hand at the screen, and come back once none is there.
    pub made_room: Vec<String>,
    /// The chessboard, if it is out.
    pub board: Option<Pose<Robot, Board>>,
    /// Number of places that the board can be held at for calibrating the eyes.
    pub board_places: usize,
    /// So many of them suffice where the board is then looked at as it lies on the table.
    pub few_board_places: usize,
    /// The board on its way through places.
    pub board_tour: Option<BoardTour>,
    /// Places that are missing since that was broken off.
    pub board_places_left: usize,
    /// Height of the block under the touchscreen, m.
    pub screen_height_m: f64,
    /// Weight in the right palm, kg.
    pub payload_kg: f64,
    /// Faults of the servo bus: name, sentence, whether it is on.
    pub faults: Vec<FaultView>,
}

impl Default for TwinView {
    /// Not running.
    fn default() -> Self {
        Self {
            running: false,
            failed: None,
            scenarios: Vec::new(),
            scenario: String::new(),
            time_s: 0.0,
            real_time_factor: 0.0,
            eyes_on_s: 0.0,
            warm_up_pace: 1.0,
            toys: Vec::new(),
            made_room: Vec::new(),
            board: None,
            board_places: 0,
            few_board_places: 0,
            board_tour: None,
            board_places_left: 0,
            screen_height_m: 0.0,
            payload_kg: 0.0,
            faults: Vec::new(),
        }
    }
}

impl TwinView {
    /// Whether the board is out and lies flat, its printed side up; it may also be held somewhere in the air.
    pub fn has_lying_board(&self) -> bool {
        let into_the_board = |pose: &Pose<Robot, Board>| pose.isometry.rotation * Vector3::z();
        self.board.as_ref().is_some_and(|pose| into_the_board(pose).z < -0.99)
    }
}

/// The board on its way through places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoardTour {
    /// Number of the place where it is, from 1.
    pub place: usize,
    /// Of so many.
    pub of: usize,
    /// What it waits for there; `None`: nothing that takes long.
    pub waits: Option<TourWaits>,
}

/// What the board waits for at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TourWaits {
    /// That somebody looks for it: the machine is busy, or the eyes are closed.
    Look,
    /// That both eyes see it sharp and still.
    Sight,
}

/// A toy.
#[derive(Clone, Debug, PartialEq)]
pub struct ToyView {
    /// Its name.
    pub name: String,
    /// Where its center is.
    pub place: Option<Point<Robot>>,
    /// Radius of a ball of its size, m.
    pub radius_m: f64,
    /// Color as red, green, blue.
    pub rgb: [u8; 3],
}

/// A fault that can be switched on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultView {
    /// Short name, for commands.
    pub name: String,
    /// What happens, for people.
    pub about: String,
    /// Whether it is on.
    pub on: bool,
}

/// The twin lives in the robot's thread and goes with it.
pub(crate) fn twin_without_its_thread(before: &TwinView, reason: &str) -> TwinView {
    let failed = before.running.then(|| reason.to_owned());
    TwinView { running: false, failed: failed.or_else(|| before.failed.clone()), ..before.clone() }
}
