//! The operator's own poses: a small file in the data folder.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use plumbline_model::files::{self, Size, shortened};
use plumbline_model::robot::{JointIndex, Rig};
use serde::{Deserialize, Serialize};

use super::view::PoseView;

/// Poses that a message names.
const MOST_POSES_TOLD: usize = 3;

/// Poses of the rig and the operator's own.
#[derive(Clone, Debug)]
pub struct PoseLibrary {
    file: PathBuf,
    own: Vec<PoseView>,
    /// What else is in the file: it is written back as it was.
    others: toml::Table,
    /// Poses that cannot be used; they stay in the file, for only their owner knows what they meant.
    unusable: Vec<toml::Value>,
    /// Why the file as a whole cannot be used.
    damaged: Option<Damaged>,
}

#[derive(Clone, Debug)]
enum Damaged {
    /// It was read and is none: it makes room under another name when something is saved.
    NoPoses,
    /// It could not even be read: nothing is saved in its place.
    Unread(String),
}

/// Key of the list in the file.
const LIST: &str = "pose";

#[derive(Debug, Serialize, Deserialize)]
struct Entry {
    title: String,
    /// Joint names and their angles, rad.
    joints_rad: BTreeMap<String, f64>,
}

impl PoseLibrary {
    /// Reads what was saved for this rig; gives sentences about what could not be used.
    pub fn read(data_dir: &Path, rig: &Rig) -> (Self, Option<String>) {
        let file = data_dir.join("poses").join(format!("{}.toml", rig.name));
        let mut library =
            Self { file, own: Vec::new(), others: toml::Table::new(), unusable: Vec::new(), damaged: None };
        let problem = library.fill(rig);
        (library, problem)
    }

    fn fill(&mut self, rig: &Rig) -> Option<String> {
        let text = match files::read_text(&self.file, Size::SHORT) {
            Ok(text) => text,
            Err(error) if error.is_absent() => return None,
            Err(error) => {
                let reason = error.to_string();
                self.damaged = Some(Damaged::Unread(reason.clone()));
                return Some(format!("Your saved poses cannot be used: {reason}."));
            }
        };
        let parsed = toml::from_str::<toml::Table>(&text).map_err(|error| error.message().to_owned());
        let poses = parsed.and_then(|mut table| match table.remove(LIST) {
            None => Ok((table, vec![])),
            Some(toml::Value::Array(poses)) => Ok((table, poses)),
            Some(_) => Err(format!("its {LIST} is no list")),
        });
        match poses {
            Ok((others, poses)) => {
                self.others = others;
                let told: Vec<String> = poses.into_iter().filter_map(|pose| self.take(pose, rig)).collect();
                // What to do is the same for each of them.
                let more = told.len().saturating_sub(MOST_POSES_TOLD);
                let rest = (more > 0).then(|| format!("{more} more cannot be used or got another name."));
                (!told.is_empty())
                    .then(|| told.into_iter().take(MOST_POSES_TOLD).chain(rest).collect::<Vec<_>>().join(" "))
            }
            Err(reason) => {
                self.damaged = Some(Damaged::NoPoses);
                Some(format!(
                    "Your saved poses in {} cannot be used: {}. They were left out, the file is untouched.",
                    self.file.display(),
                    shortened(&reason)
                ))
            }
        }
    }

    /// Adds a pose of the file; a sentence if it is left out or gets another name.
    fn take(&mut self, value: toml::Value, rig: &Rig) -> Option<String> {
        match read_entry(&value, rig) {
            Ok((title, joints)) => {
                let free = self.free_title(&title, rig);
                let told = (free != title).then(|| {
                    format!(
                        "Two poses are called {}. One of them, yours, is now called {free}.",
                        shortened(&title)
                    )
                });
                self.own.push(pose(self.free_name(rig), free, joints));
                told
            }
            Err(reason) => {
                let title = value.get("title").and_then(toml::Value::as_str).unwrap_or("without a name");
                let told = format!(
                    "Your saved pose {} cannot be used: {reason}. It was left out; it stays in {}.",
                    shortened(title),
                    self.file.display()
                );
                self.unusable.push(value);
                Some(told)
            }
        }
    }

    /// A title that no other pose has: this one, or with a number behind.
    fn free_title(&self, title: &str, rig: &Rig) -> String {
        let all = self.all(rig);
        let numbered = (2..).map(|number| format!("{title} ({number})"));
        let mut titles = std::iter::once(title.to_owned()).chain(numbered);
        titles.find(|title| all.iter().all(|pose| pose.title != *title)).unwrap_or_else(|| title.to_owned())
    }

    /// A name that no other pose has, by which one is previewed and deleted.
    fn free_name(&self, rig: &Rig) -> String {
        let all = self.all(rig);
        let mut names = (1..).map(|number| format!("own-{number}"));
        names.find(|name| all.iter().all(|pose| pose.name != *name)).unwrap_or_default()
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
    pub fn save(&mut self, title: &str, joints: Vec<(JointIndex, f64)>, rig: &Rig) -> Result<(), PoseError> {
        let title = title.trim();
        if title.is_empty() {
            return Err(PoseError::NoName);
        }
        if self.all(rig).iter().any(|pose| pose.title == title) {
            return Err(PoseError::Taken(title.to_owned()));
        }
        self.own.push(pose(self.free_name(rig), title.to_owned(), joints));
        self.write(rig).inspect_err(|_| {
            self.own.pop();
        })
    }

    /// Removes one of the operator's own poses and writes the file.
    pub fn delete(&mut self, name: &str, rig: &Rig) -> Result<(), PoseError> {
        let place = self.own.iter().position(|pose| pose.name == name);
        let place = place.ok_or_else(|| PoseError::NotOwn(name.to_owned()))?;
        let removed = self.own.remove(place);
        self.write(rig).inspect_err(|_| self.own.insert(place, removed))
    }

    fn write(&mut self, rig: &Rig) -> Result<(), PoseError> {
        self.make_room()?;
        let name = |joint: JointIndex| rig.description.joint(joint).name.clone();
        let entry = |pose: &PoseView| Entry {
            title: pose.title.clone(),
            joints_rad: pose.joints.iter().map(|(joint, angle)| (name(*joint), *angle)).collect(),
        };
        let write = || -> Result<(), Box<dyn std::error::Error>> {
            let own = self.own.iter().map(|pose| toml::Value::try_from(entry(pose)));
            let own = own.collect::<Result<Vec<_>, _>>()?;
            let mut table = self.others.clone();
            let poses = own.into_iter().chain(self.unusable.iter().cloned()).collect();
            table.insert(LIST.to_owned(), toml::Value::Array(poses));
            let text = toml::to_string_pretty(&table)?;
            let folder = self.file.parent().unwrap_or(Path::new("."));
            files::make_folder(folder)?;
            Ok(files::write(&self.file, text)?)
        };
        write().map_err(|reason| PoseError::Unsaved(reason.to_string()))
    }

    /// Puts a file that is none of this program's aside, under a name that is free.
    fn make_room(&mut self) -> Result<(), PoseError> {
        match &self.damaged {
            None => return Ok(()),
            Some(Damaged::Unread(reason)) => return Err(PoseError::Unsaved(reason.clone())),
            Some(Damaged::NoPoses) => {}
        }
        let names = (1..).map(|number| self.file.with_extension(format!("unusable-{number}.toml")));
        let aside = { names }.find(|name| name.symlink_metadata().is_err());
        let moved = aside.map(|aside| std::fs::rename(&self.file, &aside));
        if let Some(Err(error)) = moved {
            return Err(PoseError::NotPutAside { file: self.file.clone(), error });
        }
        self.damaged = None;
        Ok(())
    }
}

/// Why a pose is not kept, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum PoseError {
    /// Nobody could find it again.
    #[error("A pose needs a name.")]
    NoName,
    /// Two would be one.
    #[error("There is a pose called {0} already. Choose another name.")]
    Taken(String),
    /// Those of the rig stay.
    #[error("{0} is not one of your own poses.")]
    NotOwn(String),
    /// The file cannot be written, or is not known.
    #[error("The poses cannot be saved: {0}.")]
    Unsaved(String),
    /// A file of somebody else is in its place.
    #[error("{} cannot be put aside ({error}), so the poses are not saved. Move it away by hand.", .file.display())]
    NotPutAside {
        /// Which.
        file: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
}

/// Why an entry of the file is no pose; stands inside a sentence.
#[derive(Debug, thiserror::Error)]
enum NoPose {
    /// It lacks something.
    #[error("{0}")]
    Toml(String),
    /// Nobody could find it.
    #[error("its name is empty")]
    NoName,
    /// It is of another robot.
    #[error("the robot has no joint {0}")]
    NoJoint(String),
    /// The arm does not get there.
    #[error("it puts {joint} at {angle_rad} rad, outside of its limits")]
    BeyondLimits {
        /// Which.
        joint: String,
        /// Where.
        angle_rad: f64,
    },
}

/// Title and joints of an entry, or why it cannot be used.
fn read_entry(value: &toml::Value, rig: &Rig) -> Result<(String, Vec<(JointIndex, f64)>), NoPose> {
    let entry: Entry = value
        .clone()
        .try_into()
        .map_err(|error: toml::de::Error| NoPose::Toml(error.message().to_owned()))?;
    let title = entry.title.trim();
    if title.is_empty() {
        return Err(NoPose::NoName);
    }
    let joint = |(name, angle_rad): (&String, &f64)| {
        let joint = rig.description.find_joint(name);
        let joint = joint.map_err(|_| NoPose::NoJoint(shortened(name)))?;
        if rig.limits(joint).contain(*angle_rad) {
            Ok((joint, *angle_rad))
        } else {
            Err(NoPose::BeyondLimits { joint: name.clone(), angle_rad: *angle_rad })
        }
    };
    Ok((title.to_owned(), entry.joints_rad.iter().map(joint).collect::<Result<_, NoPose>>()?))
}

fn pose(name: String, title: String, joints: Vec<(JointIndex, f64)>) -> PoseView {
    PoseView { name, title, about: "Saved by you.".to_owned(), joints, own: true }
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

    fn file_with(folder: &Path, text: &str) -> PathBuf {
        std::fs::create_dir_all(folder.join("poses")).expect("a folder");
        let file = folder.join("poses/nico.toml");
        std::fs::write(&file, text).expect("it can be written");
        file
    }

    fn titles(library: &PoseLibrary, rig: &Rig) -> Vec<String> {
        library.all(rig).into_iter().filter(|pose| pose.own).map(|pose| pose.title).collect()
    }

    const GOOD: &str = "[[pose]]\ntitle = \"good\"\n[pose.joints_rad]\nr_elbow_y = 1.0\n";

    #[test]
    fn one_bad_pose_takes_no_other_with_it() {
        let rig = rig();
        for (bad, words) in [
            ("[[pose]]\ntitle = \"x\"\n[pose.joints_rad]\nr_toe = 1.0\n", "the robot has no joint r_toe"),
            ("[[pose]]\ntitle = \"x\"\n[pose.joints_rad]\nr_elbow_y = 9.0\n", "outside of its limits"),
            ("[[pose]]\ntitle = \"x\"\n[pose.joints_rad]\nr_elbow_y = nan\n", "outside of its limits"),
            ("[[pose]]\ntitle = \"x\"\n", "missing field"),
            ("[[pose]]\ntitle = \" \"\n[pose.joints_rad]\n", "its name is empty"),
        ] {
            let folder = tempfile::tempdir().expect("a temporary folder");
            let file = file_with(folder.path(), &format!("of = \"mine\"\n{bad}{GOOD}"));
            let (mut library, problem) = PoseLibrary::read(folder.path(), &rig);
            let problem = problem.expect("told");
            assert!(problem.contains("cannot be used") && problem.contains(words), "{problem}");
            assert!(problem.contains("It was left out; it stays in "), "{problem}");
            assert_eq!(titles(&library, &rig), ["good"]);
            // Saving and deleting keep what is not understood.
            library.save("new", vec![], &rig).expect("it can be written");
            library.delete("own-1", &rig).expect("it can be deleted");
            let text = std::fs::read_to_string(&file).expect("there");
            assert!(text.contains("of = \"mine\"") && !text.contains("good"), "{text}");
            let (again, problem) = PoseLibrary::read(folder.path(), &rig);
            assert!(problem.is_some_and(|problem| problem.contains(words)));
            assert_eq!(titles(&again, &rig), ["new"]);
        }
    }

    #[test]
    fn no_two_poses_answer_to_one_name() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let rig = rig();
        file_with(folder.path(), &format!("{GOOD}{GOOD}{}", GOOD.replace("good", "Home")));
        let (mut library, problem) = PoseLibrary::read(folder.path(), &rig);
        let problem = problem.expect("told");
        assert!(problem.contains("Two poses are called good. One of them, yours, is now called good (2)."));
        assert!(problem.contains("is now called Home (2)"), "{problem}");
        assert_eq!(titles(&library, &rig), ["good", "good (2)", "Home (2)"]);
        // What is deleted in between leaves a number free; none is given twice.
        library.delete("own-1", &rig).expect("deleted");
        library.save("a", vec![], &rig).expect("saved");
        library.save("b", vec![], &rig).expect("saved");
        let all = library.all(&rig);
        let names: std::collections::BTreeSet<&str> = all.iter().map(|pose| pose.name.as_str()).collect();
        assert_eq!(names.len(), all.len(), "{names:?}");
        let chosen = all.iter().find(|pose| pose.title == "b").expect("there");
        library.delete(&chosen.name, &rig).expect("deleted");
        assert_eq!(titles(&library, &rig), ["good (2)", "Home (2)", "a"]);
        assert_eq!(PoseLibrary::read(folder.path(), &rig).1, None, "the new names are in the file");
    }

    #[test]
    fn a_file_that_is_none_makes_room_and_is_kept() {
        let rig = rig();
        for text in ["not toml", "pose = 3\n", "[[pose]\n"] {
            let folder = tempfile::tempdir().expect("a temporary folder");
            let file = file_with(folder.path(), text);
            let (mut library, problem) = PoseLibrary::read(folder.path(), &rig);
            assert!(problem.is_some_and(|problem| problem.contains("cannot be used")), "{text}");
            assert_eq!(std::fs::read_to_string(&file).expect("still there"), text);
            library.save("new", vec![], &rig).expect("saved");
            let aside = folder.path().join("poses/nico.unusable-1.toml");
            assert_eq!(std::fs::read_to_string(aside).expect("kept"), text);
            assert_eq!(titles(&PoseLibrary::read(folder.path(), &rig).0, &rig), ["new"]);
        }
    }

    #[test]
    fn what_cannot_be_read_is_not_written_over() {
        let rig = rig();
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = file_with(folder.path(), "");
        std::fs::remove_file(&file).expect("removed");
        std::os::unix::fs::symlink("on-the-other-disk.toml", &file).expect("a link");
        let (mut library, problem) = PoseLibrary::read(folder.path(), &rig);
        assert!(problem.is_some_and(|problem| problem.contains("which does not exist")));
        let refused = library.save("new", vec![], &rig).expect_err("a link to nothing").to_string();
        assert!(refused.starts_with("The poses cannot be saved: "), "{refused}");
        assert!(titles(&library, &rig).is_empty());
        assert!(file.symlink_metadata().expect("still a link").is_symlink());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_kill_takes_no_pose_that_was_saved() {
        const TEST: &str = "robot::poses::tests::a_kill_takes_no_pose_that_was_saved";
        let rig = rig();
        let elbow = rig.description.find_joint("r_elbow_y").expect("a joint of NICO");
        if let Some(folder) = crate::ground::kept::writing() {
            let (mut library, problem) = PoseLibrary::read(&folder, &rig);
            assert_eq!(problem, None);
            for _ in crate::ground::kept::until_killed() {
                let title = format!("pose {}", library.own.len());
                library.save(&title, vec![(elbow, 1.0)], &rig).expect("saved");
            }
            return;
        }
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (mut saved, mut nth) = (0, 0);
        // How much is written between two kills is the disk's affair: some poses, in the end.
        while nth < 20 || (saved <= 20 && nth < 100) {
            crate::ground::kept::kill(TEST, folder.path(), nth);
            nth += 1;
            let (library, problem) = PoseLibrary::read(folder.path(), &rig);
            assert_eq!(problem, None, "kill {nth}");
            let now = titles(&library, &rig);
            assert!(now.len() >= saved, "kill {nth}: {} of {saved} poses are left", now.len());
            assert!((0..now.len()).all(|i| now[i] == format!("pose {i}")));
            saved = now.len();
        }
        assert!(saved > 20, "{saved} poses");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_takes_no_pose_that_was_saved() {
        const TEST: &str = "robot::poses::tests::a_full_disk_takes_no_pose_that_was_saved";
        let rig = rig();
        if let Some(folder) = crate::ground::kept::writing() {
            let (mut library, _) = PoseLibrary::read(&folder, &rig);
            let refused =
                library.save("one too many", vec![], &rig).expect_err("the disk is full").to_string();
            assert!(refused.contains("what was there before is unchanged"), "{refused}");
            assert!(library.delete("own-1", &rig).is_err());
            assert_eq!(titles(&library, &rig).len(), 40, "what cannot be written is not shown either");
            return;
        }
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (mut library, _) = PoseLibrary::read(folder.path(), &rig);
        let elbow = rig.description.find_joint("r_elbow_y").expect("a joint of NICO");
        for i in 0..40 {
            library.save(&format!("pose {i}"), vec![(elbow, 1.0)], &rig).expect("saved");
        }
        let before = std::fs::read(&library.file).expect("there");
        for room in [0, 1024] {
            assert!(
                crate::ground::kept::run_on_full_disk(TEST, folder.path(), room).success(),
                "room for {room}"
            );
            assert_eq!(std::fs::read(&library.file).expect("there"), before);
            assert_eq!(std::fs::read_dir(folder.path().join("poses")).expect("there").count(), 1);
        }
    }
}
