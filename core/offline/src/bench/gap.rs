//! The search for the gap on measured data: how long it takes, and how soon it stops.

use std::time::{Duration, Instant};

use plumbline_effects::Measurements;
use plumbline_gap::{GapError, Options, find};
use plumbline_model::robot::Rig;
use plumbline_model::{CancelledFrom, Session, Unattended, measured_data};

use super::Figure;

/// How often it is cancelled, at moments that are spread over all of the work.
const CANCELS: u32 = 30;

/// All of them; what cannot be measured here says why.
pub fn figures() -> Vec<Figure> {
    const WHAT: &str = "gap: 245 touches, held-out rows and all";
    let measurements = measured_data::folder("nico-touch/touch-245").map_err(|error| error.to_string());
    match measurements.and_then(|folder| touches(&folder)) {
        Ok(measurements) => of(&measurements).unwrap_or_else(|error| vec![Figure::missing(WHAT, error)]),
        Err(why) => vec![Figure::missing(WHAT, why)],
    }
}

fn touches(folder: &std::path::Path) -> Result<Measurements, String> {
    let session = Session::read(folder).map_err(|error| error.to_string())?;
    let rig = Rig::built_in("nico").map_err(|error| error.to_string())?;
    Measurements::of_sessions(&[("touches".to_owned(), session)], &rig).map_err(|error| error.to_string())
}

fn of(measurements: &Measurements) -> Result<Vec<Figure>, GapError> {
    let options = Options::default();
    let start = Instant::now();
    let finding = find(measurements, &options, &Unattended)?;
    let took = start.elapsed();
    let mut longest: Option<Duration> = None;
    for k in 0..CANCELS {
        let context = CancelledFrom::after(took.mul_f64((f64::from(k) + 0.5) / f64::from(CANCELS)));
        if matches!(find(measurements, &options, &context), Err(GapError::Cancelled(_))) {
            longest = longest.max(Some(context.late()));
        }
    }
    let title = |what: &str| format!("gap, {} measured touches: {what}", measurements.rows.len());
    let stops = title("cancelled, it stops after at most");
    let stops = match longest {
        Some(longest) => Figure::new(stops, longest.as_secs_f64() * 1000.0, "ms").at_most(200.0),
        None => Figure::missing(stops, "it ended each time before it was cancelled"),
    };
    Ok(vec![
        Figure::new(title("error on touches that were not used"), finding.shown.after * 1000.0, "mm")
            .at_most(3.5),
        Figure::new(title("verdict with held-out rows"), took.as_secs_f64(), "s").at_most(3.0),
        stops,
    ])
}
