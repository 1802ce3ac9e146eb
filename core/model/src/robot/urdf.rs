//! Reads URDF (XML robot description, as used by ROS) into a checked [`Description`].

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Isometry3, Matrix3, Translation3, Unit, UnitQuaternion, Vector3};
use urdf_rs::{Geometry, JointType};

use super::description::{
    Description, Inertia, Joint, JointIndex, JointKind, Limits, Link, LinkIndex, Mimic, Shape, Slide, Visual,
};
use super::error::DescriptionError as Error;
use crate::files::told;
use crate::formats::depth;
use crate::plausible::{self, Implausible};

impl Description {
    /// Reads the text of a URDF file. Meshes are left out; boxes, balls, cylinders and capsules
    /// are kept.
    ///
    /// # Errors
    /// When it is no URDF, when links form a loop or do not hang together, when a moving joint has
    /// no limits, when a name occurs twice or is not known, when a number is not finite.
    pub fn from_urdf(text: &str) -> Result<Self, Error> {
        Self::from_robot(&parse(text)?)
    }

    /// Reads the text of a URDF file of a robot that is only measured: what such work does not
    /// need may be missing. Joints without usable limits turn half a turn to either side, so do
    /// continuous ones; joints that slide or copy an unknown joint are held at zero
    /// ([`Self::held_kind`]); shapes are left out. Also tells whether limits were missing.
    ///
    /// # Errors
    /// As [`Self::from_urdf`], for what is left.
    pub fn from_urdf_measured(text: &str) -> Result<(Self, bool), Error> {
        let mut robot = parse(text)?;
        let slides = sliding(&robot)?;
        let (held, unlimited) = relax(&mut robot);
        let mut description = Self::from_robot(&robot)?;
        description.held = held;
        description.slides = slides;
        Ok((description, unlimited))
    }

    fn from_robot(robot: &urdf_rs::Robot) -> Result<Self, Error> {
        robot.joints.iter().try_for_each(check_joint)?;
        robot.links.iter().try_for_each(check_link)?;
        unique("link", robot.links.iter().map(|link| &link.name))?;
        unique("joint", robot.joints.iter().map(|joint| &joint.name))?;
        let order = Order::of(robot)?;
        let colors = robot
            .materials
            .iter()
            .filter_map(|material| Some((material.name.as_str(), material.color.as_ref()?.rgba.0)))
            .collect();
        let links = order
            .links
            .iter()
            .map(|(link, _)| read_link(&robot.links[*link], &colors))
            .collect::<Result<Vec<_>, _>>()?;
        let mut description = Self {
            name: robot.name.clone(),
            links,
            joints: vec![],
            movable: vec![],
            held: vec![],
            slides: vec![],
        };
        description.add_joints(robot, &order)?;
        Ok(description)
    }

    fn add_joints(&mut self, robot: &urdf_rs::Robot, order: &Order) -> Result<(), Error> {
        // Joints that move by themselves are numbered first: others may follow one that comes later.
        let carrying = || order.links.iter().filter_map(|(_, joint)| *joint).map(|j| &robot.joints[j]);
        let mut indices = BTreeMap::new();
        for joint in carrying().filter(|joint| moves(joint) && joint.mimic.is_none()) {
            indices.insert(joint.name.as_str(), JointIndex(indices.len()));
        }
        for (place, joint) in carrying().enumerate() {
            let child = LinkIndex(place + 1);
            let parent = self.find_link(&joint.parent.link)?;
            self.links[child.0].parent = Some(parent);
            let kind = read_kind(joint, &indices)?;
            if let JointKind::Revolute { .. } = kind {
                self.movable.push(place);
            }
            let parent_from_joint = read_pose(&joint.origin, &joint.name)?;
            self.joints.push(Joint { name: joint.name.clone(), parent, child, parent_from_joint, kind });
        }
        Ok(())
    }
}

pub(super) fn parse(text: &str) -> Result<urdf_rs::Robot, Error> {
    // The library works its way down by calling itself.
    depth::check(depth::of_xml(text)).map_err(|reason| Error::NotUrdf { reason })?;
    urdf_rs::read_from_string(text).map_err(|error| Error::NotUrdf { reason: told(&error.to_string()) })
}

/// Refuses a joint whose numbers cannot be.
pub(super) fn check_joint(joint: &urdf_rs::Joint) -> Result<(), Error> {
    let refuse = |what: Implausible| Error::Implausible {
        place: format!("joint {}", joint.name),
        what: Box::new(what),
    };
    check_origin(&joint.origin).map_err(refuse)?;
    if !moves(joint) {
        return Ok(());
    }
    // Largest first: the length of a vector of wild components is not finite.
    let axis = Vector3::from(joint.axis.xyz.0);
    if axis.iter().all(|component| component.is_finite()) && axis.amax() > 0.0 {
        plausible::AXIS.check(axis.amax()).map_err(refuse)?;
    }
    let limits = [joint.limit.lower, joint.limit.upper];
    plausible::JOINT_LIMIT_RAD.check_all(limits.iter().filter(|limit| limit.is_finite())).map_err(refuse)?;
    if let Some(mimic) = &joint.mimic {
        let (ratio, offset) = (mimic.multiplier.unwrap_or(1.0), mimic.offset.unwrap_or(0.0));
        plausible::RATIO.check(ratio).and_then(|()| plausible::ANGLE_RAD.check(offset)).map_err(refuse)?;
    }
    Ok(())
}

/// Refuses a link whose numbers cannot be.
pub(super) fn check_link(link: &urdf_rs::Link) -> Result<(), Error> {
    let refuse =
        |what: Implausible| Error::Implausible { place: format!("link {}", link.name), what: Box::new(what) };
    check_origin(&link.inertial.origin).map_err(refuse)?;
    check_inertial(&link.inertial).map_err(refuse)?;
    link.visual.iter().try_for_each(|visual| check_origin(&visual.origin)).map_err(refuse)?;
    link.collision.iter().try_for_each(|collision| check_origin(&collision.origin)).map_err(refuse)
}

fn check_origin(origin: &urdf_rs::Pose) -> Result<(), Implausible> {
    plausible::LINK_LENGTH_M.check_all(&origin.xyz.0)?;
    plausible::ANGLE_RAD.check_all(&origin.rpy.0)
}

fn check_inertial(inertial: &urdf_rs::Inertial) -> Result<(), Implausible> {
    let i = &inertial.inertia;
    plausible::LINK_MASS_KG.check(inertial.mass.value)?;
    plausible::INERTIA_KGM2.check_all(&[i.ixx, i.ixy, i.ixz, i.iyy, i.iyz, i.izz])
}

/// Joints that slide by themselves, and along which direction.
fn sliding(robot: &urdf_rs::Robot) -> Result<Vec<Slide>, Error> {
    let own =
        |joint: &&urdf_rs::Joint| matches!(joint.joint_type, JointType::Prismatic) && joint.mimic.is_none();
    let read = |joint: &urdf_rs::Joint| Ok(Slide { joint: joint.name.clone(), axis: axis_of(joint)? });
    robot.joints.iter().filter(own).map(read).collect()
}

/// Makes of a robot what can be measured: see [`Description::from_urdf_measured`]. The joints that
/// are held with the kind of their motion, and whether limits were missing.
fn relax(robot: &mut urdf_rs::Robot) -> (Vec<(String, String)>, bool) {
    let turns = |joint: &urdf_rs::Joint| {
        matches!(joint.joint_type, JointType::Revolute | JointType::Continuous) && joint.mimic.is_none()
    };
    let sources: BTreeSet<String> =
        robot.joints.iter().filter(|joint| turns(joint)).map(|joint| joint.name.clone()).collect();
    let (mut held, mut unlimited) = (vec![], false);
    for joint in &mut robot.joints {
        let follows = joint.mimic.as_ref().is_some_and(|mimic| !sources.contains(&mimic.joint));
        match joint.joint_type {
            JointType::Fixed => {}
            JointType::Revolute | JointType::Continuous if !follows => {
                let limit = &mut joint.limit;
                // Some write a joint without limits with limits beyond all measure.
                let can_be = |limit: f64| plausible::JOINT_LIMIT_RAD.contains(limit);
                let usable = limit.lower < limit.upper && can_be(limit.lower) && can_be(limit.upper);
                if !usable || matches!(joint.joint_type, JointType::Continuous) {
                    unlimited = true;
                    (limit.lower, limit.upper) = (-std::f64::consts::PI, std::f64::consts::PI);
                }
                joint.joint_type = JointType::Revolute;
            }
            _ => {
                held.push((joint.name.clone(), format!("{:?}", joint.joint_type).to_lowercase()));
                joint.joint_type = JointType::Fixed;
                joint.mimic = None;
            }
        }
    }
    for link in &mut robot.links {
        link.visual.clear();
        link.collision.clear();
        // A mass that is no mass is one that is not known.
        if check_inertial(&link.inertial).and_then(|()| check_origin(&link.inertial.origin)).is_err() {
            link.inertial = urdf_rs::Inertial::default();
        }
    }
    (held, unlimited)
}

/// Links in an order in which parents come first, with the joint that carries each.
struct Order {
    links: Vec<(usize, Option<usize>)>,
}

impl Order {
    fn of(robot: &urdf_rs::Robot) -> Result<Self, Error> {
        let number: BTreeMap<&str, usize> =
            robot.links.iter().enumerate().map(|(i, link)| (link.name.as_str(), i)).collect();
        let find = |joint: &urdf_rs::Joint, link: &str| {
            let unknown = || Error::UnknownLink { joint: joint.name.clone(), link: link.to_owned() };
            number.get(link).copied().ok_or_else(unknown)
        };
        let mut above: Vec<Option<usize>> = vec![None; robot.links.len()];
        let mut below: Vec<Vec<usize>> = vec![vec![]; robot.links.len()];
        for (j, joint) in robot.joints.iter().enumerate() {
            let (parent, child) = (find(joint, &joint.parent.link)?, find(joint, &joint.child.link)?);
            if let Some(other) = above[child] {
                return Err(Error::Loop {
                    link: joint.child.link.clone(),
                    first: robot.joints[other].name.clone(),
                    second: joint.name.clone(),
                });
            }
            above[child] = Some(j);
            below[parent].push(j);
        }
        let roots: Vec<usize> = (0..robot.links.len()).filter(|link| above[*link].is_none()).collect();
        let [root] = roots[..] else {
            let names: Vec<&str> = roots.iter().map(|link| robot.links[*link].name.as_str()).collect();
            let roots = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            return Err(Error::Roots { roots });
        };
        let mut links = vec![(root, None)];
        let mut next = 0;
        while next < links.len() {
            let parent = links[next].0;
            for joint in &below[parent] {
                links.push((number[robot.joints[*joint].child.link.as_str()], Some(*joint)));
            }
            next += 1;
        }
        if links.len() < robot.links.len() {
            // What the one root does not reach has a parent each, so it goes round.
            let reached: BTreeSet<usize> = links.iter().map(|(link, _)| *link).collect();
            let around = (0..robot.links.len()).find(|link| !reached.contains(link)).unwrap_or(root);
            let joint = above[around].map(|j| robot.joints[j].name.clone()).unwrap_or_default();
            return Err(Error::Loop {
                link: robot.links[around].name.clone(),
                first: joint.clone(),
                second: joint,
            });
        }
        Ok(Self { links })
    }
}

fn moves(joint: &urdf_rs::Joint) -> bool {
    !matches!(joint.joint_type, JointType::Fixed)
}

fn axis_of(joint: &urdf_rs::Joint) -> Result<Unit<Vector3<f64>>, Error> {
    Unit::try_new(Vector3::from(joint.axis.xyz.0), 1e-9)
        .filter(|axis| axis.iter().all(|c| c.is_finite()))
        .ok_or_else(|| Error::Number {
            place: format!("joint {}", joint.name),
            what: "its axis has no direction".to_owned(),
        })
}

fn read_kind(joint: &urdf_rs::Joint, indices: &BTreeMap<&str, JointIndex>) -> Result<JointKind, Error> {
    match joint.joint_type {
        JointType::Fixed => return Ok(JointKind::Fixed),
        JointType::Revolute => {}
        ref other => {
            return Err(Error::Kind { joint: joint.name.clone(), kind: format!("{other:?}").to_lowercase() });
        }
    }
    let number = |what: &str| Error::Number { place: format!("joint {}", joint.name), what: what.to_owned() };
    let axis = axis_of(joint)?;
    let (lower, upper) = (joint.limit.lower, joint.limit.upper);
    // Also catches NaN; URDF without limits reads as 0 to 0.
    if !(lower < upper && lower.is_finite() && upper.is_finite()) {
        return Err(Error::Limits { joint: joint.name.clone(), lower, upper });
    }
    let limits = Limits { lower_rad: lower, upper_rad: upper };
    let Some(mimic) = &joint.mimic else {
        return Ok(JointKind::Revolute { axis, limits, index: indices[joint.name.as_str()] });
    };
    let source = indices
        .get(mimic.joint.as_str())
        .ok_or_else(|| Error::Mimic { joint: joint.name.clone(), source_joint: mimic.joint.clone() })?;
    let (ratio, offset_rad) = (mimic.multiplier.unwrap_or(1.0), mimic.offset.unwrap_or(0.0));
    if !(ratio.is_finite() && offset_rad.is_finite()) {
        return Err(number("the joint it copies is given with a factor that is not finite"));
    }
    Ok(JointKind::Coupled { axis, limits, mimic: Mimic { source: *source, ratio, offset_rad } })
}

pub(super) fn read_link(link: &urdf_rs::Link, colors: &BTreeMap<&str, [f64; 4]>) -> Result<Link, Error> {
    let mass_kg = link.inertial.mass.value;
    let i = &link.inertial.inertia;
    let tensor = Matrix3::new(i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz);
    if !(mass_kg.is_finite() && mass_kg >= 0.0 && tensor.iter().all(|v| v.is_finite())) {
        return Err(Error::Number {
            place: format!("link {}", link.name),
            what: "mass or inertia is negative or not finite".to_owned(),
        });
    }
    let origin = read_pose(&link.inertial.origin, &link.name)?;
    let turn = origin.rotation.to_rotation_matrix().into_inner();
    let inertia = (mass_kg > 0.0).then(|| Inertia {
        mass_kg,
        center_m: origin.translation.vector,
        tensor_kgm2: turn * tensor * turn.transpose(),
    });
    let color = |material: &Option<urdf_rs::Material>| {
        let material = material.as_ref()?;
        let own = material.color.as_ref().map(|color| color.rgba.0);
        own.or_else(|| colors.get(material.name.as_str()).copied())
    };
    let mut visuals = vec![];
    for visual in &link.visual {
        visuals.extend(read_shape(&visual.origin, &visual.geometry, color(&visual.material), &link.name)?);
    }
    let mut collisions = vec![];
    for collision in &link.collision {
        collisions.extend(read_shape(&collision.origin, &collision.geometry, None, &link.name)?);
    }
    Ok(Link { name: link.name.clone(), parent: None, inertia, visuals, collisions })
}

fn read_shape(
    origin: &urdf_rs::Pose,
    geometry: &Geometry,
    rgba: Option<[f64; 4]>,
    link: &str,
) -> Result<Option<Visual>, Error> {
    let shape = match geometry {
        Geometry::Box { size } => Shape::Box { half_m: Vector3::from(size.0) * 0.5 },
        Geometry::Sphere { radius } => Shape::Sphere { radius_m: *radius },
        Geometry::Cylinder { radius, length } => {
            Shape::Cylinder { radius_m: *radius, half_length_m: 0.5 * length }
        }
        Geometry::Capsule { radius, length } => {
            Shape::Capsule { radius_m: *radius, half_length_m: 0.5 * length }
        }
        Geometry::Mesh { .. } => return Ok(None),
    };
    let sizes = match shape {
        Shape::Box { half_m } => vec![half_m.x, half_m.y, half_m.z],
        Shape::Sphere { radius_m } => vec![radius_m],
        Shape::Cylinder { radius_m, half_length_m } | Shape::Capsule { radius_m, half_length_m } => {
            vec![radius_m, half_length_m]
        }
    };
    if sizes.iter().any(|size| !(size.is_finite() && *size > 0.0)) {
        return Err(Error::Number {
            place: format!("link {link}"),
            what: format!("a shape has the size {sizes:?}"),
        });
    }
    let rgba = rgba.unwrap_or([0.7, 0.7, 0.7, 1.0]).map(|c| c as f32);
    Ok(Some(Visual { link_from_shape: read_pose(origin, link)?, shape, rgba }))
}

fn read_pose(pose: &urdf_rs::Pose, place: &str) -> Result<Isometry3<f64>, Error> {
    let ([x, y, z], [roll, pitch, yaw]) = (pose.xyz.0, pose.rpy.0);
    if ![x, y, z, roll, pitch, yaw].iter().all(|v| v.is_finite()) {
        return Err(Error::Number {
            place: place.to_owned(),
            what: "an origin that is not finite".to_owned(),
        });
    }
    // URDF angles are about fixed axes: R = Rz(yaw) Ry(pitch) Rx(roll), as nalgebra's.
    Ok(Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_euler_angles(roll, pitch, yaw)))
}

fn unique<'a>(what: &'static str, names: impl Iterator<Item = &'a String>) -> Result<(), Error> {
    let mut seen = BTreeSet::new();
    for name in names {
        if !seen.insert(name) {
            return Err(Error::Twice { what, name: name.clone() });
        }
    }
    Ok(())
}
