//! Runs the search on a session on disk, as the command line does. Shared by the driver and the
//! test; the library of this package knows nothing of the search.

use std::collections::BTreeMap;
use std::path::Path;

use plumbline_blind::verdict::{Found, Verdict};
use plumbline_effects::Measurements;
use plumbline_gap::finding::{ClassMember, Finding};
use plumbline_gap::{Options, find};
use plumbline_model::robot::Rig;
use plumbline_model::session::RigReference;
use plumbline_model::{Session, Unattended};
use serde_json::json;

/// What went wrong, in words.
pub type AnyError = Box<dyn std::error::Error + Send + Sync>;

/// Searches the session in a folder.
#[allow(dead_code, reason = "who follows experiments searches several")]
pub fn search(folder: &Path, options: &Options) -> Result<Verdict, AnyError> {
    Ok(verdict(&search_all(&[folder], options)?))
}

/// Searches the sessions of one robot in some folders together.
#[allow(dead_code, reason = "who takes times reads and searches apart")]
pub fn search_all(folders: &[impl AsRef<Path>], options: &Options) -> Result<Finding, AnyError> {
    Ok(find(&read_all(folders)?, options, &Unattended)?)
}

/// What the sessions of one robot in some folders measured.
pub fn read_all(folders: &[impl AsRef<Path>]) -> Result<Measurements, AnyError> {
    let mut sessions = vec![];
    let mut rig = None;
    for folder in folders {
        let folder = folder.as_ref();
        let session = Session::read(folder)?;
        if rig.is_none() {
            rig = Some(match &session.manifest.rig {
                RigReference::Named(name) => Rig::built_in(name)?,
                RigReference::File(file) => Rig::read_measured(&folder.join(file))?,
            });
        }
        sessions.push((folder.display().to_string(), session));
    }
    Ok(Measurements::of_sessions(&sessions, &rig.ok_or("no session")?)?)
}

/// A finding as the command line prints it, as far as it is judged.
pub fn verdict(finding: &Finding) -> Verdict {
    let named = |member: &ClassMember| format!("{}@{}", member.id, member.site);
    let effects = finding.effects.iter().map(|effect| Found {
        id: effect.id.clone(),
        site: effect.site.clone(),
        probability: effect.probability,
        parameters: effect
            .parameters
            .iter()
            .map(|p| (p.name.clone(), json!({"value": p.value, "low": p.low, "high": p.high})))
            .collect(),
        size_sigmas: Some(effect.size_sigmas),
        class: effect.class.iter().map(named).collect(),
        beside: effect.beside.iter().map(named).collect(),
    });
    let word = serde_json::to_value(finding.verdict).ok();
    Verdict {
        verdict: word.and_then(|word| word.as_str().map(str::to_owned)).unwrap_or_default(),
        effects: effects.collect(),
        many: finding.many,
        held_out: BTreeMap::from([("closure".to_owned(), json!(finding.shown.closure))]),
        seconds: Some(finding.seconds),
    }
}
