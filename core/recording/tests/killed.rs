//! A program that records and is killed: what it had closed is there.

use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use jiff::{SignedDuration, Timestamp};
use plumbline_recording::{About, Jpeg, Recording, RecordingWriter};

const FOLDER: &str = "PLUMBLINE_TEST_RECORDS_TO";
const TEST: &str = "all_closed_records_are_there_after_a_kill";
/// Pairs in a chunk: ten a second of the recording's clock.
const CLOSED: u64 = 10;

fn image(number: u64) -> Jpeg {
    Jpeg([&number.to_le_bytes()[..], &vec![(number % 251) as u8; 20_000]].concat())
}

/// Records without end, and says after each chunk how many pairs must be there.
#[allow(clippy::print_stdout, reason = "the parent reads it")]
fn record(file: &Path) {
    let start = Timestamp::UNIX_EPOCH + SignedDuration::from_hours(24);
    let mut writer = RecordingWriter::create(file, start, &About::default()).expect("begun");
    for number in 0..200_000 {
        let at = start + SignedDuration::from_millis(100 * i64::try_from(number).expect("small"));
        writer.pair(at, number, [image(number), image(number + 1)], None).expect("written");
        if number > 0 && number % CLOSED == 0 {
            println!("closed {number}");
        }
    }
}

#[test]
fn all_closed_records_are_there_after_a_kill() {
    if let Some(file) = std::env::var_os(FOLDER) {
        return record(Path::new(&file));
    }
    let folder = tempfile::tempdir().expect("a folder");
    for kill in 0..100 {
        let file = folder.path().join(format!("{kill}.mcap"));
        let mut child = Command::new(std::env::current_exe().expect("a test has a file"))
            .args([TEST, "--exact", "--nocapture"])
            .env(FOLDER, &file)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .expect("started");
        let mut lines = BufReader::new(child.stdout.take().expect("piped")).lines();
        let mut closed = 0;
        let mut take = |closed: &mut u64| {
            let line = lines.next().expect("it records").expect("readable");
            if let Some(number) = line.split("closed ").nth(1).and_then(|number| number.parse().ok()) {
                *closed = number;
            }
        };
        while closed < CLOSED * (1 + kill % 3) {
            take(&mut closed);
        }
        std::thread::sleep(Duration::from_micros(137 * (kill * 29 % 41)));
        child.kill().expect("killed");
        child.wait().expect("gone");
        // What it said before it was killed and we have not heard yet.
        let rest = lines.map_while(Result::ok).filter_map(|l| l.split("closed ").nth(1)?.parse().ok()).last();
        let closed = rest.unwrap_or(closed);
        let mut recording = Recording::open(&file).expect("a recording");
        let pairs = recording.pair_count() as u64;
        assert!(!recording.is_whole() && pairs >= closed, "kill {kill}: {pairs} pairs, closed {closed}");
        for number in [0, closed - 1, pairs - 1] {
            let pair = recording.pair(number as usize).expect("readable");
            assert_eq!(pair.images, [image(number), image(number + 1)], "kill {kill}");
        }
        std::fs::remove_file(&file).expect("removed");
    }
}
