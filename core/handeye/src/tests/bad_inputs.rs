//! What goes wrong while it is looked: STOP, eyes that see nothing, a hand that is not seen.

use std::cell::Cell;
use std::rc::Rc;

use image::RgbImage;
use plumbline_grasp::{Body, Halt, ServoState, Sight};
use plumbline_model::robot::Posture;

use super::*;
use crate::Outcome;

/// What is looked at now, for who meddles.
type Now = Rc<Cell<Option<(Part, usize)>>>;

/// Tells what is looked at.
struct Teller(Now);

impl Watch for Teller {
    fn looks(&mut self, part: Part, number: usize, _of: usize) {
        self.0.set(Some((part, number)));
    }
    fn saw(&mut self, _seen: &Seen) {}
    fn computes(&mut self, _what: &str) {}
}

/// A twin that somebody meddles with.
struct Meddled {
    twin: TwinBody,
    now: Now,
    /// STOP is pressed when the robot is to move for this look.
    stop_at: Option<(Part, usize)>,
    stopped: bool,
    /// Moves that were asked for after STOP.
    moved_after: usize,
    /// Whether the eyes see nothing then.
    dark: fn(Option<(Part, usize)>) -> bool,
    /// Whether the hand is behind something then: the picture is that of the table without it.
    hidden: fn(Option<(Part, usize)>) -> bool,
    last_open: Option<Sight>,
    /// What lies before the eyes all the time.
    covers: fn(&mut RgbImage),
}

impl Meddled {
    fn new(rig: &Rig) -> Self {
        Self {
            twin: TwinBody::new(rig, &scenario()),
            now: Now::default(),
            stop_at: None,
            stopped: false,
            moved_after: 0,
            dark: |_| false,
            hidden: |_| false,
            last_open: None,
            covers: |_| {},
        }
    }

    fn tied(&mut self) -> Result<Tied, HandEyeError> {
        let rig = self.twin.rig().clone();
        let mut told = Teller(self.now.clone());
        super::tied(self, &start(&rig, true), &mut told, &Unattended)
    }
}

impl Body for Meddled {
    fn rig(&self) -> &Arc<Rig> {
        self.twin.rig()
    }

    fn now_s(&self) -> f64 {
        self.twin.now_s()
    }

    fn servos(&mut self) -> Result<Vec<ServoState>, Halt> {
        self.twin.servos()
    }

    fn commanded(&mut self) -> Result<Posture, Halt> {
        self.twin.commanded()
    }

    fn follow(&mut self, way: &[Posture], speed_rad_s: f64) -> Result<(), Halt> {
        if self.stopped {
            self.moved_after += 1;
            return Err(Halt::Stopped);
        }
        if self.stop_at.is_some() && self.now.get() == self.stop_at {
            self.stopped = true;
            return Err(Halt::Stopped);
        }
        self.twin.follow(way, speed_rad_s)
    }

    fn wait(&mut self, duration_s: f64) -> Result<(), Halt> {
        self.twin.wait(duration_s)
    }

    fn look(&mut self) -> Result<Sight, Halt> {
        let now = self.now.get();
        let mut sight = self.twin.look()?;
        if (self.dark)(now) {
            for image in [&mut sight.left, &mut sight.right] {
                *image = Arc::new(RgbImage::new(image.width(), image.height()));
            }
        } else if (self.hidden)(now) {
            if let Some(open) = &self.last_open {
                (sight.left, sight.right) = (open.left.clone(), open.right.clone());
            }
        } else if !matches!(now, Some((Part::Hand(_), _))) {
            self.last_open = Some(sight.clone());
        }
        for image in [&mut sight.left, &mut sight.right] {
            (self.covers)(Arc::make_mut(image));
        }
        Ok(sight)
    }
}

#[test]
fn stop_ends_it_in_every_part_and_nothing_moves_afterward() {
    let rig = Rig::built_in("nico").expect("valid");
    let right = Part::Hand(Hand::Right);
    for at in [(Part::Body, 0), (Part::Body, 2), (Part::Screen, 1), (right, 0), (right, 5)] {
        let mut body = Meddled::new(&rig);
        body.stop_at = Some(at);
        let error = body.tied().expect_err("stopped");
        assert!(matches!(error, HandEyeError::Halted(Halt::Stopped)), "{at:?}: {error}");
        assert!(body.stopped, "{at:?}");
        assert_eq!(body.moved_after, 0, "{at:?}: nothing is sent after STOP");
    }
}

#[test]
fn in_the_dark_no_hand_is_found_and_what_to_do_is_said() {
    let mut body = Meddled::new(&Rig::built_in("nico").expect("valid"));
    body.dark = |_| true;
    let error = body.tied().expect_err("nothing is seen");
    assert!(matches!(error, HandEyeError::FewHands { hand: "right", found: 0, .. }), "{error}");
    assert!(error.to_string().contains("light"), "{error}");
}

/// A cloth over half of the screen, as bright as the table: what is left of the outline would be drawn to its border.
#[test]
fn a_screen_that_is_half_covered_is_not_seen() {
    let rig = Rig::built_in("nico").expect("valid");
    let around = [0.0, -0.03, 0.03];
    let there = screen_placed_beside(&mut Meddled::new(&rig), &rig, [0.0, 0.0], &around).expect("seen");
    let covers: [fn(&mut RgbImage); 4] = [
        |image| spread(image, |[x, _], [width, _]| x > width / 2),
        |image| spread(image, |[x, _], [width, _]| x < width / 2),
        |image| spread(image, |[_, y], [_, height]| y > height * 3 / 5),
        |image| spread(image, |[x, y], [width, height]| x > width / 3 && y > height / 2),
    ];
    for (k, covers) in covers.into_iter().enumerate() {
        for placed_m in [[0.0, 0.0], [-0.005, 0.035]] {
            let mut body = Meddled { covers, ..Meddled::new(&rig) };
            let found = screen_placed_beside(&mut body, &rig, placed_m, &around);
            let off = found.map(|found| apart(&found, &there));
            assert_eq!(off, None, "cover {k}, placed {placed_m:?}: it is drawn to whatever covers it");
        }
    }
    // A corner of it covered is no reason to see nothing of it.
    let corner: fn(&mut RgbImage) =
        |image| spread(image, |[x, y], [width, height]| x > width * 5 / 8 && y > height * 5 / 8);
    let mut body = Meddled { covers: corner, ..Meddled::new(&rig) };
    let found = screen_placed_beside(&mut body, &rig, [0.0, 0.0], &around).expect("most of it is seen");
    let (off_m, off_rad) = apart(&found, &there);
    assert!(off_m < 0.004 && off_rad < 0.01, "{off_m} {off_rad}");
}

/// Paints where it is covered.
fn spread(image: &mut RgbImage, covered: fn([u32; 2], [u32; 2]) -> bool) {
    let size = [image.width(), image.height()];
    for (x, y, pixel) in image.enumerate_pixels_mut() {
        if covered([x, y], size) {
            *pixel = image::Rgb([190, 180, 165]);
        }
    }
}

#[test]
fn a_hand_that_is_hidden_at_some_places_is_sized_by_the_others() {
    let mut body = Meddled::new(&Rig::built_in("nico").expect("valid"));
    body.hidden = |now| matches!(now, Some((Part::Hand(Hand::Right), 2 | 6 | 9)));
    // The lights go out before the left hand is looked at.
    body.dark = |now| matches!(now, Some((Part::Hand(Hand::Left), _)));
    let tied = body.tied().expect("enough is seen");
    let figures = &tied.touched.1;
    assert!(figures.found + 3 <= figures.looked && figures.found >= 7, "{figures:?}");
    let (before_m, after_m) = (figures.before_m.expect("found"), figures.after_m.expect("found"));
    assert!(after_m < 0.004 && after_m < before_m, "{before_m} {after_m}");
    let Some((Hand::Left, Outcome::Stays(why))) = &tied.other else { panic!("{:?}", tied.other) };
    assert!(why.contains("left hand was found at 0 of"), "{why}");
}
