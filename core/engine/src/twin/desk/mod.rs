//! The operator's side of the twin: starting it, placing things, its clock, its faults.

mod room;
mod shown;
#[cfg(test)]
mod tests;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use plumbline_model::counted;
use plumbline_model::frame::{Board, Pose, Robot};
use plumbline_model::robot::Rig;
use plumbline_twin::{
    Fault, Scenario, Toy, Twin, TwinSettings, TwinTouchscreen, board_presets, few_board_presets,
};

use self::room::{is_on_screen, lying};
use super::board_tour::{BoardLook, BoardTours, TourStep};
use super::command::TwinCommand;
use super::eyes::TwinEyesPlug;
use super::unable::TwinUnable;
use crate::ground::notice::NoticeLevel;
use crate::truth::TruthPlug;

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
            TwinCommand::SkipPlace => {
                self.tours.skip();
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

    /// The eyes have looked for the board.
    pub fn looked(&mut self, look: BoardLook) {
        self.tours.looked(look);
    }

    /// Goes on with what takes time.
    pub fn tick(&mut self, now: Instant, _rig: &Rig) {
        if self.twin.as_ref().is_some_and(Twin::has_failed) {
            return self.let_go_of_the_failed();
        }
        self.truth.look(self.twin.as_ref(), now);
        let Some(twin) = &self.twin else { return };
        match self.tours.step(now) {
            TourStep::Stays => {}
            TourStep::Holds(robot_from_board) => {
                twin.send(plumbline_twin::TwinCommand::PlaceBoard { robot_from_board });
            }
            TourStep::Ends { places } => {
                twin.send(plumbline_twin::TwinCommand::HideBoard);
                let text = match places == self.board_places.len() {
                    true => format!("The board was shown at all {places} places."),
                    false => format!("The board was shown at {}.", counted(places, "place")),
                };
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
}
