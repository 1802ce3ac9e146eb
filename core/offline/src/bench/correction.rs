//! Correction models: how long training takes, and how far they err on touches of the real robot,
//! beside published figures.

use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use plumbline_correction::bench::fit_times;
use plumbline_correction::{CorrectionModel, Method, TouchData, train};
use plumbline_engine::models::options;
use plumbline_model::{Pixel, Unattended, measured_data};

use super::Figure;
use crate::session;
use crate::table::Table;

/// Touches that are trained on.
const TOUCHES: &str = "nico-touch/touch-245";
/// Touches of another day that judge; nothing is chosen by them.
const JUDGE: &str = "reach-test-m2-250.csv";

/// The published recipe, run by Python.
const PUBLISHED: &str = include_str!("published_recipe.py");

/// All of them; what cannot be measured here says why.
pub fn figures() -> Vec<Figure> {
    let folder = match measured_data::folder(TOUCHES) {
        Ok(folder) => folder,
        Err(reason) => return vec![Figure::missing("correction models", reason)],
    };
    measured(&folder).unwrap_or_else(|reason| vec![Figure::missing("correction models", reason)])
}

fn measured(folder: &Path) -> Result<Vec<Figure>, String> {
    let data = touches(folder)?;
    let mut figures = times(&data)?;
    let judge = folder.parent().map(|parent| judged_touches(&parent.join(JUDGE)));
    let (_, rig) = session::open(folder).map_err(|error| error.to_string())?;
    for method in Method::ALL {
        let model = train(&data, method, &options(folder, &rig, 1, false), &Unattended, &mut |_| ());
        let model = model.map_err(|error| error.to_string())?;
        figures.extend(accuracy(&model, data.len()));
        match &judge {
            Some(Ok(touches)) => figures.push(judged(&model, touches)),
            Some(Err(reason)) => figures.push(Figure::missing("correction models on another day", reason)),
            None => {}
        }
    }
    Ok(figures)
}

fn touches(folder: &Path) -> Result<TouchData, String> {
    let (recorded, rig) = session::open(folder).map_err(|error| error.to_string())?;
    let tip = &recorded.manifest.chain.as_ref().ok_or("the session names no chain")?.tip;
    let chain = rig.chain(tip).map_err(|error| error.to_string())?;
    TouchData::of_session(&recorded, &chain).map_err(|error| error.to_string())
}

fn times(data: &TouchData) -> Result<Vec<Figure>, String> {
    let times = fit_times(data).map_err(|error| error.to_string())?;
    let what = |what: &str| format!("M3 on {} touches: {what}", data.len());
    let ratio = what("one fit as a fraction of the published recipe's in scikit-learn");
    Ok(vec![
        Figure::new(what("one fit"), times.ours_s * 1e3, "ms")
            .at_most(50.0)
            .peer("published recipe in this program", times.published_s * 1e3),
        match published_in_python_s(data) {
            Ok(published_s) => Figure::new(ratio, times.ours_s / published_s, "").at_most(0.05),
            Err(reason) => Figure::missing(ratio, reason),
        },
        Figure::new(what("training with cross-validation and border"), times.whole_training_s, "s")
            .at_most(0.5),
    ])
}

/// Median seconds that the published recipe takes in scikit-learn, in the same run.
fn published_in_python_s(data: &TouchData) -> Result<f64, String> {
    let row = |touch: &plumbline_correction::Touch| {
        let (pixel, sent) = (touch.pixel, touch.sent.coords);
        format!("{} {} {} {} {}\n", pixel.u_px, pixel.v_px, sent.x, sent.y, sent.z)
    };
    let rows: String = data.touches.iter().map(row).collect();
    let python = |error: std::io::Error| format!("python3 cannot be run ({error}): install it");
    let mut child = Command::new("python3")
        .args(["-c", PUBLISHED])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .map_err(python)?;
    if let Some(mut stdin) = child.stdin.take() {
        // A script that fell over reads nothing; its exit tells.
        let _ = stdin.write_all(rows.as_bytes());
    }
    let output = child.wait_with_output().map_err(python)?;
    let text = String::from_utf8_lossy(&output.stdout);
    let seconds = text.trim().split(';').next_back().and_then(|seconds| seconds.parse().ok());
    seconds.ok_or_else(|| {
        "scikit-learn is not there: pip install scikit-learn in the Python that python3 starts".to_owned()
    })
}

/// Errors on touches whose whole block was held out.
fn accuracy(model: &CorrectionModel, touches: usize) -> Option<Figure> {
    let held_out = model.provenance().cross_validation.as_ref()?;
    let what = format!("{}, {touches} touches, whole blocks held out: mean 2D error", model.method().name());
    let figure = Figure::new(what, held_out.errors.mean_2d_m * 1e3, "mm");
    Some(if model.method() == Method::M1 {
        figure.peer("rigid screen placement, five random parts", 6.70)
    } else {
        figure
    })
}

/// A touch of another day: pixel, and the point (x, y) that had been sent, m.
struct Judged {
    touched: Pixel<plumbline_model::session::Screen>,
    sent_m: [f64; 2],
}

fn judged_touches(file: &Path) -> Result<Vec<Judged>, String> {
    let columns = ["touch_u_px", "touch_v_px", "pred_sim_x", "pred_sim_y"];
    let table = Table::read(file, &columns, &[], "touches and the points that were sent");
    let table = table.map_err(|error| error.to_string())?;
    let judged = |row: &Vec<f64>| Judged { touched: Pixel::new(row[0], row[1]), sent_m: [row[2], row[3]] };
    Ok(table.rows().iter().map(judged).collect())
}

/// Mean distance in the plane between what the model sends for a touched pixel and what was sent.
fn judged(model: &CorrectionModel, touches: &[Judged]) -> Figure {
    let error_m = |touch: &Judged| {
        let target = model.correct(touch.touched).target.coords;
        (target.x - touch.sent_m[0]).hypot(target.y - touch.sent_m[1])
    };
    let mean_m = touches.iter().map(error_m).sum::<f64>() / touches.len().max(1) as f64;
    let what =
        format!("{} on {} touches of another day: mean 2D error", model.method().name(), touches.len());
    let figure = Figure::new(what, mean_m * 1e3, "mm");
    match model.method() {
        Method::M1 => figure,
        Method::M2 => figure.at_most(4.7).peer("published M2", 7.38),
        Method::M3 => figure.at_most(4.45).peer("published M3", 4.60),
    }
}

#[cfg(test)]
#[allow(clippy::print_stdout, reason = "figures for who reads the test's output")]
mod tests {
    use super::*;

    #[test]
    fn every_figure_is_measured_where_the_data_are() {
        if let Err(skipped) = measured_data::folder(TOUCHES) {
            return println!("{skipped}");
        }
        let figures = figures();
        for figure in &figures {
            let peer = figure.peer.as_ref().map(|peer| (peer.name, peer.value));
            println!(
                "{}: {:?} {} (at most {:?}, {peer:?})",
                figure.what, figure.value, figure.unit, figure.at_most
            );
        }
        assert_eq!(figures.len(), 9, "{figures:?}");
        // Not every machine has scikit-learn; without it the figure says so.
        let measured = |figure: &Figure| figure.value.is_some_and(|value| value > 0.0);
        let missing = |figure: &Figure| figure.note.as_ref().is_some_and(|note| note.contains("install"));
        assert!(figures.iter().all(|figure| measured(figure) || missing(figure)), "{figures:?}");
        assert!(figures.iter().filter(|figure| measured(figure)).count() >= 8, "{figures:?}");
    }
}
