//! Heights of the hand for the published methods: the open hand is lowered, palm down, at about as many
//! places as were published, until it meets the table.
//!
//! What meets the table is told by the servos, as on a robot: while the hand goes down through the air their
//! loads stay, and from contact on they grow with every step, for the table carries more and more of the arm.
//! Where the line of that growth begins the hand met the table. (A person who jogs a hand down and looks, as was
//! published, does the same with the eyes.)

use nalgebra::Vector3;
use plumbline_correction::tables::{HeightPoint, HeightTable};
use plumbline_effects::RobotModel;
use plumbline_grasp::PalmArm;
use plumbline_grasp::plan::{GraspPlanner, Headed, Standing};
use plumbline_grasp::published::heading_rad;
use plumbline_model::robot::{JointIndex, Posture};
use plumbline_model::{JobContext, Point};

use super::error::CommissionError;
use super::lab::Lab;
use super::robot::{Robot, SPEED_RAD_S};

/// Places at which the hand is lowered: 5 × 9, over what the arm reaches (published: 45).
const X_M: [f64; 5] = [0.16, 0.22, 0.28, 0.34, 0.40];
const Y_M: [f64; 9] = [-0.42, -0.33, -0.24, -0.15, -0.06, 0.03, 0.12, 0.21, 0.30];
/// The hand is held as for a thing of this height, m.
const THING_M: f64 = 0.054;
/// Steps down, m.
const STEP_M: f64 = 0.002;
/// Steps begin this high over the table as described, m.
const FEEL_M: f64 = 0.03;
/// Lower than the table is described by so much nothing is looked for, m.
const DEEPEST_M: f64 = 0.03;
/// Speed of the joints on the way down, rad/s.
const DOWN_RAD_S: f64 = 0.3;
/// Loads (shares of full torque) are compared with their mean over so many steps through the air…
const AIR: usize = 3;
/// …and contact is that they depart from it over so many steps…
const RISE: usize = 3;
/// …by no less than this from step to step, and by this in the end. A joint's friction turns over in one
/// step, and the load of a wrist that goes down drifts by 0.008 a step.
const LEAST_RISE: f64 = 0.012;
const LEAST_END: f64 = 0.045;
/// A height that is farther from what those around it say is not the hand's on the table (an elbow may have
/// met it, or a load that changed for another reason), m.
const ODD_M: f64 = 0.012;
/// Fewer places make no table.
const FEWEST: usize = 20;

/// What lowering the hand everywhere gave.
pub(super) struct Lowered {
    /// Heights that the described hand has the table at.
    pub table: HeightTable,
    /// Places at which nothing was found, and why.
    pub left_out: Vec<String>,
}

/// Plans for the hand of the robot as described.
fn planner(lab: &Lab) -> Result<GraspPlanner, CommissionError> {
    let arm = PalmArm::new(&RobotModel::nominal(lab.rig.clone()), "right").map_err(CommissionError::room)?;
    Ok(GraspPlanner::new(arm))
}

/// Lowers the hand everywhere.
pub(super) fn measure(lab: &Lab, context: &dyn JobContext) -> Result<Lowered, CommissionError> {
    let planner = planner(lab)?;
    let mut robot = Robot::new(lab, 0.0, None)?;
    let (mut points, mut left_out) = (vec![], vec![]);
    let places = X_M.iter().flat_map(|x_m| Y_M.iter().map(move |y_m| [*x_m, *y_m]));
    for (k, [x_m, y_m]) in places.enumerate() {
        context.checkpoint()?;
        context.report(k as f64 / (X_M.len() * Y_M.len()) as f64, "lowering the open hand on the table");
        match lower(&planner, &mut robot, [x_m, y_m]) {
            Ok(height_m) => points.push(HeightPoint { x_m, y_m, height_m }),
            Err(why) => left_out.push(format!("x {:.0}, y {:.0} mm: {why}", 1e3 * x_m, 1e3 * y_m)),
        }
    }
    if points.len() < FEWEST {
        let (met, example) = (points.len(), left_out.first().cloned().unwrap_or_default());
        return Err(CommissionError::room(format!(
            "the open hand met the table at {met} of {} places, which make no table of heights: is the table \
             where the rig file has it? {example}",
            X_M.len() * Y_M.len()
        )));
    }
    let mut table = HeightTable::new(points).map_err(CommissionError::room)?;
    while let Some((odd, off_m)) = oddest(&table)?.filter(|(_, off_m)| off_m.abs() > ODD_M) {
        let HeightPoint { x_m, y_m, .. } = table.remove(odd).map_err(CommissionError::room)?;
        let (x_mm, y_mm, off_mm) = (1e3 * x_m, 1e3 * y_m, 1e3 * off_m);
        left_out.push(format!("x {x_mm:.0}, y {y_mm:.0} mm: {off_mm:.0} mm from what those around it say"));
    }
    Ok(Lowered { table, left_out })
}

/// The point that is farthest from what the others say, and by how much, m.
fn oddest(table: &HeightTable) -> Result<Option<(usize, f64)>, CommissionError> {
    let off_m = table.leave_one_out().map_err(CommissionError::room)?;
    Ok(off_m.into_iter().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())))
}

/// Height of the described hand's lowest point when the real one met the table at a place, m.
fn lower(planner: &GraspPlanner, robot: &mut Robot, xy_m: [f64; 2]) -> Result<f64, String> {
    let rig = robot.lockstep().rig().clone();
    let standing = Standing { xy_m, support_m: rig.table.height_m, height_m: THING_M, lower_m: 0.0 };
    let heading_rad = heading_rad(xy_m[0], xy_m[1]);
    let headed = Headed { heading_rad, shift_m: Vector3::zeros(), centered: false };
    let home = rig.home();
    let plan = planner.plan_headed(&standing, &headed, &home).map_err(|why| why.to_string())?;
    let is_high = |posture: &&Posture| {
        let low_m = planner.arm().lowest_m(posture).unwrap_or_default();
        low_m > standing.support_m + FEEL_M
    };
    let down: Vec<Posture> = plan.down.iter().take_while(is_high).cloned().collect();
    robot.lockstep().follow(&plan.approach, SPEED_RAD_S);
    robot.lockstep().follow(&down, DOWN_RAD_S);
    let met = until_contact(planner, robot, plan.heading_rad, standing.support_m - DEEPEST_M);
    let back: Vec<Posture> = plan.approach.iter().rev().cloned().chain([home]).collect();
    robot.lockstep().follow(&back, SPEED_RAD_S);
    met
}

/// Steps down until the servos tell of contact: the height of the described hand's lowest point there, m.
fn until_contact(
    planner: &GraspPlanner,
    robot: &mut Robot,
    heading_rad: f64,
    deepest_m: f64,
) -> Result<f64, String> {
    let arm = planner.arm();
    let joints: Vec<JointIndex> = arm.joints().iter().chain(arm.hand()).copied().collect();
    let mut before = robot.lockstep().commanded().clone();
    let mut steps: Vec<Felt> = vec![];
    loop {
        let palm = arm.palm(&before).coords - Vector3::z() * STEP_M;
        let next = arm.next_to(Point::from(palm), heading_rad, &before).ok_or("the arm gets no lower")?;
        let height_m = arm.lowest_m(&next).ok_or("the description shows no hand")?;
        if height_m < deepest_m {
            return Err("the hand met nothing".to_owned());
        }
        robot.lockstep().follow(std::slice::from_ref(&next), DOWN_RAD_S);
        let servos = robot.lockstep().servos();
        let load = |joint: &JointIndex| Some(servos.iter().find(|servo| servo.joint == *joint)?.load);
        steps.push(Felt { height_m, loads: joints.iter().filter_map(load).collect() });
        if let Some(height_m) = contact_m(&steps) {
            return Ok(height_m);
        }
        before = next;
    }
}

/// What the servos said on a step down.
struct Felt {
    /// Of the described hand's lowest point, m.
    height_m: f64,
    /// Of the joints of arm and hand.
    loads: Vec<f64>,
}

/// The height at which contact began, when the last steps were in contact, m.
fn contact_m(steps: &[Felt]) -> Option<f64> {
    let (before, last) = steps.split_at(steps.len().checked_sub(RISE)?);
    let air = &before[before.len().checked_sub(AIR)?..];
    let mean = |joint: usize| air.iter().map(|step| step.loads[joint]).sum::<f64>() / AIR as f64;
    let off = |step: &Felt| {
        let squares = step.loads.iter().enumerate().map(|(joint, load)| (load - mean(joint)).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let off: Vec<f64> = last.iter().map(off).collect();
    let grows = off[0] >= LEAST_RISE && off.windows(2).all(|pair| pair[1] - pair[0] >= LEAST_RISE);
    if !grows || off[RISE - 1] < LEAST_END {
        return None;
    }
    // The straight line through how far they are off, over height, and where it begins.
    let (heights, offs) = (last.iter().map(|step| step.height_m), off.iter());
    let (mean_m, mean_off) =
        (heights.clone().sum::<f64>() / RISE as f64, offs.clone().sum::<f64>() / RISE as f64);
    let (mut along, mut square) = (0.0, 0.0);
    for (height_m, off) in heights.zip(offs) {
        along += (height_m - mean_m) * (off - mean_off);
        square += (height_m - mean_m).powi(2);
    }
    Some(mean_m - mean_off * square / along)
}

#[cfg(test)]
#[allow(clippy::print_stdout, reason = "figures for who reads the test's output")]
mod tests {
    use std::sync::Arc;

    use plumbline_model::Unattended;
    use plumbline_model::robot::Rig;

    use super::*;

    /// Loads of two joints on the way down, 2 mm a step, from 80 mm on.
    fn felt(loads: &[[f64; 2]]) -> Vec<Felt> {
        let felt = |(k, loads): (usize, &[f64; 2])| Felt {
            height_m: 0.08 - 0.002 * k as f64,
            loads: loads.to_vec(),
        };
        loads.iter().enumerate().map(felt).collect()
    }

    #[test]
    fn contact_is_where_loads_begin_to_grow() {
        let mut loads = vec![[0.1, -0.05]; 6];
        // Half a step under the contact the load is off by half of what a step adds.
        loads.extend([[0.115, -0.05], [0.145, -0.05], [0.175, -0.05]]);
        let height_m = contact_m(&felt(&loads)).expect("a contact");
        assert!((height_m - (0.08 - 0.002 * 5.5)).abs() < 1e-6, "{height_m}");
        assert_eq!(contact_m(&felt(&loads[..7])), None);
        assert_eq!(contact_m(&felt(&[])), None);
    }

    #[test]
    fn friction_that_turns_over_and_a_load_that_drifts_are_no_contact() {
        let mut turns = vec![[0.1, -0.05]; 6];
        turns.extend([[0.1, 0.05], [0.1, 0.05], [0.1, 0.058]]);
        let drifts: Vec<[f64; 2]> = (0..12).map(|k| [0.1, -0.03 - 0.008 * f64::from(k)]).collect();
        for loads in [turns, drifts] {
            assert!((1..=loads.len()).all(|count| contact_m(&felt(&loads[..count])).is_none()), "{loads:?}");
        }
    }

    /// A lab of a twin in which nothing is kept.
    fn lab(twin: &str) -> Lab {
        let rig = Arc::new(Rig::built_in("nico").expect("valid"));
        let scenario = crate::commission::scenario(twin).expect("valid");
        Lab { folder: std::path::PathBuf::new(), rig, scenario, seed: 1 }
    }

    #[test]
    fn the_hand_of_a_robot_as_described_meets_its_table_where_that_is() {
        let lab = lab("perfect");
        let planner = planner(&lab).expect("an arm");
        let mut robot = Robot::new(&lab, 0.0, None).expect("a twin");
        // On the glass, on the frame's far side, and beside it.
        for (xy_m, height_m) in
            [([0.34, -0.15], lab.rig.touchscreen.origin.coords.z), ([0.22, -0.33], lab.rig.table.height_m)]
        {
            let met_m = lower(&planner, &mut robot, xy_m).expect("met");
            assert!((met_m - height_m).abs() < 0.003, "{xy_m:?}: {met_m}, not {height_m}");
        }
    }

    #[test]
    #[ignore = "minutes; figures for who works on the published methods"]
    fn figures() {
        let twin = std::env::var("PLUMBLINE_TWIN").unwrap_or_else(|_| "lab".to_owned());
        let lowered = measure(&lab(&twin), &Unattended).expect("measured");
        for point in &lowered.table.points {
            println!("{:.2} {:.2} {:.1} mm", point.x_m, point.y_m, 1e3 * point.height_m);
        }
        println!("{:#?}", lowered.left_out);
        let off_m = lowered.table.leave_one_out().expect("a table");
        let rms_m = (off_m.iter().map(|m| m * m).sum::<f64>() / off_m.len() as f64).sqrt();
        println!("left out once each: {:.1} mm rms", 1e3 * rms_m);
    }
}
