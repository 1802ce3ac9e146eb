//! Makes some cases, searches them, and prints and scores what was said. Shared by the tests.

use std::sync::Mutex;

use plumbline_blind::answer::Answer;
use plumbline_blind::case::{self, Case};
use plumbline_blind::score::{Score, Share};
use plumbline_blind::{BlindError, table};
use plumbline_gap::Options;

use crate::judge;

/// The score of cases that are made by number, two at a time.
#[allow(clippy::print_stdout, reason = "figures are read from the test's output")]
pub fn scored(cases: usize, make: impl Fn(usize) -> Result<Case, BlindError> + Sync) -> Score {
    let folder = tempfile::tempdir().expect("a folder");
    let options = Options { show: false, advise: false, ..Options::default() };
    let score = Mutex::new(Score::default());
    let judge_some = |first: usize| {
        for number in (first..cases).step_by(2) {
            let case = make(number).expect("a case");
            let name = format!("{:03}", case.answer.case);
            case::write(&case, &folder.path().join("cases"), &folder.path().join("answers"))
                .expect("written");
            let verdict =
                judge::search(&folder.path().join("cases").join(&name), &options).expect("a verdict");
            let answer =
                Answer::read(&folder.path().join("answers").join(format!("{name}.json"))).expect("there");
            let hidden: Vec<String> = answer.hidden.iter().map(|hidden| hidden.named()).collect();
            let said: Vec<String> = verdict.effects.iter().map(|f| format!("{}@{}", f.id, f.site)).collect();
            println!("{name} {hidden:?}: {} {said:?}", verdict.verdict);
            score.lock().expect("nobody panicked").count(&answer, &verdict);
        }
    };
    std::thread::scope(|scope| {
        scope.spawn(|| judge_some(0));
        judge_some(1);
    });
    let score = score.into_inner().expect("nobody panicked");
    println!("{}", table::markdown(&score));
    score
}

/// The share of which there must be some.
pub fn value(share: &Share) -> f64 {
    share.value().expect("there were some")
}

/// All shares together.
pub fn all(shares: impl IntoIterator<Item = Share>) -> Share {
    shares
        .into_iter()
        .fold(Share::default(), |all, share| Share { hits: all.hits + share.hits, of: all.of + share.of })
}
