//! Steps touches and screen: the finger goes to the glass where that tells most, and where the glass was
//! met tells where it lies.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use plumbline_engine::ground::jobs::Part;
use plumbline_engine::motion::{Planner, ScreenPlace, TouchPath, Wanted};
use plumbline_engine::rig_models;
use plumbline_engine::robot::TouchMeasurement;
use plumbline_engine::touch::plan::{Aim, FORMAT, RunPlan, TIP};
use plumbline_engine::touch::record::{Ended, Progress, TouchRecord};
use plumbline_engine::touch::telling::{Candidate, Chosen, candidates, choose, in_short_ways};
use plumbline_engine::touch::{DEEPER_M, placement, store};
use plumbline_fit::pose;
use plumbline_handeye::{Tie, body, screen, table};
use plumbline_model::robot::{Chain, Rig};
use plumbline_model::session::Touchscreen;
use plumbline_model::spread::NORMAL_95;
use plumbline_model::touch_plan::{Finger, Pattern, PlanOptions, Purpose, Sides};
use plumbline_model::touchscreen::ScreenPlacement;
use plumbline_model::{JobContext, Pixel, Point};
use plumbline_twin::Touched;

use super::error::CommissionError;
use super::lab::{Lab, TOUCH_SESSION};
use super::plan::{AGAIN, PLACES, area};
use super::robot::{Robot, SPEED_RAD_S};
use super::steps::Step;

/// The tip comes down with this speed, m/s.
const DEEPER_M_S: f64 = 0.02;
/// Encoders are read once more so much later, s.
const DWELL_S: f64 = 0.3;
/// A contact farther from its target is not the finger's, m.
const PLAUSIBLE_M: f64 = 0.06;
/// Fewer touches place no screen.
const FEWEST: usize = 6;

/// Folder of the session.
pub(super) fn session(lab: &Lab) -> PathBuf {
    lab.sessions().join(TOUCH_SESSION)
}

/// Touches and writes the session.
pub(super) fn run(lab: &Lab, robot: &mut Robot, context: &dyn JobContext) -> Result<Step, CommissionError> {
    let step = Step::new("touches", "");
    let planner = Planner::new(&lab.rig, TIP, ScreenPlace::Nominal)?;
    let mut depths = Depths::new(&lab.rig, ScreenPlace::Nominal)?;
    let area = area(&lab.rig)?;
    let possible = candidates(&planner, &area, &Part { whole: context, begin: 0.0, end: 0.2 })?;
    context.report(0.2, "choosing touches");
    let chosen = choose(&lab.rig, Finger::Right, &possible, PLACES, AGAIN)?;
    let chosen = in_short_ways(&chosen, &possible);
    let aims: Vec<Aim> = chosen.iter().enumerate().map(|(k, pick)| aim(k + 1, pick, &possible)).collect();
    let plan = RunPlan {
        format: FORMAT,
        options: PlanOptions {
            area,
            patterns: vec![Pattern::Telling { places: PLACES, again: AGAIN }],
            repeats: 1,
            sides: Sides::Above,
            screen_heights_m: vec![0.0],
            payloads_kg: vec![0.0],
            seed: lab.seed,
            purpose: Purpose::Train,
            finger: Finger::Right,
            beside_described: false,
        },
        touches: aims,
        corrected_with: None,
        model: String::new(),
        duration_s: 0.0,
        score: None,
    };
    let mut progress = Progress::new(Purpose::Train, jiff::Timestamp::now(), plan.touches.len());
    let joints = planner.chain().names().to_vec();
    let mut missed = vec![];
    for (k, aim) in plan.touches.iter().enumerate() {
        context.checkpoint()?;
        context.report(0.25 + 0.75 * k as f64 / plan.touches.len() as f64, "touching the screen");
        let met = depths.touch(robot, &aim.wanted());
        match met.and_then(|measured| TouchRecord::new(aim, &measured).ok_or_else(|| NOTHING.to_owned())) {
            Ok(record) => progress.touched(record),
            Err(why) => {
                missed.push(format!("touch {}: {why}", aim.touch.number));
                progress.end(aim.touch.number, Ended::Missed(why));
            }
        }
    }
    robot.go(&planner.ready(&lab.rig.home()));
    robot.go(&lab.rig.home());
    let touched = progress.counted().count();
    if touched < FEWEST {
        let example = missed.first().cloned().unwrap_or_default();
        return Err(CommissionError::TooFewTouches { touched, planned: plan.touches.len(), example });
    }
    progress.finished = true;
    write(lab, &joints, &plan, &progress)?;
    let notes = if missed.is_empty() { vec![] } else { vec![format!("Missed: {}.", missed.join("; "))] };
    Ok(Step { touches: touched, notes, ..step })
}

/// Why a touch counts for nothing.
const NOTHING: &str = "the screen felt nothing near the target";

/// Touches, lower where the glass is not met: an arm that stands higher than its encoders say ends over the
/// glass when it is sent to it.
pub(super) struct Depths {
    planner: Planner,
    /// Of [`DEEPER_M`], what met the glass last.
    usual: usize,
}

impl Depths {
    pub(super) fn new(rig: &Arc<Rig>, place: ScreenPlace) -> Result<Self, CommissionError> {
        Ok(Self { planner: Planner::new(rig, TIP, place)?, usual: 0 })
    }

    /// Touches what is wanted, lower where nothing was met; else why not.
    pub(super) fn touch(&mut self, robot: &mut Robot, wanted: &Wanted) -> Result<TouchMeasurement, String> {
        let mut why = NOTHING.to_owned();
        for (k, deeper_m) in DEEPER_M.into_iter().enumerate().skip(self.usual) {
            let stands = robot.lockstep().commanded().clone();
            let planned = self.planner.plan(&wanted.deeper(deeper_m), &stands);
            match planned.or_else(|_| self.planner.plan(wanted, &stands)) {
                Ok(path) => {
                    if let Some(measured) = touch(robot, &path, self.planner.chain()) {
                        self.usual = k;
                        return Ok(measured);
                    }
                }
                Err(no_way) => why = no_way.to_string(),
            }
        }
        Err(why)
    }
}

/// The session in one folder of a name that does not change, whole or not at all.
fn write(lab: &Lab, joints: &[String], plan: &RunPlan, progress: &Progress) -> Result<(), CommissionError> {
    let folder = session(lab);
    if folder.exists() {
        // What a work that was interrupted here had left.
        std::fs::remove_dir_all(&folder).map_err(CommissionError::room)?;
    }
    let manifest = store::manifest(&lab.rig.name, &lab.rig.touchscreen, joints, plan, progress.started);
    let begun = store::begin(&lab.sessions(), &manifest, plan, progress)?;
    store::write(&begun, joints, progress)?;
    std::fs::rename(&begun, &folder).map_err(CommissionError::room)
}

/// Puts a place of the screen in use that came of the touches.
pub(super) fn accept_place(lab: &Lab, placed: &ScreenPlacement) -> Result<(), CommissionError> {
    store::keep_placement(&session(lab), placed.at)?;
    lab.accept_placement(placed)
}

/// Places the screen by the touches and the nominal arm, and looks where the eyes see it.
pub(super) fn place(lab: &Lab, robot: &mut Robot, context: &dyn JobContext) -> Result<Step, CommissionError> {
    let mut step =
        Step::new("screen", "touched places against the fingertip by the model, each left out once, rms");
    let stored = store::read(&session(lab))?;
    let records: Vec<TouchRecord> = stored.progress.counted().cloned().collect();
    let placed = placement::place(&lab.rig, Finger::Right, &stored.joints, &records)?;
    step.before_mm = miss_mm(lab, &stored.joints, &records, None);
    let left_out: Vec<f64> = (0..records.len())
        .filter_map(|k| {
            let others: Vec<TouchRecord> =
                records.iter().enumerate().filter(|(i, _)| *i != k).map(|(_, r)| r.clone()).collect();
            let without = placement::place(&lab.rig, Finger::Right, &stored.joints, &others).ok()?;
            miss_mm(lab, &stored.joints, std::slice::from_ref(&records[k]), Some(&without.screen))
        })
        .collect();
    step.after_mm = rms(&left_out);
    step.notes.extend(placed.remarks.iter().cloned());
    accept_place(lab, &placed)?;
    lab.keep_tie(&look_around(lab, robot, &placed.screen, &mut step, context)?)?;
    Ok(step)
}

/// Looks at the robot's body, the screen and the table around it.
fn look_around(
    lab: &Lab,
    robot: &mut Robot,
    placed: &Touchscreen,
    step: &mut Step,
    context: &dyn JobContext,
) -> Result<Tie, CommissionError> {
    let (rig, mounted) = (lab.rig_with_eyes()?, rig_models::mounted(&lab.mount()?));
    let body = body::see(robot.body(), &rig, &mounted, &mut |_| {}, context)?;
    step.notes.push(match &body {
        Some(body) => format!(
            "By the robot's body the neck's turn is off by {:.2}° ± {:.2}° ({} edge points, {:.2} px).",
            body.neck_rad.to_degrees(),
            NORMAL_95 * body.neck_sd_rad.to_degrees(),
            body.points,
            body.rms_px
        ),
        None => "The eyes do not see the edges of the robot's body.".to_owned(),
    });
    let screen = screen::see(robot.body(), &rig, mounted.rest_sigma_rad, placed, &mut |_| {}, context)?;
    let Some(seen) = &screen else {
        step.notes.push(
            "The eyes do not see its outline, see too little of it, or see it in two places.".to_owned(),
        );
        return Ok(Tie { body, screen, table: None });
    };
    let off = seen.robot_from_screen * pose(placed).inverse();
    let middle = placed.point_at(placed.middle()).coords;
    let shift_mm = 1e3 * ((off * middle) - middle);
    step.notes.push(format!(
        "The eyes see it {:.1} {:.1} {:.1} mm beside and {:.2}° turned ({} edges, {:.2} px).",
        shift_mm.x,
        shift_mm.y,
        shift_mm.z,
        off.rotation.angle().to_degrees(),
        seen.edges,
        seen.rms_px
    ));
    let table = table::see(robot.body(), &rig, &lab.calibration()?, seen, placed)?;
    step.notes.push(match &table {
        Some(table) => format!(
            "Its glass lies {:.1} ± {:.1} mm over the table around it ({} places).",
            1e3 * table.glass_over_m,
            NORMAL_95 * 1e3 * table.sd_m,
            table.places
        ),
        None => {
            "The table around it shows the eyes too little to match: its glass is taken to lie 2 mm over it."
                .to_owned()
        }
    });
    Ok(Tie { body, screen, table })
}

/// Rms distance of the fingertip, by encoders and the nominal arm, from the pixel it touched on a screen
/// (`None`: where the rig has it), mm.
fn miss_mm(
    lab: &Lab,
    joints: &[String],
    records: &[TouchRecord],
    screen: Option<&plumbline_model::session::Touchscreen>,
) -> Option<f64> {
    let chain = lab.rig.chain(TIP).ok()?;
    let screen = screen.unwrap_or(&lab.rig.touchscreen);
    let order: Option<Vec<usize>> =
        chain.names().iter().map(|name| joints.iter().position(|joint| joint == name)).collect();
    let order = order?;
    let misses: Vec<f64> = records
        .iter()
        .filter_map(|record| {
            let angles_rad: Option<Vec<f64>> = order.iter().map(|k| record.encoder_rad[*k]).collect();
            let tip = chain.robot_from_tip(&angles_rad?).translation_m();
            Some(1e3 * (tip - screen.point_at(record.touched).coords.coords).norm())
        })
        .collect();
    rms(&misses)
}

pub(super) fn rms(values: &[f64]) -> Option<f64> {
    let squares: f64 = values.iter().map(|value| value * value).sum();
    (!values.is_empty()).then(|| (squares / values.len() as f64).sqrt())
}

fn aim(number: usize, pick: &Chosen, candidates: &[Candidate]) -> Aim {
    let candidate = &candidates[pick.candidate];
    let sent_m: [f64; 3] = candidate.path.sent.coords.coords.into();
    Aim {
        touch: candidate.planned(number, pick.group),
        hold: candidate.hold,
        place_m: sent_m,
        sent_m,
        inside: true,
        refusal: None,
        posture: Some(candidate.path.contact.clone()),
    }
}

/// Goes above, lowers until the glass is met, reads, and goes up again. `None`: the glass was not met, or
/// far from the target.
pub(super) fn touch(robot: &mut Robot, path: &TouchPath, chain: &Chain) -> Option<TouchMeasurement> {
    let pitch_m = {
        let [u_m, v_m] = robot.lockstep().rig().touchscreen.pitch_m();
        u_m.min(v_m)
    };
    let before_s = robot.on_s() - robot.lockstep().now_s();
    let lockstep = robot.lockstep();
    lockstep.follow(&path.approach, SPEED_RAD_S);
    lockstep.follow(std::slice::from_ref(path.above()), SPEED_RAD_S);
    let started_s = lockstep.now_s();
    let touched = lockstep.follow_until_touched(&path.lower, lower_speed_rad_s(path));
    let servos = lockstep.servos();
    lockstep.wait(DWELL_S);
    let later = lockstep.encoders();
    lockstep.follow(std::slice::from_ref(path.above()), SPEED_RAD_S);
    let Touched { contact, commanded, encoders } = touched?;
    let pixel = Pixel::new(f64::from(contact.pixel[0]), f64::from(contact.pixel[1]));
    let off_px = (pixel.u_px - path.target.u_px).hypot(pixel.v_px - path.target.v_px);
    if off_px * pitch_m > PLAUSIBLE_M {
        return None;
    }
    let joints = chain.joints();
    let known = |angles: Vec<f64>| angles.into_iter().map(Some).collect::<Vec<_>>();
    let of_servo = |value: fn(&plumbline_twin::ServoState) -> f64| -> Vec<Option<f64>> {
        joints.iter().map(|joint| servos.iter().find(|servo| servo.joint == *joint).map(value)).collect()
    };
    let tip = chain.robot_from_tip_in(&commanded).translation_m();
    Some(TouchMeasurement {
        pixel,
        at: Instant::now(),
        commanded_rad: known(commanded.of(joints)),
        commanded_tip: Some(Point::new(tip.x, tip.y, tip.z)),
        encoder_rad: known(encoders.of(joints)),
        later_encoder_rad: known(later.of(joints)),
        direction: path.direction.clone(),
        temperature_c: of_servo(|servo| servo.temperature_c),
        load: of_servo(|servo| servo.load),
        move_secs: contact.time_s - started_s,
        connected_secs: before_s + contact.time_s,
    })
}

/// Peak joint speed with which a lowering takes as long as its tip should, step by step.
fn lower_speed_rad_s(path: &TouchPath) -> f64 {
    let tips = path.lower_tip.windows(2).map(|pair| pair[0].distance_m(&pair[1])).sum::<f64>();
    let turns = path.lower.windows(2).map(|pair| pair[0].distance_rad(&pair[1])).sum::<f64>();
    1.875 * turns / (tips / DEEPER_M_S).max(1e-3)
}
