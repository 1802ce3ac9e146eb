//! Sessions that can be compared with the model, and whether they changed.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use plumbline_model::Session;
use plumbline_model::session::{Manifest, names};
use serde::{Deserialize, Serialize};

use super::store::KeptSession;
use super::view::GapSession;
use crate::ground::sessions::{Unread, folders, title_of};
use crate::ground::text::sentence;

/// Tables that can be compared.
const TABLES: [&str; 3] = [names::TOUCHES, names::POSES, names::LOCALIZATIONS];

/// Sessions with something to compare in a folder, newest first.
///
/// # Errors
/// A sentence, when the folder cannot be read.
pub fn list(folder: &Path) -> Result<Vec<GapSession>, Unread> {
    let folders = folders(folder)?.into_iter();
    let measured = folders.filter(|path| TABLES.iter().any(|table| path.join(table).is_file()));
    let mut sessions: Vec<GapSession> = measured.map(listed).collect();
    sessions.sort_by(|a, b| (b.started, &b.folder).cmp(&(a.started, &a.folder)));
    Ok(sessions)
}

/// A session as it stands in the list.
pub fn listed(folder: PathBuf) -> GapSession {
    let started = Manifest::read(&folder.join(names::MANIFEST)).ok().map(|manifest| manifest.started);
    let name = title_of(&folder);
    let listed = GapSession { folder, name, started, touches: 0, poses: 0, localizations: 0, problem: None };
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

/// What tells whether a session's tables changed: length and time of each.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableStamp {
    /// Name of the table.
    table: String,
    /// Bytes.
    length: u64,
    /// Seconds since 1970 of its last change.
    changed: u64,
}

impl TableStamp {
    /// Whether it is the same table, as far as a copy of it can tell: copies are as long, but written later.
    fn may_be_copy_of(&self, other: &Self) -> bool {
        self.table == other.table && self.length == other.length
    }
}

/// The session where it is now: a lab that was moved or copied brings its sessions along, and those in its own
/// folder `sessions` are what is meant, whatever path was noted.
pub fn at_home(session: KeptSession, sessions: &Path) -> KeptSession {
    let Some(home) = session.folder.file_name().map(|name| sessions.join(name)) else { return session };
    if home == session.folder || !home.is_dir() {
        return session;
    }
    let now = stamps(&home);
    let is_copy = now.len() == session.tables.len()
        && now.iter().zip(&session.tables).all(|(now, then)| now.may_be_copy_of(then));
    KeptSession { folder: home, tables: if is_copy { now } else { session.tables } }
}

/// The tables of a session as they are now.
pub fn stamps(folder: &Path) -> Vec<TableStamp> {
    let of = |table: &&str| {
        let about = std::fs::metadata(folder.join(table)).ok()?;
        let changed = about.modified().ok()?.duration_since(SystemTime::UNIX_EPOCH).ok()?;
        Some(TableStamp { table: (*table).to_owned(), length: about.len(), changed: changed.as_secs() })
    };
    TABLES.iter().filter_map(of).collect()
}
