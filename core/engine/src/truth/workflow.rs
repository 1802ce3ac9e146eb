//! Whether the truth is shown, and what is compared with it.

use std::path::Path;
use std::sync::Arc;

use plumbline_effects::RobotModel;
use plumbline_model::robot::Posture;
use plumbline_model::{Point, Robot};

use super::command::TruthCommand;
use super::compare::rows;
use super::judge::TruthPlug;
use super::view::TruthView;
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::ground::{Context, Moment, Nothing, Workflow};

/// What is compared with the truth: all of it is known without it.
#[derive(Clone, Debug)]
pub struct TruthAround {
    /// Whether the twin runs and is the robot that is connected.
    pub is_twin: bool,
    /// The twin's robot as it is known.
    pub model: Arc<RobotModel>,
    /// Angles by the encoders; `None`: not connected.
    pub measured: Option<Posture>,
    /// The tip that is looked after, and where it is taken to be.
    pub tip: Option<(String, Point<Robot>)>,
    /// What the detector sees.
    pub seen: Vec<Seen>,
}

/// A thing that the detector sees.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// Name of its class.
    pub name: String,
    /// Where it is found.
    pub place: Point<Robot>,
}

/// Truth mode: off at each start.
#[derive(Clone, Debug)]
pub struct TruthWorkflow {
    is_on: bool,
    plug: TruthPlug,
}

impl TruthWorkflow {
    /// What the owner of the twin shows it with.
    pub fn plug(&self) -> TruthPlug {
        self.plug.clone()
    }

    fn compared(&self, around: &TruthAround) -> TruthView {
        let waits = |why: &str| TruthView {
            is_on: true,
            waits_because: Some(why.to_owned()),
            ..TruthView::default()
        };
        if !around.is_twin {
            return waits("No twin is connected: of a real robot nobody knows the truth.");
        }
        let Some(facts) = self.plug.facts() else { return waits("The twin is being asked.") };
        TruthView { is_on: true, waits_because: None, rows: rows(&facts, around).into() }
    }
}

impl Workflow for TruthWorkflow {
    type Command = TruthCommand;
    type Work = Nothing;
    type Control = Nothing;
    type Around = TruthAround;
    type View = TruthView;

    fn new(_: &Path) -> Self {
        Self { is_on: false, plug: TruthPlug::default() }
    }

    fn view(&mut self, around: &TruthAround, _: &Moment) -> Arc<TruthView> {
        Arc::new(if self.is_on { self.compared(around) } else { TruthView::default() })
    }

    fn apply(&mut self, command: TruthCommand, around: &TruthAround, context: &mut Context<'_, Nothing>) {
        let TruthCommand::Show(is_on) = command;
        if is_on && !around.is_twin {
            return context.refuse(
                "Truth mode needs a twin: of a real robot nobody knows the truth. Start the twin first.",
            );
        }
        if is_on != self.is_on {
            let text = if is_on {
                "Truth mode is on: what is shown as true comes from the simulation. Nothing that calibrates, \
                 searches, touches or grasps sees it."
            } else {
                "Truth mode is off."
            };
            context.notices.add(NoticeLevel::Info, text);
        }
        self.is_on = is_on;
        self.plug.want(is_on);
    }

    fn work_done(&mut self, _: JobId, result: Nothing, _: &TruthAround, _: &mut Context<'_, Nothing>) {
        match result {}
    }

    fn work_ended(&mut self, _: JobId, _: Option<&str>, _: &TruthAround, _: &mut Context<'_, Nothing>) {}
}
