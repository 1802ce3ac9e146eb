//! Joins two streams of frames whose clocks agree but whose frames do not come together.

use std::collections::VecDeque;

use plumbline_model::Eye;

use crate::source::Counters;

/// A frame and when it was taken.
#[derive(Clone, Debug)]
pub(crate) struct Timed<T> {
    /// Seconds on a clock that both eyes share.
    pub time_s: f64,
    pub frame: T,
}

/// A left and a right frame of one moment.
pub(crate) type TimedPair<T> = (Timed<T>, Timed<T>);

/// Frames of both eyes that wait for a partner. Times of one eye must not go backward.
pub(crate) struct PairByTime<T> {
    waiting: [VecDeque<Timed<T>>; 2],
    limit_s: f64,
    capacity: usize,
}

impl<T> PairByTime<T> {
    /// Frames at most `limit_s` apart are a pair. At most `capacity` frames of an eye wait.
    ///
    /// With a limit of half the frame distance no frame has two partners within it.
    pub(crate) fn new(limit_s: f64, capacity: usize) -> Self {
        Self { waiting: [VecDeque::new(), VecDeque::new()], limit_s, capacity }
    }

    /// Takes a frame; the oldest of its eye goes if too many wait.
    pub(crate) fn push(&mut self, eye: Eye, time_s: f64, frame: T, counters: &mut Counters) {
        let queue = &mut self.waiting[eye.index()];
        queue.push_back(Timed { time_s, frame });
        if queue.len() > self.capacity {
            queue.pop_front();
            counters.count_unpaired(eye);
        }
    }

    /// Whether an eye has no frame waiting.
    pub(crate) fn needs(&self, eye: Eye) -> bool {
        self.waiting[eye.index()].is_empty()
    }

    /// The oldest pair (left, right); frames that cannot find a partner any more are dropped
    /// and counted.
    pub(crate) fn take(&mut self, counters: &mut Counters) -> Option<TimedPair<T>> {
        loop {
            let [left, right] = [self.waiting[0].front()?.time_s, self.waiting[1].front()?.time_s];
            let difference_s = right - left;
            let (earlier, later_time_s) =
                if difference_s > 0.0 { (Eye::Left, right) } else { (Eye::Right, left) };
            // The frame behind the earlier one may fit better.
            let better = self.waiting[earlier.index()]
                .get(1)
                .is_some_and(|next| (later_time_s - next.time_s).abs() < difference_s.abs());
            if better || difference_s.abs() > self.limit_s {
                self.waiting[earlier.index()].pop_front();
                counters.count_unpaired(earlier);
                continue;
            }
            return self.waiting[0].pop_front().zip(self.waiting[1].pop_front());
        }
    }

    /// Forgets what waits (after a seek).
    pub(crate) fn clear(&mut self) {
        self.waiting.iter_mut().for_each(VecDeque::clear);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pairs (left, right) of frame numbers, and the counters, from two lists of times in ms.
    fn pairs(left_ms: &[u32], right_ms: &[u32], limit_ms: f64) -> (Vec<(u32, u32)>, Counters) {
        let mut counters = Counters::default();
        let mut pairing = PairByTime::new(limit_ms / 1000.0, 100);
        let mut arrivals: Vec<(u32, Eye)> = left_ms
            .iter()
            .map(|&t| (t, Eye::Left))
            .chain(right_ms.iter().map(|&t| (t, Eye::Right)))
            .collect();
        arrivals.sort();
        let mut found = Vec::new();
        for (time_ms, eye) in arrivals {
            pairing.push(eye, f64::from(time_ms) / 1000.0, time_ms, &mut counters);
            while let Some((left, right)) = pairing.take(&mut counters) {
                found.push((left.frame, right.frame));
            }
        }
        (found, counters)
    }

    #[test]
    fn equal_clocks_pair_one_to_one() {
        let (found, counters) = pairs(&[0, 33, 67, 100], &[4, 37, 71, 104], 16.0);
        assert_eq!(found, [(0, 4), (33, 37), (67, 71), (100, 104)]);
        assert_eq!(counters, Counters::default());
    }

    #[test]
    fn a_lost_frame_costs_one_pair_and_is_counted() {
        let (found, counters) = pairs(&[0, 33, 67, 100], &[4, 71, 104], 16.0);
        assert_eq!(found, [(0, 4), (67, 71), (100, 104)]);
        assert_eq!((counters.unpaired_left, counters.unpaired_right), (1, 0));
    }

    #[test]
    fn different_rates_pair_the_nearest() {
        let (found, counters) = pairs(&[0, 33, 66, 99, 132], &[1, 67, 133], 16.0);
        assert_eq!(found, [(0, 1), (66, 67), (132, 133)]);
        assert_eq!(counters.unpaired_left, 2);
    }

    #[test]
    fn frames_too_far_apart_never_pair() {
        let (found, counters) = pairs(&[0, 100, 200], &[50, 150, 250], 16.0);
        assert_eq!(found, []);
        assert_eq!((counters.unpaired_left, counters.unpaired_right), (3, 2), "the last may still pair");
    }

    #[test]
    fn no_frame_is_in_two_pairs_and_order_is_kept() {
        let left: Vec<u32> = (0..198).map(|i| i * 33 + (i * i) % 11).collect();
        let right: Vec<u32> = (0..198).filter(|i| i % 7 != 3).map(|i| i * 33 + 5 + (i * 3) % 9).collect();
        let (found, counters) = pairs(&left, &right, 16.5);
        assert!(found.windows(2).all(|w| w[0].0 < w[1].0 && w[0].1 < w[1].1));
        assert!(found.iter().all(|(l, r)| l.abs_diff(*r) <= 16));
        let unpaired = counters.unpaired_left + counters.unpaired_right;
        assert_eq!(found.len(), right.len(), "every right frame has a left one near it");
        assert_eq!(unpaired as usize, left.len() - right.len());
    }

    #[test]
    fn an_eye_that_is_silent_does_not_fill_the_memory() {
        let mut counters = Counters::default();
        let mut pairing = PairByTime::new(0.016, 3);
        for i in 0..100 {
            pairing.push(Eye::Left, f64::from(i), i, &mut counters);
        }
        assert!(pairing.take(&mut counters).is_none());
        assert_eq!(counters.unpaired_left, 97);
    }
}
