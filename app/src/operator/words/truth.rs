//! Measured less true in words.

use plumbline_engine::view::{TruthOf, TruthRow, TruthView};
use plumbline_widgets::format;

/// "3.1 mm", "0.4°", or both.
pub fn off(row: &TruthRow) -> String {
    let length = row.distance_m().map(format::mm);
    let angle = row.off_rad.map(format::degrees);
    length.into_iter().chain(angle).collect::<Vec<_>>().join(", ")
}

/// The axes of a difference, for who points at it: "x +1.2, y −0.3, z +2.8 mm".
pub fn axes(row: &TruthRow) -> Option<String> {
    let [x, y, z] = row.off_m?.map(|part_m| {
        let sign = if part_m < 0.0 { "−" } else { "+" };
        format!("{sign}{:.1}", part_m.abs() * 1e3)
    });
    Some(format!("x {x}, y {y}, z {z} mm"))
}

/// The worst of a kind in a few words: "Toys 3.1 mm", "Zeros up to 0.8°"; `None`: nothing to compare.
pub fn summary(truth: &TruthView, of: TruthOf) -> Option<String> {
    let worst = truth.worst(of)?;
    let several = truth.rows.iter().filter(|row| row.of == of).count() > 1;
    let up_to = if several { "up to " } else { "" };
    let off = match of {
        // A place says more than an angle where there are both.
        TruthOf::Toy | TruthOf::Finger | TruthOf::Mount => off(worst),
        TruthOf::Zero | TruthOf::Axis => format::degrees(worst.off_rad?.abs()),
    };
    Some(format!("{} {up_to}{off}", of.name()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_is_said_and_one_alone_is_not_up_to() {
        let zero = |name: &str, off_rad: f64| TruthRow {
            of: TruthOf::Zero,
            name: name.to_owned(),
            off_m: None,
            off_rad: Some(off_rad),
        };
        let toy = TruthRow {
            of: TruthOf::Toy,
            name: "Tomato".to_owned(),
            off_m: Some([3e-3, -4e-3, 0.0]),
            off_rad: None,
        };
        let rows = vec![zero("right elbow", -0.0175), zero("left elbow", 0.002), toy.clone()];
        let truth = TruthView { is_on: true, waits_because: None, rows: rows.into() };
        assert_eq!(summary(&truth, TruthOf::Toy).as_deref(), Some("Toys 5.00 mm"));
        let zeros = summary(&truth, TruthOf::Zero).expect("two");
        assert!(zeros.starts_with("Zeros up to 1.0"), "{zeros}");
        assert_eq!(summary(&truth, TruthOf::Axis), None);
        assert_eq!(axes(&toy).as_deref(), Some("x +3.0, y −4.0, z +0.0 mm"));
    }
}
