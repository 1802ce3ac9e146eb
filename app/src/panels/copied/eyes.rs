//! Tables of calibrating the eyes.

use plumbline_engine::view::{CollectedPair, EyesView, TableMap};
use plumbline_model::{Eye, PairFit, StereoCalibration};

use super::{Table, degrees, meters, mm, number, pixels};
use crate::operator::words::eyes::minutes_on;
use crate::panels::PanelState;

pub fn pairs(eyes: &EyesView) -> Table {
    let headings = [
        "pair",
        "left_corners",
        "right_corners",
        "distance_m",
        "tilt_up_down_deg",
        "tilt_left_right_deg",
        "remark",
    ];
    let taken = eyes.collected.iter().map(|pair| collected(pair, eyes.dropped.contains(&pair.name)));
    let not_taken = eyes.not_collected.iter().map(|(name, why)| {
        let empty = std::iter::repeat_n(String::new(), 5);
        [name.clone()].into_iter().chain(empty).chain([format!("not taken: {why}")]).collect()
    });
    Table::new(&headings, taken.chain(not_taken))
}

fn collected(pair: &CollectedPair, is_dropped: bool) -> Vec<String> {
    let corners = |eye: Eye| {
        let seen = pair.corners(eye).map(|corners| corners.iter().flatten().count());
        seen.map_or_else(String::new, |count| count.to_string())
    };
    let remark = if is_dropped { "left out of the next solution" } else { "" };
    vec![
        pair.name.clone(),
        corners(Eye::Left),
        corners(Eye::Right),
        number(pair.place.map(|place| place.distance_m), 1.0, 3),
        degrees(pair.place.map(|place| place.tilt_up_down_rad)),
        degrees(pair.place.map(|place| place.tilt_left_right_rad)),
        remark.to_owned(),
    ]
}

/// Corners per cell of both images.
pub fn coverage(state: &PanelState) -> Table {
    let mut rows = vec![];
    if let Some(coverage) = state.coverage.last().and_then(Option::as_ref) {
        for (eye, grid) in [(Eye::Left, &coverage.left), (Eye::Right, &coverage.right)] {
            let [columns, lines] = grid.cells();
            for (line, column) in (0..lines).flat_map(|line| (0..columns).map(move |column| (line, column))) {
                let reachable = if grid.is_reachable(column, line) { "yes" } else { "no" };
                let cell = [column + 1, line + 1].map(|n| n.to_string());
                let [column_name, line_name] = cell;
                let count = grid.count(column, line).to_string();
                rows.push(vec![eye.to_string(), column_name, line_name, count, reachable.to_owned()]);
            }
        }
    }
    Table::new(&["eye", "column", "row", "corners", "lens_shows_it"], rows)
}

pub fn pair_errors(calibration: &StereoCalibration, eyes: &EyesView) -> Table {
    let row = |fit: &PairFit| {
        vec![
            fit.name.clone(),
            pixels(fit.left_px),
            pixels(fit.right_px),
            pixels(fit.epipolar_px),
            meters(fit.left_from_board.translation_m().norm()),
            minutes_on(eyes, &fit.name).map_or_else(String::new, |minutes| format!("{minutes:.1}")),
        ]
    };
    Table::new(
        &["pair", "left_px", "right_px", "epipolar_px", "distance_m", "eyes_on_min"],
        calibration.per_pair.iter().map(row),
    )
}

/// Every corner of a pair.
pub fn corners(fit: &PairFit) -> Table {
    let headings =
        ["pair", "eye", "corner", "measured_u_px", "measured_v_px", "error_u_px", "error_v_px", "used"];
    let rows = fit.residuals.iter().map(|corner| {
        vec![
            fit.name.clone(),
            corner.eye.to_string(),
            (corner.corner + 1).to_string(),
            pixels(Some(corner.measured.u_px)),
            pixels(Some(corner.measured.v_px)),
            pixels(Some(corner.error_px[0])),
            pixels(Some(corner.error_px[1])),
            if corner.left_out { "no" } else { "yes" }.to_owned(),
        ]
    });
    Table::new(&headings, rows)
}

/// The figures of the proposal beside those in use.
pub fn figures(eyes: &EyesView) -> Table {
    let proposal = eyes.proposal.as_ref().map(|proposal| (&*proposal.calibration, proposal.depth_per_px_m));
    let in_use = eyes.in_use.as_ref().map(|in_use| (&*in_use.calibration, in_use.depth_per_px_m));
    if proposal.is_none() && in_use.is_none() {
        return Table::default();
    }
    let row = |name: &str, of: &dyn Fn(&StereoCalibration, Option<f64>) -> String| {
        let cell = |column: Option<(&StereoCalibration, Option<f64>)>| {
            column.map_or_else(String::new, |(c, d)| of(c, d))
        };
        vec![name.to_owned(), cell(proposal), cell(in_use)]
    };
    let summary = |pick: fn(&plumbline_model::FitSummary) -> Option<f64>, factor: f64| {
        move |c: &StereoCalibration, _: Option<f64>| number(c.summary.as_ref().and_then(pick), factor, 4)
    };
    let rows = vec![
        row("pairs", &|c, _| c.per_pair.len().to_string()),
        row("on unseen pairs, px", &summary(|s| s.cross_validated_px, 1.0)),
        row("stereo rms, px", &summary(|s| Some(s.rms_stereo_px), 1.0)),
        row("left rms, px", &summary(|s| Some(s.rms_left_px), 1.0)),
        row("right rms, px", &summary(|s| Some(s.rms_right_px), 1.0)),
        row("vertical error, px", &summary(|s| Some(s.epipolar_px), 1.0)),
        row("squares, mm", &summary(|s| Some(s.square_mean_m), 1e3)),
        row("squares, one standard deviation, mm", &summary(|s| Some(s.square_sd_m), 1e3)),
        row("baseline, mm", &|c, _| mm(Some(c.cameras.baseline_m()))),
        row("focal length left, px", &|c, _| pixels(Some(c.cameras.left.model.focal_px().0))),
        row("focal length right, px", &|c, _| pixels(Some(c.cameras.right.model.focal_px().0))),
        row("one pixel in depth, mm", &|_, depth_m| mm(depth_m)),
    ];
    Table::new(&["figure", "proposal", "in_use"], rows)
}

/// The map that is shown: the proposal's, else that in use.
pub fn uncertainty(eyes: &EyesView) -> Option<&TableMap> {
    match &eyes.proposal {
        Some(proposal) => proposal.uncertainty.as_ref(),
        None => eyes.in_use.as_ref()?.uncertainty.as_ref(),
    }
}

/// Every place of a map of the table, robot frame.
pub fn map(map: &TableMap, value: &str) -> Table {
    let at = |(low, high): (f64, f64), i: usize, n: usize| {
        meters(low + (high - low) * i as f64 / (n.max(2) - 1) as f64)
    };
    let places = (0..map.rows_y).flat_map(|iy| (0..map.columns_x).map(move |ix| (ix, iy)));
    let rows = places.map(|(ix, iy)| {
        vec![at(map.x_range_m, ix, map.columns_x), at(map.y_range_m, iy, map.rows_y), mm(map.at(ix, iy))]
    });
    Table::new(&["x_m", "y_m", value], rows)
}

/// Calibrations that were accepted.
pub fn earlier(eyes: &EyesView) -> Table {
    let rows = eyes.earlier.iter().map(|earlier| {
        let used = if earlier.in_use { "yes" } else { "no" };
        vec![earlier.accepted.to_string(), earlier.description.clone(), used.to_owned()]
    });
    Table::new(&["accepted", "calibration", "in_use"], rows)
}
