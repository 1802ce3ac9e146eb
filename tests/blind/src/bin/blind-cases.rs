//! Makes cases and writes them: sessions into one folder, answers into another.
//!
//! `blind-cases OUT ANSWERS lean|worn SEED CASES [FIRST]`

use std::path::Path;
use std::time::Instant;

use plumbline_blind::bench::Bench;
use plumbline_blind::design::Planner;
use plumbline_blind::{case, mix};

#[allow(clippy::print_stdout)]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, out, answers, generator, seed, cases, first @ ..] = arguments.as_slice() else {
        return Err("give: OUT ANSWERS lean|worn SEED CASES [FIRST]".into());
    };
    let first = first.first().map_or(Ok(0), |text| text.parse::<usize>())?;
    let bench = Bench::usual()?;
    let planner = Planner::new(&bench)?;
    for recipe in mix::recipes(generator.parse()?, cases.parse()?, seed.parse()?).into_iter().skip(first) {
        let started = Instant::now();
        let number = recipe.number;
        match case::make_or_smaller(&bench, &planner, &recipe) {
            Ok(case) => {
                case::write(&case, Path::new(out), Path::new(answers))?;
                let hidden: Vec<String> = case
                    .answer
                    .hidden
                    .iter()
                    .map(|h| format!("{} ({:.2} sigma)", h.named(), h.size_sigmas))
                    .collect();
                let sigma: Vec<String> =
                    case.answer.sigma.iter().map(|s| format!("{:.2}", s * 1e3)).collect();
                println!(
                    "{number:03} {:?} {:?} rows {} cells {} sigma {} mm {:.1} s: {}",
                    recipe.family,
                    recipe.design,
                    case.answer.rows,
                    case.answer.cells,
                    sigma.join(" "),
                    started.elapsed().as_secs_f64(),
                    hidden.join(", ")
                );
            }
            Err(error) => {
                println!("{number:03} {:?} {:?} {:?}: {error}", recipe.family, recipe.design, recipe.kind)
            }
        }
    }
    Ok(())
}
