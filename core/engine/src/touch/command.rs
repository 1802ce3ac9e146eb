//! Commands of touching the screen, of correction models, and of the tables of grasp height and
//! yaw.

use std::path::PathBuf;

use plumbline_correction::Method;
use plumbline_model::touch_plan::PlanOptions;
use serde::{Deserialize, Serialize};

/// What corrects targets before they are sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum Correction {
    /// A model that was trained from touches.
    Model(Method),
    /// The effects that were found, named and added to the model in use: inverse kinematics with them,
    /// no network.
    Effects,
}

impl Correction {
    /// As it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Model(method) => method.name(),
            Self::Effects => "effects",
        }
    }

    /// The one of this name, in small letters or large ones.
    pub fn of_name(name: &str) -> Option<Self> {
        let models = Method::ALL.map(Self::Model);
        models.into_iter().chain([Self::Effects]).find(|known| known.name().eq_ignore_ascii_case(name))
    }
}

impl From<Method> for Correction {
    fn from(method: Method) -> Self {
        Self::Model(method)
    }
}

impl From<Correction> for String {
    fn from(correction: Correction) -> Self {
        correction.name().to_lowercase()
    }
}

impl TryFrom<String> for Correction {
    type Error = UnknownCorrection;

    fn try_from(name: String) -> Result<Self, UnknownCorrection> {
        Self::of_name(&name).ok_or(UnknownCorrection(name))
    }
}

/// A name of nothing that corrects.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("\"{0}\" corrects nothing: m1, m2, m3 or effects do")]
pub struct UnknownCorrection(pub String);

/// Touching the screen, in the order of work.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TouchCommand {
    /// Plans touches and looks which of them can be reached. Moves nothing.
    Plan(PlanOptions),
    /// With what targets are corrected before they are sent; `None`: with nothing. Plans anew.
    CorrectWith(Option<Correction>),
    /// Starts the planned run in a new session. The arm moves.
    Start,
    /// Holds after the touch that is under way.
    Pause,
    /// Goes on with a paused or unfinished run, exactly where it was. The arm moves.
    Resume,
    /// Leaves the touch out that is under way or next.
    Skip,
    /// Touches a target once more at the end; its earlier touch is kept but does not count.
    Redo {
        /// Number of the planned touch, from 1.
        number: usize,
    },
    /// Does not count a touch.
    Reject {
        /// Number of the planned touch.
        number: usize,
    },
    /// Counts a rejected touch again.
    Restore {
        /// Number of the planned touch.
        number: usize,
    },
    /// Ends the run with what there is; the session stays.
    Finish,
    /// Says that the screen stands on a block and what the hand carries, as the plan asks.
    Prepared {
        /// Height of the block under the screen, m.
        screen_height_m: f64,
        /// Known mass at the palm, kg.
        payload_kg: f64,
    },
    /// Opens a run that was begun earlier, finished or not.
    Open {
        /// Its session folder.
        session: PathBuf,
    },
    /// Forgets the plan and shows no session.
    Close,
    /// Makes the proposed place of the screen the one in use.
    AcceptPlacement,
    /// Forgets the proposed place of the screen.
    DiscardPlacement,
    /// Puts a place of the screen that was in use earlier in use again.
    UseEarlierPlacement {
        /// Its id on the timeline.
        id: String,
    },
    /// Goes back to the place in the rig file.
    UseNominalPlacement,
    /// The touch window was touched, or clicked with the mouse.
    Contact(ScreenContact),
    /// The touch window has opened, was resized, or is gone (`None`).
    Window(Option<ScreenWindow>),
}

/// A contact that the touch window felt.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScreenContact {
    /// Column, px of the screen.
    pub u_px: f64,
    /// Row, px of the screen.
    pub v_px: f64,
    /// Time between the contact and this command, s.
    pub age_s: f64,
    /// With what.
    pub with: ContactWith,
    /// Whether it begins (`true`) or ends.
    pub down: bool,
}

/// What touched the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ContactWith {
    /// A finger or a pen.
    Touch,
    /// The mouse, for trying it out.
    Mouse,
}

/// The touch window as the window system has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScreenWindow {
    /// Physical pixels across.
    pub width_px: u32,
    /// Physical pixels down.
    pub height_px: u32,
    /// Whether it fills its monitor.
    pub full_screen: bool,
}
