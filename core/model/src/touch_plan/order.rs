//! In which order targets are touched.

use nalgebra::Vector2;

use super::pattern::Target;
use super::{PlanOptions, PlannedTouch, Side};
use crate::session::Touchscreen;

/// All touches, block after block of one screen height and one weight.
pub(super) fn touches(options: &PlanOptions, targets: &[Target], screen: &Touchscreen) -> Vec<PlannedTouch> {
    let block = block(options, targets, screen);
    let mut touches = vec![];
    for (i, &screen_height_m) in options.screen_heights_m.iter().enumerate() {
        // Every other time backward, so that the weight stays while the height changes.
        let mut payloads = options.payloads_kg.clone();
        if i % 2 == 1 {
            payloads.reverse();
        }
        for payload_kg in payloads {
            for &(target, side) in &block {
                let corrected = PlannedTouch {
                    number: 0,
                    target: targets[target].pixel,
                    set: targets[target].set.clone(),
                    group: group(target, side, screen_height_m, payload_kg),
                    side,
                    screen_height_m,
                    payload_kg,
                    as_described: false,
                };
                if options.beside_described {
                    // Another command: no repeat of the other.
                    let group = format!("{}-described", corrected.group);
                    touches.push(PlannedTouch { group, as_described: true, ..corrected.clone() });
                }
                touches.push(corrected);
            }
        }
    }
    for (i, touch) in touches.iter_mut().enumerate() {
        touch.number = i + 1;
    }
    touches
}

/// "t012-left", with "-h60mm" on a block and "-w250g" with a weight.
fn group(target: usize, side: Side, screen_height_m: f64, payload_kg: f64) -> String {
    let mut name = format!("t{:03}-{}", target + 1, side.name());
    if screen_height_m > 0.0 {
        name += &format!("-h{}mm", thousandths(screen_height_m));
    }
    if payload_kg > 0.0 {
        name += &format!("-w{}g", thousandths(payload_kg));
    }
    name
}

/// In thousandths, with only the digits that it has.
fn thousandths(value: f64) -> f64 {
    (value * 1e6).round() / 1e3
}

/// Touches of one block as (target, side). The block is walked through in as many passes as the
/// most frequent target has touches; the others are dealt to the passes so that each covers the
/// whole area. Within a pass all touches from one side come first, then those from the other.
fn block(options: &PlanOptions, targets: &[Target], screen: &Touchscreen) -> Vec<(usize, Side)> {
    let times = |target: usize| targets[target].times * options.repeats;
    let passes = (0..targets.len()).map(times).max().unwrap_or_default();
    let [u_m, v_m] = screen.pitch_m();
    let place = |target: &Target| Vector2::new(target.pixel.u_px * u_m, target.pixel.v_px * v_m);
    let places: Vec<Vector2<f64>> = targets.iter().map(place).collect();
    let mut pass_of: Vec<Vec<usize>> = vec![vec![]; passes];
    let mut dealt = 0;
    for target in tour(&(0..targets.len()).collect::<Vec<_>>(), &places) {
        let count = times(target);
        for k in 0..count {
            // Evenly over the run; the first pass rotates from target to target.
            pass_of[(dealt + k * passes / count) % passes].push(target);
        }
        dealt += if count < passes { 1 } else { 0 };
    }
    let mut order: Vec<(usize, Side)> = vec![];
    for (i, members) in pass_of.iter().enumerate() {
        let mut way = tour(members, &places);
        for (k, &side) in options.sides.all().iter().enumerate() {
            if (i + k) % 2 == 1 {
                way.reverse();
            }
            // A repeat must not follow itself where two passes meet.
            let repeats = order.last().is_some_and(|last| way.first() == Some(&last.0));
            if repeats && way.len() > 1 {
                way.rotate_left(1);
            }
            order.extend(way.iter().map(|&target| (target, side)));
        }
    }
    order
}

/// Neighbors that are tried when a way is shortened.
const NEIGHBORS: usize = 10;
/// Rounds of shortening; way after way, the first few bring nearly all.
const ROUNDS: usize = 20;

/// A short way through places (m): nearest neighbor from the far left corner, then sections are
/// turned around while that shortens it (2-opt among near neighbors). `members` are positions in
/// `places`.
fn tour(members: &[usize], places: &[Vector2<f64>]) -> Vec<usize> {
    let mut left = members.to_vec();
    let mut way = vec![];
    // The corner itself is not touched: the place nearest to it comes first.
    let corner = left.iter().fold(Vector2::repeat(f64::INFINITY), |least, &i| least.inf(&places[i]));
    let mut here = corner;
    let apart = |here: &Vector2<f64>, i: usize| (places[i] - here).norm_squared();
    while let Some(next) =
        (0..left.len()).min_by(|&a, &b| apart(&here, left[a]).total_cmp(&apart(&here, left[b])))
    {
        let target = left.swap_remove(next);
        here = places[target];
        way.push(target);
    }
    shorten(&mut way, places);
    way
}

/// Turns sections of a way around while that shortens it; its first place stays.
fn shorten(way: &mut [usize], places: &[Vector2<f64>]) {
    let apart = |a: usize, b: usize| (places[a] - places[b]).norm();
    let near = neighbors(way, places);
    let mut position = vec![0; places.len()];
    way.iter().enumerate().for_each(|(at, &place)| position[place] = at);
    for _ in 0..ROUNDS {
        let mut shorter = false;
        for i in 1..way.len() {
            let (from, to) = (way[i - 1], way[i]);
            let step = apart(from, to);
            // Replaces from→to and other→beyond by from→other and to→beyond.
            let better = near[from].iter().map(|&other| position[other]).find(|&j| {
                let gained = step - apart(from, way[j]);
                j > i
                    && gained
                        > way.get(j + 1).map_or(0.0, |&beyond| apart(to, beyond) - apart(way[j], beyond))
                            + 1e-9
            });
            if let Some(j) = better {
                way[i..=j].reverse();
                (i..=j).for_each(|at| position[way[at]] = at);
                shorter = true;
            }
        }
        if !shorter {
            return;
        }
    }
}

/// The nearest others of each member, by its position in `places`; empty for those that are none.
fn neighbors(members: &[usize], places: &[Vector2<f64>]) -> Vec<Vec<usize>> {
    let mut near = vec![vec![]; places.len()];
    for &member in members {
        let apart = |&other: &usize| (places[other] - places[member]).norm_squared();
        let nearer = |a: &usize, b: &usize| apart(a).total_cmp(&apart(b));
        let mut others: Vec<usize> = members.iter().copied().filter(|&other| other != member).collect();
        if others.len() > NEIGHBORS {
            others.select_nth_unstable_by(NEIGHBORS, nearer);
            others.truncate(NEIGHBORS);
        }
        others.sort_by(nearer);
        near[member] = others;
    }
    near
}
