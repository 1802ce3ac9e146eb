//! What the published methods know: correction models from 245 touches on the published area, made as the
//! published ones were. A commissioned lab does without; the experiment compares with it.

use std::path::PathBuf;

use plumbline_correction::{CorrectionModel, Method, Recipe, Touch, TouchData, TrainOptions, train};
use plumbline_engine::motion::{Planner, ScreenPlace};
use plumbline_engine::touch::plan::TIP;
use plumbline_model::touch_plan::{Pattern, PlanOptions, Purpose, Side, Sides, TouchArea, TouchPlan};
use plumbline_model::{JobContext, files};

use super::error::CommissionError;
use super::lab::Lab;
use super::robot::Robot;
use super::touches::touch;

/// The area of the published touches, px of the screen.
const AREA: TouchArea = TouchArea { u_px: [120.0, 1761.0], v_px: [335.0, 1055.0] };
/// Folder in that of the lab.
const FOLDER: &str = "published";

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

/// The model of a method, trained when it is asked for first.
///
/// # Errors
/// When the touches cannot be made or learned from.
pub(crate) fn published(
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
    let read = |method: &Method| CorrectionModel::read(&file(method)).map_err(CommissionError::room);
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
    };
    let screen = &lab.rig.touchscreen;
    let plan = TouchPlan::make(&options, screen).map_err(CommissionError::room)?;
    let planner = Planner::new(&lab.rig, TIP, ScreenPlace::Nominal)?;
    let mut robot = Robot::new(lab, 0.0, None)?;
    let mut touches = vec![];
    let mut left_out = vec![];
    for (row, planned) in plan.touches.iter().enumerate() {
        context.checkpoint()?;
        context.report(row as f64 / plan.touches.len() as f64, "touching for the published models");
        let stands = robot.lockstep().commanded().clone();
        let path = match planner.plan(planned.target, screen.point_at(planned.target), Side::Above, &stands) {
            Ok(path) => path,
            Err(why) => {
                left_out.push(why.to_string());
                continue;
            }
        };
        let measured = touch(&mut robot, &path, planner.chain());
        let met = measured.and_then(|measured| Some((measured.pixel, measured.commanded_tip?)));
        match met {
            Some((pixel, sent)) => {
                touches.push(Touch { pixel, sent, set: Some(planned.set.clone()), group: None, row });
            }
            None => left_out.push("no contact near the target".to_owned()),
        }
    }
    TouchData::new(touches, screen.clone(), left_out).map_err(CommissionError::room)
}
