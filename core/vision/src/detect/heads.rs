//! Boxes from the output of a network.
//!
//! Raw heads are those of YOLOv8, YOLO11, YOLO12 and YOLOv3u as ultralytics exports them; the
//! end-to-end head is that of YOLO26 and of exports with `nms=True`.

use plumbline_model::detection::ClassIndex;

use super::suppress::Candidate;
use super::{DetectSettings, Head};

/// Why an output cannot be used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Unusable {
    /// So many values are no numbers.
    NotFinite(usize),
    /// There is no such class.
    UnknownClass(f32),
}

/// Reads heads; keeps what it needs between images.
#[derive(Default)]
pub(super) struct Reader {
    best: Vec<f32>,
    class: Vec<u32>,
}

impl Reader {
    /// Puts the boxes that count into `candidates`, which is cleared first. `values` are the
    /// numbers of an output of `head` for `classes` classes.
    pub fn read(
        &mut self,
        head: Head,
        classes: usize,
        values: &[f32],
        settings: &DetectSettings,
        candidates: &mut Vec<Candidate>,
    ) -> Result<(), Unusable> {
        candidates.clear();
        let wrong = not_finite(values);
        if wrong > 0 {
            return Err(Unusable::NotFinite(wrong));
        }
        match head {
            Head::EndToEnd => return end_to_end(classes, values, settings, candidates),
            Head::Raw if settings.several_classes_per_box => {
                let count = values.len() / (4 + classes);
                for (class, row) in values[4 * count..].chunks_exact(count.max(1)).enumerate() {
                    above(row.iter().copied(), class, settings, |i, confidence| {
                        candidates.push(raw(|k| values[k * count + i], i, class, confidence));
                    });
                }
            }
            Head::Raw => self.raw(classes, values, settings, candidates),
            Head::RawTransposed => transposed(classes, values, settings, candidates),
        }
        Ok(())
    }

    /// One class a box: the surest. Row by row, so that memory is read in order and the
    /// comparison runs in vectors.
    fn raw(&mut self, classes: usize, values: &[f32], settings: &DetectSettings, out: &mut Vec<Candidate>) {
        let count = values.len() / (4 + classes);
        if count == 0 {
            return;
        }
        self.best.resize(count, 0.0);
        self.class.resize(count, 0);
        let mut rows = values[4 * count..].chunks_exact(count);
        let Some(first) = rows.next() else { return };
        self.best.copy_from_slice(first);
        self.class.fill(0);
        for (class, row) in (1u32..).zip(rows) {
            for ((best, of), value) in self.best.iter_mut().zip(&mut self.class).zip(row) {
                let better = *value > *best;
                *best = if better { *value } else { *best };
                *of = if better { class } else { *of };
            }
        }
        let least = least(classes, settings);
        for (i, (confidence, class)) in self.best.iter().zip(&self.class).enumerate() {
            if *confidence > least {
                let class = *class as usize;
                if settings.threshold(ClassIndex(class)).is_some_and(|threshold| *confidence > threshold) {
                    out.push(raw(|k| values[k * count + i], i, class, *confidence));
                }
            }
        }
    }
}

/// The lowest threshold of any class.
fn least(classes: usize, settings: &DetectSettings) -> f32 {
    let own = settings.per_class_confidence.iter().take(classes).flatten().copied();
    own.fold(settings.confidence, f32::min)
}

/// Calls back for the values of a class that count.
fn above(
    values: impl Iterator<Item = f32>,
    class: usize,
    settings: &DetectSettings,
    mut found: impl FnMut(usize, f32),
) {
    let Some(threshold) = settings.threshold(ClassIndex(class)) else { return };
    for (i, confidence) in values.enumerate() {
        if confidence > threshold {
            found(i, confidence);
        }
    }
}

/// A box from middle and size.
fn raw(value: impl Fn(usize) -> f32, number: usize, class: usize, confidence: f32) -> Candidate {
    let (x, y, half_width, half_height) = (value(0), value(1), value(2) / 2.0, value(3) / 2.0);
    let edges = [x - half_width, y - half_height, x + half_width, y + half_height];
    Candidate { edges, confidence, class: ClassIndex(class), number }
}

fn transposed(classes: usize, values: &[f32], settings: &DetectSettings, out: &mut Vec<Candidate>) {
    for (i, row) in values.chunks_exact(4 + classes).enumerate() {
        let scores = &row[4..];
        if settings.several_classes_per_box {
            for (class, confidence) in scores.iter().enumerate() {
                if settings.threshold(ClassIndex(class)).is_some_and(|threshold| *confidence > threshold) {
                    out.push(raw(|k| row[k], i, class, *confidence));
                }
            }
            continue;
        }
        let mut best = (0, f32::NEG_INFINITY);
        for (class, confidence) in scores.iter().enumerate() {
            if *confidence > best.1 {
                best = (class, *confidence);
            }
        }
        if settings.threshold(ClassIndex(best.0)).is_some_and(|threshold| best.1 > threshold) {
            out.push(raw(|k| row[k], i, best.0, best.1));
        }
    }
}

fn end_to_end(
    classes: usize,
    values: &[f32],
    settings: &DetectSettings,
    out: &mut Vec<Candidate>,
) -> Result<(), Unusable> {
    let least = least(classes, settings);
    for (number, row) in values.chunks_exact(6).enumerate() {
        let (confidence, class) = (row[4], row[5]);
        if !(confidence > least) {
            continue;
        }
        if class.fract() != 0.0 || !(0.0..classes as f32).contains(&class) {
            return Err(Unusable::UnknownClass(class));
        }
        let class = ClassIndex(class as usize);
        if settings.threshold(class).is_some_and(|threshold| confidence > threshold) {
            out.push(Candidate { edges: [row[0], row[1], row[2], row[3]], confidence, class, number });
        }
    }
    Ok(())
}

/// How many are infinite or no numbers: those with all bits of the exponent set.
fn not_finite(values: &[f32]) -> usize {
    const EXPONENT: u32 = 0x7f80_0000;
    // Short counts stay in vectors.
    let count = |part: &[f32]| -> u32 {
        part.iter().map(|value| u32::from(value.to_bits() & EXPONENT == EXPONENT)).sum()
    };
    values.chunks(1 << 16).map(|part| count(part) as usize).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three boxes, two classes, as a raw head.
    const RAW: [f32; 18] = [
        10.0, 50.0, 90.0, // middle x
        20.0, 60.0, 80.0, // middle y
        4.0, 8.0, 2.0, // width
        6.0, 8.0, 2.0, // height
        0.9, 0.3, 0.1, // first class
        0.2, 0.6, 0.1, // second class
    ];

    fn read(head: Head, values: &[f32], settings: &DetectSettings) -> Result<Vec<Candidate>, Unusable> {
        let mut candidates = Vec::new();
        Reader::default().read(head, 2, values, settings, &mut candidates)?;
        Ok(candidates)
    }

    fn transpose(values: &[f32], columns: usize) -> Vec<f32> {
        (0..columns).flat_map(|i| values.iter().skip(i).step_by(columns).copied()).collect()
    }

    #[test]
    fn the_surest_class_of_each_box_is_read_either_way_round() {
        let settings = DetectSettings::default();
        let found = read(Head::Raw, &RAW, &settings).expect("numbers");
        let expected = [
            Candidate { edges: [8.0, 17.0, 12.0, 23.0], confidence: 0.9, class: ClassIndex(0), number: 0 },
            Candidate { edges: [46.0, 56.0, 54.0, 64.0], confidence: 0.6, class: ClassIndex(1), number: 1 },
        ];
        assert_eq!(found, expected);
        assert_eq!(read(Head::RawTransposed, &transpose(&RAW, 3), &settings).expect("numbers"), expected);
    }

    #[test]
    fn several_classes_of_a_box_are_read_if_asked_for() {
        let settings =
            DetectSettings { confidence: 0.15, several_classes_per_box: true, ..DetectSettings::default() };
        let order = |candidate: &Candidate| (candidate.class.0, candidate.number);
        let mut found = read(Head::Raw, &RAW, &settings).expect("numbers");
        let mut other = read(Head::RawTransposed, &transpose(&RAW, 3), &settings).expect("numbers");
        found.sort_unstable_by_key(order);
        other.sort_unstable_by_key(order);
        assert_eq!(found.iter().map(order).collect::<Vec<_>>(), [(0, 0), (0, 1), (1, 0), (1, 1)]);
        assert_eq!(found, other);
    }

    #[test]
    fn end_to_end_rows_are_taken_as_they_are() {
        let rows = [1.0, 2.0, 3.0, 4.0, 0.8, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let found = read(Head::EndToEnd, &rows, &DetectSettings::default()).expect("numbers");
        let expected =
            Candidate { edges: [1.0, 2.0, 3.0, 4.0], confidence: 0.8, class: ClassIndex(1), number: 0 };
        assert_eq!(found, [expected]);
        let alien = [1.0, 2.0, 3.0, 4.0, 0.8, 2.0];
        assert_eq!(
            read(Head::EndToEnd, &alien, &DetectSettings::default()),
            Err(Unusable::UnknownClass(2.0))
        );
        let between = [1.0, 2.0, 3.0, 4.0, 0.8, 0.5];
        assert_eq!(
            read(Head::EndToEnd, &between, &DetectSettings::default()),
            Err(Unusable::UnknownClass(0.5))
        );
    }

    #[test]
    fn a_class_with_a_lower_threshold_of_its_own_is_found() {
        let mut settings = DetectSettings { confidence: 0.7, ..DetectSettings::default() };
        settings.per_class_confidence = vec![None, Some(0.5)];
        for (head, values) in [(Head::Raw, RAW.to_vec()), (Head::RawTransposed, transpose(&RAW, 3))] {
            let found = read(head, &values, &settings).expect("numbers");
            assert_eq!(found.iter().map(|c| c.number).collect::<Vec<_>>(), [0, 1], "{head}");
        }
    }

    #[test]
    fn what_is_no_number_is_not_overlooked() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let mut values = RAW;
            values[17] = bad;
            assert_eq!(read(Head::Raw, &values, &DetectSettings::default()), Err(Unusable::NotFinite(1)));
        }
    }
}
