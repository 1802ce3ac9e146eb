//! A fixed number of changed inputs through every reader: none may crash, hang or swell.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::Duration;

use plumbline_fuzz::run::{Options, Verdict, run};
use plumbline_fuzz::{readers, seeds};

/// Cases in the suite; the long run is a command.
const CASES: u64 = 4000;

#[test]
fn no_reader_crashes_hangs_or_swells() {
    let program = PathBuf::from(env!("CARGO_BIN_EXE_plumbline-fuzz"));
    let summary = run(&Options::new(program, CASES, 13)).expect("the run itself");
    assert_eq!(summary.not_run, Vec::<String>::new());
    for finding in &summary.findings {
        eprintln!("{finding:?}");
    }
    assert_eq!(summary.defects(), 0, "\n{summary}");
    assert!(summary.cases() >= CASES);
    assert_eq!(summary.tallies.len(), readers::all().len());
    // Cases that are all refused at the door, or all taken, test nothing.
    let (accepted, refused) = (summary.count(Verdict::Accepted), summary.count(Verdict::Refused));
    assert!(accepted > CASES / 10 && refused > CASES / 5, "{accepted} accepted, {refused} refused");
}

#[test]
fn every_reader_takes_what_is_not_changed() {
    let folder = tempfile::tempdir().expect("a folder");
    seeds::make(folder.path()).expect("seeds");
    for reader in readers::all() {
        let heard = (reader.read)(folder.path());
        let fault = plumbline_fuzz::check::fault(&heard, reader.finite);
        assert!(heard.accepted, "{}: {:?}", reader.name, heard.messages);
        assert_eq!(fault, None, "{}", reader.name);
    }
}

#[test]
fn every_kind_of_defect_is_found() {
    let program = PathBuf::from(env!("CARGO_BIN_EXE_plumbline-fuzz"));
    let keep = tempfile::tempdir().expect("a folder");
    let summary = run(&Options {
        only: "broken".to_owned(),
        patience: Duration::from_secs(2),
        keep: Some(keep.path().to_owned()),
        ..Options::new(program, 12, 1)
    })
    .expect("the run itself");
    let found: BTreeSet<(&str, Verdict)> =
        summary.findings.iter().map(|finding| (finding.reader.as_str(), finding.verdict)).collect();
    let expected = BTreeSet::from([
        ("broken-panic", Verdict::Panic),
        ("broken-thread", Verdict::Panic),
        ("broken-abort", Verdict::Abort),
        ("broken-hang", Verdict::Hang),
        ("broken-memory", Verdict::Memory),
        ("broken-fault", Verdict::Fault),
    ]);
    assert_eq!(found, expected, "\n{summary}");
    assert_eq!(summary.defects(), summary.cases());
    // What was found can be run again.
    let kept = keep.path().join("broken-fault-1-0");
    assert!(kept.join("input/arm").is_dir() && kept.join("case.json").is_file());
    let again = std::process::Command::new(env!("CARGO_BIN_EXE_plumbline-fuzz"))
        .arg("--replay")
        .arg(&kept)
        .output()
        .expect("it runs");
    let said = String::from_utf8_lossy(&again.stdout);
    assert!(again.status.code() == Some(1) && said.starts_with("fault: "), "{said}");
}
