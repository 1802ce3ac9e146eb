//! The board on its way through places of the twin: it stays at each until the eyes are done with it there.

use std::time::{Duration, Instant};

use plumbline_model::frame::{Board, Pose, Robot};

use super::view::{BoardTour, TourWaits};

/// While the board is shown at all places it stays at each for this long, so that people see it there, too.
const AT_EACH_PLACE: Duration = Duration::from_millis(1600);
/// Images taken sooner after it was put somewhere may show it where it was before.
const ON_ITS_WAY: Duration = Duration::from_millis(500);
/// Where it cannot be captured, it stays until it was looked for so often and for so long…
const LOOKS_IN_VAIN: u32 = 8;
const LOOKED_FOR_IN_VAIN: Duration = Duration::from_secs(5);
/// …after this it goes on all the same when nobody looks…
pub(super) const NOBODY_LOOKS: Duration = Duration::from_secs(12);
/// …and after this also when somebody does: the machine is too slow.
const LONGEST_AT_A_PLACE: Duration = Duration::from_secs(60);
/// Where it stays for longer than this, it is said what it waits for.
const SAID_AFTER: Duration = Duration::from_secs(4);

/// One search for the board has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoardLook {
    /// When the images were taken.
    pub captured_at: Instant,
    /// Whether nothing more is to be had of it there: it was captured, or is still and sharp where it was before.
    pub is_done: bool,
}

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

    /// The board was looked for.
    pub fn looked(&mut self, look: BoardLook) {
        if let Some(tour) = &mut self.under_way {
            tour.looked(look);
        }
    }

    /// The operator waits for nothing more where it is.
    pub fn skip(&mut self) {
        if let Some(tour) = &mut self.under_way {
            tour.is_skipped = tour.held.is_some();
        }
    }

    /// Goes on as time passes.
    pub fn step(&mut self, now: Instant) -> TourStep {
        let Some(tour) = &mut self.under_way else { return TourStep::Stays };
        if !tour.goes_on(now) {
            tour.waits = tour.waits_for(now);
            return TourStep::Stays;
        }
        match tour.places.get(tour.next).copied() {
            Some(robot_from_board) => {
                tour.comes_to_the_next(now);
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
    /// How often it was looked for since.
    looks: u32,
    /// Whether nothing more is to be had of it there.
    is_done: bool,
    /// Whether nobody waits for that.
    is_skipped: bool,
    /// What it waits for, where that takes long.
    waits: Option<TourWaits>,
}

impl Tour {
    fn through(places: Vec<Pose<Robot, Board>>) -> Self {
        Self { places, next: 0, held: None, looks: 0, is_done: false, is_skipped: false, waits: None }
    }

    fn comes_to_the_next(&mut self, now: Instant) {
        (self.next, self.held, self.looks) = (self.next + 1, Some(now), 0);
        (self.is_done, self.is_skipped, self.waits) = (false, false, None);
    }

    /// As it goes on after it was broken off: the board is held once more where it was held last.
    fn again(self) -> Self {
        Self { next: self.next.saturating_sub(1), held: None, is_skipped: false, waits: None, ..self }
    }

    fn view(&self) -> BoardTour {
        BoardTour { place: self.next.max(1), of: self.places.len(), waits: self.waits }
    }

    fn looked(&mut self, look: BoardLook) {
        if self.held.is_some_and(|held| look.captured_at >= held + ON_ITS_WAY) {
            self.looks += 1;
            self.is_done |= look.is_done;
        }
    }

    /// Whether it has been where it is for long enough.
    fn goes_on(&self, now: Instant) -> bool {
        let Some(held) = self.held.filter(|_| !self.is_skipped) else { return true };
        let at_least = match self.looks {
            _ if self.is_done => AT_EACH_PLACE,
            0 => NOBODY_LOOKS,
            LOOKS_IN_VAIN.. => LOOKED_FOR_IN_VAIN,
            _ => LONGEST_AT_A_PLACE,
        };
        now.saturating_duration_since(held) >= at_least
    }

    /// What keeps it where it is, once that takes long.
    fn waits_for(&self, now: Instant) -> Option<TourWaits> {
        let is_long = now.saturating_duration_since(self.held?) >= SAID_AFTER;
        let what = if self.looks == 0 { TourWaits::Look } else { TourWaits::Sight };
        (is_long && !self.is_done).then_some(what)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_board_stays_until_it_was_captured_however_slow_the_machine_is() {
        let held = Instant::now();
        let after = |ms: u64| held + Duration::from_millis(ms);
        let look = |ms: u64, is_done: bool| BoardLook { captured_at: after(ms), is_done };
        // When it goes on after these looks, ms: it does not one millisecond before.
        let goes_on_after = |looks: &[BoardLook], ms: u64| {
            let mut tour = Tour { held: Some(held), next: 1, ..Tour::through(vec![]) };
            looks.iter().for_each(|look| tour.looked(*look));
            !tour.goes_on(after(ms - 1)) && tour.goes_on(after(ms))
        };
        assert!(goes_on_after(&[look(700, false), look(1300, true)], 1600), "people see it, too");
        assert!(goes_on_after(&[look(9_000, false), look(40_000, true)], 1600), "a slow machine, at once");
        let moving: Vec<BoardLook> = (0..4).map(|k| look(1000 + 500 * k, false)).collect();
        assert!(goes_on_after(&moving, 60_000), "it may be captured yet");
        let unseen: Vec<BoardLook> = (0..8).map(|k| look(600 + 100 * k, false)).collect();
        assert!(goes_on_after(&unseen, 5_000), "it is not seen there");
        assert!(goes_on_after(&[], 12_000), "nobody looks");
        assert!(goes_on_after(&[look(300, true)], 12_000), "that was the place before");
    }

    #[test]
    fn what_it_waits_for_is_said_and_can_be_skipped() {
        let begun = Instant::now();
        let after = |ms: u64| begun + Duration::from_millis(ms);
        let mut tours = BoardTours::default();
        tours.begin(vec![Pose::identity(), Pose::identity()]);
        tours.skip();
        assert!(
            matches!(tours.step(begun), TourStep::Holds(_)),
            "the first place is not skipped before it is reached"
        );
        let seen = |tours: &BoardTours| tours.view().expect("it is on its way");
        assert!(matches!(tours.step(after(3_900)), TourStep::Stays) && seen(&tours).waits.is_none());
        assert!(matches!(tours.step(after(4_000)), TourStep::Stays));
        assert_eq!(seen(&tours).waits, Some(TourWaits::Look));
        tours.looked(BoardLook { captured_at: after(4_100), is_done: false });
        assert!(matches!(tours.step(after(4_200)), TourStep::Stays));
        assert_eq!(seen(&tours), BoardTour { place: 1, of: 2, waits: Some(TourWaits::Sight) });
        tours.skip();
        assert!(matches!(tours.step(after(4_300)), TourStep::Holds(_)));
        assert_eq!(seen(&tours), BoardTour { place: 2, of: 2, waits: None });
        assert!(matches!(tours.step(after(5_000)), TourStep::Stays), "one place at a time");
        tours.skip();
        assert!(matches!(tours.step(after(5_100)), TourStep::Ends { places: 2 }));
    }
}
