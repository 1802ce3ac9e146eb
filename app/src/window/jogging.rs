//! Keeps a jog alive while its key is held and ends it at once when it is not.

use std::time::{Duration, Instant};

use plumbline_engine::{JogRates, RobotCommand};

/// A jog is renewed this often: four times within its deadline.
pub(super) const RENEW: Duration = Duration::from_millis(50);

/// What the engine was told last.
#[derive(Debug, Default)]
pub(super) struct Jogging {
    sent: Option<(JogRates, Instant)>,
}

impl Jogging {
    /// Whether a jog is under way.
    pub(super) fn active(&self) -> bool {
        self.sent.is_some()
    }

    /// `wanted` is what the held keys ask for in this frame; `None` when none is held or the
    /// panel that asks is not on screen.
    pub(super) fn follow(
        &mut self,
        wanted: Option<JogRates>,
        now: Instant,
        send: &mut dyn FnMut(RobotCommand),
    ) {
        match (wanted, self.sent) {
            (Some(rates), sent) => {
                let due = sent.is_none_or(|(before, at)| before != rates || now.duration_since(at) >= RENEW);
                if due {
                    send(RobotCommand::Jog(rates));
                    self.sent = Some((rates, now));
                }
            }
            (None, Some(_)) => {
                send(RobotCommand::EndJog);
                self.sent = None;
            }
            (None, None) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn forward() -> JogRates {
        JogRates { velocity_m_s: [0.05, 0.0, 0.0], yaw_rad_s: 0.0 }
    }

    #[test]
    fn a_held_key_is_renewed_in_time_and_a_released_one_ends_once() {
        let mut jogging = Jogging::default();
        let start = Instant::now();
        let mut sent = Vec::new();
        for ms in (0..=200).step_by(10) {
            let now = start + Duration::from_millis(ms);
            jogging.follow(Some(forward()), now, &mut |command| sent.push(command));
        }
        assert_eq!(sent, vec![RobotCommand::Jog(forward()); 5]);
        sent.clear();
        for _ in 0..3 {
            jogging.follow(None, start, &mut |command| sent.push(command));
        }
        assert_eq!(sent, [RobotCommand::EndJog]);
        assert!(!jogging.active());
    }

    #[test]
    fn another_direction_is_sent_at_once() {
        let mut jogging = Jogging::default();
        let now = Instant::now();
        let mut sent = Vec::new();
        jogging.follow(Some(forward()), now, &mut |command| sent.push(command));
        let back = JogRates { velocity_m_s: [-0.05, 0.0, 0.0], yaw_rad_s: 0.0 };
        jogging.follow(Some(back), now, &mut |command| sent.push(command));
        assert_eq!(sent, [RobotCommand::Jog(forward()), RobotCommand::Jog(back)]);
    }
}
