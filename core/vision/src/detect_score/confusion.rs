//! What is taken for what, with the images and boxes behind every number.

use plumbline_model::ClassIndex;

use super::ScoredImage;

/// Which boxes are looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConfusionOptions {
    /// Boxes from this confidence on.
    pub confidence: f64,
    /// A box is a thing if they overlap by more than this.
    pub iou: f64,
}

impl Default for ConfusionOptions {
    /// 0.25 and 0.45, as usual.
    fn default() -> Self {
        Self { confidence: 0.25, iou: 0.45 }
    }
}

/// A place in the matrix: what is there, and what it is taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// Row: the class of the thing; `None`: nothing is there.
    pub truth: Option<ClassIndex>,
    /// Column: the class of the box; `None`: missed.
    pub found: Option<ClassIndex>,
}

/// One thing, one box, or a thing and its box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellEntry {
    /// Number of the image.
    pub image: usize,
    /// Number of the thing in the image's truth.
    pub truth: Option<usize>,
    /// Number of the box in what was found on the image.
    pub found: Option<usize>,
}

/// What is taken for what. Things in crowds are not in it.
#[derive(Clone, Debug, PartialEq)]
pub struct ConfusionMatrix {
    classes: usize,
    cells: Vec<Vec<CellEntry>>,
}

impl ConfusionMatrix {
    /// Sorts things and boxes into cells. A thing goes with the box that it overlaps most,
    /// whatever the classes; of equal overlaps with the surer one. Where a detector gives one and
    /// the same box to several classes, only the surest counts, as on the screen.
    pub fn new(images: &[ScoredImage], classes: usize, options: &ConfusionOptions) -> Self {
        let mut matrix = Self { classes, cells: vec![Vec::new(); (classes + 1) * (classes + 1)] };
        for (index, image) in images.iter().enumerate() {
            matrix.add(index, image, options);
        }
        matrix
    }

    /// How many classes it has; there is one row and one column more.
    pub fn classes(&self) -> usize {
        self.classes
    }

    /// What is in a cell; nothing for classes that are not in the matrix.
    pub fn entries(&self, cell: Cell) -> &[CellEntry] {
        self.place(cell).map_or(&[], |place| &self.cells[place])
    }

    /// How much is in a cell.
    pub fn count(&self, cell: Cell) -> usize {
        self.entries(cell).len()
    }

    /// The rows from the first class to "nothing there", and the columns to "missed".
    pub fn lines(&self) -> impl Iterator<Item = Option<ClassIndex>> + use<> {
        (0..self.classes).map(|class| Some(ClassIndex(class))).chain([None])
    }

    fn place(&self, cell: Cell) -> Option<usize> {
        let line = |class: Option<ClassIndex>| {
            class.map_or(Some(self.classes), |class| (class.0 < self.classes).then_some(class.0))
        };
        Some(line(cell.truth)? * (self.classes + 1) + line(cell.found)?)
    }

    fn add(&mut self, index: usize, image: &ScoredImage, options: &ConfusionOptions) {
        let things: Vec<usize> = (0..image.truth.len()).filter(|&i| !image.truth[i].crowd).collect();
        let boxes = image.surest_classes(options.confidence);
        let mut couples: Vec<(f64, usize, usize)> = Vec::new();
        for &thing in &things {
            for &found in &boxes {
                let iou = image.truth[thing].area.iou(&image.found[found].area);
                if iou > options.iou {
                    couples.push((iou, thing, found));
                }
            }
        }
        let sure = |found: usize| image.found[found].confidence;
        couples.sort_by(|a, b| b.0.total_cmp(&a.0).then(sure(b.2).total_cmp(&sure(a.2))));
        let (mut thing_taken, mut box_taken) =
            (vec![false; image.truth.len()], vec![false; image.found.len()]);
        for (_, thing, found) in couples {
            if !thing_taken[thing] && !box_taken[found] {
                (thing_taken[thing], box_taken[found]) = (true, true);
                self.put(index, image, Some(thing), Some(found));
            }
        }
        for thing in things.into_iter().filter(|&thing| !thing_taken[thing]) {
            self.put(index, image, Some(thing), None);
        }
        // A box inside a crowd is neither right nor wrong.
        let in_crowd = |found: usize| {
            let mut crowds = image.truth.iter().filter(|truth| truth.crowd);
            crowds.any(|crowd| image.found[found].area.part_in(&crowd.area) > options.iou)
        };
        for found in boxes.into_iter().filter(|&found| !box_taken[found] && !in_crowd(found)) {
            self.put(index, image, None, Some(found));
        }
    }

    fn put(&mut self, index: usize, image: &ScoredImage, truth: Option<usize>, found: Option<usize>) {
        let cell = Cell {
            truth: truth.map(|thing| image.truth[thing].class),
            found: found.map(|found| image.found[found].class),
        };
        if let Some(place) = self.place(cell) {
            self.cells[place].push(CellEntry { image: index, truth, found });
        }
    }
}

impl ScoredImage {
    /// Boxes from a confidence on, without those that are a surer one's with another class.
    fn surest_classes(&self, confidence: f64) -> Vec<usize> {
        let mut sure: Vec<usize> =
            (0..self.found.len()).filter(|&i| self.found[i].confidence >= confidence).collect();
        sure.sort_by(|&a, &b| self.found[b].confidence.total_cmp(&self.found[a].confidence));
        let mut boxes: Vec<usize> = Vec::with_capacity(sure.len());
        for found in sure {
            let other = |&surer: &usize| {
                let (surer, found) = (&self.found[surer], &self.found[found]);
                surer.area == found.area && surer.class != found.class
            };
            if !boxes.iter().any(other) {
                boxes.push(found);
            }
        }
        boxes
    }
}
