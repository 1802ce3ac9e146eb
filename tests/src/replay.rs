//! What was done by clicks is done once more from the journal that the program wrote of it, and has to
//! end in the same.

use std::fs::{self, File, FileTimes};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use jiff::{SignedDuration, Timestamp};
use plumbline_engine::View;
use plumbline_engine::journal::{self, Heading, Line};
use plumbline_engine::replay::Replay;
use plumbline_engine::view::KeptView;
use tempfile::TempDir;

use crate::{Window, until, view};

/// Nothing is under way any more when nothing new has been shown for this long; the engine looks after
/// its threads twice a second.
const QUIET: Duration = Duration::from_millis(700);

/// A folder as it was before anything was clicked, with the program's data folder `data` in it.
pub struct Beginning {
    folder: PathBuf,
    kept: TempDir,
}

impl Beginning {
    /// Keeps what is in the folder.
    ///
    /// # Panics
    /// When it cannot be copied.
    pub fn of(folder: &Path) -> Self {
        let kept = tempfile::tempdir().expect("a temporary folder");
        copy(folder, kept.path());
        Self { folder: folder.to_owned(), kept }
    }

    /// Closes the window, begins anew in the same folder, and does from the journal what was clicked;
    /// twice. Each time every view ends, byte for byte, as the window showed it.
    ///
    /// Left out are how many views were published and where the journal lies, which are of that start
    /// of the program and not of what was done, and what `forget` takes out.
    ///
    /// # Panics
    /// When a replay ends otherwise.
    pub fn leads_to_what_is_shown(self, mut window: Window, forget: impl Fn(&mut View)) -> Recorded {
        settle(&mut window);
        let shown = View::clone(&view(&window));
        drop(window);
        assert_eq!((shown.lost_commands, shown.kept.journal_lost), (0, 0), "the journal is whole");
        let file = shown.kept.journal.clone().expect("a journal is kept");
        let (heading, lines) = journal::read_lines(&file).expect("a journal");
        assert!(lines.len() > 10, "{} lines", lines.len());
        let in_the_end = text(shown, &forget);
        for _ in 0..2 {
            is_the_same(&text(self.replayed(&heading, &lines), &forget), &in_the_end);
        }
        Recorded { beginning: self, heading, lines, in_the_end }
    }

    fn replayed(&self, heading: &Heading, lines: &[Line]) -> View {
        self.restore();
        let mut replay = Replay::new(&self.folder.join("data"), heading);
        for line in lines {
            replay.take(line.clone());
        }
        replay.view()
    }

    fn restore(&self) {
        fs::remove_dir_all(&self.folder).expect("removed");
        copy(self.kept.path(), &self.folder);
    }
}

/// What was done, and how it ended.
pub struct Recorded {
    beginning: Beginning,
    heading: Heading,
    lines: Vec<Line>,
    in_the_end: String,
}

impl Recorded {
    /// Does it all once more an hour later by the journal's time of day: it has to end otherwise, or the
    /// comparison would not see a workflow that reads a clock.
    ///
    /// # Panics
    /// When it ends in the same.
    pub fn ends_otherwise_an_hour_later(mut self) {
        let later = |day: &mut Timestamp| *day += SignedDuration::from_hours(1);
        for line in &mut self.lines {
            match line {
                Line::Event(event) => later(&mut event.day),
                Line::Command(entry) => entry.day.iter_mut().for_each(later),
            }
        }
        let otherwise = text(self.beginning.replayed(&self.heading, &self.lines), |_| {});
        assert_ne!(otherwise, self.in_the_end, "the time of day is seen in the view");
    }
}

/// With the times of its files: lists are in their order.
fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("made");
    for entry in fs::read_dir(from).expect("a folder").map(|entry| entry.expect("readable")) {
        let (path, copied) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            copy(&path, &copied);
            continue;
        }
        fs::copy(&path, &copied).expect("copied");
        let modified = entry.metadata().and_then(|known| known.modified()).expect("a time");
        let file = File::options().write(true).open(&copied).expect("copied");
        file.set_times(FileTimes::new().set_modified(modified)).expect("the time is kept");
    }
}

fn settle(window: &mut Window) {
    let (mut newest, mut since) = (view(window).revision, Instant::now());
    loop {
        until(window, "the work to end", |window| view(window).running_job().is_none());
        let revision = view(window).revision;
        if revision != newest {
            (newest, since) = (revision, Instant::now());
        } else if since.elapsed() > QUIET {
            return;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

fn text(mut view: View, forget: impl Fn(&mut View)) -> String {
    (view.revision, view.kept) = (0, Arc::new(KeptView::default()));
    forget(&mut view);
    format!("{view:#?}")
}

fn is_the_same(replayed: &str, in_the_end: &str) {
    if replayed == in_the_end {
        return;
    }
    let same = replayed.lines().zip(in_the_end.lines()).take_while(|(a, b)| a == b).count();
    let around = |text: &str| -> String {
        text.lines().skip(same.saturating_sub(12)).take(24).map(|line| format!("{line}\n")).collect()
    };
    panic!("the replay differs:\n{}\nand not\n{}", around(replayed), around(in_the_end));
}
