//! Grasps: from a pair of images to a lifted object, by the published methods and by ours.
//!
//! Nothing here knows whether a robot or a twin moves: a [`Body`] carries out what is asked.

mod arm;
pub mod attempt;
pub mod body;
pub mod hand;
mod hands;
mod held;
mod knowledge;
pub mod method;
pub mod outline;
mod places;
pub mod plan;
pub mod published;
pub mod record;
pub mod see;
pub mod stands;
mod table;
pub mod things;
pub mod tracks;

pub use arm::{NoArm, PalmArm};
pub use attempt::{Grasper, Order, Watch};
pub use body::{Body, Halt, ServoState, Sight};
pub use hands::{Hand, HandChoice};
pub use held::{Grip, HoldWatch};
pub use knowledge::{Corrections, Knowledge};
pub use method::{Method, PublishedWithRight};
pub use places::PLACES_M;
pub use record::{Failure, Outcome, Record, Step};
