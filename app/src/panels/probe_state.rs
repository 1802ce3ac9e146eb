//! The point that is asked for.

use plumbline_engine::{LiveCommand, ProbePoint};

/// Which point is measured: the one that was clicked, else the one under the mouse.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProbeState {
    /// Stays when the mouse leaves.
    pub pinned: Option<ProbePoint>,
    sent: Option<ProbePoint>,
}

/// A click this near to a pinned point lets it go, pixels.
const NEAR_PX: f64 = 6.0;
/// The mouse moves by less than this without being measured anew, pixels.
const STILL_PX: f64 = 0.2;

impl ProbeState {
    /// Pins a point, or lets go of the one that is there.
    pub fn toggle_pin(&mut self, point: ProbePoint) {
        let same = self.pinned.is_some_and(|pinned| distance_px(pinned, point) < NEAR_PX);
        self.pinned = (!same).then_some(point);
    }

    /// Tells the engine when another point is wanted.
    pub(crate) fn follow(&mut self, hovered: Option<ProbePoint>, send: &mut dyn FnMut(LiveCommand)) {
        let wanted = self.pinned.or(hovered);
        let unchanged = match (wanted, self.sent) {
            (Some(a), Some(b)) => distance_px(a, b) < STILL_PX,
            (None, None) => true,
            _ => false,
        };
        if !unchanged {
            self.sent = wanted;
            send(wanted.map_or(LiveCommand::StopProbe, LiveCommand::Probe));
        }
    }
}

/// Infinite between different images.
fn distance_px(a: ProbePoint, b: ProbePoint) -> f64 {
    match (a, b) {
        (ProbePoint::Raw { eye: e, u_px: u, v_px: v }, ProbePoint::Raw { eye, u_px, v_px }) if e == eye => {
            (u - u_px).hypot(v - v_px)
        }
        (ProbePoint::Rectified { u_px: u, v_px: v }, ProbePoint::Rectified { u_px, v_px }) => {
            (u - u_px).hypot(v - v_px)
        }
        _ => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(u_px: f64) -> ProbePoint {
        ProbePoint::Rectified { u_px, v_px: 10.0 }
    }

    fn sent(state: &mut ProbeState, hovered: Option<ProbePoint>) -> Vec<LiveCommand> {
        let mut commands = Vec::new();
        state.follow(hovered, &mut |command| commands.push(command));
        commands
    }

    #[test]
    fn a_still_mouse_asks_once_and_a_gone_mouse_stops() {
        let mut state = ProbeState::default();
        assert_eq!(sent(&mut state, Some(point(5.0))), [LiveCommand::Probe(point(5.0))]);
        assert_eq!(sent(&mut state, Some(point(5.1))), []);
        assert_eq!(sent(&mut state, None), [LiveCommand::StopProbe]);
        assert_eq!(sent(&mut state, None), []);
    }

    #[test]
    fn a_pinned_point_stays_and_a_second_click_lets_it_go() {
        let mut state = ProbeState::default();
        state.toggle_pin(point(5.0));
        assert_eq!(sent(&mut state, Some(point(300.0))), [LiveCommand::Probe(point(5.0))]);
        state.toggle_pin(point(7.0));
        assert_eq!(state.pinned, None);
        assert_eq!(sent(&mut state, Some(point(300.0))), [LiveCommand::Probe(point(300.0))]);
    }
}
