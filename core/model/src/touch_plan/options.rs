//! What the operator chooses.

use serde::{Deserialize, Serialize};

use super::{PlanError, Side};
use crate::pixel::Pixel;
use crate::session::{Screen, Touchscreen};

/// A rectangle of the screen, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TouchArea {
    /// First and last column.
    pub u_px: [f64; 2],
    /// First and last row.
    pub v_px: [f64; 2],
}

impl TouchArea {
    /// The whole screen but a border of `margin_m` meters, where panels err and fingers slip off.
    pub fn within(screen: &Touchscreen, margin_m: f64) -> Self {
        let [u_m, v_m] = screen.pitch_m();
        let inner = |count: u32, pitch_m: f64| {
            [margin_m / pitch_m - 0.5, f64::from(count) - 0.5 - margin_m / pitch_m]
        };
        Self { u_px: inner(screen.width_px, u_m), v_px: inner(screen.height_px, v_m) }
    }

    /// Whether a pixel lies in it, borders included.
    pub fn contains(&self, pixel: Pixel<Screen>) -> bool {
        let on = |at: f64, range: [f64; 2]| at >= range[0] && at <= range[1];
        on(pixel.u_px, self.u_px) && on(pixel.v_px, self.v_px)
    }

    /// The pixel at fractions (0–1) of its width and height.
    pub fn at(&self, across: f64, down: f64) -> Pixel<Screen> {
        let part = |range: [f64; 2], fraction: f64| range[0] + fraction * (range[1] - range[0]);
        Pixel::new(part(self.u_px, across), part(self.v_px, down))
    }

    /// Its corners: top left, top right, bottom right, bottom left.
    pub fn corners(&self) -> [Pixel<Screen>; 4] {
        [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(across, down)| self.at(across, down))
    }
}

/// Where targets lie in the area.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pattern {
    /// Evenly spaced, borders of the area included; a single column or row lies in the middle.
    Grid {
        /// Targets across.
        columns: usize,
        /// Targets down.
        rows: usize,
    },
    /// Evenly spaced lines with evenly spaced targets.
    Lines {
        /// Number of lines across.
        horizontal: usize,
        /// Number of lines down.
        vertical: usize,
        /// Number of diagonals, at most 2: from the top left, from the top right.
        diagonal: usize,
        /// Targets on each line, at least 2.
        points: usize,
    },
    /// Anywhere in the area, evenly likely.
    Random {
        /// Number of targets.
        count: usize,
    },
    /// The corners of the area.
    Corners,
    /// Some targets of the other patterns once more and again, far from each other.
    Again {
        /// How many targets.
        targets: usize,
        /// How often more.
        times: usize,
    },
    /// Where touches tell most of where the palm will be, from the sides and with the hand held as tells
    /// most. They are chosen with the arm itself, not by [`super::TouchPlan::make`], and alone.
    Telling {
        /// Number of places.
        places: usize,
        /// How many of them are touched twice.
        again: usize,
    },
}

/// From where the fingertip arrives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sides {
    /// Straight from above.
    Above,
    /// Every target once from the robot's left and once from its right.
    LeftAndRight,
}

impl Sides {
    /// The single sides.
    pub fn all(self) -> &'static [Side] {
        match self {
            Self::Above => &[Side::Above],
            Self::LeftAndRight => &[Side::Left, Side::Right],
        }
    }
}

/// The finger that touches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Finger {
    /// The right index finger.
    #[default]
    Right,
    /// The left index finger.
    Left,
}

impl Finger {
    /// Both.
    pub const BOTH: [Self; 2] = [Self::Right, Self::Left];

    /// Its tip in the robot's description.
    pub fn tip(self) -> &'static str {
        match self {
            Self::Right => "right_index_tip",
            Self::Left => "left_index_tip",
        }
    }

    fn is_right(&self) -> bool {
        *self == Self::Right
    }
}

/// What the touches are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Purpose {
    /// To train correction models.
    Train,
    /// To measure where the screen lies.
    PlaceScreen,
    /// To see how well a model reaches new targets.
    Check,
}

/// What a plan is made from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanOptions {
    /// The part of the screen to be touched.
    pub area: TouchArea,
    /// Where targets lie. A place that several patterns contain is one target with repeats.
    pub patterns: Vec<Pattern>,
    /// How often every target is touched, per side, height and weight; at least 1.
    pub repeats: usize,
    /// From where the fingertip arrives.
    pub sides: Sides,
    /// Heights of the block under the screen, m; 0 is the screen as it lies.
    pub screen_heights_m: Vec<f64>,
    /// Known masses at the palm, kg; 0 is the bare hand.
    pub payloads_kg: Vec<f64>,
    /// Where random targets lie.
    pub seed: u64,
    /// What the touches are for.
    pub purpose: Purpose,
    /// What touches.
    #[serde(default, skip_serializing_if = "Finger::is_right")]
    pub finger: Finger,
    /// Every touch is made twice: by the robot as it is described, then as its targets are corrected.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub beside_described: bool,
}

impl PlanOptions {
    /// Number of places where touches tell most, and how many of them are touched twice; `None`: targets lie
    /// where patterns have them.
    pub fn telling(&self) -> Option<(usize, usize)> {
        self.patterns.iter().find_map(|pattern| match *pattern {
            Pattern::Telling { places, again } => Some((places, again)),
            _ => None,
        })
    }

    /// Looks whether a plan can be made from them.
    ///
    /// # Errors
    /// What is wrong with them, and what to do.
    pub fn check(&self, screen: &Touchscreen) -> Result<(), PlanError> {
        let area = &self.area;
        if !(area.u_px[0] < area.u_px[1] && area.v_px[0] < area.v_px[1]) {
            return Err(PlanError::AreaEmpty);
        }
        if !area.corners().into_iter().all(|corner| screen.contains(corner)) {
            return Err(PlanError::AreaOffScreen { width_px: screen.width_px, height_px: screen.height_px });
        }
        if self.patterns.is_empty() {
            return Err(PlanError::NoPattern);
        }
        if self.patterns.iter().all(|pattern| matches!(pattern, Pattern::Again { .. })) {
            return Err(PlanError::NothingToRepeat);
        }
        for pattern in &self.patterns {
            if let Some((pattern, least)) = pattern.lack() {
                return Err(PlanError::EmptyPattern { pattern, least });
            }
            // Before anything of that size is made.
            let count = pattern.size();
            if count > super::MOST_TOUCHES {
                return Err(PlanError::TooMany { count, most: super::MOST_TOUCHES });
            }
        }
        if self.telling().is_some() {
            let as_it_lies = self.screen_heights_m == [0.0] && self.payloads_kg == [0.0];
            if self.patterns.len() > 1 || !as_it_lies || self.beside_described {
                return Err(PlanError::TellingAlone);
            }
        }
        if self.repeats == 0 {
            return Err(PlanError::NoRepeats);
        }
        if self.repeats > super::MOST_TOUCHES {
            return Err(PlanError::TooMany { count: self.repeats, most: super::MOST_TOUCHES });
        }
        conditions(
            "screen heights",
            &self.screen_heights_m,
            "give heights in meters, 0 for the screen as it lies",
        )?;
        conditions("weights", &self.payloads_kg, "give masses in kilograms, 0 for the bare hand")
    }
}

impl Pattern {
    /// Name and least size, when it has no target.
    fn lack(&self) -> Option<(&'static str, &'static str)> {
        match *self {
            Self::Grid { columns, rows } => {
                (columns == 0 || rows == 0).then_some(("grid", "one column and one row"))
            }
            Self::Lines { horizontal, vertical, diagonal, points } => {
                let without = points < 2 || horizontal.saturating_add(vertical).saturating_add(diagonal) == 0;
                (without || diagonal > 2)
                    .then_some(("pattern of lines", "one line (two diagonals at most) of two targets"))
            }
            Self::Random { count } => (count == 0).then_some(("random pattern", "one target")),
            Self::Corners => None,
            Self::Again { targets, times } => {
                (targets == 0 || times == 0).then_some(("pattern of repeats", "one target, once more"))
            }
            Self::Telling { places, .. } => {
                (places == 0).then_some(("choice of what tells most", "one place"))
            }
        }
    }

    /// Number of touches, when every target is touched once.
    fn size(&self) -> usize {
        match *self {
            Self::Grid { columns, rows } => columns.saturating_mul(rows),
            Self::Lines { horizontal, vertical, diagonal, points } => {
                horizontal.saturating_add(vertical).saturating_add(diagonal).saturating_mul(points)
            }
            Self::Random { count } => count,
            Self::Corners => 4,
            Self::Again { targets, times } => targets.saturating_mul(times),
            Self::Telling { places, again } => places.saturating_add(again),
        }
    }
}

/// A list of heights or weights must name each once, none negative.
fn conditions(what: &'static str, values: &[f64], advice: &'static str) -> Result<(), PlanError> {
    let problem = |problem: String| Err(PlanError::Conditions { what, problem, advice });
    if values.is_empty() {
        return problem("is empty".to_owned());
    }
    for (i, value) in values.iter().enumerate() {
        if !(value.is_finite() && *value >= 0.0) {
            return problem(format!("holds {value}"));
        }
        if values[..i].contains(value) {
            return problem(format!("holds {value} twice"));
        }
    }
    Ok(())
}
