//! What the window shows of the twin.

use plumbline_model::Point;
use plumbline_twin::{Fault, Scenario, Toy};

use super::TwinDesk;
use crate::twin::view::{FaultView, ToyView, TwinView};

impl TwinDesk {
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
            made_room: self.off_screen.iter().map(|(toy, _)| toy.name().to_owned()).collect(),
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
