//! In which order targets are touched.

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
            touches.extend(block.iter().map(|&(target, side)| PlannedTouch {
                number: 0,
                target: targets[target].pixel,
                set: targets[target].set.clone(),
                group: group(target, side, screen_height_m, payload_kg),
                side,
                screen_height_m,
                payload_kg,
            }));
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
    let mut pass_of: Vec<Vec<usize>> = vec![vec![]; passes];
    let mut dealt = 0;
    for target in tour(&(0..targets.len()).collect::<Vec<_>>(), targets, screen) {
        let count = times(target);
        for k in 0..count {
            // Evenly over the run; the first pass rotates from target to target.
            pass_of[(dealt + k * passes / count) % passes].push(target);
        }
        dealt += if count < passes { 1 } else { 0 };
    }
    let mut order: Vec<(usize, Side)> = vec![];
    for (i, members) in pass_of.iter().enumerate() {
        let mut way = tour(members, targets, screen);
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

/// A short way through targets: nearest neighbor from the far left corner, then sections are
/// turned around while that shortens it (2-opt).
fn tour(members: &[usize], targets: &[Target], screen: &Touchscreen) -> Vec<usize> {
    let [u_m, v_m] = screen.pitch_m();
    let at = |i: usize| (targets[i].pixel.u_px * u_m, targets[i].pixel.v_px * v_m);
    let apart = |a: usize, b: usize| (at(a).0 - at(b).0).hypot(at(a).1 - at(b).1);
    let mut left = members.to_vec();
    let corner = |&i: &usize| at(i).0 + at(i).1;
    let Some(first) = (0..left.len()).min_by(|&a, &b| corner(&left[a]).total_cmp(&corner(&left[b]))) else {
        return left;
    };
    let mut way = vec![left.swap_remove(first)];
    while let Some(&here) = way.last() {
        let next = (0..left.len()).min_by(|&a, &b| apart(here, left[a]).total_cmp(&apart(here, left[b])));
        let Some(next) = next else { break };
        way.push(left.swap_remove(next));
    }
    shorten(&mut way, &apart);
    way
}

/// Turns sections of a way around while that shortens it; its first place stays. A few rounds
/// are enough, and bound the time for the largest plans.
fn shorten(way: &mut [usize], apart: &dyn Fn(usize, usize) -> f64) {
    for _ in 0..20 {
        let mut shorter = false;
        for i in 1..way.len().saturating_sub(1) {
            for j in i + 1..way.len() {
                let before =
                    apart(way[i - 1], way[i]) + way.get(j + 1).map_or(0.0, |&next| apart(way[j], next));
                let after =
                    apart(way[i - 1], way[j]) + way.get(j + 1).map_or(0.0, |&next| apart(way[i], next));
                if after < before - 1e-9 {
                    way[i..=j].reverse();
                    shorter = true;
                }
            }
        }
        if !shorter {
            return;
        }
    }
}
