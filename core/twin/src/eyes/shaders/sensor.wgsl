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
    // Electrons at full brightness, read noise in electrons, 0, 0.
    noise: vec4<f32>,
    // Weights of the blur, the middle first.
    blur: array<vec4<f32>, 2>,
    // Width, height of the images, seed (two 16-bit halves).
    size: vec4<f32>,
}

@group(0) @binding(0) var<uniform> sensor: Sensor;
@group(0) @binding(1) var<storage, read> tiles: array<u32>;
// Exposed light, packed by `see`.
@group(0) @binding(2) var<storage, read> radiance: array<u32>;
@group(0) @binding(3) var<storage, read_write> bytes: array<u32>;

// Pixels that the blur reaches to each side, 1 to 6.
override TAPS: i32 = 1;

fn light_at(eye: u32, x: i32, y: i32) -> vec3<f32> {
    let width = i32(sensor.size.x);
    let height = i32(sensor.size.y);
    let root = radiance[(i32(eye) * height + clamp(y, 0, height - 1)) * width + clamp(x, 0, width - 1)];
    let unit = vec3<f32>(f32(root & 2047u), f32((root >> 11u) & 2047u), f32(root >> 22u))
        * vec3<f32>(2.0 / 2047.0, 2.0 / 2047.0, 2.0 / 1023.0);
    return unit * unit;
}

fn weight(i: i32) -> f32 {
    let k = abs(i);
    return sensor.blur[k >> 2u][k & 3];
}

fn blurred(eye: u32, x: i32, y: i32) -> vec3<f32> {
    var sum = vec3<f32>(0.0);
    for (var j = -TAPS; j <= TAPS; j++) {
        var row = vec3<f32>(0.0);
        for (var i = -TAPS; i <= TAPS; i++) {
            row += light_at(eye, x + i, y + j) * weight(i);
        }
        sum += row * weight(j);
    }
    return sum;
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

// Headers of 16 numbers per tile, see `see`; alpha is 255 where the scene is seen, 0 on shell and outside.
@compute @workgroup_size(8, 8)
fn develop(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let place = tiles[(group.x >> 2u) * 16u];
    let eye = place >> 20u;
    let corner = vec2<u32>(place & 1023u, (place >> 10u) & 1023u) * 16u;
    let at = corner + vec2<u32>(group.x & 1u, (group.x >> 1u) & 1u) * 8u + local.xy;
    if (at.x >= u32(sensor.size.x) || at.y >= u32(sensor.size.y)) {
        return;
    }
    let light = blurred(eye, i32(at.x), i32(at.y));
    let index = (eye * u32(sensor.size.y) + at.y) * u32(sensor.size.x) + at.x;

    let lens = sensor.eyes[eye].lens;
    let more = sensor.eyes[eye].more;
    let y = (f32(at.y) - lens.w) / lens.y;
    let x = (f32(at.x) - lens.z - more.x * y) / lens.x;
    let theta_d = sqrt(x * x + y * y);

    let edge = theta_d / more.y;
    let falloff = 1.0 - sensor.exposure.w * edge * edge * edge * edge;
    var exposed = light * falloff;

    let turns = fract(atan2(y, x) / 6.2831853 + 1.0) * 64.0;
    let before = u32(turns) & 63u;
    let after = (before + 1u) & 63u;
    let begins = mix(sensor.eyes[eye].shell[before >> 2u][before & 3u], sensor.eyes[eye].shell[after >> 2u][after & 3u], fract(turns));
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
    let alpha = select(0u, 0xff000000u, shell <= 0.5 && theta_d <= more.y);
    bytes[index] = u32(rgb.x) | (u32(rgb.y) << 8u) | (u32(rgb.z) << 16u) | alpha;
}
