//! What lens, face and sensor make of the light.

use plumbline_model::{Eye, Fisheye};

use super::error::RenderError;

/// Taps of the blur to each side, at most.
pub(super) const MOST_TAPS: usize = 6;
/// Azimuths at which the device knows the edge of the shell.
pub(super) const SHELL_STEPS: usize = 64;

/// Lens and sensor of an eye. The default looks like the real eyes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Factor from light to brightness, more than 0. At 1, a white surface in full light just
    /// saturates; the real eyes expose a little longer.
    pub exposure: f32,
    /// Factors of red, green and blue, more than 0.
    pub white_balance: [f32; 3],
    /// Electrons of a saturated pixel; the fewer, the more shot noise.
    pub full_well_electrons: f32,
    /// Standard deviation of the readout, electrons.
    pub read_noise_electrons: f32,
    /// Standard deviation of the lens blur, pixels, 0 to 2. More than 0.6 costs time.
    pub blur_px: f32,
    /// Share of light lost at the edge of the image circle, 0 to 1.
    pub falloff: f32,
    /// Angle off the axis up to which the lens sees, rad; all black beyond.
    pub image_circle_rad: f32,
    /// The part of the face that covers the rim.
    pub shell: Option<FaceShell>,
}

/// The face around an eye, far out of focus. Given for the left eye; the right has its mirror image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceShell {
    /// Angle off the axis (rad) where the shell begins, at 32 equal steps of azimuth, from the
    /// image's right over its bottom.
    pub edge_rad: [f32; 32],
    /// Half width of its soft edge, rad.
    pub softness_rad: f32,
    /// Light that comes from it: red, green, blue, linear.
    pub light: [f32; 3],
}

impl Default for Sensor {
    fn default() -> Self {
        Self {
            exposure: 1.3,
            white_balance: [1.0, 1.0, 1.0],
            full_well_electrons: 4000.0,
            read_noise_electrons: 1.5,
            blur_px: 0.45,
            falloff: 0.2,
            image_circle_rad: std::f32::consts::FRAC_PI_2,
            shell: Some(FaceShell::default()),
        }
    }
}

impl Default for FaceShell {
    fn default() -> Self {
        Self { edge_rad: SHELL_EDGE_RAD, softness_rad: 0.012, light: [0.23, 0.19, 0.145] }
    }
}

impl Sensor {
    /// A perfect one: no blur, noise, falloff or shell. For measuring geometry.
    pub fn ideal() -> Self {
        Self {
            full_well_electrons: 1e9,
            read_noise_electrons: 0.0,
            blur_px: 0.0,
            falloff: 0.0,
            shell: None,
            ..Self::default()
        }
    }

    /// Says which setting cannot be used.
    pub fn check(&self) -> Result<(), RenderError> {
        let within = |setting, value: f32, low: f32, high: f32, usable| {
            if value.is_finite() && value >= low && value <= high {
                Ok(())
            } else {
                Err(RenderError::Sensor { setting, value, usable })
            }
        };
        within("exposure", self.exposure, 1e-6, 1e6, "a number above 0")?;
        for factor in self.white_balance {
            within("white balance", factor, 1e-3, 1e3, "numbers above 0")?;
        }
        within("full well", self.full_well_electrons, 1.0, 1e12, "at least 1 electron")?;
        within("read noise", self.read_noise_electrons, 0.0, 1e9, "electrons, 0 or more")?;
        within("blur", self.blur_px, 0.0, 2.0, "0 to 2 pixels")?;
        within("falloff", self.falloff, 0.0, 1.0, "a share from 0 to 1")?;
        within("image circle", self.image_circle_rad, 0.05, 2.4, "0.05 to 2.4 rad off the axis")?;
        if let Some(shell) = &self.shell {
            within("shell softness", shell.softness_rad, 1e-4, 1.0, "0.0001 to 1 rad")?;
            for edge in shell.edge_rad {
                within("shell edge", edge, 0.01, 3.1, "angles from 0.01 to 3.1 rad")?;
            }
            for light in shell.light {
                within("shell light", light, 0.0, 1e3, "numbers of 0 or more")?;
            }
        }
        Ok(())
    }

    /// Weights of the blur to one side, the middle first; they sum to 1 over both sides.
    pub(super) fn blur_weights(&self) -> Vec<f32> {
        let sigma = f64::from(self.blur_px).max(0.05);
        // Taps of less than a third of a percent are left out.
        let taps = ((3.4 * sigma).floor() as usize).clamp(1, MOST_TAPS);
        let raw: Vec<f64> = (0..=taps).map(|i| (-0.5 * (i as f64 / sigma).powi(2)).exp()).collect();
        let total = raw[0] + 2.0 * raw[1..].iter().sum::<f64>();
        raw.iter().map(|w| (w / total) as f32).collect()
    }

    /// Where the shell begins for one eye as distance from the axis in the image, in units of
    /// the focal length, at [`SHELL_STEPS`] azimuths; out of sight without a shell.
    pub(super) fn shell_edges(&self, eye: Eye, lens: &Fisheye) -> [f32; SHELL_STEPS] {
        let Some(shell) = &self.shell else { return [100.0; SHELL_STEPS] };
        std::array::from_fn(|step| {
            // A mirror swaps left and right: azimuth a becomes half a turn minus a.
            let step = match eye {
                Eye::Left => step,
                Eye::Right => (SHELL_STEPS + SHELL_STEPS / 2 - step) % SHELL_STEPS,
            };
            let known = shell.edge_rad.len();
            let place = step as f64 * known as f64 / SHELL_STEPS as f64;
            let before = place.floor() as usize % known;
            let share = place.fract() as f32;
            let theta = shell.edge_rad[before] * (1.0 - share) + shell.edge_rad[(before + 1) % known] * share;
            theta_d(lens, f64::from(theta)) as f32
        })
    }
}

/// Distance from the axis in the image, in units of the focal length, at an angle off the axis.
pub(crate) fn theta_d(lens: &Fisheye, theta_rad: f64) -> f64 {
    let t2 = theta_rad * theta_rad;
    let [k1, k2, k3, k4] = lens.k;
    theta_rad * (1.0 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4))))
}

/// Read off images of the real left eye.
const SHELL_EDGE_RAD: [f32; 32] = [
    1.463, 1.457, 1.439, 1.312, 1.244, 1.322, 1.405, 1.441, 1.491, 1.549, 1.620, 1.702, 1.796, 1.902, 1.961,
    1.993, 2.028, 1.993, 1.961, 1.914, 1.840, 1.774, 1.681, 1.576, 1.541, 1.507, 1.485, 1.456, 1.401, 1.391,
    1.401, 1.443,
];
