// What each pixel sees: four rays, the nearest thing of each, every different thing shaded once.

@group(0) @binding(5) var<storage, read> shadow_map: array<f32>;
// Exposed light, see `packed`.
@group(0) @binding(6) var<storage, read_write> radiance: array<u32>;
@group(0) @binding(7) var<storage, read_write> objects: array<u32>;
@group(0) @binding(8) var speckles: texture_2d<f32>;
@group(0) @binding(9) var repeat: sampler;

struct Job {
    // Place of the first tile header in `tiles`.
    first: u32,
}
@group(1) @binding(0) var<uniform> job: Job;

override HAS_PATTERN: bool = false;
override HAS_MIRROR: bool = false;

const SPECKLE_TEXELS = 512.0;
const TEXELS_PER_SPECKLE = 5.0;
const INK = 0.045;

// Unit normal in the shape's frame at a place on it, seen along `d`.
fn normal_on(kind: u32, dims: vec4<f32>, p: vec3<f32>, triangle: u32) -> vec3<f32> {
    let q = abs(p) / max(dims.xyz, vec3<f32>(1e-9));
    var n = select(vec3<f32>(0.0, 0.0, p.z), select(vec3<f32>(0.0, p.y, 0.0), vec3<f32>(p.x, 0.0, 0.0), q.x > q.y && q.x > q.z), q.x > q.z || q.y > q.z);
    if (HAS_ROUND) {
        if (kind == ELLIPSOID) {
            n = p / (dims.xyz * dims.xyz);
        }
        if (kind == CAPSULE) {
            n = vec3<f32>(p.xy, p.z - clamp(p.z, -dims.y, dims.y));
        }
        if (kind == CYLINDER) {
            let on_end = dims.y - abs(p.z) < dims.x - length(p.xy);
            n = select(vec3<f32>(p.xy, 0.0), vec3<f32>(0.0, 0.0, p.z), on_end);
        }
    }
    if (HAS_BOARD && kind == BOARD) {
        n = vec3<f32>(0.0, 0.0, -1.0);
    }
    if (HAS_MESH && kind == MESH) {
        let at = u32(dims.z) + 6u * triangle;
        let v0 = meshes[at].xyz;
        let e1 = meshes[at + 1u].xyz;
        let e2 = meshes[at + 2u].xyz;
        let s = p - v0;
        let d11 = dot(e1, e1);
        let d12 = dot(e1, e2);
        let d22 = dot(e2, e2);
        let s1 = dot(s, e1);
        let s2 = dot(s, e2);
        let scale = 1.0 / (d11 * d22 - d12 * d12);
        let v = (d22 * s1 - d12 * s2) * scale;
        let w = (d11 * s2 - d12 * s1) * scale;
        n = meshes[at + 3u].xyz * (1.0 - v - w) + meshes[at + 4u].xyz * v + meshes[at + 5u].xyz * w;
    }
    return n / max(length(n), 1e-12);
}

// Light that comes from a direction where nothing is: a bright ceiling above dim surroundings.
fn surroundings(d: vec3<f32>) -> f32 {
    return frame.light.w * (1.0 + 2.0 * clamp(d.z, 0.0, 1.0));
}

// Share of the lamp that reaches a place, 0 to 1: 3 by 3 texels averaged under a tent, for a lamp is no
// point.
fn lit(p: vec3<f32>, n: vec3<f32>) -> f32 {
    let rows = frame.light_from_robot;
    let per_texel = frame.light.y;
    let facing = dot(n, frame.to_lamp.xyz);
    let q = p + n * (1.8 * per_texel);
    let x = dot(rows[0].xyz, q) + rows[0].w - 0.5;
    let y = dot(rows[1].xyz, q) + rows[1].w - 0.5;
    let depth = FAR - (dot(rows[2].xyz, q) + rows[2].w - per_texel);
    let width = frame.light.z;
    let off_map = facing <= 0.0 || x < 2.0 || y < 2.0 || x > width - 3.0 || y > width - 3.0;
    let x0 = floor(clamp(x, 2.0, width - 3.0) + 0.5);
    let y0 = floor(clamp(y, 2.0, width - 3.0) + 0.5);
    // Weights of three texels each way; the middle one is nearest.
    let fx = x - x0 + 0.5;
    let fy = y - y0 + 0.5;
    let wx = vec3<f32>(1.0 - fx, 1.0, fx);
    let first = (u32(y0) - 1u) * u32(width) + u32(x0) - 1u;
    let second = first + u32(width);
    let third = second + u32(width);
    let a = vec3<f32>(shadow_map[first], shadow_map[first + 1u], shadow_map[first + 2u]);
    let b = vec3<f32>(shadow_map[second], shadow_map[second + 1u], shadow_map[second + 2u]);
    let c = vec3<f32>(shadow_map[third], shadow_map[third + 1u], shadow_map[third + 2u]);
    let open = (1.0 - fy) * dot(wx, open_of(a, depth)) + dot(wx, open_of(b, depth)) + fy * dot(wx, open_of(c, depth));
    return select(0.25 * open, 1.0, off_map);
}

// The lamp is as broad as a ceiling: what is far above a surface hardly darkens it.
fn open_of(s: vec3<f32>, depth: f32) -> vec3<f32> {
    let gap = max(s - vec3<f32>(depth), vec3<f32>(0.0));
    return select(1.0 - 1.0 / (1.0 + 25.0 * gap * gap), vec3<f32>(1.0), s < vec3<f32>(depth));
}

// Light from lamp and surroundings on a surface.
fn irradiance(n: vec3<f32>, open: f32) -> f32 {
    return frame.light.x * (0.82 + 0.18 * n.z) + frame.to_lamp.w * max(dot(n, frame.to_lamp.xyz), 0.0) * open;
}

// Speckles at a place, averaged over the pixel's footprint; -1 to 1.
fn speckle(p: vec3<f32>, n: vec3<f32>, d: vec3<f32>, footprint: f32, size: f32) -> f32 {
    let a = abs(n);
    let slide = d - n * dot(d, n);
    var at = p.xy;
    var along = slide.xy;
    if (a.x > a.y && a.x > a.z) {
        at = p.yz + vec2<f32>(0.37, 0.11);
        along = slide.yz;
    } else if (a.y > a.z) {
        at = p.xz + vec2<f32>(0.19, 0.73);
        along = slide.xz;
    }
    let texel_m = size / TEXELS_PER_SPECKLE;
    let slant = max(abs(dot(d, n)), 0.08);
    let stretch = along / max(length(along), 1e-6) * (footprint / slant);
    let lod = log2(max(footprint * max(1.0, 0.25 / slant) / texel_m, 1e-3));
    var sum = 0.0;
    for (var i = 0; i < 4; i++) {
        let uv = (at + stretch * (0.25 * f32(i) - 0.375)) / (texel_m * SPECKLE_TEXELS);
        sum += textureSampleLevel(speckles, repeat, uv, max(lod, 0.0)).x;
    }
    return sum * 0.5 - 1.0;
}

// Factor of the pattern on a surface.
fn pattern_at(m: Material, p: vec3<f32>, n: vec3<f32>, footprint: f32, grain: f32) -> f32 {
    if (m.pattern.x == 1.0) {
        return 1.0 + m.pattern.z * grain;
    }
    if (m.pattern.x == 2.0) {
        let across = select(p.x, p.y, abs(n.x) > abs(n.y));
        let turns = across / m.pattern.y;
        // Folds narrower than a pixel fade away.
        let fade = clamp(1.5 - 2.0 * footprint / m.pattern.y, 0.0, 1.0);
        return 1.0 + m.pattern.z * fade * (0.75 * sin(6.2831853 * turns) + 0.25 * sin(6.2831853 * 2.7 * turns + 1.0 + 4.0 * p.z));
    }
    return 1.0;
}

// Share of ink on a chessboard under a pixel: 16 places of it.
fn ink(g: Geometry, o: vec3<f32>, d: vec3<f32>, du: vec3<f32>, dv: vec3<f32>) -> f32 {
    var dark = 0.0;
    for (var i = 0; i < 16; i++) {
        let column = i & 3;
        let row = i >> 2u;
        // Rows and columns of a grid that leans, so that an edge meets its places one by one.
        let u = (f32(column) - 1.5) * 0.25 + (f32(row) - 1.5) * 0.0625;
        let v = (f32(row) - 1.5) * 0.25 - (f32(column) - 1.5) * 0.0625;
        let ray = d + du * u + dv * v;
        let z = -o.z / ray.z;
        let at = vec2<f32>(o.x + z * ray.x, o.y + z * ray.y) / g.dims.x;
        let square = floor(at) + 1.0;
        let on = square.x >= 0.0 && square.y >= 0.0 && square.x < g.dims.y && square.y < g.dims.z;
        let parity = fract((square.x + square.y) * 0.5);
        dark += select(0.0, 1.0 / 16.0, on && parity < 0.25);
    }
    return dark;
}

// What comes along one ray that met `item`; simple, for mirror images.
fn simple(item: u32, triangle: u32, p: vec3<f32>, d: vec3<f32>) -> vec3<f32> {
    let g = geometries[item];
    let m = materials[item];
    let ps = vec3<f32>(dot(g.row0.xyz, p) + g.row0.w, dot(g.row1.xyz, p) + g.row1.w, dot(g.row2.xyz, p) + g.row2.w);
    let ns = normal_on(u32(m.what.x), g.dims, ps, triangle);
    var n = g.row0.xyz * ns.x + g.row1.xyz * ns.y + g.row2.xyz * ns.z;
    n = select(n, -n, dot(n, d) > 0.0);
    return m.albedo.xyz * irradiance(n, 1.0);
}

// Light in one number: square roots in 11, 11 and 10 bits, up to four times saturation; a step is a
// quarter of a gray level of the image.
fn packed(light: vec3<f32>) -> u32 {
    let root = sqrt(clamp(light * 0.25, vec3<f32>(0.0), vec3<f32>(1.0))) * vec3<f32>(2047.0, 2047.0, 1023.0) + 0.5;
    return u32(root.x) | (u32(root.y) << 11u) | (u32(root.z) << 22u);
}

struct Seen {
    item: u32,
    triangle: u32,
    range: f32,
    // Mean direction of the rays that met it.
    d: vec3<f32>,
    // Change of direction per pixel.
    du: vec3<f32>,
    dv: vec3<f32>,
}

fn shade(eye: u32, o: vec3<f32>, seen: Seen, mirror_list: u32) -> vec3<f32> {
    let g = geometries[seen.item];
    let m = materials[seen.item];
    let kind = u32(m.what.x);
    let d = seen.d;
    let p = o + d * seen.range;
    let ps = vec3<f32>(dot(g.row0.xyz, p) + g.row0.w, dot(g.row1.xyz, p) + g.row1.w, dot(g.row2.xyz, p) + g.row2.w);
    let ds = vec3<f32>(dot(g.row0.xyz, d), dot(g.row1.xyz, d), dot(g.row2.xyz, d));
    var ns = normal_on(kind, g.dims, ps, seen.triangle);
    let back = dot(ns, ds) > 0.0;
    ns = select(ns, -ns, back);
    let n = g.row0.xyz * ns.x + g.row1.xyz * ns.y + g.row2.xyz * ns.z;
    let footprint = seen.range * frame.eyes[eye].more.w;

    var albedo = m.albedo.xyz;
    if (HAS_PATTERN) {
        let grain = speckle(ps, ns, ds, footprint, max(m.pattern.y, 1e-4));
        albedo *= pattern_at(m, ps, ns, footprint, grain);
    }
    if (HAS_BOARD && kind == BOARD) {
        let os = vec3<f32>(dot(g.row0.xyz, o) + g.row0.w, dot(g.row1.xyz, o) + g.row1.w, dot(g.row2.xyz, o) + g.row2.w);
        let dus = vec3<f32>(dot(g.row0.xyz, seen.du), dot(g.row1.xyz, seen.du), dot(g.row2.xyz, seen.du));
        let dvs = vec3<f32>(dot(g.row0.xyz, seen.dv), dot(g.row1.xyz, seen.dv), dot(g.row2.xyz, seen.dv));
        let dark = ink(g, os, ds, dus, dvs);
        albedo = select(m.albedo.xyz * mix(1.0, INK, dark), vec3<f32>(0.05), back);
    }
    let open = lit(p, n);
    var color = albedo * irradiance(n, open);

    // More is mirrored at a grazing view.
    let facing = clamp(-dot(d, n), 0.0, 1.0);
    let grazing = 1.0 - facing;
    let gloss = m.albedo.w * (1.0 + 3.0 * grazing * grazing * grazing * grazing * grazing);
    let r = d - n * (2.0 * dot(d, n));
    let toward = clamp(dot(r, frame.to_lamp.xyz), 0.0, 1.0);
    var mirrored = vec3<f32>(surroundings(r));
    if (HAS_MIRROR) {
        if (kind == BOX) {
            let q = p + n * 1e-3;
            let rays = Rays(vec4<f32>(q.x), vec4<f32>(q.y), vec4<f32>(q.z), vec4<f32>(r.x), vec4<f32>(r.y), vec4<f32>(r.z));
            let hits = trace(rays, mirror_list);
            if (hits.item.x != NO_ITEM) {
                mirrored = simple(hits.item.x, hits.triangle.x, q + r * hits.range.x, r);
            }
        }
    }
    let spot = toward * toward;
    let spot4 = spot * spot;
    let highlight = spot4 * spot4 * spot4 * spot4 * frame.to_lamp.w * open;
    color = mix(color, mirrored, min(gloss, 1.0)) + select(4.0, 0.3, kind == BOX) * m.albedo.w * highlight;
    return color;
}

// The pixel of an invocation, and the eye.
struct Where {
    pixel: vec2<u32>,
    eye: u32,
}

fn place_of(header: u32, group: u32, local: vec2<u32>) -> Where {
    let place = tiles[header];
    let quarter = vec2<u32>(group & 1u, (group >> 1u) & 1u) * 8u;
    return Where(vec2<u32>(place & 1023u, (place >> 10u) & 1023u) * 16u + quarter + local, place >> 20u);
}

// Which object the middle of each pixel shows.
@compute @workgroup_size(8, 8)
fn label(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let header = job.first + (group.x >> 2u) * 16u;
    let at = place_of(header, group.x, local.xy);
    let rows = frame.eyes[at.eye].robot_from_eye;
    let center = vec2<f32>(at.pixel);
    let d = turn(rows, unproject(at.eye, center, theta_of(at.eye, center)));
    let rays = Rays(
        vec4<f32>(rows[0].w), vec4<f32>(rows[1].w), vec4<f32>(rows[2].w),
        vec4<f32>(d.x), vec4<f32>(d.y), vec4<f32>(d.z),
    );
    let item = trace(rays, header + 1u).item.x;
    let width = u32(frame.size.x);
    let height = u32(frame.size.y);
    if (at.pixel.x < width && at.pixel.y < height && item != NO_ITEM) {
        objects[(at.eye * height + at.pixel.y) * width + at.pixel.x] = u32(materials[item].what.y);
    }
}

// A header: place (x + 1024 y + 2^20 eye), seven numbers of the list, the same of what mirrors of the
// tile may show, one number unused. Tiles of 16 by 16 pixels, four workgroups each.
@compute @workgroup_size(8, 8)
fn see(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let header = job.first + (group.x >> 2u) * 16u;
    let at = place_of(header, group.x, local.xy);
    let eye = at.eye;
    let pixel = at.pixel;
    let center = vec2<f32>(pixel);

    let rows = frame.eyes[eye].robot_from_eye;
    let o = vec3<f32>(rows[0].w, rows[1].w, rows[2].w);
    let theta = theta_of(eye, center);
    let d0 = turn(rows, unproject(eye, center + vec2<f32>(-0.375, -0.125), theta));
    let d1 = turn(rows, unproject(eye, center + vec2<f32>(0.125, -0.375), theta));
    let d2 = turn(rows, unproject(eye, center + vec2<f32>(0.375, 0.125), theta));
    let d3 = turn(rows, unproject(eye, center + vec2<f32>(-0.125, 0.375), theta));
    let rays = Rays(
        vec4<f32>(o.x), vec4<f32>(o.y), vec4<f32>(o.z),
        vec4<f32>(d0.x, d1.x, d2.x, d3.x), vec4<f32>(d0.y, d1.y, d2.y, d3.y), vec4<f32>(d0.z, d1.z, d2.z, d3.z),
    );
    let hits = trace(rays, header + 1u);

    // The four places are corners of a leaning square: solve for the change per pixel.
    let across = d2 - d0;
    let down = d1 - d3;
    var seen = Seen();
    seen.du = (across * 0.75 + down * 0.25) / 0.625;
    seen.dv = (across * 0.25 - down * 0.75) / 0.625;

    var color = vec3<f32>(0.0);
    var todo = vec4<f32>(1.0);
    loop {
        var pick = NO_ITEM;
        var triangle = 0u;
        for (var s = 0u; s < 4u; s++) {
            let mine = todo[s] > 0.0;
            pick = select(pick, hits.item[s], mine);
            triangle = select(triangle, hits.triangle[s], mine);
        }
        let same = select(vec4<f32>(0.0), todo, hits.item == vec4<u32>(pick));
        let count = dot(same, same);
        todo = todo - same;
        let share = same / count;
        let d = d0 * share.x + d1 * share.y + d2 * share.z + d3 * share.w;
        var light = vec3<f32>(surroundings(d) * 0.3);
        seen.item = select(pick, 0u, pick == NO_ITEM);
        seen.triangle = triangle;
        seen.range = dot(select(vec4<f32>(0.0), hits.range, same > vec4<f32>(0.0)), share);
        seen.d = d;
        if (pick != NO_ITEM) {
            light = shade(eye, o, seen, header + 8u);
        }
        color += light * (count * 0.25);
        if (dot(todo, todo) == 0.0) {
            break;
        }
    }
    let width = u32(frame.size.x);
    let height = u32(frame.size.y);
    if (pixel.x < width && pixel.y < height) {
        let index = (eye * height + pixel.y) * width + pixel.x;
        radiance[index] = packed(color * frame.exposure.xyz);
    }
}
