//! Inverse kinematics: the joint angles that bring a tip to a target, or an honest answer why
//! none do.
//!
//! ```
//! use plumbline_model::robot::{Rig, ik::{Answer, Options, Solver, Target}};
//! use plumbline_model::Point;
//!
//! let rig = Rig::built_in("nico")?;
//! let solver = Solver::of_rig(&rig, "right_palm_center")?;
//! let target = Target::Position(Point::new(0.35, -0.15, 0.2));
//! let answer = solver.solve_from(&target, &rig.home(), &Options::default())?;
//! assert!(matches!(answer, Answer::Reached(_)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod descent;
mod explain;
mod kernel;
mod seeds;
mod solver;
mod target;
mod task;
#[cfg(test)]
mod tests;

pub use kernel::MAX_JOINTS;
pub use solver::{Solver, SolverError};
pub use target::{Answer, ChainAngles, IkError, Options, Solution, Target};
