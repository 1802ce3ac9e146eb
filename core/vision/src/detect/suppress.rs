//! Non-maximum suppression: of boxes of one class that overlap, only the surest stays.
//!
//! Greedy, as introduced by Dalal and Triggs (2005) and used by every YOLO: by falling
//! confidence a box is kept if its intersection over union with every kept box of its class is
//! not above the threshold. The reference moves classes apart by adding 7680 px per class
//! before a suppression that knows no classes; here classes are compared directly, which is the
//! same but for the rounding of those large coordinates.

use plumbline_model::detection::ClassIndex;

/// No more boxes than these are looked at, the surest; as in the reference.
const MOST_CANDIDATES: usize = 30_000;

/// A box on the input of a network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Left, upper, right, lower edge, px of the input.
    pub edges: [f32; 4],
    /// 0–1.
    pub confidence: f32,
    /// What it is.
    pub class: ClassIndex,
    /// Which box of the head; of two equally sure ones the earlier comes first.
    pub number: usize,
}

/// Sorts by falling confidence.
pub fn surest_first(candidates: &mut [Candidate]) {
    candidates.sort_unstable_by(|a, b| {
        b.confidence.total_cmp(&a.confidence).then(a.number.cmp(&b.number)).then(a.class.cmp(&b.class))
    });
}

/// Leaves those that are kept, at most `most`, the surest first. Allocates nothing.
pub fn suppress(candidates: &mut Vec<Candidate>, iou: f32, most: usize) {
    surest_first(candidates);
    candidates.truncate(MOST_CANDIDATES);
    let mut kept = 0;
    for at in 0..candidates.len() {
        if kept == most {
            break;
        }
        let candidate = candidates[at];
        let seen = candidates[..kept]
            .iter()
            .any(|other| other.class == candidate.class && overlap(&other.edges, &candidate.edges) > iou);
        if !seen {
            candidates[kept] = candidate;
            kept += 1;
        }
    }
    candidates.truncate(kept);
}

/// Intersection over union; NaN for two boxes without extent, which is above no threshold.
fn overlap(a: &[f32; 4], b: &[f32; 4]) -> f32 {
    let area = |edges: &[f32; 4]| (edges[2] - edges[0]) * (edges[3] - edges[1]);
    let width = (a[2].min(b[2]) - a[0].max(b[0])).max(0.0);
    let height = (a[3].min(b[3]) - a[1].max(b[1])).max(0.0);
    let common = width * height;
    common / (area(a) + area(b) - common)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(number: usize, class: usize, confidence: f32, edges: [f32; 4]) -> Candidate {
        Candidate { edges, confidence, class: ClassIndex(class), number }
    }

    fn kept(mut candidates: Vec<Candidate>, iou: f32, most: usize) -> Vec<usize> {
        suppress(&mut candidates, iou, most);
        candidates.iter().map(|candidate| candidate.number).collect()
    }

    #[test]
    fn of_one_thing_seen_twice_the_surer_stays() {
        let boxes = vec![
            candidate(0, 0, 0.5, [0.0, 0.0, 10.0, 10.0]),
            candidate(1, 0, 0.9, [1.0, 0.0, 11.0, 10.0]),
            candidate(2, 1, 0.4, [0.0, 0.0, 10.0, 10.0]),
            candidate(3, 0, 0.3, [20.0, 0.0, 30.0, 10.0]),
        ];
        assert_eq!(kept(boxes.clone(), 0.5, 300), [1, 2, 3], "another class and another place stay");
        assert_eq!(kept(boxes.clone(), 0.9, 300), [1, 0, 2, 3], "9/11 is not above 0.9");
        assert_eq!(kept(boxes.clone(), 0.5, 2), [1, 2]);
        assert_eq!(kept(boxes, 0.5, 0), [0; 0]);
    }

    #[test]
    fn a_suppressed_box_suppresses_nothing() {
        let chain = (0..3).map(|i| {
            let x = 4.0 * i as f32;
            candidate(i, 0, 0.9 - 0.1 * i as f32, [x, 0.0, x + 10.0, 10.0])
        });
        assert_eq!(kept(chain.collect(), 0.3, 300), [0, 2]);
    }

    #[test]
    fn exactly_at_the_threshold_both_stay() {
        let boxes =
            vec![candidate(0, 0, 0.9, [0.0, 0.0, 2.0, 1.0]), candidate(1, 0, 0.8, [0.0, 0.0, 1.0, 1.0])];
        assert_eq!(kept(boxes, 0.5, 300), [0, 1]);
    }

    #[test]
    fn boxes_without_extent_do_no_harm() {
        let empty = candidate(0, 0, 0.9, [5.0; 4]);
        assert_eq!(kept(vec![empty, candidate(1, 0, 0.8, [5.0; 4])], 0.5, 300), [0, 1]);
    }

    #[test]
    fn equally_sure_boxes_keep_their_order() {
        let boxes = (0..50).map(|i| {
            let x = 20.0 * i as f32;
            candidate(i, 0, 0.5, [x, 0.0, x + 10.0, 10.0])
        });
        assert_eq!(kept(boxes.collect(), 0.5, 300), (0..50).collect::<Vec<_>>());
    }
}
