//! The experiment with grasps in words.

/// What a person has to do: "Put the tomato at (300, −200) mm: 300 mm ahead of the robot, 200 mm to its right".
pub fn ask(object: &str, [x_m, y_m]: [f64; 2]) -> String {
    let [x_mm, y_mm] = [x_m, y_m].map(|m| (1e3 * m).round());
    let side = match y_mm {
        y_mm if y_mm > 0.0 => format!("{y_mm:.0} mm to its left"),
        y_mm if y_mm < 0.0 => format!("{:.0} mm to its right", -y_mm),
        _ => "straight ahead".to_owned(),
    };
    let signed = if y_mm < 0.0 { format!("−{:.0}", -y_mm) } else { format!("{y_mm:.0}") };
    format!(
        "Put the {} at ({x_mm:.0}, {signed}) mm: {x_mm:.0} mm ahead of the robot, {side}. Take your hands away, then press Placed.",
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
            said.starts_with(
                "Put the tomato at (300, −200) mm: 300 mm ahead of the robot, 200 mm to its right."
            ),
            "{said}"
        );
        assert!(ask("Tomato", [0.3, 0.1]).contains("100 mm to its left"));
        assert!(ask("Tomato", [0.2, 0.0]).contains("straight ahead"));
    }
}
