//! Reads rig files (TOML): the keys, and the checks that make a [`Rig`] of them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use nalgebra::Vector3;
use serde::Deserialize;

use super::description::{Description, JointIndex, Limits};
use super::error::{DescriptionError, RigError};
use super::outlines::OutlinesPart;
use super::rig::{
    Arm, Board, Bus, CoupledLimit, Direction, EyeMount, Gate, NamedPose, Rig, Servo, TableTop, TipName,
    WorkPatch,
};
use crate::camera::{Camera, CameraModel, Fisheye};
use crate::files::{self, Size, told};
use crate::formats::depth;
use crate::frame::{Direction as Axis, Point, Pose};
use crate::plausible::{self, Quantity};
use crate::session::{CalibratedAt, Touchscreen};
use crate::stereo::StereoCameras;

/// Version of the format.
pub(super) const FORMAT: u32 = 1;

/// Rigs that come with the program: name, rig file, description.
const BUILT_IN: &[(&str, &str, &str)] = &[(
    "nico",
    include_str!("../../../../assets/robots/nico/rig.toml"),
    include_str!("../../../../assets/robots/nico/nico.urdf"),
)];

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: u32,
    name: String,
    title: String,
    description: String,
    bus: BusPart,
    servo: Vec<ServoPart>,
    #[serde(default)]
    board: Vec<BoardPart>,
    #[serde(default)]
    coupled_limit: Vec<CoupledPart>,
    eyes: EyesPart,
    table: TablePart,
    workspace: WorkspacePart,
    touchscreen: ScreenPart,
    arm: Vec<ArmPart>,
    #[serde(default)]
    pose: Vec<PosePart>,
    #[serde(default)]
    outlines: OutlinesPart,
    gate: GatePart,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BusPart {
    baud: u32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ServoPart {
    pub id: u8,
    model: String,
    pub joint: String,
    pub title: String,
    direction: DirectionPart,
    offset_rad: f64,
    ratio: f64,
    motor_lower_rad: f64,
    motor_upper_rad: f64,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum DirectionPart {
    Direct,
    Indirect,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BoardPart {
    pub id: u8,
    model: String,
    pub title: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CoupledPart {
    joint: String,
    by: String,
    why: String,
    table_rad: Vec<[f64; 2]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EyesPart {
    link: String,
    pan: String,
    tilt: String,
    left_position_m: [f64; 3],
    left_rotation_rad: [f64; 3],
    right_from_left_rotation_rad: [f64; 3],
    right_from_left_translation_m: [f64; 3],
    left: LensPart,
    right: LensPart,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LensPart {
    width_px: u32,
    height_px: u32,
    fx_px: f64,
    fy_px: f64,
    cx_px: f64,
    cy_px: f64,
    skew_px: f64,
    k: [f64; 4],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TablePart {
    height_m: f64,
    x_range_m: [f64; 2],
    y_range_m: [f64; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WorkspacePart {
    x_range_m: [f64; 2],
    y_range_m: [f64; 2],
    headroom_m: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ScreenPart {
    width_px: u32,
    height_px: u32,
    width_m: f64,
    height_m: f64,
    origin_m: [f64; 3],
    u_axis: [f64; 3],
    v_axis: [f64; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ArmPart {
    name: String,
    title: String,
    joints: Vec<String>,
    hand: Vec<String>,
    tip: Vec<TipPart>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TipPart {
    link: String,
    title: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PosePart {
    pub name: String,
    title: String,
    about: String,
    pub joints_rad: BTreeMap<String, f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GatePart {
    warm_c: f64,
    hot_c: f64,
    load: f64,
    speed_rad_s: f64,
    usual_speed_rad_s: f64,
    step_rad: f64,
    floor_m: f64,
}

/// The rig that is used unless another one is chosen.
pub fn default_rig() -> Arc<Rig> {
    Arc::new(Rig::built_in("nico").expect("the rig that comes with the program is tested"))
}

impl Rig {
    /// Names of the rigs that come with the program.
    pub fn built_in_names() -> impl Iterator<Item = &'static str> {
        BUILT_IN.iter().map(|(name, ..)| *name)
    }

    /// A rig that comes with the program.
    ///
    /// # Errors
    /// When there is none of that name.
    pub fn built_in(name: &str) -> Result<Self, RigError> {
        let found = BUILT_IN.iter().find(|(known, ..)| *known == name);
        let (_, rig, description) = found.ok_or_else(|| RigError::Unreadable {
            file: format!("rig {name}"),
            reason: format!(
                "no rig of that name comes with the program; there are: {}",
                Self::built_in_names().collect::<Vec<_>>().join(", ")
            ),
        })?;
        Self::parse(&format!("{name}/rig.toml"), rig, |_| Ok((*description).to_owned()))
    }

    /// The files of a rig that comes with the program: the rig and its description; `None`: there is none of
    /// that name.
    pub fn built_in_files(name: &str) -> Option<[&'static str; 2]> {
        BUILT_IN.iter().find(|(known, ..)| *known == name).map(|(_, rig, description)| [*rig, *description])
    }

    /// Reads a rig file; the description it names lies beside it.
    pub fn read(file: &Path) -> Result<Self, RigError> {
        let read = |path: &Path| Ok(files::read_text(path, Size::TEXT)?);
        let folder = file.parent().unwrap_or(Path::new(""));
        Self::parse(&file.display().to_string(), &read(file)?, |name| read(&folder.join(name)))
    }

    /// The name of the description that a rig file names, which lies beside it.
    ///
    /// # Errors
    /// When the file cannot be read or names none.
    pub fn description_of(file: &Path) -> Result<String, RigError> {
        #[derive(Deserialize)]
        struct Named {
            description: String,
        }
        let text = files::read_text(file, Size::TEXT)?;
        let not = |reason: String| RigError::NotRig { file: file.display().to_string(), reason };
        depth::check(depth::of_toml(&text)).map_err(not)?;
        let named: Named = toml::from_str(&text).map_err(|error| not(told(&error.to_string())))?;
        Ok(named.description)
    }

    /// From the text of a rig file; `description` gives the text of the description that it names.
    pub fn parse(
        file: &str,
        text: &str,
        description: impl FnOnce(&str) -> Result<String, RigError>,
    ) -> Result<Self, RigError> {
        depth::check(depth::of_toml(text))
            .map_err(|reason| RigError::NotRig { file: file.to_owned(), reason })?;
        let parts: File = toml::from_str(text)
            .map_err(|error| RigError::NotRig { file: file.to_owned(), reason: told(&error.to_string()) })?;
        let urdf = description(&parts.description)?;
        let robot = Description::from_urdf(&urdf).map_err(|error| RigError::Description {
            file: parts.description.clone(),
            error: Box::new(error),
        })?;
        Reader { file, robot: &robot }.rig(parts)
    }
}

/// Knows where it reads, for its errors.
pub(super) struct Reader<'a> {
    pub file: &'a str,
    pub robot: &'a Description,
}

impl Reader<'_> {
    fn rig(&self, parts: File) -> Result<Rig, RigError> {
        if parts.format != FORMAT {
            return Err(self.value("format", format!("is {}, this program reads {FORMAT}", parts.format)));
        }
        let servos = parts.servo.iter().map(|part| self.servo(part)).collect::<Result<Vec<_>, _>>()?;
        self.unique(&servos, &parts.board)?;
        let rig = Rig {
            description: Arc::new(self.robot.clone()),
            bus: Bus { baud: parts.bus.baud },
            servos,
            boards: parts
                .board
                .into_iter()
                .map(|b| Board { id: b.id, model: b.model, title: b.title })
                .collect(),
            coupled_limits: parts.coupled_limit.iter().map(|p| self.coupled(p)).collect::<Result<_, _>>()?,
            eyes: self.eyes(&parts.eyes)?,
            table: self.table(&parts.table)?,
            work_patch: self.work_patch(&parts.workspace)?,
            touchscreen: self.screen(&parts.touchscreen)?,
            arms: parts.arm.iter().map(|part| self.arm(part)).collect::<Result<_, _>>()?,
            poses: parts.pose.iter().map(|part| self.pose(part)).collect::<Result<_, _>>()?,
            outlines: self.outlines(&parts.outlines)?,
            gate: self.gate(&parts.gate)?,
            name: parts.name,
            title: parts.title,
            lacking: vec![],
        };
        for pose in &rig.poses {
            for (joint, angle_rad) in &pose.joints {
                let limits = rig.limits(*joint);
                if !limits.contain(*angle_rad) {
                    return Err(self.value(
                        &format!("pose {}", pose.name),
                        format!(
                            "puts {} at {angle_rad} rad, outside of its limits {} to {}",
                            rig.description.joint(*joint).name,
                            limits.lower_rad,
                            limits.upper_rad
                        ),
                    ));
                }
            }
        }
        Ok(rig)
    }

    pub(super) fn value(&self, place: &str, what: String) -> RigError {
        RigError::Value { file: self.file.to_owned(), place: place.to_owned(), what: told(&what) }
    }

    fn finite(&self, place: &str, values: &[f64]) -> Result<(), RigError> {
        match values.iter().find(|value| !value.is_finite()) {
            Some(value) => Err(self.value(place, format!("{value} is not a number that can be used"))),
            None => Ok(()),
        }
    }

    /// Refuses numbers that cannot be what they are said to be.
    pub(super) fn plausible(&self, place: &str, quantity: Quantity, values: &[f64]) -> Result<(), RigError> {
        self.finite(place, values)?;
        quantity.check_all(values).map_err(|what| self.value(place, what.to_string()))
    }

    fn unknown(&self, place: &str, error: DescriptionError) -> RigError {
        RigError::Unknown { file: self.file.to_owned(), place: place.to_owned(), error: Box::new(error) }
    }

    fn joint(&self, place: &str, name: &str) -> Result<JointIndex, RigError> {
        self.robot.find_joint(name).map_err(|error| self.unknown(place, error))
    }

    pub(super) fn servo(&self, part: &ServoPart) -> Result<Servo, RigError> {
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
    pub(super) fn servo_problems(&self, part: &ServoPart) -> Vec<RigError> {
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

    fn unique(&self, servos: &[Servo], boards: &[BoardPart]) -> Result<(), RigError> {
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

    pub(super) fn coupled(&self, part: &CoupledPart) -> Result<CoupledLimit, RigError> {
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

    pub(super) fn eyes(&self, part: &EyesPart) -> Result<EyeMount, RigError> {
        let vectors = [
            part.left_position_m,
            part.left_rotation_rad,
            part.right_from_left_rotation_rad,
            part.right_from_left_translation_m,
        ];
        self.finite("eyes", vectors.as_flattened())?;
        let [position, rotation, right_rotation, right_translation] = vectors.map(Vector3::from);
        self.plausible("eyes", plausible::LINK_LENGTH_M, &part.left_position_m)?;
        self.plausible(
            "eyes",
            plausible::ANGLE_RAD,
            &[part.left_rotation_rad, part.right_from_left_rotation_rad].concat(),
        )?;
        self.plausible("eyes", plausible::BASELINE_M, &[right_translation.norm()])?;
        Ok(EyeMount {
            link: self.robot.find_link(&part.link).map_err(|error| self.unknown("eyes", error))?,
            pan: self.joint("eyes", &part.pan)?,
            tilt: self.joint("eyes", &part.tilt)?,
            head_from_left: EyeMount::pose(position, rotation),
            cameras: StereoCameras {
                left: self.lens("eyes.left", &part.left)?,
                right: self.lens("eyes.right", &part.right)?,
                right_from_left: Pose::from_rotation_vector(right_rotation, right_translation),
            },
            calibrated_at: CalibratedAt::default(),
        })
    }

    fn lens(&self, place: &str, part: &LensPart) -> Result<Camera, RigError> {
        self.finite(place, &[part.fx_px, part.fy_px, part.cx_px, part.cy_px, part.skew_px])?;
        self.finite(place, &part.k)?;
        if part.width_px == 0 || part.height_px == 0 || part.fx_px <= 0.0 || part.fy_px <= 0.0 {
            return Err(self.value(place, "image size and focal lengths must be positive".to_owned()));
        }
        let lens = Fisheye {
            fx_px: part.fx_px,
            fy_px: part.fy_px,
            cx_px: part.cx_px,
            cy_px: part.cy_px,
            skew_px: part.skew_px,
            k: part.k,
        };
        let (width_px, height_px) = (part.width_px, part.height_px);
        let camera = Camera { model: CameraModel::Fisheye(lens), width_px, height_px };
        camera.check_plausible().map_err(|what| self.value(place, what.to_string()))?;
        Ok(camera)
    }

    pub(super) fn table(&self, part: &TablePart) -> Result<TableTop, RigError> {
        self.plausible("table", plausible::PLACE_M, &[part.height_m])?;
        self.plausible("table", plausible::PLACE_M, &[part.x_range_m, part.y_range_m].concat())?;
        if part.x_range_m[0] >= part.x_range_m[1] || part.y_range_m[0] >= part.y_range_m[1] {
            return Err(self.value("table", "ranges go from the smaller to the larger value".to_owned()));
        }
        Ok(TableTop { height_m: part.height_m, x_range_m: part.x_range_m, y_range_m: part.y_range_m })
    }

    pub(super) fn work_patch(&self, part: &WorkspacePart) -> Result<WorkPatch, RigError> {
        self.plausible("workspace", plausible::PLACE_M, &[part.headroom_m])?;
        self.plausible("workspace", plausible::PLACE_M, &[part.x_range_m, part.y_range_m].concat())?;
        let rising = part.x_range_m[0] < part.x_range_m[1] && part.y_range_m[0] < part.y_range_m[1];
        if !rising || part.headroom_m <= 0.0 {
            let what = "ranges go from the smaller to the larger value, and the headroom is positive";
            return Err(self.value("workspace", what.to_owned()));
        }
        Ok(WorkPatch { x_range_m: part.x_range_m, y_range_m: part.y_range_m, headroom_m: part.headroom_m })
    }

    pub(super) fn screen(&self, part: &ScreenPart) -> Result<Touchscreen, RigError> {
        let axis = |name: &str, vector: [f64; 3]| {
            Axis::new(Vector3::from(vector))
                .ok_or_else(|| self.value("touchscreen", format!("{name} has no direction")))
        };
        self.plausible("touchscreen", plausible::DIRECTION, &[part.u_axis, part.v_axis].concat())?;
        self.plausible("touchscreen", plausible::SCREEN_PLACE_M, &part.origin_m)?;
        self.finite("touchscreen", &[part.width_m, part.height_m])?;
        let (u_axis, v_axis) = (axis("u_axis", part.u_axis)?, axis("v_axis", part.v_axis)?);
        let sized = part.width_px > 0 && part.height_px > 0 && part.width_m > 0.0 && part.height_m > 0.0;
        if !sized || u_axis.vector().dot(&v_axis.vector()).abs() > 1e-6 {
            return Err(
                self.value("touchscreen", "sizes must be positive and the axes at right angles".to_owned())
            );
        }
        self.plausible("touchscreen", plausible::SCREEN_SIDE_M, &[part.width_m, part.height_m])?;
        let pixels = [f64::from(part.width_px), f64::from(part.height_px)];
        self.plausible("touchscreen", plausible::SCREEN_SIDE_PX, &pixels)?;
        let [x, y, z] = part.origin_m;
        Ok(Touchscreen {
            width_px: part.width_px,
            height_px: part.height_px,
            width_m: part.width_m,
            height_m: part.height_m,
            origin: Point::new(x, y, z),
            u_axis,
            v_axis,
        })
    }

    pub(super) fn arm(&self, part: &ArmPart) -> Result<Arm, RigError> {
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

    pub(super) fn pose(&self, part: &PosePart) -> Result<NamedPose, RigError> {
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

    pub(super) fn gate(&self, p: &GatePart) -> Result<Gate, RigError> {
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
