//! What was done by clicks is done once more from the journal that the program wrote of it, and has to
//! end in the same.

use std::fs::{self, File, FileTimes};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_engine::replay::Replay;
use plumbline_engine::view::KeptView;
use plumbline_engine::{View, journal};
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
    pub fn leads_to_what_is_shown(self, mut window: Window, forget: impl Fn(&mut View)) {
        settle(&mut window);
        let shown = View::clone(&view(&window));
        drop(window);
        assert_eq!((shown.lost_commands, shown.kept.journal_lost), (0, 0), "the journal is whole");
        let file = shown.kept.journal.clone().expect("a journal is kept");
        let (heading, lines) = journal::read_lines(&file).expect("a journal");
        assert!(lines.len() > 10, "{} lines", lines.len());
        let in_the_end = text(shown, &forget);
        for _ in 0..2 {
            self.restore();
            let mut replay = Replay::new(&self.folder.join("data"), &heading);
            for line in &lines {
                replay.take(line.clone());
            }
            is_the_same(&text(replay.view(), &forget), &in_the_end);
        }
    }

    fn restore(&self) {
        fs::remove_dir_all(&self.folder).expect("removed");
        copy(self.kept.path(), &self.folder);
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
