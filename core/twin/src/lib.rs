//! The simulated NICO: physics, eyes, and servos that speak the true protocol.

pub mod scene;

#[cfg(test)]
mod tests {
    use mujoco_rs::prelude::*;
    #[test]
    fn the_library_answers() {
        let model = MjModel::from_xml_string("<mujoco><worldbody><body><freejoint/><geom size='.1'/></body></worldbody></mujoco>").unwrap();
        let mut data = MjData::new(&model);
        data.step();
        assert!(data.time() > 0.0);
    }
}
