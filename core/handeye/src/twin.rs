//! A twin as the body of a look, for tests.

use std::sync::Arc;

use plumbline_grasp::{Body, Halt, ServoState, Sight};
use plumbline_model::robot::{Posture, Rig};
use plumbline_twin::{Lockstep, Scenario, Toy};

/// A twin without a clock, its table cleared, its eyes warm.
pub struct TwinBody(Lockstep);

impl TwinBody {
    /// Of a scenario as its file has it.
    pub fn new(rig: &Rig, scenario: &str) -> Self {
        let scenario = Scenario::from_toml("test", scenario).expect("a scenario");
        let mut twin = Lockstep::new(Arc::new(rig.clone()), &scenario, 1).expect("a twin");
        Toy::ALL.into_iter().for_each(|toy| twin.remove_toy(toy));
        twin.advance_warm_up(1200.0);
        Self(twin)
    }
}

impl Body for TwinBody {
    fn rig(&self) -> &Arc<Rig> {
        self.0.rig()
    }

    fn now_s(&self) -> f64 {
        self.0.now_s()
    }

    fn servos(&mut self) -> Result<Vec<ServoState>, Halt> {
        Ok(vec![])
    }

    fn commanded(&mut self) -> Result<Posture, Halt> {
        Ok(self.0.commanded().clone())
    }

    fn follow(&mut self, way: &[Posture], speed_rad_s: f64) -> Result<(), Halt> {
        self.0.follow(way, speed_rad_s);
        Ok(())
    }

    fn wait(&mut self, duration_s: f64) -> Result<(), Halt> {
        self.0.wait(duration_s);
        Ok(())
    }

    fn look(&mut self) -> Result<Sight, Halt> {
        let pair = self.0.look().map_err(|error| Halt::Blind(error.to_string()))?;
        let (left, right) = (Arc::new(pair.left), Arc::new(pair.right));
        let (posture, at_s) = (self.0.encoders(), self.0.now_s());
        Ok(Sight { left, right, posture, at_s, eyes_on_s: Some(self.0.eyes_on_s()), seq: 0 })
    }
}
