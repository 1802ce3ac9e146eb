//! Every command, written down as it is applied, so that a bug report is a replay.
//!
//! One JSON object per line: a heading, then in the order in which the engine took them in: one entry
//! per command, with the number of the pair that was newest at that moment, and one per event, which
//! says when work came to its end. What a connected robot and a source bring is not in it.

use std::fs::File;
use std::io::{BufRead, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use crossbeam_channel::{Receiver, Sender};
use jiff::Timestamp;
use plumbline_model::files::{self, FileError, Size};
use serde::{Deserialize, Serialize};

use crate::command::Command;
use crate::ground::bell::Bell;
use crate::ground::notice::NoticeLevel;
use crate::ground::watched::{self, Pulse, Trial, Watched, WatchedThread};
use crate::live::command::LiveCommand;

/// First line of a journal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Heading {
    /// Version of this format: 2. The first had no events and no time of day.
    pub journal: u32,
    /// Program and version.
    pub software: String,
    /// When the program was started, UTC.
    pub started: Timestamp,
}

/// One command and when it was applied.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Since the program was started, seconds.
    pub at_secs: f64,
    /// The time of day, UTC; `None` in journals of the first version.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub day: Option<Timestamp>,
    /// Number of the newest pair when it was applied.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub newest_seq: Option<u64>,
    /// What was asked.
    #[serde(flatten)]
    pub command: Command,
}

/// Something that came from what works beside the engine, and when it was taken in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Since the program was started, seconds.
    pub at_secs: f64,
    /// The time of day, UTC.
    pub day: Timestamp,
    /// What it was.
    #[serde(flatten)]
    pub happened: Happened,
}

/// What came from what works beside the engine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "happened", rename_all = "snake_case")]
pub enum Happened {
    /// Work came to its end; what came of it follows from the work.
    WorkEnded {
        /// Number of the job, counted from 1 in the order in which work was asked for.
        job: u64,
        /// How long it took, seconds.
        took_s: f64,
        /// Whether it was cancelled.
        cancelled: bool,
    },
    /// The robot's side, with nothing connected, told how it is.
    RobotTold,
    /// The robot's side or the source had a message for the operator.
    Noted {
        /// How it is meant.
        level: NoticeLevel,
        /// A sentence.
        text: String,
    },
}

/// A line of a journal after its heading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Line {
    /// Something happened beside the engine.
    Event(Event),
    /// The operator asked for something.
    Command(Entry),
}

impl Line {
    fn is_command(&self) -> bool {
        matches!(self, Self::Command(_))
    }
}

/// Why a journal cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The file system says no.
    #[error(
        "{path}: {error}. Check that the folder exists and can be written, or choose another data folder."
    )]
    Io {
        /// Which file.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
    /// It is no file that can be read as a journal.
    #[error(transparent)]
    File(#[from] FileError),
    /// A line is not what it should be.
    #[error(
        "{path}, line {line}: {reason}. This is not a journal of this program, or it was edited by hand."
    )]
    Line {
        /// Which file.
        path: PathBuf,
        /// From 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
}

/// Writes entries on a thread of its own, so that a slow disk holds nothing up.
pub struct Journal {
    file: PathBuf,
    entries: Option<Sender<Line>>,
    /// Commands that were not taken, because too many waited or the writer has ended.
    refused: u64,
    handed_over: u64,
    written: Arc<AtomicU64>,
    waiting_probe: Option<Entry>,
    writer: Watched,
}

/// Entries that may wait for the disk.
const WAITING: usize = 1024;
/// Journals that are kept.
const KEPT: usize = 30;
/// A disk that takes longer for one line is worth a word.
const SILENT: Duration = Duration::from_secs(3);

impl Journal {
    /// Starts a journal in a folder, which is made if it is not there.
    pub fn start(folder: &Path) -> Result<Self, JournalError> {
        Self::start_watched(folder, Pulse::new(WatchedThread::Journal, Bell::new().0, Trial::default()))
    }

    /// The same, for somebody who looks after its thread.
    pub fn start_watched(folder: &Path, pulse: Pulse) -> Result<Self, JournalError> {
        let io = |path: &Path| {
            let path = path.to_owned();
            move |error| JournalError::Io { path, error }
        };
        std::fs::create_dir_all(folder).map_err(io(folder))?;
        forget_oldest(folder);
        let started = Timestamp::now();
        let path = folder.join(format!(
            "{}_{}.jsonl",
            started.strftime("%Y-%m-%dT%H-%M-%S%.3f"),
            std::process::id()
        ));
        let mut file = BufWriter::new(File::create_new(&path).map_err(io(&path))?);
        let heading = Heading { journal: 2, software: crate::ground::software(), started };
        write_line(&mut file, &heading).map_err(io(&path))?;
        Self::write_to(path, file, pulse).map_err(io(folder))
    }

    fn write_to(path: PathBuf, file: BufWriter<File>, pulse: Pulse) -> std::io::Result<Self> {
        let (entries, waiting) = crossbeam_channel::bounded(WAITING);
        let written = Arc::new(AtomicU64::new(0));
        let count = written.clone();
        let name = path.display().to_string();
        let work = move |file: &mut BufWriter<File>, pulse: &Pulse| {
            write_entries(file, &waiting, &count, &name, pulse);
        };
        let writer = watched::spawn(pulse, file, work)?;
        Ok(Self {
            file: path,
            entries: Some(entries),
            refused: 0,
            handed_over: 0,
            written,
            waiting_probe: None,
            writer,
        })
    }

    /// Where it is written.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Whether its thread does its work.
    pub fn watched(&self) -> &Watched {
        &self.writer
    }

    /// Hands an entry to the writer; never waits.
    pub fn note(&mut self, entry: Entry) {
        // The mouse moves the probe sixty times a second: of a row of probes only the last one
        // says anything.
        if matches!(entry.command, Command::Live(LiveCommand::Probe(_))) {
            self.waiting_probe = Some(entry);
            return;
        }
        if let Some(probe) = self.waiting_probe.take() {
            self.hand_over(Line::Command(probe));
        }
        self.hand_over(Line::Command(entry));
    }

    /// Hands an event to the writer; never waits.
    pub fn note_event(&mut self, event: Event) {
        if let Some(probe) = self.waiting_probe.take() {
            self.hand_over(Line::Command(probe));
        }
        self.hand_over(Line::Event(event));
    }

    /// Commands that were lost because the disk did not keep up, or does not take any more.
    pub fn lost(&self) -> u64 {
        let has_failed = self.writer.pulse().has_failed();
        let unwritten = self.handed_over.saturating_sub(self.written.load(Ordering::Acquire));
        self.refused + if has_failed { unwritten } else { 0 }
    }

    fn hand_over(&mut self, line: Line) {
        let Some(entries) = &self.entries else { return };
        // What came by itself is not what somebody asked for, which is what is counted.
        let count = u64::from(line.is_command());
        match entries.try_send(line) {
            Ok(()) => self.handed_over += count,
            Err(_) => self.refused += count,
        }
    }
}

impl Drop for Journal {
    fn drop(&mut self) {
        if let Some(probe) = self.waiting_probe.take() {
            self.hand_over(Line::Command(probe));
        }
        self.writer.ask_to_end();
        // What waits is written before the writer, which is waited for, comes to its end.
        self.entries = None;
    }
}

/// Reads the commands of a journal. A last line without an end, as a crash leaves it, is left out.
///
/// # Errors
/// When it cannot be read, or is no journal.
pub fn read(path: &Path) -> Result<(Heading, Vec<Entry>), JournalError> {
    let (heading, lines) = read_lines(path)?;
    let command = |line| match line {
        Line::Command(entry) => Some(entry),
        Line::Event(_) => None,
    };
    Ok((heading, lines.into_iter().filter_map(command).collect()))
}

/// Reads commands and events of a journal. A last line without an end is left out.
///
/// # Errors
/// When it cannot be read, or is no journal.
pub fn read_lines(path: &Path) -> Result<(Heading, Vec<Line>), JournalError> {
    let io = |error| JournalError::Io { path: path.to_owned(), error };
    let bad = |line: usize, reason: String| JournalError::Line { path: path.to_owned(), line, reason };
    // A pipe would never answer, a device never end.
    let mut reader = BufReader::new(files::open(path, Size::TEXT)?);
    let mut text = String::new();
    reader.read_line(&mut text).map_err(io)?;
    let heading: Heading = serde_json::from_str(&text).map_err(|error| bad(1, error.to_string()))?;
    let mut entries = Vec::new();
    for line in 2.. {
        text.clear();
        reader.read_line(&mut text).map_err(io)?;
        if !text.ends_with('\n') {
            break;
        }
        entries.push(serde_json::from_str(&text).map_err(|error| bad(line, error.to_string()))?);
    }
    Ok((heading, entries))
}

fn write_line(file: &mut impl Write, value: &impl Serialize) -> std::io::Result<()> {
    serde_json::to_writer(&mut *file, value)?;
    file.write_all(b"\n")?;
    file.flush()
}

fn write_entries(
    file: &mut BufWriter<File>,
    waiting: &Receiver<Line>,
    written: &AtomicU64,
    name: &str,
    pulse: &Pulse,
) {
    for entry in waiting {
        pulse.promise(SILENT);
        if let Err(error) = write_line(file, &entry) {
            // One broken line is left out by whoever reads it; a second one would be taken for damage.
            return pulse.fail(&format!("{name}: {error}"));
        }
        if entry.is_command() {
            written.fetch_add(1, Ordering::Release);
        }
        pulse.rest();
    }
}

fn forget_oldest(folder: &Path) {
    let Ok(listing) = std::fs::read_dir(folder) else { return };
    let mut journals: Vec<PathBuf> = listing
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "jsonl"))
        .collect();
    // Names begin with the time, so they sort by age.
    journals.sort();
    for path in journals.iter().take(journals.len().saturating_sub(KEPT - 1)) {
        if let Err(error) = std::fs::remove_file(path) {
            log::warn!("an old journal stays: {}: {error}", path.display());
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;
    use crate::eyes::command::EyesCommand;
    use crate::live::command::ProbePoint;
    use crate::source::command::SourceCommand;

    fn entry(at_secs: f64, command: impl Into<Command>) -> Entry {
        Entry { at_secs, day: None, newest_seq: Some(3), command: command.into() }
    }

    fn only_file(folder: &Path) -> PathBuf {
        let mut listing = std::fs::read_dir(folder).expect("folder");
        listing.next().expect("a journal").expect("readable").path()
    }

    #[test]
    fn what_never_ends_is_no_journal() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let endless = folder.path().join("journal.jsonl");
        std::os::unix::fs::symlink("/dev/zero", &endless).expect("a link");
        let error = read(&endless).expect_err("a device").to_string();
        assert!(error.contains("journal.jsonl") && error.contains("not a file"), "{error}");
        assert!(read(folder.path()).is_err());
    }

    #[test]
    fn what_was_noted_is_read_back() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let commands = [
            entry(0.5, SourceCommand::OpenPaths(vec!["pairs".into()])),
            entry(1.0, EyesCommand::ChooseBoard { columns: 9, rows: 6, square_m: 0.03 }),
            entry(1.5, EyesCommand::Capture),
            entry(2.0, EyesCommand::DropPair { pair: "frame_09.png".into() }),
        ];
        let mut journal = Journal::start(folder.path()).expect("writable");
        for entry in &commands {
            journal.note(entry.clone());
        }
        drop(journal);
        let (heading, entries) = read(&only_file(folder.path())).expect("readable");
        assert_eq!(heading.journal, 2);
        assert_eq!(entries, commands);
    }

    #[test]
    fn of_a_row_of_probes_the_last_is_kept() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let probe = |u_px| LiveCommand::Probe(ProbePoint::Rectified { u_px, v_px: 1.0 });
        let mut journal = Journal::start(folder.path()).expect("writable");
        for i in 0..50 {
            journal.note(entry(f64::from(i), probe(f64::from(i))));
        }
        journal.note(entry(50.0, LiveCommand::StopProbe));
        drop(journal);
        let (_, entries) = read(&only_file(folder.path())).expect("readable");
        assert_eq!(entries, [entry(49.0, probe(49.0)), entry(50.0, LiveCommand::StopProbe)]);
    }

    #[test]
    fn a_half_written_last_line_is_left_out_and_a_spoiled_line_is_named() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let mut journal = Journal::start(folder.path()).expect("writable");
        journal.note(entry(1.0, EyesCommand::Capture));
        drop(journal);
        let path = only_file(folder.path());
        let whole = std::fs::read_to_string(&path).expect("text");
        std::fs::write(&path, format!("{whole}{{\"at_secs\":2.0,\"workfl")).expect("writable");
        assert_eq!(read(&path).expect("readable").1.len(), 1);
        std::fs::write(&path, format!("{whole}not json\n")).expect("writable");
        let message = read(&path).expect_err("spoiled").to_string();
        assert!(message.contains("line 3"), "{message}");
    }

    #[test]
    fn a_full_disk_is_told_and_what_it_did_not_take_is_counted() {
        let full = Path::new("/dev/full");
        if !full.exists() {
            return;
        }
        let file = BufWriter::new(File::options().write(true).open(full).expect("a device that is full"));
        let (bell, rung) = Bell::new();
        let pulse = Pulse::new(WatchedThread::Journal, bell, Trial::default());
        let mut journal = Journal::write_to(full.to_owned(), file, pulse).expect("a thread");
        assert_eq!(journal.lost(), 0);
        for i in 0..5 {
            journal.note(entry(f64::from(i), EyesCommand::Capture));
        }
        rung.recv_timeout(Duration::from_secs(10)).expect("it is rung");
        match journal.watched().pulse().trouble(Instant::now()) {
            Some(watched::Trouble::Ended { said, .. }) => {
                assert!(said.contains("/dev/full") && said.contains("No space left"), "{said}");
            }
            other => panic!("{other:?}"),
        }
        assert_eq!(journal.lost(), 5);
        for i in 0..3 {
            journal.note(entry(f64::from(i), EyesCommand::Capture));
        }
        assert_eq!(journal.lost(), 8);
    }

    #[test]
    fn what_was_written_is_not_lost() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let mut journal = Journal::start(folder.path()).expect("writable");
        for i in 0..100 {
            journal.note(entry(f64::from(i), EyesCommand::Capture));
        }
        assert_eq!(journal.lost(), 0);
        let file = journal.file().to_owned();
        drop(journal);
        assert_eq!(read(&file).expect("readable").1.len(), 100);
    }

    #[test]
    fn old_journals_are_forgotten() {
        let folder = tempfile::tempdir().expect("temporary folder");
        for i in 0..KEPT + 5 {
            std::fs::write(folder.path().join(format!("2020-01-01T00-00-{i:03}.jsonl")), "{}")
                .expect("writable");
        }
        drop(Journal::start(folder.path()).expect("writable"));
        let count = std::fs::read_dir(folder.path()).expect("folder").count();
        assert_eq!(count, KEPT);
        assert!(!folder.path().join("2020-01-01T00-00-000.jsonl").exists());
    }
}
