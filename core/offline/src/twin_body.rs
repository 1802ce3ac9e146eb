//! A twin without a clock as the body of a grasp, or of a look.

use std::sync::Arc;

use plumbline_grasp::body::{GRIP_RAD_S, closes, grip_force, turning};
use plumbline_grasp::{Body, Halt, ServoState, Sight};
use plumbline_model::robot::{JointIndex, Posture, Rig};
use plumbline_twin::{Lockstep, Toy};

/// Joints that turn by less stay, rad.
const SAME_RAD: f64 = 1e-9;

/// The twin, and what it lacks to be told from a robot.
pub(crate) struct TwinBody {
    twin: Lockstep,
    pairs: u64,
    /// Joints of hands.
    hands: Vec<JointIndex>,
}

impl TwinBody {
    /// The twin stands with one toy on its table, which has come to rest.
    pub fn new(mut twin: Lockstep, toy: Toy, at_m: [f64; 2]) -> Result<Self, plumbline_twin::TwinError> {
        Toy::ALL.into_iter().filter(|other| *other != toy).for_each(|other| twin.remove_toy(other));
        twin.place_toy(toy, at_m[0], at_m[1])?;
        twin.wait(1.0);
        Ok(Self::of(twin))
    }

    /// The twin stands before an empty table.
    pub fn cleared(mut twin: Lockstep) -> Self {
        Toy::ALL.into_iter().for_each(|toy| twin.remove_toy(toy));
        Self::of(twin)
    }

    fn of(twin: Lockstep) -> Self {
        let hands = twin.rig().arms.iter().flat_map(|arm| arm.hand.iter().copied()).collect();
        Self { twin, pairs: 0, hands }
    }

    /// Somebody else takes the robot over. As on the bus, goals of fingers that met something lie no farther ahead of
    /// them than a step.
    pub fn taken_over(&mut self) {
        let (commanded, here) = (self.twin.commanded().clone(), self.twin.encoders());
        let step_rad = self.rig().gate.step_rad;
        let goal =
            |joint: &JointIndex| here[*joint] + (commanded[*joint] - here[*joint]).clamp(-step_rad, step_rad);
        let goals: Vec<f64> = self.hands.iter().map(goal).collect();
        let taken = commanded.with(&self.hands, &goals);
        if taken.distance_rad(&commanded) > SAME_RAD {
            self.twin.follow(&[taken], GRIP_RAD_S);
        }
    }

    /// What only a twin can, and for who judges.
    pub fn twin(&mut self) -> &mut Lockstep {
        &mut self.twin
    }

    /// The twin itself.
    pub fn into_twin(self) -> Lockstep {
        self.twin
    }
}

impl Body for TwinBody {
    fn rig(&self) -> &Arc<Rig> {
        self.twin.rig()
    }

    fn now_s(&self) -> f64 {
        self.twin.now_s()
    }

    fn servos(&mut self) -> Result<Vec<ServoState>, Halt> {
        let servos = self.twin.servos().into_iter().map(|servo| ServoState {
            joint: servo.joint,
            angle_rad: servo.angle_rad,
            load: Some(servo.load),
            current_a: None,
            temperature_c: Some(servo.temperature_c),
        });
        Ok(servos.collect())
    }

    fn commanded(&mut self) -> Result<Posture, Halt> {
        Ok(self.twin.commanded().clone())
    }

    /// As on the bus: fingers that close press with no more than a grip does, until they are moved otherwise.
    fn follow(&mut self, way: &[Posture], speed_rad_s: f64) -> Result<(), Halt> {
        let from = self.twin.commanded().clone();
        let joints = turning(self.rig(), &from, way, SAME_RAD);
        let end = way.last().unwrap_or(&from);
        let goals: Vec<(JointIndex, f64)> = joints.iter().map(|joint| (*joint, end[*joint])).collect();
        let grips = closes(&self.hands, &from, &goals);
        for joint in joints.into_iter().filter(|joint| self.hands.contains(joint)) {
            let force = if grips { grip_force(self.rig(), joint) } else { 1.0 };
            self.twin.limit(joint, force);
        }
        let speed_rad_s = if grips { speed_rad_s.min(GRIP_RAD_S) } else { speed_rad_s };
        self.twin.follow(way, speed_rad_s);
        Ok(())
    }

    fn wait(&mut self, duration_s: f64) -> Result<(), Halt> {
        self.twin.wait(duration_s);
        Ok(())
    }

    fn look(&mut self) -> Result<Sight, Halt> {
        let pair = self.twin.look().map_err(|error| Halt::Blind(error.to_string()))?;
        self.pairs += 1;
        Ok(Sight {
            left: Arc::new(pair.left),
            right: Arc::new(pair.right),
            posture: self.twin.encoders(),
            at_s: self.twin.now_s(),
            eyes_on_s: Some(self.twin.eyes_on_s()),
            seq: self.pairs,
        })
    }
}
