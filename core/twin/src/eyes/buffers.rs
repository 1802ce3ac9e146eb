//! All memory of the device that an image pair takes.

use super::gpu::{FRAME_VEC4, Gpu, JOB_STRIDE, JOBS, SENSOR_VEC4};
use super::pack::MOST_ITEMS;
use super::shadow;

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
