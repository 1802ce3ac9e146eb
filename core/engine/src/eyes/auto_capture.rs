//! Decides when to capture without being asked: the board is still, sharp, seen by both eyes
//! and somewhere new.

use std::time::{Duration, Instant};

use plumbline_model::{Corners, Eye};

use super::coverage::Novelty;
use super::view::CaptureHint;

/// A corner may move this much between two looks, in pixels of an image 640 wide.
const STILL_PX: f64 = 0.8;
/// For this long it must not have moved more.
const STILL_FOR: Duration = Duration::from_millis(350);
/// Looks that must agree, so that a slow search does not pass one look for stillness.
const STILL_LOOKS: u32 = 3;
/// Wider edges are blurred, pixels.
const SHARP_PX: f64 = 4.0;

/// What one look at both eyes found.
#[derive(Clone, Copy, Debug)]
pub struct Look<'a> {
    /// When the images were captured.
    pub at: Instant,
    /// Width of the images, pixels.
    pub width_px: u32,
    /// Corners in the left eye.
    pub left: Option<&'a Corners>,
    /// Corners in the right eye.
    pub right: Option<&'a Corners>,
    /// Median width of edges, the wider of both eyes, pixels.
    pub edge_width_px: Option<f64>,
    /// What the pair would add; `None` when an eye does not see the board.
    pub novelty: Option<Novelty>,
    /// A photograph is still by nature.
    pub photograph: bool,
}

/// Watches the board from look to look.
#[derive(Clone, Debug, Default)]
pub struct AutoCapture {
    last: Option<[Corners; 2]>,
    still_since: Option<Instant>,
    still_looks: u32,
}

impl AutoCapture {
    /// Takes a look and says what capturing waits for.
    pub fn look(&mut self, look: Look<'_>) -> CaptureHint {
        let (Some(left), Some(right)) = (look.left, look.right) else {
            *self = Self::default();
            let unseen = |(eye, corners): (Eye, Option<&Corners>)| corners.is_none().then_some(eye);
            let eyes = [(Eye::Left, look.left), (Eye::Right, look.right)].into_iter().filter_map(unseen);
            return CaptureHint::NotSeen { eyes: eyes.collect() };
        };
        let motion_px = self.last.as_ref().and_then(|last| {
            let motions = [greatest_motion_px(&last[0], left), greatest_motion_px(&last[1], right)];
            motions.into_iter().flatten().reduce(f64::max)
        });
        self.last = Some([left.clone(), right.clone()]);
        if !look.photograph
            && let Some(hint) = self.moving(&look, motion_px)
        {
            return hint;
        }
        match (look.edge_width_px, look.novelty) {
            (Some(edge_width_px), _) if edge_width_px > SHARP_PX => CaptureHint::Blurred { edge_width_px },
            (_, Some(novelty)) if novelty.is_new() => CaptureHint::Ready,
            _ => CaptureHint::NothingNew,
        }
    }

    fn moving(&mut self, look: &Look<'_>, motion_px: Option<f64>) -> Option<CaptureHint> {
        let allowed_px = STILL_PX * f64::from(look.width_px) / 640.0;
        match motion_px {
            Some(motion_px) if motion_px <= allowed_px => {
                self.still_looks += 1;
                let since = *self.still_since.get_or_insert(look.at);
                let still = self.still_looks >= STILL_LOOKS && look.at.duration_since(since) >= STILL_FOR;
                (!still).then_some(CaptureHint::Moving { motion_px })
            }
            moved => {
                self.still_looks = 0;
                self.still_since = None;
                Some(CaptureHint::Moving { motion_px: moved.unwrap_or(0.0) })
            }
        }
    }
}

/// `None` when no corner was seen both times.
fn greatest_motion_px(before: &Corners, now: &Corners) -> Option<f64> {
    before.iter().zip(now).filter_map(|(a, b)| Some(a.as_ref()?.distance_px(b.as_ref()?))).reduce(f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use plumbline_model::Pixel;

    const NEW: Novelty = Novelty { cells: 9, distance: true, tilt: true, elsewhere: true };

    fn corners(shift_px: f64) -> Corners {
        (0..6).map(|i| Some(Pixel::new(f64::from(i) * 10.0 + shift_px, 50.0))).collect()
    }

    fn look<'a>(at: Instant, eyes: [Option<&'a Corners>; 2]) -> Look<'a> {
        Look {
            at,
            width_px: 640,
            left: eyes[0],
            right: eyes[1],
            edge_width_px: Some(2.0),
            novelty: Some(NEW),
            photograph: false,
        }
    }

    /// Shows the board at 30 Hz, moving at this speed, and gives the last hint.
    fn watch(speed_px: f64, looks: u32) -> CaptureHint {
        let start = Instant::now();
        let mut auto = AutoCapture::default();
        let mut hint = CaptureHint::NothingNew;
        for i in 0..looks {
            let seen = corners(speed_px * f64::from(i));
            hint = auto.look(look(start + Duration::from_millis(33) * i, [Some(&seen), Some(&seen)]));
        }
        hint
    }

    #[test]
    fn a_still_board_is_captured_after_a_moment_and_a_moving_one_never() {
        assert!(matches!(watch(0.0, 1), CaptureHint::Moving { .. }), "one look does not show stillness");
        assert!(matches!(watch(0.1, 5), CaptureHint::Moving { .. }), "too short");
        assert_eq!(watch(0.1, 20), CaptureHint::Ready);
        assert!(
            matches!(watch(3.0, 200), CaptureHint::Moving { motion_px } if (motion_px - 3.0).abs() < 1e-9)
        );
    }

    #[test]
    fn a_slow_stream_needs_more_than_one_agreeing_look() {
        let (start, seen) = (Instant::now(), corners(0.0));
        let mut auto = AutoCapture::default();
        let mut hints =
            (0..5).map(|i| auto.look(look(start + Duration::from_secs(1) * i, [Some(&seen), Some(&seen)])));
        assert!(matches!(hints.next(), Some(CaptureHint::Moving { .. })));
        assert!(matches!(hints.next(), Some(CaptureHint::Moving { .. })));
        assert_eq!(hints.last(), Some(CaptureHint::Ready));
    }

    #[test]
    fn a_photograph_is_still() {
        let seen = corners(0.0);
        let photograph = Look { photograph: true, ..look(Instant::now(), [Some(&seen), Some(&seen)]) };
        assert_eq!(AutoCapture::default().look(photograph), CaptureHint::Ready);
    }

    #[test]
    fn what_is_missing_is_said() {
        let seen = corners(0.0);
        let mut auto = AutoCapture::default();
        let one_eye = auto.look(look(Instant::now(), [Some(&seen), None]));
        assert_eq!(one_eye, CaptureHint::NotSeen { eyes: vec![Eye::Right] });
        let still = Look { photograph: true, ..look(Instant::now(), [Some(&seen), Some(&seen)]) };
        assert_eq!(
            auto.look(Look { edge_width_px: Some(9.0), ..still }),
            CaptureHint::Blurred { edge_width_px: 9.0 }
        );
        assert_eq!(auto.look(Look { novelty: Some(Novelty::default()), ..still }), CaptureHint::NothingNew);
    }
}
