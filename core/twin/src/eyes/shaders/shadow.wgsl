// The shadow map: distance along the light of the first thing that each texel's ray meets.
// Four texels per invocation.

// Zero where nothing is, else FAR minus the distance: a cleared map throws no shadow.
@group(0) @binding(5) var<storage, read_write> shadow_map: array<f32>;

struct Job {
    // Place of the first tile header in `tiles`.
    first: u32,
}
@group(1) @binding(0) var<uniform> job: Job;

// A header: place (x + 1024 y), then seven numbers of the list. Tiles of 16 by 16 texels.
@compute @workgroup_size(8, 8)
fn cast_shadows(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let header = job.first + group.x * 8u;
    let place = tiles[header];
    let texel = vec2<u32>(place & 1023u, place >> 10u) * 16u + local.xy * 2u;
    // Rays against the light's rows: texel and depth back into the robot frame.
    let rows = frame.light_from_robot;
    let per_texel = frame.light.y;
    let x_axis = rows[0].xyz * per_texel;
    let y_axis = rows[1].xyz * per_texel;
    let z_axis = rows[2].xyz;
    let at = (vec2<f32>(texel) + 0.5 - vec2<f32>(rows[0].w, rows[1].w)) * per_texel;
    let o = x_axis * at.x + y_axis * at.y - z_axis * rows[2].w;
    let sx = vec4<f32>(0.0, 1.0, 0.0, 1.0) * per_texel;
    let sy = vec4<f32>(0.0, 0.0, 1.0, 1.0) * per_texel;
    let rays = Rays(
        o.x + sx * x_axis.x + sy * y_axis.x,
        o.y + sx * x_axis.y + sy * y_axis.y,
        o.z + sx * x_axis.z + sy * y_axis.z,
        vec4<f32>(z_axis.x), vec4<f32>(z_axis.y), vec4<f32>(z_axis.z),
    );
    let hits = trace(rays, header + 1u);
    let width = u32(frame.light.z);
    let index = texel.y * width + texel.x;
    shadow_map[index] = max(FAR - hits.range.x, 0.0);
    shadow_map[index + 1u] = max(FAR - hits.range.y, 0.0);
    shadow_map[index + width] = max(FAR - hits.range.z, 0.0);
    shadow_map[index + width + 1u] = max(FAR - hits.range.w, 0.0);
}
