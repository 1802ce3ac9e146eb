// Shared by all kernels: the scene as it was packed, rays, and where rays meet shapes.
//
// Rays come in fours (one component of every vec4 each), so that what is fetched for a shape is
// used four times. All lengths in meters, in the robot frame unless said otherwise.

struct Eye {
    // Rows of the rotation; w is the place of the eye.
    robot_from_eye: array<vec4<f32>, 3>,
    // fx, fy, cx, cy in pixels.
    lens: vec4<f32>,
    // k1..k4.
    k: vec4<f32>,
    // Skew in pixels, largest theta (rad) and theta_d of the lens, pixel radius in rad.
    more: vec4<f32>,
}

struct Frame {
    eyes: array<Eye, 2>,
    // Robot frame to texels of the shadow map (x, y) and meters along the light (z).
    light_from_robot: array<vec4<f32>, 3>,
    // Direction to the lamp, its strength.
    to_lamp: vec4<f32>,
    // Light from everywhere, meters per shadow texel, texels of the shadow map, background.
    light: vec4<f32>,
    // Width and height of the images.
    size: vec4<f32>,
    // Exposure of red, green, blue.
    exposure: vec4<f32>,
}

struct Geometry {
    // Rows of shape_from_robot.
    row0: vec4<f32>,
    row1: vec4<f32>,
    row2: vec4<f32>,
    // Sizes; their meaning depends on the shape.
    dims: vec4<f32>,
}

struct Material {
    // Reflectance of red, green, blue; share of light mirrored.
    albedo: vec4<f32>,
    // Kind (0 plain, 1 speckle, 2 folds), size in meters, contrast, 0.
    pattern: vec4<f32>,
    // Kind of the shape, number of the object, 0, 0.
    what: vec4<f32>,
}

const MOST_ITEMS = 768u;
const BOX = 0u;
const ELLIPSOID = 1u;
const CAPSULE = 2u;
const CYLINDER = 3u;
const BOARD = 4u;
const MESH = 5u;

const NOWHERE = 1e9;
const NO_ITEM = 0xffffu;
const NEAREST_M = 1e-4;
const FAR = 50.0;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> geometries: array<Geometry, MOST_ITEMS>;
@group(0) @binding(2) var<uniform> materials: array<Material, MOST_ITEMS>;
// Headers and item lists of tiles, see `tiles.rs`.
@group(0) @binding(3) var<storage, read> tiles: array<u32>;
// Trees and triangles of meshes, see `mesh_tree.rs`.
@group(0) @binding(4) var<storage, read> meshes: array<vec4<f32>>;

// Whether the tiles of this dispatch hold meshes at all: a shader on a CPU runs through all its
// branches, taken or not.
override HAS_MESH: bool = false;
override HAS_ROUND: bool = false;
override HAS_BOARD: bool = false;

struct Rays {
    ox: vec4<f32>, oy: vec4<f32>, oz: vec4<f32>,
    dx: vec4<f32>, dy: vec4<f32>, dz: vec4<f32>,
}

struct Hits {
    // Distance along the ray, meters.
    range: vec4<f32>,
    item: vec4<u32>,
    // Triangle of a mesh.
    triangle: vec4<u32>,
}

fn no_hits() -> Hits {
    return Hits(vec4<f32>(NOWHERE), vec4<u32>(NO_ITEM), vec4<u32>(0u));
}

fn into_shape(g: Geometry, r: Rays) -> Rays {
    return Rays(
        g.row0.x * r.ox + g.row0.y * r.oy + g.row0.z * r.oz + g.row0.w,
        g.row1.x * r.ox + g.row1.y * r.oy + g.row1.z * r.oz + g.row1.w,
        g.row2.x * r.ox + g.row2.y * r.oy + g.row2.z * r.oz + g.row2.w,
        g.row0.x * r.dx + g.row0.y * r.dy + g.row0.z * r.dz,
        g.row1.x * r.dx + g.row1.y * r.dy + g.row1.z * r.dz,
        g.row2.x * r.dx + g.row2.y * r.dy + g.row2.z * r.dz,
    );
}

// Where a pixel lies on the lens: direction from the axis (x, y) and distance theta_d from it.
fn on_lens(eye: u32, pixel: vec2<f32>) -> vec3<f32> {
    let lens = frame.eyes[eye].lens;
    let y = (pixel.y - lens.w) / lens.y;
    let x = (pixel.x - lens.z - frame.eyes[eye].more.x * y) / lens.x;
    return vec3<f32>(x, y, max(sqrt(x * x + y * y), 1e-7));
}

// One step of Newton's method toward the angle theta off the axis that the lens of Kannala and Brandt
// maps to theta_d.
fn toward_theta(k: vec4<f32>, theta: f32, theta_d: f32) -> f32 {
    let t2 = theta * theta;
    let value = theta * (1.0 + t2 * (k.x + t2 * (k.y + t2 * (k.z + t2 * k.w))));
    let slope = 1.0 + t2 * (3.0 * k.x + t2 * (5.0 * k.y + t2 * (7.0 * k.z + t2 * 9.0 * k.w)));
    return clamp(theta - (value - theta_d) / max(slope, 0.05), 0.0, 3.0);
}

// Angle off the axis of a pixel.
fn theta_of(eye: u32, pixel: vec2<f32>) -> f32 {
    let at = on_lens(eye, pixel);
    let k = frame.eyes[eye].k;
    var theta = min(at.z, frame.eyes[eye].more.y);
    for (var i = 0; i < 5; i++) {
        theta = toward_theta(k, theta, at.z);
    }
    return theta;
}

// Direction in the eye's frame of a pixel, given the angle off the axis of one at most a pixel away.
fn unproject(eye: u32, pixel: vec2<f32>, nearby: f32) -> vec3<f32> {
    let at = on_lens(eye, pixel);
    let k = frame.eyes[eye].k;
    let theta = toward_theta(k, toward_theta(k, nearby, at.z), at.z);
    let s = sin(theta) / at.z;
    return vec3<f32>(at.x * s, at.y * s, cos(theta));
}

fn turn(rows: array<vec4<f32>, 3>, v: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(dot(rows[0].xyz, v), dot(rows[1].xyz, v), dot(rows[2].xyz, v));
}

fn dot3(ax: vec4<f32>, ay: vec4<f32>, az: vec4<f32>, bx: vec4<f32>, by: vec4<f32>, bz: vec4<f32>) -> vec4<f32> {
    return ax * bx + ay * by + az * bz;
}

// A box is seen from inside too (a room).
fn meet_box(r: Rays, half: vec3<f32>) -> vec4<f32> {
    let ix = 1.0 / r.dx;
    let iy = 1.0 / r.dy;
    let iz = 1.0 / r.dz;
    let ax = (-half.x - r.ox) * ix;
    let bx = (half.x - r.ox) * ix;
    let ay = (-half.y - r.oy) * iy;
    let by = (half.y - r.oy) * iy;
    let az = (-half.z - r.oz) * iz;
    let bz = (half.z - r.oz) * iz;
    let near = max(max(min(ax, bx), min(ay, by)), min(az, bz));
    let far = min(min(max(ax, bx), max(ay, by)), max(az, bz));
    let range = select(far, near, near > vec4<f32>(NEAREST_M));
    return select(vec4<f32>(NOWHERE), range, (near <= far) & (range > vec4<f32>(NEAREST_M)));
}

fn meet_ellipsoid(r: Rays, radii: vec3<f32>) -> vec4<f32> {
    let inverse = 1.0 / radii;
    let ox = r.ox * inverse.x;
    let oy = r.oy * inverse.y;
    let oz = r.oz * inverse.z;
    let dx = r.dx * inverse.x;
    let dy = r.dy * inverse.y;
    let dz = r.dz * inverse.z;
    let a = dot3(dx, dy, dz, dx, dy, dz);
    let closest = -dot3(ox, oy, oz, dx, dy, dz) / a;
    // The point of the ray nearest to the center: precise even for a small ball far away.
    let px = ox + closest * dx;
    let py = oy + closest * dy;
    let pz = oz + closest * dz;
    let inside = 1.0 - dot3(px, py, pz, px, py, pz);
    let range = closest - sqrt(max(inside, vec4<f32>(0.0)) / a);
    return select(vec4<f32>(NOWHERE), range, (inside > vec4<f32>(0.0)) & (range > vec4<f32>(NEAREST_M)));
}

fn meet_capsule(r: Rays, radius: f32, half: f32) -> vec4<f32> {
    let a = max(r.dx * r.dx + r.dy * r.dy, vec4<f32>(1e-12));
    let closest = -(r.ox * r.dx + r.oy * r.dy) / a;
    let px = r.ox + closest * r.dx;
    let py = r.oy + closest * r.dy;
    let inside = radius * radius - (px * px + py * py);
    let side = closest - sqrt(max(inside, vec4<f32>(0.0)) / a);
    let z = r.oz + side * r.dz;
    let end = clamp(z, vec4<f32>(-half), vec4<f32>(half));
    // The ball at that end.
    let cz = r.oz - end;
    let along = -dot3(r.ox, r.oy, cz, r.dx, r.dy, r.dz);
    let qx = r.ox + along * r.dx;
    let qy = r.oy + along * r.dy;
    let qz = cz + along * r.dz;
    let in_ball = radius * radius - dot3(qx, qy, qz, qx, qy, qz);
    let ball = along - sqrt(max(in_ball, vec4<f32>(0.0)));
    let on_side = abs(z) <= vec4<f32>(half);
    let range = select(ball, side, on_side);
    let hit = (inside > vec4<f32>(0.0)) & (on_side | (in_ball > vec4<f32>(0.0))) & (range > vec4<f32>(NEAREST_M));
    return select(vec4<f32>(NOWHERE), range, hit);
}

fn meet_cylinder(r: Rays, radius: f32, half: f32) -> vec4<f32> {
    let a = max(r.dx * r.dx + r.dy * r.dy, vec4<f32>(1e-12));
    let closest = -(r.ox * r.dx + r.oy * r.dy) / a;
    let px = r.ox + closest * r.dx;
    let py = r.oy + closest * r.dy;
    let inside = radius * radius - (px * px + py * py);
    let chord = sqrt(max(inside, vec4<f32>(0.0)) / a);
    let iz = 1.0 / r.dz;
    let az = (-half - r.oz) * iz;
    let bz = (half - r.oz) * iz;
    let near = max(closest - chord, min(az, bz));
    let far = min(closest + chord, max(az, bz));
    let hit = (inside > vec4<f32>(0.0)) & (near < far) & (near > vec4<f32>(NEAREST_M));
    return select(vec4<f32>(NOWHERE), near, hit);
}

// dims: side of a square, squares along x, squares along y. One more square of margin all round.
fn meet_board(r: Rays, dims: vec4<f32>) -> vec4<f32> {
    let range = -r.oz / r.dz;
    let x = (r.ox + range * r.dx) / dims.x;
    let y = (r.oy + range * r.dy) / dims.x;
    let on = (x > vec4<f32>(-2.0)) & (y > vec4<f32>(-2.0)) & (x < vec4<f32>(dims.y)) & (y < vec4<f32>(dims.z));
    return select(vec4<f32>(NOWHERE), range, on & (range > vec4<f32>(NEAREST_M)));
}

// Walks the tree of a mesh; dims: first node, end of nodes, first triangle. Returns range and triangle.
fn meet_mesh(o: vec3<f32>, d: vec3<f32>, dims: vec4<f32>, nearest: f32) -> vec2<f32> {
    let inverse = 1.0 / d;
    var best = vec2<f32>(nearest, 0.0);
    var node = u32(dims.x);
    let end = u32(dims.y);
    while (node < end) {
        // Corner and next node if missed; corner and triangles of a leaf (16 first + count).
        let low = meshes[node];
        let high = meshes[node + 1u];
        let a = (low.xyz - o) * inverse;
        let b = (high.xyz - o) * inverse;
        let lows = min(a, b);
        let highs = max(a, b);
        let near = max(max(lows.x, lows.y), lows.z);
        let far = min(min(highs.x, highs.y), highs.z);
        let met = (near <= far) && (far > NEAREST_M) && (near < best.x);
        let leaf = u32(high.w);
        let count = select(0u, leaf & 15u, met);
        for (var i = 0u; i < count; i++) {
            let number = (leaf >> 4u) + i;
            let at = u32(dims.z) + 6u * number;
            let v0 = meshes[at].xyz;
            let e1 = meshes[at + 1u].xyz;
            let e2 = meshes[at + 2u].xyz;
            let p = cross(d, e2);
            let scale = 1.0 / dot(e1, p);
            let s = o - v0;
            let u = dot(s, p) * scale;
            let q = cross(s, e1);
            let v = dot(d, q) * scale;
            let range = dot(e2, q) * scale;
            if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && range > NEAREST_M && range < best.x) {
                best = vec2<f32>(range, f32(number));
            }
        }
        node = select(u32(low.w), node + 2u, met && leaf == 0u);
    }
    return best;
}

fn keep(hits: ptr<function, Hits>, range: vec4<f32>, item: u32) {
    let nearer = range < (*hits).range;
    (*hits).range = select((*hits).range, range, nearer);
    (*hits).item = select((*hits).item, vec4<u32>(item), nearer);
}

// The nearest hits among the items of a list; `list` is the place of seven numbers in `tiles`: where
// the items of each kind begin, and where the last ends. Loops test at their end, because a CPU runs
// the body once more for a test at the beginning.
fn trace(rays: Rays, list: u32) -> Hits {
    var hits = no_hits();
    let start = tiles[list];
    let end0 = tiles[list + 1u];
    if (start < end0) {
        var i = start;
        loop {
            let item = tiles[i];
            let g = geometries[item];
            keep(&hits, meet_box(into_shape(g, rays), g.dims.xyz), item);
            i++;
            if (i >= end0) { break; }
        }
    }
    if (HAS_ROUND) {
        let end1 = tiles[list + 2u];
        if (end0 < end1) {
            var i = end0;
            loop {
                let item = tiles[i];
                let g = geometries[item];
                keep(&hits, meet_ellipsoid(into_shape(g, rays), g.dims.xyz), item);
                i++;
                if (i >= end1) { break; }
            }
        }
        let end2 = tiles[list + 3u];
        if (end1 < end2) {
            var i = end1;
            loop {
                let item = tiles[i];
                let g = geometries[item];
                keep(&hits, meet_capsule(into_shape(g, rays), g.dims.x, g.dims.y), item);
                i++;
                if (i >= end2) { break; }
            }
        }
        let end3 = tiles[list + 4u];
        if (end2 < end3) {
            var i = end2;
            loop {
                let item = tiles[i];
                let g = geometries[item];
                keep(&hits, meet_cylinder(into_shape(g, rays), g.dims.x, g.dims.y), item);
                i++;
                if (i >= end3) { break; }
            }
        }
    }
    let end3 = tiles[list + 4u];
    let end4 = tiles[list + 5u];
    if (HAS_BOARD) {
        if (end3 < end4) {
            var i = end3;
            loop {
                let item = tiles[i];
                let g = geometries[item];
                keep(&hits, meet_board(into_shape(g, rays), g.dims), item);
                i++;
                if (i >= end4) { break; }
            }
        }
    }
    if (HAS_MESH) {
        let end5 = tiles[list + 6u];
        for (var i = end4; i < end5; i++) {
            let item = tiles[i];
            let g = geometries[item];
            let r = into_shape(g, rays);
            for (var s = 0u; s < 4u; s++) {
                let o = vec3<f32>(r.ox[s], r.oy[s], r.oz[s]);
                let d = vec3<f32>(r.dx[s], r.dy[s], r.dz[s]);
                let met = meet_mesh(o, d, g.dims, hits.range[s]);
                if (met.x < hits.range[s]) {
                    hits.range[s] = met.x;
                    hits.item[s] = item;
                    hits.triangle[s] = u32(met.y);
                }
            }
        }
    }
    return hits;
}
