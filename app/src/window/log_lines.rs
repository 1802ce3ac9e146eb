//! The program's own log, kept for the log panel and written to standard error.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use jiff::Zoned;
use log::{Level, LevelFilter, Log, Metadata, Record};

/// One line.
#[derive(Clone, Debug, PartialEq)]
pub struct LogLine {
    /// Counts up.
    pub number: u64,
    /// Local time.
    pub at: Zoned,
    /// How much it matters.
    pub level: Level,
    /// The module that said it.
    pub target: String,
    /// What it said.
    pub text: String,
}

impl LogLine {
    /// As it is copied and written.
    pub fn text(&self) -> String {
        format!("{} {:5} {}: {}", self.at.strftime("%H:%M:%S%.3f"), self.level, self.target, self.text)
    }
}

/// Where the lines are.
#[derive(Debug, Default)]
pub struct LogStore {
    lines: Mutex<(u64, VecDeque<Arc<LogLine>>)>,
}

/// How many lines are kept.
const KEPT: usize = 2000;

impl LogStore {
    fn add(&self, record: &Record<'_>) {
        let mut lines = self.lines.lock().unwrap_or_else(PoisonError::into_inner);
        if lines.1.len() == KEPT {
            lines.1.pop_front();
        }
        lines.0 += 1;
        let number = lines.0;
        lines.1.push_back(Arc::new(LogLine {
            number,
            at: Zoned::now(),
            level: record.level(),
            target: record.target().to_owned(),
            text: record.args().to_string(),
        }));
    }

    /// Number of the newest line.
    pub fn newest(&self) -> u64 {
        self.lines.lock().unwrap_or_else(PoisonError::into_inner).0
    }

    /// All that are kept, oldest first.
    pub fn snapshot(&self) -> Vec<Arc<LogLine>> {
        self.lines.lock().unwrap_or_else(PoisonError::into_inner).1.iter().cloned().collect()
    }
}

struct Logger {
    store: Arc<LogStore>,
    to_stderr: LevelFilter,
}

/// Own modules tell everything from `info` on, other people's only what is wrong.
fn is_wanted(metadata: &Metadata<'_>) -> bool {
    if metadata.target().starts_with("plumbline") {
        metadata.level() <= Level::Debug
    } else {
        metadata.level() <= Level::Warn
    }
}

impl Log for Logger {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        is_wanted(metadata)
    }

    fn log(&self, record: &Record<'_>) {
        if !is_wanted(record.metadata()) {
            return;
        }
        if record.level() <= self.to_stderr && record.target().starts_with("plumbline") {
            use std::io::Write as _;
            // A closed terminal is no reason to stop.
            let _ =
                writeln!(std::io::stderr(), "{}: {}", record.level().as_str().to_lowercase(), record.args());
        }
        self.store.add(record);
    }

    fn flush(&self) {}
}

/// Starts logging; later calls return the same store.
pub fn start(to_stderr: LevelFilter) -> Arc<LogStore> {
    static STORE: OnceLock<Arc<LogStore>> = OnceLock::new();
    STORE
        .get_or_init(|| {
            let store = Arc::new(LogStore::default());
            let logger = Logger { store: Arc::clone(&store), to_stderr };
            if log::set_boxed_logger(Box::new(logger)).is_ok() {
                log::set_max_level(LevelFilter::Debug);
            }
            store
        })
        .clone()
}
