//! What stands on any screen is for people: no numbers that are none, nothing that only programmers write, and
//! one of a thing is no several. Read from what is painted. (Ids are looked for in `raw_ids`.)

use plumbline::{Screen, WindowSettings};
use plumbline_engine::View;

use crate::fake::Fake;
use crate::layout::{lines, much_to_show};
use crate::made_up;

/// Words that end as a plural does and are none, after a number.
const NO_PLURALS: [&str; 6] = ["always", "does", "this", "class", "less", "across"];

/// What only programmers write.
const RAW: [&str; 5] = ["NaN", "Some(", "None)", "Err(", "{}"];

/// What is wrong with a line for people.
fn fault(line: &str) -> Option<String> {
    if let Some(raw) = RAW.into_iter().find(|raw| line.contains(raw)) {
        return Some(format!("{raw} is for programmers"));
    }
    let words: Vec<&str> = line.split_whitespace().collect();
    let plural = words.windows(2).find(|two| {
        let noun = two[1].trim_end_matches(|c: char| c.is_ascii_punctuation());
        let is_noun = noun.len() > 3 && noun.chars().all(|c| c.is_ascii_lowercase());
        two[0] == "1" && is_noun && noun.ends_with('s') && !NO_PLURALS.contains(&noun)
    });
    plural.map(|two| format!("\"{} {}\" is one", two[0], two[1]))
}

#[test]
fn every_line_on_every_screen_is_for_people() {
    let mut views: Vec<(Screen, View)> = Vec::new();
    for screen in Screen::ALL {
        views.extend([View::default(), made_up::everything()].map(|view| (screen, view)));
    }
    views.extend(much_to_show());
    let mut faults = Vec::new();
    for (screen, view) in views {
        let fake = Fake::over(view);
        let settings = WindowSettings { screen, ..WindowSettings::default() };
        let mut window = fake.window_of_size(settings, [1920.0, 1200.0]);
        window.run_steps(2);
        let said = lines(&window);
        assert!(said.len() > 10, "{screen:?} draws texts");
        let wrong = said.iter().filter_map(|line| Some((&line.text, fault(&line.text)?)));
        faults.extend(wrong.map(|(text, why)| format!("{screen:?}: {text:?}: {why}")));
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn what_is_not_for_people_is_seen() {
    for line in ["1 pairs collected", "of 1 places", "error NaN mm", "seen Some(3) times"] {
        assert!(fault(line).is_some(), "{line}");
    }
    for line in ["1 pair collected", "21 pairs", "1 class", "0.1 seconds", "1 s ago"] {
        assert_eq!(fault(line), None, "{line}");
    }
}
