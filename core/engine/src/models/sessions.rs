//! Sessions with touches: which there are, and what can be learned from one.

use std::path::{Path, PathBuf};

use plumbline_correction::TouchData;
use plumbline_model::Session;
use plumbline_model::robot::Rig;
use plumbline_model::session::{Manifest, names};

use super::view::TouchSession;
use crate::ground::sessions::rig_of;
use crate::ground::text::sentence;

/// Sessions with touches in a folder, newest first. One that cannot be read is listed with the
/// reason.
pub fn list(folder: &Path) -> Result<Vec<TouchSession>, String> {
    let listing = match std::fs::read_dir(folder) {
        Ok(listing) => listing,
        // Nothing was ever touched.
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => {
            return Err(format!(
                "{} cannot be read ({error}). Check that you may read it.",
                folder.display()
            ));
        }
    };
    let folders = listing.flatten().map(|entry| entry.path());
    let with_touches = folders.filter(|path| path.join(names::TOUCHES).is_file());
    let mut sessions: Vec<TouchSession> = with_touches.map(listed).collect();
    sessions.sort_by(|a, b| (b.started, &b.folder).cmp(&(a.started, &a.folder)));
    Ok(sessions)
}

/// Whether a session was touched to be learned from: not only its corners to place the screen, and
/// not through a model to check that.
pub fn is_for_training(folder: &Path) -> bool {
    let name = folder.file_name().unwrap_or_default().to_string_lossy();
    !name.contains("_corners") && !name.contains("_check")
}

/// A session as it stands in the list.
pub fn listed(folder: PathBuf) -> TouchSession {
    let started = Manifest::read(&folder.join(names::MANIFEST)).ok().map(|manifest| manifest.started);
    match Session::read(&folder) {
        Ok(session) => {
            let touches = session.touches.as_ref().map_or(0, |table| table.row_count());
            let problem = (touches == 0).then(|| "There is no touch in it.".to_owned());
            TouchSession { folder, started, touches, problem }
        }
        Err(error) => {
            TouchSession { folder, started, touches: 0, problem: Some(sentence(&error.to_string())) }
        }
    }
}

/// What can be learned from a session of this robot, or why nothing can, a sentence.
pub fn touch_data(folder: &Path, rig: &Rig) -> Result<TouchData, String> {
    let words = |error: &dyn std::fmt::Display| sentence(&error.to_string());
    let session = Session::read(folder).map_err(|error| words(&error))?;
    let own = rig_of(&session, folder).map_err(|error| words(&error))?;
    if own.name != rig.name {
        return Err(format!(
            "The session was recorded with the robot \"{}\", this one is \"{}\". Choose a session of this robot.",
            own.name, rig.name
        ));
    }
    let chain = session.manifest.chain.as_ref().ok_or("The session does not say which tip touched.")?;
    let chain = rig.chain(&chain.tip).map_err(|error| words(&error))?;
    let data = TouchData::of_session(&session, &chain).map_err(|error| words(&error))?;
    super::screen::same_size(&(&data.screen).into(), &(&rig.touchscreen).into(), "The session")?;
    Ok(data)
}
