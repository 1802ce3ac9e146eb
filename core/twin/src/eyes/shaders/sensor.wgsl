// From the light that falls on the sensor to the bytes of an image: blur of the lens, falloff,
// face shell, image circle, noise, brightness curve.

struct Lens {
    // fx, fy, cx, cy in pixels.
    lens: vec4<f32>,
    // Skew, theta_d at the edge of the image circle, softness of the edge in theta_d, which eye.
    more: vec4<f32>,
    // theta_d where the face shell begins, around the axis from +u over +v.
    shell: array<vec4<f32>, 16>,
}

struct Sensor {
    eyes: array<Lens, 2>,
    // Exposure of red, green, blue (white balance included); falloff towards the edge.
    exposure: vec4<f32>,
    // Light from the shell; softness of its edge in theta_d.
    shell: vec4<f32>,
    // Electrons at full brightness, read noise in electrons, taps of the blur to each side, 0.
    noise: vec4<f32>,
    // Weights of the blur, the middle first.
    blur: array<vec4<f32>, 4>,
    // Width, height of the images, seed (two 16-bit halves).
    size: vec4<f32>,
}

@group(0) @binding(0) var<uniform> sensor: Sensor;
@group(0) @binding(1) var<storage, read> tiles: array<u32>;
@group(0) @binding(2) var<storage, read> source: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read_write> target_light: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read_write> objects: array<u32>;
@group(0) @binding(5) var<storage, read_write> bytes: array<u32>;

struct Where {
    eye: u32,
    x: u32,
    y: u32,
}

// Headers of 16 numbers per tile, see `see`.
fn place_of(group: u32, local: vec2<u32>) -> Where {
    let place = tiles[(group >> 2u) * 16u];
    let quarter = vec2<u32>(group & 1u, (group >> 1u) & 1u) * 8u;
    return Where(place >> 20u, (place & 1023u) * 16u + quarter.x + local.x, ((place >> 10u) & 1023u) * 16u + quarter.y + local.y);
}

fn light_at(eye: u32, x: i32, y: i32) -> vec3<f32> {
    let width = i32(sensor.size.x);
    let height = i32(sensor.size.y);
    let index = (i32(eye) * height + clamp(y, 0, height - 1)) * width + clamp(x, 0, width - 1);
    let packed = source[index];
    return vec3<f32>(unpack2x16float(packed.x), unpack2x16float(packed.y).x);
}

fn weight(i: i32) -> f32 {
    return sensor.blur[i >> 2u][i & 3];
}

fn blurred(at: Where, step: vec2<i32>) -> vec3<f32> {
    let x = i32(at.x);
    let y = i32(at.y);
    var sum = light_at(at.eye, x, y) * sensor.blur[0].x;
    let taps = i32(sensor.noise.z);
    for (var i = 1; i <= taps; i++) {
        sum += (light_at(at.eye, x + step.x * i, y + step.y * i) + light_at(at.eye, x - step.x * i, y - step.y * i)) * weight(i);
    }
    return sum;
}

@compute @workgroup_size(8, 8)
fn blur_rows(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let at = place_of(group.x, local.xy);
    if (at.x >= u32(sensor.size.x) || at.y >= u32(sensor.size.y)) {
        return;
    }
    let light = blurred(at, vec2<i32>(1, 0));
    let index = (at.eye * u32(sensor.size.y) + at.y) * u32(sensor.size.x) + at.x;
    target_light[index] = vec2<u32>(pack2x16float(light.xy), pack2x16float(vec2<f32>(light.z, 0.0)));
}

// A permuted congruential generator as a hash.
fn pcg(v: u32) -> u32 {
    let state = v * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// Nearly normal: the sum of eight uniform bytes each of two numbers, unit variance.
fn normal(a: u32, b: u32) -> f32 {
    let x = vec4<f32>(f32(a & 0xffu), f32((a >> 8u) & 0xffu), f32((a >> 16u) & 0xffu), f32(a >> 24u));
    let y = vec4<f32>(f32(b & 0xffu), f32((b >> 8u) & 0xffu), f32((b >> 16u) & 0xffu), f32(b >> 24u));
    // Eight bytes: mean 8 * 127.5, variance 8 * (256 * 256 - 1) / 12.
    return (dot(x + y, vec4<f32>(1.0)) - 1020.0) / 209.0215;
}

fn curve(x: vec3<f32>) -> vec3<f32> {
    let low = x * 12.92;
    let high = 1.055 * pow(max(x, vec3<f32>(1e-6)), vec3<f32>(1.0 / 2.4)) - 0.055;
    return select(high, low, x < vec3<f32>(0.0031308));
}

@compute @workgroup_size(8, 8)
fn develop(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let at = place_of(group.x, local.xy);
    if (at.x >= u32(sensor.size.x) || at.y >= u32(sensor.size.y)) {
        return;
    }
    let light = blurred(at, vec2<i32>(0, 1));
    let index = (at.eye * u32(sensor.size.y) + at.y) * u32(sensor.size.x) + at.x;

    let lens = sensor.eyes[at.eye].lens;
    let more = sensor.eyes[at.eye].more;
    let y = (f32(at.y) - lens.w) / lens.y;
    let x = (f32(at.x) - lens.z - more.x * y) / lens.x;
    let theta_d = sqrt(x * x + y * y);

    let edge = theta_d / more.y;
    let falloff = 1.0 - sensor.exposure.w * edge * edge * edge * edge;
    var exposed = light * sensor.exposure.xyz * falloff;

    let turns = fract(atan2(y, x) / 6.2831853 + 1.0) * 64.0;
    let before = u32(turns) & 63u;
    let after = (before + 1u) & 63u;
    let begins = mix(sensor.eyes[at.eye].shell[before >> 2u][before & 3u], sensor.eyes[at.eye].shell[after >> 2u][after & 3u], fract(turns));
    let shell = smoothstep(-sensor.shell.w, sensor.shell.w, theta_d - begins);
    // The shell curves away from the light further out.
    let shade = 1.0 - 0.35 * clamp((theta_d - begins) * 2.5, 0.0, 1.0) + 0.25 * clamp(-y, -0.4, 1.0);
    exposed = mix(exposed, sensor.shell.xyz * sensor.exposure.xyz * shade, shell);

    // Blue reaches a little further out than red.
    let beyond = vec3<f32>(theta_d) - vec3<f32>(more.y) - vec3<f32>(-0.9, -0.2, 0.9) * more.z;
    exposed = exposed * (1.0 - smoothstep(vec3<f32>(-more.z), vec3<f32>(more.z), beyond));

    let seed = u32(sensor.size.z) | (u32(sensor.size.w) << 16u);
    let n0 = pcg(index ^ pcg(seed));
    let n1 = pcg(n0 ^ 0x9e3779b9u);
    let n2 = pcg(n1 + 0x85ebca6bu);
    let n3 = pcg(n2 ^ 0xc2b2ae35u);
    let n4 = pcg(n3 + 0x27d4eb2fu);
    let n5 = pcg(n4 ^ 0x165667b1u);
    let random = vec3<f32>(normal(n0, n1), normal(n2, n3), normal(n4, n5));
    let sd = sqrt(max(exposed, vec3<f32>(0.0)) * sensor.noise.x + sensor.noise.y * sensor.noise.y) / sensor.noise.x;
    let value = clamp(exposed + sd * random, vec3<f32>(0.0), vec3<f32>(1.0));
    let inside = theta_d < more.y + 4.0 * more.z;
    let rgb = select(vec3<f32>(0.0), curve(value) * 255.0 + 0.5, inside);
    bytes[index] = u32(rgb.x) | (u32(rgb.y) << 8u) | (u32(rgb.z) << 16u) | 0xff000000u;
    if (shell > 0.5 || theta_d > more.y) {
        objects[index] = 0u;
    }
}
