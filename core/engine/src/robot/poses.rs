//! The operator's own poses: a small file in the data folder.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use plumbline_model::robot::{JointIndex, Rig};
use serde::{Deserialize, Serialize};

use crate::view::PoseView;

/// Poses of the rig and the operator's own.
#[derive(Clone, Debug)]
pub struct PoseLibrary {
    file: PathBuf,
    own: Vec<PoseView>,
}

#[derive(Debug, Default, Serialize, Deserialize)]
struct File {
    #[serde(default)]
    pose: Vec<Entry>,
}

#[derive(Debug, Serialize, Deserialize)]
struct Entry {
    title: String,
    /// Joint names and their angles, rad.
    joints_rad: BTreeMap<String, f64>,
}

impl PoseLibrary {
    /// Reads what was saved for this rig; gives a sentence about what could not be read.
    pub fn read(data_dir: &Path, rig: &Rig) -> (Self, Option<String>) {
        let file = data_dir.join("poses").join(format!("{}.toml", rig.name));
        let mut library = Self { file: file.clone(), own: Vec::new() };
        let problem = match std::fs::read_to_string(&file) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => None,
            Err(error) => Some(error.to_string()),
            Ok(text) => match toml::from_str::<File>(&text) {
                Ok(entries) => library.take(entries, rig).err(),
                Err(error) => Some(error.to_string()),
            },
        };
        let problem = problem.map(|reason| {
            format!(
                "Your saved poses in {} cannot be used: {reason}. They were left out, the file is untouched.",
                file.display()
            )
        });
        (library, problem)
    }

    fn take(&mut self, file: File, rig: &Rig) -> Result<(), String> {
        let mut own = vec![];
        for entry in file.pose {
            let joint = |(name, angle_rad): (&String, &f64)| {
                let joint = rig.description.find_joint(name).map_err(|error| error.to_string())?;
                if rig.limits(joint).contain(*angle_rad) {
                    Ok((joint, *angle_rad))
                } else {
                    Err(format!("{} puts {name} at {angle_rad} rad, outside of its limits", entry.title))
                }
            };
            let joints = entry.joints_rad.iter().map(joint).collect::<Result<_, String>>()?;
            own.push(pose(own.len(), entry.title.clone(), joints));
        }
        self.own = own;
        Ok(())
    }

    /// All poses, the rig's first.
    pub fn all(&self, rig: &Rig) -> Vec<PoseView> {
        let of_rig = rig.poses.iter().map(|pose| PoseView {
            name: pose.name.clone(),
            title: pose.title.clone(),
            about: pose.about.clone(),
            joints: pose.joints.clone(),
            own: false,
        });
        of_rig.chain(self.own.iter().cloned()).collect()
    }

    /// Adds a pose and writes the file.
    pub fn save(&mut self, title: &str, joints: Vec<(JointIndex, f64)>, rig: &Rig) -> Result<(), String> {
        let title = title.trim();
        if title.is_empty() {
            return Err("A pose needs a name.".to_owned());
        }
        if self.all(rig).iter().any(|pose| pose.title == title) {
            return Err(format!("There is a pose called {title} already. Choose another name."));
        }
        self.own.push(pose(self.own.len(), title.to_owned(), joints));
        self.write(rig).inspect_err(|_| {
            self.own.pop();
        })
    }

    /// Removes one of the operator's own poses and writes the file.
    pub fn delete(&mut self, name: &str, rig: &Rig) -> Result<(), String> {
        let place = self.own.iter().position(|pose| pose.name == name);
        let place = place.ok_or_else(|| format!("{name} is not one of your own poses."))?;
        let removed = self.own.remove(place);
        self.write(rig).inspect_err(|_| self.own.insert(place, removed))
    }

    fn write(&self, rig: &Rig) -> Result<(), String> {
        let name = |joint: JointIndex| rig.description.joint(joint).name.clone();
        let entry = |pose: &PoseView| Entry {
            title: pose.title.clone(),
            joints_rad: pose.joints.iter().map(|(joint, angle)| (name(*joint), *angle)).collect(),
        };
        let file = File { pose: self.own.iter().map(entry).collect() };
        let write = || -> Result<(), String> {
            let text = toml::to_string_pretty(&file).map_err(|error| error.to_string())?;
            let folder = self.file.parent().unwrap_or(Path::new("."));
            std::fs::create_dir_all(folder).map_err(|error| error.to_string())?;
            let part = self.file.with_extension("toml.part");
            std::fs::write(&part, text).map_err(|error| error.to_string())?;
            std::fs::rename(&part, &self.file).map_err(|error| error.to_string())
        };
        write().map_err(|reason| format!("The poses cannot be saved in {}: {reason}.", self.file.display()))
    }
}

fn pose(number: usize, title: String, joints: Vec<(JointIndex, f64)>) -> PoseView {
    PoseView {
        name: format!("own-{}", number + 1),
        title,
        about: "Saved by you.".to_owned(),
        joints,
        own: true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rig() -> Rig {
        Rig::built_in("nico").expect("the rig that comes with the program")
    }

    #[test]
    fn a_saved_pose_is_there_after_a_restart() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let rig = rig();
        let (mut library, problem) = PoseLibrary::read(folder.path(), &rig);
        assert_eq!(problem, None);
        let elbow = rig.description.find_joint("r_elbow_y").expect("a joint of NICO");
        library.save("Above the cup", vec![(elbow, 1.5)], &rig).expect("it can be written");
        let (again, problem) = PoseLibrary::read(folder.path(), &rig);
        assert_eq!(problem, None);
        let found =
            again.all(&rig).into_iter().find(|pose| pose.title == "Above the cup").expect("it is there");
        assert!(found.own);
        assert_eq!(found.joints, vec![(elbow, 1.5)]);
        library.delete(&found.name, &rig).expect("it can be deleted");
        assert!(PoseLibrary::read(folder.path(), &rig).0.all(&rig).iter().all(|pose| !pose.own));
    }

    #[test]
    fn names_are_needed_and_unique() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let rig = rig();
        let (mut library, _) = PoseLibrary::read(folder.path(), &rig);
        assert!(library.save("  ", vec![], &rig).is_err());
        assert!(library.save("Home", vec![], &rig).is_err(), "the rig has one of that name");
        assert!(library.delete("home", &rig).is_err(), "the rig's poses stay");
    }

    #[test]
    fn a_broken_file_is_told_and_left_alone() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let rig = rig();
        std::fs::create_dir_all(folder.path().join("poses")).expect("a folder");
        let file = folder.path().join("poses/nico.toml");
        for text in [
            "not toml",
            "[[pose]]\ntitle = \"x\"\n[pose.joints_rad]\nr_toe = 1.0\n",
            "[[pose]]\ntitle = \"x\"\n[pose.joints_rad]\nr_elbow_y = 9.0\n",
            "[[pose]]\ntitle = \"x\"\n[pose.joints_rad]\nr_elbow_y = nan\n",
        ] {
            std::fs::write(&file, text).expect("it can be written");
            let (library, problem) = PoseLibrary::read(folder.path(), &rig);
            assert!(problem.is_some_and(|problem| problem.contains("cannot be used")), "{text}");
            assert!(library.all(&rig).iter().all(|pose| !pose.own));
            assert_eq!(std::fs::read_to_string(&file).expect("still there"), text);
        }
    }
}
