//! The board on its way through places of the twin: it stays at each until the eyes have seen it there.

use std::time::{Duration, Instant};

use plumbline_model::frame::{Board, Pose, Robot};

use super::view::BoardTour;

/// While the board is shown at all places it stays at each for this long: long enough to be
/// found still, sharp and new.
const AT_EACH_PLACE: Duration = Duration::from_millis(1600);
/// Where the machine is slow, it stays until it was looked at so often: a few looks must agree.
const LOOKS_AT_EACH_PLACE: u64 = 8;
/// After this it goes on all the same when nobody looks…
pub(super) const NOBODY_LOOKS: Duration = Duration::from_secs(12);
/// …and after this also when somebody does: the machine is too slow.
const LONGEST_AT_A_PLACE: Duration = Duration::from_secs(60);

/// The way that is under way, and the one that was broken off.
#[derive(Default)]
pub(super) struct BoardTours {
    under_way: Option<Tour>,
    broken_off: Option<Tour>,
}

/// What is done next.
pub(super) enum TourStep {
    /// Nothing.
    Stays,
    /// The board is held there.
    Holds(Pose<Robot, Board>),
    /// It was at all of its places.
    Ends {
        /// So many.
        places: usize,
    },
}

impl BoardTours {
    /// From the first place on.
    pub fn begin(&mut self, places: Vec<Pose<Robot, Board>>) {
        (self.under_way, self.broken_off) = (Some(Tour::through(places)), None);
    }

    /// The board is needed elsewhere, or is to stay: the tour can go on later.
    pub fn break_off(&mut self) {
        if let Some(tour) = self.under_way.take() {
            self.broken_off = Some(tour.again());
        }
    }

    /// Goes on where it was broken off; where it was not, through all places.
    pub fn go_on(&mut self, all: &[Pose<Robot, Board>]) {
        self.break_off();
        let rest = self.broken_off.take();
        self.under_way = Some(rest.unwrap_or_else(|| Tour::through(all.to_vec())));
    }

    /// Goes on as time passes and the eyes look.
    pub fn step(&mut self, now: Instant, looks: u64) -> TourStep {
        let Some(tour) = self.under_way.as_mut().filter(|tour| tour.is_seen(now, looks)) else {
            return TourStep::Stays;
        };
        match tour.places.get(tour.next).copied() {
            Some(robot_from_board) => {
                (tour.next, tour.held, tour.looks) = (tour.next + 1, Some(now), looks);
                TourStep::Holds(robot_from_board)
            }
            None => {
                let places = tour.places.len();
                self.under_way = None;
                TourStep::Ends { places }
            }
        }
    }

    /// How far the tour is that is under way.
    pub fn view(&self) -> Option<BoardTour> {
        self.under_way.as_ref().map(Tour::view)
    }

    /// Places that are missing since a tour was broken off.
    pub fn left(&self) -> usize {
        self.broken_off.as_ref().map_or(0, |tour| tour.places.len().saturating_sub(tour.next))
    }
}

/// Through these places.
struct Tour {
    /// Where it is held, one after the other.
    places: Vec<Pose<Robot, Board>>,
    /// The place that is next.
    next: usize,
    /// When it was held at the one before; `None`: at none yet.
    held: Option<Instant>,
    /// How often the eyes had looked then.
    looks: u64,
}

impl Tour {
    fn through(places: Vec<Pose<Robot, Board>>) -> Self {
        Self { places, next: 0, held: None, looks: 0 }
    }

    /// As it goes on after it was broken off: the board is held once more where it was held last.
    fn again(self) -> Self {
        Self { next: self.next.saturating_sub(1), held: None, ..self }
    }

    fn view(&self) -> BoardTour {
        BoardTour { place: self.next.max(1), of: self.places.len() }
    }

    /// Whether the board was seen where it is.
    fn is_seen(&self, now: Instant, looks: u64) -> bool {
        let Some(held) = self.held else { return true };
        let since = now.saturating_duration_since(held);
        let looked = looks.saturating_sub(self.looks);
        let waits_for = match looked {
            LOOKS_AT_EACH_PLACE.. => AT_EACH_PLACE,
            0 => NOBODY_LOOKS,
            _ => LONGEST_AT_A_PLACE,
        };
        since >= waits_for
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_board_stays_until_it_was_looked_at_often_enough() {
        let held = Instant::now();
        let tour = Tour { places: vec![], next: 1, held: Some(held), looks: 100 };
        let seen = |after_ms: u64, looks: u64| tour.is_seen(held + Duration::from_millis(after_ms), looks);
        assert!(!seen(500, 200), "not found still yet");
        assert!(seen(1600, 108));
        assert!(!seen(30_000, 104) && seen(60_000, 104), "a slow machine has looked four times");
        assert!(seen(12_000, 100), "nobody looks");
    }
}
