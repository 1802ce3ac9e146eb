//! The pairs collected for a calibration, with undo.

use std::collections::BTreeSet;
use std::sync::Arc;

use plumbline_model::{Chessboard, PairObservation};

use super::view::CollectedPair;

/// Changes that can be taken back.
const UNDO_DEPTH: usize = 200;

/// Why a pair cannot be added or found.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CollectError {
    /// It is there already.
    #[error("The pair {0} is collected already. Show the board somewhere else, or delete that pair first.")]
    Twice(String),
    /// Another camera, or other settings.
    #[error(
        "The pair {name} is {}×{} px, but what is collected is {}×{} px. Delete all collected pairs to begin with the new images.",
        .size_px.0, .size_px.1, .collected_px.0, .collected_px.1
    )]
    OtherSize {
        /// Name of the pair.
        name: String,
        /// Its size (width, height).
        size_px: (u32, u32),
        /// Size of what is collected.
        collected_px: (u32, u32),
    },
    /// Not in the collection.
    #[error("There is no collected pair called {0}.")]
    NoSuchPair(String),
    /// Nothing to delete.
    #[error("No pair is collected yet. Capture one, or collect a recording.")]
    Empty,
    /// Nothing to take back.
    #[error("There is nothing to take back.")]
    NothingToUndo,
}

/// What can be taken back.
#[derive(Clone, Debug)]
struct Content {
    /// Different for every content there ever was, and the same for one that came back.
    revision: u64,
    board: Chessboard,
    size_px: Option<[(u32, u32); 2]>,
    pairs: Vec<Arc<CollectedPair>>,
    dropped: BTreeSet<String>,
}

impl Content {
    fn is_as(&self, other: &Self) -> bool {
        let same_pairs = self.pairs.len() == other.pairs.len()
            && self.pairs.iter().zip(&other.pairs).all(|(one, two)| Arc::ptr_eq(one, two));
        same_pairs
            && self.board == other.board
            && self.size_px == other.size_px
            && self.dropped == other.dropped
    }
}

/// Pairs in the order of capture, which of them are dropped, and how it came about.
#[derive(Clone, Debug)]
pub struct Collection {
    now: Content,
    before: Vec<Content>,
    revisions: u64,
    captured: u32,
}

impl Collection {
    /// No pairs yet.
    pub fn new(board: Chessboard) -> Self {
        let now = Content { revision: 0, board, size_px: None, pairs: Vec::new(), dropped: BTreeSet::new() };
        Self { now, before: Vec::new(), revisions: 0, captured: 0 }
    }

    /// The board that the corners belong to.
    pub fn board(&self) -> &Chessboard {
        &self.now.board
    }

    /// Pairs in the order of capture.
    pub fn pairs(&self) -> &[Arc<CollectedPair>] {
        &self.now.pairs
    }

    /// Names of pairs left out of the next solution.
    pub fn dropped(&self) -> &BTreeSet<String> {
        &self.now.dropped
    }

    /// Size (width, height) of the images of both eyes; `None` while empty.
    pub fn sizes_px(&self) -> Option<[(u32, u32); 2]> {
        self.now.size_px
    }

    /// Number of the present content; undo brings the number back too.
    pub fn revision(&self) -> u64 {
        self.now.revision
    }

    /// Whether there is a change to take back.
    pub fn can_undo(&self) -> bool {
        !self.before.is_empty()
    }

    /// What the solver gets.
    pub fn observations(&self) -> Vec<PairObservation> {
        self.now
            .pairs
            .iter()
            .map(|pair| PairObservation {
                name: pair.name.clone(),
                left: pair.left.clone(),
                right: pair.right.clone(),
            })
            .collect()
    }

    /// A name for a pair that has none of its own; never given twice.
    pub fn next_name(&mut self) -> String {
        loop {
            self.captured += 1;
            let name = format!("capture {:03}", self.captured);
            if !self.contains(&name) {
                return name;
            }
        }
    }

    /// Whether a pair of this name is collected.
    pub fn contains(&self, name: &str) -> bool {
        self.now.pairs.iter().any(|pair| pair.name == name)
    }

    /// Adds one pair whose images have these sizes.
    pub fn add(&mut self, pair: CollectedPair, sizes_px: [(u32, u32); 2]) -> Result<(), CollectError> {
        self.fits(&pair.name, sizes_px)?;
        self.remember();
        self.now.size_px = Some(sizes_px);
        self.now.pairs.push(Arc::new(pair));
        Ok(())
    }

    /// Adds the pairs that are not there yet as one change; gives their number.
    pub fn add_all(
        &mut self,
        pairs: Vec<CollectedPair>,
        sizes_px: [(u32, u32); 2],
    ) -> Result<usize, CollectError> {
        let new: Vec<CollectedPair> = pairs.into_iter().filter(|pair| !self.contains(&pair.name)).collect();
        let Some(first) = new.first() else { return Ok(0) };
        self.fits(&first.name, sizes_px)?;
        self.remember();
        self.now.size_px = Some(sizes_px);
        let count = new.len();
        self.now.pairs.extend(new.into_iter().map(Arc::new));
        Ok(count)
    }

    /// Puts other pairs in place of all.
    pub fn replace(
        &mut self,
        board: Chessboard,
        pairs: Vec<CollectedPair>,
        sizes_px: [(u32, u32); 2],
        dropped: BTreeSet<String>,
    ) {
        self.remember();
        let pairs = pairs.into_iter().map(Arc::new).collect();
        let revision = self.now.revision;
        self.now = Content { revision, board, size_px: Some(sizes_px), pairs, dropped };
    }

    /// Changes the board. Corners of another board are of no use, so the pairs go (and come
    /// back with undo).
    pub fn set_board(&mut self, board: Chessboard) {
        if board == self.now.board {
            return;
        }
        let same_corners = (board.inner_columns, board.inner_rows)
            == (self.now.board.inner_columns, self.now.board.inner_rows);
        self.remember();
        self.now.board = board;
        if !same_corners {
            self.clear();
        }
    }

    /// Removes the newest pair; gives its name.
    pub fn delete_last(&mut self) -> Result<String, CollectError> {
        let name = self.now.pairs.last().ok_or(CollectError::Empty)?.name.clone();
        self.delete(&name)?;
        Ok(name)
    }

    /// Removes a pair.
    pub fn delete(&mut self, name: &str) -> Result<(), CollectError> {
        self.exists(name)?;
        self.remember();
        self.now.pairs.retain(|pair| pair.name != name);
        self.now.dropped.remove(name);
        if self.now.pairs.is_empty() {
            self.now.size_px = None;
        }
        Ok(())
    }

    /// Removes all pairs; gives their number.
    pub fn delete_all(&mut self) -> Result<usize, CollectError> {
        let count = self.now.pairs.len();
        if count == 0 {
            return Err(CollectError::Empty);
        }
        self.remember();
        self.clear();
        Ok(count)
    }

    /// Leaves a pair out of the next solution.
    pub fn drop_pair(&mut self, name: &str) -> Result<(), CollectError> {
        self.exists(name)?;
        if !self.now.dropped.contains(name) {
            self.remember();
            self.now.dropped.insert(name.to_owned());
            self.recognize();
        }
        Ok(())
    }

    /// Takes a dropped pair back in.
    pub fn restore_pair(&mut self, name: &str) -> Result<(), CollectError> {
        self.exists(name)?;
        if self.now.dropped.contains(name) {
            self.remember();
            self.now.dropped.remove(name);
            self.recognize();
        }
        Ok(())
    }

    /// Takes the last change back.
    pub fn undo(&mut self) -> Result<(), CollectError> {
        self.now = self.before.pop().ok_or(CollectError::NothingToUndo)?;
        Ok(())
    }

    fn clear(&mut self) {
        self.now.pairs.clear();
        self.now.dropped.clear();
        self.now.size_px = None;
    }

    fn remember(&mut self) {
        if self.before.len() == UNDO_DEPTH {
            self.before.remove(0);
        }
        self.before.push(self.now.clone());
        self.revisions += 1;
        self.now.revision = self.revisions;
    }

    /// What is as it was before has the number that it had: what was solved from it is not stale.
    fn recognize(&mut self) {
        if let Some(same) = self.before.iter().rev().find(|before| before.is_as(&self.now)) {
            self.now.revision = same.revision;
        }
    }

    fn exists(&self, name: &str) -> Result<(), CollectError> {
        if self.contains(name) { Ok(()) } else { Err(CollectError::NoSuchPair(name.to_owned())) }
    }

    fn fits(&self, name: &str, sizes_px: [(u32, u32); 2]) -> Result<(), CollectError> {
        if self.contains(name) {
            return Err(CollectError::Twice(name.to_owned()));
        }
        match self.now.size_px {
            Some(collected) if collected != sizes_px => {
                let other = if collected[0] == sizes_px[0] { 1 } else { 0 };
                Err(CollectError::OtherSize {
                    name: name.to_owned(),
                    size_px: sizes_px[other],
                    collected_px: collected[other],
                })
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZES: [(u32, u32); 2] = [(640, 480); 2];

    fn pair(name: &str) -> CollectedPair {
        CollectedPair {
            name: name.into(),
            left: None,
            right: None,
            left_image: None,
            right_image: None,
            place: None,
            taken: None,
        }
    }

    fn names(collection: &Collection) -> Vec<&str> {
        collection.pairs().iter().map(|pair| pair.name.as_str()).collect()
    }

    fn three() -> Collection {
        let mut collection = Collection::new(plumbline_model::default_board());
        for name in ["a", "b", "c"] {
            collection.add(pair(name), SIZES).expect("fits");
        }
        collection
    }

    #[test]
    fn undo_takes_back_one_change_after_the_other() {
        let mut collection = three();
        collection.drop_pair("a").expect("there");
        collection.delete("b").expect("there");
        assert_eq!(collection.delete_last(), Ok("c".to_owned()));
        collection.delete_all().expect("not empty");
        assert_eq!(names(&collection), Vec::<&str>::new());
        for expected in [vec!["a"], vec!["a", "c"], vec!["a", "b", "c"]] {
            collection.undo().expect("a change");
            assert_eq!(names(&collection), expected);
        }
        assert!(collection.dropped().contains("a"));
        collection.undo().expect("a change");
        assert!(collection.dropped().is_empty());
        for _ in 0..3 {
            collection.undo().expect("a change");
        }
        assert_eq!(collection.undo(), Err(CollectError::NothingToUndo));
    }

    #[test]
    fn what_came_back_is_what_was_solved() {
        let mut collection = three();
        let solved = collection.revision();
        let name = names(&collection)[1].to_owned();
        collection.drop_pair(&name).expect("it is there");
        let without = collection.revision();
        assert_ne!(without, solved);
        collection.restore_pair(&name).expect("it is there");
        assert_eq!(collection.revision(), solved);
        collection.drop_pair(&name).expect("it is there");
        assert_eq!(collection.revision(), without);
        // Another one is another content.
        collection.restore_pair(&name).expect("it is there");
        let other = names(&collection)[0].to_owned();
        collection.drop_pair(&other).expect("it is there");
        assert!(![solved, without].contains(&collection.revision()));
    }

    #[test]
    fn another_board_empties_the_collection_and_undo_brings_both_back() {
        let mut collection = three();
        let board = *collection.board();
        collection.set_board(Chessboard { square_m: 0.02, ..board });
        assert_eq!(names(&collection).len(), 3, "the same corners at another scale stay");
        collection.set_board(Chessboard { inner_columns: 9, ..board });
        assert!(names(&collection).is_empty());
        collection.undo().expect("a change");
        collection.undo().expect("a change");
        assert_eq!((collection.board(), names(&collection).len()), (&board, 3));
    }

    #[test]
    fn what_does_not_belong_is_refused_and_changes_nothing() {
        let mut collection = three();
        assert_eq!(collection.add(pair("b"), SIZES), Err(CollectError::Twice("b".into())));
        let other = [(640, 480), (1280, 800)];
        let refused = collection.add(pair("d"), other).expect_err("other size");
        assert!(refused.to_string().contains("1280×800"), "{refused}");
        assert_eq!(collection.delete("x"), Err(CollectError::NoSuchPair("x".into())));
        assert_eq!(names(&collection), ["a", "b", "c"]);
        collection.delete_all().expect("not empty");
        collection.add(pair("d"), other).expect("an empty collection takes any size");
    }

    #[test]
    fn a_recording_is_one_change_and_leaves_out_what_is_there() {
        let mut collection = three();
        let added = collection.add_all(vec![pair("b"), pair("d"), pair("e")], SIZES);
        assert_eq!(added, Ok(2));
        assert_eq!(names(&collection), ["a", "b", "c", "d", "e"]);
        collection.undo().expect("a change");
        assert_eq!(names(&collection), ["a", "b", "c"]);
    }
}
