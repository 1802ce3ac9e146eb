//! The experiment with grasps in words.

/// What a person has to do: "Put the tomato at (30, −20) cm: 30 cm ahead of the robot, 20 cm to its right".
pub fn ask(object: &str, [x_m, y_m]: [f64; 2]) -> String {
    let [x_cm, y_cm] = [x_m, y_m].map(|m| (100.0 * m).round());
    let side = match y_cm {
        y_cm if y_cm > 0.0 => format!("{y_cm:.0} cm to its left"),
        y_cm if y_cm < 0.0 => format!("{:.0} cm to its right", -y_cm),
        _ => "straight ahead".to_owned(),
    };
    let signed = if y_cm < 0.0 { format!("−{:.0}", -y_cm) } else { format!("{y_cm:.0}") };
    format!(
        "Put the {} at ({x_cm:.0}, {signed}) cm: {x_cm:.0} cm ahead of the robot, {side}. Take your hands away, then press Placed.",
        object.to_lowercase()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn left_and_right_are_the_robots() {
        let said = ask("Tomato", [0.3, -0.2]);
        assert!(
            said.starts_with("Put the tomato at (30, −20) cm: 30 cm ahead of the robot, 20 cm to its right."),
            "{said}"
        );
        assert!(ask("Tomato", [0.3, 0.1]).contains("10 cm to its left"));
        assert!(ask("Tomato", [0.2, 0.0]).contains("straight ahead"));
    }
}
