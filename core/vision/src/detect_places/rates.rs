//! How reliably each class is seen, over the last frames.

use plumbline_model::{ClassIndex, Eye};

use super::types::{ObjectPlace, Seen};

/// Objects of one class in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Count {
    agreed: u16,
    left_only: u16,
    right_only: u16,
}

impl Count {
    fn objects(self) -> u32 {
        u32::from(self.agreed) + u32::from(self.left_only) + u32::from(self.right_only)
    }
}

/// Counts what was seen, per class, over a window of frames.
///
/// Nobody knows here what truly lies in front of the eyes, so every figure is about consistency: of
/// one eye with the other, and of a frame with the window. An object of which the two eyes name
/// different classes counts for either class as seen by that eye only.
#[derive(Clone, Debug)]
pub struct Rates {
    classes: usize,
    window: usize,
    /// `window` frames of `classes` counts, used as a ring.
    counts: Vec<Count>,
    next: usize,
    frames: usize,
}

/// Figures of one class over the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClassRates {
    /// Frames in the window.
    pub frames: usize,
    /// Share of the frames in which the left eye saw at least one, 0–1.
    pub left: f64,
    /// The same of the right eye.
    pub right: f64,
    /// Of all objects of the class in the window, the share that both eyes saw as one and the same;
    /// `None` if there was none.
    pub agree: Option<f64>,
    /// Of all objects of the class in the window, the share that only one eye saw: the other one
    /// has missed it or one has invented it. `1 − agree`.
    pub one_eye_only: Option<f64>,
    /// Objects that a frame usually has (the most frequent number in the window, the larger one of
    /// two equally frequent).
    pub usual: u32,
    /// Share of the usual objects that frames lacked in both eyes, 0–1; `None` if there usually is
    /// none. Counts as missing also what was taken away during the window.
    pub lost: Option<f64>,
}

/// Numbers of objects that are told apart when the usual one is looked for.
const MOST_OBJECTS: usize = 64;

impl Rates {
    /// For so many classes and a window of so many frames (at least one).
    pub fn new(classes: usize, window: usize) -> Self {
        let window = window.max(1);
        Self { classes, window, counts: vec![Count::default(); classes * window], next: 0, frames: 0 }
    }

    /// Forgets everything.
    pub fn reset(&mut self) {
        (self.next, self.frames) = (0, 0);
    }

    /// Adds a frame. Classes beyond those it was made for are not counted.
    pub fn add(&mut self, objects: &[ObjectPlace]) {
        let frame = &mut self.counts[self.next * self.classes..][..self.classes];
        frame.fill(Count::default());
        let mut count = |class: ClassIndex, add: fn(&mut Count)| {
            if let Some(count) = frame.get_mut(class.0) {
                add(count);
            }
        };
        let left_only = |count: &mut Count| count.left_only = count.left_only.saturating_add(1);
        let right_only = |count: &mut Count| count.right_only = count.right_only.saturating_add(1);
        for object in objects {
            match object.seen {
                Seen::Both { eyes_disagree: None, .. } => {
                    count(object.class, |count| count.agreed = count.agreed.saturating_add(1));
                }
                Seen::Both { eyes_disagree: Some([left, right]), .. } => {
                    count(left, left_only);
                    count(right, right_only);
                }
                Seen::One { eye: Eye::Left, .. } => count(object.class, left_only),
                Seen::One { eye: Eye::Right, .. } => count(object.class, right_only),
            }
        }
        self.next = (self.next + 1) % self.window;
        self.frames = (self.frames + 1).min(self.window);
    }

    /// Frames in the window so far.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Figures of a class; `None` before the first frame and for a class that is not counted.
    pub fn class(&self, class: ClassIndex) -> Option<ClassRates> {
        if class.0 >= self.classes || self.frames == 0 {
            return None;
        }
        // Until the ring is full it is filled from its start.
        let each = || self.counts.chunks_exact(self.classes).take(self.frames).map(|frame| frame[class.0]);
        let share = |seen: fn(Count) -> bool| each().filter(|c| seen(*c)).count() as f64 / self.frames as f64;
        let objects: u32 = each().map(Count::objects).sum();
        let agreed: u32 = each().map(|count| u32::from(count.agreed)).sum();
        let agree = (objects > 0).then(|| f64::from(agreed) / f64::from(objects));
        let usual = usual(each().map(Count::objects));
        let lacking: u32 = each().map(|count| usual.saturating_sub(count.objects())).sum();
        Some(ClassRates {
            frames: self.frames,
            left: share(|count| count.agreed + count.left_only > 0),
            right: share(|count| count.agreed + count.right_only > 0),
            agree,
            one_eye_only: agree.map(|agree| 1.0 - agree),
            usual,
            lost: (usual > 0).then(|| f64::from(lacking) / (f64::from(usual) * self.frames as f64)),
        })
    }
}

fn usual(numbers: impl Iterator<Item = u32>) -> u32 {
    let mut frames = [0u32; MOST_OBJECTS + 1];
    for number in numbers {
        frames[(number as usize).min(MOST_OBJECTS)] += 1;
    }
    let most_frequent = (0..=MOST_OBJECTS as u32).max_by_key(|number| frames[*number as usize]);
    most_frequent.unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detect_places::{NoPlace, Unpaired};

    fn object(class: usize, seen: Seen) -> ObjectPlace {
        ObjectPlace { class: ClassIndex(class), confidence: 0.5, seen, place: Err(NoPlace::NoCalibration) }
    }

    fn both(class: usize) -> ObjectPlace {
        object(class, Seen::Both { left: 0, right: 0, epipolar_px: 0.0, eyes_disagree: None })
    }

    fn one(class: usize, eye: Eye) -> ObjectPlace {
        object(class, Seen::One { eye, index: 0, why: Unpaired::NoneOfThatClass })
    }

    #[test]
    fn what_was_seen_is_counted() {
        let mut rates = Rates::new(3, 10);
        assert_eq!(rates.class(ClassIndex(0)), None);
        for _ in 0..6 {
            rates.add(&[both(0), both(0), both(1)]);
        }
        rates.add(&[both(0), one(0, Eye::Left)]);
        rates.add(&[one(0, Eye::Right), both(9)]);
        let zero = rates.class(ClassIndex(0)).expect("counted");
        assert_eq!((zero.frames, zero.usual), (8, 2));
        assert_eq!((zero.left, zero.right), (7.0 / 8.0, 1.0));
        assert_eq!(zero.agree, Some(13.0 / 15.0));
        assert_eq!(zero.lost, Some(1.0 / 16.0));
        let one = rates.class(ClassIndex(1)).expect("counted");
        assert_eq!((one.left, one.agree, one.lost), (0.75, Some(1.0), Some(0.25)));
        let two = rates.class(ClassIndex(2)).expect("counted");
        assert_eq!((two.left, two.agree, two.usual, two.lost), (0.0, None, 0, None));
        assert_eq!(rates.class(ClassIndex(9)), None);
    }

    #[test]
    fn old_frames_are_forgotten() {
        let mut rates = Rates::new(1, 3);
        rates.add(&[both(0)]);
        for _ in 0..3 {
            rates.add(&[]);
        }
        assert_eq!(rates.class(ClassIndex(0)).expect("counted").left, 0.0);
        rates.reset();
        assert_eq!(rates.class(ClassIndex(0)), None);
        rates.add(&[one(0, Eye::Left)]);
        assert_eq!(rates.class(ClassIndex(0)).expect("counted").left, 1.0);
    }

    #[test]
    fn eyes_that_name_different_classes_do_not_agree() {
        let mut rates = Rates::new(2, 3);
        let eyes_disagree = Some([ClassIndex(0), ClassIndex(1)]);
        rates.add(&[object(0, Seen::Both { left: 0, right: 0, epipolar_px: 0.0, eyes_disagree })]);
        let [zero, one] = [0, 1].map(|class| rates.class(ClassIndex(class)).expect("counted"));
        assert_eq!((zero.left, zero.right, zero.agree), (1.0, 0.0, Some(0.0)));
        assert_eq!((one.left, one.right, one.agree), (0.0, 1.0, Some(0.0)));
    }
}
