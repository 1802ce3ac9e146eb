//! `plumbline gap`: finds where model and measurement disagree, names what is missing, and shows the
//! gap shrink.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use plumbline_effects::measurements::What;
use plumbline_effects::{Measurements, RigModel};
use plumbline_engine::gap::same_rig;
use plumbline_engine::ground::sessions::{rig_of, title_of};
use plumbline_engine::rig_models;
use plumbline_gap::finding::{Dependence, NamedEffect, NextExperiment, ShownUnit};
use plumbline_gap::{Finding, Options, Verdict, find};
use plumbline_model::robot::Rig;
use plumbline_model::{JobContext, Session, files};
use plumbline_report::ReportContext;
use serde::Serialize;
use serde_json::{Map, Value};

use super::OfflineError;
use super::gap_calibrations::{newest_localized, of_calibrations};
use super::session::{self, ModelFile};

/// Where to look for a gap.
#[derive(Clone, Debug)]
pub struct GapArgs {
    /// Folders of sessions of one robot.
    pub sessions: Vec<PathBuf>,
    /// What to look with in place of what the first session names.
    pub rig_model: Option<PathBuf>,
    /// Of all that is drawn by chance.
    pub seed: u64,
    /// Receives the model with what was found.
    pub add_to: Option<PathBuf>,
    /// Receives a page about it: PDF if it is called so, else HTML.
    pub report: Option<PathBuf>,
}

/// What was found, with the keys of the command line's JSON.
#[derive(Clone, Debug, Serialize)]
pub struct GapReport {
    /// The answer in a word.
    pub verdict: Verdict,
    /// The answer in a sentence.
    pub sentence: String,
    /// Effects that were found, the largest first.
    pub effects: Vec<EffectReport>,
    /// The gap before and after on rows that were not used; lengths in the unit that the key names.
    pub held_out: Map<String, Value>,
    /// Whether effects are no names, but close a part of the gap and can be added as that.
    pub partial: bool,
    /// Probability that much is a little off at once, where that is more probable than any few effects: those above stand
    /// for it. Left out elsewhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub many: Option<f64>,
    /// What stays.
    pub unexplained: UnexplainedReport,
    /// What of the effects the rows do not tell.
    pub undetermined: Vec<UndeterminedReport>,
    /// What to measure next; null where nothing is left to tell apart.
    pub next_experiment: Option<NextReport>,
    /// What is odd about the data, in words.
    pub warnings: Vec<String>,
    /// Rows that were left out.
    pub left_out: usize,
    /// Time of the search.
    pub seconds: f64,
    /// `id@site` of the effects that were written into a model.
    pub added: Vec<String>,
    /// Everything, for people and for the window.
    #[serde(skip)]
    pub finding: Finding,
}

/// An effect that was found.
#[derive(Clone, Debug, Serialize)]
pub struct EffectReport {
    /// Its name.
    pub id: String,
    /// Where it sits.
    pub site: String,
    /// Probability of the name.
    pub probability: f64,
    /// By name.
    pub parameters: BTreeMap<String, ParameterReport>,
    /// `id@site` of all that cannot be told apart from it, itself first.
    pub class: Vec<String>,
    /// Probability of the class.
    pub class_probability: f64,
    /// What experiment would tell them apart.
    pub split_by: Option<String>,
    /// The best name outside of the class, and log₁₀ of the odds against it.
    pub runner_up: Option<(String, f64)>,
    /// Why it cannot be added, if so.
    pub not_addable: Option<String>,
}

/// A parameter with its 95 % interval; some are a choice, as the name of a joint.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum ParameterReport {
    /// A number.
    Number {
        /// In the unit that the name says.
        value: f64,
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// A name.
    Text(String),
}

/// What stays unexplained.
#[derive(Clone, Debug, Serialize)]
pub struct UnexplainedReport {
    /// Probability of it by noise alone.
    pub p_value: f64,
    /// On what it depends.
    pub depends_on: Vec<String>,
    /// Probability of something that is not in the library.
    pub probability: f64,
}

/// Parameters that the rows do not tell apart, or do not show at all.
#[derive(Clone, Debug, Serialize)]
pub struct UndeterminedReport {
    /// `id@site.parameter` of each.
    pub parameters: Vec<String>,
    /// In words.
    pub words: String,
}

/// What to measure next.
#[derive(Clone, Debug, Serialize)]
pub struct NextReport {
    /// In words.
    pub what: String,
    /// Why.
    pub why: String,
    /// How likely the most probable names are the right ones after it.
    pub expected_probability: f64,
    /// How long it takes.
    pub minutes: f64,
}

/// Reads the sessions, looks for the gap, and writes what is asked for.
pub fn gap(args: &GapArgs, context: &dyn JobContext) -> Result<GapReport, OfflineError> {
    let given = read(&args.sessions, args.rig_model.as_deref())?;
    check_outputs(args, &given)?;
    let options = Options { seed: args.seed, ..Options::default() };
    let mut finding = find(&given.measurements, &options, context)?;
    finding.warnings.extend(of_calibrations(&given.sessions, &given.rig, &finding.effects));
    let mut report = GapReport::of(finding);
    if let Some(file) = &args.add_to {
        report.added = add(&given, &report.finding, file)?;
    }
    if let Some(file) = &args.report {
        write_report(&given, &report.finding, file)?;
    }
    Ok(report)
}

/// Before the search, which takes minutes.
fn check_outputs(args: &GapArgs, given: &Given) -> Result<(), OfflineError> {
    let rig_files = args.sessions.iter().zip(&given.sessions);
    let rig_files: Vec<PathBuf> = rig_files.filter_map(|(folder, s)| session::rig_file(s, folder)).collect();
    let mut inputs: Vec<&Path> = args.sessions.iter().chain(&rig_files).map(PathBuf::as_path).collect();
    // A model with effects may be written over: it is written with its history, so nothing is lost.
    let model = args.rig_model.as_deref();
    inputs.extend(model.filter(|_| !given.has_history));
    if let Some(file) = &args.add_to {
        files::output(file, &inputs)?;
    }
    if let Some(report) = &args.report {
        inputs.extend(model);
        inputs.extend(args.add_to.as_deref());
        files::output(report, &inputs)?;
    }
    Ok(())
}

/// Writes the model with all effects that can be added; as it was where there is none.
fn add(given: &Given, finding: &Finding, file: &Path) -> Result<Vec<String>, OfflineError> {
    let places = finding.addable();
    let effects: Vec<&NamedEffect> = places.iter().map(|&i| &finding.effects[i]).collect();
    let model = if places.is_empty() {
        given.model.clone()
    } else {
        // A search that began with effects finds what is missing beside them.
        let of = (finding, given.sessions.as_slice());
        rig_models::with(
            &given.model,
            &given.rig,
            of,
            &places,
            given.model.is_nominal(),
            jiff::Timestamp::now(),
        )
        .map_err(|error| OfflineError::NotAdded(error.to_string()))?
    };
    model.write(file, &given.rig)?;
    Ok(effects.into_iter().map(|effect| name(&effect.id, &effect.site)).collect())
}

fn write_report(given: &Given, finding: &Finding, file: &Path) -> Result<(), OfflineError> {
    let page = ReportContext {
        date: jiff::Zoned::now().strftime("%-d %B %Y").to_string(),
        model: plumbline_engine::gap::model_name(&given.model),
        history: plumbline_engine::gap::history(&given.model),
        screen_m: finding
            .comparison
            .kinds
            .iter()
            .any(|kind| kind.what == What::Touch)
            .then(|| given.rig.touchscreen.corners().map(|corner| [corner.coords.x, corner.coords.y])),
    };
    let is_pdf = file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("pdf"));
    let bytes = if is_pdf {
        plumbline_report::pdf(finding, &page)?
    } else {
        plumbline_report::html(finding, &page).into_bytes()
    };
    Ok(files::write(file, bytes)?)
}

/// All that a search is made on.
pub(super) struct Given {
    pub sessions: Vec<Session>,
    pub rig: Rig,
    model: RigModel,
    measurements: Measurements,
    /// Whether the model that was given is one with effects, whose file keeps what it was before.
    has_history: bool,
}

/// Reads all sessions; their robot is that of the first one, or of the rig model.
pub(super) fn read(folders: &[PathBuf], rig_model: Option<&Path>) -> Result<Given, OfflineError> {
    let sessions: Vec<(String, Session)> = folders
        .iter()
        .map(|folder| Ok((title_of(folder), Session::read(folder)?)))
        .collect::<Result<_, OfflineError>>()?;
    let Some((first, folder)) = sessions.first().zip(folders.first()) else {
        return Err(plumbline_effects::MeasurementsError::NoSession.into());
    };
    let mut rig = rig_of(&first.1, folder)?;
    for ((title, other), folder) in sessions.iter().zip(folders).skip(1) {
        same_rig(&rig, &rig_of(other, folder)?, title)?;
    }
    let mut model = RigModel::nominal(&rig);
    let mut has_history = false;
    if let Some(file) = rig_model {
        match ModelFile::read(file, &rig)? {
            ModelFile::Rig(other) => {
                same_rig(&rig, &other, &file.display().to_string())?;
                rig = *other;
            }
            ModelFile::Placement(placement) => rig.touchscreen = placement.screen,
            ModelFile::Effects(effects) => {
                model = *effects;
                has_history = true;
            }
        }
    }
    // What grows as the eyes warm up counts from the calibration by which places were localized.
    if let Some(newest) = newest_localized(sessions.iter().map(|(_, session)| session)) {
        rig.eyes.calibrated_at = newest.manifest.calibrated_at();
    }
    let measurements = model.put_into(Measurements::of_sessions(&sessions, &rig)?);
    let sessions = sessions.into_iter().map(|(_, session)| session).collect();
    Ok(Given { sessions, rig, model, measurements, has_history })
}

impl GapReport {
    /// The report of a finding.
    pub fn of(finding: Finding) -> Self {
        Self {
            verdict: finding.verdict,
            sentence: finding.sentence.clone(),
            effects: finding.effects.iter().map(EffectReport::of).collect(),
            held_out: held_out(&finding),
            partial: finding.partial,
            many: finding.many,
            unexplained: UnexplainedReport {
                p_value: finding.unexplained.p_value,
                depends_on: finding.unexplained.depends_on.iter().map(dependence).collect(),
                probability: finding.unexplained.probability,
            },
            undetermined: finding
                .undetermined
                .iter()
                .map(|one| UndeterminedReport {
                    parameters: one.parameters.clone(),
                    words: one.words.clone(),
                })
                .collect(),
            next_experiment: finding.next.as_ref().map(NextReport::of),
            warnings: finding.warnings.clone(),
            left_out: finding.left_out.len(),
            seconds: finding.seconds,
            added: vec![],
            finding,
        }
    }
}

impl EffectReport {
    fn of(effect: &NamedEffect) -> Self {
        let parameter = |found: &plumbline_gap::finding::FoundParameter| {
            let value = match &found.text {
                Some(text) => ParameterReport::Text(text.clone()),
                None => ParameterReport::Number { value: found.value, low: found.low, high: found.high },
            };
            (found.name.clone(), value)
        };
        Self {
            id: effect.id.clone(),
            site: effect.site.clone(),
            probability: effect.probability,
            parameters: effect.parameters.iter().map(parameter).collect(),
            class: effect.class.iter().map(|member| name(&member.id, &member.site)).collect(),
            class_probability: effect.class_probability,
            split_by: effect.split_by.clone(),
            runner_up: effect.runner_up.clone(),
            not_addable: effect.not_addable.clone(),
        }
    }
}

impl NextReport {
    fn of(next: &NextExperiment) -> Self {
        Self {
            what: next.what.clone(),
            why: next.why.clone(),
            expected_probability: next.expected_probability,
            minutes: next.minutes,
        }
    }
}

/// `joint-zero@r_elbow_y`; only the kind where there is one place.
pub(crate) fn name(id: &str, site: &str) -> String {
    if site.is_empty() { id.to_owned() } else { format!("{id}@{site}") }
}

fn dependence(on: &Dependence) -> String {
    let formula = on.formula.as_ref().map_or_else(String::new, |formula| format!(": {formula}"));
    format!("{} on {}{formula}", on.of, on.on)
}

/// The numbers with the unit in their keys.
fn held_out(finding: &Finding) -> Map<String, Value> {
    let shown = &finding.shown;
    let (unit, scale) = match shown.unit {
        ShownUnit::Meter => ("mm", 1e3),
        ShownUnit::Pixel => ("px", 1.0),
    };
    let mut keys = Map::new();
    keys.insert("rows".to_owned(), shown.rows.into());
    for (name, value) in [("before", shown.before), ("after", shown.after), ("floor", shown.floor)] {
        keys.insert(format!("{name}_{unit}"), (value * scale).into());
    }
    keys.insert("floor_from".to_owned(), finding.comparison.floor_source.word().into());
    keys.insert("closure".to_owned(), shown.closure.into());
    keys.insert("closure_range".to_owned(), shown.closure_range.map(Vec::from).into());
    keys.insert("blocks".to_owned(), shown.blocks.clone().into());
    if let Some(part) = &shown.part {
        let mut of = Map::new();
        of.insert(format!("after_{unit}"), (part.after * scale).into());
        of.insert("closure".to_owned(), part.closure.into());
        of.insert("closure_range".to_owned(), part.closure_range.map(Vec::from).into());
        keys.insert("addable_alone".to_owned(), of.into());
    }
    if let Some(unseen) = &shown.unseen {
        let mut of = Map::new();
        of.insert("what".to_owned(), unseen.what.clone().into());
        of.insert("rows".to_owned(), unseen.rows.into());
        for (name, value) in [("before", unseen.before), ("after", unseen.after), ("floor", unseen.floor)] {
            of.insert(format!("{name}_{unit}"), (value * scale).into());
        }
        keys.insert("unseen".to_owned(), of.into());
    }
    keys
}
