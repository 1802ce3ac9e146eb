//! What is known of a kind of effect: its words, its parameters, where it sits, what rows show it
//! and what it does.

use super::known::Known;
use super::report::Fit;
use super::{Effect, Parameter, Reported, Situation};
use crate::arm::{Deviation, GRAVITY_M_S2};
use crate::eyes::{EyeSituation, EyesDeviation};

/// All that is known of a kind of effect.
pub(crate) struct Entry {
    /// What it is, for people; its site comes before it where it has one.
    pub about: &'static str,
    /// What it means for the robot, a sentence.
    pub meaning: &'static str,
    /// What could be done about it in the lab, other than adding it to the model.
    pub remedy: &'static str,
    /// Its parameters in their usual size.
    pub parameters: &'static [Parameter],
    /// The same at a joint that slides, where they are lengths instead of angles; else empty.
    pub sliding: &'static [Parameter],
    /// Where it sits.
    pub site: Site,
    /// What of it is no matter of degree.
    pub shape: Shape,
    /// Whether rows could show it, by their columns.
    pub shown: fn(&Known) -> bool,
    /// What it does, linear in its values.
    pub act: Act,
    /// Its parameters as people read them.
    pub reported: fn(&Effect, &Fit<'_>) -> Vec<Reported>,
    /// What else is true of it.
    pub is: &'static [Is],
}

impl Entry {
    pub fn is(&self, what: Is) -> bool {
        self.is.contains(&what)
    }
}

/// Where effects of a kind sit.
#[derive(Clone, Copy)]
pub(crate) enum Site {
    /// At each joint of the arm.
    Joint,
    /// The same, or as one size for all joints alike: parts of one make, one controller.
    JointOrAllAlike,
    /// The same, or at every joint at once, each with its own values, as when an arm is put
    /// together: parameters at up to twelve sites in turn.
    JointOrEvery(&'static [Parameter]),
    /// At each joint that another one may pull along.
    JointBesideAnother,
    /// At each link between two joints; the way to the tip belongs to the tip's offset.
    Link,
    /// The same, or at every link at once.
    LinkOrEvery(&'static [Parameter]),
    /// At the tip.
    Tip,
    /// At the tip while it meets the screen.
    Contact,
    /// At the tip as the end of all that moves.
    WholeArm,
    /// Where a weight is held.
    Palm,
    /// At the base of the arm.
    Base,
    /// At the touchscreen.
    Screen,
    /// At the eyes.
    OfEyes(EyeSite),
}

/// Where at the eyes.
#[derive(Clone, Copy)]
pub(crate) enum EyeSite {
    /// At each joint of the neck.
    Neck,
    /// At the right eye, against the left one.
    Right,
    /// At both.
    Both,
    /// At one of both. What grows at the left one is told as what grows at the right one, the other way.
    One,
    /// At both alike, or at one of them alone.
    BothOrOne,
    /// At the right eye, while one set of rows was measured: the site is the label of the set.
    Set,
}

impl Site {
    /// Parameters at up to twelve sites in turn, where it comes at every site at once.
    pub fn parameters_of_every(self) -> &'static [Parameter] {
        match self {
            Self::JointOrEvery(parameters) | Self::LinkOrEvery(parameters) => parameters,
            _ => &[],
        }
    }
}

/// What [`Effect::shape`] means for effects of a kind.
#[derive(Clone, Copy)]
pub(crate) enum Shape {
    /// Nothing.
    None,
    /// Periods per turn: one (`None`) or two.
    OnceOrTwice,
    /// Periods per turn: many.
    Teeth,
    /// Largest torque that is held, N m.
    Limit,
    /// Time constant, s, of what grows while this lasts, s.
    TimeConstant(fn(&Known) -> f64),
    /// Moment, s.
    Moment,
    /// `None`: constant. Else it grows, see [`Effect::growth`], and has these parameters.
    Growth(&'static [Parameter]),
    /// `None`: the first of some things; 1: the second, and so on.
    OneOf(&'static [&'static str]),
    /// Which other joint pulls: `None`: the one before (of the first joint the one behind it); 1: the first one of the
    /// others, in the order of the arm, and so on.
    AnotherJoint,
}

/// What effects of a kind do.
#[derive(Clone, Copy)]
pub(crate) enum Act {
    /// Turns a joint by so much, rad.
    Turn(fn(&Turning<'_>) -> f64),
    /// Something else at a joint or link.
    Joint(fn(&Turning<'_>, &mut Deviation)),
    /// Something at the arm as a whole, its tip, its base or the screen.
    Arm(fn(&Effect, &Situation<'_>, &[f64], &mut Deviation)),
    /// Something at the eyes.
    Eyes(fn(&Effect, &EyeSituation, &[f64], &mut EyesDeviation)),
    /// Nothing that a prediction holds.
    Unseen,
}

/// What may be true of a kind of effect.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Is {
    /// A plan of touches is scored by it: it does not depend on time, speed or logging.
    Planned,
    /// An encoder sees it, so that a prediction from encoder angles already holds it.
    SeenByEncoder,
    /// It sits between motor and joint: an encoder behind the gear sees it, one at the motor does not.
    SeenBehindGear,
    /// A joint that slides has it, too.
    OfSlides,
    /// It goes with a load, and so with masses.
    OfLoad,
    /// A robot's description can hold it, as the place of a joint or of the tip.
    Origin,
    /// Nothing has less than none of it: what gives way goes with the load, a pad is round to the outside.
    OneSided,
}

/// An effect at one joint in a situation.
pub(crate) struct Turning<'a> {
    pub effect: &'a Effect,
    pub situation: &'a Situation<'a>,
    /// Place of the joint in the arm.
    pub joint: usize,
    pub values: &'a [f64],
}

impl Turning<'_> {
    /// Value of its first parameter.
    pub fn value(&self) -> f64 {
        self.values[0]
    }

    pub fn angle_rad(&self) -> f64 {
        self.situation.angles_rad[self.joint]
    }

    /// Of the joint that pulls this one along.
    pub fn angle_of_puller_rad(&self) -> f64 {
        let puller = self.effect.puller().and_then(|puller| self.situation.angles_rad.get(puller.place));
        puller.copied().unwrap_or(0.0)
    }

    pub fn torque_nm(&self) -> f64 {
        self.situation.torques_nm[self.joint]
    }

    /// What all that the joint bears would turn it by were it at the hand, N m.
    pub fn torque_of_weight_at_hand_nm(&self) -> f64 {
        let situation = self.situation;
        let bears_n = situation.weights_n.get(self.joint).map_or(0.0, |weight| weight.norm());
        bears_n / GRAVITY_M_S2.abs() * situation.torques_per_kg_nm[self.joint]
    }

    pub fn direction(&self) -> f64 {
        self.situation.direction_of(self.joint)
    }

    /// Commanded less encoder angle.
    pub fn lag_rad(&self) -> f64 {
        self.situation.lag_rad(self.joint)
    }

    /// Commanded less encoder angle, without what the servo gave way by under its load.
    pub fn way_left_rad(&self) -> f64 {
        self.lag_rad() - self.situation.given_way_rad(self.joint)
    }

    pub fn t_secs(&self) -> Option<f64> {
        self.situation.row.and_then(|row| row.t_secs)
    }

    pub fn held_s(&self) -> Option<f64> {
        self.situation.row.and_then(|row| row.hold_secs)
    }
}
