//! What was written, in words.

use plumbline_model::counted;

use crate::export::Exported;

impl Exported {
    /// What is in it, and what is not and why: sentences for people.
    pub fn said(&self) -> Vec<String> {
        let mut said = vec![format!(
            "{} at {:.1} Hz with {}.",
            counted(self.frames, "frame"),
            self.rate_hz,
            counted(self.joints.len(), "joint")
        )];
        if self.left_out > 0 {
            said.push(format!(
                "Not in it, from before angles were read: {}.",
                counted(self.left_out, "pair")
            ));
        }
        said.extend(self.action_said());
        if !self.has_cameras {
            said.push(
                "The recording has no calibration of the eyes that can be read: intrinsics and extrinsics are not in it."
                    .to_owned(),
            );
        }
        if !self.has_places {
            said.push(
                "The recording does not say how the head stood in any pair: where the eyes were in the robot is not in \
                 it."
                    .to_owned(),
            );
        } else if self.without_place > 0 {
            said.push(format!(
                "Where the eyes were in the robot is not known of {} of them; it is NaN there.",
                self.without_place
            ));
        }
        said
    }

    fn action_said(&self) -> Option<String> {
        if self.actions.is_empty() {
            return Some(
                "No joint was told something in every pair, as far as the recording says it: there is no action."
                    .to_owned(),
            );
        }
        let named = self.not_commanded.iter().map(|joint| format!("{} ({})", joint.joint, joint.frames));
        let named = named.collect::<Vec<_>>().join(", ");
        (!named.is_empty()).then(|| {
            format!("Not in its action, because nothing told them where to be in so many pairs: {named}.")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frames::NotCommanded;

    fn exported() -> Exported {
        Exported {
            frames: 300,
            left_out: 0,
            rate_hz: 30.0,
            joints: vec!["head_z".to_owned(), "r_elbow_y".to_owned()],
            actions: vec!["head_z".to_owned(), "r_elbow_y".to_owned()],
            not_commanded: vec![],
            has_cameras: true,
            has_places: true,
            without_place: 0,
        }
    }

    #[test]
    fn a_whole_one_is_said_in_a_line_and_what_is_missing_in_one_each() {
        assert_eq!(exported().said(), ["300 frames at 30.0 Hz with 2 joints."]);
        let less = Exported {
            left_out: 1,
            actions: vec!["head_z".to_owned()],
            not_commanded: vec![NotCommanded { joint: "r_elbow_y".to_owned(), frames: 12 }],
            has_cameras: false,
            without_place: 4,
            ..exported()
        };
        let said = less.said();
        assert_eq!(said.len(), 5, "{said:?}");
        for words in [
            "before angles were read: 1 pair.",
            "r_elbow_y (12)",
            "no calibration of the eyes",
            "of 4 of them",
        ] {
            assert!(said.iter().any(|line| line.contains(words)), "{words}: {said:?}");
        }
        let none = Exported { actions: vec![], has_places: false, ..exported() };
        assert!(none.said().iter().any(|line| line.ends_with("there is no action.")), "{:?}", none.said());
    }
}
