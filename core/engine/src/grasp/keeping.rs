//! What is kept of an attempt: a folder `grasps/<time>_<method>` with `record.json`, the joints over time in
//! `tracks.csv`, and images of both eyes before, while the hand is aligned, and after.

use std::path::{Path, PathBuf};

use image::DynamicImage;
use jiff::Timestamp;
use plumbline_grasp::tracks::{self, Tracks};
use plumbline_grasp::{Method, Record, Sight, Step, record};
use plumbline_model::files::{self, FileError, Size};
use plumbline_model::robot::Rig;

use super::view::AttemptView;

/// The record, in the folder of an attempt.
const RECORD: &str = "record.json";
/// Attempts that are shown.
const MOST_SHOWN: usize = 200;

/// Why an attempt cannot be kept, or read. Reads as a sentence.
#[derive(Debug, thiserror::Error)]
pub enum KeepingError {
    /// A file.
    #[error(transparent)]
    File(#[from] FileError),
    /// It is no record.
    #[error("{} is no record of a grasp ({why}): move its folder away", .file.display())]
    NoRecord {
        /// Which.
        file: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// It is of a newer program.
    #[error("{} has format {format}, this program knows {}: read it with a newer program", .file.display(), record::FORMAT)]
    Newer {
        /// Which.
        file: PathBuf,
        /// Its format.
        format: u32,
    },
    /// A folder.
    #[error("{} cannot be made ({error}): free space, or choose another data folder", .folder.display())]
    NoFolder {
        /// Which.
        folder: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
}

/// What the images of a look are called: from the second try (`number`, from 1) on with its number, so that
/// those of the tries before stay; `look` counts the looks at the hand.
pub fn image_name(number: usize, step: Step, look: usize) -> String {
    let name = match step {
        Step::Align => format!("aligned_{look}"),
        Step::Check => "after".to_owned(),
        _ => "before".to_owned(),
    };
    if number > 1 { format!("try{number}_{name}") } else { name }
}

/// Where attempts of a world are kept.
pub fn grasps_in(folder: &Path) -> PathBuf {
    folder.join("grasps")
}

/// The folder of an attempt.
#[derive(Clone, Debug)]
pub struct Keeping {
    folder: PathBuf,
}

impl Keeping {
    /// A folder of its own among the attempts of a world.
    ///
    /// # Errors
    /// When it cannot be made.
    pub fn begin(grasps: &Path, method: Method, at: Timestamp) -> Result<Self, KeepingError> {
        files::make_folder(grasps)?;
        let name = format!("{}_{}", at.strftime("%Y-%m-%dT%H-%M-%SZ"), method.name());
        let names = std::iter::once(name.clone()).chain((2..).map(|n| format!("{name}_{n:03}")));
        for folder in names.map(|name| grasps.join(name)) {
            match std::fs::create_dir(&folder) {
                Ok(()) => return Ok(Self { folder }),
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(KeepingError::NoFolder { folder, error }),
            }
        }
        unreachable!("there is always a next number")
    }

    /// One that is there already.
    pub fn of(folder: PathBuf) -> Self {
        Self { folder }
    }

    /// Its name.
    pub fn name(&self) -> String {
        self.folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
    }

    /// Writes what is known so far in place of what was.
    ///
    /// # Errors
    /// When it cannot be written; then the old one is there.
    pub fn record(&self, record: &Record) -> Result<(), KeepingError> {
        let file = self.folder.join(RECORD);
        let text = serde_json::to_vec_pretty(record)
            .map_err(|error| KeepingError::NoRecord { file: file.clone(), why: error.to_string() })?;
        Ok(files::write(&file, text)?)
    }

    /// Begins the table of what the joints do.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn tracks(&self, rig: &Rig) -> Result<Tracks, KeepingError> {
        Ok(Tracks::begin(&self.folder.join(tracks::FILE), rig)?)
    }

    /// Writes both images of a pair.
    ///
    /// # Errors
    /// When they cannot be written.
    pub fn images(&self, name: &str, sight: &Sight) -> Result<(), KeepingError> {
        for (eye, image) in [("left", &sight.left), ("right", &sight.right)] {
            let image = DynamicImage::ImageRgb8((**image).clone());
            files::write_png(&self.folder.join(format!("{name}_{eye}.png")), &image)?;
        }
        Ok(())
    }

    /// Reads the record.
    ///
    /// # Errors
    /// When there is none, or it cannot be read.
    pub fn read(&self) -> Result<Record, KeepingError> {
        let file = self.folder.join(RECORD);
        let text = files::read_text(&file, Size::SHORT)?;
        let record: Record = serde_json::from_str(&text)
            .map_err(|error| KeepingError::NoRecord { file: file.clone(), why: error.to_string() })?;
        if record.format > record::FORMAT {
            return Err(KeepingError::Newer { file, format: record.format });
        }
        Ok(record)
    }

    /// For the list.
    pub fn view(&self, record: &Record) -> AttemptView {
        AttemptView {
            name: self.name(),
            folder: self.folder.clone(),
            began: record.began,
            method: record.method,
            hand: record.hand,
            model: record.model.clone(),
            object: record.object.clone(),
            outcome: record.outcome.clone(),
            reached: record.step,
            told: record.told_by_operator,
            slipped_after: record.slipped_after_s.and_then(plumbline_model::duration::seconds),
            alignment_m: record.alignment_m(),
            closed_at_m: record.wanted_m,
            seconds: record.seconds,
        }
    }
}

/// Attempts of a world, newest first, and what is wrong with those that cannot be read.
pub fn list(grasps: &Path) -> (Vec<AttemptView>, Vec<KeepingError>) {
    let folders = std::fs::read_dir(grasps).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut folders: Vec<PathBuf> = folders
        .filter(|path| path.is_dir() && !files::is_hidden(path) && path.join(RECORD).exists())
        .collect();
    folders.sort_unstable_by(|a, b| b.cmp(a));
    folders.truncate(MOST_SHOWN);
    let (mut attempts, mut problems) = (vec![], vec![]);
    for keeping in folders.into_iter().map(Keeping::of) {
        match keeping.read() {
            Ok(record) => attempts.push(keeping.view(&record)),
            Err(problem) => problems.push(problem),
        }
    }
    attempts.sort_by_key(|attempt| std::cmp::Reverse(attempt.began));
    (attempts, problems)
}

#[cfg(test)]
mod tests {
    use plumbline_grasp::Step;
    use plumbline_grasp::record::Iteration;

    use super::*;

    #[test]
    fn what_was_kept_is_read_back_and_listed() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let grasps = grasps_in(folder.path());
        let at = Timestamp::UNIX_EPOCH;
        let keeping = Keeping::begin(&grasps, Method::M5, at).expect("writable");
        let other = Keeping::begin(&grasps, Method::M5, at).expect("writable");
        assert_eq!(
            (keeping.name(), other.name()),
            ("1970-01-01T00-00-00Z_m5".to_owned(), "1970-01-01T00-00-00Z_m5_002".to_owned())
        );
        let mut record = Record::new(Method::M5, "Tomato", at, "as described".to_owned());
        record.step = Some(Step::Approach);
        keeping.record(&record).expect("writable");
        assert_eq!(keeping.read().expect("there"), record);
        std::fs::write(other.folder.join(RECORD), "{").expect("writable");
        let (attempts, problems) = list(&grasps);
        assert_eq!(attempts.len(), 1);
        assert_eq!((attempts[0].reached, &attempts[0].outcome), (Some(Step::Approach), &None));
        assert!(problems[0].to_string().contains("is no record of a grasp"), "{}", problems[0]);
    }

    /// Without a key that older programs did not write.
    fn without(value: &mut serde_json::Value, key: &str) {
        assert!(value.as_object_mut().and_then(|of| of.remove(key)).is_some(), "{key} is written");
    }

    #[test]
    fn when_it_was_looked_is_kept_and_a_record_that_does_not_say_is_read_all_the_same() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let keeping =
            Keeping::begin(&grasps_in(folder.path()), Method::M5, Timestamp::UNIX_EPOCH).expect("writable");
        let look = Iteration {
            at_s: Some(6.5),
            sent_m: [0.3, -0.1, 0.2],
            hand_m: None,
            not_found: Some("hidden".to_owned()),
            distance_m: None,
            sigma_m: None,
        };
        let mut record = Record::new(Method::M5, "Tomato", Timestamp::UNIX_EPOCH, "as described".to_owned());
        (record.seen_at_s, record.seen_after_at_s) = (Some(0.25), Some(12.0));
        record.iterations.push(look.clone());
        keeping.record(&record).expect("writable");
        assert_eq!(keeping.read().expect("there"), record);

        let file = keeping.folder.join(RECORD);
        let text = std::fs::read_to_string(&file).expect("there");
        let mut older: serde_json::Value = serde_json::from_str(&text).expect("a record");
        without(&mut older, "seen_at_s");
        without(&mut older, "seen_after_at_s");
        without(&mut older["iterations"][0], "at_s");
        std::fs::write(&file, older.to_string()).expect("writable");
        let read = keeping.read().expect("older ones are read");
        assert_eq!(read.iterations, [Iteration { at_s: None, ..look }]);
        assert_eq!((read.seen_at_s, read.seen_after_at_s), (None, None));
    }
}
