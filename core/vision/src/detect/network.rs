//! A network in ONNX Runtime: opening it, and running it again and again in the same memory.

use half::f16;
use half::slice::HalfFloatSliceExt as _;
use image::RgbImage;
use ort::ep::ExecutionProvider;
use ort::memory::Allocator;
use ort::session::builder::SessionBuilder;
use ort::session::{HasSelectedOutputs, OutputSelector, RunOptions, Session, SessionInputValue};
use ort::value::{DynTensor, DynValue, PrimitiveTensorElementType, Tensor, TensorElementType};

use super::Letterbox;
use super::filler::{Brightness, Filler};
use super::library::Library;
use super::{DetectError, DetectorOptions, Precision, Provider};

/// Where a network comes from.
pub(super) enum Source<'a> {
    File(&'a std::path::Path),
    Memory(&'a [u8]),
}

/// Opens a network; says what computes it, and why if that is not what was asked for.
pub(super) fn open(
    library: &Library,
    name: &str,
    source: &Source<'_>,
    options: &DetectorOptions,
) -> Result<(Session, Provider, Option<String>), DetectError> {
    let asked = options.provider;
    let refused = match open_with(library, name, source, options, asked) {
        Err(DetectError::NoProvider { reason, .. }) if options.or_processor => reason,
        result => return result.map(|session| (session, asked, None)),
    };
    let session = open_with(library, name, source, options, Provider::Cpu)?;
    let note = format!("{asked} was asked for but cannot be used here ({refused}); the processor is used");
    Ok((session, Provider::Cpu, Some(note)))
}

fn open_with(
    library: &Library,
    name: &str,
    source: &Source<'_>,
    options: &DetectorOptions,
    provider: Provider,
) -> Result<Session, DetectError> {
    let not_onnx = |error: ort::Error| DetectError::NotOnnx { model: name.to_owned(), reason: words(&error) };
    let mut builder = Session::builder(&library.environment).map_err(not_onnx)?;
    if let Some(threads) = options.threads {
        builder = builder.with_intra_threads(threads).map_err(|error| not_onnx(error.into()))?;
    }
    let spins = !options.shares_processor;
    builder = builder.with_intra_op_spinning(spins).map_err(|error| not_onnx(error.into()))?;
    register(library, provider, &mut builder)?;
    match source {
        Source::File(path) => builder.commit_from_file(path),
        Source::Memory(bytes) => builder.commit_from_memory(bytes),
    }
    .map_err(|error| match provider {
        Provider::Cpu => not_onnx(error),
        // Whether it is the file's fault shows when the processor opens it.
        _ => DetectError::NoProvider { provider, reason: words(&error) },
    })
}

fn register(library: &Library, provider: Provider, builder: &mut SessionBuilder) -> Result<(), DetectError> {
    if !library.providers().contains(&provider) {
        let reason = format!("{} was built without it", library.version());
        return Err(DetectError::NoProvider { provider, reason });
    }
    match provider {
        Provider::Cpu => Ok(()),
        Provider::Cuda => ort::ep::CUDA::default().register(builder),
        Provider::TensorRt => ort::ep::TensorRT::default().register(builder),
        Provider::DirectMl => ort::ep::DirectML::default().register(builder),
        Provider::CoreMl => ort::ep::CoreML::default().register(builder),
    }
    .map_err(|error| DetectError::NoProvider { provider, reason: words(&error) })
}

/// What ONNX Runtime says, on one line of bearable length.
pub(super) fn words(error: &ort::Error) -> String {
    const MOST: usize = 240;
    let line =
        error.message().lines().map(str::trim).find(|line| !line.is_empty()).unwrap_or("no reason given");
    // Where in its source it was says nothing to people: "graph.cc:1587 void onnxruntime::F(…) what was wrong".
    let line = match (line.find("onnxruntime::"), line.rfind(") ")) {
        (Some(place), Some(end)) if end > place => line[end + 2..].trim(),
        (Some(_), _) => "it is damaged inside",
        _ => line,
    };
    match line.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.trim_end_matches('.').to_owned(),
    }
}

/// Inputs of so many sizes keep their memory: both eyes, looked at in part and whole.
const MOST_SIZES: usize = 4;

/// Inputs and outputs of a network, in memory that stays.
pub(super) struct Network {
    session: Session,
    /// One per size of input.
    sizes: Vec<OfSize>,
    /// Which of them was filled last, once one was.
    filled: usize,
    input_precision: Precision,
    /// The output as float32, where it is float16.
    wide: Vec<f32>,
    output_precision: Precision,
    /// Whether inputs of one shape have outputs of one shape.
    steady: bool,
}

/// Input and output of one size.
struct OfSize {
    input: Input,
    /// Runs into an output of the right shape; made after the first run, which tells the shape.
    into_kept: Option<RunOptions<HasSelectedOutputs>>,
}

enum Input {
    Float32(InputMemory<f32>),
    Float16(InputMemory<f16>),
}

struct InputMemory<T: Number> {
    filler: Filler<T>,
    /// Size (width, height), px.
    size: (u32, u32),
    tensor: Tensor<T>,
}

/// A number of a network's input.
trait Number: Brightness + PrimitiveTensorElementType + std::fmt::Debug + Clone + 'static {}

impl Number for f32 {}
impl Number for f16 {}

/// Why an input could not be filled.
pub(super) enum NotFilled {
    Image(DetectError),
    Runtime(ort::Error),
}

impl Network {
    /// Wraps a session whose input and output have been checked. `steady`: inputs of one shape
    /// have outputs of one shape.
    pub fn new(session: Session, [input_precision, output_precision]: [Precision; 2], steady: bool) -> Self {
        let (sizes, wide) = (Vec::with_capacity(MOST_SIZES), Vec::new());
        Self { session, sizes, filled: 0, input_precision, wide, output_precision, steady }
    }

    /// The session alone.
    pub fn into_session(self) -> Session {
        self.session
    }

    /// Writes an image into the input of its size.
    pub fn fill(&mut self, image: &RgbImage, letterbox: &Letterbox) -> Result<(), NotFilled> {
        let given = (letterbox.given.width_px, letterbox.given.height_px);
        self.filled = self.size(given).map_err(NotFilled::Runtime)?;
        match self.sizes.get_mut(self.filled).map(|of_size| &mut of_size.input) {
            Some(Input::Float32(memory)) => memory.fill(image, letterbox),
            Some(Input::Float16(memory)) => memory.fill(image, letterbox),
            None => Ok(()),
        }
        .map_err(NotFilled::Image)
    }

    /// Which memory is that of a size, made if there is none; the oldest one goes for it.
    fn size(&mut self, size: (u32, u32)) -> Result<usize, ort::Error> {
        if let Some(known) = self.sizes.iter().position(|of_size| of_size.input.size() == size) {
            return Ok(known);
        }
        if self.sizes.len() == MOST_SIZES {
            self.sizes.remove(0);
        }
        let input = match self.input_precision {
            Precision::Float32 => Input::Float32(InputMemory::new(size)?),
            Precision::Float16 => Input::Float16(InputMemory::new(size)?),
        };
        self.sizes.push(OfSize { input, into_kept: None });
        Ok(self.sizes.len() - 1)
    }

    /// Runs the network on what was filled in last and hands over shape and numbers of its
    /// first output.
    pub fn run<R>(&mut self, read: impl FnOnce(&[i64], &[f32]) -> R) -> Result<R, ort::Error> {
        let Some(OfSize { input, into_kept }) = self.sizes.get_mut(self.filled) else {
            return Err(ort::Error::new("no image was given"));
        };
        let input = match input {
            Input::Float32(memory) => SessionInputValue::from(&memory.tensor),
            Input::Float16(memory) => SessionInputValue::from(&memory.tensor),
        };
        let (precision, wide) = (self.output_precision, &mut self.wide);
        if let Some(options) = into_kept {
            let outputs = self.session.run_with_options([input], options)?;
            return with_values(&outputs[0], precision, wide, read);
        }
        let name = self.session.outputs()[0].name().to_owned();
        let one = || OutputSelector::no_default().with(&name);
        let plain = RunOptions::new()?.with_outputs(one());
        let (result, shape) = {
            let outputs = self.session.run_with_options([input], &plain)?;
            let mut shape = Vec::new();
            let result = with_values(&outputs[0], precision, wide, |of, values| {
                shape.extend_from_slice(of);
                read(of, values)
            })?;
            (result, shape)
        };
        if self.steady {
            let number = match precision {
                Precision::Float32 => TensorElementType::Float32,
                Precision::Float16 => TensorElementType::Float16,
            };
            let kept = DynTensor::new(&Allocator::default(), number, shape)?;
            *into_kept = Some(RunOptions::new()?.with_outputs(one().preallocate(&name, kept)));
        }
        Ok(result)
    }
}

/// Hands over shape and numbers of an output, as float32.
fn with_values<R>(
    output: &DynValue,
    precision: Precision,
    wide: &mut Vec<f32>,
    read: impl FnOnce(&[i64], &[f32]) -> R,
) -> Result<R, ort::Error> {
    match precision {
        Precision::Float32 => {
            let (shape, values) = output.try_extract_tensor::<f32>()?;
            Ok(read(shape, values))
        }
        Precision::Float16 => {
            let (shape, values) = output.try_extract_tensor::<f16>()?;
            wide.resize(values.len(), 0.0);
            values.convert_to_f32_slice(wide);
            Ok(read(shape, wide))
        }
    }
}

impl Input {
    /// Size (width, height), px.
    fn size(&self) -> (u32, u32) {
        match self {
            Self::Float32(memory) => memory.size,
            Self::Float16(memory) => memory.size,
        }
    }
}

impl<T: Number> InputMemory<T> {
    fn new(size: (u32, u32)) -> Result<Self, ort::Error> {
        let shape = [1, 3, i64::from(size.1), i64::from(size.0)];
        let tensor = Tensor::<T>::new(&Allocator::default(), shape)?;
        Ok(Self { filler: Filler::new(), size, tensor })
    }

    fn fill(&mut self, image: &RgbImage, letterbox: &Letterbox) -> Result<(), DetectError> {
        let (_, numbers) = self.tensor.extract_tensor_mut();
        self.filler.fill(image, letterbox, numbers)
    }
}

/// Type of numbers that can be fed and read, if it is one.
pub(super) fn precision(number: TensorElementType) -> Option<Precision> {
    match number {
        TensorElementType::Float32 => Some(Precision::Float32),
        TensorElementType::Float16 => Some(Precision::Float16),
        _ => None,
    }
}
