//! Where calibrations, sessions and the journal are kept: never in a folder that somebody else can
//! write, unless the operator names it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A folder for data and what is wrong with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DataFolder {
    /// Where data go.
    pub path: PathBuf,
    /// What is wrong with that and what to do: a sentence.
    pub problem: Option<String>,
}

/// Where data are kept, and whether what is done is written down.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KeptView {
    /// Where calibrations, sessions and the journal are kept.
    pub folder: PathBuf,
    /// What is wrong with that folder and what to do, a sentence.
    pub problem: Option<Arc<str>>,
    /// The journal of this start; `None` when none is kept.
    pub journal: Option<PathBuf>,
    /// Why no journal is kept, a sentence.
    pub no_journal_because: Option<Arc<str>>,
    /// Commands that the journal lacks, because the disk did not keep up or did not take them.
    pub journal_lost: u64,
}

/// Nothing can ever be written here.
const NOWHERE: &str = "/dev/null/plumbline";
const CHOOSE: &str = "Start the program with --data-dir and a folder of your own.";

impl DataFolder {
    /// The wished folder, else that of the user, else a private one that does not last.
    pub fn choose(wished: Option<&Path>) -> Self {
        let of_user = || {
            let dirs = directories::ProjectDirs::from("", "", "plumbline");
            dirs.map(|dirs| dirs.data_dir().to_path_buf())
        };
        match wished {
            Some(wished) => Self::named(wished),
            None => Self::of_user(of_user(), &std::env::temp_dir()),
        }
    }

    /// The operator knows why; what others could do there is said all the same.
    fn named(folder: &Path) -> Self {
        let problem = others_can_write(folder).map(|why| {
            format!(
                "Data go to {}, but {why}: they could be changed there. It was asked for, so it is used.",
                folder.display()
            )
        });
        Self { path: folder.to_owned(), problem }
    }

    fn of_user(folder: Option<PathBuf>, temporary: &Path) -> Self {
        let why = match folder {
            None => "You have no home folder".to_owned(),
            Some(folder) => {
                let usable = make_private(&folder)
                    .map_err(|error| format!("{} cannot be written ({error})", folder.display()))
                    .and_then(|()| match others_can_write(&folder) {
                        None => Ok(()),
                        Some(why) => Err(format!("Your data folder {} is not safe: {why}", folder.display())),
                    });
                match usable {
                    Ok(()) => return Self { path: folder, problem: None },
                    Err(why) => why,
                }
            }
        };
        match private_folder(temporary) {
            Ok(path) => {
                let problem = format!(
                    "{why}. What is accepted and measured now goes to {}, which only you can read and which is not found again at the next start. {CHOOSE}",
                    path.display()
                );
                Self { path, problem: Some(problem) }
            }
            Err(error) => {
                let problem = format!(
                    "{why}, and no private folder can be made in {} ({error}). Nothing is kept: no calibration, no session, no journal. {CHOOSE}",
                    temporary.display()
                );
                Self { path: NOWHERE.into(), problem: Some(problem) }
            }
        }
    }
}

/// Makes a folder that only its owner can enter, and sees that it can be written.
fn make_private(folder: &Path) -> std::io::Result<()> {
    builder().recursive(true).create(folder)?;
    let probe = folder.join(format!(".write-test-{}", std::process::id()));
    let made = builder().recursive(false).create(&probe);
    // One that a program of the same number left is as good.
    let made = made.or_else(|error| if probe.is_dir() { Ok(()) } else { Err(error) });
    let removed = std::fs::remove_dir(&probe);
    made.and(removed)
}

/// A new folder with a name of its own: a folder that is there already, or a link that somebody
/// else put there, is never taken.
fn private_folder(temporary: &Path) -> std::io::Result<PathBuf> {
    let mut tried = Err(std::io::ErrorKind::AlreadyExists.into());
    for number in 0..100 {
        let folder = temporary.join(format!("plumbline-{}-{number}", std::process::id()));
        match builder().recursive(false).create(&folder) {
            Ok(()) => return Ok(folder),
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => tried = Err(error),
            Err(error) => return Err(error),
        }
    }
    tried
}

#[cfg(unix)]
fn builder() -> std::fs::DirBuilder {
    use std::os::unix::fs::DirBuilderExt as _;
    let mut builder = std::fs::DirBuilder::new();
    builder.mode(0o700);
    builder
}

#[cfg(not(unix))]
fn builder() -> std::fs::DirBuilder {
    std::fs::DirBuilder::new()
}

/// Who else could change what is in a folder, or put another in its place; a part of a sentence.
#[cfg(unix)]
fn others_can_write(folder: &Path) -> Option<String> {
    use std::os::unix::fs::MetadataExt as _;
    const STICKY: u32 = 0o1000;
    const BY_OTHERS: u32 = 0o022;
    let me = rustix::process::geteuid().as_raw();
    let whole = std::path::absolute(folder).ok()?;
    // Links are followed: what counts is where data really go.
    let whole = whole.canonicalize().unwrap_or(whole);
    whole.ancestors().find_map(|part| {
        let there = std::fs::metadata(part).ok()?;
        let name = part.display();
        if there.uid() != me && there.uid() != 0 {
            return Some(format!("{name} belongs to another user"));
        }
        // In a folder like /tmp others can add things, but not change mine.
        let is_shared = part != whole && there.mode() & STICKY != 0;
        (there.mode() & BY_OTHERS != 0 && !is_shared).then(|| format!("other users can write in {name}"))
    })
}

#[cfg(not(unix))]
fn others_can_write(_folder: &Path) -> Option<String> {
    None
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _};

    use super::*;

    fn set_mode(folder: &Path, mode: u32) {
        std::fs::set_permissions(folder, std::fs::Permissions::from_mode(mode)).expect("my own folder");
    }

    #[test]
    fn a_folder_of_ones_own_is_taken_without_a_word() {
        let home = tempfile::tempdir().expect("a temporary folder");
        let folder = home.path().join("deep").join("plumbline");
        let chosen = DataFolder::of_user(Some(folder.clone()), Path::new("/dev/null"));
        assert_eq!(chosen, DataFolder { path: folder.clone(), problem: None });
        assert_eq!(std::fs::metadata(&folder).expect("made").mode() & 0o777, 0o700);
        assert_eq!(std::fs::read_dir(&folder).expect("a folder").count(), 0, "the probe is gone");
    }

    #[test]
    fn without_a_home_data_go_to_a_new_private_folder_and_that_is_said() {
        let temporary = tempfile::tempdir().expect("a temporary folder");
        set_mode(temporary.path(), 0o1777);
        // What somebody else prepared under the name that would come first is not taken.
        let trap = temporary.path().join(format!("plumbline-{}-0", std::process::id()));
        std::os::unix::fs::symlink("/etc", &trap).expect("a link");
        let chosen = DataFolder::of_user(None, temporary.path());
        assert_ne!(chosen.path, trap);
        assert!(chosen.path.starts_with(temporary.path()));
        assert_eq!(std::fs::metadata(&chosen.path).expect("made").mode() & 0o777, 0o700);
        let problem = chosen.problem.expect("it is said");
        for words in ["no home folder", &chosen.path.display().to_string(), "only you can read", "--data-dir"]
        {
            assert!(problem.contains(words), "{words}: {problem}");
        }
    }

    #[test]
    fn where_nothing_can_be_made_nothing_is_kept_and_that_is_said() {
        let chosen = DataFolder::of_user(None, Path::new("/dev/null"));
        assert_eq!(chosen.path, Path::new(NOWHERE));
        assert!(std::fs::create_dir_all(&chosen.path).is_err());
        assert!(chosen.problem.expect("it is said").contains("Nothing is kept"));
        let chosen = DataFolder::of_user(Some("/dev/null/home".into()), Path::new("/dev/null"));
        assert!(chosen.problem.expect("it is said").contains("/dev/null/home cannot be written"));
    }

    #[test]
    fn a_home_that_others_can_write_is_not_taken() {
        let home = tempfile::tempdir().expect("a temporary folder");
        let temporary = tempfile::tempdir().expect("a temporary folder");
        set_mode(home.path(), 0o777);
        let folder = home.path().join(".local").join("plumbline");
        let chosen = DataFolder::of_user(Some(folder.clone()), temporary.path());
        assert!(chosen.path.starts_with(temporary.path()), "{chosen:?}");
        let problem = chosen.problem.expect("it is said");
        assert!(problem.contains("other users can write in"), "{problem}");

        // Named by the operator it is used, with a word.
        let named = DataFolder::choose(Some(&folder));
        assert_eq!(named.path, folder);
        assert!(named.problem.expect("it is said").contains("It was asked for"));
        let own = DataFolder::choose(Some(temporary.path()));
        assert_eq!(own, DataFolder { path: temporary.path().to_owned(), problem: None });
    }
}
