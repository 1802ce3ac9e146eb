//! `plumbline rig check` and `plumbline rig export`: is a rig file sound; the robot with its effects for
//! other programs.

#[cfg(test)]
mod tests;

use std::fmt;
use std::path::{Path, PathBuf};

use plumbline_effects::RigModel;
use plumbline_effects::rig_model::LeftOut;
use plumbline_model::robot::{Description, Problem, Rig};
use plumbline_model::{JobContext, files};
use serde::{Deserialize, Serialize};

use super::OfflineError;
use super::ik::find_rig;

/// What was found of a rig file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RigCheckReport {
    /// The file.
    pub file: PathBuf,
    /// Whether it can be used as it is.
    pub ok: bool,
    /// All that is wrong with it and with the description that it names.
    pub problems: Vec<Problem>,
}

/// Checks a rig file.
///
/// # Errors
/// When the file cannot be read.
pub fn rig_check(file: &Path) -> Result<RigCheckReport, OfflineError> {
    let problems = Rig::check(file)?;
    Ok(RigCheckReport { file: file.to_owned(), ok: problems.is_empty(), problems })
}

/// A format that other programs read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RigFormat {
    /// The description of ROS: the text of the rig's own URDF with other origins.
    Urdf,
    /// The model of MuJoCo.
    Mjcf,
}

impl fmt::Display for RigFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Urdf => "URDF",
            Self::Mjcf => "MJCF",
        })
    }
}

/// What to write.
#[derive(Clone, Debug)]
pub struct RigExportArgs {
    /// Name of a rig that comes with the program, or the path of a rig file.
    pub rig: String,
    /// Effects; `None`: the robot as described.
    pub rig_model: Option<PathBuf>,
    /// In which format.
    pub format: RigFormat,
    /// Where to.
    pub out: PathBuf,
}

/// What was written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RigExportReport {
    /// The file.
    pub out: PathBuf,
    /// Its format.
    pub format: RigFormat,
    /// Effects that are in it, as `id@site`.
    pub inside: Vec<String>,
    /// Effects that are not, each with the reason; and meshes, which MJCF does not get.
    pub left_out: Vec<LeftOut>,
}

/// Writes the robot with its effects for other programs.
///
/// # Errors
/// When the rig or its effects cannot be read, its description cannot hold them, or the file cannot be
/// written.
pub fn rig_export(args: &RigExportArgs, context: &dyn JobContext) -> Result<RigExportReport, OfflineError> {
    let rig = find_rig(&args.rig)?;
    let (rig_files, urdf) = urdf_of(&args.rig)?;
    let mut inputs: Vec<&Path> = rig_files.iter().map(PathBuf::as_path).collect();
    inputs.extend(args.rig_model.as_deref());
    files::output(&args.out, &inputs)?;
    let model = match &args.rig_model {
        Some(file) => RigModel::read(file, &rig)?,
        None => RigModel::nominal(&rig),
    };
    context.checkpoint()?;
    let mut exported = model.urdf_with(&rig, &urdf)?;
    let text = match args.format {
        RigFormat::Urdf => exported.urdf,
        RigFormat::Mjcf => {
            if urdf.contains("<mesh") {
                let reason = "shapes from files are not copied; boxes, balls, cylinders and capsules are";
                exported.left_out.push(LeftOut { effect: "meshes".to_owned(), reason: reason.to_owned() });
            }
            Description::from_urdf(&exported.urdf)?.to_mjcf()
        }
    };
    files::write(&args.out, text)?;
    Ok(RigExportReport {
        out: args.out.clone(),
        format: args.format,
        inside: exported.inside,
        left_out: exported.left_out,
    })
}

/// The files of a rig, and the text of its description.
fn urdf_of(rig: &str) -> Result<(Vec<PathBuf>, String), OfflineError> {
    if let Some([_, urdf]) = Rig::built_in_files(rig) {
        return Ok((vec![], urdf.to_owned()));
    }
    let file = PathBuf::from(rig);
    let mut description = file.clone();
    description.set_file_name(Rig::description_of(&file)?);
    let urdf = files::read_text(&description, files::Size::TEXT)?;
    Ok((vec![file, description], urdf))
}
