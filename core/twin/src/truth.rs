//! What is really so: for judges and tests only. Nothing that calibrates, trains, searches or
//! grasps may read it.

use nalgebra::Isometry3;
use plumbline_model::robot::{LinkIndex, Posture};

use crate::physics::{Places, World};
use crate::scene::TrueEyes;
use crate::toys::Toy;

/// The twin's hidden state at one moment.
#[derive(Clone, Debug)]
pub struct Truth {
    /// Place of every link and mark, by link of the description.
    pub robot_from_link: Vec<Option<Isometry3<f64>>>,
    /// Place of table and touchscreen.
    pub places: Places,
    /// The eyes.
    pub eyes: TrueEyes,
    /// Joint angles as the encoders have them, not rounded to ticks.
    pub encoders: Posture,
    /// Toys and where they are; `None`: put away.
    pub toys: Vec<(Toy, Option<Isometry3<f64>>)>,
}

impl World {
    /// What is really so. For judges and tests only.
    pub fn truth_for_judging(&mut self) -> Truth {
        self.refresh();
        let links = self.rig().description.links().len();
        Truth {
            robot_from_link: (0..links).map(|i| self.true_link(LinkIndex(i))).collect(),
            places: *self.places(),
            eyes: self.true_eyes(),
            encoders: self.encoders(),
            toys: Toy::ALL.into_iter().map(|toy| (toy, self.toy(toy))).collect(),
        }
    }
}
