//! The boxes of one image while they are drawn and corrected, with undo.

use plumbline_model::{ClassIndex, PixelBox};

use super::command::BoxEdit;
use super::view::LabelBox;

/// Changes that can be taken back, per image.
const KEPT: usize = 400;
/// A box has at least this side; less is a slip of the hand.
pub const LEAST_SIDE_PX: f32 = 2.0;

/// The boxes of one image with what they were before.
///
/// That an image was looked at and nothing is on it is a label too, so it is taken back like a box.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BoxHistory {
    now: Labels,
    past: Vec<Labels>,
    future: Vec<Labels>,
}

#[derive(Clone, Debug, Default, PartialEq)]
struct Labels {
    boxes: Vec<LabelBox>,
    labeled: bool,
}

/// Why a change is not made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EditError {
    /// The list changed since.
    #[error("There is no such box any more.")]
    NoSuchBox,
    /// The list changed since.
    #[error("There is no such proposal any more.")]
    NoSuchProposal,
    /// Not a class of the data set.
    #[error("The data set has no class number {}; it has {classes}.", class.0 + 1)]
    NoSuchClass {
        /// What was asked for.
        class: ClassIndex,
        /// How many there are.
        classes: usize,
    },
    /// Nothing of it is on the image, or it has no extent.
    #[error("A box must lie on the image and be at least {LEAST_SIDE_PX} px wide and high.")]
    TooSmall,
}

/// What boxes may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bounds {
    /// Width and height of the image.
    pub size_px: (u32, u32),
    /// How many classes there are.
    pub classes: usize,
}

impl Bounds {
    /// The part on the image.
    fn area(&self, area: PixelBox) -> Result<PixelBox, EditError> {
        let ordered = PixelBox::new(
            area.x0_px.min(area.x1_px),
            area.y0_px.min(area.y1_px),
            area.x0_px.max(area.x1_px),
            area.y0_px.max(area.y1_px),
        );
        let on_image = ordered.on_image(self.size_px).ok_or(EditError::TooSmall)?;
        let big = on_image.width_px() >= LEAST_SIDE_PX && on_image.height_px() >= LEAST_SIDE_PX;
        big.then_some(on_image).ok_or(EditError::TooSmall)
    }

    fn class(&self, class: ClassIndex) -> Result<ClassIndex, EditError> {
        let known = class.0 < self.classes;
        known.then_some(class).ok_or(EditError::NoSuchClass { class, classes: self.classes })
    }
}

impl BoxHistory {
    /// As it is on disk.
    pub fn new(boxes: Vec<LabelBox>, labeled: bool) -> Self {
        Self { now: Labels { boxes, labeled }, past: Vec::new(), future: Vec::new() }
    }

    /// Whether somebody said what is on the image.
    pub fn is_labeled(&self) -> bool {
        self.now.labeled
    }

    /// The boxes as they are now.
    pub fn boxes(&self) -> &[LabelBox] {
        &self.now.boxes
    }

    /// Whether there is something to take back.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Whether there is something to do again.
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }

    /// Changes a box. Returns whether anything is different now.
    ///
    /// # Errors
    /// When the change makes no sense; then nothing was changed.
    pub fn apply(&mut self, edit: BoxEdit, bounds: &Bounds) -> Result<bool, EditError> {
        let mut next = self.now.boxes.clone();
        let at = |boxes: &[LabelBox], index: usize| {
            (index < boxes.len()).then_some(index).ok_or(EditError::NoSuchBox)
        };
        match edit {
            BoxEdit::Add { class, area } => {
                next.push(LabelBox { class: bounds.class(class)?, area: bounds.area(area)? });
            }
            BoxEdit::Place { index, area } => {
                let index = at(&next, index)?;
                next[index].area = bounds.area(area)?;
            }
            BoxEdit::Class { index, class } => {
                let index = at(&next, index)?;
                next[index].class = bounds.class(class)?;
            }
            BoxEdit::Delete { index } => {
                let index = at(&next, index)?;
                next.remove(index);
            }
        }
        Ok(self.replace(next))
    }

    /// Adds boxes, leaving out those that are there already. Returns whether anything is different now.
    pub fn add_all(&mut self, more: impl IntoIterator<Item = LabelBox>, bounds: &Bounds) -> bool {
        let mut next = self.now.boxes.clone();
        for label in more {
            let (Ok(class), Ok(area)) = (bounds.class(label.class), bounds.area(label.area)) else {
                continue;
            };
            let label = LabelBox { class, area };
            if !next.iter().any(|there| is_double(there, &label)) {
                next.push(label);
            }
        }
        next != self.now.boxes && self.replace(next)
    }

    /// Is labeled with these boxes from now on, as one change. Returns whether anything is different
    /// now.
    pub fn replace(&mut self, boxes: Vec<LabelBox>) -> bool {
        let next = Labels { boxes, labeled: true };
        if next == self.now {
            return false;
        }
        self.past.push(std::mem::replace(&mut self.now, next));
        if self.past.len() > KEPT {
            self.past.remove(0);
        }
        self.future.clear();
        true
    }

    /// Takes the last change back. Returns whether there was one.
    pub fn undo(&mut self) -> bool {
        let Some(before) = self.past.pop() else { return false };
        self.future.push(std::mem::replace(&mut self.now, before));
        true
    }

    /// Does again what was taken back. Returns whether there was something.
    pub fn redo(&mut self) -> bool {
        let Some(after) = self.future.pop() else { return false };
        self.past.push(std::mem::replace(&mut self.now, after));
        true
    }
}

/// Overlap from which two boxes of a class are the same thing labeled twice.
const DOUBLE_FROM_IOU: f32 = 0.9;

/// Whether two boxes say the same twice.
pub fn is_double(a: &LabelBox, b: &LabelBox) -> bool {
    a.class == b.class && a.area.iou(&b.area) >= DOUBLE_FROM_IOU
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Bounds = Bounds { size_px: (640, 480), classes: 8 };

    fn add(x: f32, class: usize) -> BoxEdit {
        let area = PixelBox::new(x, 10.0, x + 30.0, 40.0);
        BoxEdit::Add { class: ClassIndex(class), area }
    }

    /// A long row of different edits, always the same.
    fn edits() -> Vec<BoxEdit> {
        let mut edits: Vec<BoxEdit> = (0..6).map(|i| add(50.0 * i as f32, i)).collect();
        edits.push(BoxEdit::Place { index: 2, area: PixelBox::new(5.0, 5.0, 25.0, 30.0) });
        edits.push(BoxEdit::Class { index: 4, class: ClassIndex(7) });
        edits.push(BoxEdit::Delete { index: 0 });
        edits.push(BoxEdit::Delete { index: 4 });
        edits.push(add(300.0, 1));
        edits
    }

    #[test]
    fn undoing_everything_gives_the_beginning_and_redoing_everything_the_end() {
        let mut history = BoxHistory::default();
        let mut seen = vec![history.boxes().to_vec()];
        for edit in edits() {
            assert_eq!(history.apply(edit, &BOUNDS), Ok(true));
            seen.push(history.boxes().to_vec());
        }
        for expected in seen.iter().rev().skip(1) {
            assert!(history.undo());
            assert_eq!(history.boxes(), expected);
        }
        assert!(!history.undo() && !history.can_undo());
        for expected in seen.iter().skip(1) {
            assert!(history.redo());
            assert_eq!(history.boxes(), expected);
        }
        assert!(!history.redo() && !history.can_redo());
    }

    #[test]
    fn a_change_after_undo_forgets_what_could_be_redone() {
        let mut history = BoxHistory::default();
        for edit in edits() {
            history.apply(edit, &BOUNDS).expect("valid");
        }
        history.undo();
        history.apply(add(500.0, 2), &BOUNDS).expect("valid");
        assert!(!history.can_redo());
        let now = history.boxes().to_vec();
        history.undo();
        history.redo();
        assert_eq!(history.boxes(), now);
    }

    #[test]
    fn what_changes_nothing_is_no_step_back() {
        let mut history = BoxHistory::default();
        history.apply(add(0.0, 3), &BOUNDS).expect("valid");
        assert_eq!(history.apply(BoxEdit::Class { index: 0, class: ClassIndex(3) }, &BOUNDS), Ok(false));
        assert!(history.undo() && !history.can_undo());
    }

    #[test]
    fn that_nothing_is_there_is_a_label_that_can_be_taken_back() {
        let mut history = BoxHistory::default();
        assert!(history.replace(Vec::new()) && history.is_labeled());
        assert!(!history.replace(Vec::new()), "it was said already");
        assert!(history.undo() && !history.is_labeled());
        history.apply(add(0.0, 0), &BOUNDS).expect("valid");
        assert!(history.is_labeled());
        assert!(history.undo() && !history.is_labeled() && history.boxes().is_empty());
    }

    #[test]
    fn nonsense_is_refused_and_changes_nothing() {
        let mut history = BoxHistory::default();
        history.apply(add(0.0, 0), &BOUNDS).expect("valid");
        let before = history.clone();
        let off = BoxEdit::Place { index: 0, area: PixelBox::new(700.0, 0.0, 800.0, 9.0) };
        assert_eq!(history.apply(off, &BOUNDS), Err(EditError::TooSmall));
        let dot = BoxEdit::Add { class: ClassIndex(0), area: PixelBox::new(9.0, 9.0, 10.0, 30.0) };
        assert_eq!(history.apply(dot, &BOUNDS), Err(EditError::TooSmall));
        let nan = BoxEdit::Add { class: ClassIndex(0), area: PixelBox::new(f32::NAN, 9.0, 10.0, f32::NAN) };
        assert_eq!(history.apply(nan, &BOUNDS), Err(EditError::TooSmall));
        assert_eq!(history.apply(BoxEdit::Delete { index: 1 }, &BOUNDS), Err(EditError::NoSuchBox));
        let class = ClassIndex(8);
        let error = history.apply(BoxEdit::Class { index: 0, class }, &BOUNDS).expect_err("eight classes");
        assert_eq!(error.to_string(), "The data set has no class number 9; it has 8.");
        assert_eq!(history, before);
    }

    #[test]
    fn a_box_is_kept_on_the_image_however_it_was_drawn() {
        let mut history = BoxHistory::default();
        let area = PixelBox::new(630.0, 490.0, 700.0, 400.0);
        history.apply(BoxEdit::Add { class: ClassIndex(0), area }, &BOUNDS).expect("partly on it");
        assert_eq!(history.boxes()[0].area, PixelBox::new(630.0, 400.0, 640.0, 480.0));
    }

    #[test]
    fn copied_boxes_are_one_step_and_do_not_double() {
        let mut before = BoxHistory::default();
        for edit in edits() {
            before.apply(edit, &BOUNDS).expect("valid");
        }
        let mut history = BoxHistory::new(before.boxes()[..2].to_vec(), true);
        assert!(history.add_all(before.boxes().iter().copied(), &BOUNDS));
        assert_eq!(history.boxes(), before.boxes());
        assert!(!history.add_all(before.boxes().iter().copied(), &BOUNDS), "all are there");
        assert!(history.undo());
        assert_eq!(history.boxes(), &before.boxes()[..2]);
    }
}
