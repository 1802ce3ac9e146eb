//! Hides effects in the physics, writes ordinary sessions, keeps the answers apart, and scores who
//! finds them.
//!
//! - [`bench`]: the robot whose arm is simulated, as described.
//! - [`secret`]: what can be hidden.
//! - [`physics`]: what the generators take servos, masses, contact and noise to be.
//! - [`world`], [`stage`]: the physics, touch by touch.
//! - [`design`]: plans of touches.
//! - [`recipe`], [`mix`]: which cases shall be made.
//! - [`case`]: cases drawn by chance, their sessions and their answers.
//! - [`hide`]: what a case of other scenes hides: [`arms`], drawn by chance and measured from outside, and [`eyes`].
//! - [`score`], [`table`], [`names`]: who found what; [`followed`]: where the experiments lead that the search asks for.

pub mod answer;
pub mod arms;
pub mod bench;
pub mod case;
pub mod design;
mod error;
pub mod eyes;
pub mod followed;
mod heat;
pub mod hide;
pub mod measure;
pub mod mix;
pub mod names;
pub mod parallel;
pub mod physics;
pub mod recipe;
pub mod score;
pub mod secret;
pub mod stage;
pub mod table;
pub mod verdict;
pub mod words;
pub mod world;

pub use error::BlindError;
