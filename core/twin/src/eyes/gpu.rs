//! The graphics device: opening it, its pipelines and buffers. Nothing here knows of scenes.

use std::sync::{Arc, Mutex, PoisonError};

use super::error::RenderError;
use super::pack::MOST_ITEMS;
use super::sensor::MOST_TAPS;
use super::shadow;
use super::speckle;
use super::tiles::{NEEDS_BOARD, NEEDS_MESH, NEEDS_MIRROR, NEEDS_PATTERN, NEEDS_ROUND, VARIANTS};

/// Which device draws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AdapterChoice {
    /// A graphics processor if there is one, else the CPU.
    #[default]
    Best,
    /// The CPU, even if there is a graphics processor.
    Software,
    /// None, as on a machine without Vulkan: opening fails.
    Absent,
}

/// Bytes between two numbers that select a run of tiles (the least alignment that every device has).
pub(super) const JOB_STRIDE: u64 = 256;
/// Jobs: one per variant of `see`, one for the shadow map, one for all tiles.
const JOBS: u64 = VARIANTS as u64 + 2;
/// Job of the shadow map.
pub(super) const SHADOW_JOB: u32 = VARIANTS as u32;
/// Job of all tiles.
pub(super) const ALL_JOB: u32 = VARIANTS as u32 + 1;

/// vec4 of the frame's numbers: two eyes of 6, light, size, exposure.
pub(super) const FRAME_VEC4: usize = 2 * 6 + 3 + 4;
/// vec4 of the sensor's numbers: two eyes of 18, three, blur, size.
pub(super) const SENSOR_VEC4: usize = 2 * 18 + 3 + 2 + 1;

const COMMON: &str = include_str!("shaders/common.wgsl");
const SHADOW: &str = include_str!("shaders/shadow.wgsl");
const SEE: &str = include_str!("shaders/see.wgsl");
const SENSOR: &str = include_str!("shaders/sensor.wgsl");

/// An open device.
pub(super) struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    /// Name of the device, for the operator.
    pub name: String,
    /// Errors that the device reported on its own.
    trouble: Arc<Mutex<Option<String>>>,
    scene_layout: wgpu::BindGroupLayout,
    shadow_layout: wgpu::BindGroupLayout,
    job_layout: wgpu::BindGroupLayout,
    sensor_layout: wgpu::BindGroupLayout,
    scene_pipeline_layout: wgpu::PipelineLayout,
    shadow_pipeline_layout: wgpu::PipelineLayout,
    sensor_pipeline_layout: wgpu::PipelineLayout,
    shadow_module: wgpu::ShaderModule,
    sensor_module: wgpu::ShaderModule,
    see_module: wgpu::ShaderModule,
    /// Variants of `see`, made when first needed.
    see: Vec<Option<wgpu::ComputePipeline>>,
    /// Without and with meshes.
    cast: [Option<wgpu::ComputePipeline>; 2],
    label: Option<wgpu::ComputePipeline>,
    /// By taps of the blur.
    develop: Vec<Option<wgpu::ComputePipeline>>,
    speckles: wgpu::TextureView,
    sampler: wgpu::Sampler,
}

impl Gpu {
    /// Opens a device and compiles what every image needs.
    pub fn open(choice: AdapterChoice) -> Result<Self, RenderError> {
        let adapter = adapter(choice)?;
        let name = adapter.get_info().name;
        let failed = |detail: String| RenderError::Device { adapter: name.clone(), detail };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
                label: Some("twin's eyes"),
                ..Default::default()
            }))
            .map_err(|e| failed(e.to_string()))?;
        let trouble = Arc::new(Mutex::new(None));
        let told = trouble.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            told.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_with(|| error.to_string());
        }));

        let scene_layout = scene_layout(&device);
        let shadow_layout = scene_layout_of_shadow(&device);
        let job_layout = job_layout(&device);
        let sensor_layout = sensor_layout(&device);
        let scene_pipeline_layout = pipeline_layout(&device, &[&scene_layout, &job_layout]);
        let shadow_pipeline_layout = pipeline_layout(&device, &[&shadow_layout, &job_layout]);
        let sensor_pipeline_layout = pipeline_layout(&device, &[&sensor_layout]);
        let module = |label: &str, source: String| {
            device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(label),
                source: wgpu::ShaderSource::Wgsl(source.into()),
            })
        };
        let shadow_module = module("shadow", format!("{COMMON}\n{SHADOW}"));
        let see_module = module(
            "see",
            match std::env::var("TWSH") {
                Ok(p) => std::fs::read_to_string(p).unwrap_or_default(),
                _ => format!("{COMMON}\n{SEE}"),
            },
        );
        let sensor_module = module("sensor", SENSOR.to_owned());
        let speckles = speckle_texture(&device, &queue);
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            address_mode_u: wgpu::AddressMode::Repeat,
            address_mode_v: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        let gpu = Self {
            see: (0..VARIANTS).map(|_| None).collect(),
            device,
            queue,
            name,
            trouble,
            scene_layout,
            shadow_layout,
            job_layout,
            sensor_layout,
            scene_pipeline_layout,
            shadow_pipeline_layout,
            sensor_pipeline_layout,
            shadow_module,
            see_module,
            sensor_module,
            cast: [None, None],
            label: None,
            develop: (0..=MOST_TAPS).map(|_| None).collect(),
            speckles,
            sampler,
        };
        gpu.check()?;
        Ok(gpu)
    }

    /// Compiles what an image needs and was not needed before: about 50 ms each.
    pub fn prepare(
        &mut self,
        variants: impl Iterator<Item = usize>,
        meshes: bool,
        taps: usize,
        labels: bool,
    ) {
        for variant in variants {
            let layout = &self.scene_pipeline_layout;
            self.see[variant].get_or_insert_with(|| {
                let flag = |bit: usize| if variant & bit != 0 { 1.0 } else { 0.0 };
                let constants = [
                    ("HAS_MESH", flag(NEEDS_MESH)),
                    ("HAS_BOARD", flag(NEEDS_BOARD)),
                    ("HAS_MIRROR", flag(NEEDS_MIRROR)),
                    ("HAS_ROUND", flag(NEEDS_ROUND)),
                    ("HAS_PATTERN", flag(NEEDS_PATTERN)),
                ];
                pipeline(&self.device, layout, &self.see_module, "see", &constants)
            });
        }
        self.cast[usize::from(meshes)].get_or_insert_with(|| {
            let constants = [("HAS_MESH", f64::from(meshes)), ("HAS_ROUND", 1.0), ("HAS_BOARD", 1.0)];
            pipeline(
                &self.device,
                &self.shadow_pipeline_layout,
                &self.shadow_module,
                "cast_shadows",
                &constants,
            )
        });
        if labels {
            let constants = [("HAS_MESH", 1.0), ("HAS_ROUND", 1.0), ("HAS_BOARD", 1.0)];
            self.label.get_or_insert_with(|| {
                pipeline(&self.device, &self.scene_pipeline_layout, &self.see_module, "label", &constants)
            });
        }
        self.develop[taps].get_or_insert_with(|| {
            let constants = [("TAPS", taps as f64)];
            pipeline(&self.device, &self.sensor_pipeline_layout, &self.sensor_module, "develop", &constants)
        });
    }

    /// A variant of `see` that was prepared.
    pub fn see(&self, variant: usize) -> Option<&wgpu::ComputePipeline> {
        self.see.get(variant)?.as_ref()
    }

    /// The shadow map's pipeline, if prepared.
    pub fn cast(&self, meshes: bool) -> Option<&wgpu::ComputePipeline> {
        self.cast[usize::from(meshes)].as_ref()
    }

    /// The pipeline of object numbers, if prepared.
    pub fn label(&self) -> Option<&wgpu::ComputePipeline> {
        self.label.as_ref()
    }

    /// The sensor's pipeline for a width of blur, if prepared.
    pub fn develop(&self, taps: usize) -> Option<&wgpu::ComputePipeline> {
        self.develop.get(taps)?.as_ref()
    }

    /// Whether the device has reported anything since it was last asked.
    pub fn check(&self) -> Result<(), RenderError> {
        match self.trouble.lock().unwrap_or_else(PoisonError::into_inner).take() {
            Some(detail) => Err(RenderError::Device { adapter: self.name.clone(), detail }),
            None => Ok(()),
        }
    }

    /// Writes to the beginning of a buffer with the next submission.
    pub fn write(&self, buffer: &wgpu::Buffer, bytes: &[u8]) {
        if !bytes.is_empty() {
            self.queue.write_buffer(buffer, 0, bytes);
        }
    }

    /// Waits for the device and looks at what it left in a buffer.
    pub fn read<T>(&self, buffer: &wgpu::Buffer, look: impl FnOnce(&[u8]) -> T) -> Result<T, RenderError> {
        let lost = |detail: String| RenderError::Lost(detail);
        let (done, wait) = std::sync::mpsc::sync_channel(1);
        buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            // Nobody waits any more only if this thread is gone.
            let _ = done.send(result);
        });
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| lost(e.to_string()))?;
        wait.recv().map_err(|e| lost(e.to_string()))?.map_err(|e| lost(e.to_string()))?;
        let found = {
            let view = buffer.get_mapped_range(..).map_err(|e| lost(e.to_string()))?;
            look(&view)
        };
        buffer.unmap();
        self.check()?;
        Ok(found)
    }

    /// A buffer on the device.
    pub fn buffer(&self, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: size.max(16).next_multiple_of(16),
            usage,
            mapped_at_creation: false,
        })
    }
}

/// The best adapter of the kind asked for.
fn adapter(choice: AdapterChoice) -> Result<wgpu::Adapter, RenderError> {
    if choice == AdapterChoice::Absent {
        return Err(RenderError::NoAdapter);
    }
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: wgpu::Backends::VULKAN,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let rank = |adapter: &wgpu::Adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    };
    pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN))
        .into_iter()
        .filter(|a| choice == AdapterChoice::Best || a.get_info().device_type == wgpu::DeviceType::Cpu)
        .min_by_key(rank)
        .ok_or(RenderError::NoAdapter)
}

fn pipeline(
    device: &wgpu::Device,
    layout: &wgpu::PipelineLayout,
    module: &wgpu::ShaderModule,
    entry_point: &str,
    constants: &[(&str, f64)],
) -> wgpu::ComputePipeline {
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry_point),
        layout: Some(layout),
        module,
        entry_point: Some(entry_point),
        compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
        cache: None,
    })
}

fn pipeline_layout(device: &wgpu::Device, groups: &[&wgpu::BindGroupLayout]) -> wgpu::PipelineLayout {
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

fn scene_layout_of_shadow(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("shadow"),
        entries: &scene_entries(true),
    })
}

fn scene_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
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

fn job_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("job"),
        entries: &[uniform(0, true)],
    })
}

fn sensor_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("sensor"),
        entries: &[uniform(0, false), storage(1, true), storage(2, true), storage(3, false)],
    })
}

fn speckle_texture(device: &wgpu::Device, queue: &wgpu::Queue) -> wgpu::TextureView {
    let side = speckle::SIDE as u32;
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("speckles"),
        size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: 1 },
        mip_level_count: speckle::LEVELS as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (level, texels) in speckle::levels().iter().enumerate() {
        let side = (side >> level).max(1);
        queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &texture,
                mip_level: level as u32,
                origin: wgpu::Origin3d::ZERO,
                aspect: wgpu::TextureAspect::All,
            },
            texels,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(side), rows_per_image: None },
            wgpu::Extent3d { width: side, height: side, depth_or_array_layers: 1 },
        );
    }
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// All buffers, for images of one size and lists up to some length.
pub(super) struct Buffers {
    pub size: (u32, u32),
    pub frame: wgpu::Buffer,
    pub geometries: wgpu::Buffer,
    pub materials: wgpu::Buffer,
    pub jobs: wgpu::Buffer,
    pub sensor: wgpu::Buffer,
    pub tiles: wgpu::Buffer,
    pub shadow_tiles: wgpu::Buffer,
    pub shadow_map: wgpu::Buffer,
    pub meshes: wgpu::Buffer,
    pub radiance: wgpu::Buffer,
    pub objects: wgpu::Buffer,
    pub bytes: wgpu::Buffer,
    pub bytes_back: wgpu::Buffer,
    pub objects_back: wgpu::Buffer,
    pub see_group: wgpu::BindGroup,
    pub shadow_group: wgpu::BindGroup,
    pub job_group: wgpu::BindGroup,
    pub develop_group: wgpu::BindGroup,
}

/// How much room the lists need, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Room {
    pub tiles: u64,
    pub shadow_tiles: u64,
    pub meshes: u64,
}

impl Buffers {
    /// Bytes of one pixel of both eyes' images and object numbers.
    pub fn image_bytes(size: (u32, u32)) -> u64 {
        2 * u64::from(size.0) * u64::from(size.1) * 4
    }

    /// Whether these buffers can hold that much.
    pub fn hold(&self, size: (u32, u32), room: Room) -> bool {
        self.size == size
            && self.tiles.size() >= room.tiles
            && self.shadow_tiles.size() >= room.shadow_tiles
            && self.meshes.size() >= room.meshes
    }

    pub fn new(gpu: &Gpu, size: (u32, u32), room: Room) -> Self {
        use wgpu::BufferUsages as Usage;
        let constant = Usage::UNIFORM | Usage::COPY_DST;
        let list = Usage::STORAGE | Usage::COPY_DST;
        let image = Usage::STORAGE | Usage::COPY_DST | Usage::COPY_SRC;
        let back = Usage::MAP_READ | Usage::COPY_DST;
        let pixels = Self::image_bytes(size);
        let frame = gpu.buffer("frame", 16 * FRAME_VEC4 as u64, constant);
        let geometries = gpu.buffer("geometries", 64 * MOST_ITEMS as u64, constant);
        let materials = gpu.buffer("materials", 48 * MOST_ITEMS as u64, constant);
        let jobs = gpu.buffer("jobs", JOBS * JOB_STRIDE, constant);
        let sensor = gpu.buffer("sensor", 16 * SENSOR_VEC4 as u64, constant);
        let tiles = gpu.buffer("tiles", 2 * room.tiles, list);
        let shadow_tiles = gpu.buffer("shadow tiles", 2 * room.shadow_tiles, list);
        let shadow_map = gpu.buffer("shadow map", (shadow::SIDE * shadow::SIDE * 4) as u64, list);
        let meshes = gpu.buffer("meshes", room.meshes, list);
        let radiance = gpu.buffer("radiance", pixels, list);
        let objects = gpu.buffer("objects", pixels, image);
        let bytes = gpu.buffer("bytes", pixels, image);
        let group = |layout: &wgpu::BindGroupLayout, resources: &[wgpu::BindingResource<'_>]| {
            let entries: Vec<_> = resources
                .iter()
                .enumerate()
                .map(|(i, r)| wgpu::BindGroupEntry { binding: i as u32, resource: r.clone() })
                .collect();
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout,
                entries: &entries,
            })
        };
        let speckles = wgpu::BindingResource::TextureView(&gpu.speckles);
        let sampler = wgpu::BindingResource::Sampler(&gpu.sampler);
        let whole = wgpu::Buffer::as_entire_binding;
        let see_group = group(
            &gpu.scene_layout,
            &[
                whole(&frame),
                whole(&geometries),
                whole(&materials),
                whole(&tiles),
                whole(&meshes),
                whole(&shadow_map),
                whole(&radiance),
                whole(&objects),
                speckles,
                sampler,
            ],
        );
        let shadow_group = group(
            &gpu.shadow_layout,
            &[
                whole(&frame),
                whole(&geometries),
                whole(&materials),
                whole(&shadow_tiles),
                whole(&meshes),
                whole(&shadow_map),
            ],
        );
        let one_job = wgpu::BufferBinding { buffer: &jobs, offset: 0, size: wgpu::BufferSize::new(16) };
        let job_group = group(&gpu.job_layout, &[wgpu::BindingResource::Buffer(one_job)]);
        let develop_group =
            group(&gpu.sensor_layout, &[whole(&sensor), whole(&tiles), whole(&radiance), whole(&bytes)]);
        Self {
            bytes_back: gpu.buffer("bytes back", pixels, back),
            objects_back: gpu.buffer("objects back", pixels, back),
            size,
            frame,
            geometries,
            materials,
            jobs,
            sensor,
            tiles,
            shadow_tiles,
            shadow_map,
            meshes,
            radiance,
            objects,
            bytes,
            see_group,
            shadow_group,
            job_group,
            develop_group,
        }
    }
}
