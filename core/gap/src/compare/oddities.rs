//! What is odd about the data, in words: nothing of it stops the search, all of it limits what can
//! be found.

use std::collections::{BTreeMap, BTreeSet};

use plumbline_effects::measurements::{Measurements, Observation, What, copies_of_commands};

use crate::error::GapError;

/// A joint that moves less than this is not moved, rad.
const STILL_RAD: f64 = 2e-3;
/// A column that moves the prediction by less is not missed when it is all zeros, m.
const MATTERS_M: f64 = 0.01;
/// A share of rows at the very same extreme that chance does not explain.
const CLIPPED_SHARE: f64 = 0.1;

/// Stops where a measured column holds nothing.
///
/// # Errors
/// [`GapError::DeadColumn`].
pub fn stop_at_dead_columns(measurements: &Measurements) -> Result<(), GapError> {
    for (session, apparatus) in measurements.apparatuses.iter().enumerate() {
        let rows: Vec<&Observation> = measurements.rows.iter().filter(|row| row.session == session).collect();
        let dead = |column: String| GapError::DeadColumn { session: apparatus.title.clone(), column };
        for (j, part) in apparatus.arm.iter().flat_map(|arm| &arm.parts).enumerate() {
            let of = |angles: fn(&Observation) -> Option<&Vec<f64>>| {
                range(rows.iter().filter_map(|row| Some(angles(row)?[j])))
            };
            let commanded = of(|row| row.commanded_rad.as_ref());
            let encoder = of(|row| row.encoder_rad.as_ref());
            for (prefix, own, other) in [("enc", encoder, commanded), ("cmd", commanded, encoder)] {
                if own == Some((0.0, 0.0)) && other.is_some_and(|(low, high)| high - low > 0.05) {
                    return Err(dead(part.column(prefix)));
                }
            }
        }
        for (what, columns) in [
            (What::Touch, &["touch_u_px", "touch_v_px"][..]),
            (What::Pose, &["meas_x_m", "meas_y_m", "meas_z_m"]),
            (What::OrientedPose, &["meas_x_m", "meas_y_m", "meas_z_m"]),
            (What::EyePoints, &["left_u_px", "left_v_px", "right_u_px", "right_v_px"]),
        ] {
            let own: Vec<&&Observation> = rows.iter().filter(|row| row.what == what).collect();
            if own.len() < 6 {
                continue;
            }
            for (c, column) in columns.iter().enumerate() {
                let is_still =
                    range(own.iter().map(|row| row.measured[c])).is_some_and(|(low, high)| low == high);
                if is_still && moves(measurements, &own, what) {
                    return Err(dead((*column).to_owned()));
                }
            }
        }
    }
    Ok(())
}

/// Whether the model says that these rows lie apart.
fn moves(measurements: &Measurements, rows: &[&&Observation], what: What) -> bool {
    let assumed = plumbline_effects::Assumed::nominal(measurements);
    let predicted: Vec<Vec<f64>> =
        rows.iter().filter_map(|row| measurements.predict(row, &assumed)).collect();
    let least = if what == What::EyePoints { 5.0 } else { MATTERS_M };
    (0..what.len()).all(|c| {
        c == 2 || range(predicted.iter().map(|row| row[c])).is_some_and(|(low, high)| high - low > least)
    })
}

fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |range, value| {
        let (low, high) = range.unwrap_or((value, value));
        Some((value.min(low), value.max(high)))
    })
}

/// Everything odd, in words.
pub fn warnings(measurements: &Measurements) -> Vec<String> {
    let mut warnings = vec![];
    for (session, apparatus) in measurements.apparatuses.iter().enumerate() {
        let rows: Vec<&Observation> = measurements.rows.iter().filter(|row| row.session == session).collect();
        let mut said = vec![];
        still_joints(measurements, session, &rows, &mut said);
        zeros(&rows, &mut said);
        clipped(&rows, &mut said);
        duplicates(&rows, &mut said);
        copied_encoders(&rows, &mut said);
        behind_gears(&rows, &mut said);
        super::poses::in_one_plane(measurements, &rows, &mut said);
        backwards(&rows, &mut said);
        warnings.extend(said.into_iter().map(|words| format!("{}: {words}", apparatus.title)));
    }
    warnings
}

fn still_joints(measurements: &Measurements, session: usize, rows: &[&Observation], said: &mut Vec<String>) {
    let apparatus = &measurements.apparatuses[session];
    let moved: Vec<&&Observation> = rows.iter().filter(|row| row.what.is_placed()).collect();
    let seen: Vec<&&Observation> = rows.iter().filter(|row| !row.what.is_placed()).collect();
    let mut still = vec![];
    for (j, part) in apparatus.arm.iter().flat_map(|arm| &arm.parts).enumerate().filter(|_| !moved.is_empty())
    {
        let angles = moved.iter().map(|row| row.angles_rad()[j]);
        if range(angles).is_some_and(|(low, high)| high - low < STILL_RAD) {
            still.push(part.title.clone());
        }
    }
    if !still.is_empty() {
        said.push(format!(
            "{} never moved: what is wrong there (its scale, play, sag against angle) cannot be seen. Measure with it \
             at several angles",
            still.join(", ")
        ));
    }
    let neck = apparatus.eyes.as_ref().map_or(&[][..], |eyes| &eyes.neck.parts);
    let fixed: Vec<&str> = neck
        .iter()
        .enumerate()
        .filter(|(j, _)| {
            range(seen.iter().map(|row| row.neck_rad[*j])).is_some_and(|(low, high)| high - low < STILL_RAD)
        })
        .map(|(_, part)| part.title.as_str())
        .collect();
    if !fixed.is_empty() && !seen.is_empty() {
        said.push(format!(
            "{} never moved: a wrong joint of the neck looks like wrongly mounted eyes",
            fixed.join(", ")
        ));
    }
}

/// Some values of a row, where they are known.
type Values<'a> = &'a dyn Fn(&Observation) -> Option<Vec<f64>>;

fn zeros(rows: &[&Observation], said: &mut Vec<String>) {
    let all_zero = |value: Values<'_>| {
        let mut any = false;
        let zero = rows.iter().filter_map(|row| value(row)).all(|values| {
            any = true;
            values.iter().all(|value| *value == 0.0)
        });
        any && zero
    };
    let columns: [(&str, Values<'_>); 5] = [
        ("tau_…_nm", &|row| row.torque_nm.clone()),
        ("temp_…_c", &|row| row.temperature_c.clone()),
        ("t_secs", &|row| row.t_secs.map(|t| vec![t])),
        ("move_secs", &|row| row.move_secs.map(|t| vec![t])),
        ("background_m", &|row| row.background_m.map(|m| vec![m])),
    ];
    for (column, value) in columns {
        if rows.len() > 1 && all_zero(value) {
            said.push(format!("{column} is zero in every row: leave the column out if it was not measured"));
        }
    }
    for (prefix, encoder) in [("cmd", false), ("enc", true)] {
        let angles =
            |row: &Observation| if encoder { row.encoder_rad.clone() } else { row.commanded_rad.clone() };
        let joints = rows.iter().filter_map(|row| angles(row)).map(|angles| angles.len()).next().unwrap_or(0);
        let zero = (0..joints).filter(|&j| all_zero(&|row| Some(vec![angles(row)?[j]]))).count();
        if zero > 0 {
            said.push(format!(
                "{zero} of the {prefix}_…_rad columns hold only zeros: check that they were logged"
            ));
        }
    }
}

fn clipped(rows: &[&Observation], said: &mut Vec<String>) {
    for what in [What::Touch, What::Pose, What::EyePoints] {
        let own: Vec<&&Observation> = rows.iter().filter(|row| row.what == what).collect();
        if own.len() < 12 {
            continue;
        }
        for (c, (name, _)) in
            what.coordinates().iter().enumerate().filter(|(c, _)| what != What::Touch || *c < 2)
        {
            let Some((low, high)) = range(own.iter().map(|row| row.measured[c])) else { continue };
            for (end, words) in [(low, "smallest"), (high, "largest")] {
                let cells: BTreeSet<usize> =
                    own.iter().filter(|row| row.measured[c] == end).map(|row| row.cell).collect();
                let all: BTreeSet<usize> = own.iter().map(|row| row.cell).collect();
                if high > low && cells.len() >= 3 && cells.len() as f64 > CLIPPED_SHARE * all.len() as f64 {
                    said.push(format!(
                        "{} rows share the {words} value of \"{name}\" exactly: they were probably clipped at the \
                         edge. Leave such rows out",
                        own.iter().filter(|row| row.measured[c] == end).count()
                    ));
                }
            }
        }
    }
}

fn duplicates(rows: &[&Observation], said: &mut Vec<String>) {
    let mut seen = BTreeMap::<Vec<u64>, usize>::new();
    for row in rows {
        let angles = row.commanded_rad.iter().chain(&row.encoder_rad).flatten();
        let times = row.t_secs.iter().chain(&row.move_secs);
        let truth = row.truth_m.iter().flat_map(|truth| truth.coords.iter());
        let key = row
            .measured
            .iter()
            .chain(angles)
            .chain(times)
            .chain(truth)
            .map(|value| value.to_bits())
            .collect();
        *seen.entry(key).or_default() += 1;
    }
    let copies: usize = seen.values().map(|count| count - 1).sum();
    // Screens have whole pixels: a repeat may well hit the same one.
    if copies > (rows.len() / 20).max(1) {
        said.push(format!(
            "{copies} rows are exact copies of others: they make the noise look smaller than it is. Leave them out"
        ));
    }
}

/// No encoder reads exactly what its joint was sent to, row after row.
fn copied_encoders(rows: &[&Observation], said: &mut Vec<String>) {
    let copied = copies_of_commands(rows).into_iter().filter(|copied| *copied).count();
    if copied > 0 {
        said.push(format!(
            "{copied} of the enc_…_rad columns are copies of the commands: what servos do between command and encoder \
             cannot be seen in them, and they are taken for commands. Log the encoders, or leave these columns out"
        ));
    }
}

/// What sits between motor and joint is in such readings already.
fn behind_gears(rows: &[&Observation], said: &mut Vec<String>) {
    if rows.iter().any(|row| row.encoder_behind_gear && row.encoder_rad.is_some()) {
        said.push(
            "encoders = \"joint\": the encoders are taken to sit behind the gears. Play, teeth, horns that slip and \
             cables that pull stand in their readings, so nothing of it is looked for beside them: it shows only between \
             command and encoder"
                .to_owned(),
        );
    }
}

fn backwards(rows: &[&Observation], said: &mut Vec<String>) {
    for what in What::ALL {
        let times: Vec<f64> =
            rows.iter().filter(|row| row.what == what).filter_map(|row| row.t_secs).collect();
        let back = times.windows(2).filter(|pair| pair[1] < pair[0]).count();
        if back > 0 {
            said.push(format!(
                "t_secs goes backwards {back} times in {}: was the robot switched off in between? Effects of time and \
                 warmth are not to be trusted then; make a session of each run",
                what.table()
            ));
        }
    }
}
