//! `session.toml`: what was measured with what, and when.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use nalgebra::Vector3;

use super::document;
use super::error::SessionError;
use super::eyes_setup;
use super::pose_setup::PoseSetup;
use crate::formats::node::Field;
use crate::formats::{FormatError, text_file};
use crate::frame::{Direction, Point, Robot};
use crate::plausible;

/// Version of the session format.
const FORMAT: usize = 1;
/// Sections of the manifest and the keys that the format defines in them.
const SECTIONS: [(&str, &[&str]); 2] = [
    ("touchscreen", &["width_px", "height_px", "width_m", "height_m", "origin_m", "u_axis", "v_axis"]),
    ("chain", &["tip", "joints"]),
];
/// u and v axes may miss the right angle by this (sine).
const SQUARE_TOLERANCE: f64 = 0.02;

/// Which rig was measured.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RigReference {
    /// A rig that the program knows, such as "nico".
    Named(String),
    /// A rig file, relative to the session folder.
    File(PathBuf),
}

/// The touchscreen and where it nominally lies.
#[derive(Clone, Debug)]
pub struct Touchscreen {
    /// Pixels across.
    pub width_px: u32,
    /// Pixels down.
    pub height_px: u32,
    /// Visible width, m.
    pub width_m: f64,
    /// Visible height, m.
    pub height_m: f64,
    /// Outer corner of pixel (0, 0).
    pub origin: Point<Robot>,
    /// Direction of growing u.
    pub u_axis: Direction<Robot>,
    /// Direction of growing v.
    pub v_axis: Direction<Robot>,
}

/// The joints that moved and the frame that they moved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chain {
    /// A frame of the rig.
    pub tip: String,
    /// Joints from base to tip.
    pub joints: Vec<String>,
}

/// The manifest of a session.
#[derive(Clone, Debug, PartialEq)]
pub struct Manifest {
    /// Which rig.
    pub rig: RigReference,
    /// When the session started.
    pub started: jiff::Timestamp,
    /// Who measured; free text.
    pub operator: String,
    /// Free text.
    pub notes: String,
    /// Needed with touches.
    pub touchscreen: Option<Touchscreen>,
    /// Needed with touches and poses.
    pub chain: Option<Chain>,
    /// Keys that the format does not define, kept for writing.
    pub extra: toml::Table,
}

impl PartialEq for Touchscreen {
    fn eq(&self, other: &Self) -> bool {
        let key = |screen: &Self| {
            let size = (screen.width_px, screen.height_px, screen.width_m, screen.height_m);
            (size, screen.origin.coords, screen.u_axis.vector(), screen.v_axis.vector())
        };
        key(self) == key(other)
    }
}

impl Manifest {
    /// With nothing but the rig, by the name that the program knows it by, and when it began.
    pub fn of_rig(name: impl Into<String>, started: jiff::Timestamp) -> Self {
        Self {
            rig: RigReference::Named(name.into()),
            started,
            operator: String::new(),
            notes: String::new(),
            touchscreen: None,
            chain: None,
            extra: toml::Table::new(),
        }
    }

    /// Reads `session.toml`. Comments are not kept.
    pub fn read(file: &Path) -> Result<Self, FormatError> {
        Self::parse(file, &text_file::read(file)?)
    }

    fn parse(file: &Path, text: &str) -> Result<Self, FormatError> {
        let node = document::parse(file, text)?;
        let root = Field::root(file, &node);
        let format = root.get("format")?;
        if format.count()? != FORMAT {
            return Err(format.out_of_range(format!(
                "{FORMAT}, the version that this program knows (a newer program may be needed)"
            )));
        }
        let text_or_empty = |key: &str| -> Result<String, FormatError> {
            Ok(root.find(key)?.map(|field| field.text()).transpose()?.unwrap_or_default())
        };
        PoseSetup::read(&root)?;
        eyes_setup::check(&root)?;
        Ok(Self {
            rig: rig(&root)?,
            started: root.get("started")?.timestamp()?,
            operator: text_or_empty("operator")?,
            notes: text_or_empty("notes")?,
            touchscreen: root.find("touchscreen")?.map(|field| touchscreen(&field)).transpose()?,
            chain: root.find("chain")?.map(|field| chain(&field)).transpose()?,
            extra: extra_keys(file, text)?,
        })
    }

    /// Writes `session.toml` in one step.
    pub fn write(&self, file: &Path) -> Result<(), SessionError> {
        let text = self.render();
        // What cannot be read again (an empty chain, say) must not replace what could.
        Self::parse(file, &text)?;
        Ok(text_file::write(file, &text)?)
    }

    /// The chain, or an error that the table needs one.
    pub(crate) fn chain_for(&self, table: &Path) -> Result<&Chain, SessionError> {
        self.chain
            .as_ref()
            .ok_or_else(|| SessionError::NeedsSection { table: table.to_path_buf(), section: "chain" })
    }

    /// The touchscreen, or an error that the table needs one.
    pub(crate) fn touchscreen_for(&self, table: &Path) -> Result<&Touchscreen, SessionError> {
        self.touchscreen
            .as_ref()
            .ok_or_else(|| SessionError::NeedsSection { table: table.to_path_buf(), section: "touchscreen" })
    }

    fn render(&self) -> String {
        let text = |value: &str| toml::Value::from(value).to_string();
        let mut out = format!("format = {FORMAT}\n");
        out += &match &self.rig {
            RigReference::Named(name) => format!("rig = {}\n", text(name)),
            RigReference::File(path) => format!("rig_file = {}\n", text(&path.to_string_lossy())),
        };
        out += &format!("started = {}\n", self.started);
        out += &format!("operator = {}\nnotes = {}\n", text(&self.operator), text(&self.notes));
        // Values stand before the first section, unknown sections after the last known one.
        let is_section = |entry: &(&String, &toml::Value)| entry.1.is_table();
        for (key, value) in self.extra.iter().filter(|entry| !is_section(entry)) {
            out += &line(key, value);
        }
        if let Some(screen) = &self.touchscreen {
            out += &render_touchscreen(screen);
            out += &self.extra_of("touchscreen");
        }
        if let Some(chain) = &self.chain {
            let joints: toml::Value = chain.joints.clone().into();
            out += &format!("\n[chain]\ntip = {}\njoints = {joints}\n", text(&chain.tip));
            out += &self.extra_of("chain");
        }
        let unknown = |entry: &(&String, &toml::Value)| SECTIONS.iter().all(|(name, _)| name != entry.0);
        let sections: toml::Table = self
            .extra
            .iter()
            .filter(|entry| is_section(entry) && unknown(entry))
            .map(|(key, value)| (key.clone(), value.clone()))
            .collect();
        if !sections.is_empty() {
            out += &format!("\n{sections}");
        }
        out
    }

    /// Unknown keys of a known section.
    fn extra_of(&self, section: &str) -> String {
        let entries = self.extra.get(section).and_then(toml::Value::as_table);
        entries.into_iter().flatten().map(|(key, value)| line(key, value)).collect()
    }
}

/// `key = value`, with the key in quotes since it may hold anything.
fn line(key: &str, value: &toml::Value) -> String {
    format!("{} = {value}\n", toml::Value::from(key))
}

fn render_touchscreen(screen: &Touchscreen) -> String {
    let list = |vector: Vector3<f64>| format!("[{:?}, {:?}, {:?}]", vector.x, vector.y, vector.z);
    format!(
        "\n[touchscreen]\nwidth_px = {}\nheight_px = {}\nwidth_m = {:?}\nheight_m = {:?}\norigin_m = {}\nu_axis = {}\nv_axis = {}\n",
        screen.width_px,
        screen.height_px,
        screen.width_m,
        screen.height_m,
        list(screen.origin.coords.coords),
        list(screen.u_axis.vector()),
        list(screen.v_axis.vector()),
    )
}

fn rig(root: &Field<'_>) -> Result<RigReference, FormatError> {
    match (root.find("rig")?, root.find("rig_file")?) {
        (Some(name), None) => Ok(RigReference::Named(name.text()?)),
        (None, Some(path)) => Ok(RigReference::File(PathBuf::from(path.text()?))),
        (Some(_), Some(path)) => Err(path.out_of_range("absent, because rig is given too")),
        (None, None) => match root.get("rig") {
            Err(FormatError::Missing { place, .. }) => {
                Err(FormatError::Missing { place, or: vec!["rig_file".to_owned()] })
            }
            Err(other) => Err(other),
            Ok(name) => Ok(RigReference::Named(name.text()?)),
        },
    }
}

fn touchscreen(field: &Field<'_>) -> Result<Touchscreen, FormatError> {
    let [x, y, z] = field.get("origin_m")?.each_of(plausible::SCREEN_PLACE_M)?.exactly()?;
    let axis = |key: &str| {
        let axis = field.get(key)?.each_of(plausible::DIRECTION)?;
        let direction = Direction::<Robot>::new(Vector3::from(axis.exactly::<3>()?));
        direction.ok_or_else(|| axis.out_of_range("a direction that is not zero"))
    };
    let (u_axis, v_axis) = (axis("u_axis")?, axis("v_axis")?);
    if u_axis.vector().dot(&v_axis.vector()).abs() > SQUARE_TOLERANCE {
        return Err(field.get("v_axis")?.out_of_range("at a right angle to u_axis"));
    }
    Ok(Touchscreen {
        width_px: field.get("width_px")?.of(plausible::SCREEN_SIDE_PX)?.pixels()?,
        height_px: field.get("height_px")?.of(plausible::SCREEN_SIDE_PX)?.pixels()?,
        width_m: field.get("width_m")?.of(plausible::SCREEN_SIDE_M)?.positive()?,
        height_m: field.get("height_m")?.of(plausible::SCREEN_SIDE_M)?.positive()?,
        origin: Point::new(x, y, z),
        u_axis,
        v_axis,
    })
}

fn chain(field: &Field<'_>) -> Result<Chain, FormatError> {
    let list = field.get("joints")?;
    let joints: Vec<String> = list.items()?.map(|item| item.text()).collect::<Result<_, _>>()?;
    if joints.is_empty() {
        return Err(list.out_of_range("at least one joint"));
    }
    let mut seen = HashSet::new();
    for (joint, item) in joints.iter().zip(list.items()?) {
        if joint.is_empty() || !seen.insert(joint) {
            return Err(item.out_of_range("the name of a joint that is not in the list yet"));
        }
    }
    Ok(Chain { tip: field.get("tip")?.text()?, joints })
}

/// The document without the keys that [`Manifest`] holds.
fn extra_keys(file: &Path, text: &str) -> Result<toml::Table, FormatError> {
    let mut table: toml::Table =
        toml::from_str(text).map_err(|error| document::syntax(file, text, &error))?;
    for known in ["format", "rig", "rig_file", "started", "operator", "notes"] {
        table.remove(known);
    }
    for (name, keys) in SECTIONS {
        let Some(toml::Value::Table(section)) = table.get_mut(name) else { continue };
        section.retain(|key, _| !keys.contains(&key));
        if section.is_empty() {
            table.remove(name);
        }
    }
    Ok(table)
}
