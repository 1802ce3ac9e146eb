//! From a scenery at one moment to a pair of images.

use image::RgbImage;
use plumbline_model::{Camera, CameraModel, Eye, Fisheye};

use super::buffers::{Buffers, Room};
use super::error::RenderError;
use super::gpu::{ALL_JOB, AdapterChoice, Gpu, JOB_STRIDE, SHADOW_JOB};
use super::numbers::{frame_numbers, sensor_numbers};
use super::pack::{self, MeshStore, Packed};
use super::sensor::Sensor;
use super::shadow::{self, Shadow};
use super::tiles::{self, Cones, TileLists, VARIANTS};
use crate::scene::{Scenery, Snapshot};

/// How to open the renderer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EyeOptions {
    /// Which device draws.
    pub adapter: AdapterChoice,
}

/// What both eyes see at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderedPair {
    /// The left eye's image.
    pub left: RgbImage,
    /// The right eye's image.
    pub right: RgbImage,
}

/// Which object each pixel belongs to ([`Item::object`](crate::scene::Item::object)); 0 is the background, the face
/// shell and all outside of the image circle.
pub type ObjectImage = image::ImageBuffer<image::Luma<u16>, Vec<u16>>;

/// A pair with its objects, for labels that no person has to draw.
#[derive(Clone, Debug, PartialEq)]
pub struct LabeledPair {
    /// The images.
    pub pair: RenderedPair,
    /// Objects in the left image: of every pixel the one in its middle.
    pub left_objects: ObjectImage,
    /// Objects in the right image.
    pub right_objects: ObjectImage,
}

/// Draws what the eyes see.
///
/// One image pair at a time; every call waits until its images are there. Items, lens and sensor may
/// change from call to call.
pub struct EyeRenderer {
    gpu: Gpu,
    buffers: Option<Buffers>,
    meshes: MeshStore,
    cones: [Cones; 2],
}

/// Everything of one image pair, ready for the device.
struct Work {
    size: (u32, u32),
    frame: Vec<[f32; 4]>,
    sensor: Vec<[f32; 4]>,
    packed: Packed,
    lists: TileLists,
    shadow: Shadow,
    /// Whether there is any mesh.
    meshes: bool,
    /// Taps of the blur to each side.
    taps: usize,
}

/// What the device is asked for.
#[derive(Clone, Copy)]
struct Wanted {
    /// The images.
    image: bool,
    /// The object of every pixel.
    objects: bool,
}

/// Handles to where the device leaves an image pair.
struct Results {
    bytes: wgpu::Buffer,
    objects: wgpu::Buffer,
}

impl EyeRenderer {
    /// Opens a device and compiles the shaders, about a second.
    pub fn new(options: EyeOptions) -> Result<Self, RenderError> {
        Ok(Self {
            gpu: Gpu::open(options.adapter)?,
            buffers: None,
            meshes: MeshStore::default(),
            cones: Default::default(),
        })
    }

    /// Name of the device that draws.
    pub fn adapter_name(&self) -> &str {
        &self.gpu.name
    }

    /// Both images. The same `seed` gives the same noise, another one other noise.
    pub fn render(
        &mut self,
        scenery: &Scenery,
        snapshot: &Snapshot,
        sensor: &Sensor,
        seed: u64,
    ) -> Result<RenderedPair, RenderError> {
        let work = self.prepare(scenery, snapshot, sensor, seed)?;
        let results = self.submit(&work, Wanted { image: true, objects: false })?;
        let [left, right] = self.gpu.read(&results.bytes, |bytes| images(bytes, work.size))?;
        Ok(RenderedPair { left, right })
    }

    /// Both images, and which object every pixel shows.
    pub fn render_labeled(
        &mut self,
        scenery: &Scenery,
        snapshot: &Snapshot,
        sensor: &Sensor,
        seed: u64,
    ) -> Result<LabeledPair, RenderError> {
        let work = self.prepare(scenery, snapshot, sensor, seed)?;
        let results = self.submit(&work, Wanted { image: true, objects: true })?;
        let ([left, right], seen) =
            self.gpu.read(&results.bytes, |bytes| (images(bytes, work.size), bytes.to_vec()))?;
        let [left_objects, right_objects] =
            self.gpu.read(&results.objects, |bytes| object_images(bytes, &seen, work.size))?;
        Ok(LabeledPair { pair: RenderedPair { left, right }, left_objects, right_objects })
    }

    /// Only which object every pixel shows, in a fraction of the time: left, right. It is what
    /// [`EyeRenderer::render_labeled`] says.
    pub fn objects(
        &mut self,
        scenery: &Scenery,
        snapshot: &Snapshot,
        sensor: &Sensor,
    ) -> Result<[ObjectImage; 2], RenderError> {
        let work = self.prepare(scenery, snapshot, sensor, 0)?;
        let results = self.submit(&work, Wanted { image: false, objects: true })?;
        let seen = self.gpu.read(&results.bytes, |bytes| bytes.to_vec())?;
        self.gpu.read(&results.objects, |bytes| object_images(bytes, &seen, work.size))
    }

    /// The part of the work that the CPU does: checks, packing, lists.
    fn prepare(
        &mut self,
        scenery: &Scenery,
        snapshot: &Snapshot,
        sensor: &Sensor,
        seed: u64,
    ) -> Result<Work, RenderError> {
        sensor.check()?;
        let eyes = &snapshot.eyes;
        let lenses = [lens(Eye::Left, &eyes.left, sensor)?, lens(Eye::Right, &eyes.right, sensor)?];
        let size = eyes.left.size_px();
        if eyes.right.size_px() != size {
            return Err(RenderError::Lens {
                eye: Eye::Right,
                problem: "its image has another size than the left one; give both the same".to_owned(),
            });
        }
        let poses = [eyes.robot_from_left.isometry, eyes.robot_from_right.isometry];
        for (pose, eye) in poses.iter().zip(Eye::BOTH) {
            if !pack::is_finite(pose) {
                return Err(RenderError::BadPose(format!("the {eye} eye")));
            }
        }
        let light = &scenery.light;
        let numbers =
            [light.toward.x, light.toward.y, light.toward.z, light.lamp.into(), light.ambient.into()];
        if numbers.iter().any(|n| !n.is_finite()) {
            return Err(RenderError::BadPose("the lamp".to_owned()));
        }
        self.meshes.keep_only(scenery);
        let packed = pack::pack(scenery, snapshot, &mut self.meshes)?;
        let circle = f64::from(sensor.image_circle_rad);
        let [left_cones, right_cones] = &mut self.cones;
        let cones =
            [left_cones.update(&lenses[0], size, circle), right_cones.update(&lenses[1], size, circle)];
        let lists = tiles::lists(poses, cones, &packed.bounds);
        let shadow = shadow::shadow(&light.toward, &packed.bounds);
        let frame = frame_numbers(&lenses, &poses, scenery, &shadow, sensor, size);
        let (sensor, taps) = sensor_numbers(&lenses, sensor, size, seed);
        let meshes = packed.bounds.iter().any(|b| b.kind == pack::MESH);
        Ok(Work { size, frame, sensor, packed, lists, shadow, meshes, taps })
    }

    /// Uploads and starts the device; tells where the results will be.
    fn submit(&mut self, work: &Work, wanted: Wanted) -> Result<Results, RenderError> {
        let used = (0..VARIANTS).filter(|&variant| work.lists.runs[variant].1 > 0);
        self.gpu.prepare(used, work.meshes, work.taps, wanted.objects);
        let room = Room {
            tiles: 4 * work.lists.data.len() as u64,
            shadow_tiles: 4 * work.shadow.data.len() as u64,
            meshes: 16 * self.meshes.buffer.len() as u64,
        };
        if !self.buffers.as_ref().is_some_and(|b| b.hold(work.size, room)) {
            self.buffers = Some(Buffers::new(&self.gpu, work.size, room));
            self.meshes.changed = true;
        }
        let Some(buffers) = &self.buffers else { return Err(RenderError::Lost("no memory".to_owned())) };
        upload(&self.gpu, buffers, work);
        if self.meshes.changed {
            self.gpu.write(&buffers.meshes, bytemuck::cast_slice(&self.meshes.buffer));
            self.meshes.changed = false;
        }
        encode(&self.gpu, buffers, work, wanted);
        self.gpu.check()?;
        Ok(Results { bytes: buffers.bytes_back.clone(), objects: buffers.objects_back.clone() })
    }
}

/// The lens of an eye, if it can be drawn through.
fn lens(eye: Eye, camera: &Camera, sensor: &Sensor) -> Result<Fisheye, RenderError> {
    let bad = |problem: String| Err(RenderError::Lens { eye, problem });
    let CameraModel::Fisheye(lens) = camera.model else {
        return bad("the twin's eyes are fisheyes; give a fisheye lens".to_owned());
    };
    let numbers = [lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px, lens.skew_px];
    if numbers.iter().chain(&lens.k).any(|n| !n.is_finite()) || lens.fx_px <= 1.0 || lens.fy_px <= 1.0 {
        return bad("its parameters must be finite, its focal lengths more than a pixel".to_owned());
    }
    if !(16..=1024).contains(&camera.width_px) || !(16..=1024).contains(&camera.height_px) {
        return bad(format!(
            "images of {}×{} pixels are not drawn; give 16 to 1024 each way",
            camera.width_px, camera.height_px
        ));
    }
    let limit_rad = lens.limit_rad();
    if limit_rad < f64::from(sensor.image_circle_rad) {
        return bad(format!(
            "its distortion folds at {:.1}° off the axis, within the image circle; give other coefficients or a smaller circle",
            limit_rad.to_degrees()
        ));
    }
    Ok(lens)
}

fn upload(gpu: &Gpu, buffers: &Buffers, work: &Work) {
    gpu.write(&buffers.frame, bytemuck::cast_slice(&work.frame));
    gpu.write(&buffers.sensor, bytemuck::cast_slice(&work.sensor));
    gpu.write(&buffers.geometries, bytemuck::cast_slice(&work.packed.geometries));
    gpu.write(&buffers.materials, bytemuck::cast_slice(&work.packed.materials));
    gpu.write(&buffers.tiles, bytemuck::cast_slice(&work.lists.data));
    gpu.write(&buffers.shadow_tiles, bytemuck::cast_slice(&work.shadow.data));
    let per_job = JOB_STRIDE as usize / 4;
    // The jobs of the shadow map and of all tiles begin at 0.
    let mut jobs = vec![0_u32; (VARIANTS + 2) * per_job];
    for (variant, (first, _)) in work.lists.runs.iter().enumerate() {
        jobs[variant * per_job] = (first * tiles::HEADER) as u32;
    }
    gpu.write(&buffers.jobs, bytemuck::cast_slice(&jobs));
}

fn encode(gpu: &Gpu, buffers: &Buffers, work: &Work, wanted: Wanted) {
    let Wanted { image, objects } = wanted;
    let mut encoder =
        gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("eyes") });
    encoder.clear_buffer(&buffers.shadow_map, 0, None);
    encoder.clear_buffer(&buffers.radiance, 0, None);
    if objects {
        encoder.clear_buffer(&buffers.objects, 0, None);
    }
    encoder.clear_buffer(&buffers.bytes, 0, None);
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        let job = |number: u32| number * JOB_STRIDE as u32;
        if let Some(cast) = gpu.cast(work.meshes).filter(|_| image && work.shadow.tiles > 0) {
            pass.set_pipeline(cast);
            pass.set_bind_group(0, &buffers.shadow_group, &[]);
            pass.set_bind_group(1, &buffers.job_group, &[job(SHADOW_JOB)]);
            pass.dispatch_workgroups(work.shadow.tiles as u32, 1, 1);
        }
        pass.set_bind_group(0, &buffers.see_group, &[]);
        for (variant, &(_, count)) in work.lists.runs.iter().enumerate() {
            if let Some(pipeline) = gpu.see(variant).filter(|_| image && count > 0) {
                pass.set_pipeline(pipeline);
                pass.set_bind_group(1, &buffers.job_group, &[job(variant as u32)]);
                pass.dispatch_workgroups(4 * count as u32, 1, 1);
            }
        }
        if let Some(label) = gpu.label().filter(|_| objects) {
            pass.set_pipeline(label);
            pass.set_bind_group(1, &buffers.job_group, &[job(ALL_JOB)]);
            pass.dispatch_workgroups(4 * work.lists.tiles as u32, 1, 1);
        }
        if let Some(develop) = gpu.develop(work.taps) {
            pass.set_pipeline(develop);
            pass.set_bind_group(0, &buffers.develop_group, &[]);
            pass.dispatch_workgroups(4 * work.lists.tiles as u32, 1, 1);
        }
    }
    let bytes = Buffers::image_bytes(work.size);
    encoder.copy_buffer_to_buffer(&buffers.bytes, 0, &buffers.bytes_back, 0, bytes);
    if objects {
        encoder.copy_buffer_to_buffer(&buffers.objects, 0, &buffers.objects_back, 0, bytes);
    }
    gpu.queue.submit([encoder.finish()]);
}

/// Two images from bytes red, green, blue, unused.
fn images(bytes: &[u8], (width, height): (u32, u32)) -> [RgbImage; 2] {
    let half = width as usize * height as usize * 4;
    [0, 1].map(|eye| {
        let mut image = RgbImage::new(width, height);
        let source = bytes[eye * half..(eye + 1) * half].chunks_exact(4);
        for (to, from) in image.chunks_exact_mut(3).zip(source) {
            to.copy_from_slice(&from[..3]);
        }
        image
    })
}

/// Object numbers where the image's alpha says that the scene is seen at all.
fn object_images(bytes: &[u8], seen: &[u8], (width, height): (u32, u32)) -> [ObjectImage; 2] {
    let half = width as usize * height as usize * 4;
    [0, 1].map(|eye| {
        let mut image = ObjectImage::new(width, height);
        let range = eye * half..(eye + 1) * half;
        let source = bytes[range.clone()].chunks_exact(4).zip(seen[range].chunks_exact(4));
        for (to, (object, seen)) in image.iter_mut().zip(source) {
            *to = if seen[3] == 0 { 0 } else { u16::from_le_bytes([object[0], object[1]]) };
        }
        image
    })
}
