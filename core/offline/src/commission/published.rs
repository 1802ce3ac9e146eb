//! What the published methods know: correction models from 245 touches on the published area, made as the
//! published ones were, and heights at which the open hand met the table. A commissioned lab does without; the
//! experiment compares with it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use plumbline_correction::tables::HeightTable;
use plumbline_correction::{CorrectionModel, Method, Recipe, Touch, TouchData, TrainOptions, train};
use plumbline_engine::ground::jobs::Part;
use plumbline_engine::motion::{ScreenPlace, Wanted};
use plumbline_grasp::Corrections;
use plumbline_grasp::published::HandHeights;
use plumbline_model::touch_plan::{Finger, Pattern, PlanOptions, Purpose, Side, Sides, TouchArea, TouchPlan};
use plumbline_model::{JobContext, files};

use super::error::CommissionError;
use super::hand_heights;
use super::lab::Lab;
use super::robot::Robot;
use super::touches::Depths;

/// The area of the published touches, px of the screen.
const AREA: TouchArea = TouchArea { u_px: [120.0, 1761.0], v_px: [335.0, 1055.0] };
/// Folder in that of the lab.
const FOLDER: &str = "published";
/// Heights of the hand, in that folder, and the places at which it met nothing.
const HEIGHTS: &str = "hand-heights.csv";
const HEIGHTS_LEFT_OUT: &str = "hand-heights-left-out.txt";

/// The published plan: a grid of 36, lines of 89, and 120 drawn by chance.
fn patterns() -> Vec<Pattern> {
    let lines =
        |horizontal, vertical, diagonal, points| Pattern::Lines { horizontal, vertical, diagonal, points };
    vec![
        Pattern::Grid { columns: 9, rows: 4 },
        lines(2, 0, 0, 17),
        lines(0, 3, 0, 11),
        lines(0, 0, 2, 11),
        Pattern::Random { count: 120 },
    ]
}

/// What the published methods know, made when it is asked for first. Neither its touches nor its time count
/// as commissioning: they are what the published methods need, not what a lab needs.
///
/// # Errors
/// When it cannot be made, or what was kept of it cannot be read.
pub(crate) fn corrections(lab: &Lab, context: &dyn JobContext) -> Result<Corrections, CommissionError> {
    let half = |begin, end| Part { whole: context, begin, end };
    let models = models(lab, &Method::ALL, &half(0.0, 0.7))?;
    let [m1, m2, m3] = <[CorrectionModel; 3]>::try_from(models)
        .map_err(|_| CommissionError::room("the published methods are three"))?
        .map(|model| Some(Arc::new(model)));
    let heights = heights(lab, &half(0.7, 1.0))?;
    let touches = m3.iter().flat_map(|m3| &m3.provenance().touches);
    let fingertips_m = touches.map(|touch| touch.sent_m);
    let hand = HandHeights::new(&heights, fingertips_m).map_err(CommissionError::room)?;
    Ok(Corrections { m1, m2, m3, hand: Some(Arc::new(hand)) })
}

fn unusable(file: &Path, error: &impl std::fmt::Display) -> CommissionError {
    CommissionError::Published { file: file.to_owned(), reason: error.to_string() }
}

/// Heights of the open hand.
fn heights(lab: &Lab, context: &dyn JobContext) -> Result<HeightTable, CommissionError> {
    let folder = lab.folder.join(FOLDER);
    let file = folder.join(HEIGHTS);
    if !file.exists() {
        let lowered = hand_heights::measure(lab, context)?;
        files::make_folder(&folder)?;
        files::write(&folder.join(HEIGHTS_LEFT_OUT), lowered.left_out.join("\n"))?;
        lowered.table.write(&file).map_err(CommissionError::room)?;
    }
    HeightTable::read(&file).map_err(|error| unusable(&file, &error))
}

/// The model of a method, trained when it is asked for first.
///
/// # Errors
/// When the touches cannot be made or learned from.
fn models(
    lab: &Lab,
    methods: &[Method],
    context: &dyn JobContext,
) -> Result<Vec<CorrectionModel>, CommissionError> {
    let file = |method: &Method| -> PathBuf {
        lab.folder.join(FOLDER).join(format!("{}.json", method.name().to_lowercase()))
    };
    if !methods.iter().all(|method| file(method).exists()) {
        let data = touches(lab, context)?;
        files::make_folder(&lab.folder.join(FOLDER))?;
        for method in methods {
            context.checkpoint()?;
            let options = TrainOptions {
                seed: lab.seed,
                recipe: Recipe::Published,
                session: FOLDER.to_owned(),
                rig: lab.rig.name.clone(),
                screen: Some((&lab.rig.touchscreen).into()),
                ..TrainOptions::default()
            };
            let model =
                train(&data, *method, &options, context, &mut |_| ()).map_err(CommissionError::room)?;
            model.write(&file(method)).map_err(CommissionError::room)?;
        }
    }
    let read = |method: &Method| {
        let file = file(method);
        CorrectionModel::read(&file).map_err(|error| unusable(&file, &error))
    };
    methods.iter().map(read).collect()
}

fn touches(lab: &Lab, context: &dyn JobContext) -> Result<TouchData, CommissionError> {
    let options = PlanOptions {
        area: AREA,
        patterns: patterns(),
        repeats: 1,
        sides: Sides::Above,
        screen_heights_m: vec![0.0],
        payloads_kg: vec![0.0],
        seed: lab.seed,
        purpose: Purpose::Train,
        finger: Finger::Right,
        beside_described: false,
    };
    let screen = &lab.rig.touchscreen;
    let plan = TouchPlan::make(&options, screen).map_err(CommissionError::room)?;
    let mut depths = Depths::new(&lab.rig, ScreenPlace::Nominal)?;
    let mut robot = Robot::new(lab, 0.0, None)?;
    let mut touches = vec![];
    let mut left_out = vec![];
    for (row, planned) in plan.touches.iter().enumerate() {
        context.checkpoint()?;
        context.report(row as f64 / plan.touches.len() as f64, "touching for the published models");
        let sent = screen.point_at(planned.target);
        let met = depths.touch(&mut robot, &Wanted::straight(planned.target, sent, Side::Above));
        match met.map(|measured| (measured.pixel, measured.commanded_tip)) {
            Ok((pixel, Some(sent))) => {
                touches.push(Touch { pixel, sent, set: Some(planned.set.clone()), group: None, row });
            }
            Ok(_) => left_out.push("it is not known where the finger was sent".to_owned()),
            Err(why) => left_out.push(why),
        }
    }
    TouchData::new(touches, screen.clone(), left_out).map_err(CommissionError::room)
}

#[cfg(test)]
mod tests {
    use plumbline_model::Unattended;
    use plumbline_model::robot::Rig;

    use super::*;

    #[test]
    fn heights_that_cannot_be_read_say_which_file_and_what_to_do() {
        let folder = tempfile::tempdir().expect("a folder");
        let scenario = crate::commission::scenario("perfect").expect("valid");
        let rig = Arc::new(Rig::built_in("nico").expect("valid"));
        let lab = Lab { folder: folder.path().to_owned(), rig, scenario, seed: 1 };
        let file = folder.path().join(FOLDER).join(HEIGHTS);
        std::fs::create_dir(folder.path().join(FOLDER)).expect("made");
        std::fs::write(&file, "x_m,y_m\n0.3,0.1\n").expect("written");
        let why = heights(&lab, &Unattended).expect_err("no heights").to_string();
        assert!(why.contains(HEIGHTS) && why.contains("remove it, and it is made anew"), "{why}");
        let text = "x_m,y_m,height_m\n0.2,0,0.05\n0.3,0,0.05\n0.2,0.1,0.06\n0.3,0.1,0.06\n";
        std::fs::write(&file, text).expect("written");
        assert_eq!(heights(&lab, &Unattended).expect("heights").points.len(), 4);
    }
}
