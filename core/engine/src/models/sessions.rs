//! Sessions with touches: which there are, and what can be learned from one.

use std::path::{Path, PathBuf};

use plumbline_correction::TouchData;
use plumbline_model::Session;
use plumbline_model::robot::Rig;
use plumbline_model::session::{Manifest, names};
use plumbline_model::touch_plan::Finger;

use super::error::ModelError;
use super::view::TouchSession;
use crate::ground::sessions::{Unread, folders, rig_of};
use crate::ground::text::sentence;

/// Sessions with touches in a folder, newest first. One that cannot be read is listed with the
/// reason.
pub fn list(folder: &Path) -> Result<Vec<TouchSession>, Unread> {
    let folders = folders(folder)?.into_iter();
    let with_touches = folders.filter(|path| path.join(names::TOUCHES).is_file());
    let mut sessions: Vec<TouchSession> = with_touches.map(listed).collect();
    sessions.sort_by(|a, b| (b.started, &b.folder).cmp(&(a.started, &a.folder)));
    Ok(sessions)
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
pub fn touch_data(folder: &Path, rig: &Rig) -> Result<TouchData, ModelError> {
    let session = Session::read(folder)?;
    let own = rig_of(&session, folder)?;
    if own.name != rig.name {
        return Err(ModelError::OtherRobotsSession { recorded: own.name, present: rig.name.clone() });
    }
    let chain = session.manifest.chain.as_ref().ok_or(ModelError::NoTip)?;
    // What is learned here is where one finger lands; it is used for that finger alone.
    if chain.tip == Finger::Left.tip() {
        return Err(ModelError::LeftFinger);
    }
    let chain = rig.chain(&chain.tip)?;
    let data = TouchData::of_session(&session, &chain)?;
    super::screen::same_size(&(&data.screen).into(), &(&rig.touchscreen).into(), "The session")?;
    Ok(data)
}
