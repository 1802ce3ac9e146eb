//! Which kind of buffer each shader finds at which binding; the shaders say the same.

/// The layout of pipelines that use these groups.
pub(super) fn pipeline_layout(
    device: &wgpu::Device,
    groups: &[&wgpu::BindGroupLayout],
) -> wgpu::PipelineLayout {
    let groups: Vec<_> = groups.iter().map(|g| Some(*g)).collect();
    device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &groups,
        immediate_size: 0,
    })
}

fn uniform(binding: u32, dynamic: bool) -> wgpu::BindGroupLayoutEntry {
    entry(
        binding,
        wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: dynamic,
            min_binding_size: None,
        },
    )
}

fn storage(binding: u32, read_only: bool) -> wgpu::BindGroupLayoutEntry {
    entry(
        binding,
        wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
    )
}

fn entry(binding: u32, ty: wgpu::BindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { binding, visibility: wgpu::ShaderStages::COMPUTE, ty, count: None }
}

/// Frame, items, tiles, meshes, shadow map: what `cast` (which writes the map) and `see` share.
fn scene_entries(writes_map: bool) -> Vec<wgpu::BindGroupLayoutEntry> {
    vec![
        uniform(0, false),
        uniform(1, false),
        uniform(2, false),
        storage(3, true),
        storage(4, true),
        storage(5, !writes_map),
    ]
}

/// The scene's group for drawing the shadow map.
pub(super) fn scene_layout_of_shadow(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("shadow"),
        entries: &scene_entries(true),
    })
}

/// The scene's group for drawing the eyes.
pub(super) fn scene_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let mut entries = scene_entries(false);
    entries.extend([
        storage(6, false),
        storage(7, false),
        entry(
            8,
            wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: true },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
        ),
        entry(9, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
    ]);
    device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("see"), entries: &entries })
}

/// The group that selects a run of tiles.
pub(super) fn job_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("job"),
        entries: &[uniform(0, true)],
    })
}

/// The sensor's group.
pub(super) fn sensor_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("sensor"),
        entries: &[uniform(0, false), storage(1, true), storage(2, true), storage(3, false)],
    })
}
