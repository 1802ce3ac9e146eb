//! What is learned from: pairs of touched pixel and point sent.

use std::collections::BTreeMap;

use nalgebra::{Matrix2, Vector2};
use plumbline_model::decompose;
use plumbline_model::robot::Chain;
use plumbline_model::session::{Screen, Session, TouchRow, TouchTable, Touchscreen};
use plumbline_model::{Pixel, Point, Robot};

/// Fewest touches that anything can be learned from: a placement and a height need them.
pub const FEWEST_TOUCHES: usize = 4;
/// Touches whose spread across is smaller than this part of the spread along count as a line.
const LINE_RATIO: f64 = 0.05;
/// Points sent may lie farther out than the arm reaches: the real arm may be longer, and corrections
/// are small against this.
const REACH_MARGIN: f64 = 1.25;

/// A touch to learn from.
#[derive(Clone, Debug, PartialEq)]
pub struct Touch {
    /// The pixel that was touched.
    pub pixel: Pixel<Screen>,
    /// The point that the simulated robot had been sent to.
    pub sent: Point<Robot>,
    /// Label that blocks cross-validation: a line, a grid, a day.
    pub set: Option<String>,
    /// Touches of one group repeat the same command from the same side.
    pub group: Option<String>,
    /// Row of the session's table, counted from 0.
    pub row: usize,
}

/// Touches of one session that can be learned from.
#[derive(Clone, Debug)]
pub struct TouchData {
    /// The touches.
    pub touches: Vec<Touch>,
    /// The screen, where the session says it lies.
    pub screen: Touchscreen,
    /// What was left out and why, a sentence each.
    pub left_out: Vec<String>,
}

/// Why nothing can be learned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DataError {
    /// The session has no touches.
    #[error("the session has no touches: choose one that was recorded with the touchscreen")]
    NoTouches,
    /// The session does not describe its touchscreen.
    #[error(
        "the session does not say which touchscreen was touched: add [touchscreen] to its session.toml (size in pixels and meters, origin, axes)"
    )]
    NoScreen,
    /// The touchscreen has no area.
    #[error(
        "the touchscreen of the session has no area ({width_px} × {height_px} px, {width_m} × {height_m} m): correct its size in session.toml"
    )]
    ScreenWithoutArea {
        /// Pixels across.
        width_px: u32,
        /// Pixels down.
        height_px: u32,
        /// Visible width, m.
        width_m: f64,
        /// Visible height, m.
        height_m: f64,
    },
    /// A number that is none.
    #[error("{what} of row {row} is not a finite number: correct or delete the row in touches.csv")]
    NotFinite {
        /// Which number.
        what: &'static str,
        /// Row of the table, counted from 1 without its header.
        row: usize,
    },
    /// Not enough touches are left.
    #[error(
        "{found} of the session's touches can be learned from, at least {needed} are needed: touch more places, or look at what was left out{}", listed(.left_out)
    )]
    TooFew {
        /// Touches that are usable.
        found: usize,
        /// Touches that are needed.
        needed: usize,
        /// Why the others were left out.
        left_out: Vec<String>,
    },
    /// Points sent that the arm cannot be sent to.
    #[error(
        "the points sent of {count} of the {rows} touches lie up to {farthest_m:.2} m from the robot, whose arm reaches {reach_m:.2} m: the columns target_x_m, target_y_m, target_z_m of touches.csv are in another unit, or of another robot; correct them"
    )]
    BeyondReach {
        /// How many.
        count: usize,
        /// All rows.
        rows: usize,
        /// The farthest, m.
        farthest_m: f64,
        /// Reach of the arm, m.
        reach_m: f64,
    },
    /// All touches lie on a line.
    #[error(
        "all {found} touches lie on a line (spread across it {:.1} mm, along it {:.0} mm): touch places to both sides of it",
        1e3 * .across_m, 1e3 * .along_m
    )]
    OnALine {
        /// Number of touches.
        found: usize,
        /// Standard deviation along the line, m.
        along_m: f64,
        /// Standard deviation across the line, m.
        across_m: f64,
    },
    /// The chain is another one than the session's.
    #[error(
        "the session logged no commanded angle of joint {joint}, which the chain to {tip} needs: choose the rig that the session was recorded with"
    )]
    OtherChain {
        /// Joint that is not in the session.
        joint: String,
        /// Tip of the chain that was given.
        tip: String,
    },
}

fn listed(left_out: &[String]) -> String {
    if left_out.is_empty() { String::new() } else { format!(" ({})", left_out.join("; ")) }
}

impl TouchData {
    /// The touches of a session. Where the point that was sent was not logged it is computed
    /// from the commanded angles with `chain`, the chain to the session's tip. Encoder angles
    /// are not used.
    ///
    /// Only rows of the commonest height of the screen and the commonest payload are taken: a
    /// model speaks of one arm and one screen.
    ///
    /// # Errors
    /// When there is nothing to learn from: which, and what to do.
    pub fn of_session(session: &Session, chain: &Chain) -> Result<Self, DataError> {
        let table = session.touches.as_ref().filter(|table| table.row_count() > 0);
        let table = table.ok_or(DataError::NoTouches)?;
        let screen = session.manifest.touchscreen.clone().ok_or(DataError::NoScreen)?;
        check_screen(&screen)?;
        let reader = RowReader { chain, order: joint_order(table, chain), screen: &screen };
        let mut gathered = Gathered::default();
        let rows: Vec<TouchRow> = table.rows().collect();
        let same_height = commonest(rows.iter().map(|row| row.screen_height_m));
        let same_payload = commonest(rows.iter().map(|row| row.payload_kg));
        let reach_m = REACH_MARGIN * chain.farthest_m();
        let beyond = |row: &TouchRow| row.target.map(|sent| sent.range_m()).filter(|m| *m > reach_m);
        let farthest_m = rows.iter().filter_map(beyond).fold(0.0, f64::max);
        let count = rows.iter().filter(|row| beyond(row).is_some()).count();
        if count == rows.len() || (count > 1 && 4 * count > rows.len()) {
            let (rows, reach_m) = (rows.len(), chain.farthest_m());
            return Err(DataError::BeyondReach { count, rows, farthest_m, reach_m });
        }
        for (index, row) in rows.iter().enumerate() {
            if let Some(what) = table.implausible().get(&index) {
                gathered.leave_out_because(format!("holds what cannot be ({what})"));
            } else if beyond(row).is_some() {
                gathered.leave_out("was sent to a point that the arm cannot reach");
            } else if bits(row.screen_height_m) != same_height {
                gathered.leave_out("stood at another height of the screen than most");
            } else if bits(row.payload_kg) != same_payload {
                gathered.leave_out("carried another payload than most");
            } else if rows[..index].contains(row) {
                gathered.leave_out("repeated an earlier row exactly, every number of it");
            } else {
                match reader.touch(row, index)? {
                    Ok(touch) => gathered.touches.push(touch),
                    Err(reason) => gathered.leave_out(reason),
                }
            }
        }
        let left_out = gathered.sentences();
        Self::new(gathered.touches, screen, left_out)
    }

    /// Touches that were gathered elsewhere, checked.
    ///
    /// # Errors
    /// As [`Self::of_session`].
    pub fn new(touches: Vec<Touch>, screen: Touchscreen, left_out: Vec<String>) -> Result<Self, DataError> {
        check_screen(&screen)?;
        for touch in &touches {
            finite(&touch.pixel.vector().data.0[0], "the touched pixel", touch.row)?;
            finite(&touch.sent.coords.coords.data.0[0], "the point sent", touch.row)?;
        }
        if touches.len() < FEWEST_TOUCHES {
            return Err(DataError::TooFew { found: touches.len(), needed: FEWEST_TOUCHES, left_out });
        }
        // A line that was commanded can be touched as a crooked one: neither may be a line.
        let pitch_m = pixel_pitch_m(&screen);
        let touched = touches.iter().map(|touch| touch.pixel.vector().component_mul(&pitch_m));
        let sent = touches.iter().map(|touch| touch.sent.coords.coords.xy());
        for (along_m, across_m) in [spread_m(touched), spread_m(sent)] {
            if across_m <= LINE_RATIO * along_m {
                return Err(DataError::OnALine { found: touches.len(), along_m, across_m });
            }
        }
        Ok(Self { touches, screen, left_out })
    }

    /// Number of touches.
    pub fn len(&self) -> usize {
        self.touches.len()
    }

    /// Whether there is none; never so after [`Self::of_session`].
    pub fn is_empty(&self) -> bool {
        self.touches.is_empty()
    }

    /// The touches with these indices. Nothing is checked again.
    pub fn subset(&self, indices: &[usize]) -> Self {
        Self {
            touches: indices.iter().map(|index| self.touches[*index].clone()).collect(),
            screen: self.screen.clone(),
            left_out: vec![],
        }
    }

    /// Errors of targets that are sent as they are: where each pixel lies on the screen, less the point that was
    /// sent, m.
    pub fn sent_as_they_are_m(&self) -> Vec<[f64; 3]> {
        let error = |touch: &Touch| (self.screen.point_at(touch.pixel).coords - touch.sent.coords).into();
        self.touches.iter().map(error).collect()
    }

    /// The touched pixels.
    pub fn pixels(&self) -> Vec<Pixel<Screen>> {
        self.touches.iter().map(|touch| touch.pixel).collect()
    }
}

fn check_screen(screen: &Touchscreen) -> Result<(), DataError> {
    let pixels = screen.width_px > 0 && screen.height_px > 0;
    let meters = [screen.width_m, screen.height_m].iter().all(|m| m.is_finite() && *m > 0.0);
    if pixels && meters {
        return Ok(());
    }
    Err(DataError::ScreenWithoutArea {
        width_px: screen.width_px,
        height_px: screen.height_px,
        width_m: screen.width_m,
        height_m: screen.height_m,
    })
}

fn finite(numbers: &[f64], what: &'static str, row: usize) -> Result<(), DataError> {
    if numbers.iter().all(|number| number.is_finite()) {
        return Ok(());
    }
    Err(DataError::NotFinite { what, row: row + 1 })
}

/// Not measured means nominal, which is 0; -0 is 0.
fn bits(number: Option<f64>) -> u64 {
    (number.unwrap_or(0.0) + 0.0).to_bits()
}

fn commonest(numbers: impl Iterator<Item = Option<f64>>) -> u64 {
    let mut counts = BTreeMap::<u64, usize>::new();
    for number in numbers {
        *counts.entry(bits(number)).or_default() += 1;
    }
    // Of equally common ones the nominal height, which has the smallest bits.
    let best = counts.into_iter().max_by_key(|(bits, count)| (*count, std::cmp::Reverse(*bits)));
    best.map_or(0, |(bits, _)| bits)
}

/// Width and height of a pixel, m.
pub(crate) fn pixel_pitch_m(screen: &Touchscreen) -> Vector2<f64> {
    Vector2::new(screen.width_m / f64::from(screen.width_px), screen.height_m / f64::from(screen.height_px))
}

/// Standard deviations of places along and across their main direction, m.
fn spread_m(places: impl ExactSizeIterator<Item = Vector2<f64>> + Clone) -> (f64, f64) {
    let count = places.len() as f64;
    let mean: Vector2<f64> = places.clone().sum::<Vector2<f64>>() / count;
    let offsets = places.map(|place| place - mean);
    let scatter: Matrix2<f64> = offsets.map(|offset| offset * offset.transpose() / count).sum();
    // Without an answer there is no spread, which is refused as a line is.
    let variances_m2 = decompose::symmetric_eigenvalues(scatter).unwrap_or_else(Vector2::zeros);
    (variances_m2.max().max(0.0).sqrt(), variances_m2.min().max(0.0).sqrt())
}

/// For each joint of the chain its place in the table; the name of the first that is missing.
fn joint_order(table: &TouchTable, chain: &Chain) -> Result<Vec<usize>, String> {
    let place = |name: &String| table.joints().iter().position(|joint| joint == name).ok_or(name.clone());
    chain.names().iter().map(place).collect()
}

struct RowReader<'a> {
    chain: &'a Chain,
    order: Result<Vec<usize>, String>,
    screen: &'a Touchscreen,
}

impl RowReader<'_> {
    /// The touch of a row, or why the row is left out.
    fn touch(&self, row: &TouchRow, index: usize) -> Result<Result<Touch, &'static str>, DataError> {
        let Some(pixel) = row.touch else { return Ok(Err("touched nothing")) };
        finite(&[pixel.u_px, pixel.v_px], "the touched pixel", index)?;
        if !pixel.is_inside((self.screen.width_px, self.screen.height_px)) {
            return Ok(Err("touched a place off the screen"));
        }
        let Some(sent) = self.sent(row)? else {
            return Ok(Err("had neither the point sent nor all commanded angles"));
        };
        finite(&[sent.coords.x, sent.coords.y, sent.coords.z], "the point sent", index)?;
        Ok(Ok(Touch { pixel, sent, set: row.set.clone(), group: row.group.clone(), row: index }))
    }

    fn sent(&self, row: &TouchRow) -> Result<Option<Point<Robot>>, DataError> {
        if row.target.is_some() {
            return Ok(row.target);
        }
        let order = self.order.as_ref().map_err(|joint| DataError::OtherChain {
            joint: joint.clone(),
            tip: self.chain.tip().to_owned(),
        })?;
        let angles: Option<Vec<f64>> =
            order.iter().map(|place| row.commanded_rad.get(*place).copied().flatten()).collect();
        Ok(angles.map(|angles| {
            Point::from(nalgebra::Point3::from(self.chain.robot_from_tip(&angles).translation_m()))
        }))
    }
}

/// Touches so far, and how many were left out for which reason.
#[derive(Default)]
struct Gathered {
    touches: Vec<Touch>,
    left_out: BTreeMap<String, usize>,
}

impl Gathered {
    fn leave_out(&mut self, reason: &'static str) {
        self.leave_out_because(reason.to_owned());
    }

    fn leave_out_because(&mut self, reason: String) {
        *self.left_out.entry(reason).or_default() += 1;
    }

    fn sentences(&self) -> Vec<String> {
        self.left_out
            .iter()
            .map(|(reason, count)| format!("{count} {} {reason}", if *count == 1 { "row" } else { "rows" }))
            .collect()
    }
}
