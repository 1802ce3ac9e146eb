//! The grid of the real robot, where it is at hand: what was published, reproduced.
#![allow(clippy::print_stdout, reason = "figures are read from the test's output")]

use plumbline_drift::{GridErrors, GridPlace, PivotCorrection, grid_places};
use plumbline_model::robot::default_rig;
use plumbline_model::{Session, measured_data};

fn places(name: &str) -> Option<Vec<GridPlace>> {
    let folder = match measured_data::folder(name) {
        Ok(folder) => folder,
        Err(not_at_hand) => {
            println!("{not_at_hand}");
            return None;
        }
    };
    let session = Session::read(&folder).expect("a session");
    Some(grid_places(&session.localizations.expect("a table"), &default_rig()))
}

fn said(what: &str, places: &[GridPlace]) -> GridErrors {
    let errors = GridErrors::of(places).expect("places");
    let [mean, median, worst] = [errors.mean_m, errors.median_m, errors.worst_m].map(|m| 1e3 * m);
    println!("{what}: mean {mean:.2}, median {median:.2}, worst {worst:.2} mm");
    errors
}

#[test]
fn the_published_correction_is_reproduced() {
    let (Some(raw), Some(live)) =
        (places("nico-vision/grid-z5"), places("nico-vision/grid-z5-pivot-corrected"))
    else {
        return;
    };
    assert_eq!(raw.len(), 36);
    assert!((said("raw", &raw).mean_m - 36.8e-3).abs() < 1e-4);
    // As the robot corrected itself: the figure of the paper.
    assert!((said("corrected live, published", &live).mean_m - 7.6e-3).abs() < 1e-4);
    let published: Vec<GridPlace> =
        raw.iter().map(|place| PivotCorrection::PUBLISHED.applied(place)).collect();
    said("published pivot", &published);
    let fit = PivotCorrection::fitted(&raw).expect("told");
    println!("fitted: {fit:?}, published: {:?}", PivotCorrection::PUBLISHED);
    let fitted: Vec<GridPlace> = raw.iter().map(|place| fit.applied(place)).collect();
    said("fitted pivot, the same points", &fitted);
    said("fitted pivot, each place held out", &PivotCorrection::leave_one_out(&raw).expect("told"));
    assert!((GridErrors::of(&published).expect("places").mean_m - 8.4e-3).abs() < 1e-4);
}
