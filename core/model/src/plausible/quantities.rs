//! The quantities and their ranges.

use super::{Confused, Quantity};

const MILLIMETERS: Confused = Confused { name: "millimeters", factor: 1e3, right: "meters" };
const CENTIMETERS: Confused = Confused { name: "centimeters", factor: 1e2, right: "meters" };
const DEGREES: Confused = Confused { name: "degrees", factor: 57.295_779_513_082_32, right: "radians" };
const GRAMS: Confused = Confused { name: "grams", factor: 1e3, right: "kilograms" };
const PERCENT: Confused = Confused { name: "percent", factor: 1e2, right: "shares of 1" };
const MILLISECONDS: Confused = Confused { name: "milliseconds", factor: 1e3, right: "seconds" };
const LENGTHS: &[Confused] = &[MILLIMETERS, CENTIMETERS];

/// A focal length is this part of the longer side of its image at least, and this multiple at most.
pub const FOCAL_SHARES: [f64; 2] = [0.05, 20.0];
/// The principal point lies between these multiples of the side of its image.
pub const CENTER_SHARES: [f64; 2] = [-1.0, 2.0];

macro_rules! quantities {
    ($($(#[$doc:meta])* $id:ident = $name:literal, $unit:literal, $least:literal ..= $most:literal, $reason:literal, $confused:expr;)*) => {
        $($(#[$doc])* pub const $id: Quantity = Quantity {
            name: $name,
            unit: $unit,
            least: $least,
            most: $most,
            reason: $reason,
            confused: $confused,
        };)*
    };
}

quantities! {
    /// A coordinate of a point that is sent to inverse kinematics, robot frame. Checked again against
    /// the reach of the arm where the arm is known ([`crate::robot::Chain::farthest_m`]).
    TARGET_M = "a coordinate of a point sent to the arm", "m", -5.0 ..= 5.0,
        "no arm on a table reaches farther", LENGTHS;
    /// A coordinate of a known place, robot frame.
    PLACE_M = "a coordinate of a place near the robot", "m", -10.0 ..= 10.0,
        "the table is less than a meter away", LENGTHS;
    /// A coordinate of a place that eyes estimated, robot frame. Failed estimates land on the wall.
    ESTIMATE_M = "a coordinate of a place that the eyes estimated", "m", -20.0 ..= 20.0,
        "eyes side by side measure nothing that far away", LENGTHS;
    /// How far an instrument scatters.
    SIGMA_M = "the standard deviation of an instrument", "m", 1e-9 ..= 1.0,
        "an instrument that scatters by more measures no robot, and none measures exactly", &[MILLIMETERS];
    /// A coordinate in the frame of an external device.
    EXTERNAL_M = "a coordinate that a device measured from outside", "m", -200.0 ..= 200.0,
        "a laser tracker sees no farther", &[MILLIMETERS];
    /// Distance of what lies behind an object.
    BACKGROUND_M = "a distance of the background", "m", 0.0 ..= 100.0, "a room is smaller", LENGTHS;
    /// Side of a touchscreen.
    SCREEN_SIDE_M = "a side of the visible area of a touchscreen", "m", 0.02 ..= 2.0,
        "phones are larger, and no table carries a larger one", LENGTHS;
    /// A coordinate of the touchscreen's corner, robot frame.
    SCREEN_PLACE_M = "a coordinate of the touchscreen", "m", -3.0 ..= 3.0,
        "an arm has to reach it", LENGTHS;
    /// Side of a touchscreen.
    SCREEN_SIDE_PX = "a side of a touchscreen in pixels", "px", 1.0 ..= 20_000.0,
        "no screen has more", &[];
    /// A coordinate of a touch.
    TOUCH_PX = "a coordinate of a touch", "px", -20_000.0 ..= 40_000.0, "no screen has more pixels", &[];
    /// Height of a block under the touchscreen, above its nominal place.
    BLOCK_HEIGHT_M = "a height of the block under the touchscreen", "m", -0.5 ..= 1.0,
        "the arm has to reach above it", LENGTHS;
    /// Mass at the palm.
    PAYLOAD_KG = "a payload", "kg", 0.0 ..= 20.0, "nothing weighs less than nothing, and no such arm lifts more",
        &[GRAMS];
    /// Angle of a joint.
    JOINT_ANGLE_RAD = "a joint angle", "rad", -13.0 ..= 13.0, "no joint of an arm turns more than twice around",
        &[DEGREES];
    /// Where a joint stands that slides.
    SLIDE_M = "a place of a joint that slides", "m", -5.0 ..= 5.0, "no such joint of an arm reaches farther",
        LENGTHS;
    /// A limit of a joint.
    JOINT_LIMIT_RAD = "a limit of a joint", "rad", -1000.0 ..= 1000.0, "joints of arms do not turn that often",
        &[];
    /// Any other angle.
    ANGLE_RAD = "an angle", "rad", -13.0 ..= 13.0, "twice around is farther than anything is turned here",
        &[DEGREES];
    /// Speed of a joint.
    SPEED_RAD_S = "a speed of a joint", "rad/s", -100.0 ..= 100.0, "servos are slower", &[DEGREES];
    /// Duration of a move.
    MOVE_S = "a duration of a move", "s", 0.0 ..= 3600.0, "no move takes an hour", &[MILLISECONDS];
    /// Time since something was switched on; room for clocks that count from 1970, in milliseconds.
    TIME_S = "a time", "s", -1e13 ..= 1e13, "no clock counts farther", &[];
    /// Temperature of a servo or a room.
    TEMPERATURE_C = "a temperature", "°C", -50.0 ..= 250.0, "electronics are dead beyond", &[];
    /// Load as a share of stall.
    LOAD = "a load as a share of the stall torque", "", -10.0 ..= 10.0, "a servo stalls at 1", &[PERCENT];
    /// Torque of a joint.
    TORQUE_NM = "a torque of a joint", "N m", -20_000.0 ..= 20_000.0, "the strongest industrial joints have less",
        &[];
    /// Part of a link's place in the link before it.
    LINK_LENGTH_M = "a length of a link", "m", -10.0 ..= 10.0, "links of a robot are shorter", LENGTHS;
    /// Mass of a link.
    LINK_MASS_KG = "a mass of a link", "kg", 0.0 ..= 5000.0, "links weigh something, and less than a truck",
        &[GRAMS];
    /// Entry of a link's tensor of inertia.
    INERTIA_KGM2 = "a moment of inertia of a link", "kg m²", -50_000.0 ..= 50_000.0, "links are lighter and shorter",
        &[];
    /// Length of the vector that gives an axis its direction.
    AXIS = "a length of a vector that gives a direction", "", 1e-9 ..= 1e9, "directions are given by vectors of length 1",
        &[];
    /// Component of such a vector.
    DIRECTION = "a component of a direction", "", -1e9 ..= 1e9, "directions are given by vectors of length 1", &[];
    /// Ratio of a joint that copies another, or of a gear.
    RATIO = "a ratio of a gear or of a joint that copies another", "", -10_000.0 ..= 10_000.0,
        "gears of robots are smaller", &[];
    /// Distance between the optical centers of the eyes.
    BASELINE_M = "a distance between the eyes", "m", 1e-3 ..= 1.0, "heads of robots are smaller", LENGTHS;
    /// Focal length, of the largest image; see [`FOCAL_SHARES`].
    FOCAL_PX = "a focal length", "px", 0.05 ..= 400_000.0,
        "a fisheye has about a third of the longer side of its image, a strong telephoto lens ten times that side", &[];
    /// Coordinate of the principal point, of the largest image; see [`CENTER_SHARES`].
    CENTER_PX = "a coordinate of the principal point", "px", -20_000.0 ..= 40_000.0,
        "the optical axis meets the sensor", &[];
    /// Skew of a sensor, of the largest image.
    SKEW_PX = "a skew of the sensor", "px", -20_000.0 ..= 20_000.0, "pixels are nearly rectangles", &[];
    /// A coefficient of an equidistant lens.
    FISHEYE_K = "a coefficient of a fisheye lens", "", -100.0 ..= 100.0, "real lenses have less than 1", &[];
    /// A coefficient of a pinhole lens; those of high order are large for narrow lenses.
    PINHOLE_K = "a distortion coefficient of a pinhole lens", "", -1e5 ..= 1e5, "real lenses have less", &[];
    /// Side of an image.
    IMAGE_SIDE_PX = "a side of an image", "px", 1.0 ..= 20_000.0, "no camera here has more", &[];
    /// A coordinate in an image.
    IMAGE_PX = "a coordinate in an image", "px", -20_000.0 ..= 40_000.0, "no image is larger", &[];
    /// An error or a standard deviation of a coordinate in an image.
    ERROR_PX = "an error in the image", "px", -20_000.0 ..= 20_000.0, "no image is larger", &[];
    /// Side of a square of the board.
    SQUARE_M = "a side of a square of the board", "m", 1e-4 ..= 1.0, "a board is held in front of the eyes", LENGTHS;
    /// Height of a grasp over the table.
    GRASP_HEIGHT_M = "a height to grasp at", "m", -0.5 ..= 1.0, "the hand grasps what lies on the table", LENGTHS;
    /// A weight or bias of a network.
    NETWORK_WEIGHT = "a weight of a network", "", -1e6 ..= 1e6, "inputs and outputs are scaled to about 1", &[];
    /// A length that an effect changes (a link, a tip, a mount).
    EFFECT_M = "a length of an effect", "m", -1.0 ..= 1.0, "what is farther off is not assembled so", LENGTHS;
}
