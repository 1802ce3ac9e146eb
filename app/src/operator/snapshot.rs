//! What the engine's snapshots are made of that other packages define: all that window, panels and
//! command line know of those packages.

/// Of correction models, and of the tables of grasp height and yaw.
pub mod models {
    pub use plumbline_engine::correction::tables::{HeightTable, YawTable};
    pub use plumbline_engine::correction::{
        Comparison, CorrectionModel, Errors, LossPoint, Method, Recipe, Repeats, TouchData, spread_of_repeats,
    };
}

/// Of a plan of touches: what it would tell.
pub mod touch {
    pub use plumbline_engine::effects::observability::{EffectVisibility, PlanScore};
}

/// Of the experiment with grasps.
pub mod trials {
    pub use plumbline_engine::report::experiment::{
        Experiment as Page, Method as PageMethod, Position as PagePosition, TABLE as HEADINGS,
    };
}

/// Of the gap between model and measurement.
pub mod gap {
    pub use plumbline_engine::effects::measurements::{Unit, What};
    pub use plumbline_engine::gap::finding::{
        Candidate, Comparison, CoordinateComparison, Experiment, Finding, Knowledge, NamedEffect,
        NextExperiment, Residual, Shown, ShownUnit, Unexplained,
    };
    pub use plumbline_engine::gap::{Verdict, plan_for};
}
