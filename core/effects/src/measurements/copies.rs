//! Encoder columns that only repeat the commands.

use super::Observation;

/// A joint that moves less than this is not moved, rad.
const STILL_RAD: f64 = 2e-3;
/// Fewer rows with command and encoder may be alike by chance.
const FEWEST_LOGGED: usize = 6;

/// Joints whose encoder reads exactly what they were sent to in every one of these rows of a session, although
/// they moved: no encoder does that. Empty where too few rows have both.
pub fn copies_of_commands(rows: &[&Observation]) -> Vec<bool> {
    let both: Vec<(&Vec<f64>, &Vec<f64>)> = rows
        .iter()
        .filter_map(|row| Some((row.commanded_rad.as_ref()?, row.encoder_rad.as_ref()?)))
        .collect();
    if both.len() < FEWEST_LOGGED {
        return vec![];
    }
    let joints =
        both.iter().map(|(commanded, encoder)| commanded.len().min(encoder.len())).min().unwrap_or(0);
    let is_copied = |j: usize| {
        let ends = both.iter().fold((f64::MAX, f64::MIN), |(low, high), (commanded, _)| {
            (low.min(commanded[j]), high.max(commanded[j]))
        });
        let alike =
            |(commanded, encoder): &(&Vec<f64>, &Vec<f64>)| commanded[j].to_bits() == encoder[j].to_bits();
        ends.1 - ends.0 > STILL_RAD && both.iter().all(alike)
    };
    (0..joints).map(is_copied).collect()
}

/// Says so in every row of a session with such columns. A joint that rests all the while cannot tell.
pub(super) fn complete(rows: &mut [Observation], sessions: usize) {
    for session in 0..sessions {
        let of_session = |row: &&Observation| row.session == session && row.what.is_placed();
        let own: Vec<&Observation> = rows.iter().filter(of_session).collect();
        let copies = copies_of_commands(&own);
        if !copies.contains(&true) {
            continue;
        }
        for row in rows.iter_mut().filter(|row| row.session == session && row.encoder_rad.is_some()) {
            row.encoder_copies.clone_from(&copies);
        }
    }
}
