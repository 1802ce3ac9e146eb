//! What moves: servos, how they limit each other, arms, named poses, and how fast.

use std::collections::BTreeSet;

use super::Reader;
use super::parts::{ArmPart, BoardPart, CoupledPart, DirectionPart, GatePart, PosePart, ServoPart};
use crate::plausible;
use crate::robot::description::Limits;
use crate::robot::error::RigError;
use crate::robot::rig::{Arm, CoupledLimit, Direction, Gate, NamedPose, Servo, TipName};

impl Reader<'_> {
    pub(in crate::robot) fn servo(&self, part: &ServoPart) -> Result<Servo, RigError> {
        if let Some(first) = self.servo_problems(part).into_iter().next() {
            return Err(first);
        }
        self.servo_of(part)
    }

    fn servo_of(&self, part: &ServoPart) -> Result<Servo, RigError> {
        Ok(Servo {
            id: part.id,
            model: part.model.clone(),
            joint: self.joint(&format!("servo {}", part.id), &part.joint)?,
            joint_name: part.joint.clone(),
            title: part.title.clone(),
            direction: match part.direction {
                DirectionPart::Direct => Direction::Direct,
                DirectionPart::Indirect => Direction::Indirect,
            },
            offset_rad: part.offset_rad,
            ratio: part.ratio,
            motor_limits: Limits { lower_rad: part.motor_lower_rad, upper_rad: part.motor_upper_rad },
        })
    }

    /// All that is wrong with a servo.
    pub(in crate::robot) fn servo_problems(&self, part: &ServoPart) -> Vec<RigError> {
        let place = format!("servo {}", part.id);
        let motor_rad = [part.motor_lower_rad, part.motor_upper_rad];
        let mut found: Vec<RigError> = [
            self.plausible(&place, plausible::ANGLE_RAD, &[part.offset_rad]),
            self.plausible(&place, plausible::RATIO, &[part.ratio]),
            self.plausible(&place, plausible::JOINT_LIMIT_RAD, &motor_rad),
        ]
        .into_iter()
        .filter_map(Result::err)
        .collect();
        if part.id > 252 {
            found.push(self.value(&place, "ids go from 0 to 252".to_owned()));
        }
        if part.ratio <= 0.0 {
            let what = "must be positive; a reversed motor has the direction \"indirect\"";
            found.push(self.value(&place, format!("ratio {} {what}", part.ratio)));
        }
        if part.motor_lower_rad >= part.motor_upper_rad {
            found.push(self.value(&place, "motor_lower_rad must be below motor_upper_rad".to_owned()));
        }
        if !found.is_empty() {
            return found;
        }
        let servo = match self.servo_of(part) {
            Ok(servo) => servo,
            Err(error) => return vec![error],
        };
        let (by_motor, by_joint) = (servo.joint_limits(), self.robot.limits(servo.joint));
        if by_motor.lower_rad.max(by_joint.lower_rad) >= by_motor.upper_rad.min(by_joint.upper_rad) {
            found.push(self.value(&place, format!(
                "its motor reaches {:.3} to {:.3} rad of {}, which the description limits to {:.3} to {:.3}: check offset and direction",
                by_motor.lower_rad, by_motor.upper_rad, part.joint, by_joint.lower_rad, by_joint.upper_rad
            )));
        }
        found
    }

    pub(super) fn unique(&self, servos: &[Servo], boards: &[BoardPart]) -> Result<(), RigError> {
        let twice = |what: String| RigError::Twice { file: self.file.to_owned(), what };
        let (mut ids, mut joints) = (BTreeSet::new(), BTreeSet::new());
        for servo in servos {
            if !ids.insert(servo.id) {
                return Err(twice(format!("two servos have the id {}", servo.id)));
            }
            if !joints.insert(servo.joint) {
                return Err(twice(format!("two servos move the joint {}", servo.joint_name)));
            }
        }
        match boards.iter().find(|board| !ids.insert(board.id)) {
            Some(board) => {
                Err(twice(format!("the board {} has the id {} of another part", board.title, board.id)))
            }
            None => Ok(()),
        }
    }

    pub(in crate::robot) fn coupled(&self, part: &CoupledPart) -> Result<CoupledLimit, RigError> {
        let place = format!("coupled limit of {}", part.joint);
        self.plausible(&place, plausible::ANGLE_RAD, part.table_rad.as_flattened())?;
        let rising = part.table_rad.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        if part.table_rad.len() < 2 || !rising || part.table_rad.iter().any(|row| row[1] < 0.0) {
            return Err(self.value(&place, "its table needs two or more rows [angle, largest], rising in the angle, with no negative largest value".to_owned()));
        }
        Ok(CoupledLimit {
            joint: self.joint(&place, &part.joint)?,
            by: self.joint(&place, &part.by)?,
            table_rad: part.table_rad.iter().map(|row| (row[0], row[1])).collect(),
            why: part.why.clone(),
        })
    }

    pub(in crate::robot) fn arm(&self, part: &ArmPart) -> Result<Arm, RigError> {
        let place = format!("arm {}", part.name);
        let joints =
            |names: &[String]| names.iter().map(|name| self.joint(&place, name)).collect::<Result<_, _>>();
        if part.tip.is_empty() {
            return Err(self.value(&place, "needs at least one tip".to_owned()));
        }
        for tip in &part.tip {
            self.robot.find_link(&tip.link).map_err(|error| self.unknown(&place, error))?;
        }
        Ok(Arm {
            name: part.name.clone(),
            title: part.title.clone(),
            joints: joints(&part.joints)?,
            hand: joints(&part.hand)?,
            tips: part.tip.iter().map(|t| TipName { link: t.link.clone(), title: t.title.clone() }).collect(),
        })
    }

    pub(in crate::robot) fn pose(&self, part: &PosePart) -> Result<NamedPose, RigError> {
        let place = format!("pose {}", part.name);
        let joint = |(name, angle_rad): (&String, &f64)| Ok((self.joint(&place, name)?, *angle_rad));
        let joints = part.joints_rad.iter().map(joint).collect::<Result<Vec<_>, RigError>>()?;
        let angles_rad: Vec<f64> = joints.iter().map(|(_, angle)| *angle).collect();
        self.plausible(&place, plausible::JOINT_ANGLE_RAD, &angles_rad)?;
        Ok(NamedPose {
            name: part.name.clone(),
            title: part.title.clone(),
            about: part.about.clone(),
            joints,
        })
    }

    pub(in crate::robot) fn gate(&self, p: &GatePart) -> Result<Gate, RigError> {
        self.finite(
            "gate",
            &[p.warm_c, p.hot_c, p.load, p.speed_rad_s, p.usual_speed_rad_s, p.step_rad, p.floor_m],
        )?;
        self.plausible("gate", plausible::TEMPERATURE_C, &[p.warm_c, p.hot_c])?;
        self.plausible("gate", plausible::SPEED_RAD_S, &[p.speed_rad_s, p.usual_speed_rad_s])?;
        self.plausible("gate", plausible::ANGLE_RAD, &[p.step_rad])?;
        self.plausible("gate", plausible::PLACE_M, &[p.floor_m])?;
        let positive = p.speed_rad_s > 0.0 && p.usual_speed_rad_s > 0.0 && p.step_rad > 0.0;
        if !positive
            || p.warm_c >= p.hot_c
            || !(p.load > 0.0 && p.load <= 1.0)
            || p.usual_speed_rad_s > p.speed_rad_s
        {
            return Err(self.value("gate", "speeds and step must be positive, the usual speed not above the largest, load within 0 to 1, warm below hot".to_owned()));
        }
        Ok(Gate {
            warm_c: p.warm_c,
            hot_c: p.hot_c,
            load: p.load,
            speed_rad_s: p.speed_rad_s,
            usual_speed_rad_s: p.usual_speed_rad_s,
            step_rad: p.step_rad,
            floor_m: p.floor_m,
        })
    }
}
