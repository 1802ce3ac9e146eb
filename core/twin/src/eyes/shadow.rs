//! Where the lamp looks from: the frame of the shadow map and which items each of its tiles can meet.

use nalgebra::{Matrix3, Vector3};

use super::pack::Bound;
use super::tiles::{append_list, half_sides};

/// Texels of a side of the map.
pub(super) const SIDE: usize = 512;
const TILE: usize = 16;
const TILES: usize = SIDE / TILE;
/// Numbers of a header.
pub(super) const HEADER: usize = 8;
/// Items larger than this throw no shadow (table, walls), meters.
const LARGEST_CASTER_M: f64 = 0.3;

/// The map's frame and lists.
pub(super) struct Shadow {
    /// Rows that take the robot frame to texels (x, y) and meters along the light (z).
    pub light_from_robot: [[f32; 4]; 3],
    /// Toward the lamp.
    pub to_lamp: Vector3<f64>,
    /// Side of a texel, meters.
    pub texel_m: f32,
    /// Headers of 8 numbers (place x + 1024 y, seven places of the list), then the lists.
    pub data: Vec<u32>,
    /// Number of tiles that can meet something.
    pub tiles: usize,
}

/// Frames the map around everything that throws a shadow.
pub(super) fn shadow(toward: &Vector3<f64>, bounds: &[Bound]) -> Shadow {
    let z = if toward.norm() > 1e-9 { toward.normalize() } else { -Vector3::z() };
    let x = z.cross(&if z.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() }).normalize();
    let axes = Matrix3::from_rows(&[x.transpose(), z.cross(&x).transpose(), z.transpose()]);
    let mut casters: Vec<usize> =
        (0..bounds.len()).filter(|&i| bounds[i].radius_m < LARGEST_CASTER_M).collect();
    casters.sort_by_key(|&i| bounds[i].kind);
    // Extent of each caster along the light's axes.
    let boxes: Vec<(Vector3<f64>, Vector3<f64>)> = casters
        .iter()
        .map(|&i| {
            let center = axes * bounds[i].center.coords;
            let half = half_sides(&bounds[i]).iter().map(|s| (axes * s).abs()).sum::<Vector3<f64>>();
            (center - half, center + half)
        })
        .collect();
    let (low, high) = boxes
        .iter()
        .fold(None, |all: Option<(Vector3<f64>, Vector3<f64>)>, (l, h)| {
            Some(all.map_or((*l, *h), |(low, high)| (low.inf(l), high.sup(h))))
        })
        .unwrap_or((Vector3::repeat(-0.5), Vector3::repeat(0.5)));
    // Two tiles of margin, so that taps at the edge stay on the map.
    let texel_m = ((high - low).xy().max() / (SIDE - 2 * TILE) as f64).max(1e-4);
    let shift = Vector3::repeat(0.5 * SIDE as f64) - 0.5 * (low + high) / texel_m;
    let row = |r: usize, scale: f64, offset: f64| {
        let a = axes.row(r) * scale;
        [a[0] as f32, a[1] as f32, a[2] as f32, offset as f32]
    };
    let light_from_robot =
        [row(0, 1.0 / texel_m, shift.x), row(1, 1.0 / texel_m, shift.y), row(2, 1.0, 0.05 - low.z)];
    let (data, tiles) = lists(&casters, &boxes, texel_m, &shift, bounds);
    Shadow { light_from_robot, to_lamp: -z, texel_m: texel_m as f32, data, tiles }
}

fn lists(
    casters: &[usize],
    boxes: &[(Vector3<f64>, Vector3<f64>)],
    texel_m: f64,
    shift: &Vector3<f64>,
    bounds: &[Bound],
) -> (Vec<u32>, usize) {
    let mut found: Vec<Vec<u32>> = vec![Vec::new(); TILES * TILES];
    for (&item, (low, high)) in casters.iter().zip(boxes) {
        let tile = |value: f64, shift: f64, more: f64| {
            (((value / texel_m + shift + more) / TILE as f64).floor().max(0.0) as usize).min(TILES - 1)
        };
        for y in tile(low.y, shift.y, -1.0)..=tile(high.y, shift.y, 1.0) {
            for x in tile(low.x, shift.x, -1.0)..=tile(high.x, shift.x, 1.0) {
                found[y * TILES + x].push(item as u32);
            }
        }
    }
    let full: Vec<usize> = (0..found.len()).filter(|&t| !found[t].is_empty()).collect();
    let mut data = vec![0; full.len() * HEADER];
    for (index, &t) in full.iter().enumerate() {
        data[index * HEADER] = (t % TILES + ((t / TILES) << 10)) as u32;
        append_list(&mut data, index * HEADER + 1, &found[t], bounds);
    }
    (data, full.len())
}
