//! What the engine's snapshots are made of that other packages define: all that window, panels and
//! command line know of those packages.

/// Of correction models, and of the tables of grasp height and yaw.
pub mod models {
    pub use plumbline_engine::models::{
        Comparison, CorrectionModel, Errors, FEWEST_FOR_A_NETWORK, HeightTable, LossPoint, Method, Recipe,
        Repeats, TouchData, YawTable, spread_of_repeats,
    };
}

/// Of a plan of touches: what it would tell.
pub mod touch {
    pub use plumbline_engine::touch::{EffectVisibility, PlanScore};
}

/// Of the experiment with grasps.
pub mod trials {
    pub use plumbline_engine::trials::{HEADINGS, Page, PageMethod, PagePosition};
}

/// Of pages for a colleague: one tile of the window.
pub mod page {
    pub use plumbline_engine::timeline::{PagePicture, TilePage, tile_pdf};
}

/// Of the gap between model and measurement.
pub mod gap {
    pub use plumbline_engine::gap::{
        Candidate, Comparison, CoordinateComparison, Experiment, Finding, Knowledge, NamedEffect,
        NextExperiment, Residual, Shown, ShownUnit, Unexplained, Unit, Verdict, What, plan_for, titles,
    };

    #[cfg(test)]
    pub use plumbline_engine::gap::sample;
}
