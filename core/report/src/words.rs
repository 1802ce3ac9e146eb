//! What effects mean, in words, and what can be done about them in the lab.

/// What an effect means for the robot; `None` for an id that is not in the library.
pub fn meaning(id: &str) -> Option<&'static str> {
    entry(id).map(|(meaning, _)| meaning)
}

/// What could be done about an effect in the lab, other than adding it to the model.
pub fn remedy(id: &str) -> Option<&'static str> {
    entry(id).map(|(_, remedy)| remedy)
}

fn entry(id: &str) -> Option<(&'static str, &'static str)> {
    of_joint(id).or_else(|| of_contact_and_frames(id)).or_else(|| of_eyes(id))
}

fn of_joint(id: &str) -> Option<(&'static str, &'static str)> {
    Some(match id {
        "joint-zero" => (
            "The joint stands elsewhere than its encoder says, by the same angle everywhere.",
            "Remount the horn, or set the encoder's zero against a jig.",
        ),
        "joint-scale" => (
            "The joint turns further, or less far, than commanded, in proportion to its angle.",
            "Check the gear ratio and the ticks per turn in the servo's settings.",
        ),
        "joint-eccentricity" => (
            "The reading swings once or twice per turn: magnet or gear sits off the axis.",
            "Recenter the encoder's magnet, or swap the servo.",
        ),
        "tooth-ripple" => (
            "The reading ripples with every tooth of a gear.",
            "Look for a chipped or dry gear; grease or swap it.",
        ),
        "backlash" => (
            "The joint stops on one side or the other of its play, as it last moved.",
            "Approach always from one side; tighten or swap worn gears.",
        ),
        "gravity-backlash" => (
            "The load pushes the gears to one flank; where the load turns over, the joint drops through its play.",
            "Keep to postures that load the joint one way, or add a light spring.",
        ),
        "stiction" => (
            "Friction stops the joint short of its goal, on the side it came from.",
            "Raise the integral gain a little, or approach from one side.",
        ),
        "servo-droop" => (
            "The servo holds its goal like a spring and gives way under load; its encoder sees it.",
            "Raise the position gain, or command the angle with the droop added.",
        ),
        "joint-sag" => (
            "The bracket behind the encoder bends under load; the encoder does not see it.",
            "Stiffen the bracket, tighten its screws, lighten the hand.",
        ),
        "sideways-give" => (
            "The joint gives way across its axis under load.",
            "Check the bearing and its preload; add a second bearing.",
        ),
        "link-bending" => ("The link bends under the load.", "Stiffen the link, lighten the hand."),
        "creep" => (
            "The arm sinks slowly while it holds a pose.",
            "Measure soon after arriving; look for soft plastic parts under load.",
        ),
        "early-log" => (
            "Angles were logged before the arm had come to rest.",
            "Wait longer before logging, or lower the tolerance of arrival.",
        ),
        "torque-limit" => (
            "The servo runs into its torque limit in stretched poses.",
            "Raise the torque limit, cool the servo, avoid stretched poses.",
        ),
        "servo-warm-up" => (
            "The joint's zero wanders while the servo warms up.",
            "Let the servos warm up before measuring, or calibrate warm.",
        ),
        "slipped-horn" => (
            "From one moment on the joint stands elsewhere: something slipped.",
            "Tighten the horn's screw, then measure its zero again.",
        ),
        "joint-coupling" => (
            "The joint moves along with another one: a cable or tendon pulls.",
            "Give the cable more slack, or route it through the axis.",
        ),
        "axis-skew" => {
            ("The axis is not at the angle that the model gives it.", "Check how the part is seated.")
        }
        _ => return None,
    })
}

fn of_contact_and_frames(id: &str) -> Option<(&'static str, &'static str)> {
    Some(match id {
        "link-length" => ("The link is longer or shorter than in the model.", "Measure it with a caliper."),
        "tip-offset" => (
            "The fingertip lies elsewhere in the hand than in the model.",
            "Measure the fingertip with a caliper; check how the finger is mounted.",
        ),
        "finger-bend" => ("The finger bends when it presses.", "Press less, or stop at the first touch."),
        "finger-roll" => (
            "The round pad touches with another point when the finger is inclined.",
            "Keep the finger's inclination, or use a pointed stylus.",
        ),
        "touch-drag" => {
            ("The finger slides on after it has touched.", "Come straight from above, and slower.")
        }
        "base-tilt" => ("The torso stands tilted or shifted.", "Shim and fasten the torso's base."),
        "torso-lean" => ("The torso leans as the arm reaches out.", "Fasten the base; brace the torso."),
        "payload-mass" => (
            "Hand or payload weighs more, or less, than the model says.",
            "Weigh the hand and put its mass into the description.",
        ),
        "screen-bumped" => (
            "Screen or table moved during the measurement.",
            "Fix the screen; touch three corners at the start of every session.",
        ),
        "screen-scale" => (
            "A pixel of the screen has another size than the rig file says.",
            "Measure the lit area with a ruler and correct the rig file.",
        ),
        "screen-tilt" => {
            ("The screen lies tilted or shifted.", "Level the screen, or measure its place again.")
        }
        "screen-bow" => ("The glass is bowed.", "Lay a straight edge on it; support its middle."),
        "panel-edge" => ("The touch panel errs near its border.", "Keep 15 mm away from the border."),
        "speed-overshoot" => {
            ("Fast moves end elsewhere than slow ones.", "Approach slower, or wait before touching.")
        }
        _ => return None,
    })
}

fn of_eyes(id: &str) -> Option<(&'static str, &'static str)> {
    Some(match id {
        "camera-mount" => (
            "The eyes sit elsewhere on the head than in the model.",
            "Check the screws of the eyes; calibrate the mount again.",
        ),
        "head-joint" => (
            "The head stands elsewhere than its encoders say.",
            "Look at targets from one side; check the zeros of the head.",
        ),
        "eye-yaw" => (
            "The eyes turn against each other, which falsifies depth.",
            "Let the cameras warm up; check their mounts; calibrate warm.",
        ),
        "image-shift" => (
            "The image of one eye is shifted on its sensor.",
            "Check that the lens is screwed tight; calibrate warm.",
        ),
        "focal-or-baseline" => (
            "All distances come out too long or too short by the same share.",
            "Calibrate again with a board whose squares were measured.",
        ),
        "eye-roll" => (
            "One eye is rolled or pitched against the other.",
            "Check the mounts of the eyes; calibrate the stereo pair again.",
        ),
        "lens-distortion" => (
            "Some lens distortion is left, growing towards the border of the image.",
            "Calibrate with the board out to the corners of the image.",
        ),
        "disparity-steps" => {
            ("Depth comes in steps of the matcher.", "Use the sub-pixel matcher, or a finer rectified image.")
        }
        "background-bleed" => (
            "The matcher mixes the background into the depth of small things.",
            "Put a card behind the hand, or use a smaller matching window.",
        ),
        "foreground-fattening" => (
            "Things look wider by half a matching window.",
            "Use a smaller window, or measure in the middle of things.",
        ),
        "seen-surface" => (
            "The eyes see the surface, the model means the center.",
            "Enter the radius of the thing, or mark a point on it.",
        ),
        "box-bias" => (
            "The detector's box is not centered on what it detects.",
            "Label again, or use a printed marker.",
        ),
        "eye-latency" => (
            "The two images, or image and angles, are not of the same moment.",
            "Hold still while measuring, or trigger both eyes together.",
        ),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_of_the_library_has_words() {
        for kind in plumbline_effects::Kind::ALL {
            let id = kind.id();
            let (meaning, remedy) = (meaning(id).expect(id), remedy(id).expect(id));
            assert!(meaning.ends_with('.') && remedy.ends_with('.'), "{id}");
        }
        assert_eq!(meaning("no-such-effect"), None);
    }
}
