//! Why no image came out.

/// The eyes could not be rendered.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RenderError {
    /// No Vulkan device, not even the CPU's.
    #[error(
        "the twin's eyes need Vulkan and found no device for it: install a graphics driver, or mesa-vulkan-drivers (it draws on the CPU)"
    )]
    NoAdapter,
    /// A device that refuses.
    #[error(
        "the graphics device \"{adapter}\" cannot draw the twin's eyes ({detail}): update its driver, or install mesa-vulkan-drivers and draw on the CPU"
    )]
    Device {
        /// Name of the device.
        adapter: String,
        /// What it says.
        detail: String,
    },
    /// The device went away while it drew.
    #[error("the graphics device stopped drawing ({0}): restart the program")]
    Lost(String),
    /// A place that is no place.
    #[error("the place of {0} is not a finite number: the simulation has become unstable, reset the twin")]
    BadPose(String),
    /// An item on a body that the snapshot does not have.
    #[error(
        "item {item} is carried by body {body}, but there are only {bodies} bodies: give scenery and snapshot of the same world"
    )]
    NoBody {
        /// Index of the item.
        item: usize,
        /// The body it names.
        body: usize,
        /// Bodies in the snapshot.
        bodies: usize,
    },
    /// A size, color or triangle that cannot be drawn.
    #[error("item {item} cannot be drawn: {problem}")]
    BadItem {
        /// Index of the item.
        item: usize,
        /// What is wrong, and what it should be.
        problem: &'static str,
    },
    /// More than fit on the device.
    #[error("{items} items are more than the {most} that can be drawn: join small ones to meshes")]
    TooMany {
        /// Items in the scenery.
        items: usize,
        /// The limit.
        most: usize,
    },
    /// A lens that cannot be drawn through.
    #[error("the lens of the {eye} eye cannot be drawn through: {problem}")]
    Lens {
        /// Which eye.
        eye: plumbline_model::Eye,
        /// Why, and what to do.
        problem: String,
    },
    /// A sensor setting out of range.
    #[error("the sensor's {setting} cannot be {value}: give {usable}")]
    Sensor {
        /// Which setting.
        setting: &'static str,
        /// What was asked for.
        value: f32,
        /// What is possible.
        usable: &'static str,
    },
    /// A frame rate that is none.
    #[error("{0} pairs per second is not a rate: give a number from 0.1 to 120")]
    Rate(f64),
    /// The operating system gives no thread.
    #[error("no thread for the eyes could be started ({0}): close other programs")]
    Thread(String),
}
