//! A disk that has no more room: the recording ends, says so, and holds what it had closed.

use std::path::Path;
use std::process::Command;

use jiff::{SignedDuration, Timestamp};
use plumbline_recording::{About, Jpeg, Recording, RecordingError, RecordingWriter};

const FILE: &str = "PLUMBLINE_TEST_RECORDS_TO";
const TEST: &str = "a_full_disk_ends_a_recording_and_loses_no_closed_second";
/// Room for the file, blocks of 512 bytes.
const ROOM_BLOCKS: u32 = 1000;
/// Pairs in a chunk: ten a second of the recording's clock.
const CLOSED: u64 = 10;

fn image(number: u64) -> Jpeg {
    Jpeg([&number.to_le_bytes()[..], &vec![(number % 251) as u8; 7_000]].concat())
}

/// Records until it is refused; says how many pairs were closed before.
#[allow(clippy::print_stdout, reason = "the parent reads it")]
fn record(file: &Path) {
    let start = Timestamp::UNIX_EPOCH + SignedDuration::from_hours(24);
    let mut writer = RecordingWriter::create(file, start, &About::default()).expect("begun");
    for number in 0..1000 {
        let at = start + SignedDuration::from_millis(100 * i64::try_from(number).expect("small"));
        if let Err(error) = writer.pair(at, number, [image(number), image(number + 1)], None) {
            assert!(matches!(error, RecordingError::Io { .. }), "{error:?}");
            assert!(error.to_string().contains("check that the disk is there and has room"), "{error}");
            // Dropping it writes what it can, and must not wait or fail.
            drop(writer);
            // The pair that was refused would have begun a chunk.
            println!("closed {}", (number / CLOSED).saturating_sub(1) * CLOSED);
            return;
        }
    }
    panic!("there was room for everything");
}

#[test]
fn a_full_disk_ends_a_recording_and_loses_no_closed_second() {
    if let Some(file) = std::env::var_os(FILE) {
        return record(Path::new(&file));
    }
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("log.mcap");
    // The shell takes the room away for the child alone; the signal that goes with it would end the child.
    let script = format!("trap '' XFSZ; ulimit -f {ROOM_BLOCKS}; exec \"$0\" {TEST} --exact --nocapture");
    let child = Command::new("sh")
        .args(["-c", &script])
        .arg(std::env::current_exe().expect("a test has a file"))
        .env(FILE, &file)
        .output()
        .expect("started");
    let said = String::from_utf8_lossy(&child.stdout).into_owned();
    assert!(child.status.success(), "{said}\n{}", String::from_utf8_lossy(&child.stderr));
    let closed = said.lines().filter_map(|line| line.split("closed ").nth(1)).next_back();
    let closed: u64 = closed.and_then(|number| number.parse().ok()).expect("it said so");
    assert!(closed >= 2 * CLOSED, "the room was for more than that: {closed}");
    let length = std::fs::metadata(&file).expect("there").len();
    assert!(length <= u64::from(ROOM_BLOCKS) * 1024, "{length} bytes");
    let mut recording = Recording::open(&file).expect("what is there can be read");
    let pairs = recording.pair_count() as u64;
    assert!(!recording.is_whole() && pairs >= closed, "{pairs} pairs, closed {closed}");
    for number in 0..pairs {
        let pair = recording.pair(number as usize).expect("readable");
        assert_eq!(pair.images, [image(number), image(number + 1)], "pair {number}");
    }
}
