//! The simulated robot: its physics and what draws its eyes.

use plumbline_model::robot::default_rig;
use plumbline_twin::Scenario;
use plumbline_twin::eyes::{EyeOptions, EyeRenderer};
use plumbline_twin::physics::World;

use super::Check;

/// Builds a world and asks for a device to draw on.
pub(super) fn checks() -> Vec<Check> {
    let world = Scenario::built_in("perfect").and_then(|scenario| World::new(default_rig(), &scenario, 1));
    let physics = match world {
        Ok(_) => Check::good("twin", "the simulated robot can be started"),
        Err(error) => Check::bad("twin", format!("{error}; run ./plumbline setup")),
    };
    let eyes = match EyeRenderer::new(EyeOptions::default()) {
        Ok(renderer) => Check::good("twin's eyes", format!("drawn by {}", renderer.adapter_name())),
        Err(error) => Check::bad("twin's eyes", error.to_string()),
    };
    vec![physics, eyes]
}
