//! Gates before anything moves.

use super::{End, Running};

/// A joint that hangs farther from where it was sent is not settled, rad.
const SETTLED_RAD: f64 = 0.25;

impl Running<'_> {
    /// Refuses when the arm is not fit to move: what is hot, overloaded or not where it was sent is
    /// named, and what to do.
    pub(super) fn ready(&mut self) -> Result<(), End> {
        let rig = self.body.rig().clone();
        let commanded = self.body.commanded()?;
        let planner = self.grasper.planner(self.order.method);
        let arm: Vec<_> = planner.arm().joints().iter().chain(planner.arm().hand()).copied().collect();
        for servo in self.body.servos()?.iter().filter(|servo| arm.contains(&servo.joint)) {
            let title = rig.servo_of(servo.joint).map_or("A joint", |known| known.title.as_str());
            if let Some(hot_c) = servo.temperature_c.filter(|celsius| *celsius >= rig.gate.hot_c) {
                return Err(End::Refused(format!(
                    "{title} has {hot_c:.0} °C: let it cool down to {:.0} °C",
                    rig.gate.warm_c
                )));
            }
            if servo.load.is_some_and(|load| load.abs() >= rig.gate.load) {
                return Err(End::Refused(format!(
                    "{title} pushes against something: move the arm by hand to where nothing is in its way"
                )));
            }
            if (servo.angle_rad - commanded[servo.joint]).abs() > SETTLED_RAD {
                return Err(End::Refused(format!(
                    "{title} is not where it was sent: let the arm come to rest, then try again"
                )));
            }
        }
        Ok(())
    }
}
