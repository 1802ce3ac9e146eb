//! The graphics device: opening it, its pipelines and buffers. Nothing here knows of scenes.

use std::sync::{Arc, Mutex, PoisonError};

use super::error::RenderError;
use super::layouts::{job_layout, pipeline_layout, scene_layout, scene_layout_of_shadow, sensor_layout};
use super::sensor::MOST_TAPS;
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
pub(super) const JOBS: u64 = VARIANTS as u64 + 2;
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
    pub scene_layout: wgpu::BindGroupLayout,
    pub shadow_layout: wgpu::BindGroupLayout,
    pub job_layout: wgpu::BindGroupLayout,
    pub sensor_layout: wgpu::BindGroupLayout,
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
    pub speckles: wgpu::TextureView,
    pub sampler: wgpu::Sampler,
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
