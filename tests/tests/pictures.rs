//! What makes the pictures of the documentation asks the window only for what it can do.

#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::process::Command;

use plumbline::ScriptStep;

/// The program and the tools around it stand still, and what the window would be started with is
/// printed: words end with a zero byte, starts with a line.
const STUBS: &str = r#"
set -euo pipefail
the_program() { :; }
the_program/blind-cases() { :; }
program=the_program
xvfb-run() {
    while [[ "$1" != "$program" ]]; do shift; done
    printf '%s\0' "$@"
    printf '\n'
}
mktemp() { printf '%s' "$PWD"; }
mkdir() { :; }
rm() { :; }
say() { :; }
"#;

fn repository_file(name: &str) -> String {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name);
    fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()))
}

#[test]
fn the_window_understands_every_step_that_pictures_are_made_with() {
    let script = repository_file("plumbline");
    let from = script.find("\npictures() {\n").expect("the verb") + 1;
    let to = from + script[from..].find("\n}\n").expect("its end") + 3;
    let work = tempfile::tempdir().expect("a temporary folder");
    // A source is a folder that is there.
    fs::create_dir(work.path().join("board")).expect("writable");
    let text = format!("{STUBS}{}pictures\n", &script[from..to]);
    let said = Command::new("bash").arg("-c").arg(text).current_dir(&work).output().expect("bash runs");
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    let starts = String::from_utf8(said.stdout).expect("text");
    let mut count = 0;
    for start in starts.lines() {
        let words = start.split_terminator('\0').map(str::to_owned);
        if let Err(why) = plumbline::understands(words) {
            panic!("{}\n{why}", start.replace('\0', " "));
        }
        count += 1;
    }
    assert!(count >= 9, "pictures of every screen are made: {starts}");
}

#[test]
fn the_steps_that_people_read_about_are_understood() {
    let text = repository_file("app/README.md");
    let steps = text.split("--do \"").skip(1).filter_map(|rest| rest.split('"').next());
    let steps: Vec<&str> = steps.flat_map(|steps| steps.split(';')).collect();
    assert!(!steps.is_empty(), "the page shows how it is done");
    for step in steps {
        assert!(step.parse::<ScriptStep>().is_ok(), "{step}: {:?}", step.parse::<ScriptStep>());
    }
}

/// The recipes that put an experiment on many machines, as their machines fill them in.
#[test]
fn the_recipes_for_many_machines_are_understood() {
    let text = repository_file("docs/command-line.md");
    let calls: Vec<&str> = text
        .split("```sh\n")
        .skip(1)
        .filter_map(|block| block.split("```").next())
        .flat_map(str::lines)
        .filter_map(|line| Some(&line[line.find("plumbline grasp-trials")?..]))
        .map(|call| call.split(['\'', '#']).next().unwrap_or(call))
        .map(|call| call.split(" ::: ").next().unwrap_or(call))
        .collect();
    assert!(calls.len() >= 4, "one for each way: {calls:?}");
    for call in calls {
        let filled = call
            .replace("$((JOB_COMPLETION_INDEX + 1))", "3")
            .replace("$JOB_COMPLETION_INDEX", "2")
            .replace("$SLURM_ARRAY_TASK_ID", "3")
            .replace("{}", "3");
        assert!(!filled.contains(['$', '{']), "{filled}");
        if let Err(why) = plumbline::understands(filled.split_whitespace().map(str::to_owned)) {
            panic!("{filled}\n{why}");
        }
    }
}
