//! `plumbline ik`: the joint angles that bring a tip to targets.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use plumbline_effects::rig_model::{Conditions, ModelEffect};
use plumbline_effects::robot_model::worst_sigma_m;
use plumbline_effects::{RigModel, RobotModel};
use plumbline_model::robot::Rig;
use plumbline_model::robot::ik::{Options, Target};
use plumbline_model::{JobContext, Point, Pose};
use serde::Serialize;

use super::OfflineError;
use super::table::Table;

/// What the file of targets needs.
const NEEDS: &str = "the header x_m,y_m,z_m, or with roll_rad,pitch_rad,yaw_rad or yaw_rad behind it, and one target in the robot's frame per line, for example 0.35,-0.15,0.2";
/// Targets between two reports.
const REPORTED: usize = 1000;

/// What to solve.
#[derive(Clone, Debug)]
pub struct IkArgs {
    /// Name of a rig that comes with the program, or the path of a rig file.
    pub rig: String,
    /// Link that shall go to the targets.
    pub tip: String,
    /// Table with the columns `x_m`, `y_m`, `z_m` and, for poses, `roll_rad`, `pitch_rad`,
    /// `yaw_rad` (R = Rz(yaw) · Ry(pitch) · Rx(roll)), or `yaw_rad` alone for a heading.
    pub targets: PathBuf,
    /// Whether the tip's z axis shall point up as nearly as the arm can.
    pub upright: bool,
    /// A model with effects: the angles are those that must be commanded so that the arm with these
    /// effects gets there.
    pub rig_model: Option<PathBuf>,
}

/// What was found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IkReport {
    /// The tip.
    pub tip: String,
    /// Targets that are reached.
    pub reached: usize,
    /// The model of the robot that was solved with: "as described", "with 2 effects".
    pub model: String,
    /// Effects that were solved with, as `id@site`.
    pub effects: Vec<String>,
    /// In the order of the table.
    pub solutions: Vec<IkSolution>,
}

/// One target: the angles that reach it or come nearest.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IkSolution {
    /// Joint angles by name, rad, inside the limits.
    pub joints: BTreeMap<String, f64>,
    /// Distance of the tip to the target.
    pub position_error_m: f64,
    /// What is left of the orientation or heading asked for; zero when none was.
    pub orientation_error_rad: f64,
    /// One standard deviation of the tip's place along the worst direction, by what is not known of the
    /// effects; zero without effects.
    pub effects_sigma_m: f64,
    /// `reached`, `limited-by:<joint>` or `out-of-reach`; with effects also `unsettled`: no command
    /// was found that leads there.
    pub status: String,
}

/// Solves every target of the table, each from the rig's home posture.
pub fn ik(args: &IkArgs, context: &dyn JobContext) -> Result<IkReport, OfflineError> {
    let rig = find_rig(&args.rig)?;
    let rig = Arc::new(rig);
    let model = match &args.rig_model {
        None => RobotModel::nominal(rig.clone()),
        Some(file) => RobotModel::new(rig.clone(), Arc::new(RigModel::read(file, &rig)?))?,
    };
    let arm = model.arm(&args.tip)?;
    let targets = read_targets(&args.targets)?;
    let (start, conditions) = (rig.home(), Conditions::default());
    let options = if args.upright { Options::upright() } else { Options::default() };
    let nominal = arm.deviated().is_nominal();
    let effects =
        if nominal { vec![] } else { model.added().effects().iter().map(ModelEffect::name).collect() };
    let solutions = Vec::with_capacity(targets.len());
    let mut report = IkReport { tip: args.tip.clone(), reached: 0, model: model.title(), effects, solutions };
    for (k, target) in targets.iter().enumerate() {
        if k % REPORTED == 0 {
            context.checkpoint()?;
            context.report(k as f64 / targets.len() as f64, "solving");
        }
        let found = arm.reach(target, &start, &options, &conditions)?;
        let best = found.answer.best();
        let commanded = start.with(arm.joints(), &best.joints);
        report.reached += usize::from(found.is_reached());
        report.solutions.push(IkSolution {
            joints: arm.solver().names().iter().cloned().zip(best.joints.iter().copied()).collect(),
            position_error_m: found.error_m,
            orientation_error_rad: best.orientation_error_rad,
            effects_sigma_m: worst_sigma_m(&arm.covariance_m2(&commanded, &conditions)),
            status: found.status(),
        });
    }
    context.report(1.0, "solved");
    Ok(report)
}

/// A rig that comes with the program, or else a file.
pub(super) fn find_rig(rig: &str) -> Result<Rig, OfflineError> {
    let built_in = Rig::built_in_names().any(|name| name == rig);
    let looks_like_a_file = rig.contains(['/', '\\']) || rig.ends_with(".toml");
    Ok(if built_in || !looks_like_a_file { Rig::built_in(rig)? } else { Rig::read(Path::new(rig))? })
}

/// Reads targets; which columns of orientation are there decides what they ask for.
fn read_targets(file: &Path) -> Result<Vec<Target>, OfflineError> {
    let table = Table::read(file, &["x_m", "y_m", "z_m"], &["roll_rad", "pitch_rad", "yaw_rad"], NEEDS)?;
    let target: fn(&[f64]) -> Target = match &table.columns()[3..] {
        [] => |row| Target::Position(Point::new(row[0], row[1], row[2])),
        ["yaw_rad"] => {
            |row| Target::PositionYaw { point: Point::new(row[0], row[1], row[2]), yaw_rad: row[3] }
        }
        [_, _, _] => |row| {
            let rotation = UnitQuaternion::from_euler_angles(row[3], row[4], row[5]);
            Target::Pose(Pose::new(Isometry3::from_parts(
                Translation3::new(row[0], row[1], row[2]),
                rotation,
            )))
        },
        some => {
            return Err(OfflineError::HalfAnOrientation { file: file.to_owned(), given: some.join(", ") });
        }
    };
    Ok(table.rows().iter().map(|row| target(row)).collect())
}

#[cfg(test)]
mod tests {
    use plumbline_model::Unattended;

    use super::*;

    fn solve(tip: &str, table: &str) -> Result<IkReport, String> {
        let folder = tempfile::tempdir().expect("temporary folder");
        let targets = folder.path().join("targets.csv");
        std::fs::write(&targets, table).expect("written");
        let args =
            IkArgs { rig: "nico".to_owned(), tip: tip.to_owned(), targets, upright: false, rig_model: None };
        ik(&args, &Unattended).map_err(|error| error.to_string())
    }

    #[test]
    fn each_target_has_its_angles_and_its_status() {
        let report = solve("right_palm_center", "x_m,y_m,z_m\n0.3,-0.2,0.2\n3,0,0\n").expect("solved");
        assert_eq!((report.reached, report.solutions.len()), (1, 2));
        let [near, far] = &report.solutions[..] else { panic!("two targets") };
        assert!(near.status == "reached" && near.position_error_m < 1e-5 && near.joints.len() == 6);
        assert!(far.status == "out-of-reach" && far.position_error_m > 2.0);
        let rig = Rig::built_in("nico").expect("a rig");
        let chain = rig.chain("right_palm_center").expect("a tip");
        let angles: Vec<f64> = chain.names().iter().map(|name| near.joints[name]).collect();
        let there = chain.robot_from_tip(&angles).translation_m();
        assert!((there - nalgebra::Vector3::new(0.3, -0.2, 0.2)).norm() < 1e-5);
    }

    #[test]
    fn columns_decide_what_is_asked() {
        let yaw = solve("right_palm_center", "yaw_rad,x_m,y_m,z_m\n0.2,0.3,-0.2,0.2\n").expect("solved");
        assert!(yaw.reached == 1 && yaw.solutions[0].orientation_error_rad < 1e-4);
        let pose = "x_m,y_m,z_m,roll_rad,pitch_rad,yaw_rad\n0.3,-0.2,0.2,3,0,2\n";
        let pose = solve("right_palm_center", pose).expect("answered");
        assert!(pose.solutions[0].status.starts_with("limited-by:r_"), "{:?}", pose.solutions[0]);
        assert!(solve("right_palm_center", "x_m,y_m,z_m\n").expect("nothing to do").solutions.is_empty());
    }

    #[test]
    fn what_cannot_be_asked_is_refused_with_a_sentence() {
        for (tip, table, said) in [
            ("right_palm_center", "x_m,y_m\n1,2\n", "no column z_m"),
            ("right_palm_center", "x_m,y_m,z_m\n1,2,NaN\n", "line 2: \"NaN\" in column z_m is no number"),
            ("right_palm_center", "x_m,y_m,z_m,roll_rad\n1,2,3,4\n", "yaw_rad alone for a heading"),
            ("right_toe", "x_m,y_m,z_m\n1,2,3\n", "no link called right_toe"),
            ("torso", "x_m,y_m,z_m\n1,2,3\n", "0 joints"),
        ] {
            let message = solve(tip, table).expect_err("bad");
            assert!(message.contains(said), "{message}");
        }
        let args = IkArgs {
            rig: "nobody".to_owned(),
            tip: "right_palm_center".to_owned(),
            targets: PathBuf::from("none.csv"),
            upright: false,
            rig_model: None,
        };
        assert!(ik(&args, &Unattended).expect_err("no such rig").to_string().contains("there are: nico"));
    }
}
