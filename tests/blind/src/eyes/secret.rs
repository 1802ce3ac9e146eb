//! What can be wrong with eyes.

use std::collections::BTreeMap;

use strum::VariantArray;

use crate::answer::{Hidden, Plan};
use crate::hide;

/// What kind of thing is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, VariantArray)]
pub enum Kind {
    /// The right eye is turned sideways in its socket.
    EyeYaw,
    /// The right eye is rolled and pitched in its socket.
    EyeRoll,
    /// The right eye's sensor is shifted behind its lens.
    ImageShift,
    /// Both lenses have another focal length.
    Focal,
    /// The right eye stands further from the left one.
    Baseline,
    /// The body that carries both eyes sits elsewhere.
    Mount,
    /// The zero of a joint of the neck is off.
    HeadZero,
    /// Both lenses are bulged.
    Bulge,
    /// The right eye stood otherwise while one set was measured.
    Knock,
    /// The right eye turns sideways as it warms.
    YawGrows,
    /// The right eye rolls and pitches as it warms.
    RollGrows,
    /// The right eye's sensor wanders as it warms, along its rows.
    ShiftGrows,
    /// The body that carries both eyes turns as it warms.
    MountGrows,
    /// Not in the library: the outer half of the right lens is another one.
    HalfLens,
    /// Not in the library: rows of the right image are read late and shifted, the lower the further.
    RowOffset,
    /// Not in the library: the left lens alone has another focal length.
    OneFocal,
    /// Not in the library: the axis of the neck's second joint is not square.
    HeadSkew,
    /// Not in the library: the neck stays behind, the more the further it came.
    NeckMemory,
    /// Not in the library: the right eye is loose and wobbles over minutes.
    Wobble,
}

impl Kind {
    /// How many the library knows; they stand first.
    const KNOWN: usize = Self::MountGrows as usize + 1;

    /// Its name on the command line.
    pub fn id(self) -> &'static str {
        match self {
            Self::EyeYaw | Self::YawGrows => "eye-yaw",
            Self::EyeRoll | Self::RollGrows => "eye-roll",
            Self::ImageShift | Self::ShiftGrows => "image-shift",
            Self::Focal | Self::Baseline => "focal-or-baseline",
            Self::Mount | Self::MountGrows => "camera-mount",
            Self::HeadZero => "head-joint",
            Self::Bulge => "lens-distortion",
            Self::Knock => "eye-knock",
            Self::HalfLens => "(half-lens)",
            Self::RowOffset => "(row-offset)",
            Self::OneFocal => "(one-focal)",
            Self::HeadSkew => "(head-skew)",
            Self::NeckMemory => "(neck-memory)",
            Self::Wobble => "(wobble)",
        }
    }

    /// Whether it grows as the eyes warm up.
    pub fn grows(self) -> bool {
        matches!(self, Self::YawGrows | Self::RollGrows | Self::ShiftGrows | Self::MountGrows)
    }

    /// Whether the library knows it.
    pub fn is_named(self) -> bool {
        (self as usize) < Self::KNOWN
    }

    /// A usual amount, and the most that a robot has: rad, m, px, 1.
    pub fn usual_and_most(self) -> [f64; 2] {
        match self {
            Self::EyeYaw | Self::YawGrows | Self::Knock | Self::Wobble => [0.004, 0.04],
            Self::EyeRoll | Self::RollGrows | Self::MountGrows => [0.004, 0.02],
            Self::Mount | Self::HeadZero | Self::HeadSkew | Self::NeckMemory => [0.004, 0.08],
            Self::ImageShift | Self::ShiftGrows => [0.6, 6.0],
            Self::HalfLens | Self::RowOffset => [0.6, 12.0],
            Self::Focal | Self::OneFocal => [0.005, 0.08],
            Self::Baseline => [0.02, 0.2],
            Self::Bulge => [0.005, 0.04],
        }
    }
}

impl hide::Kinds for Kind {
    const NAMED: &'static [Self] = Self::VARIANTS.split_at(Self::KNOWN).0;
    const NAMELESS: &'static [Self] = Self::VARIANTS.split_at(Self::KNOWN).1;

    /// A neck that stands still shows neither its zeros, which are the mount's there, nor what follows its motion; one
    /// thing that is watched shows what grows alone.
    fn shows_in(self, plan: Plan) -> bool {
        match plan {
            Plan::Plain => !matches!(self, Self::HeadZero | Self::HeadSkew | Self::NeckMemory),
            Plan::Rich => true,
            Plan::Watched => self.grows() || self == Self::Wobble,
        }
    }
}

/// Something that is wrong, where, and by how much.
#[derive(Clone, Debug, PartialEq)]
pub struct Secret {
    /// What.
    pub kind: Kind,
    /// Which joint of the neck, or which set.
    pub which: usize,
    /// How much.
    pub amount: f64,
    /// Directions and phases.
    pub shape: [f64; 6],
}

/// A turn goes with a shift of this much per radian, m.
pub const SHIFT_PER_TURN_M: f64 = 0.4;

impl hide::Secret for Secret {
    type Kind = Kind;

    fn amount(&self) -> f64 {
        self.amount
    }

    fn with_amount(&self, amount: f64) -> Self {
        Self { amount, ..self.clone() }
    }

    fn most(&self) -> f64 {
        self.kind.usual_and_most()[1]
    }
}

impl Secret {
    /// A part of its direction, times its amount.
    pub fn part(&self, k: usize) -> f64 {
        self.amount * self.shape[k]
    }

    /// As the command line would say it.
    pub fn told(&self, neck: &[String], sets: &[String], size_sigmas: f64) -> Hidden {
        let site = match self.kind {
            Kind::Focal | Kind::Baseline | Kind::Mount | Kind::MountGrows | Kind::Bulge => "eyes".to_owned(),
            Kind::HeadZero | Kind::HeadSkew | Kind::NeckMemory => neck[self.which].clone(),
            Kind::Knock => sets[self.which].clone(),
            Kind::OneFocal => "left".to_owned(),
            _ => "right".to_owned(),
        };
        Hidden { id: self.kind.id().to_owned(), site, parameters: self.parameters(), size_sigmas }
    }

    fn parameters(&self) -> BTreeMap<String, f64> {
        let many = |names: &[&str], values: &[f64]| {
            names.iter().map(|name| (*name).to_owned()).zip(values.iter().copied()).collect()
        };
        let p = |k: usize| self.part(k);
        let s = SHIFT_PER_TURN_M;
        match self.kind {
            Kind::EyeYaw => many(&["yaw_rad"], &[self.amount]),
            Kind::EyeRoll => many(&["roll_rad", "pitch_rad"], &[p(0), p(1)]),
            Kind::ImageShift => many(&["du_px", "dv_px"], &[p(0), p(1)]),
            Kind::Focal | Kind::Baseline => many(&["scale"], &[self.amount]),
            Kind::Mount => many(
                &["x_m", "y_m", "z_m", "rot_x_rad", "rot_y_rad", "rot_z_rad"],
                &[s * p(3), s * p(4), s * p(5), p(0), p(1), p(2)],
            ),
            Kind::HeadZero => many(&["offset_rad"], &[self.amount]),
            Kind::Knock => many(&["pitch_rad", "yaw_rad", "roll_rad"], &[p(0), p(1), p(2)]),
            // How far it goes follows from the heat, and how far a bulged lens bends from the lens.
            _ => BTreeMap::new(),
        }
    }
}
