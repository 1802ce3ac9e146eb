//! One joint in one line: where it is, where it should go, what it may, how it feels.
//!
//! Nothing here moves anything: a row gives back what the operator proposes.

mod bar;
mod cells;
mod field;
mod layout;

pub use layout::{ROW_HEIGHT, joint_header};

use std::time::Duration;

use egui::{Response, Sense, Ui, vec2};

use crate::format::{self, Quantity};
use crate::history::{History, Sparkline};
use crate::theme::{self, Role, space};
use layout::Columns;

/// From here on a servo is too warm, in °C.
pub const WARM_C: f64 = 55.0;
/// From here on a servo is in danger, in °C.
pub const HOT_C: f64 = 70.0;
/// From here on a load is high, as a fraction of the largest.
pub const HIGH_LOAD: f64 = 0.8;

const SPARKLINE_HEIGHT: f32 = 34.0;

/// What is known of a joint right now. `None` where it is not known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointState {
    /// Measured angle of the joint, radians.
    pub present_rad: Option<f64>,
    /// Angle that the servo was told to go to.
    pub goal_rad: Option<f64>,
    /// Angle that the operator has proposed and not sent yet.
    pub proposed_rad: Option<f64>,
    /// Fraction of the largest load, −1 to 1; positive turns the joint forward.
    pub load: Option<f64>,
    /// Of the servo, °C.
    pub temperature_c: Option<f64>,
    /// Whether the servo holds its place.
    pub torque_on: Option<bool>,
}

/// How new the state is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Freshness<'a> {
    /// From the last cycle.
    Live,
    /// Nothing newer for so long.
    Stale(Option<Duration>),
    /// Does not answer.
    NoAnswer {
        /// Who: "servo 31".
        from: &'a str,
        /// For how long; `None` if it never did.
        since: Option<Duration>,
    },
}

/// Less than the limits, because of another joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReducedRange<'a> {
    /// Lower and upper angle that are allowed now, radians.
    pub range_rad: [f64; 2],
    /// Why, in a few words: "the head is turned by 40°".
    pub reason: &'a str,
}

/// What the row of a joint shows when it is hovered or open.
#[derive(Clone, Debug, PartialEq)]
pub struct JointHistory {
    /// Fractions of the largest load.
    pub load: History,
    /// °C.
    pub temperature_c: History,
}

impl JointHistory {
    /// Keeps so many seconds.
    pub fn new(span_s: f64) -> Self {
        Self { load: History::new(span_s), temperature_c: History::new(span_s) }
    }

    /// Adds what was measured at a time.
    pub fn push(&mut self, at_s: f64, state: &JointState) {
        self.load.push(at_s, state.load);
        self.temperature_c.push(at_s, state.temperature_c);
    }
}

/// The row of a joint.
pub struct JointRow<'a> {
    name: &'a str,
    id: &'a str,
    limits_rad: [f64; 2],
    reduced: Option<ReducedRange<'a>>,
    state: JointState,
    freshness: Freshness<'a>,
    history: Option<&'a JointHistory>,
    expanded: bool,
}

/// What the operator did to a row.
#[derive(Clone, Debug)]
pub struct JointRowResponse {
    /// The row.
    pub response: Response,
    /// A new angle, radians, inside the limits.
    pub proposed_rad: Option<f64>,
    /// What was typed cannot be: why, as shown below the row.
    pub refused: Option<String>,
    /// Asked to hold (`true`) or to let go.
    pub torque: Option<bool>,
    /// The name was pressed: open or close the row.
    pub expand_toggled: bool,
}

impl<'a> JointRow<'a> {
    /// A row for a joint in plain words ("right elbow") with its id ("r_elbow_y"). Limits are
    /// lower and upper, in radians of the joint.
    pub fn new(name: &'a str, id: &'a str, limits_rad: [f64; 2], state: JointState) -> Self {
        Self {
            name,
            id,
            limits_rad,
            reduced: None,
            state,
            freshness: Freshness::Live,
            history: None,
            expanded: false,
        }
    }

    /// A range that another joint leaves; the rest is hatched.
    pub fn reduced(mut self, reduced: Option<ReducedRange<'a>>) -> Self {
        self.reduced = reduced;
        self
    }

    /// How new the state is.
    pub fn freshness(mut self, freshness: Freshness<'a>) -> Self {
        self.freshness = freshness;
        self
    }

    /// The last minute of load and temperature, shown on hover and in an open row.
    pub fn history(mut self, history: &'a JointHistory) -> Self {
        self.history = Some(history);
        self
    }

    /// Whether the row is open.
    pub fn expanded(mut self, expanded: bool) -> Self {
        self.expanded = expanded;
        self
    }

    /// Draws it over the available width. Labels for tests: `"{name} goal"` is the slider,
    /// `"{name} goal in degrees"` the number, `"{name} torque"` the switch, `"{name}"` opens.
    pub fn show(self, ui: &mut Ui) -> JointRowResponse {
        let size = vec2(ui.available_width(), ROW_HEIGHT);
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        let columns = Columns::of(rect);
        let base = ui.scope_id().with(("joint", self.id));
        if response.contains_pointer() {
            ui.painter().rect_filled(rect, 3.0, theme::tokens(ui).raised.gamma_multiply(0.35));
        }
        let expand_toggled = cells::name(&self, ui, columns.name, base);
        let dragged = match self.no_answer() {
            Some(sentence) => {
                cells::no_answer(ui, columns.bar_to_goal(), &sentence);
                None
            }
            None => bar::show(&self, ui, columns.bar, base),
        };
        let mut typed = None;
        let mut refused = None;
        if self.no_answer().is_none() {
            cells::present(&self, ui, columns.present);
            typed = field::show(&self, ui, columns.goal, base);
        }
        if let Some(rect) = columns.load {
            cells::load(&self, ui, rect, base);
        }
        cells::temperature(&self, ui, columns.temperature, base);
        let torque = cells::torque(&self, ui, columns.torque, base);
        let mut proposed_rad = dragged;
        match typed {
            Some(Ok(angle_rad)) => proposed_rad = Some(angle_rad),
            Some(Err(reason)) => refused = Some(reason),
            None => {}
        }
        // A refusal stays until something valid is asked for.
        let shown = field::refusal(ui, base, proposed_rad.is_some(), refused.clone());
        if let Some(reason) = shown {
            cells::refusal(ui, &columns, &reason);
        }
        if self.expanded {
            self.details(ui, &columns);
        }
        JointRowResponse { response, proposed_rad, refused, torque, expand_toggled }
    }

    fn no_answer(&self) -> Option<String> {
        match self.freshness {
            Freshness::NoAnswer { from, since: Some(since) } => {
                Some(format!("no answer from {from} for {} s", since.as_secs()))
            }
            Freshness::NoAnswer { from, since: None } => Some(format!("{from} never answered")),
            Freshness::Live | Freshness::Stale(_) => None,
        }
    }

    fn is_old(&self) -> bool {
        self.freshness != Freshness::Live
    }

    fn is_beyond_limits(&self) -> bool {
        match (self.limits(), self.state.present_rad) {
            (Some([low, high]), Some(present)) => !(low..=high).contains(&present),
            _ => false,
        }
    }

    /// The limits, where they are two different numbers in order.
    fn limits(&self) -> Option<[f64; 2]> {
        let [low, high] = self.limits_rad;
        (low.is_finite() && high.is_finite() && low < high).then_some([low, high])
    }

    /// What may be proposed: the limits, or what another joint leaves of them.
    fn allowed(&self) -> Option<[f64; 2]> {
        let [low, high] = self.limits()?;
        let [low, high] = match self.reduced {
            Some(ReducedRange { range_rad: [from, to], .. }) => [low.max(from), high.min(to)],
            None => [low, high],
        };
        (low <= high).then_some([low, high])
    }

    /// The angle as a proposal, or why it cannot be one.
    fn check(&self, angle_rad: f64) -> Result<f64, String> {
        let text = format::joint_degrees(angle_rad);
        let Some([low, high]) = self.limits() else {
            return Err(format!("no limits are known for {}; check the rig file", self.name));
        };
        // A limit that was typed as it is written must count as inside.
        let slack = 0.05f64.to_radians();
        let span = |[low, high]: [f64; 2]| {
            format!("{} to {}", format::joint_degrees(low), format::joint_degrees(high))
        };
        if !(low - slack..=high + slack).contains(&angle_rad) {
            return Err(format!(
                "{text} is beyond the limits: {} goes from {}",
                self.name,
                span([low, high])
            ));
        }
        match (self.allowed(), self.reduced) {
            (Some(allowed), _) if (allowed[0] - slack..=allowed[1] + slack).contains(&angle_rad) => {
                Ok(angle_rad.clamp(allowed[0], allowed[1]))
            }
            (Some(allowed), Some(reduced)) => {
                Err(format!("{text} cannot be while {}: now {}", reduced.reason, span(allowed)))
            }
            (_, Some(reduced)) => Err(format!("{} cannot move while {}", self.name, reduced.reason)),
            (_, None) => Err(format!("no limits are known for {}; check the rig file", self.name)),
        }
    }

    fn details(&self, ui: &mut Ui, columns: &Columns) {
        ui.horizontal(|ui| {
            ui.add_space(space::M);
            ui.spacing_mut().item_spacing.x = space::M;
            match self.history {
                Some(history) => {
                    let width = ((columns.width() - 4.0 * space::M) / 2.0).clamp(80.0, 320.0);
                    self.sparklines(ui, history, width);
                }
                None => {
                    ui.label(theme::small(ui, "No history is kept of this joint."));
                }
            }
        });
        ui.add_space(space::XS);
    }

    fn sparklines(&self, ui: &mut Ui, history: &JointHistory, width: f32) {
        load_line(history, vec2(width, SPARKLINE_HEIGHT)).show(ui);
        temperature_line(history, vec2(width, SPARKLINE_HEIGHT)).show(ui);
    }
}

fn load_line(history: &JointHistory, size: egui::Vec2) -> Sparkline<'_> {
    const LEVELS: [(f64, Role); 2] = [(HIGH_LOAD, Role::Warning), (-HIGH_LOAD, Role::Warning)];
    Sparkline::new("load", &history.load, Quantity::Ratio).range([-1.0, 1.0]).levels(&LEVELS).size(size)
}

fn temperature_line(history: &JointHistory, size: egui::Vec2) -> Sparkline<'_> {
    const LEVELS: [(f64, Role); 2] = [(WARM_C, Role::Warning), (HOT_C, Role::Danger)];
    Sparkline::new("temperature", &history.temperature_c, Quantity::Temperature)
        .range([20.0, 75.0])
        .levels(&LEVELS)
        .size(size)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn elbow() -> JointRow<'static> {
        JointRow::new(
            "right elbow",
            "r_elbow_y",
            [50f64.to_radians(), 180f64.to_radians()],
            JointState::default(),
        )
    }

    #[test]
    fn limits_hold_and_say_what_they_are() {
        assert_eq!(elbow().check(1.0), Ok(1.0));
        let reason = elbow().check(10f64.to_radians()).expect_err("below the limit");
        assert_eq!(reason, "10.0° is beyond the limits: right elbow goes from 50.0° to 180.0°");
        assert!(elbow().check(f64::NAN).is_err());
    }

    #[test]
    fn a_limit_typed_as_it_is_written_is_inside() {
        let row = JointRow::new("x", "x", [-0.7, 0.52], JointState::default());
        assert_eq!(row.check(29.8f64.to_radians()), Ok(0.52), "29.79° is written as 29.8°");
        assert_eq!(row.check(-40.1f64.to_radians()), Ok(-40.1f64.to_radians()));
        assert!(row.check(30f64.to_radians()).is_err());
    }

    #[test]
    fn a_reduced_range_refuses_with_its_reason() {
        let reduced = ReducedRange { range_rad: [1.0, 2.0], reason: "the head is turned by 40°" };
        let row = || elbow().reduced(Some(reduced));
        let reason = row().check(2.5).expect_err("outside of what is left");
        assert!(
            reason.contains("while the head is turned by 40°") && reason.contains("57.3° to 114.6°"),
            "{reason}"
        );
        let nothing = ReducedRange { range_rad: [5.0, 6.0], reason: "the arm is down" };
        assert!(elbow().reduced(Some(nothing)).check(1.5).is_err());
        assert!(JointRow::new("x", "x", [f64::NAN, 1.0], JointState::default()).check(0.0).is_err());
    }
}
