//! Markers that were mounted anew although nobody said so. A marker that stands turned by more than any
//! zero of a wrist can be off is no effect of the arm: its place at the tip is then found with the frame.

use plumbline_effects::Measurements;
use plumbline_effects::measurements::What;
use plumbline_model::JobContext;

use crate::compare::{median, placed, residuals};
use crate::error::GapError;

/// Three usual sizes of the zero of a joint: no effect of the library turns the tip further, rad.
const FURTHEST_TURN_RAD: f64 = 0.13;
/// With the marker's place free, turns have to become smaller at least by this.
const CLEARLY: f64 = 3.0;
/// Fewer rows with orientation say nothing.
const FEWEST_ROWS: usize = 12;

/// The measurements with such markers told, where there are any, and words about it.
///
/// # Errors
/// Cancelled.
pub(crate) fn mounted_anew(
    measurements: &Measurements,
    context: &dyn JobContext,
) -> Result<Option<(Measurements, Vec<String>)>, GapError> {
    let mut changed: Option<(Measurements, Vec<String>)> = None;
    for session in 0..measurements.apparatuses.len() {
        let rows: Vec<usize> = (0..measurements.rows.len())
            .filter(|&i| {
                let row = &measurements.rows[i];
                row.session == session && row.what == What::OrientedPose && row.marker == 0
            })
            .collect();
        if rows.len() < FEWEST_ROWS || measurements.apparatuses[session].tip_is_unknown {
            continue;
        }
        let fixed = measurements.only(rows.iter().copied());
        let mut free = fixed.clone();
        free.apparatuses[session].tip_is_unknown = true;
        let all: Vec<usize> = (0..rows.len()).collect();
        let [as_described, anew] = [placed(&fixed, &all, context)?, placed(&free, &all, context)?];
        let turn_rad = anew.mount(session).rotation.angle();
        let turns_rad = |of: &Measurements, assumed| {
            let turns = residuals(of, assumed);
            let turns = turns.iter().flatten().filter(|residual| residual.len() > 3);
            median(turns.map(|residual| residual[3..].iter().map(|turn| turn * turn).sum::<f64>().sqrt()))
        };
        let (Some(before), Some(after)) = (turns_rad(&fixed, &as_described), turns_rad(&free, &anew)) else {
            continue;
        };
        if turn_rad < FURTHEST_TURN_RAD || before < CLEARLY * after {
            continue;
        }
        let (told, words) = changed.get_or_insert_with(|| (measurements.clone(), vec![]));
        told.apparatuses[session].tip_is_unknown = true;
        words.push(format!(
            "{}: what was measured stands turned by {:.0}° against the tip of the description, further than any joint \
             can be off: it was taken as mounted anew, and its place at the tip was found with the frame. If so, write \
             tip_place = \"unknown\" under [chain] in its session.toml; else correct the description",
            measurements.apparatuses[session].title,
            turn_rad.to_degrees()
        ));
    }
    Ok(changed)
}
