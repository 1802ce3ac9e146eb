//! Sessions that can be compared with the model, and whether they changed.

use std::fs::File;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use plumbline_model::Session;
use plumbline_model::session::{Manifest, names};
use serde::{Deserialize, Serialize};

use super::store::KeptSession;
use super::view::GapSession;
use crate::ground::sessions::{Unread, folders, is_check, is_for_training, is_of_corners, title_of};
use crate::ground::text::sentence;

/// Tables that can be compared.
const TABLES: [&str; 3] = [names::TOUCHES, names::POSES, names::LOCALIZATIONS];

/// Sessions with something to compare in a folder, newest first.
///
/// # Errors
/// A sentence, when the folder cannot be read.
pub fn list(folder: &Path) -> Result<Vec<GapSession>, Unread> {
    let folders = folders(folder)?.into_iter();
    let mut sessions: Vec<GapSession> = folders.filter(|path| is_measured(path)).map(listed).collect();
    sessions.sort_by(|a, b| (b.started, &b.folder).cmp(&(a.started, &a.folder)));
    Ok(sessions)
}

/// Whether a session has a table to compare: a run that ended before its first touch has none.
pub fn is_measured(session: &Path) -> bool {
    TABLES.iter().any(|table| session.join(table).is_file())
}

/// A session as it stands in the list.
pub fn listed(folder: PathBuf) -> GapSession {
    let started = Manifest::read(&folder.join(names::MANIFEST)).ok().map(|manifest| manifest.started);
    let name = title_of(&folder);
    let is_check = is_check(&folder);
    let listed =
        GapSession { folder, name, started, is_check, touches: 0, poses: 0, localizations: 0, problem: None };
    match Session::read(&listed.folder) {
        Ok(session) => {
            let touches = session.touches.as_ref().map_or(0, |table| table.row_count());
            let poses = session.poses.as_ref().map_or(0, |table| table.row_count());
            let localizations = session.localizations.as_ref().map_or(0, |table| table.row_count());
            let problem = (touches + poses + localizations == 0).then(|| "Nothing was measured.".to_owned());
            GapSession { touches, poses, localizations, problem, ..listed }
        }
        Err(error) => GapSession { problem: Some(sentence(&error.to_string())), ..listed },
    }
}

/// What tells whether a session's tables changed: length, time and contents of each.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableStamp {
    /// Name of the table.
    table: String,
    /// Bytes.
    length: u64,
    /// Seconds since 1970 of its last change.
    changed: u64,
    /// A sum over its bytes; `None`: noted by a program that took none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sum: Option<u64>,
}

impl TableStamp {
    /// Whether the table holds what it held. Where its contents were not noted, it must not have been written since either.
    fn is_as(&self, then: &Self) -> bool {
        self.holds(then).unwrap_or(self.changed == then.changed && self.length == then.length)
    }

    /// The same, as far as a copy of it can tell: copies are written later.
    fn may_be_copy_of(&self, then: &Self) -> bool {
        self.holds(then).unwrap_or(self.length == then.length)
    }

    /// Whether it holds what the other one does; `None`: of one of them that was not noted.
    fn holds(&self, other: &Self) -> Option<bool> {
        let sums = self.sum.zip(other.sum);
        sums.map(|(own, others)| own == others && self.length == other.length)
    }
}

/// Whether all tables are as they were.
pub fn are_as(now: &[TableStamp], then: &[TableStamp]) -> bool {
    are_all(now, then, TableStamp::is_as)
}

fn are_all(now: &[TableStamp], then: &[TableStamp], is: fn(&TableStamp, &TableStamp) -> bool) -> bool {
    now.len() == then.len()
        && now.iter().zip(then).all(|(now, then)| now.table == then.table && is(now, then))
}

/// The session where it is now: a lab that was moved or copied brings its sessions along. Those in its own folder
/// `sessions` are meant where they hold what was noted, or the noted folder is gone or holds the very same; any other
/// one of the same name is another session.
pub fn at_home(session: KeptSession, sessions: &Path) -> KeptSession {
    let Some(home) = session.folder.file_name().map(|name| sessions.join(name)) else { return session };
    if home == session.folder || !home.is_dir() {
        return session;
    }
    let now = stamps(&home);
    let are_the_same = |others: &[TableStamp]| {
        !now.is_empty() && are_all(&now, others, |own, others| own.holds(others) == Some(true))
    };
    // In the lab that was copied from, measuring may have gone on.
    let is_it = are_the_same(&session.tables)
        || !session.folder.is_dir()
        || is_same_folder(&home, &session.folder)
        || are_the_same(&stamps(&session.folder));
    if !is_it {
        return session;
    }
    let is_copy = are_all(&now, &session.tables, TableStamp::may_be_copy_of);
    KeptSession { folder: home, tables: if is_copy { now } else { session.tables } }
}

/// What is compared once a run of touches is finished. One that checks is compared beside those that were learned
/// from, since few touches alone tell little, and never beside those of another place; corners only place the screen.
pub fn with_finished(mut chosen: Vec<PathBuf>, session: &Path) -> Vec<PathBuf> {
    if is_for_training(session) {
        chosen.clear();
    }
    // What was opened from elsewhere may be of another robot or of another day.
    if chosen.iter().any(|other| other.parent() != session.parent()) {
        return chosen;
    }
    if !is_of_corners(session) && !chosen.iter().any(|other| other == session) {
        chosen.push(session.to_owned());
    }
    chosen
}

fn is_same_folder(a: &Path, b: &Path) -> bool {
    a.canonicalize().ok().zip(b.canonicalize().ok()).is_some_and(|(a, b)| a == b)
}

/// The tables of a session as they are now.
pub fn stamps(folder: &Path) -> Vec<TableStamp> {
    let of = |table: &&str| {
        let file = folder.join(table);
        let about = std::fs::metadata(&file).ok()?;
        let changed = about.modified().ok()?.duration_since(SystemTime::UNIX_EPOCH).ok()?.as_secs();
        Some(TableStamp { table: (*table).to_owned(), length: about.len(), changed, sum: sum(&file) })
    };
    TABLES.iter().filter_map(of).collect()
}

/// A sum over the bytes of a file by which two of them are told apart; `None`: it cannot be read. FNV-1a with 64 bits:
/// Fowler, Noll, Vo and Eastlake, "The FNV Non-Cryptographic Hash Algorithm". Nobody is to be kept from forging it.
fn sum(file: &Path) -> Option<u64> {
    let mut reader = BufReader::new(File::open(file).ok()?);
    let mut sum = 0xcbf2_9ce4_8422_2325_u64;
    loop {
        let bytes = reader.fill_buf().ok()?;
        if bytes.is_empty() {
            return Some(sum);
        }
        sum =
            bytes.iter().fold(sum, |sum, byte| (sum ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3));
        let read = bytes.len();
        reader.consume(read);
    }
}
