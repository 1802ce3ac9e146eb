//! What a residual can depend on, row by row: for maps, plots and the question which of it told.

use plumbline_effects::measurements::{Measurements, Observation, What};
use plumbline_effects::{EyesDeviation, Situation};

/// Names for people with their units, and one value per row where it is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Covariates {
    /// Name and unit.
    pub names: Vec<(String, String)>,
    /// Per row, one value per name.
    pub values: Vec<Vec<Option<f64>>>,
}

impl Covariates {
    /// Of these measurements. Those that no row has, or that never change, are left out.
    pub fn of(measurements: &Measurements) -> Self {
        let arm = measurements.apparatuses.iter().find_map(|apparatus| apparatus.arm.as_ref());
        let neck = measurements.apparatuses.iter().find_map(|apparatus| Some(&apparatus.eyes.as_ref()?.neck));
        let titles = |part: &plumbline_effects::Part| part.title.clone();
        let joints: Vec<String> = arm.map_or(vec![], |arm| arm.parts.iter().map(titles).collect());
        let neck: Vec<String> = neck.map_or(vec![], |neck| neck.parts.iter().map(titles).collect());
        let mut names = vec![];
        let mut all = |what: &str, unit: &str| {
            names.extend(joints.iter().map(|joint| (format!("{what} of {joint}"), unit.to_owned())));
        };
        all("angle", "rad");
        all("torque", "N m");
        all("direction", "");
        all("commanded less encoder", "rad");
        all("temperature", "°C");
        names.extend(neck.iter().map(|joint| (format!("angle of {joint}"), "rad".to_owned())));
        let others = [
            ("place along u", "m"),
            ("place along v", "m"),
            ("payload", "kg"),
            ("height of the screen", "m"),
            ("time", "s"),
            ("duration of the move", "s"),
            ("distance from the eyes", "m"),
            ("distance from the middle of the image", "px"),
            ("distance of the background", "m"),
            ("place along x of the table", "m"),
            ("place along y of the table", "m"),
        ];
        names.extend(others.map(|(name, unit)| (name.to_owned(), unit.to_owned())));
        let values =
            measurements.rows.iter().map(|row| of_row(measurements, row, joints.len(), neck.len())).collect();
        let mut covariates = Self { names, values };
        covariates.keep_telling();
        covariates
    }

    fn keep_telling(&mut self) {
        let kept: Vec<usize> = (0..self.names.len())
            .filter(|&c| {
                let mut known = self.values.iter().filter_map(|row| row[c]);
                known.next().is_some_and(|first| known.any(|value| (value - first).abs() > 1e-9))
            })
            .collect();
        self.names = kept.iter().map(|&c| self.names[c].clone()).collect();
        for row in &mut self.values {
            *row = kept.iter().map(|&c| row[c]).collect();
        }
    }
}

fn of_row(measurements: &Measurements, row: &Observation, joints: usize, neck: usize) -> Vec<Option<f64>> {
    let listed = |values: Option<&[f64]>, count: usize| -> Vec<Option<f64>> {
        (0..count).map(|j| values.and_then(|values| values.get(j)).copied()).collect()
    };
    let apparatus = measurements.apparatus(row);
    let placed = row.what.is_placed();
    let torques = apparatus.arm.as_ref().filter(|_| placed).map(|arm| {
        let up = nalgebra::Vector3::z();
        let situation =
            Situation::new(arm, row.angles_rad(), &row.direction, row.payload_kg, &up).during(row);
        situation.torques_nm().to_vec()
    });
    let direction = (placed && row.direction.iter().any(|sign| *sign != 0.0)).then_some(&row.direction[..]);
    let mut values = listed(placed.then(|| row.angles_rad()), joints);
    values.extend(listed(torques.as_deref(), joints));
    values.extend(listed(direction, joints));
    values.extend(listed(row.lag_rad().as_deref(), joints));
    values.extend(listed(row.temperature_c.as_deref(), joints));
    values.extend(listed((!placed).then_some(&row.neck_rad[..]), neck));
    let touch = (row.what == What::Touch).then_some(&row.measured);
    values.push(touch.map(|measured| measured[0]));
    values.push(touch.map(|measured| measured[1]));
    values.push(placed.then_some(row.payload_kg));
    values.push(touch.map(|_| row.screen_height_m));
    values.push(row.t_secs);
    values.push(row.move_secs);
    let seen = apparatus.eyes.as_ref().zip(row.truth_m).map(|(eyes, truth_m)| {
        let nominal = EyesDeviation::none(eyes.neck.len());
        let situation = eyes.situation(row, truth_m);
        let pixels = eyes.image_points(&situation, &nominal);
        let middle = eyes.cameras.left.model.principal_point();
        let radius = pixels.map(|p| (p[0] - middle.u_px).hypot(p[1] - middle.v_px));
        (situation.in_left_m.coords.norm(), radius)
    });
    values.push(seen.map(|(distance, _)| distance));
    values.push(seen.and_then(|(_, radius)| radius));
    values.push(row.background_m);
    values.push(row.truth_m.map(|truth| truth.x));
    values.push(row.truth_m.map(|truth| truth.y));
    values
}
